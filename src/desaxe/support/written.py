"""Outputs bear a mark, by which desaxe knows what it may replace; others only with `overwrite`.

A generated text has its own checksum in its head, so that one which was edited is no longer ours. Anything
else has `desaxe` in its metadata, a table of numbers in a comment line.
"""

import hashlib
import os
import re
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from difflib import unified_diff
from pathlib import Path

from .files import check_target, kind_of, require_writable, staging, swap_in
from .forks import imported
from .shown import printable

UNSEALED = "checksum 0000000000000000"  # the place for it in a text that is generated
_SEAL = re.compile(rb"\bchecksum [0-9a-f]{16}\b")
# Pictures, and the field with the mark.
SIGNED = {".png": "Software", **dict.fromkeys((".svg", ".pdf", ".ps", ".eps"), "Creator")}
PAGE, GIF_COMMENT = '<meta name="generator" content="desaxe">', b"!\xfe\x06desaxe\0"
ZIPPED = ("docProps/core.xml", "modelDescription.xml")  # of a workbook, of an FMU
STORED = ("zarr.json", ".zattrs", ".zmetadata")
_MARK = re.compile(  # of a table or a scene, of JSON, of .png, .svg, .pdf, .ps, .gif and .html
    rb"\A# desaxe |\A\{\s*\"source\": \"desaxe |Software\0desaxe\b|<dc:title>desaxe</dc:title>"
    rb"|/Creator \(desaxe\)|%%Creator: desaxe\b|" + re.escape(GIF_COMMENT) + b"|" + PAGE.encode()
)


def sealed(text: str) -> str:
    """A text with its checksum at the place for it."""
    return text.replace(UNSEALED, _checksum(text.encode()), 1)


def _checksum(content: bytes) -> str:
    """The checksum of a text as it was generated, whatever the ends of its lines."""
    plain = _SEAL.sub(UNSEALED.encode(), content, count=1)
    lines = b"\n".join(line.rstrip() for line in plain.splitlines())
    return f"checksum {hashlib.sha256(lines.rstrip()).hexdigest()[:16]}"


def sign_archive(path: Path) -> None:
    """Put the mark into the comment of a ZIP archive."""
    with zipfile.ZipFile(path, "a") as archive:
        archive.comment = b"desaxe"


def is_ours(path: Path) -> bool:
    """True if the file or Zarr store at a path bears the mark; an empty file is as good as none."""
    if path.is_dir():
        return any(b"desaxe " in (path / name).read_bytes() for name in STORED if (path / name).is_file())
    if kind_of(path):  # a pipe has no end
        return False
    with open(path, "rb") as file:
        head = file.read(8)
    if head.startswith(b"PK"):
        return _is_our_archive(path)
    if head.startswith(b"\x89HDF"):
        return _is_our_dataset(path)
    content = path.read_bytes()
    seal = _SEAL.search(content)
    if seal is not None:
        return seal[0].decode() == _checksum(content)
    return not content or _MARK.search(content) is not None


def _is_our_archive(path: Path) -> bool:
    with suppress(zipfile.BadZipFile, KeyError), zipfile.ZipFile(path) as archive:
        there = [name for name in ZIPPED if name in archive.namelist()]
        return archive.comment == b"desaxe" or any(b"desaxe" in archive.read(name) for name in there)
    return False


def _is_our_dataset(path: Path) -> bool:
    """A NetCDF file whose source is named in the attributes of the file, or of one of its groups."""
    h5py = imported("h5py")
    with suppress(OSError), h5py.File(path) as file:
        groups = [file, *(part for part in file.values() if isinstance(part, h5py.Group))]
        return any(str(group.attrs.get("source", "")).startswith("desaxe ") for group in groups)
    return False


def require_ours(path: Path, overwrite: bool) -> None:
    """FileExistsError where something is at a path that desaxe did not write, unless it may be replaced."""
    if overwrite or not os.path.lexists(path) or (path.exists() and is_ours(path)):
        return
    raise FileExistsError(
        f"{printable(path)} exists and was not written by desaxe, or was edited since; "
        "use --overwrite (overwrite=True)"
    )


def require_path(path: Path, overwrite: bool) -> None:
    """An error where `write_whole` would have one: a way to fail before anything is computed."""
    check_target(path)
    require_ours(path, overwrite)
    require_writable(path)


@contextmanager
def write_whole(target: Path, overwrite: bool = False) -> Iterator[Path]:
    """Yield a temporary path; the file written there takes the place of `target` when the block succeeds.

    target     a file, or what does not exist yet; its folder is made. A link is replaced, not followed
    overwrite  replace a file that desaxe did not write

    The file is on the disk before it is renamed. Raises ValueError where `target` is not a regular file,
    OSError where it cannot be written, FileExistsError for what is not ours, also if it appeared meanwhile.
    """
    check_target(target)
    require_ours(target, overwrite)
    with staging(target.parent) as folder:
        staged = folder / target.name
        yield staged
        require_ours(target, overwrite)
        swap_in(staged, target)


class Generated:
    """The files of a place by name, each with its text; without one it should not be there."""

    def __init__(self, folder: Path, texts: Mapping[str, str | None]) -> None:
        self.folder, self.texts = folder, texts

    def there(self, name: str) -> bytes | None:
        """The content of a file; None where there is none."""
        file = self.folder / name
        return file.read_bytes() if file.is_file() else None

    def stale(self) -> list[str]:
        """The names of those that are missing, have another text or should not be there."""
        requested = {name: None if text is None else text.encode() for name, text in self.texts.items()}
        return [name for name, content in requested.items() if self.there(name) != content]

    def diff(self) -> Iterator[str]:
        """The lines in which those that are there differ."""
        for name in self.stale():
            there, text = self.there(name), self.texts[name]
            old, new = ((there or b"").decode(errors="replace"), text or "")
            heads = f"{name} (there)", f"{name} (new)"
            yield from unified_diff(old.splitlines(), new.splitlines(), *heads, lineterm="")
            if not old or not new:
                yield f"{name} is {'not wanted' if text is None else 'missing' if there is None else 'stale'}"

    def write(self, overwrite: bool) -> None:
        """Write all of them, once it is known that each may be."""
        for name in self.texts:
            require_path(self.folder / name, overwrite)
        for name, text in self.texts.items():
            if text is None:
                (self.folder / name).unlink(missing_ok=True)
                continue
            with write_whole(self.folder / name, overwrite) as staged:
                staged.write_bytes(text.encode())

    def summary(self) -> list[str]:
        """A line for each file that was written."""
        return [
            f"{self.folder / name}: {len(text.splitlines())} lines"
            for name, text in self.texts.items()
            if text
        ]
