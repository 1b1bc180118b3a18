"""The arguments of `simulate`, read and checked: errors name the argument, the value and the limit."""

from collections.abc import Mapping
from math import inf, isnan, nan, pi
from typing import Any

import numpy as np

from ..loads.along_motion import OfMotion
from ..loads.arguments import ARGUMENTS, arguments_of
from ..loads.load import Load as LoadOverMotion
from ..loads.motors import Motor
from ..loads.resolve import as_load
from ..mechanism.catalogue import quantity
from ..mechanism.closed import TURN
from ..mechanism.closed.limits import theta_intervals
from ..mechanism.inputs import INPUTS, Input
from ..mechanism.messages import Message, amount, listed, named
from ..mechanism.names import CENTRES, LENGTHS, LOADS, MASSES
from ..mechanism.read import read
from ..mechanism.spelling import did_you_mean
from ..runtime.request import several
from ..support.deadline import Deadline
from ..support.shown import shown
from .coordinate import arc_around, coordinate_of
from .drive import ROLES, Acting, Actuation, TorqueDerivative, UserFunction
from .model import Model

OWN = {"t", "theta", "omega", "alpha", "status"}  # keys of the result that no name may take
LEAST_RTOL = 3e-14
SMALL = 1e-4  # rad: so near to a dead centre without inertia no motion is followed


def scalar(name: str, value: Any, unit: str, least: float = -inf, limit: str = "a finite number") -> float:
    """A number, which may carry its unit."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    return read(Input(name, unit, "", least, limit), value, "simulate", limit)


def refuse_function(name: str, value: Any) -> None:
    """TypeError for a function in place of a length or a mass."""
    if callable(value) and name not in ("F_X", "F_Y"):
        raise TypeError(f"{name} = {shown(value)}: expected a number; torque, F_X and F_Y may be functions")


def design_values(inputs: Mapping[str, Any]) -> dict[str, float]:
    """The lengths, masses and constant loads of one design; those that are not given are 0."""
    values = {}
    for name in (*LENGTHS, *LOADS):
        value = inputs.get(name)
        if value is None and name in CENTRES:
            continue
        refuse_function(name, value)
        if callable(value):
            values[name] = nan  # it varies: nothing may be folded
        else:
            values[name] = 0.0 if value is None and name in LOADS else one(name, value)
    return values


def one(name: str, value: Any) -> float:
    """A number for an input of the mechanism."""
    return read(INPUTS[name], value, "simulate")


def check_names(names: Any, of_design: bool = True) -> tuple[str, ...]:
    """Check the requested names: of a design, quantities or sensitivities of a given state."""
    requested = (names,) if isinstance(names, str) else several(names)
    for name in requested:
        if name in OWN - {"omega"}:
            raise ValueError(f"names: {name!r} is always among the results")
        if of_design:
            quantity(name, state=True)
    return requested


def follows_the_slider(torque: Any) -> bool:
    """True for a user's function that is called with the slider's position or speed."""
    if not callable(torque) or isinstance(torque, (LoadOverMotion, Motor)):
        return False
    return not set(arguments_of("torque", torque, ARGUMENTS)) <= set(ROLES)


def acting(
    name: str, value: Any, unit: str, deadline: Deadline, derivative: TorqueDerivative | None = None
) -> Acting:
    """A torque or force along the motion; a function is checked wherever it is called."""
    if not callable(value):
        return Acting(scalar(name, value, unit, limit="a finite number or a function"))
    if isinstance(value, Motor):
        return Acting(value)
    arguments = () if isinstance(value, LoadOverMotion) else arguments_of(name, value, ARGUMENTS)
    if isinstance(value, LoadOverMotion) or (arguments == ("theta",) and derivative is None):
        return Acting(as_load(name, value))
    return Acting(UserFunction(name, value, arguments, unit, deadline, derivative))


def drive_of(
    torque: Any, F_X: Any, F_Y: Any, deadline: Deadline, derivative: TorqueDerivative | None = None
) -> Actuation:
    """Torque and forces; what is not given is 0. Functions are called within the time of a simulation."""
    return Actuation(
        acting("torque", torque, "N*m", deadline, derivative),
        acting("F_X", 0.0 if F_X is None else F_X, "N", deadline),
        acting("F_Y", 0.0 if F_Y is None else F_Y, "N", deadline),
    )


def model_of(values: Mapping[str, float], branch: int, theta0: float, drive: Actuation) -> Model:
    """The model of a design in the coordinate of its motion; ValueError if it cannot start at theta0."""
    lengths = tuple(values[name] for name in LENGTHS)
    coordinate = coordinate_of(values, theta0)
    if coordinate is None:
        if arc_around(theta0, *lengths) is None:
            start = "theta0 = " + amount("theta", theta0, "g")
            raise ValueError(start + ": it cannot be assembled there; " + _feasible(lengths))
        limit = ": that is a limit angle (S = 0), where no motion can start; "
        raise ValueError("theta0 = " + amount("theta", theta0) + limit + _feasible(lengths))
    return Model(values, branch, coordinate, drive)


def _feasible(lengths: tuple[float, ...]) -> Message:
    def angle(theta: float) -> Message:
        return amount("theta", theta, ".6g", says_unit=True)

    arcs = [angle(first) + " to " + angle(last) for first, last in theta_intervals(*lengths)]
    design = listed([named(name, value, "g") for name, value in zip(LENGTHS, lengths, strict=True)])
    if not arcs:
        return design + ": there is no mechanism"
    return "with " + design + " theta goes " + listed(arcs, " or ")


def check_inertia(model: Model, theta0: float) -> None:
    """ValueError where a motion starts without inertia."""
    inertia = float(model.inertia(theta0))
    if isnan(inertia):
        start = "theta0 = " + amount("theta", theta0, "g")
        raise ValueError(start + ": the effective inertia is not finite there")
    gaps = {which: _gap(theta0, angle) for which, angle in model.vanishing().items()}
    near = [which for which, gap in gaps.items() if gap <= SMALL]
    if near or inertia <= 0.0:
        moves = any(model.values[name] for name in MASSES)
        where = f" (the {near[0]} dead centre)" if near and moves else ""
        there = "M_eff = " + amount("M_eff", inertia, "g", says_unit=True)
        remedy = f"give {'m_crank or I_crank' if moves else 'masses'}, M_eff must be > 0"
        start = " at theta0 = " + amount("theta", theta0, "g") + where
        raise ValueError(there + start + f": nothing moves without inertia; {remedy}")


def _gap(theta: float, angle: float) -> float:
    """The distance of two crank angles, modulo whole turns."""
    return abs((theta - angle + pi) % TURN - pi)


def read_times(times: Any, t_end: float) -> Any:
    """The requested instants as an array; None for the default."""
    if times is None:
        return None
    try:
        array = np.array(times)
        if array.dtype.kind not in "fiu":
            raise TypeError
        array = array.astype(np.float64)
    except (ValueError, TypeError, OverflowError):
        raise TypeError(f"times = {shown(times)}: expected a row of finite instants in s") from None
    if array.ndim != 1 or not array.size or not np.isfinite(array).all():
        raise ValueError("times: expected a row of finite instants in s")
    wrong = (array < 0.0) | (array > t_end) | (np.diff(array, prepend=array[0]) < 0.0)
    if wrong.any():
        place = int(np.argmax(wrong))
        wrong_time, end = (amount("t", t, "g") for t in (array[place], t_end))
        rule = ": instants must ascend from 0 to t_end = "
        raise ValueError(f"times[{place}] = " + wrong_time + rule + end)
    return array


def read_knots(knots: Any) -> tuple[float, ...]:
    """The instants at which a torque or a load changes at once."""
    if knots is None:
        return ()
    several = knots if isinstance(knots, (list, tuple, np.ndarray)) else [knots]
    return tuple(scalar("knots", t, "s", 0.0, "a finite time >= 0") for t in several)


def read_until(until: Any) -> tuple[float, ...]:
    """The crank angles that end the motion."""
    if until is None:
        return ()
    several = until if isinstance(until, (list, tuple, np.ndarray)) else [until]
    return tuple(scalar("until", angle, "rad") for angle in several)


def read_wrt(wrt: Any, inputs: Mapping[str, Any]) -> tuple[str, ...]:
    """The parameters of the sensitivities of a motion: numbers of the call, whose loads have derivatives."""
    requested = (wrt,) if isinstance(wrt, str) else several(wrt)
    loads = {n: a for n, a in inputs.items() if isinstance(a, OfMotion)}
    own = [f"{force}.{number}" for force, load in loads.items() for number in load.numbers]
    own += inputs["torque"].numbers if isinstance(inputs.get("torque"), Motor) else ()
    for name in requested:
        if name in own:
            continue
        if name not in inputs:
            known = [*inputs, *own]
            asked = did_you_mean(name, known) if isinstance(name, str) else ""
            raise ValueError(f"wrt: no parameter {shown(name)}; {asked}there are {', '.join(known)}")
        if callable(inputs[name]):
            raise ValueError(
                f"wrt: {name} = {shown(inputs[name])} is no number, there is no derivative with respect to it"
            )
    for name in ("F_X", "F_Y"):
        load = inputs[name]
        if requested and callable(load) and not (isinstance(load, LoadOverMotion) and load.has_slope):
            raise TypeError(
                f"{name} = {shown(load)}: wrt= needs its derivative: give a table, or "
                "desaxe.over_theta(f, derivative=...)"
            )
    return requested


def read_rtol(rtol: Any) -> float:
    """The relative tolerance."""
    number = scalar("rtol", rtol, "1", 0.0, "a number from 3e-14 to 0.1")
    if not LEAST_RTOL <= number <= 0.1:
        raise ValueError(f"rtol = {shown(rtol)}: it must be a number from 3e-14 to 0.1")
    return number
