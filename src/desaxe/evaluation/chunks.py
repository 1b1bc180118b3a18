"""The chunks of a grid, from the request alone: every machine cuts alike."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import prod
from typing import Any

import numpy as np

from ..mechanism.inputs import INPUTS
from ..mechanism.spelling import did_you_mean

Slices = dict[str, slice]


def chunk_lengths(chunks: Any, sizes: Mapping[str, int], points: int) -> dict[str, tuple[int, ...]]:
    """The lengths of the chunks along each dimension.

    chunks  "auto": about `points` points each, the last dimensions whole; a number: that length along
            every dimension, -1 for the whole; or a dict dimension -> a number, "auto" or the lengths.
            Dimensions that it does not name are whole
    sizes   the length of each dimension, in their order

    Raises ValueError or TypeError that names the dimension.
    """
    if isinstance(chunks, Mapping):
        for name in chunks:
            if name not in sizes:
                known = ", ".join(sizes) or "none"
                raise ValueError(
                    f"chunks: {name!r} is not a dimension of this grid"
                    f"{' (it is a number, or reduced)' if name in INPUTS else ''}; "
                    f"{did_you_mean(str(name), list(sizes))}dimensions: {known}"
                )
        requested = {name: chunks.get(name, -1) for name in sizes}
    else:
        requested = dict.fromkeys(sizes, chunks)
        if not sizes and not _is_auto(chunks):  # checked, though nothing is left to cut
            _lengths("every axis", chunks, 1)
    known_lengths = {n: _lengths(n, w, sizes[n]) for n, w in requested.items() if not _is_auto(w)}
    room = max(1, points // prod(max(own, default=1) or 1 for own in known_lengths.values()))
    for name in reversed([name for name in sizes if name not in known_lengths]):
        length = min(max(sizes[name], 1), room)
        known_lengths[name] = _cut(sizes[name], length)
        room = max(1, room // length)
    return {name: known_lengths[name] for name in sizes}


def uniform(lengths: Mapping[str, Sequence[int]]) -> dict[str, int]:
    """The uniform chunk length along each dimension; ValueError if the lengths differ.

    The last chunk of a dimension may be shorter: a store has chunks of one length.
    """
    for name, own in lengths.items():
        if any(length != own[0] for length in own[:-1]) or (own and own[-1] > own[0]):
            raise ValueError(f"chunks of {name}: {_shown(own)}: a store has chunks of one length")
    return {name: max(own[0], 1) if own else 1 for name, own in lengths.items()}


def longest(lengths: Mapping[str, Sequence[int]]) -> dict[str, int]:
    """The longest chunk of each dimension."""
    return {name: max(1, *own) for name, own in lengths.items()}


def blocks_of(sizes: Mapping[str, int], chunk: Mapping[str, int]) -> Iterator[tuple[dict[str, int], Slices]]:
    """All chunks in order: the index and the slice along each dimension."""
    for index in product(*(range(-(-size // chunk[name])) for name, size in sizes.items())):
        places = dict(zip(sizes, index, strict=True))
        ends = {name: min((k + 1) * chunk[name], sizes[name]) for name, k in places.items()}
        yield places, {name: slice(k * chunk[name], ends[name]) for name, k in places.items()}


def _is_auto(requested: Any) -> bool:
    return isinstance(requested, str) and requested == "auto"


def _lengths(name: str, requested: Any, size: int) -> tuple[int, ...]:
    if isinstance(requested, (tuple, list)):
        own = tuple(_length(name, part, size) for part in requested)
        if sum(own) != size:
            raise ValueError(f"chunks of {name}: {_shown(own)} is {sum(own)} points, it has {size}")
        return own
    return _cut(size, _length(name, requested, size))


def _length(name: str, requested: Any, size: int) -> int:
    if requested is None or requested == -1:
        return max(size, 1)
    if isinstance(requested, bool) or not hasattr(requested, "__index__") or np.ndim(requested):
        raise TypeError(f'chunks of {name} = {requested!r}: a whole number, "auto" or -1 for the whole')
    if int(requested) < 1:
        raise ValueError(f'chunks of {name} = {requested}: at least 1, "auto" or -1 for the whole')
    return min(int(requested), max(size, 1))


def _cut(size: int, length: int) -> tuple[int, ...]:
    rest = size % length
    return (length,) * (size // length) + ((rest,) if rest or not size else ())


def _shown(own: Sequence[int]) -> str:
    text = ", ".join(map(str, own[:8]))
    return f"({text}{', ...' if len(own) > 8 else ''})"
