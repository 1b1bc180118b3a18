"""Peaks of the designs of a sweep, beside its grid: refined over the crank angle, with their gradients."""

from collections.abc import Mapping, Sequence
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.labels import attributes as attributes_of
from ..evaluation.labels import side_attributes
from ..evaluation.outer import Outer
from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.names import sensitivity
from ..mechanism.status import PeakStatus
from ..peaks.designs import KINDS, plan_of
from ..peaks.lazy import GRADIENT, PeakBlock, peak_block

Array = NDArray[Any]
WORDS = {"absmax": "largest magnitude", "max": "maximum", "min": "minimum"}
STATUS = "; ".join(f"{status:d} {status.words}" for status in PeakStatus)


class PeakRequest(NamedTuple):
    """A quantity, what is taken of it, and the range of crank angles."""

    name: str
    kind: str
    theta: tuple[float, float]


class PeakPart(NamedTuple):
    """The peak of a quantity over some of the dimensions of a sweep."""

    block: PeakBlock
    dims: tuple[str, ...]

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the part needs."""
        return self.dims

    @property
    def variables(self) -> dict[str, str]:
        """Map outputs to variables of the store: `peak_absmax_a_C`, `peak_absmax_a_C_theta`, ..."""
        stem = f"peak_{self.block.kind}_{self.block.name}"
        return {
            output: stem + ("" if output == "value" else f"_{output.replace(GRADIENT, 'wrt_', 1)}")
            for output in self.block.outputs
        }

    @property
    def outputs(self) -> dict[str, np.dtype[Any]]:
        """The variables of the part and their dtypes."""
        return {self.variables[output]: dtype for output, dtype in self.block.outputs.items()}

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The variables of a block, from the values along each of its dimensions."""
        grids = np.meshgrid(*(values[name] for name in self.dims), indexing="ij", sparse=True)
        arrays = dict(zip(self.dims, grids, strict=True))
        block = self.block._replace(threads=threads or 1)
        found = block.compute(*(arrays[name] for name in block.names))
        return {self.variables[output]: array for output, array in found.items()}

    def attributes(self, state: bool) -> dict[str, dict[str, Any]]:
        """CF attributes of its variables."""
        name, kind = self.block.name, self.block.kind
        own = attributes_of(name, state)
        found: dict[str, dict[str, Any]] = {
            "value": {**own, "long_name": f"{WORDS[kind]} over theta of {own['long_name']}"},
            "theta": {"units": "rad", "long_name": "crank angle of the peak"},
            "side": side_attributes(),
            "status": {"long_name": STATUS},
        }
        for p in self.block.search.parameters:
            told = {"units": _slope_unit(name, p, state), "long_name": f"derivative of the peak by {p}"}
            found[f"{GRADIENT}{p}"] = told
        return {self.variables[output]: told for output, told in found.items()}


def _slope_unit(name: str, parameter: str, state: bool) -> str:
    try:
        return quantity(sensitivity(name, parameter), state).unit
    except ValueError:  # a derivative that only a peak has
        return f"{quantity(name, state).unit}/({INPUTS[parameter].unit})"


def peak_requests(peaks: Any, outer: Outer) -> tuple[PeakRequest, ...]:
    """The requested peaks, from a name, several names, or a dict name -> kind or kinds.

    They are taken over the range of the crank angles of the sweep, one turn where that is no axis.
    """
    if isinstance(peaks, str):
        peaks = (peaks,)
    if not isinstance(peaks, Mapping):
        given = tuple(peaks)
        if all(isinstance(one, PeakRequest) for one in given):
            return given
        peaks = dict.fromkeys(given, "absmax")
    angles = outer.axes.get("theta", np.empty(0)).reshape(-1)
    whole = angles[np.isfinite(angles)]
    ends = (float(whole.min()), float(whole.max())) if whole.size > 1 else (0.0, 2.0 * pi)
    found = []
    for name, kinds in peaks.items():
        for kind in (kinds,) if isinstance(kinds, str) else tuple(kinds):
            if kind not in KINDS:
                raise ValueError(f"peaks: kind = {kind!r} of {name}: it is one of {', '.join(KINDS)}")
            found.append(PeakRequest(name, kind, ends))
    return tuple(dict.fromkeys(found))


def peak_parts(
    requests: Sequence[PeakRequest], outer: Outer, branch: int, accuracy: Any
) -> tuple[PeakPart, ...]:
    """The parts of a sweep that compute them."""
    return tuple(_peak_part(one, outer, branch, accuracy) for one in requests)


def _peak_part(one: PeakRequest, outer: Outer, branch: int, accuracy: Any) -> PeakPart:
    given = {"alpha": 0.0, "omega": None, "omega0": None, **outer.given}
    given.pop("theta", None)
    plan = plan_of(one.name, {**given, **outer.loads}, branch, accuracy)
    loads = {n: load for n, load in outer.loads.items() if n in plan.parameters}
    needs = [name for name in plan.needs if name not in loads]
    for name in needs:
        if name not in outer.axes:
            raise TypeError(f"peak of {one.name}: {name} is missing (needed: {', '.join(plan.needs)})")
    dims = tuple(name for name in outer.dimensions if name in needs)
    scalars = {name: float(outer.axes[name].reshape(-1)[0]) for name in needs if name not in dims}
    return PeakPart(peak_block(one.kind, plan, scalars, dims, branch, one.theta, 1, loads), dims)
