"""Running a scene: values over the grid, peaks, checks, feasibility, files."""

from collections.abc import Mapping
from importlib import import_module
from itertools import pairwise
from math import pi, prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from ..design.feasibility.feasibility import feasibility
from ..evaluation.evaluate import evaluate
from ..evaluation.grid import grid
from ..evaluation.in_units import in_units
from ..evaluation.labels import with_loads
from ..loads.load import Load
from ..mechanism.unit_system import UnitSystem
from ..support.extras import needed
from ..support.files import check_target
from ..support.progress import Progress, Steps
from .content import Check, Content, Peak, Picture
from .files import check_place, requirements_of, write
from .peaks import PeakResult, batches, columns_of, peaks_in_units, peaks_of, provenance
from .stored import sweep_content
from .values import Value

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 5_000_000  # points of the grid between two reports of progress
MOST_BATCHES = 1_000  # of peaks that a run shows beside a store
MOST_DESIGNS = 10_000_000  # that are looked at for feasibility; a sweep has the margin of all
MOST_SHOWN = 100  # designs that cannot turn fully, looked at one by one


class CheckResult(NamedTuple):
    """A printed value and the computed one, in SI units."""

    check: Check
    computed: float
    agrees: bool


class Infeasible(NamedTuple):
    """A design that cannot turn fully, and the ranges of crank angles [rad] that it cannot reach."""

    design: dict[str, float]
    gaps: tuple[tuple[float, float], ...]


class FeasibilityResult(NamedTuple):
    """The number of designs that turn fully, and the first ones that do not.

    `limit` is the largest |ec| with which the crank turns fully [m], where AB and BC are numbers.
    """

    designs: int
    turning: int
    infeasible: tuple[Infeasible, ...]
    limit: float | None


class Run(NamedTuple):
    """The results of a run."""

    dataset: "xr.Dataset | None"
    checks: tuple[CheckResult, ...]
    peaks: tuple[PeakResult, ...]
    feasibility: FeasibilityResult | None
    files: tuple[Path, ...]


def run(content: Content, watch: Progress | None, shown_in: UnitSystem) -> Run:
    """Compute, write and draw all that a scene asks for; pictures in the units shown."""
    _require_rooms(content)
    _check_files(content)
    stored = content.store is not None
    blocks = _blocks(content) if content.outputs and not stored else []
    parts = sum(batches(one) for one in content.peaks)
    shown = content.peaks if not stored or parts <= MOST_BATCHES else ()  # all of them are in the store
    parts = (parts if shown else 0) + stored
    steps = Steps(len(blocks) + parts + len(content.pictures) + (content.data is not None), watch)
    checks = tuple(_check(check, content) for check in content.checks)
    dataset = None
    if stored:
        steps.next(f"sweeping into {content.store}")
        dataset = sweep_content(content, watch=_no_watch)
    elif content.outputs:
        dataset = in_units(_values(content, blocks, steps), content.units)
    peaks = tuple(_peaks(one, content, steps) for one in shown)
    files = []
    if content.data is not None:
        steps.next(f"writing {content.data}")
        files = write(
            Path(content.data),
            dataset,
            dict(zip(group_names(peaks), (f.dataset for f in peaks), strict=True)),
        )
    files += [_picture(picture, content, shown_in, steps) for picture in content.pictures]
    steps.next("")
    return Run(dataset, checks, peaks, _feasibility(content.inputs), tuple(files))


def _peaks(one: Peak, content: Content, steps: Steps) -> PeakResult:
    """Peaks in the units of the scene."""
    found = peaks_of(one, content, steps)
    return found._replace(dataset=peaks_in_units(found, content.units))


def _no_watch(done: int, total: int, what: str) -> None:
    """The steps of the run are shown, not the points of the sweep."""


def _require_rooms(content: Content) -> None:
    """Fail early if an optional dependency is missing."""
    rooms = {"outputs": "xarray"} if content.outputs else {}
    rooms |= {"results.store": "zarr", "a results.store": "dask"} if content.store is not None else {}
    rooms |= {"[[peak]]": "xarray"} if content.peaks else {}
    rooms |= requirements_of(content.data) if content.data is not None else {}
    rooms |= (
        {"[[picture]]": "matplotlib", "the values of a [[picture]]": "xarray"} if content.pictures else {}
    )
    for what, module in rooms.items():
        with needed(what):
            import_module(module)


def _check_files(content: Content) -> None:
    """Fail early if an output file cannot be written."""
    if content.data is not None:
        check_place(Path(content.data))
    for picture in content.pictures:
        check_target(Path(picture.file))


# ---- the grid ------------------------------------------------------------------------------------


def _blocks(content: Content) -> list[tuple[int, int]]:
    """Blocks of the first axis, so that a large grid can report its progress."""
    lengths = [len(value) for value in content.inputs.values() if isinstance(value, tuple)]
    first = lengths[0] if lengths and content.reduction is None else 1
    count = max(1, min(first, prod(lengths) // BLOCK))
    return list(pairwise(first * k // count for k in range(count + 1)))


def _values(content: Content, blocks: list[tuple[int, int]], steps: Steps) -> "xr.Dataset":
    """The requested outputs over the outer product of all inputs."""
    options = grid_options(content)
    arrays = _arrays(content.inputs)
    if content.reduction is not None:
        axis, kinds = content.reduction
        steps.next("values")
        reduced: Any = grid(content.outputs, reduce={axis: kinds}, **options, **arrays)
        return cast("xr.Dataset", reduced.assign_attrs(provenance(content)))
    first = next((name for name, value in arrays.items() if isinstance(value, np.ndarray)), "")
    whole: Any = None
    for start, stop in blocks:
        steps.next("values")
        if len(blocks) == 1:
            whole = grid(content.outputs, **options, **arrays)
            break
        part: Any = grid(content.outputs, **options, **{**arrays, first: arrays[first][start:stop]})
        whole = _longer(part, first, arrays[first]) if whole is None else whole
        for name, values in part.data_vars.items():
            whole[name].values[slice(start, stop) if first in values.dims else ...] = values.values
    if len(blocks) > 1:
        loads = {name: value for name, value in content.inputs.items() if isinstance(value, Load)}
        whole = with_loads(whole, loads)
    labelled: xr.Dataset = whole.assign_attrs(provenance(content))
    return labelled


def _longer(part: "xr.Dataset", first: str, values: NDArray[np.float64]) -> "xr.Dataset":
    """An empty dataset like a block of it, with all values along its first axis."""
    import xarray

    sizes = {**part.sizes, first: values.size}
    empty = {
        name: (array.dims, np.empty([sizes[d] for d in array.dims], array.dtype), array.attrs)
        for name, array in part.data_vars.items()
    }
    others = {name: array for name, array in part.coords.items() if first not in array.dims}
    coordinates = {**others, first: (first, values, part[first].attrs)}
    return xarray.Dataset(empty, coordinates, part.attrs)


def grid_options(content: Content) -> dict[str, Any]:
    """The options of this scene's grid."""
    return {"branch": content.branch, "accuracy": content.accuracy, "threads": content.threads}


def _arrays(inputs: Mapping[str, Value]) -> dict[str, Any]:
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}


# ---- checks and feasibility ----------------------------------------------------------------------


def _check(check: Check, content: Content) -> CheckResult:
    design: dict[str, Any] = {**check.inputs, "branch": content.branch, "accuracy": content.accuracy}
    computed = float(evaluate(check.quantity, **design))
    return CheckResult(check, computed, check.printed.agrees(computed))


def _feasibility(inputs: Mapping[str, Value]) -> FeasibilityResult | None:
    """The feasibility of the scene's designs; None without all lengths, or for too many designs."""
    lengths = {name: value for name, value in inputs.items() if name in ("ec", "AB", "BC")}
    count = prod(len(value) for value in lengths.values() if isinstance(value, tuple))
    if len(lengths) < 3 or count > MOST_DESIGNS:
        return None
    columns: dict[str, Any] = columns_of(lengths)
    margins: Any = evaluate("margin", **columns)
    rows = np.flatnonzero(margins < 0.0)
    designs = [{name: float(column[row]) for name, column in columns.items()} for row in rows[:MOST_SHOWN]]
    found = tuple(Infeasible(one, _gaps(feasibility(**one)["theta_intervals"])) for one in designs)
    AB, BC = inputs["AB"], inputs["BC"]
    limit = (
        None
        if isinstance(AB, tuple) or isinstance(BC, tuple)
        else feasibility(ec=0.0, AB=AB, BC=BC)["margin"]
    )
    return FeasibilityResult(margins.size, margins.size - rows.size, found, limit)


def _gaps(intervals: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The gaps of a turn between these intervals, starting at angles from 0 to 2 pi."""
    if not intervals:
        return ((0.0, 2.0 * pi),)
    starts = [start for start, _ in intervals[1:]] + [intervals[0][0] + 2.0 * pi]
    gaps = [(stop, start) for (_, stop), start in zip(intervals, starts, strict=True)]
    return tuple(sorted((a - 2.0 * pi, b - 2.0 * pi) if a >= 2.0 * pi else (a, b) for a, b in gaps))


# ---- files ---------------------------------------------------------------------------------------


def group_names(peaks: tuple[PeakResult, ...]) -> list[str]:
    """A name for each peak, such as `peak_absmax_a_C`; further ones of the same kind get a number."""
    names: list[str] = []
    for found in peaks:
        name = f"peak_{found.peak.kind}_{found.peak.quantity}"
        again = sum(other == name or other.startswith(f"{name}__") for other in names)
        names.append(f"{name}__{again + 1}" if again else name)
    return names


def _picture(picture: Picture, content: Content, shown_in: UnitSystem, steps: Steps) -> Path:
    from ..plot import curves, save

    steps.next(f"drawing {picture.file}")
    # With the names of the outputs the kernel of the grid serves here too, where all inputs are the same.
    shared = picture.quantity in content.outputs and set(picture.inputs) == set(content.inputs)
    names = content.outputs if shared else (picture.quantity,)
    values: Any = grid(names, **grid_options(content), **_arrays(picture.inputs))
    dataset = in_units(values, shown_in)
    axes: Any = curves(dataset, picture.quantity, over=picture.over, family=picture.family)[0].axes
    title = picture.title or content.title
    if title:
        axes.set_title(title, loc="left")
    return save(axes.figure, picture.file)
