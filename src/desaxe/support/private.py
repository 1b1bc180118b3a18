"""Trusted files and folders: owned by and writable only for this user or root.

What is loaded as machine code must come from nobody else. So a file counts only if its owner is this user or
root, if nobody else may write to it, and if it is an ordinary file and no link; all of that is asked of the
opened file, which cannot be exchanged in between.
"""

import os
import stat
import sys
from pathlib import Path

from .shown import printable

FOLDER_MODE = 0o700
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


class UntrustedError(OSError):
    """A file or folder that another user owns or may write to, or a link."""


def distrust(about: os.stat_result) -> str:
    """The reason to distrust a file or folder; empty if it is trusted."""
    if sys.platform == "win32":  # the user's profile is private there, and owners are no numbers
        return ""
    if about.st_uid not in (os.geteuid(), 0):
        return f"it belongs to another user ({about.st_uid})"
    if about.st_mode & _OTHERS_WRITE:
        return f"others may write to it (mode {stat.S_IMODE(about.st_mode):04o})"
    return ""


def read_bytes(path: Path) -> bytes:
    """The content of a trusted file; UntrustedError for any other, OSError where it cannot be read."""
    flags = (
        os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    )
    with open(os.open(path, flags), "rb") as file:
        about = os.fstat(file.fileno())
        why = distrust(about) if stat.S_ISREG(about.st_mode) else "it is not a regular file"
        if why:
            raise UntrustedError(f"{printable(path)}: {why}")
        return file.read()


def make_folder(path: Path) -> None:
    """Make a folder for this user alone, if it is not there, with those above it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.mkdir(mode=FOLDER_MODE, exist_ok=True)


def check_folder(path: Path) -> None:
    """UntrustedError unless a path is a trusted folder, and no link to one."""
    about = path.lstat()
    if stat.S_ISLNK(about.st_mode):
        raise UntrustedError(f"{printable(path)}: it is a link")
    if not stat.S_ISDIR(about.st_mode):
        raise UntrustedError(f"{printable(path)}: it is not a folder")
    why = distrust(about)
    if why:
        raise UntrustedError(f"{printable(path)}: {why}")
