"""`steady`: the periodic motion of a machine on its motor, and its derivatives."""

from collections.abc import Mapping
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import are_good, as_array, broadcast_shape
from ...evaluation.under_loads.loaded import loads_of
from ...loads.along_motion import with_derivatives
from ...loads.angles import turns_of
from ...mechanism.inputs import INPUTS, Input
from ...mechanism.keywords import check_inputs, with_known_keywords
from ...mechanism.messages import named
from ...mechanism.names import LENGTHS
from ...mechanism.read import read_array
from ...runtime.request import as_number, check_common, check_sliders
from ...support.shown import shown
from .designs import DesignRows
from .inertia import with_flywheels
from .result import Steady, result_of
from .source import TorqueSource, source_of
from .states import states_of

Array = NDArray[Any]
OWN = ("torque", "flywheel_inertia", "fluctuation", "branch")
SPEEDS = ("omega0", "omega", "alpha")
MOST_TURNS = 4  # after which loads repeat; two in a four-stroke engine
CHUNK = 1000  # designs at once
FLYWHEEL = Input("flywheel_inertia", "kg*m^2", "", 0.0, "a finite moment of inertia >= 0")
FLUCTUATION = Input("fluctuation", "1", "", 1e-9, "a number above 0, at least 1e-9, and below 2")


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
    sliders           filled in by a `Crankshaft`, without friction
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
    source = source_of(torque)
    shape, designs, bad = _designs(source, flywheel_inertia, fluctuation, branch, inputs, sliders)
    wanted = None if fluctuation is None else _flat(_row(FLUCTUATION, fluctuation), shape)
    if wanted is not None and (not np.isfinite(wanted).all() or (wanted >= 2.0).any()):
        raise ValueError(f"fluctuation = {shown(fluctuation)}: it must be {FLUCTUATION.limit}")
    good = np.flatnonzero(~bad)
    parts = []
    for first in range(0, max(len(good), 1), CHUNK):
        index = good[first : first + CHUNK]
        part = designs.rows(index)
        if wanted is not None:
            part = with_flywheels(part, wanted[index])
        parts.append((index, part, states_of(part), wanted is not None))
    made_of = {**designs.numbers, **designs.loads, **({} if sliders is None else {"sliders": sliders})}
    about = {"inputs": made_of, "torque": torque, "branch": int(branch)}
    return result_of(shape, parts, about)


def _row(row: Input, value: Any) -> Array:
    """A number or an array of them within the limit of a row."""
    array = read_array(row, value)
    with np.errstate(invalid="ignore"):
        wrong = ~np.isfinite(array) | (array < (row.least or 0.0))
    if wrong.any():
        raise ValueError(named(row.name, array[wrong].item(0)) + f": it must be {row.limit}")
    return array


def _flat(array: Array, shape: tuple[int, ...]) -> Array:
    return np.broadcast_to(array, shape).reshape(-1)


def _designs(
    source: TorqueSource,
    flywheel: Any,
    fluctuation: Any,
    branch: int,
    inputs: Mapping[str, Any],
    sliders: Any,
) -> tuple[tuple[int, ...], DesignRows, NDArray[np.bool_]]:
    """The shape of the designs, these in rows, and which of them have a bad input."""
    given = {name: value for name, value in inputs.items() if value is not None}
    check_sliders(sliders)
    turn = (
        None
        if sliders is None
        else sliders.turn("steady", {n: v for n, v in given.items() if n not in SPEEDS})
    )
    given = given if turn is None else {n: v for n, v in given.items() if n in SPEEDS}
    if turn is not None and turn.has_friction:
        raise ValueError("steady: of several sliders without friction, mu = 0")
    if turn is not None and turn.sliders.follows_speed:
        raise ValueError("steady: loads of several sliders must not depend on the speed")
    check_inputs("steady", given, [*OWN, *(n for n in INPUTS if n != "theta")])
    check_common(given, branch)
    numbers, loads = loads_of(given)
    if np.any(np.asarray(numbers.pop("alpha", 0.0), float)):
        raise ValueError("alpha: steady finds the speed over a turn itself; leave it out")
    for name in LENGTHS:
        if turn is None and name not in numbers:
            as_number(name, None, LENGTHS, ("steady",))
    arrays = {name: as_array(name, value, LENGTHS, ("steady",)) for name, value in numbers.items()}
    speed = arrays.pop("omega0", None)
    speed = arrays.pop("omega", speed)
    loads = with_derivatives(loads, {**arrays, "omega": 1.0 if speed is None else speed})
    motor = {name: np.asarray(value, float) for name, value in source.numbers.items()}
    J = _row(FLYWHEEL, flywheel)
    extra = {"flywheel_inertia": J}
    if fluctuation is not None and J.any():
        rule = "give one of them; a flywheel that stays is a part of I_crank"
        wheel = named("flywheel_inertia", flywheel)
        raise ValueError(wheel + f", fluctuation = {shown(fluctuation)}: {rule}")
    if fluctuation is not None:
        extra["fluctuation"] = read_array(FLUCTUATION, fluctuation)
    if speed is not None and source.way is None:
        extra["omega0"] = speed
    shape = broadcast_shape({**arrays, **motor, **extra})
    empty = next((n for n, a in {**arrays, **motor, **extra}.items() if not a.size), None)
    if empty is not None:
        raise ValueError(f"{empty}: an empty array; expected at least one design")
    way = (
        source.way if source.way is not None else (1.0 if speed is None else np.where(speed < 0.0, -1.0, 1.0))
    )
    count = int(np.prod(shape))

    def rows(values: Mapping[str, Array]) -> dict[str, Any]:
        return {n: _flat(v, shape) if v.ndim else v.item() for n, v in values.items()}

    turning: dict[str, Any] = dict(loads)
    if source.load is not None:
        turning["torque"] = source.load
    designs = DesignRows(
        count, rows(arrays), loads, int(branch), source, rows(motor), _flat(J, shape),
        _flat(np.asarray(way, float), shape), _turns(turning, turn), turn,
    )  # fmt: skip
    return shape, designs, _bad(designs)


def _turns(loads: Mapping[str, Any], turn: Any) -> int:
    """After how many turns everything repeats."""
    turns = turns_of("steady", loads, MOST_TURNS)
    return turns if turn is None else lcm(turns, turn.turns)


def _bad(designs: DesignRows) -> NDArray[np.bool_]:
    """True for designs with a bad input."""
    bad = np.zeros(designs.size, bool)
    for name, value in designs.numbers.items():
        bad |= ~are_good(name, np.asarray(value))
    for value in designs.motor.values():
        bad |= ~np.isfinite(value)
    return bad
