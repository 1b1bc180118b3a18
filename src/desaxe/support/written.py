"""Outputs bear a mark, by which desaxe knows what it may replace; others only with `overwrite`.

A generated text has its own checksum in its head, so that one which was edited is no longer ours. Anything
else has `desaxe` in its metadata, a table of numbers in a comment line.
"""

import hashlib
import os
import re
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .files import check_target, kind_of, replacing, require_writable
from .forks import imported
from .shown import printable

UNSEALED = "checksum 0000000000000000"  # the place for it in a text that is generated
_SEAL = re.compile(rb"\bchecksum [0-9a-f]{16}\b")
SIGNED = {".png": "Software", ".svg": "Creator", ".pdf": "Creator"}  # pictures, and the field with the mark
ZIPPED = ("docProps/core.xml", "modelDescription.xml")  # of a workbook, of an FMU
STORED = ("zarr.json", ".zattrs", ".zmetadata")
# Of a table and of each kind of picture.
_MARK = re.compile(rb"\A# desaxe |Software\0desaxe\b|<dc:title>desaxe</dc:title>|/Creator \(desaxe\)")


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
