"""Values under loads that vary with the motion: first the loads at each point, then the Program."""

from collections.abc import Callable, Container, Mapping, Sequence
from math import prod
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.function import FunctionOverTheta
from ...loads.load import Load, OverY
from ...loads.pieces import Place
from ...loads.resolve import VARIABLE, Forces, LoadPlan, plan_of, split, way_of
from ...loads.tabulated import over_theta
from ...mechanism.closed import TURN
from ...mechanism.messages import amount, message_of
from ...mechanism.names import LENGTHS, STATUS
from ...runtime.request import as_number, check_common, several
from ...support.forks import IMPORTS
from ..arrays import as_array, outputs_for
from ..labelled import evaluate_labelled, is_labelled
from ..values import values

Array = NDArray[Any]
MOTION = ("theta", *LENGTHS, "omega0", "alpha", "omega")  # inputs that every request has, if only as None
MANY = 10_000  # points
GAP = 1.5  # steps: a table that lacks no more of a turn is a whole one


def evaluate_loaded(
    names: str | Sequence[str],
    given: Mapping[str, Any],
    branch: int,
    accuracy: str | float,
    threads: int | None,
    out: Any = None,
    of_arrays: Callable[..., dict[str, Any]] | None = None,
) -> Any:
    """`evaluate` where F_X or F_Y varies with the motion; derivatives are total ones."""
    wanted = (names,) if isinstance(names, str) else several(names)
    check_common(given, branch, threads)
    if out is None and any(map(is_labelled, given.values())):

        def run(plain: dict[str, Any]) -> dict[str, Any]:
            return values_under_loads(wanted, plain, branch, accuracy, threads, None, of_arrays)

        labelled = evaluate_labelled(run, wanted, given)
        return labelled[names] if isinstance(names, str) else labelled
    found = values_under_loads(wanted, given, branch, accuracy, threads, out, of_arrays)
    return found[names] if isinstance(names, str) else found


def values_under_loads(
    names: Sequence[str],
    given: Mapping[str, Any],
    branch: int,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Any = None,
    of_arrays: Callable[..., dict[str, Any]] | None = None,
) -> dict[str, Any]:
    """The values by name, under loads or without; see `values` for `of_arrays`."""
    numbers, plan = plan_for(names, given)
    loaded, given = given, {**dict.fromkeys(MOTION), **numbers}
    found: dict[str, Any] | None = None
    if not plan.loads:
        found = values(list(names), given, branch, accuracy, threads, out, of_arrays)
        return found
    if accuracy == "standard" and are_many(numbers):
        found = _by_kernel(plan, loaded, numbers, branch, threads)
    if found is None:
        found = totals_at(plan, given, numbers, branch, accuracy, threads)
    return found if out is None else _put(found, out)


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


def _by_kernel(
    plan: LoadPlan, given: Mapping[str, Any], numbers: Mapping[str, Any], branch: int, threads: int | None
) -> dict[str, Any] | None:
    """The totals at many points by one kernel; None where it is not one, or not ready."""
    with IMPORTS:
        from .points import motion_of_jumps, points_under_loads

    more = [name for name in motion_of_jumps(plan.loads) if name not in plan.shown]
    every = plan_for((*plan.shown, *more), given)[1] if more else plan
    answer = points_under_loads(every, plan.shown, numbers, branch, threads)
    if answer is None:
        return None
    found, places = answer
    if places is not None:
        shape = next(iter(found.values())).shape
        own = {n: np.broadcast_to(numeric(n, v, plan.shown), shape) for n, v in numbers.items()}
        some = {name: array.reshape(-1)[places] for name, array in own.items()}
        again = totals_at(plan, {**dict.fromkeys(MOTION), **some}, some, branch, "standard", threads)
        for name in plan.shown:
            found[name].reshape(-1)[places] = again[name]
    return found


def are_many(numbers: Mapping[str, Any]) -> bool:
    """True if there may be enough points for one kernel under loads to pay."""
    return prod(value.size for value in numbers.values() if type(value) is np.ndarray) >= MANY


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
    what = f"theta, over which {' and '.join(plan.loads)} varies" if "theta" not in numbers else ""
    if what:
        raise TypeError(f"{', '.join(plan.shown)}: {what}, is missing")
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


def loads_of(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Load]]:
    """The inputs without loads that vary with the motion, and these; an array labelled over theta is one."""
    return split(with_labelled(inputs))


def with_labelled(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs, with labelled arrays over theta replaced by the loads that they stand for."""
    labelled = [n for n in VARIABLE if getattr(inputs.get(n), "dims", ()) == ("theta",)]
    return {**inputs, **{n: labelled_load(n, inputs[n]) for n in labelled}}


# ---- grids ----------------------------------------------------------------------------------------


def split_axes(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Load]]:
    """The inputs of a grid without its loads, and these; a labelled array over theta is one of them."""
    theta = inputs.get("theta")
    made = {
        name: labelled_load(name, value, theta) if name in VARIABLE else value
        for name, value in inputs.items()
        if _is_along(name, value, inputs)
    }
    return split({**inputs, **made})


def labelled_load(name: str, array: Any, theta: Any = None) -> Load:
    """The load over theta of a labelled array, at its own angles or at those of `theta`.

    Where its angles are those of `theta`, and no period of a table, it is known at these alone.
    """
    angles = array.coords.get("theta", theta)
    if angles is None:
        raise ValueError(f"{name}: a labelled array over theta has the coordinate theta")
    x, y = as_array("theta", angles, ("theta",), (name,)), as_array(name, array, (name,), (name,))
    if x.shape != y.shape:
        raise ValueError(f"{name}: {y.size} values over theta, which has {x.size}")
    try:
        if x.size and x[-1] - x[0] < TURN - GAP * np.diff(x).max(initial=0.0):
            first, last = (amount("theta", end, "g", says_unit=True) for end in (x[0], x[-1]))
            raise ValueError("its angles go from " + first + " to " + last + ", which is not a whole turn")
        return over_theta(x, y)
    except ValueError as error:
        if theta is None or not np.array_equal(x, as_array("theta", theta, ("theta",), (name,))):
            raise ValueError(f"{name}: " + message_of(error)) from None
        return FunctionOverTheta(SampledLoad(x, y).at)


class SampledLoad(NamedTuple):
    """A load that is known only at samples of the crank angle."""

    angles: Array
    values: Array

    def at(self, theta: Any) -> Any:
        """The values at angles that are among the samples."""
        order = np.argsort(self.angles)
        place = order[np.searchsorted(self.angles[order], theta).clip(0, order.size - 1)]
        if (self.angles[place] != theta).any():
            raise LookupError("a labelled load over part of a turn is known at its own angles alone")
        return self.values[place]


def _is_along(name: str, value: Any, inputs: Mapping[str, Any]) -> bool:
    """True for a labelled array over theta; ValueError for another one over a different input."""
    dimensions = getattr(value, "dims", ())
    if dimensions == ("theta",) and name in VARIABLE:
        return True
    other = [str(d) for d in dimensions if d != name and d in inputs]
    if other:
        raise ValueError(
            f"{name} has the dimensions {', '.join(map(str, dimensions))}: a grid is the outer product of "
            "its inputs, each with one dimension of its own; F_X and F_Y may be over theta alone"
        )
    return False


def _put(found: Mapping[str, Any], out: Any) -> dict[str, Any]:
    """The values in the arrays of `out`."""
    if all(isinstance(value, (float, int)) for value in found.values()):
        raise TypeError("out= is for arrays, but every input is a number")
    shape = np.broadcast_shapes(*(np.shape(value) for value in found.values()))
    places = outputs_for(tuple(found), shape, out)
    for name, place in places.items():
        np.copyto(place, found[name], casting="same_kind")
    return places
