"""`steady`: the periodic motion of a machine on its motor, and its derivatives."""

from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.labelled import refuse_other_labels
from ...loads.angles import turns_of
from ...mechanism.inputs import INPUTS, Input
from ...mechanism.keywords import check_inputs, with_known_keywords
from ...mechanism.messages import named
from ...mechanism.names import LENGTHS
from ...mechanism.read import read_array
from ...runtime.request import check_common, check_sliders
from ...support.shown import shown
from ..turn.cycle import MOST_TURNS, input_rows
from .designs import DesignRows
from .result import Steady, result_of
from .source import source_of
from .states import states_of, with_flywheels

Array = NDArray[Any]
OWN = ("torque", "flywheel_inertia", "fluctuation", "branch")
SPEEDS = ("omega0", "omega", "alpha")
CHUNK = 1000  # designs at once
FLYWHEEL = Input("flywheel_inertia", "kg*m^2", "", 0.0, "a finite moment of inertia >= 0")
FLUCTUATION = Input("fluctuation", "1", "", 1e-9, "a number of at least 1e-9, and below 2")


@with_known_keywords
def steady(
    *,
    torque: Any,
    flywheel_inertia: Any = 0.0,
    fluctuation: Any = None,
    branch: int = 1,
    sliders: Any = None,
    **inputs: Any,
) -> Steady:
    """The steady state of a machine on its motor: the periodic motion that it settles into.

    torque            of the motor on the crank [N m], positive like theta: `kloss`, `over_omega`, a function
                      (numba may have compiled it) of theta and omega, by the names of its arguments,
                      `over_theta`, or a number, which fixes a speed only where the guide has friction
    flywheel_inertia  added to the crank [kg m2]
    fluctuation       the smallest flywheel that keeps this one is found instead
    sliders           filled in by a `Crankshaft`
    inputs            lengths, masses, loads as in `evaluate`; F_X and F_Y may vary with the motion, over up
                      to four turns. omega0 only says which way the crank turns, if the motor does not

    In theta the kinetic energy obeys one scalar equation. All of its stable periodic solutions are found and
    polished to rounding. Returns a dict with the values of the stable one at the highest speed:

    theta, omega, T_motor   arrays over a period, in the way of turning: angle [rad], speed, motor's torque
    period, omega_mean      time of a turn, or of those after which the loads repeat [s]; their angle over it
    fluctuation             (fastest - slowest)/omega_mean
    power_mean, work        of the motor [W], and in a period [J]
    multiplier, stable      what is left of a small change of energy after a period; stable below 1
    gradient                dict of period, omega_mean, fluctuation, power_mean -> dict parameter -> exact
                            derivative, by each number given: inputs, flywheel_inertia, those of the motor.
                            With `fluctuation`, at the flywheel found, and of `flywheel_inertia` besides
    flywheel_inertia        as given or found
    others                  list of dicts as this one: the other stable motions, by descending speed
    status, message         0 ok; 1 none: all is NaN, and `message` says whether the motor is too weak, and
                            where it stalls, or too strong; 4 bad input

    Every number may be an array, also those of `kloss`: all broadcast like NumPy. Then all values are arrays
    of that shape (theta, omega and T_motor have one axis more), others and message of objects.

    Raises ValueError for a bad input, TypeError for a missing or an unknown one.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> motor = dx.kloss(40.0, 0.15, 157.08, gear=12)
        >>> press = dict(ec=0.01, AB=0.05, BC=0.2, m_slider=20.0, I_crank=2.0, F_Y=-900.0)
        >>> found = dx.steady(torque=motor, **press)
        >>> [round(found[name], 3) for name in ("omega_mean", "fluctuation", "power_mean")]
        [13.09, 0.015, 0.013]
    """
    refuse_other_labels({**inputs, FLYWHEEL.name: flywheel_inertia, FLUCTUATION.name: fluctuation})
    source, J = source_of(torque), _row(FLYWHEEL, flywheel_inertia)
    more = {name: np.asarray(value, float) for name, value in source.numbers.items()}
    more["flywheel_inertia"] = J
    if fluctuation is not None:
        more["fluctuation"] = _row(FLUCTUATION, fluctuation)
        if J.any():
            rule = ": give one of them; a flywheel that stays is a part of I_crank"
            wheel = named("flywheel_inertia", flywheel_inertia)
            raise ValueError(wheel + f", fluctuation = {shown(fluctuation)}" + rule)
        if (more["fluctuation"] >= 2.0).any():
            raise ValueError(f"fluctuation = {shown(fluctuation)}: it must be {FLUCTUATION.limit}")
    given, turn = _of_sliders(sliders, {n: v for n, v in inputs.items() if v is not None})
    check_inputs("steady", given, [*OWN, *(n for n in INPUTS if n != "theta")])
    check_common(given, branch)
    if np.any(np.asarray(given.pop("alpha", 0.0), float)):
        raise ValueError("alpha: steady finds the speed over a turn itself; leave it out")
    rows = input_rows("steady", given, more, LENGTHS if turn is None else ())
    if not rows.size:
        raise ValueError("steady: an empty array; expected at least one design")
    speeds = [rows.numbers.pop(name) for name in ("omega", "omega0") if name in rows.numbers]
    way = np.where(rows.each(speeds[0] if speeds else 1.0) < 0.0, -1.0, 1.0)
    if source.way is not None:
        way = np.broadcast_to(source.way, rows.shape).reshape(-1)
    turning = {**rows.loads, **({} if source.load is None else {"torque": source.load})}
    turns = lcm(turns_of("steady", turning, MOST_TURNS), 1 if turn is None else turn.turns)
    motor = {name: rows.more[name] for name in source.numbers}
    designs = DesignRows(
        rows.size, rows.numbers, rows.loads, int(branch), source, motor,
        rows.each(rows.more["flywheel_inertia"]), way, turns, turn,
    )  # fmt: skip
    good, parts = np.flatnonzero(~rows.bad), []
    for first in range(0, max(len(good), 1), CHUNK):
        index = good[first : first + CHUNK]
        part = designs.rows(index)
        if fluctuation is not None:
            part = with_flywheels(part, rows.each(rows.more["fluctuation"])[index])
        parts.append((index, part, states_of(part), fluctuation is not None))
    made_of = {**rows.numbers, **rows.loads, **({} if sliders is None else {"sliders": sliders})}
    return result_of(rows.shape, parts, {"inputs": made_of, "torque": torque, "branch": int(branch)})


def _row(row: Input, value: Any) -> Array:
    """A number or an array of them within the limit of a row."""
    array = read_array(row, value)
    with np.errstate(invalid="ignore"):
        wrong = ~np.isfinite(array) | (array < (row.least or 0.0))
    if wrong.any():
        raise ValueError(named(row.name, array[wrong].item(0)) + f": it must be {row.limit}")
    return array


def _of_sliders(sliders: Any, inputs: dict[str, Any]) -> tuple[dict[str, Any], Any]:
    """The inputs, and the turn of several sliders, which has all of them but the speed."""
    check_sliders(sliders)
    if sliders is None:
        return inputs, None
    turn = sliders.turn("steady", {n: v for n, v in inputs.items() if n not in SPEEDS})
    return {n: v for n, v in inputs.items() if n in SPEEDS}, turn
