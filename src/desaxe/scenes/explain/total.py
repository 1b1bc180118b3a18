"""Times of a whole run, the first and later ones: grid, peaks, pictures, files, start-up.

The times are of a quiet machine; `explain` has run nothing.
"""

from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

from ...peaks.compiled import BREAK_EVEN
from ...sweeps.estimate import STORING
from ..content import Content, Peak
from . import estimate

STARTUP = 1.2  # s for NumPy, xarray and the scene in a new process
DRAWING = 1.0  # s to import matplotlib
PICTURE = 0.15  # s to draw and write a picture
PEAK_COMPILE = 6.0  # s to compile the search for a quantity
PEAK = 1.5e-6  # s for a design by the compiled search
NUMPY_PEAK, NUMPY_START = 1e-5, 2e-2  # s for one by NumPy, and for the first
STEADY, STEADY_START = 1e-3, 0.1  # s for a steady state, and for the first
CELL = 0.9e-6  # s for a number in a CSV file
FILES = {".nc": 3e-9, ".zarr": 8e-9, ".npz": 1e-9}  # s a byte
FILE = 0.05  # s to open one
CHECK = 2e-3  # s for a printed value


class RunTime(NamedTuple):
    """Seconds of a part of a run: of the first run, and of later ones, which find compiled code on disk."""

    what: str
    first: float
    later: float


def costs_of(content: Content, run: Mapping[str, Any] | None, cells: int, stored: int) -> list[RunTime]:
    """The parts of a run that take time.

    run     how the grid runs, None where there is none
    cells   numbers of the labelled result
    stored  bytes of a store, 0 without one
    """
    costs = [RunTime("start", STARTUP, STARTUP)]
    if run is not None:
        seconds, compiled = run["seconds"], run["way"] == "compiled"
        later = min(seconds["before_the_first"], estimate.LOAD) if compiled else 0.0
        work = seconds["expected"]
        costs.append(RunTime("grid", seconds["before_the_first"] + work, later + work))
    quantities: set[str] = set()
    for peak in content.peaks:
        costs.append(_peak(peak, peak.quantity in quantities, content.store is not None))
        quantities.add(peak.quantity)
    if content.steady is not None:
        time = STEADY_START + STEADY * prod(len(values) for values in content.steady.axes.values())
        costs.append(RunTime("steady state", time, time))
    if content.checks:
        time = CHECK * len(content.checks)
        costs.append(RunTime("printed values", time, time))
    if content.store is not None:
        time = STORING * stored / (run["threads"] if run is not None else 1)
        costs.append(RunTime(f"store {content.store}", time, time))
    if content.data is not None:
        costs.append(_file(content.data, cells))
    if content.pictures:
        time = DRAWING + PICTURE * len(content.pictures)
        costs.append(RunTime("pictures", time, time))
    return costs


def _peak(peak: Peak, known: bool, stored: bool) -> RunTime:
    """A peak: many compile the search of the quantity; fewer run in NumPy."""
    designs = prod(len(values) for values in peak.axes.values()) + len(peak.claims) + bool(peak.baseline)
    what = f"{peak.kind} of {peak.quantity}"
    if designs < BREAK_EVEN and not stored:
        time = NUMPY_START + NUMPY_PEAK * designs
        return RunTime(what, time, time)
    work = PEAK * designs
    return RunTime(what, work + (0.0 if known else PEAK_COMPILE), work + (0.0 if known else estimate.LOAD))


def _file(name: str, cells: int) -> RunTime:
    suffix = Path(name).suffix
    time = FILE + (CELL * cells if suffix == ".csv" else FILES[suffix] * 8 * cells)
    return RunTime(name, time, time)


def work_besides(content: Content) -> list[dict[str, Any]]:
    """The work besides the grid: peaks, pictures, checks."""
    found: list[dict[str, Any]] = []
    for peak in content.peaks:
        designs = prod(len(values) for values in peak.axes.values())
        how = "refined over theta by its derivative"
        found.append(
            {"what": f"{peak.kind} of {peak.quantity}", "count": designs, "of": "designs", "how": how}
        )
    if content.steady is not None:
        designs = prod(len(values) for values in content.steady.axes.values())
        how = "periodic motions by Newton's method, in NumPy"
        found.append({"what": "steady state on a motor", "count": designs, "of": "designs", "how": how})
    for picture in content.pictures:
        points = prod(len(value) for value in picture.inputs.values() if isinstance(value, tuple))
        how = f"drawn to {picture.file}"
        found.append({"what": f"picture of {picture.quantity}", "count": points, "of": "points", "how": how})
    if content.checks:
        how = "single points in plain Python"
        found.append({"what": "printed values", "count": len(content.checks), "of": "points", "how": how})
    return found
