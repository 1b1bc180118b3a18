"""The folder where compiled kernels live: one that can be written, or a temporary one, never a crash."""

import atexit
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from threading import get_ident
from typing import NamedTuple

VARIABLE = "DESAXE_CACHE_DIR"


class Folder(NamedTuple):
    """Where kernels are kept, and whether the next process finds them there."""

    path: Path
    lasting: bool


@cache
def folder() -> Folder:
    """The first place that can be written: $DESAXE_CACHE_DIR, the user's cache, else a temporary one."""
    import shutil
    import tempfile

    for path in _candidates():
        with suppress(OSError):
            path.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=path):
                return Folder(path, True)
    path = Path(tempfile.mkdtemp(prefix="desaxe-"))
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    warnings.warn(
        f"no cache folder can be written: kernels are compiled anew in every process (set {VARIABLE})",
        RuntimeWarning,
        stacklevel=2,
    )
    return Folder(path, False)


def _candidates() -> list[Path]:
    named = os.environ.get(VARIABLE)
    if named:
        return [Path(named)]
    home = Path(os.path.expanduser("~"))
    if sys.platform == "win32":
        return [Path(os.environ.get("LOCALAPPDATA", home / "AppData" / "Local")) / "desaxe" / "cache"]
    if sys.platform == "darwin":
        return [home / "Library" / "Caches" / "desaxe"]
    return [Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "desaxe"]


def write(path: Path, text: str) -> None:
    """Write a text so that no reader ever sees a part of it."""
    write_bytes(path, text.encode())


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file so that no reader ever sees a part of it."""
    staged = path.with_name(f".{path.name}.{os.getpid()}-{get_ident()}.new")
    try:
        staged.write_bytes(data)  # with the permissions that any new file gets here
        os.replace(staged, path)
    finally:
        staged.unlink(missing_ok=True)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a file across processes; where locks do not work, go on without."""
    with open(path.with_suffix(".lock"), "a", encoding="utf-8") as file:
        held = _lock(file.fileno(), True)
        try:
            yield
        finally:
            if held:
                _lock(file.fileno(), False)


def _lock(descriptor: int, hold: bool) -> bool:
    with suppress(OSError):
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_LOCK if hold else msvcrt.LK_UNLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX if hold else fcntl.LOCK_UN)
        return True
    return False
