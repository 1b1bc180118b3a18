"""The chunks of a sweep, and the memory of a chunk while it is computed and written."""

import json
from collections.abc import Mapping
from math import prod
from typing import Any, NamedTuple

from ..evaluation.chunks import chunk_lengths, uniform
from ..support.memory import size_text
from ..support.shown import shown

DEFAULT_MEMORY = 256_000_000  # bytes of the chunks in flight
IN_FLIGHT = 2  # chunks at once that an automatic layout leaves memory for
STORED = 2**21  # points of a stored chunk: 16 MiB of doubles
REDUCED = 2**23  # points of the grid behind a chunk of a reduced one
MOST_CHUNKS, FEWEST_POINTS = 10_000, 1_000  # beyond these the memory allowed is a slip: a file a chunk
WRITING = 3 * 8  # bytes a point while an array is written: copied, compressed, and masked


class Layout(NamedTuple):
    """The dimensions of a store, the length of its chunks, bytes a point in flight, and their limit."""

    sizes: dict[str, int]
    chunk: dict[str, int]
    per_point: int
    memory: int | None

    @property
    def chunks(self) -> int:
        """The number of chunks of a variable over all dimensions."""
        return prod(-(-size // self.chunk[name]) for name, size in self.sizes.items())

    @property
    def in_flight(self) -> int:
        """Bytes of one chunk while it is computed and written."""
        return self.per_point * prod(self.chunk.values())

    @property
    def at_once(self) -> int:
        """The number of chunks in flight that fit into the memory, at least one."""
        return max(1, min(self.chunks, (self.memory or DEFAULT_MEMORY) // self.in_flight))

    @property
    def shape(self) -> str:
        """The shape of a chunk as text."""
        return " x ".join(f"{length} {name}" for name, length in self.chunk.items()) or "one point"

    def cut(self, chunk: Any) -> "Layout":
        """The layout with the chunks of an existing store, from its attribute; ValueError for others."""
        try:
            lengths = json.loads(chunk)
            if set(lengths) == set(self.sizes) and all(type(n) is int and n > 0 for n in lengths.values()):
                return self._replace(chunk={name: lengths[name] for name in self.sizes})
        except (ValueError, TypeError, AttributeError, RecursionError):
            pass
        raise ValueError(f"its chunks are {shown(chunk)}")

    def require_memory(self) -> None:
        """MemoryError where a chunk takes more memory than is allowed."""
        if self.memory is not None and self.in_flight > self.memory:
            raise MemoryError(
                f"memory: a chunk of {self.shape} takes {size_text(self.in_flight)} while it is computed and "
                f"written, {size_text(self.memory)} are allowed; give smaller chunks or more memory"
            )


def layout_of(
    chunks: Any, sizes: Mapping[str, int], stored: int, behind: int | None, memory: int | None
) -> Layout:
    """The layout of a sweep, from the request alone.

    sizes   the dimensions of the store
    stored  bytes that are stored for each of its points
    behind  points of the reduced axes behind each of them, None where nothing is reduced
    """
    per_point = stored + WRITING + 8 * len(sizes)
    most = STORED if behind is None else max(1, REDUCED // max(behind, 1))
    points = min(most, (memory or DEFAULT_MEMORY) // (IN_FLIGHT * per_point))
    if points < 1:
        raise MemoryError(f"memory = {memory} bytes: a single point takes {IN_FLIGHT * per_point}")
    layout = Layout(dict(sizes), uniform(chunk_lengths(chunks, sizes, points)), per_point, memory)
    if chunks == "auto" and memory is not None and layout.chunks > MOST_CHUNKS and points < FEWEST_POINTS:
        raise MemoryError(
            f"memory: {size_text(memory)} make {layout.chunks} chunks of {points} points, a file each; "
            'give more, such as "100 MB"'
        )
    return layout
