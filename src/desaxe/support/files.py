"""Atomic writes: a file appears whole or not at all, even if the writer is killed.

Everything is written into a staging folder beside its place and then swapped in by one step of the file
system. A process that is killed leaves its staging folder behind; the next writer beside it removes that.
The lock of a staging folder tells one that is in use from one that is left.
"""

import errno
import os
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from .forks import IMPORTS
from .shown import printable, shown

if sys.platform != "win32":
    import fcntl

PREFIX = ".desaxe-"
# In a staging folder: what was moved out of the way, where two names cannot be swapped.
_REPLACED = "replaced"
WAIT = 60.0  # seconds for a lock that is held for milliseconds
_FIRST_PAUSE, _LONGEST_PAUSE = 0.002, 0.1
_UNLOCKED_AGE = 86_400.0  # seconds after which a staging folder is left, where there are no locks
_KINDS = {
    stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device",
    stat.S_IFDIR: "a folder",
}  # fmt: skip


def as_path(name: str, value: Any) -> Path:
    """An argument as a path; TypeError or ValueError that names it."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} = {shown(value)}: the path of a file is wanted")
    if "\0" in os.fspath(value):
        raise ValueError(f"{name} = {shown(value)}: no path has a null character")
    return Path(value)


def read_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """The content of a regular file of at most `most` bytes; ValueError, without its name, for any other."""
    kind = kind_of(as_path("path", path))
    if kind:
        raise ValueError(f"this is {kind}, no file to read")
    with open(path, "rb", opener=_without_waiting) as file:
        data = file.read(most + 1)
    if data is None:  # as of a kernel's log, which says that it is a file
        raise ValueError("nothing can be read from it now")
    if len(data) > most:
        raise ValueError(f"a file of more than {most // 1_000_000} MB")
    return data


def _without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def check_target(target: Path) -> None:
    """Refuse a target that is no regular file, or not writable."""
    kind = kind_of(target)
    if kind:
        raise ValueError(f"{printable(target)}: this is {kind}; a file can only take the place of a file")
    if target.is_file() and not os.access(target, os.W_OK):
        raise PermissionError(13, "Permission denied", str(target))


def require_writable(path: Path) -> None:
    """OSError where nothing can be made at a path, whose folders need not exist yet."""
    with suppress(FileNotFoundError):
        path.lstat()
    folder = next(one for one in path.absolute().parents if os.path.lexists(one))
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(folder)) from None


def require_space(folder: Path, size: int) -> None:
    """Raise OSError if a file of `size` bytes does not fit on the disk: some libraries would crash."""
    reserve = getattr(os, "posix_fallocate", None)
    if reserve is None:
        return
    with tempfile.TemporaryFile(dir=folder) as file:
        try:
            reserve(file.fileno(), 0, size)
        except OSError as error:
            if error.errno not in (errno.EINVAL, errno.EOPNOTSUPP):
                raise OSError(error.errno, f"{error.strerror}: {size} bytes") from None


def kind_of(path: Path) -> str:
    """The kind of a path that is no regular file, such as "folder"; empty for a file or no file."""
    try:
        result = stat.S_IFMT(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return ""
    return "" if result == stat.S_IFREG else _KINDS.get(result, "not a regular file")


@contextmanager
def staging(parent: Path) -> Iterator[Path]:
    """Yield an empty folder in `parent`, which is made if need be; it is removed when the block ends."""
    parent.mkdir(parents=True, exist_ok=True)
    remove_strays(parent)
    folder, descriptor = _new_staging(parent)
    try:
        yield folder
    finally:
        _restore(folder)
        shutil.rmtree(folder, ignore_errors=True)
        if descriptor is not None:
            os.close(descriptor)


def _new_staging(parent: Path) -> tuple[Path, int | None]:
    """A locked folder. One that a cleaner took between its making and its locking is made again."""
    while True:
        try:
            folder = Path(tempfile.mkdtemp(dir=parent, prefix=PREFIX))
        except OSError as error:  # named by what the user knows
            raise type(error)(error.errno, error.strerror, str(parent)) from None
        with suppress(FileNotFoundError):
            descriptor = opened(folder)
            if descriptor is None or (try_lock(descriptor) is not False and folder.is_dir()):
                return folder, descriptor
            os.close(descriptor)


def remove_strays(parent: Path) -> list[Path]:
    """Remove staging folders that a killed process of this user left; return those that were there."""
    with suppress(OSError):
        return [one for one in parent.iterdir() if one.name.startswith(PREFIX) and _remove_stray(one)]
    return []


def _remove_stray(path: Path) -> bool:
    with suppress(OSError):
        about = path.lstat()
        if not stat.S_ISDIR(about.st_mode) or about.st_uid != getattr(os, "geteuid", lambda: about.st_uid)():
            return False
        descriptor = opened(path, getattr(os, "O_NOFOLLOW", 0))
        try:
            free = None if descriptor is None else try_lock(descriptor)
            if free or (free is None and time.time() - about.st_mtime > _UNLOCKED_AGE):
                _restore(path)
                shutil.rmtree(path, ignore_errors=True)
                return True
        finally:
            if descriptor is not None:
                os.close(descriptor)
    return False


def _restore(stray: Path) -> None:
    """Undo an interrupted replacement: move the old file or folder back."""
    with suppress(OSError):
        for path in (stray / _REPLACED).iterdir():
            if not os.path.lexists(stray.parent / path.name):
                os.rename(path, stray.parent / path.name)


def swap_in(staged: Path, target: Path) -> None:
    """Replace a file or folder by a staged one; the old one stays in the staging folder."""
    if staged.is_file() and target.is_file() and not target.is_symlink():
        staged.chmod(stat.S_IMODE(target.stat().st_mode))
    for path in (staged, *staged.rglob("*")) if staged.is_dir() else (staged,):
        _flush(path)
    if not staged.is_dir():
        os.replace(staged, target)
    elif not os.path.lexists(target):
        os.rename(staged, target)
    elif not exchange(staged, target):
        _swap_by_renaming(staged, target)
    _flush(target.parent)


def _flush(path: Path) -> None:
    """Flush a file, or the entries of a folder, to the disk where the system supports it."""
    if path.is_dir() and sys.platform == "win32":
        return
    with suppress(PermissionError):
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _swap_by_renaming(staged: Path, target: Path) -> None:
    """Swap in two steps, for systems without an atomic exchange; `_restore` mends a stop in between."""
    aside = staged.parent / _REPLACED
    aside.mkdir()
    os.rename(target, aside / target.name)
    os.rename(staged, target)


def exchange(one: Path, other: Path) -> bool:
    """Swap two names in one step (Linux: renameat2, macOS: renamex_np); False where that cannot be done."""
    with IMPORTS:
        import ctypes

    try:
        library = ctypes.CDLL(None, use_errno=True)
        first, second = os.fsencode(os.path.abspath(one)), os.fsencode(os.path.abspath(other))
        if sys.platform == "darwin":
            return int(library.renamex_np(first, second, 2)) == 0
        here = -100  # AT_FDCWD: not used with absolute paths
        return int(library.renameat2(here, first, here, second, 2)) == 0
    except (AttributeError, OSError, TypeError):
        return False


# ---- locks of folders between processes, which the system releases when a process ends ---------------


@contextmanager
def locked(folder: Path, wait: float = WAIT) -> Iterator[bool]:
    """Lock an existing folder for the duration of a block.

    Yields True while the lock is held and False where the system has no locks. Raises TimeoutError after
    `wait` seconds, of short pauses, so that an interrupt takes effect at once.
    """
    descriptor = opened(folder)
    if descriptor is None:
        yield False
        return
    end, pause = time.monotonic() + wait, _FIRST_PAUSE
    try:
        while (held := try_lock(descriptor)) is False:
            if time.monotonic() >= end:
                raise TimeoutError(f"{printable(folder)}: another process has held its lock for {wait:g} s")
            time.sleep(pause)
            pause = min(2.0 * pause, _LONGEST_PAUSE)
        try:
            yield held is True
        finally:
            _release(descriptor)
    finally:
        os.close(descriptor)


def opened(folder: Path, flags: int = 0) -> int | None:
    """A descriptor of a folder; None on Windows, where folders cannot be opened."""
    return None if sys.platform == "win32" else os.open(folder, os.O_RDONLY | os.O_DIRECTORY | flags)


def try_lock(descriptor: int) -> bool | None:
    """Try to lock a descriptor: True if locked, False if another process has it, None without support."""
    if sys.platform != "win32":
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except (BlockingIOError, PermissionError):
            return False
        except OSError:
            pass
    return None


def _release(descriptor: int) -> None:
    """Release a lock: closing is not enough if a forked child has a copy of the descriptor."""
    if sys.platform != "win32":
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_UN)
