"""Running a scene: values over the grid, peaks, checks, feasibility, files."""

import os
import tempfile
from collections.abc import Callable, Mapping
from importlib import import_module
from itertools import pairwise
from math import pi, prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._evaluate import evaluate
from ._feasibility import feasibility
from ._grid import grid, input_attributes
from ._peak import peak
from ._program import digest
from ._scene_read import Check, Claim, Content, Peak, Picture, Value
from .catalogue import quantity
from .extras import needed

if TYPE_CHECKING:
    import xarray as xr

# How far a run is: steps done, steps in all, what comes next.
Progress = Callable[[int, int, str], None]

BLOCK = 5_000_000  # points of the grid between two reports of progress
DESIGNS = 1_000  # designs of a peak between two reports of progress
MOST_SHOWN = 100  # designs that cannot turn fully, looked at one by one
ORDER = ("theta", "ec", "AB", "BC", "omega0", "omega", "alpha")  # of the parameters of a sensitivity
WORDS = {"absmax": "largest magnitude", "max": "maximum", "min": "minimum"}


class CheckResult(NamedTuple):
    """A printed value and the computed one, in SI units."""

    check: Check
    computed: float
    agrees: bool


class ClaimResult(NamedTuple):
    """A claimed increase of a peak over its baseline and the computed one, in percent."""

    claim: Claim
    computed: float
    agrees: bool


class PeakResult(NamedTuple):
    """The peaks of all designs, labelled, and what was claimed about some of them.

    `dataset` has over the designs' dimensions: `value`, `theta`, `status`, `value_wrt_<parameter>`
    and, where there is a baseline, `increase` over it in percent. `mirrored` tells the designs with
    ec = 0 that reach the peak at -theta as well, where the derivative by ec has the other sign.
    """

    peak: Peak
    dataset: "xr.Dataset"
    claims: tuple[ClaimResult, ...]
    mirrored: NDArray[np.bool_]


class Infeasible(NamedTuple):
    """A design that cannot turn fully, and the ranges of crank angles [rad] that it cannot reach."""

    design: dict[str, float]
    gaps: tuple[tuple[float, float], ...]


class FeasibilityResult(NamedTuple):
    """How many of the designs turn fully, and the first of those that do not.

    `limit` is the largest |ec| with which the crank turns fully [m], where AB and BC are numbers.
    """

    designs: int
    turning: int
    infeasible: tuple[Infeasible, ...]
    limit: float | None


class Run(NamedTuple):
    """All that a run gives."""

    dataset: "xr.Dataset | None"
    checks: tuple[CheckResult, ...]
    peaks: tuple[PeakResult, ...]
    feasibility: FeasibilityResult | None
    files: tuple[Path, ...]


class Steps:
    """Counts the steps of a run for whoever watches."""

    def __init__(self, total: int, watch: Progress | None) -> None:
        self.done, self.total, self.watch = 0, total, watch

    def next(self, what: str) -> None:
        """The next step begins."""
        if self.watch is not None:
            self.watch(self.done, self.total, what)
        self.done += 1


def run(content: Content, watch: Progress | None) -> Run:
    """Compute, draw and write all that a scene asks for."""
    _require_rooms(content)
    blocks = _blocks(content.inputs) if content.outputs else []
    batches = [-(-_designs(one) // DESIGNS) for one in content.peaks]
    steps = Steps(len(blocks) + sum(batches) + len(content.pictures) + (content.data is not None), watch)
    checks = tuple(_check(check, content) for check in content.checks)
    dataset = _values(content, blocks, steps) if content.outputs else None
    peaks = tuple(_peaks(one, content, steps) for one in content.peaks)
    files = [_data_file(Path(content.data), dataset, peaks, steps)] if content.data is not None else []
    files += [_picture(picture, content, steps) for picture in content.pictures]
    steps.next("")
    return Run(dataset, checks, peaks, _feasibility(content.inputs), tuple(files))


def _require_rooms(content: Content) -> None:
    """Fail at the start, not at the end, where an optional dependency is missing."""
    rooms = {"outputs": "xarray"} if content.outputs else {}
    rooms |= {"[[peak]]": "xarray"} if content.peaks else {}
    rooms |= {"results.data": "h5netcdf"} if content.data is not None else {}
    rooms |= (
        {"[[picture]]": "matplotlib", "the values of a [[picture]]": "xarray"} if content.pictures else {}
    )
    for what, module in rooms.items():
        with needed(what):
            import_module(module)


# ---- the grid ------------------------------------------------------------------------------------


def _blocks(inputs: Mapping[str, Value]) -> list[tuple[int, int]]:
    """Where to cut the first axis, so that a large grid can report how far it is."""
    lengths = [len(value) for value in inputs.values() if isinstance(value, tuple)]
    first = lengths[0] if lengths else 1
    count = max(1, min(first, prod(lengths) // BLOCK))
    return list(pairwise(first * k // count for k in range(count + 1)))


def _values(content: Content, blocks: list[tuple[int, int]], steps: Steps) -> "xr.Dataset":
    """The wanted outputs over the outer product of all inputs."""
    options: dict[str, Any] = {"branch": content.branch, "accuracy": content.accuracy}
    arrays = _arrays(content.inputs)
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
    labelled: xr.Dataset = whole.assign_attrs(_provenance(content))
    return labelled


def _longer(part: "xr.Dataset", first: str, values: NDArray[np.float64]) -> "xr.Dataset":
    """An empty dataset like a block of it, with all values along its first axis."""
    import xarray

    sizes = {**part.sizes, first: values.size}
    empty = {
        name: (array.dims, np.empty([sizes[d] for d in array.dims], array.dtype), array.attrs)
        for name, array in part.data_vars.items()
    }
    coordinates = {**part.coords, first: (first, values, part[first].attrs)}
    return xarray.Dataset(empty, coordinates, part.attrs)


def _arrays(inputs: Mapping[str, Value]) -> dict[str, Any]:
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}


def _provenance(content: Content) -> dict[str, str]:
    from . import __version__

    title = {"title": content.title} if content.title else {}
    return {**title, "source": f"desaxe {__version__}, derivation {digest()[:16]}"}


# ---- checks and feasibility ----------------------------------------------------------------------


def _check(check: Check, content: Content) -> CheckResult:
    design: dict[str, Any] = {**check.inputs, "branch": content.branch, "accuracy": content.accuracy}
    computed = float(evaluate(check.quantity, **design))
    return CheckResult(check, computed, check.printed.agrees(computed))


def _feasibility(inputs: Mapping[str, Value]) -> FeasibilityResult | None:
    """Which designs turn fully; None where a length is not given."""
    if not all(name in inputs for name in ("ec", "AB", "BC")):
        return None
    columns: dict[str, Any] = _columns({name: inputs[name] for name in inputs if name in ("ec", "AB", "BC")})
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
    """What of a turn is not in these intervals, beginning at angles from 0 to 2 pi."""
    if not intervals:
        return ((0.0, 2.0 * pi),)
    starts = [start for start, _ in intervals[1:]] + [intervals[0][0] + 2.0 * pi]
    gaps = [(stop, start) for (_, stop), start in zip(intervals, starts, strict=True)]
    return tuple(sorted((a - 2.0 * pi, b - 2.0 * pi) if a >= 2.0 * pi else (a, b) for a, b in gaps))


def _columns(inputs: Mapping[str, Value]) -> dict[str, NDArray[np.float64]]:
    """The outer product of the inputs, flat, in the order given."""
    arrays = np.meshgrid(*(np.asarray(value) for value in inputs.values()), indexing="ij")
    return {name: array.reshape(-1) for name, array in zip(inputs, arrays, strict=True)}


# ---- peaks ---------------------------------------------------------------------------------------


def _designs(one: Peak) -> int:
    return prod(len(values) for values in one.axes.values()) + len(one.claims) + bool(one.baseline)


def _peaks(one: Peak, content: Content, steps: Steps) -> PeakResult:
    """The peaks of the designs, of the baseline and of what was claimed, in one go."""
    others = [*([one.baseline] if one.baseline else []), *(claim.design for claim in one.claims)]
    columns = {
        name: np.append(column, [design[name] for design in others])
        for name, column in _columns({**one.axes, **one.fixed}).items()
    }
    found = _found(one, content, columns, steps)
    shape = [len(values) for values in one.axes.values()]
    count = prod(shape)
    arrays = {name: values[:count].reshape(shape) for name, values in found.items()}
    claims: tuple[ClaimResult, ...] = ()
    if one.baseline:
        base, *claimed = found["value"][count:].tolist()
        arrays["increase"] = np.asarray(_increase(arrays["value"], base))
        computed = [float(_increase(value, base)) for value in claimed]
        pairs = zip(one.claims, computed, strict=True)
        claims = tuple(ClaimResult(claim, value, claim.increase.agrees(value)) for claim, value in pairs)
    mirrored = _mirrored(one, content, columns, found)[:count].reshape(shape)
    return PeakResult(one, _labelled(one, content, arrays), claims, mirrored)


def _found(
    one: Peak, content: Content, columns: Mapping[str, NDArray[np.float64]], steps: Steps
) -> dict[str, NDArray[Any]]:
    """Value, angle, status and gradient of flat designs, batch by batch."""
    size = next(iter(columns.values())).size
    options: dict[str, Any] = {"branch": content.branch, "accuracy": content.accuracy}
    parts = []
    for start in range(0, size, DESIGNS):
        steps.next(f"peaks of {one.quantity}")
        batch: dict[str, Any] = {name: column[start : start + DESIGNS] for name, column in columns.items()}
        found = peak(one.quantity, kind=one.kind, theta=one.theta, **batch, **options)
        slopes = {f"value_wrt_{name}": slope for name, slope in found.pop("gradient").items()}
        parts.append({**found, **slopes})
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _mirrored(
    one: Peak, content: Content, columns: Mapping[str, NDArray[np.float64]], found: Mapping[str, NDArray[Any]]
) -> NDArray[np.bool_]:
    """Designs with ec = 0 whose peak is shared by theta and -theta: a kink in its course over ec."""
    theta = found["theta"]
    low, high = one.theta
    if "ec" not in columns or high - low < 2.0 * pi - 1e-9:
        return np.zeros(theta.shape, np.bool_)
    steady = columns["alpha"] == 0.0 if "alpha" in columns else True
    usable = (columns["ec"] == 0.0) & (found["status"] == 0) & (np.abs(np.sin(theta)) > 1e-6) & steady
    design: dict[str, Any] = {**columns, "branch": content.branch, "accuracy": content.accuracy}
    there: Any = evaluate(one.quantity, theta=-theta, **design)
    there = np.abs(there) if one.kind == "absmax" else there
    shared: NDArray[np.bool_] = usable & (np.abs(there - found["value"]) <= 1e-9 * np.abs(found["value"]))
    return shared


def _increase(value: Any, base: float) -> Any:
    """In percent; relative to the magnitude of the baseline, so that more is always positive."""
    with np.errstate(all="ignore"):
        return 100.0 * (np.asarray(value) - base) / np.abs(np.float64(base))


def _labelled(one: Peak, content: Content, arrays: Mapping[str, NDArray[Any]]) -> "xr.Dataset":
    import xarray

    state = "omega" in one.axes or "omega" in one.fixed
    slopes = [name for name in arrays if name.startswith("value_wrt_")]
    attributes = {
        "value": _peak_attributes(one, state),
        "theta": {"units": "rad", "long_name": "crank angle of the peak"},
        "status": {
            "long_name": "0 ok, 1 infeasible, 2 at a limit angle or change point, 3 stalled, 4 bad input"
        },
        "increase": {"units": "percent", "long_name": "increase over the baseline"},
        **{name: _slope_attributes(one, name.removeprefix("value_wrt_"), state) for name in slopes},
    }
    data = {name: (tuple(one.axes), array, attributes[name]) for name, array in arrays.items()}
    axes = {name: (name, list(values), input_attributes(name)) for name, values in one.axes.items()}
    scalars = {name: ((), value, input_attributes(name)) for name, value in one.fixed.items()}
    kind = {"quantity": one.quantity, "kind": one.kind, "branch": content.branch}
    return xarray.Dataset(data, {**axes, **scalars}, {**_provenance(content), **kind})


def _peak_attributes(one: Peak, state: bool) -> dict[str, str]:
    known = quantity(one.quantity, state)
    return {"units": known.unit, "long_name": f"{WORDS[one.kind]} of {one.quantity}, {known.meaning}"}


def _slope_attributes(one: Peak, parameter: str, state: bool) -> dict[str, str]:
    base, _, others = one.quantity.partition("_wrt_")
    parameters = sorted([*(others.split("_") if others else []), parameter], key=ORDER.index)
    unit = quantity(f"{base}_wrt_{'_'.join(parameters)}", state).unit
    return {"units": unit, "long_name": f"derivative of the peak by {parameter}"}


# ---- files ---------------------------------------------------------------------------------------


def _data_file(path: Path, dataset: "xr.Dataset | None", peaks: tuple[PeakResult, ...], steps: Steps) -> Path:
    """Everything labelled in one NetCDF file: the grid at its root, each peak a group of its own."""
    steps.next(f"writing {path}")
    path.parent.mkdir(parents=True, exist_ok=True)
    parts: list[tuple[str | None, xr.Dataset]] = [(None, dataset)] if dataset is not None else []
    parts += zip(group_names(peaks), (found.dataset for found in peaks), strict=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".desaxe-") as folder:
        staged = Path(folder) / path.name
        for group, part in parts:
            part.to_netcdf(staged, mode="a" if staged.exists() else "w", group=group, engine="h5netcdf")
        os.replace(staged, path)
    return path


def group_names(peaks: tuple[PeakResult, ...]) -> list[str]:
    """A name for each peak, such as `peak_absmax_a_C`; further ones of the same kind get a number."""
    names: list[str] = []
    for found in peaks:
        name = f"peak_{found.peak.kind}_{found.peak.quantity}"
        again = sum(other == name or other.startswith(f"{name}__") for other in names)
        names.append(f"{name}__{again + 1}" if again else name)
    return names


def _picture(picture: Picture, content: Content, steps: Steps) -> Path:
    from .plot import curves, save

    steps.next(f"drawing {picture.file}")
    # With the names of the outputs the kernel of the grid serves here too.
    names = content.outputs if picture.quantity in content.outputs else (picture.quantity,)
    options: dict[str, Any] = {"branch": content.branch, "accuracy": content.accuracy}
    dataset: Any = grid(names, **options, **_arrays(picture.inputs))
    axes: Any = curves(dataset, picture.quantity, over=picture.over, family=picture.family)[0].axes
    title = picture.title or content.title
    if title:
        axes.set_title(title, loc="left")
    return save(axes.figure, picture.file)
