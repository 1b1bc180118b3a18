"""The chunks of a sweep, and the memory of a chunk while it is computed and written."""

import json
import re
from collections.abc import Mapping
from math import prod
from typing import Any, NamedTuple

from ..evaluation.chunks import chunk_lengths, uniform
from ..mechanism.read import is_numpy_number
from ..support.shown import shown

DEFAULT_MEMORY = 256_000_000  # bytes of the chunks in flight
IN_FLIGHT = 2  # chunks at once that an automatic layout leaves memory for
STORED = 2**21  # points of a stored chunk: 16 MiB of doubles
REDUCED = (2**23, 2**26)  # points of the grid behind a chunk of a reduced one
SHARES = 64  # chunks into which a reduced grid is cut if that keeps it between these
WRITING = 3 * 8  # bytes a point while an array is written: copied, compressed, and masked
UNITS = {"": 1, "B": 1, "kB": 10**3, "MB": 10**6, "GB": 10**9, "TB": 10**12,
         "KiB": 2**10, "MiB": 2**20, "GiB": 2**30, "TiB": 2**40}  # fmt: skip


class Layout(NamedTuple):
    """The dimensions of a store, the length of the chunks along each, and bytes a point in flight."""

    sizes: dict[str, int]
    chunk: dict[str, int]
    per_point: int

    @property
    def chunks(self) -> int:
        """The number of chunks of a variable over all dimensions."""
        return prod(-(-size // self.chunk[name]) for name, size in self.sizes.items())

    @property
    def in_flight(self) -> int:
        """Bytes of one chunk while it is computed and written."""
        return self.per_point * prod(self.chunk.values())

    def at_once(self, memory: int | None) -> int:
        """The number of chunks in flight that fit into this memory, at least one."""
        return max(1, (memory or DEFAULT_MEMORY) // self.in_flight)

    def cut(self, chunk: Any) -> "Layout":
        """The layout with the chunks of an existing store, from its attribute; ValueError for others."""
        names = table_of(chunk)
        if set(names) != set(self.sizes) or not all(type(n) is int and n > 0 for n in names.values()):
            raise ValueError(f"its chunks are {shown(chunk)}")
        return self._replace(chunk={name: names[name] for name in self.sizes})

    def require_memory(self, memory: int | None) -> None:
        """MemoryError where a chunk takes more memory than is allowed."""
        if memory is not None and self.in_flight > memory:
            raise MemoryError(
                f"memory: a chunk of {shape_text(self.chunk)} takes {size_text(self.in_flight)} while it is "
                f"computed and written, {size_text(memory)} are allowed; give smaller chunks or more memory"
            )


def layout_of(
    chunks: Any, sizes: Mapping[str, int], stored: int, length: int | None, memory: int | None
) -> Layout:
    """The layout of a sweep, from the request alone.

    sizes   the dimensions of the store
    stored  bytes that are stored for each of its points
    length  points of the reduced axis behind each of them, None where nothing is reduced
    """
    per_point = stored + WRITING + 8 * len(sizes)
    points = (memory or DEFAULT_MEMORY) // (IN_FLIGHT * per_point)
    if length is None:
        points = min(STORED, points)
    else:
        least, most = REDUCED
        behind = min(max(prod(sizes.values()) * length // SHARES, least), most)
        points = min(max(1, behind // max(length, 1)), points)
    if points < 1:
        raise MemoryError(f"memory = {memory} bytes: a single point takes {IN_FLIGHT * per_point}")
    return Layout(dict(sizes), uniform(chunk_lengths(chunks, sizes, points)), per_point)


def bytes_of(memory: Any) -> int | None:
    """A number of bytes, or text such as "200 MB"; None stays None."""
    if memory is None:
        return None
    if isinstance(memory, str):
        found = re.fullmatch(r"\s*((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][0-9]{1,2})?)\s*([A-Za-z]*)\s*", memory)
        unit = found and next((u for u in UNITS if u.lower() == found[2].lower()), None)
        if found is None or unit is None:
            raise ValueError(f'memory = {shown(memory)}: a number of bytes, or text such as "200 MB"')
        number = float(found[1]) * UNITS[unit]
    elif isinstance(memory, bool) or not (isinstance(memory, (int, float)) or is_numpy_number(memory)):
        raise TypeError(f'memory = {shown(memory)}: a number of bytes, or text such as "200 MB"')
    else:
        number = float(max(min(memory, 2**63), -1))
    if not 1.0 <= number < 2.0**63:
        raise ValueError(f"memory = {shown(memory)}: at least one byte, less than 2^63")
    return int(number)


def size_text(count: float) -> str:
    """A number of bytes as text, in kB, MB, GB or TB."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if count < 1000.0:
            return f"{count:.0f} bytes" if unit == "bytes" else f"{count:.3g} {unit}"
        count /= 1000.0
    return f"{count:.3g} TB"


def shape_text(chunk: Mapping[str, int]) -> str:
    """The shape of a chunk as text."""
    return " x ".join(f"{length} {name}" for name, length in chunk.items()) or "one point"


def table_of(value: Any) -> dict[str, Any]:
    """A table, or the text of one; empty for anything else, as in a damaged store."""
    try:
        found = json.loads(value) if isinstance(value, str) else value
    except (ValueError, RecursionError):
        return {}
    return dict(found) if isinstance(found, Mapping) else {}
