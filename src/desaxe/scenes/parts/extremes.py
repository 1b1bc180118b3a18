"""The peaks of a scene, labelled, and the claims about them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi, prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...evaluation.labels import import_xarray, input_attributes, tell_loads
from ...loads.load import Load
from ...mechanism.catalogue import quantity
from ...peaks.peak import peak
from ...support.forks import IMPORTS
from ...support.progress import Steps
from ...sweeps.peak_step import WORDS, attributes_beside, slope_attributes
from ..reading.printed import Printed
from ..reading.values import Value
from ..setting import PlanRow, Setting

if TYPE_CHECKING:
    import xarray as xr

DESIGNS = 1_000  # designs of a peak between two reports of progress
SIDEWAYS = ("ec", "F_X", "g_X")  # change sign where the mechanism is mirrored at the Y axis


@dataclass(frozen=True)
class Claim:
    """A claim about the peak of one design: its increase over the baseline."""

    source: str
    at: dict[str, float]
    design: dict[str, float]
    increase: Printed


@dataclass(frozen=True)
class Peak:
    """A peak over the crank angle, for the outer product of `axes` with everything else fixed."""

    title: str
    quantity: str
    kind: str
    axes: dict[str, tuple[float, ...]]
    fixed: dict[str, float]
    theta: tuple[float, float]
    at_baseline: dict[str, float]
    baseline: dict[str, float]
    claims: tuple[Claim, ...]
    sensitivities: tuple[str, ...]
    loads: Mapping[str, Load] = field(default_factory=dict)  # that vary with the motion

    @property
    def designs(self) -> int:
        """The number of designs, without those of baseline and claims."""
        return prod(len(values) for values in self.axes.values())

    @property
    def work(self) -> PlanRow:
        """A search for each design."""
        how = "refined over theta by its derivative"
        return PlanRow(f"{self.kind} of {self.quantity}", self.designs, "designs", how)


class ClaimResult(NamedTuple):
    """A claimed increase of a peak over its baseline and the computed one, in percent."""

    claim: Claim
    computed: float
    agrees: bool


class PeakResult(NamedTuple):
    """The peaks of all designs, labelled, and the checked claims about them.

    `dataset` has over the designs' dimensions: `value`, `theta`, `side`, `status`, `value_wrt_<parameter>`
    and, where there is a baseline, `increase` over it in percent. `mirrored` tells the designs with
    ec = 0 that reach the peak at -theta as well, where the derivatives by what points to the side
    (ec, F_X, g_X) have the other sign.
    """

    peak: Peak
    dataset: "xr.Dataset"
    claims: tuple[ClaimResult, ...]
    mirrored: NDArray[np.bool_]


def batches(one: Peak) -> int:
    """The number of batches of a peak."""
    return -(-(one.designs + len(one.claims) + bool(one.baseline)) // DESIGNS)


def peaks_of(one: Peak, setting: Setting, steps: Steps) -> PeakResult:
    """The peaks of designs, baseline and claims, found together."""
    others = [*([one.baseline] if one.baseline else []), *(claim.design for claim in one.claims)]
    columns = {
        name: np.append(column, [design[name] for design in others])
        for name, column in columns_of({**one.axes, **one.fixed}).items()
    }
    found = _found(one, setting, columns, steps)
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
    mirrored = _mirrored(one, setting, columns, found)[:count].reshape(shape)
    return PeakResult(one, _labelled(one, setting, arrays), claims, mirrored)


def _found(
    one: Peak, setting: Setting, columns: Mapping[str, NDArray[np.float64]], steps: Steps
) -> dict[str, NDArray[Any]]:
    """Value, angle, status and gradient of flat designs, batch by batch."""
    size = next(iter(columns.values())).size
    options: dict[str, Any] = {"branch": setting.branch, "accuracy": setting.accuracy}
    parts = []
    for start in range(0, size, DESIGNS):
        steps.next(f"peaks of {one.quantity}")
        batch: dict[str, Any] = {name: column[start : start + DESIGNS] for name, column in columns.items()}
        batch |= one.loads
        found = peak(one.quantity, kind=one.kind, theta=one.theta, **batch, **options)
        gradient = found.pop("gradient")
        for name in one.sensitivities:  # by what has no effect, such as F_X without friction
            gradient.setdefault(name, np.where(np.isfinite(found["value"]), 0.0, np.nan))
        parts.append({**found, **{f"value_wrt_{name}": slope for name, slope in gradient.items()}})
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _mirrored(
    one: Peak, setting: Setting, columns: Mapping[str, NDArray[np.float64]], found: Mapping[str, NDArray[Any]]
) -> NDArray[np.bool_]:
    """Designs with ec = 0 whose peak is shared by theta and -theta: a kink in its course over ec."""
    theta = found["theta"]
    low, high = one.theta
    if "ec" not in columns or high - low < 2.0 * pi - 1e-9:
        return np.zeros(theta.shape, np.bool_)
    steady = columns["alpha"] == 0.0 if "alpha" in columns else True
    usable = (columns["ec"] == 0.0) & (found["status"] == 0) & (np.abs(np.sin(theta)) > 1e-6) & steady
    design: dict[str, Any] = {**columns, **one.loads, "branch": setting.branch, "accuracy": setting.accuracy}
    there: Any = evaluate(one.quantity, theta=-theta, **design)
    there = np.abs(there) if one.kind == "absmax" else there
    shared: NDArray[np.bool_] = usable & (np.abs(there - found["value"]) <= 1e-9 * np.abs(found["value"]))
    return shared


def _increase(value: Any, base: float) -> Any:
    """In percent; relative to the magnitude of the baseline, so that more is always positive."""
    with np.errstate(all="ignore"):
        return 100.0 * (np.asarray(value) - base) / np.abs(np.float64(base))


def _labelled(one: Peak, setting: Setting, arrays: Mapping[str, NDArray[Any]]) -> "xr.Dataset":
    import_xarray()
    with IMPORTS:
        import xarray

    state = "omega" in one.axes or "omega" in one.fixed
    slopes = [name for name in arrays if name.startswith("value_wrt_")]
    attributes = {
        "value": _peak_attributes(one, state),
        **attributes_beside(),
        "increase": {"units": "percent", "long_name": "increase over the baseline"},
        **{name: slope_attributes(one.quantity, name.removeprefix("value_wrt_")) for name in slopes},
    }
    data = {name: (tuple(one.axes), array, attributes[name]) for name, array in arrays.items()}
    axes = {name: (name, list(values), input_attributes(name)) for name, values in one.axes.items()}
    scalars = {name: ((), value, input_attributes(name)) for name, value in one.fixed.items()}
    kind = {"quantity": one.quantity, "kind": one.kind, "branch": setting.branch}
    dataset = xarray.Dataset(data, {**axes, **scalars}, {**setting.provenance, **kind})
    return tell_loads(dataset, one.loads)


def _peak_attributes(one: Peak, state: bool) -> dict[str, str]:
    known = quantity(one.quantity, state)
    return {
        "units": known.unit,
        "quantity": one.quantity,
        "long_name": f"{WORDS[one.kind]} of {one.quantity}, {known.meaning}",
    }


def columns_of(inputs: Mapping[str, Value]) -> dict[str, NDArray[np.float64]]:
    """The outer product of the inputs, flat, in the order given."""
    arrays = np.meshgrid(*(np.asarray(value) for value in inputs.values()), indexing="ij")
    return {name: array.reshape(-1) for name, array in zip(inputs, arrays, strict=True)}


def group_names(peaks: Sequence[Peak]) -> list[str]:
    """A name for each peak, such as `peak_absmax_a_C`; further ones of the same kind get a number."""
    names: list[str] = []
    for one in peaks:
        name = f"peak_{one.kind}_{one.quantity}"
        again = sum(other == name or other.startswith(f"{name}__") for other in names)
        names.append(f"{name}__{again + 1}" if again else name)
    return names
