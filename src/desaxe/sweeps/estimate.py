"""Size, time and free disk of a sweep before it starts; the time from a trial of its kernels."""

import time
from math import prod

from ..evaluation.plan import Plan, computed
from .layout import Layout, shape_text, size_text

TRIAL = 2**17  # points of a trial
STORING = 6e-9  # s to compress, check and write a byte, on one core
CHUNK = 2.5e-3  # s for the file of a chunk of a variable, besides its bytes


def seconds_of(plan: Plan) -> float:
    """The expected time on one core, from running every step at some of its points."""
    total, axes = STORING * plan.bytes, plan.outer.axes
    for step in plan.all:
        values, left = {}, TRIAL
        for name in reversed(step.axes):
            length = min(axes[name].size, max(1, left))
            values[name], left = axes[name][:length], left // length
        computed(step, values)  # compiles, or loads
        start = time.perf_counter()
        computed(step, values)
        share = prod(axis.size for axis in values.values()) / prod(axes[name].size for name in step.axes)
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
