"""The cache folder of compiled kernels: private, bounded, and never the cause of an error.

It is $DESAXE_CACHE_DIR or the user's cache folder. Nothing is loaded from it that another user could have
written (see `support.private`). Where it cannot be used, a temporary folder of this process takes its place,
and a warning says so. A folder that can only be read serves for reading.
"""

import atexit
import os
import re
import shutil
import stat
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

from ..support import locks, private
from ..support.files import PREFIX
from ..support.shown import printable

VARIABLE = "DESAXE_CACHE_DIR"
LIMIT_VARIABLE = "DESAXE_CACHE_MB"
LIMIT = 256  # MB on disk, unless the variable says otherwise
WAIT = 10.0  # seconds for another process that compiles the same kernel
_STRAY_AGE = 3600.0  # seconds after which a file that is being written is one that was left
OURS = re.compile(
    r"[a-z]+_[0-9a-f]{20,64}\.\w+|__pycache__|upkeep\.lock|written|\.desaxe-\w+"
)  # names that we give


class Folder(NamedTuple):
    """A cache folder: its path, its persistence, and the reason if it does not persist."""

    path: Path
    lasting: bool
    why: str = ""


@cache
def folder() -> Folder:
    """The cache folder of this process, chosen on first use."""
    path, why = _usual()
    if path is not None:
        try:
            _prepare(path)
            return Folder(path, True)
        except OSError as error:
            why = str(error) if error.strerror is None else f"{printable(path)}: {error.strerror}"
    return _temporary(why)


def _usual() -> tuple[Path | None, str]:
    """The configured or default path of the folder; None and the reason if there is none."""
    named = os.environ.get(VARIABLE)
    if named:
        path = Path(named).expanduser() if named.startswith("~") else Path(named)
        with suppress(OSError):
            return Path(os.path.abspath(path)), ""
        return None, f"{named}: the current folder is gone"
    home = Path(os.path.expanduser("~"))
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", home / "AppData" / "Local")) / "desaxe" / "cache"
    elif sys.platform == "darwin":
        base = home / "Library" / "Caches" / "desaxe"
    else:
        named = os.environ.get("XDG_CACHE_HOME", "")
        base = (Path(named) if os.path.isabs(named) else home / ".cache") / "desaxe"
    return (base, "") if base.is_absolute() else (None, "there is no home folder")


def _prepare(path: Path) -> None:
    """See that the folder is there and private; OSError where it is not and cannot be made so."""
    try:
        private.make_folder(path)
    except FileExistsError:
        raise private.UntrustedError(f"{printable(path)}: it is not a folder") from None
    about = path.lstat()
    mine = sys.platform != "win32" and about.st_uid == os.geteuid() and stat.S_ISDIR(about.st_mode)
    if mine and about.st_mode & 0o077 and all(OURS.fullmatch(name) for name in os.listdir(path)):
        with suppress(OSError):
            path.chmod(private.FOLDER_MODE)  # what others put there before is recognised by its owner
    private.check_folder(path)
    if not os.access(path, os.R_OK | os.X_OK):
        raise PermissionError(13, "Permission denied", str(path))
    try:
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError:
        if not any(path.glob("*.code")):  # there is something to read
            raise


def _temporary(why: str) -> Folder:
    """A temporary folder for this process, or a path that cannot be written; with a warning."""
    try:
        path = Path(tempfile.mkdtemp(prefix="desaxe-"))
    except OSError:
        path = Path(os.devnull) / "desaxe"
    else:
        atexit.register(_remove, path, os.getpid())
    warnings.warn(
        f"no cache folder can be written ({why}): every process compiles its kernels anew (set {VARIABLE})",
        RuntimeWarning,
        stacklevel=3,
    )
    return Folder(path, False, why)


def _remove(path: Path, owner: int) -> None:
    if os.getpid() == owner:  # a forked child leaves its parent's folder alone
        shutil.rmtree(path, ignore_errors=True)


def read_bytes(path: Path) -> bytes:
    """The content of a trusted file of the folder; its time of last use becomes now."""
    data = private.read_bytes(path)
    with suppress(OSError):
        os.utime(path)
    return data


def write_bytes(path: Path, data: bytes) -> None:
    """Keep a file, readable by this user alone, so that no reader ever sees a part of it."""
    with suppress(FileNotFoundError):
        _swap_in(path, data)
        trim(path)
        return
    private.make_folder(path.parent)  # it was removed while we ran
    _swap_in(path, data)


def _swap_in(path: Path, data: bytes) -> None:
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=PREFIX)  # mode 0600, never a link
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.replace(name, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(name)
        raise


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a file across processes.

    Where the folder has no locks or cannot be written, and where another process does not let go in time,
    the block runs without: then two processes may do the same work.
    """
    message = f"another process has held {path.with_suffix('.lock')} for {WAIT:g} s: going on without it"
    held = locks.locked(path.with_suffix(".lock"), WAIT, message)
    try:
        held.__enter__()
    except TimeoutError as error:
        warnings.warn(str(error), RuntimeWarning, stacklevel=4)
    except OSError:
        pass
    else:
        try:
            yield
        finally:
            held.__exit__(None, None, None)
        return
    yield


# ---- upkeep ------------------------------------------------------------------------------------------


class CachedFile(NamedTuple):
    """A file of the folder: its path, its size [bytes], when it was last used [s since 1970]."""

    path: Path
    size: int
    used: float


def entries(path: Path) -> list[CachedFile]:
    """The files that we keep in a folder, the least recently used first."""
    found = []
    with suppress(OSError), os.scandir(path) as there:
        for one in there:
            with suppress(OSError):
                about = one.stat(follow_symlinks=False)
                if OURS.fullmatch(one.name) and stat.S_ISREG(about.st_mode):
                    found.append(CachedFile(Path(one.path), about.st_size, about.st_mtime))
    return sorted(found, key=lambda entry: (entry.used, entry.path))


def limit() -> int:
    """The largest size of the folder [bytes]."""
    named = os.environ.get(LIMIT_VARIABLE, "")
    return int(named) * 1_000_000 if named.isdecimal() and len(named) < 10 else LIMIT * 1_000_000


def trim(kept: Path, most: int | None = None) -> list[Path]:
    """Remove the least recently used files until the folder of `kept` is within its limit; their paths."""
    found = entries(kept.parent)
    for entry in found:
        if entry.path.name.startswith(PREFIX) and entry.used < time.time() - _STRAY_AGE:
            entry.path.unlink(missing_ok=True)
    size = sum(entry.size for entry in found)
    removed = []
    for entry in found:
        if size <= (limit() if most is None else most):
            break
        if entry.path != kept and entry.size:
            with suppress(OSError):
                entry.path.unlink()
                removed.append(entry.path)
                size -= entry.size
    return removed


def clear(path: Path) -> int:
    """Remove all that we keep in a folder, and nothing else; how many files."""
    count = 0
    for entry in entries(path):
        with suppress(OSError):
            entry.path.unlink()
            count += 1
    if not (path / "__pycache__").is_symlink():  # of versions that kept numba's files
        shutil.rmtree(path / "__pycache__", ignore_errors=True)
    return count
