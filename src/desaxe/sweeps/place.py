"""The place of a store: whether a sweep may write there, and whether the disk has room for it."""

import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..support.files import remove_strays as remove_folders
from ..support.files import require_writable
from ..support.shown import printable
from .layout import size_text
from .request import IDENTITY, Sweep, differences
from .skeleton import INCOMPLETE, STATE, Compared, compared, skeleton_of
from .store import HELD, attributes, create, held, put, remove_strays

if TYPE_CHECKING:
    import xarray as xr

CHUNKS = "chunks"  # the attribute with the layout
SEVERAL = 3  # differences that are named


def kept_at(root: Path, told: Mapping[str, str], overwrite: bool) -> dict[str, Any] | None:
    """The attributes of the store to go on with; None where one is to be made, perhaps in another's place.

    told  what identifies the sweep, and its chunks: a store that differs in these alone is gone on with,
          unless it may be overwritten

    FileExistsError for what may not be replaced, other OSErrors where nothing can be written.
    """
    there = attributes(root)
    if there is None:
        if os.path.lexists(root) and (not root.is_dir() or any(root.iterdir())):
            if attributes(root) is not None:  # put there by another sweep just now
                raise BlockingIOError(f"{printable(root)}: {HELD}")
            raise FileExistsError(f"{printable(root)}: this is no Zarr store; it is left as it is")
        require_writable(root)
        return None
    ours = set(IDENTITY) <= set(there)
    found = differences(there, told) if ours else ["no sweep wrote it"]
    if found and not overwrite:
        raise FileExistsError(
            f"{printable(root)}: a store of another sweep: {'; '.join(found)}. overwrite=True replaces it"
        )
    return None if found or (overwrite and there.get(CHUNKS) != told[CHUNKS]) else there


def require_place(sweep: Sweep, root: Path, overwrite: bool, memory: int | None) -> Sweep | None:
    """The sweep with the chunks of the store to go on with; None where a store is to be made."""
    there = kept_at(root, {**sweep.identity, CHUNKS: json.dumps(sweep.layout.chunk)}, overwrite)
    try:
        kept = None if there is None else sweep._replace(layout=sweep.layout.cut(there.get(CHUNKS)))
        changed = [] if kept is None else _changes(root, partial(_changed, kept, root))
    except ValueError as error:
        kept, changed = None, [str(error)]
    if changed and not overwrite:
        several = "; ".join(changed[:SEVERAL]) + ("; ..." if len(changed) > SEVERAL else "")
        raise FileExistsError(
            f"{printable(root)}: changed since a sweep wrote it: {several}. overwrite=True replaces it"
        )
    if kept is not None and not changed:
        return kept
    sweep.layout.require_memory(memory)
    require_room(sweep, root, sweep.plan.bytes)
    return None


def _changes(root: Path, changes: Callable[[], list[str]]) -> list[str]:
    """The changes of a store; BlockingIOError where another sweep is changing it."""
    if not changes():
        return []
    with held(root):
        return changes()


def _changed(sweep: Sweep, root: Path) -> list[str]:
    """The changes of a store since its sweep wrote it."""
    return _compared(sweep, root).changed


def _compared(sweep: Sweep, root: Path) -> Compared:
    return compared(root, _labelled(sweep), sweep.layout.chunk)


def _labelled(sweep: Sweep) -> "xr.Dataset":
    """The template with all attributes of its store."""
    told = {**sweep.identity, CHUNKS: json.dumps(sweep.layout.chunk), STATE: INCOMPLETE}
    return sweep.template.assign_attrs(told)


def placed(sweep: Sweep, root: Path, overwrite: bool, memory: int | None) -> Sweep:
    """Create the store, or check that the existing one is of this sweep; return the sweep with its chunks."""
    kept = require_place(sweep, root, overwrite, memory)
    if kept is not None:
        lost = _compared(kept, root).lost
        with held(root) if lost else nullcontext():
            put(root, lost)
        return kept
    with free_for(root) as replace:
        create(root, skeleton_of(_labelled(sweep), sweep.layout.chunk), replace)
    return sweep


def clear(root: Path) -> None:
    """Remove what killed writers left, in a store and beside it."""
    remove_strays(root)
    remove_folders(root.parent)


@contextmanager
def free_for(root: Path) -> Iterator[bool]:
    """Hold the store in whose place a new one is made; yields if there is one."""
    if attributes(root) is None:
        yield False
        return
    with held(root):
        yield True


def require_room(sweep: Sweep, root: Path, needed_bytes: int) -> None:
    """OSError if the disk has too little free space for the store."""
    free = free_at(root)
    if needed_bytes > free:
        raise OSError(
            28,
            f"the store takes up to {size_text(needed_bytes)} ({sweep.plan.points:,} points, "
            f"{len(sweep.template.data_vars)} variables), {size_text(free)} are free",
            str(root),
        )


def free_at(root: Path) -> int:
    """Bytes that are free where a store is, or will be."""
    return shutil.disk_usage(next(path for path in root.parents if path.exists())).free
