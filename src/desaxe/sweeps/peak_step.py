"""Peaks of the designs of a sweep, beside its grid: refined over the crank angle, with their gradients."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.labels import Output, attributes, side_attributes
from ..evaluation.points import Outer, Step, outer_arrays
from ..loads.angles import cycle
from ..mechanism.names import sensitivity
from ..mechanism.own import Definition, using
from ..mechanism.quantity_units import SI
from ..mechanism.status import PeakStatus
from ..peaks.designs import KINDS, Sought, peaks_of_designs, search_of, sought_of
from ..peaks.programs import Search

Array = NDArray[Any]
WORDS = {"absmax": "largest magnitude", "max": "maximum", "min": "minimum"}
STATUS = "; ".join(f"{status:d} {status.words}" for status in PeakStatus)


class PeakRequest(NamedTuple):
    """A quantity, what is taken of it, and the range of crank angles."""

    name: str
    kind: str
    theta: tuple[float, float]


@dataclass(frozen=True)
class PeakStep(Step):
    """The peak of a quantity over some of the dimensions of a sweep: a step of its plan.

    Its variables are `peak_absmax_a_C`, `peak_absmax_a_C_theta`, ..., `peak_absmax_a_C_wrt_ec`.
    """

    sought: Sought
    search: Search
    scalars: tuple[tuple[str, float], ...]  # the inputs that are no dimensions
    state: bool

    @property
    def quantity(self) -> str:
        """The quantity whose peak it is."""
        return self.sought.plan.name

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.search.form.own

    @property
    def identity(self) -> str:
        """A text that tells the step from all others, by what its loads are too."""
        return " ".join([repr(self), *(load.identity for load in self.sought.loads.values())])

    @property
    def outputs(self) -> dict[str, Output]:
        """The variables by name: their types and CF attributes."""
        slopes = (f"wrt_{name}" for name in self.search.parameters)
        dtypes = {**dict.fromkeys(("value", "theta"), np.float64), "side": np.int8}
        dtypes |= {**dict.fromkeys(slopes, np.float64), "status": np.int8}
        return {
            self._variable(output): Output(np.dtype(dtype), self._attributes(output))
            for output, dtype in dtypes.items()
        }

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The variables of a block, from the values along each of its dimensions."""
        arrays = outer_arrays(values, self.columns, self.dims)
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        columns = {n: np.broadcast_to(a, shape).reshape(-1) for n, a in arrays.items()}
        columns |= {name: np.full(prod(shape), value) for name, value in self.scalars}
        with using(self.own):
            peaks = peaks_of_designs(self.sought._replace(threads=threads or 1), self.search, columns)
        gradient = {f"wrt_{name}": slope for name, slope in peaks.pop("gradient").items()}
        return {self._variable(n): array.reshape(shape) for n, array in {**peaks, **gradient}.items()}

    def _variable(self, output: str) -> str:
        stem = f"peak_{self.sought.kind}_{self.quantity}"
        return stem if output == "value" else f"{stem}_{output}"

    def _attributes(self, output: str) -> dict[str, Any]:
        name, kind = self.quantity, self.sought.kind
        if output == "value":
            own = attributes(name, self.state)
            words = f"{WORDS[kind]} over theta of {own['long_name']}"
            return {**own, "long_name": words, "quantity": name}
        if output.startswith("wrt_"):
            return slope_attributes(name, output.removeprefix("wrt_"))
        return attributes_beside()[output]


def attributes_beside() -> dict[str, dict[str, Any]]:
    """CF attributes of what comes beside the value of a peak, but for its derivatives."""
    return {
        "theta": {"units": "rad", "quantity": "theta", "long_name": "crank angle of the peak"},
        "side": side_attributes(),
        "status": {"long_name": STATUS},
    }


def slope_attributes(name: str, parameter: str) -> dict[str, str]:
    """CF attributes of the derivative of a peak by a parameter."""
    slope = sensitivity(name, parameter)
    words = f"derivative of the peak by {parameter}"
    return {"units": SI.of(slope).unit, "long_name": words, "quantity": slope}


def peak_requests(peaks: Any, outer: Outer) -> tuple[PeakRequest, ...]:
    """The requested peaks, from a name, several names, or a dict name -> kind or kinds.

    They are taken over the range of the crank angles of the sweep; where theta is no axis, over a cycle.
    """
    if isinstance(peaks, str):
        peaks = (peaks,)
    if not isinstance(peaks, Mapping):
        inputs = tuple(peaks)
        if all(isinstance(one, PeakRequest) for one in inputs):
            return inputs
        peaks = dict.fromkeys(inputs, "absmax")
    angles = outer.axes.get("theta", np.empty(0)).reshape(-1)
    whole = angles[np.isfinite(angles)]
    ends = (float(whole.min()), float(whole.max())) if whole.size > 1 else (0.0, cycle(outer.loads))
    result = []
    for name, kinds in peaks.items():
        for kind in (kinds,) if isinstance(kinds, str) else tuple(kinds):
            if kind not in KINDS:
                raise ValueError(f"peaks: kind = {kind!r} of {name}: it is one of {', '.join(KINDS)}")
            result.append(PeakRequest(name, kind, ends))
    return tuple(dict.fromkeys(result))


def peak_steps(
    requests: Sequence[PeakRequest], outer: Outer, branch: int, accuracy: Any
) -> tuple[PeakStep, ...]:
    """The steps of a sweep that compute them."""
    return tuple(_peak_step(one, outer, branch, accuracy) for one in requests)


def _peak_step(one: PeakRequest, outer: Outer, branch: int, accuracy: Any) -> PeakStep:
    inputs = {"alpha": 0.0, "omega": None, "omega0": None, **outer.given}
    inputs.pop("theta", None)
    sought = sought_of(one.name, one.kind, inputs, outer.loads, branch, accuracy, one.theta)
    needs = sought.numbers
    for name in needs:
        if name not in outer.axes:
            raise TypeError(f"peak of {one.name}: {name} is missing (needed: {', '.join(sought.plan.needs)})")
    along = {name: dim for name, dim in outer.along.items() if name in needs}
    scalars = {name: float(outer.axes[name].reshape(-1)[0]) for name in needs if name not in along}
    varying = {name: np.array(scalars[name]) if name in scalars else np.zeros(2) for name in needs}
    search = search_of(sought.plan, varying, sought.ends)  # an input of 0 is folded where it is a number
    state = outer.given.get("omega") is not None
    return PeakStep(
        tuple(outer.of(needs)), tuple(along.items()), sought, search, tuple(scalars.items()), state
    )
