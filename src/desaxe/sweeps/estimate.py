"""Size, time and free disk of a sweep before it starts; the time from a trial of its kernels."""

import time
from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

from numpy.typing import NDArray

from ..evaluation.lazy import AnyPart
from .layout import Layout, shape_text, size_text
from .peaks import PeakPart

TRIAL = 2**17  # points of a trial
STORING = 6e-9  # s to compress, check and write a byte, on one core
CHUNK = 2.5e-3  # s for the file of a chunk of a variable, besides its bytes


def seconds_of(parts: Sequence[AnyPart | PeakPart], axes: Mapping[str, NDArray[Any]], stored: int) -> float:
    """The expected time on one core, from running every part at some of its points; `stored` in bytes."""
    total = STORING * stored
    for part in parts:
        values, left = {}, TRIAL
        for name in reversed(part.axes):
            length = min(axes[name].size, max(1, left))
            values[name], left = axes[name][:length], left // length
        part.compute(values)  # compiles, or loads
        start = time.perf_counter()
        part.compute(values)
        share = prod(axis.size for axis in values.values()) / prod(axes[name].size for name in part.axes)
        total += (time.perf_counter() - start) / share
    return total


def announcement(points: int, variables: int, stored: int, layout: Layout, seconds: float, free: int) -> str:
    """A line of text about a sweep before it starts."""
    return (
        f"{points:,} points, {variables} variables, at most {size_text(stored)} in {layout.chunks:,} chunks "
        f"of {shape_text(layout.chunk)}; about {time_text(seconds)}; {size_text(free)} free"
    )


def time_text(seconds: float) -> str:
    """A time as text, in s, min or h."""
    if seconds < 120.0:
        return f"{seconds:.1f} s" if seconds < 10.0 else f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
