"""The Zarr store of a sweep: a chunk is whole or absent, whatever stops the writer.

Metadata and coordinates are written beside the store's path and put there in one step; zarr renames a chunk
into its place, and its checksum tells whether it is whole. A store whose metadata or coordinates are others
is refused by their names: it would be read as something that no sweep computed.
"""

import json
import os
import shutil
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.plan import Part
from ..support.extras import explained
from ..support.files import kind_of, locked, remove_strays, require_writable, staging, swap_in
from ..support.memory import size_text
from ..support.shown import printable
from ..support.signals import put_off
from ..support.written import write_whole
from .request import Sweep, differences

with put_off(), explained("a sweep"):
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec
    from zarr.storage import LocalStore, MemoryStore

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
METADATA = "zarr.json"
CHUNKS, STATE = "chunks", "state"  # attributes: the layout, and whether the store is complete
LEVEL = 1  # of zstd: doubles hardly shrink, and this is the fastest
CONSOLIDATED = "Consolidated metadata is currently not part"  # of the format, a warning says
SEVERAL = 3  # differences that are named
DAMAGED = (ValueError, RuntimeError, OSError, LookupError, TypeError, AttributeError)  # what zarr raises


def write_groups(store: Any, parts: "Mapping[str | None, xr.Dataset]", **options: Any) -> None:
    """Write the Dataset of each group to a Zarr store, or into a folder; None is the store itself."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=CONSOLIDATED)
        for group, part in parts.items():
            part.to_zarr(store, mode="a", group=group, consolidated=False, zarr_format=3, **options)
        zarr.consolidate_metadata(store)  # what xarray looks for when it opens the store


def put_group(root: Path, name: str, part: "xr.Dataset") -> None:
    """Put a group into an existing store, whole; it replaces one of that name."""
    with staging(root) as folder:
        write_groups(str(folder / "new"), {name: part})
        swap_in(folder / "new" / name, root / name)
    write_groups(LocalStore(root), {})


def _write_skeleton(sweep: Sweep, store: Any) -> None:
    """Write all of a store but the chunks that the sweep computes."""
    template, chunk = sweep.template, sweep.chunk
    encoding = {
        str(name): {
            "chunks": tuple(chunk[str(dim)] if name not in template.coords else max(1, template.sizes[dim])
                            for dim in variable.dims),
            "compressors": [ZstdCodec(level=LEVEL), Crc32cCodec()],
        }
        for name, variable in template.variables.items()
    }  # fmt: skip
    labelled = template.assign_attrs({**sweep.identity, CHUNKS: json.dumps(chunk), STATE: "incomplete"})
    write_groups(store, {None: labelled}, compute=False, encoding=encoding, safe_chunks=False)


# ---- the store -----------------------------------------------------------------------------------


@contextmanager
def claimed(sweep: Sweep, root: Path, overwrite: bool) -> Iterator[Sweep]:
    """Make the store, or check the existing one, and hold it; yields the sweep with the chunks of the store.

    BlockingIOError where another sweep is writing it, else the errors of `checked`.
    """
    checked(sweep, root, overwrite)
    root.parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        with locked(root.parent):  # whoever makes or replaces a store here
            kept = checked(sweep, root, overwrite)
            if kept is None:
                with _held(root) if root.exists() else nullcontext(), staging(root.parent) as folder:
                    _write_skeleton(sweep, str(folder / root.name))
                    swap_in(folder / root.name, root)
            stack.enter_context(_held(root))
        yield kept or sweep


@contextmanager
def _held(root: Path) -> Iterator[None]:
    try:
        with locked(root, wait=0.0):
            yield
    except TimeoutError:
        raise BlockingIOError(f"{printable(root)}: another sweep is writing this store") from None


def checked(sweep: Sweep, root: Path, overwrite: bool) -> Sweep | None:
    """The sweep with the chunks of the store to go on with; None where a store is to be made.

    FileExistsError for what may not be replaced, OSError where nothing can be written or the disk is too
    small, MemoryError where a chunk takes too much.
    """
    there = attributes(root)
    if there is None:
        if os.path.lexists(root) and (not root.is_dir() or any(root.iterdir())):
            raise FileExistsError(f"{printable(root)}: this is no Zarr store; it is left as it is")
        require_writable(root)
    else:
        try:
            resumed = _resumed(sweep, root, there)
            if not overwrite or resumed.chunk == sweep.chunk:
                return resumed
        except DAMAGED as error:
            if not overwrite:
                why = " ".join(str(error).split())
                raise FileExistsError(
                    f"{printable(root)}: {why}. --overwrite (overwrite=True) replaces it"
                ) from None
    sweep.require_memory()
    require_disk(sweep, root, sweep.plan.bytes)
    return None


def _resumed(sweep: Sweep, root: Path, there: Mapping[str, Any]) -> Sweep:
    """The sweep with the chunks of its store; one of DAMAGED says why for the store of another one."""
    other = differences(there, sweep.identity) if "request" in there else ["no sweep wrote it"]
    if other:
        raise ValueError(f"a store of another sweep: {_several(other)}")
    resumed = sweep.cut(there.get(CHUNKS))
    changed = _changed(resumed, root)
    if changed:
        raise ValueError(f"changed since a sweep wrote it: {_several(changed)}")
    return resumed


def _several(lines: Sequence[str]) -> str:
    return "; ".join(lines[:SEVERAL]) + ("; ..." if len(lines) > SEVERAL else "")


def _changed(sweep: Sweep, root: Path) -> list[str]:
    """The names whose metadata, or values of a coordinate, are not those that the sweep writes."""
    files: dict[str, Any] = {}
    _write_skeleton(sweep, MemoryStore(files))
    for key in files:
        if kind_of(root / key):  # a pipe would be waited for
            raise ValueError(f"{key} is {kind_of(root / key)}")
    names: dict[str, None] = {}
    for consolidated in (True, False):  # the copy that xarray reads, and the one of each array
        here, there = (
            zarr.open_group(store, mode="r", zarr_format=3, use_consolidated=consolidated)
            for store in (MemoryStore(files), LocalStore(root, read_only=True))
        )
        same = all(there.attrs.get(key) == value for key, value in here.attrs.items() if key != STATE)
        names |= {} if same else {"the attributes": None}
        for name, array in here.arrays():
            other: Any = there[name]
            same = other.metadata.to_dict() == array.metadata.to_dict()
            if same and name in sweep.template.coords:
                same = np.array_equal(other[...], np.asarray(array[...]), equal_nan=True)
            names |= {} if same else {name: None}
    return [*names]


def attributes(root: Path) -> dict[str, Any] | None:
    """The attributes of the store in a folder; None where there is no Zarr store."""
    try:
        if not (root / METADATA).is_file():
            return None
        group = json.loads((root / METADATA).read_text(encoding="utf-8"))
        return dict(group["attributes"]) if group["node_type"] == "group" else None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def finish(root: Path) -> None:
    """Mark a store as complete, and remove what killed writers left in it and beside it."""
    group = json.loads((root / METADATA).read_text(encoding="utf-8"))
    if group["attributes"][STATE] != "complete":
        group["attributes"][STATE] = "complete"
        with write_whole(root / METADATA, overwrite=True) as staged:
            staged.write_text(json.dumps(group, indent=2), encoding="utf-8")
    for path in root.rglob("*.partial"):
        path.unlink(missing_ok=True)
    remove_strays(root.parent)


def require_disk(sweep: Sweep, root: Path, size: int) -> None:
    """OSError if the disk has too little free space for `size` bytes of the store."""
    free = free_at(root)
    if size > free:
        raise OSError(
            28,
            f"the store takes up to {size_text(size)} ({sweep.plan.points:,} points, "
            f"{len(sweep.template.data_vars)} variables), {size_text(free)} are free",
            str(root),
        )


def free_at(root: Path) -> int:
    """Bytes that are free where a store is, or will be."""
    return shutil.disk_usage(next(path for path in root.parents if path.exists())).free


# ---- chunks --------------------------------------------------------------------------------------


def absent(sweep: Sweep, root: Path) -> int:
    """The number of chunks that are not in the store; an existing one may still be damaged."""
    return sum(
        any(not _chunk(root, name, part).is_file() for part in block.parts for name in part.step.outputs)
        for block in sweep.plan.blocks(sweep.chunk)
    )


def _chunk(root: Path, name: str, part: Part) -> Path:
    return root.joinpath(name, "c", *map(str, part.place))


def is_whole(root: Path, name: str, part: Part) -> bool:
    """True if the chunk of a part exists and its checksum is right."""
    try:
        if _chunk(root, name, part).is_file():
            zarr.open_array(str(root / name), mode="r", zarr_format=3)[part.region or ...]
            return True
    except DAMAGED:
        pass
    return False


def write_chunk(root: Path, name: str, part: Part, values: Array) -> None:
    """Write the chunk of a part, also where all of it is NaN."""
    with suppress(OSError):
        _chunk(root, name, part).rmdir()  # an empty folder in its place
    array = zarr.open_array(str(root / name), mode="r+", zarr_format=3)
    array.with_config({"write_empty_chunks": True})[part.region or ...] = values
