"""Loads at points: their values there as columns, then the Program, then total derivatives."""

from collections.abc import Container, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from ...loads.load import Load, OverY
from ...loads.pieces import Place
from ...loads.resolve import SPEEDS, Forces, LoadPlan, plan_of, split, way_of
from ...mechanism.names import LENGTHS, STATUS
from ...runtime.kernels import KernelKey, all_have_wide_margins, plain_of
from ...runtime.request import as_number, request
from ...runtime.threads import run_in_blocks
from ..arrays import as_array, dtype_of
from ..values import values

MOTION = ("theta", *LENGTHS, "omega0", "alpha", "omega")  # inputs that every request has, if only as None


def totals_at(
    plan: LoadPlan,
    given: Mapping[str, Any],
    numbers: Mapping[str, Any],
    branch: int,
    accuracy: str | float,
    threads: int | None,
) -> dict[str, Any]:
    """The loads at each point, then the Program."""
    forces = forces_at(plan, numbers, branch, accuracy)
    alone = values(list(plan.names), {**given, **forces.values}, branch, accuracy, threads)
    return plan.totals(alone, forces)


def totals_of_columns(
    plan: LoadPlan, columns: Mapping[str, Any], branch: int, accuracy: str
) -> dict[str, Any]:
    """The totals at points, from columns of their inputs; no digit depends on which others are among them."""
    lengths = {name: columns[name] for name in ("theta", *LENGTHS) if plan.motion}
    motion = _of_columns(plan.motion, lengths, branch, accuracy) if plan.motion else {}
    speeds = {name: columns[name] for name in SPEEDS if name in columns}
    place = Place(columns["theta"], [*lengths.values()][1:], way_of(speeds), branch)
    forces = plan.forces(place, motion)
    return plan.totals(_of_columns(plan.names, {**columns, **forces.values}, branch, accuracy), forces)


def _of_columns(
    names: Sequence[str], columns: Mapping[str, Any], branch: int, accuracy: str
) -> dict[str, Any]:
    """The values of names at points, by the kernel of which every input varies."""
    asked = request(names, columns, branch, accuracy)
    size = columns["theta"].size
    given = {name: np.ascontiguousarray(np.broadcast_to(columns[name], (size,))) for name in asked.inputs}
    axes = tuple((name, 0) for name in sorted(given))
    result = {name: np.empty(size, dtype_of(name)) for name in names}
    key = KernelKey(asked.names, asked.form, asked.fixed, axes, 1, asked.accuracy)
    lengths = [given[name] for name in LENGTHS if name in given]
    wide = len(lengths) == len(LENGTHS) and all_have_wide_margins(asked.form, *lengths)
    if wide and plain_of(key) is not None:  # half as much to compile
        key = key._replace(form=asked.form._replace(wide_margins=True))
    run_in_blocks(key, given, [*result.values()], 1)
    return result


def plan_for(names: Sequence[str], given: Mapping[str, Any]) -> tuple[dict[str, Any], LoadPlan]:
    """The inputs that are numbers, and the plan for names under the loads that are not."""
    numbers, loads = split({name: value for name, value in given.items() if value is not None})
    return numbers, plan_at(names, loads, numbers)


def plan_at(names: Sequence[str], loads: Mapping[str, Load], given: Container[str]) -> LoadPlan:
    """The plan for names under loads; without an angle, a status has no friction and no load."""
    at_angle = "theta" in given
    loads = loads if at_angle or tuple(names) != (STATUS,) else {}
    return plan_of(names, loads, "omega" in given, "mu" in given and at_angle)


def forces_at(
    plan: LoadPlan,
    numbers: Mapping[str, Any],
    branch: int,
    accuracy: str | float,
    held: Mapping[str, Any] = MappingProxyType({}),
) -> Forces:
    """The loads of a plan at the crank angles, lengths and speed among `numbers`; some on pieces held."""
    require_angle(plan, numbers)
    theta = numeric("theta", numbers["theta"], plan.shown)
    motion: Mapping[str, Any] = {}
    lengths: Sequence[Any] = ()
    if plan.motion:
        given = {**dict.fromkeys(MOTION), **{n: numbers.get(n) for n in LENGTHS}, "theta": theta}
        motion = values(list(plan.motion), given, branch, accuracy if accuracy == "extended" else "standard")
        for name, load in plan.loads.items():
            if name not in held and isinstance(load, OverY) and load.jumping:
                own = ((n, numbers[n]) for n in LENGTHS)
                lengths = [x if type(x) is float else numeric(n, x, plan.shown) for n, x in own]
    speeds = {n: numeric(n, numbers[n], plan.shown) for n in ("omega0", "omega", "alpha") if n in numbers}
    return plan.forces(Place(theta, lengths, way_of(speeds), branch), motion, held)


def numeric(name: str, value: Any, names: Sequence[str]) -> Any:
    """An input as a float, or as an array of floats."""
    number = as_number(name, value, (name,), names)
    return as_array(name, value, (name,), names) if number is None else number


def require_angle(plan: LoadPlan, numbers: Container[str]) -> None:
    """TypeError where the angle is missing that loads vary over."""
    if "theta" not in numbers:
        varying = " and ".join(plan.loads)
        raise TypeError(f"{', '.join(plan.shown)}: theta, over which {varying} varies, is missing")
