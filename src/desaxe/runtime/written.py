"""A record of the files that desaxe wrote: it replaces those, others only with `overwrite`.

The SHA-256 of whatever is written is remembered as the name of an empty file in the cache folder's `written`.
So no file carries a mark, copies and renamed files are known too, and what somebody edited is theirs. Text
that is generated, and may come from another machine, has its own checksum in its head.
"""

import hashlib
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..support.files import check_target, kind_of, replacing, require_writable
from ..support.shown import printable
from . import cache

FOLDER = "written"
MOST = 20_000  # files that are remembered; the oldest tenth is forgotten beyond
UNSEALED = "checksum 0000000000000000"  # the place for it in a text that is generated
_SEAL = re.compile(rb"\bchecksum [0-9a-f]{16}\b")


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


def sealed(text: str) -> str:
    """A text with its checksum at the place for it."""
    return text.replace(UNSEALED, _checksum(text.encode()), 1)


def _checksum(content: bytes) -> str:
    """The checksum of a text as it was generated, whatever the ends of its lines."""
    plain = _SEAL.sub(UNSEALED.encode(), content, count=1)
    lines = b"\n".join(line.rstrip() for line in plain.splitlines())
    return f"checksum {hashlib.sha256(lines.rstrip()).hexdigest()[:16]}"


def _is_sealed(content: bytes) -> bool:
    found = _SEAL.search(content)
    return found is not None and found[0].decode() == _checksum(content)


def is_ours(path: Path) -> bool:
    """True if desaxe wrote the file at a path, as it is; an empty file is as good as none."""
    if kind_of(path) not in ("", "a folder"):  # a pipe has no end
        return False
    if path.is_file() and ((content := path.read_bytes()) == b"" or _is_sealed(content)):
        return True
    return (cache.folder().path / FOLDER / digest_of(path)).exists()


def require_ours(path: Path, overwrite: bool) -> None:
    """FileExistsError where something is at a path that desaxe did not write, unless it may be replaced."""
    if overwrite or not os.path.lexists(path) or (path.exists() and is_ours(path)):
        return
    raise FileExistsError(
        f"{printable(path)}: this is not, or no longer, what desaxe wrote; "
        "overwrite=True (--overwrite) replaces it"
    )


def require_place(path: Path, overwrite: bool) -> None:
    """An error where `replacing_ours` would have one: a way to fail before anything is computed."""
    check_target(path)
    require_ours(path, overwrite)
    require_writable(path)


@contextmanager
def replacing_ours(target: Path, overwrite: bool = False) -> Iterator[Path]:
    """Yield a path to write, which takes the place of `target` as `support.files.replacing` does.

    Raises FileExistsError for what is not ours, also where it appeared meanwhile.
    """
    check_target(target)
    require_ours(target, overwrite)
    with replacing(target) as staged:
        yield staged
        require_ours(target, overwrite)
        remember(staged)
