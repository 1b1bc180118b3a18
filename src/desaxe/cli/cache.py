"""`desaxe cache`: the folder where compiled kernels are kept: list, verify, trim, clear."""

import argparse
import time
from typing import Any

from .parser import add_command


def add_cache(commands: Any) -> None:
    """Add `desaxe cache`."""
    parser = add_command(commands, "cache", "the folder of compiled kernels", _cache)
    parser.add_argument(
        "action",
        nargs="?",
        default="list",
        choices=("list", "verify", "trim", "clear"),
        help="action (default: list)",
    )


def _cache(options: argparse.Namespace) -> int:
    from ..runtime import cache

    folder = cache.folder().path
    print(folder)
    if options.action == "list":
        return _list(folder)
    if options.action == "clear":
        print(f"{cache.clear(folder)} files removed")
        return 0
    return _verify(folder) if options.action == "verify" else _trim(folder)


def _list(folder: Any) -> int:
    from ..runtime import cache

    found = [entry for entry in cache.entries(folder) if entry.path.suffix != ".lock"]
    for entry in reversed(found):
        used = time.strftime("%Y-%m-%d %H:%M", time.localtime(entry.used))
        print(f"{used}  {entry.size / 1e3:9.1f} kB  {entry.path.name}")
    size = sum(entry.size for entry in found)
    print(f"{len(found)} files, {size / 1e6:.1f} MB of at most {cache.limit() / 1e6:.0f} MB")
    return 0


def _verify(folder: Any) -> int:
    from ..runtime.native.modules import faults

    found = faults(folder)
    for path, why in found.items():
        print(f"{path.name}: {why}")
    print(f"{len(found)} files will not be used" if found else "every file is whole and private")
    return 1 if found else 0


def _trim(folder: Any) -> int:
    from ..runtime import cache
    from ..runtime.native.modules import faults

    removed = [*faults(folder)]
    for path in removed:
        path.unlink(missing_ok=True)
    removed += cache.trim(folder / "none")
    for path in removed:
        print(path.name)
    print(f"{len(removed)} files removed")
    return 0
