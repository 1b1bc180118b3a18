"""The skeleton of a store, all of it but the chunks that a sweep computes: what it must be, and what it is.

What is lost or unreadable is written again. What says something else (another unit, type or coordinate) is
named and never passed: the store would be read as something that no sweep computed.
"""

import hashlib
import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..support.extras import explained
from ..support.signals import put_off

with put_off(), explained("a sweep"):
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec
    from zarr.core.metadata.v3 import ArrayV3Metadata
    from zarr.storage import LocalStore, MemoryStore

if TYPE_CHECKING:
    import xarray as xr

METADATA = "zarr.json"
STATE = "state"  # an attribute: whether the store is complete
INCOMPLETE, COMPLETE = "incomplete", "complete"
LEVEL = 1  # of zstd: doubles hardly shrink, and this is the fastest
CONSOLIDATED = "Consolidated metadata is currently not part"  # of the format, a warning says
UNREADABLE = (ValueError, RuntimeError, OSError, KeyError, TypeError)


class Compared(NamedTuple):
    """The files of a skeleton that a store lacks or that are damaged, and what others of it say instead."""

    lost: dict[str, bytes]
    changed: list[str]


def skeleton_of(template: "xr.Dataset", chunk: Mapping[str, int]) -> dict[str, bytes]:
    """The files of a store by their places, but for the chunks of lazy variables."""
    encoding = {
        str(name): {
            "chunks": tuple(
                chunk[str(dim)] if name not in template.coords else max(1, template.sizes[dim])
                for dim in variable.dims
            ),
            "compressors": [ZstdCodec(level=LEVEL), Crc32cCodec()],
        }
        for name, variable in template.variables.items()
    }
    files: dict[str, Any] = {}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=CONSOLIDATED)
        template.to_zarr(
            MemoryStore(files), mode="w-", compute=False, encoding=encoding, zarr_format=3, consolidated=True,
            safe_chunks=False,
        )  # fmt: skip
    group = json.loads(files.pop(METADATA).to_bytes())
    arrays = group["consolidated_metadata"]["metadata"]  # in an order that depends on the process
    group["consolidated_metadata"]["metadata"] = {name: arrays[name] for name in encoding}
    return {METADATA: as_json(group)} | {place: data.to_bytes() for place, data in files.items()}


def with_state(metadata: bytes, state: str) -> bytes:
    """The metadata of a group whose store is complete, or is not."""
    group = json.loads(metadata)
    group["attributes"][STATE] = state
    return as_json(group)


def as_json(metadata: Mapping[str, Any]) -> bytes:
    """Metadata as the text of a file."""
    return json.dumps(metadata, indent=2).encode()


def compared(root: Path, template: "xr.Dataset", chunk: Mapping[str, int]) -> Compared:
    """The differences of a store from the skeleton of a template."""
    found = Compared({}, [])
    for place, data in skeleton_of(template, chunk).items():
        there, name = _bytes(root / place), place.rpartition("/")[0].partition("/")[0]
        if there == data or (place == METADATA and there == with_state(data, COMPLETE)):
            continue
        if place.endswith(METADATA):
            facts, wanted = _facts(there), _facts(data)
        else:
            facts = None if there is None else _values(root, name)
            wanted = {"sha256": _digest(template[name].values.tobytes())}
        if facts is None or facts == wanted:  # the same in other bytes
            found.lost[place] = data
        else:
            found.changed.extend(_differences(name, facts, wanted))
    return found


def _facts(metadata: bytes | None) -> dict[str, Any] | None:
    """The facts in the metadata of a group or an array, of any version; None for anything else."""
    try:
        found = json.loads(metadata or b"")
        if found["node_type"] == "array":
            return ArrayV3Metadata.from_dict(found).to_dict()
        arrays = found["consolidated_metadata"]["metadata"].items()
        facts = {f"attributes.{key}": value for key, value in found["attributes"].items() if key != STATE}
        return {**facts, **{name: ArrayV3Metadata.from_dict(one).to_dict() for name, one in arrays}}
    except UNREADABLE:
        return None


def _values(root: Path, name: str) -> dict[str, str] | None:
    """The values of an array, by a digest; None where they cannot be read."""
    try:
        array = zarr.open_array(LocalStore(root, read_only=True), path=name, mode="r", zarr_format=3)
        return {"sha256": _digest(np.asarray(array[...]).tobytes())}
    except UNREADABLE:
        return None


def _bytes(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def _differences(where: str, there: Any, here: Any) -> list[str]:
    """The differences of facts, one by one; a group may have more than these."""
    if not (isinstance(there, Mapping) and isinstance(here, Mapping)):
        return [f"{where} is {json.dumps(there, default=str)} there and {json.dumps(here, default=str)} here"]
    keys = dict.fromkeys((*here, *(there if where else ())))
    pairs = {f"{where}.{key}".lstrip("."): (there.get(key), here.get(key)) for key in keys}
    return [
        line for key, (one, other) in pairs.items() if one != other for line in _differences(key, one, other)
    ]
