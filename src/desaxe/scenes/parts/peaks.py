"""[[peak]]: refined extrema over the crank angle for many designs, and claims about them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import pi, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...loads.angles import cycle
from ...loads.load import Load
from ...mechanism.catalogue import has, of_design, quantity
from ...mechanism.names import CENTRES, LENGTHS, STATUS, parts, sensitivity
from ...mechanism.quantity_units import UnitSystem
from ...peaks.peak import peak
from ...sweeps.peak_step import WORDS, attributes_beside, slope_attributes
from ..content import Content, PlanRow, RequestPlan, Sink, columns_of
from ..reading.values import (
    OPTIONAL,
    Value,
    design_of,
    needs_of,
    number_of,
    only_inputs,
    require,
    require_known,
    values_of,
    with_others,
)
from ..schema import SceneError, shown
from .checks import Printed, read_percentage
from .peak_answer import ClaimResult, PeakResult

DESIGNS = 1_000  # designs of a peak between two reports of progress


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

    key = "peak"
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
        """The number of designs."""
        return prod(len(values) for values in self.axes.values())

    @property
    def batches(self) -> int:
        """The number of batches in which they are searched."""
        return -(-self.designs // DESIGNS)

    @property
    def group(self) -> str:
        """The name of its results, such as `peak_absmax_a_C`."""
        return f"peak_{self.kind}_{self.quantity}"

    @property
    def state(self) -> bool:
        """True for peaks in a given state of motion."""
        return "omega" in self.axes or "omega" in self.fixed

    def plan(self, content: Content) -> RequestPlan:
        """A search for each design."""
        how = "refined over theta by its derivative"
        work = [PlanRow(f"{self.kind} of {self.quantity}", self.designs, "designs", how)]
        return RequestPlan(lambda sink: _answer(self, content, sink), self.batches, work)


def peak_of(key: str, table: Mapping[str, Any], inputs: Mapping[str, Value], units: UnitSystem) -> Peak:
    """The peak of a [[peak]], with its designs, baseline and claims."""
    name, written = table["quantity"], table.get("over", {})
    only_inputs(f"{key}.over", written)
    over = {n: values_of(f"{key}.over.{n}", n, value, units) for n, value in written.items()}
    if "theta" in over:
        raise SceneError(f"{key}.over.theta: a peak is taken over theta; its range is {key}.theta")
    there = _completed(key, table, with_others(inputs, over))
    state, place = "omega" in there, f"{key}.quantity"
    require_known(place, name, state)
    if name == STATUS or of_design(name):
        raise SceneError(f"{place} = {shown(name)}: it has no peak over theta")
    slope = sensitivity(name, "theta")  # whose inputs a peak needs
    requested = (name, slope) if has(slope, state) else (name,)
    needed = require(place, [n for n in needs_of(requested, there) if n != "theta"], name, there)
    if "omega" in parts(name)[1] and "omega" not in needed:  # V_C_wrt_omega: it has no effect
        needed.append("omega")
    for n in over:
        if n not in needed:
            raise SceneError(f"{key}.over.{n}: {name} does not depend on it")
    # Whether the mechanism can be assembled at all depends on its lengths.
    lengths = require(place, [n for n in LENGTHS if n not in needed], name, there)
    ordered = {n: there[n] for n in dict.fromkeys((*over, *needed, *lengths))}
    axes = {n: value for n, value in ordered.items() if isinstance(value, tuple)}
    loads = {n: value for n, value in ordered.items() if isinstance(value, Load)}
    fixed: Any = {n: value for n, value in ordered.items() if n not in axes and n not in loads}

    def other(place: str, table: Mapping[str, Any]) -> tuple[dict[str, float], dict[str, float]]:
        """The differences of another design, and all of its inputs."""
        at = design_of(place, table, units)
        return at, _other_design(place, at, axes, fixed)

    none: dict[str, float] = {}
    at_base, base = other(f"{key}.baseline", table["baseline"]) if "baseline" in table else (none, none)
    claims = []
    for number, one in enumerate(table.get("claim", ()), 1):
        place = f"{key}.claim #{number}"
        if not base:
            written = f"{place}.increase = {shown(one['increase'])}"
            raise SceneError(f"{written}: an increase needs the peak's baseline = {{...}}")
        increase = read_percentage(f"{place}.increase", one["increase"])
        claims.append(Claim(one.get("source", "printed"), *other(f"{place}.at", one["at"]), increase))
    return Peak(
        table.get("title", ""), name, table.get("kind", "absmax"), axes, fixed,
        _angles(key, table, inputs, units), at_base, base, tuple(claims),
        _sensitivities(f"{key}.sensitivities", table, needed), loads,
    )  # fmt: skip


def _completed(key: str, table: Mapping[str, Any], inputs: Mapping[str, Value]) -> dict[str, Value]:
    """The inputs, with 0 for those that only the baseline, a claim or a sensitivity names."""
    completed = dict(inputs)
    named: dict[str, Iterable[str]] = {f"{key}.{n}": table.get(n, ()) for n in ("sensitivities", "baseline")}
    named |= {f"{key}.claim #{k}.at": claim["at"] for k, claim in enumerate(table.get("claim", ()), 1)}
    for place, names in named.items():
        for name in names:
            if name in CENTRES and name not in completed:
                raise SceneError(f"{place}: {name} is half a length unless it is given: give masses.{name}")
            if name in OPTIONAL:
                completed.setdefault(name, 0.0)
    return completed


def _sensitivities(key: str, table: Mapping[str, Any], needed: Iterable[str]) -> tuple[str, ...]:
    """The parameters of the requested sensitivities; those of the lengths without."""
    if "sensitivities" not in table:
        return tuple(name for name in LENGTHS if name in needed)
    only_inputs(key, table["sensitivities"])
    for name in table["sensitivities"]:
        if name not in needed:
            reason = "a peak is taken over it" if name == "theta" else "it does not depend on it"
            raise SceneError(f"{key}: {table['quantity']} has no sensitivity by {name}, {reason}")
    return tuple(table["sensitivities"])


def _angles(
    key: str, table: Mapping[str, Any], inputs: Mapping[str, Value], units: UnitSystem
) -> tuple[float, float]:
    """The range of theta: that of the peak, else that of the motion, else a cycle of the loads."""
    if "theta" in table:
        ends = enumerate(table["theta"], 1)
        low, high = (number_of(f"{key}.theta #{k}", "theta", part, units) for k, part in ends)
        if low > high:
            raise SceneError(f"{key}.theta = {shown(table['theta'])}: its lower end comes first")
        return low, high
    theta = inputs.get("theta")
    if isinstance(theta, tuple) and len(theta) > 1:
        return min(theta), max(theta)
    return 0.0, cycle({n: value for n, value in inputs.items() if isinstance(value, Load)})


def _other_design(
    key: str, at: Mapping[str, float], axes: Mapping[str, Any], fixed: Mapping[str, float]
) -> dict[str, float]:
    """All inputs of a design of which only the differences are written."""
    for name in at:
        if name not in axes and name not in fixed:
            raise SceneError(f"{key}.{name}: the peak does not depend on it")
    for name in axes:
        if name not in at:
            raise SceneError(f"{key}: {name} has {len(axes[name])} values, expected one: give {key}.{name}")
    return {name: {**fixed, **at}[name] for name in (*axes, *fixed)}


# ---- the answer -----------------------------------------------------------------------------------


def _answer(one: Peak, content: Content, sink: Sink) -> PeakResult:
    """The peaks of all designs, then of the baseline and of each claim."""
    columns: dict[str, Any] = columns_of({**one.axes, **one.fixed})
    options: dict[str, Any] = {"branch": content.branch, "accuracy": content.accuracy, **one.loads}
    values = _searched(one, columns, options, sink)
    shape = [len(axis) for axis in one.axes.values()]
    arrays = {name: array.reshape(shape) for name, array in values.items()}
    claims: list[ClaimResult] = []
    if one.baseline:
        designs = [one.baseline, *(claim.design for claim in one.claims)]
        base, *claimed = (_peak(one, **design, **options)["value"] for design in designs)
        arrays["increase"] = _increase(arrays["value"], base)
        for claim, value in zip(one.claims, claimed, strict=True):
            computed = float(_increase(value, base))
            claims.append(ClaimResult(claim, computed, claim.increase.agrees(computed)))
    mirrored = _mirrored(one, {**columns, **options}, values).reshape(shape)
    known = quantity(one.quantity, one.state)
    words = f"{WORDS[one.kind]} of {one.quantity}, {known.meaning}"
    attributes = {
        "value": {"units": known.unit, "quantity": one.quantity, "long_name": words},
        **attributes_beside(),
        "increase": {"units": "percent", "long_name": "increase over the baseline"},
    }
    rows = {
        n: (a, attributes.get(n) or slope_attributes(one.quantity, n.removeprefix("value_wrt_")))
        for n, a in arrays.items()
    }
    about = {"quantity": one.quantity, "kind": one.kind}
    dataset = content.labelled(rows, one.axes, {**one.fixed, **one.loads}, about)
    return PeakResult(peak=one, dataset=dataset, claims=tuple(claims), mirrored=mirrored)


def _peak(one: Peak, **design: Any) -> Any:
    """The peak of one design or of several."""
    return peak(one.quantity, kind=one.kind, theta=one.theta, **design)


def _searched(
    one: Peak, columns: Mapping[str, Any], options: Mapping[str, Any], sink: Sink
) -> dict[str, NDArray[Any]]:
    """Value, angle, status and gradient of flat designs, batch by batch."""
    batches = []
    for start in range(0, one.designs, DESIGNS):
        sink.steps.next(f"peaks of {one.quantity}")
        batch = {name: column[start : start + DESIGNS] for name, column in columns.items()}
        result = _peak(one, **batch, **options)
        gradient = result.pop("gradient")
        for name in one.sensitivities:  # by what has no effect, such as F_X without friction
            gradient.setdefault(name, np.where(np.isfinite(result["value"]), 0.0, np.nan))
        batches.append({**result, **{f"value_wrt_{name}": slope for name, slope in gradient.items()}})
    return {name: np.concatenate([batch[name] for batch in batches]) for name in batches[0]}


def _mirrored(one: Peak, design: dict[str, Any], values: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Designs with ec = 0 whose peak is shared by theta and -theta: a kink in its course over ec."""
    theta = values["theta"]
    low, high = one.theta
    if "ec" not in design or high - low < 2.0 * pi - 1e-9:
        return np.zeros(theta.shape, np.bool_)
    usable = (design["ec"] == 0.0) & (values["status"] == 0) & (np.abs(np.sin(theta)) > 1e-6)
    usable &= design.get("alpha", 0.0) == 0.0
    there: Any = evaluate(one.quantity, theta=-theta, **design)
    there = np.abs(there) if one.kind == "absmax" else there
    shared: NDArray[np.bool_] = usable & (np.abs(there - values["value"]) <= 1e-9 * np.abs(values["value"]))
    return shared


def _increase(value: Any, base: float) -> Any:
    """In percent; relative to the magnitude of the baseline, so that more is always positive."""
    with np.errstate(all="ignore"):
        return 100.0 * (np.asarray(value) - base) / np.abs(np.float64(base))
