"""The Zarr store of a sweep: a chunk is whole or absent, whatever stops the writer.

The skeleton (metadata, coordinates, attributes) is written beside the store's place and put there in one
step. A chunk is written to a `.partial` file, flushed to the disk and renamed; its checksum tells whether
it is whole. Nothing in a finished store depends on when, where, how often or by how many it was written.
"""

import asyncio
import json
import os
import shutil
import sys
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.labels import import_xarray
from ..support.extras import explained
from ..support.files import exchange, staging
from ..support.forks import IMPORTS
from ..support.locks import locked
from ..support.shown import printable
from ..support.signals import put_off
from .skeleton import METADATA, STATE, with_state

with put_off(), explained("a sweep"):
    import zarr
    from zarr.core.buffer import Buffer
    from zarr.storage import LocalStore

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
PARTIAL = ".partial"
HELD = "another sweep is writing this store"


class DurableStore(LocalStore):
    """A folder whose files appear whole, and stay after a power failure."""

    async def set(self, key: str, value: Buffer) -> None:
        """Write a file."""
        await asyncio.to_thread(self.set_sync, key, value)

    def set_sync(self, key: str, value: Buffer) -> None:
        """Write a file, in the calling thread."""
        write_durably(Path(self.root) / key, value.to_bytes())


def write_durably(path: Path, data: bytes) -> None:
    """Write a file that appears whole, and stays after a power failure."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.{uuid.uuid4().hex}{PARTIAL}")
    try:
        with open(partial, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        with suppress(OSError):
            path.rmdir()  # an empty folder in its place
        os.replace(partial, path)
    except BaseException as error:
        with suppress(OSError):
            partial.unlink()
        if isinstance(error, OSError) and error.filename is None:  # of a write to a full disk
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def sync(folder: Path) -> None:
    """See to it that the names in a folder survive a power failure, where the system can."""
    if sys.platform != "win32":
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


# ---- the skeleton --------------------------------------------------------------------------------


def create(root: Path, files: Mapping[str, bytes], replace: bool) -> None:
    """Create a store of these files; `replace` an existing one.

    BlockingIOError where there is one and it may not be replaced.
    """
    with staging(root.parent) as folder:
        staged = folder / root.name
        put(staged, files)
        sync_folders(staged)
        if not replace:
            _rename(staged, root)
        elif not exchange(staged, root):
            shutil.rmtree(root)
            os.rename(staged, root)
        sync(root.parent)


def _rename(staged: Path, root: Path) -> None:
    """Put a store where nothing or an empty folder is; BlockingIOError where another sweep has put one."""
    try:
        if sys.platform == "win32" and root.is_dir():  # elsewhere an empty folder is replaced in one step
            root.rmdir()
        os.rename(staged, root)
    except OSError:
        if attributes(root) is None:
            raise
        raise BlockingIOError(f"{printable(root)}: {HELD}") from None


def put(root: Path, files: Mapping[str, bytes]) -> None:
    """Write files of a store by their places."""
    for place, data in files.items():
        write_durably(root / place, data)


def attributes(root: Path) -> dict[str, Any] | None:
    """The attributes of the store in a folder; None where there is no Zarr store."""
    try:
        if not (root / METADATA).is_file():
            return None
        found = json.loads((root / METADATA).read_text(encoding="utf-8"))
        return dict(found["attributes"]) if found["node_type"] == "group" else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def set_state(root: Path, state: str) -> None:
    """Write the state (complete or not) into the store's attributes, if it differs."""
    path = root / METADATA
    metadata = path.read_bytes()
    if json.loads(metadata)["attributes"].get(STATE) != state:
        write_durably(path, with_state(metadata, state))
        sync(root)


@contextmanager
def held(root: Path) -> Iterator[None]:
    """Hold the store for the length of a block; BlockingIOError where another sweep does."""
    try:
        with locked(root, wait=0.0):
            yield
    except TimeoutError:
        raise BlockingIOError(f"{printable(root)}: {HELD}") from None


# ---- chunks --------------------------------------------------------------------------------------


def _array(root: Path, name: str, mode: str) -> Any:
    return zarr.open_array(DurableStore(root, read_only=mode == "r"), path=name, mode=mode, zarr_format=3)


def write_chunk(root: Path, name: str, region: Sequence[slice], values: Array) -> None:
    """Write a chunk of a variable, also where all of it is NaN."""
    if values.dtype.kind == "f":
        np.copyto(values, np.nan, where=np.isnan(values))  # one NaN: others have bits that machines choose
    array = _array(root, name, "r+").with_config({"write_empty_chunks": True})
    array[tuple(region) if region else ...] = values


def chunk_path(root: Path, name: str, place: Sequence[int]) -> Path:
    """The file of a chunk."""
    return root.joinpath(name, "c", *map(str, place))


def is_whole(root: Path, name: str, place: Sequence[int], region: Sequence[slice]) -> bool:
    """True if a chunk exists and its checksum is right."""
    if not chunk_path(root, name, place).is_file():
        return False
    try:
        _array(root, name, "r")[tuple(region) if region else ...]
    except (ValueError, RuntimeError, OSError):
        return False
    return True


def remove_strays(root: Path) -> None:
    """Remove what a writer that was killed left behind."""
    for path in root.rglob(f"*{PARTIAL}"):
        with suppress(FileNotFoundError):
            path.unlink()


def sync_folders(root: Path) -> None:
    """See to it that the names of all files survive a power failure."""
    for path in (root, *(path for path in root.rglob("*") if path.is_dir())):
        sync(path)


def open_store(root: Path) -> "xr.Dataset":
    """The Dataset of a store, its variables as lazy Dask arrays."""
    import_xarray()
    with IMPORTS:
        import xarray

    found: xr.Dataset = xarray.open_zarr(root)
    return found
