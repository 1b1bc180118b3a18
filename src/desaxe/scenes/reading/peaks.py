"""[[peak]] of a scene as a request."""

from collections.abc import Iterable, Mapping
from typing import Any

from ...loads.angles import cycle
from ...loads.load import Load
from ...mechanism.catalogue import of_design, quantity
from ...mechanism.names import CENTRES, LENGTHS, STATUS, parts, sensitivity
from ...mechanism.quantity_units import UnitSystem
from ...scenes import schema
from ..parts.extremes import Claim, Peak
from ..schema import SceneError, shown
from .needs import OPTIONAL, needs_of, require, require_known, with_others
from .printed import read_percentage
from .values import Value, design_of, number_of, only_inputs, values_of

SENSITIVITIES = LENGTHS  # of a peak, those on which it depends, unless others are requested


def peak_of(key: str, table: schema.PeakTable, inputs: Mapping[str, Value], units: UnitSystem) -> Peak:
    """The peak of a [[peak]], with its designs, baseline and claims."""
    name = table.quantity
    only_inputs(f"{key}.over", table.over)
    over = {n: values_of(f"{key}.over.{n}", n, written, units) for n, written in table.over.items()}
    if "theta" in over:
        raise SceneError(f"{key}.over.theta: a peak is taken over theta; its range is {key}.theta")
    there = _completed(key, table, with_others(inputs, over))
    require_known(f"{key}.quantity", name, "omega" in there)
    slope = _slope(f"{key}.quantity", name, "omega" in there)
    needed = require(
        f"{key}.quantity", [n for n in needs_of((name, slope), there) if n != "theta"], name, there
    )
    if "omega" in parts(name)[1] and "omega" not in needed:  # V_C_wrt_omega: it has no effect
        needed.append("omega")
    for n in over:
        if n not in needed:
            raise SceneError(f"{key}.over.{n}: {name} does not depend on it")
    # Whether the mechanism can be assembled at all depends on its lengths.
    lengths = require(f"{key}.quantity", [n for n in LENGTHS if n not in needed], name, there)
    ordered = dict.fromkeys((*over, *needed, *lengths))
    axes = {n: value for n in ordered if isinstance(value := there[n], tuple)}
    fixed = {n: value for n in ordered if isinstance(value := there[n], float)}
    loads = {n: value for n in ordered if isinstance(value := there[n], Load)}
    base = (
        _other_design(f"{key}.baseline", table.baseline or {}, axes, fixed, units)
        if table.baseline is not None
        else {}
    )
    claims = tuple(
        _claim(f"{key}.claim #{index}", claim, axes, fixed, bool(base), units)
        for index, claim in enumerate(table.claim, 1)
    )
    wanted = _sensitivities(f"{key}.sensitivities", table, needed)
    angles = _angles(key, table, inputs, units)
    at_base = design_of(f"{key}.baseline", table.baseline or {}, units)
    return Peak(table.title, name, table.kind, axes, fixed, angles, at_base, base, claims, wanted, loads)


def _completed(key: str, table: schema.PeakTable, inputs: Mapping[str, Value]) -> dict[str, Value]:
    """The inputs, with 0 for those that only the baseline, a claim or a sensitivity names."""
    found = dict(inputs)
    named: dict[str, Iterable[str]]
    named = {f"{key}.sensitivities": table.sensitivities or (), f"{key}.baseline": table.baseline or ()}
    named |= {f"{key}.claim #{index}.at": claim.at for index, claim in enumerate(table.claim, 1)}
    for place, names in named.items():
        for name in names:
            if name in CENTRES and name not in found:
                raise SceneError(f"{place}: {name} is half a length unless it is given: give masses.{name}")
            if name in OPTIONAL:
                found.setdefault(name, 0.0)
    return found


def _sensitivities(key: str, table: schema.PeakTable, needed: Iterable[str]) -> tuple[str, ...]:
    """The parameters of the requested sensitivities."""
    if table.sensitivities is None:
        return tuple(name for name in SENSITIVITIES if name in needed)
    only_inputs(key, table.sensitivities)
    for name in table.sensitivities:
        if name not in needed:
            reason = "a peak is taken over it" if name == "theta" else "it does not depend on it"
            raise SceneError(f"{key}: {table.quantity} has no sensitivity by {name}, {reason}")
    return table.sensitivities


def _slope(key: str, name: str, state: bool) -> str:
    """The derivative of a quantity by theta, whose inputs a peak needs; the quantity itself without one."""
    if name == STATUS or of_design(name):
        raise SceneError(f"{key} = {shown(name)}: it has no peak over theta")
    slope = sensitivity(name, "theta")
    try:
        quantity(slope, state)
    except ValueError:
        return name
    return slope


def _angles(
    key: str, table: schema.PeakTable, inputs: Mapping[str, Value], units: UnitSystem
) -> tuple[float, float]:
    """The range of theta: that of the peak, else that of the motion, else a cycle of the loads."""
    if table.theta is not None:
        low, high = (
            number_of(f"{key}.theta #{i}", "theta", part, units) for i, part in enumerate(table.theta, 1)
        )
        if low > high:
            raise SceneError(f"{key}.theta = {shown(list(table.theta))}: its lower end comes first")
        return low, high
    theta = inputs.get("theta")
    if isinstance(theta, tuple) and len(theta) > 1:
        return min(theta), max(theta)
    return 0.0, cycle({n: value for n, value in inputs.items() if isinstance(value, Load)})


def _other_design(
    key: str,
    written: Mapping[str, float | str],
    axes: Mapping[str, Any],
    fixed: Mapping[str, float],
    units: UnitSystem,
) -> dict[str, float]:
    """All inputs of a design of which only the differences are written."""
    design = {**fixed, **design_of(key, written, units)}
    for name in written:
        if name not in axes and name not in fixed:
            raise SceneError(f"{key}.{name}: the peak does not depend on it")
    for name in axes:
        if name not in design:
            raise SceneError(f"{key}: {name} has {len(axes[name])} values, expected one: give {key}.{name}")
    return {name: design[name] for name in (*axes, *fixed)}


def _claim(
    key: str,
    claim: schema.ClaimTable,
    axes: Mapping[str, Any],
    fixed: Mapping[str, float],
    based: bool,
    units: UnitSystem,
) -> Claim:
    if not based:
        raise SceneError(
            f"{key}.increase = {shown(claim.increase)}: an increase needs the peak's baseline = {{...}}"
        )
    design = _other_design(f"{key}.at", claim.at, axes, fixed, units)
    at = design_of(f"{key}.at", claim.at, units)
    return Claim(claim.source, at, design, read_percentage(f"{key}.increase", claim.increase))
