"""A record of the files that desaxe wrote: it replaces those, others only with `overwrite`.

The SHA-256 of whatever is written is remembered as the name of an empty file in the cache folder's `written`.
So no file carries a mark, copies and renamed files are known too, and what somebody edited is theirs. Text
that is generated, and may come from another machine, says itself by which command it was made.
"""

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..support.files import check_target, replacing
from . import cache

FOLDER = "written"
MOST = 20_000  # files that are remembered; the oldest tenth is forgotten beyond
HEAD = 4096  # bytes at the start of a text in which its command stands


def digest_of(path: Path) -> str:
    """The SHA-256 of a file, or of all files in a folder with their names."""
    if not path.is_dir():
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    whole = hashlib.sha256()
    for one in sorted(path.rglob("*")):
        if one.is_file():
            whole.update(f"{one.relative_to(path).as_posix()}\0{digest_of(one)}\n".encode())
    return whole.hexdigest()


def remember(path: Path) -> None:
    """Remember what is about to take its place; where that cannot be kept, the file is unknown later."""
    with suppress(OSError):
        folder = cache.folder().path / FOLDER
        folder.mkdir(mode=0o700, exist_ok=True)
        (folder / digest_of(path)).touch(mode=0o600)
        _trim(folder)


def _trim(folder: Path) -> None:
    names = os.listdir(folder)
    if len(names) > MOST:
        for path in sorted((folder / name for name in names), key=os.path.getmtime)[: MOST // 10]:
            path.unlink(missing_ok=True)


def is_ours(path: Path, mark: bytes = b"") -> bool:
    """True if desaxe wrote the file at a path; `mark` is a text in the head of files that say so themselves.

    An empty file is as good as none.
    """
    if path.is_file():
        with open(path, "rb") as file:
            head = file.read(HEAD)
        if not head or (mark and mark in head):
            return True
    return (cache.folder().path / FOLDER / digest_of(path)).exists()


def require_ours(path: Path, overwrite: bool, mark: bytes = b"") -> None:
    """FileExistsError where something is at a path that desaxe did not write, unless it may be replaced."""
    if overwrite or not os.path.lexists(path) or (path.exists() and is_ours(path, mark)):
        return
    raise FileExistsError(
        f"{path}: this is not, or no longer, what desaxe wrote; overwrite=True (--overwrite) replaces it"
    )


@contextmanager
def replacing_ours(target: Path, overwrite: bool = False, mark: bytes = b"") -> Iterator[Path]:
    """Yield a path to write, which takes the place of `target` as `support.files.replacing` does.

    Raises FileExistsError for what is not ours, also where it appeared meanwhile.
    """
    check_target(target)
    require_ours(target, overwrite, mark)
    with replacing(target) as staged:
        yield staged
        require_ours(target, overwrite, mark)
        remember(staged)
