"""`drive`: torque, power, work, flywheel and starting torque required over a turn."""

from collections.abc import Mapping
from math import copysign, inf, nan, sqrt
from typing import Any

import numpy as np

from ...mechanism.inputs import Input
from ...mechanism.keywords import with_known_keywords
from ...mechanism.read import number_of
from ...peaks.peak import peak
from ...runtime.request import as_number
from ...support.panels import Array, Panels
from ...support.shown import shown
from ..turn.turn import CREEP, JAMS, NoCycleError, Turn, turn_of
from .inertia import flywheel_for
from .result import FIGURES, Drive

STALLED = 3
FLUCTUATION = Input(
    "fluctuation", "1", "", 1e-9, "a number above 0, at least 1e-09, and below 2, where the crank stops"
)
SAME = 1e-9  # of an extreme value
DIFFERENTIATED = tuple(name for name in FIGURES if not name.startswith("theta_"))


@with_known_keywords
def drive(
    *, fluctuation: float = 0.03, reverse: bool = False, branch: int = 1, sliders: Any = None, **inputs: Any
) -> Drive:
    """Torque, power, work, flywheel and starting torque that one turn of a design requires.

    fluctuation  (fastest - slowest)/mean speed that a flywheel is to keep under a constant torque: 0.1 or
                 "10 %"
    reverse      True: the starting torque is that for either way of turning
    sliders      filled in by a `Crankshaft`
    inputs       of one design with masses and loads, as in `evaluate`. omega0 is the speed of the crank; with
                 alpha it is that at theta = 0, and the turn is the first one. F_X and F_Y may vary
                 with the motion, over one turn or up to four: all figures are then of these

    Returns a dict, which prints as a report and has `plot()`. Means are over time:

    torque_mean, torque_rms   of T_in [N m]; the root of the mean square heats a motor
    torque_peak               the largest magnitude of T_in [N m], at `theta_peak` [rad]
    work_in, work_out         what the drive puts in and what it takes back in a turn [J], both >= 0
    power_mean, power_peak    net work over the time of a turn, and the largest magnitude of T_in omega [W]
    flywheel_inertia          [kg m2] on the crank: the smallest that keeps the required fluctuation about
                              |omega0|, the mean of fastest and slowest, under a constant torque; friction
                              included. 0 if none is needed, NaN with alpha
    flywheel_torque           that constant torque [N m]; without friction it is torque_mean
    starting_torque           what it takes to start from the worst standstill [N m], positive in the way of
                              turning: the largest torque over theta that loads, gravity and friction hold
                              against; at `theta_start` [rad]. Infinite where friction jams
    period, fluctuation       time of a turn, or of those after which loads repeat [s]; as given
    gradient                  dict name -> dict input -> exact derivative, of all but the angles, by each
                              input that is a number and matters; of the flywheel by `fluctuation` too. At
                              a jump or kink of a load it is that of the limit, which moves along; NaN at
                              a kink that friction makes
    status                    0 ok; 1 the crank cannot turn fully; 2 at a change point (derivatives by the
                              lengths are NaN); 3 stalls within the turn; 5 friction jams, 6 two sets of
                              forces balance. All is NaN but for 0 and 2

    Integrals are taken to rounding, by Gauss's rule between the angles at which friction or a load has kinks,
    on panels that are halved until the torque and its derivatives are resolved. Raises ValueError for a bad
    input and for a crank at rest, TypeError for a missing input or an array.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.drive(ec=0.01, AB=0.05, BC=0.2, omega0=30.0, m_slider=2.0, F_Y=-500.0, mu=0.1)
        >>> [round(found[name], 3) for name in ("torque_mean", "torque_peak", "flywheel_inertia")]
        [0.323, 26.468, 1.845]
    """
    required = fluctuation_of(fluctuation)
    design = design_of("drive", inputs, branch, sliders)
    status = _status(design)
    found: dict[str, Any] = dict.fromkeys(FIGURES, nan)
    slopes = {name: dict.fromkeys(design.parameters, nan) for name in DIFFERENTIATED}
    course: dict[str, Array] = {}
    try:
        if status in (0, 2):
            _over_a_turn(design, found, slopes, course)
            if "alpha" not in design.numbers:
                _flywheel(design, required, found, slopes, course)
            _starting(design, reverse, found, slopes)
    except NoCycleError as error:
        status, course = error.status, {}
        found = dict.fromkeys(FIGURES, nan)
    if status:
        lost = design.parameters if status != 2 else [n for n in ("ec", "AB", "BC") if n in design.parameters]
        for gradient in slopes.values():
            gradient.update(dict.fromkeys(lost, nan))
    figures = {name: float(value) for name, value in found.items()}
    gradients = {name: {by: float(slope) for by, slope in own.items()} for name, own in slopes.items()}
    about = {"fluctuation": required, "gradient": gradients, "status": status}
    inputs = {**design.numbers, **design.loads}
    return Drive({**figures, **about}, inputs, design.branch, course, design.turns)


def design_of(caller: str, inputs: Mapping[str, Any], branch: int, sliders: Any = None) -> Turn:
    """A design whose crank turns."""
    design = turn_of(caller, inputs, branch, sliders, accelerates=True)
    if "omega0" not in design.numbers:
        as_number("omega0", None, ("ec", "AB", "BC", "omega0"), (caller,))
    if not design.numbers["omega0"]:
        raise ValueError(f"{caller}: omega0 = 0 gives no cycle; it must be the speed of the crank")
    return design


def fluctuation_of(given: Any) -> float:
    """A fluctuation of speed that a flywheel can keep, 0.1 or "10 %"; ValueError for any other."""
    number = number_of(FLUCTUATION, given)
    if number is None or number >= 2.0:
        raise ValueError(f"fluctuation = {shown(given)}: it must be {FLUCTUATION.limit}")
    return number


def _status(design: Turn) -> int:
    """The status from geometry and speed alone, without forces."""
    if design.margin < 0.0:
        return 1
    way = 2.0 * design.angle * design.direction
    last = design.numbers["omega0"] ** 2 + way * design.numbers.get("alpha", 0.0)
    if last <= 0.0:
        return STALLED
    return 2 if design.margin == 0.0 else 0


def _over_a_turn(
    design: Turn, found: dict[str, Any], slopes: dict[str, dict[str, float]], course: dict[str, Array]
) -> None:
    """The figures other than flywheel and starting torque, and the arrays of torque and power."""
    names = ["T_in", *(f"T_in_wrt_{name}" for name in design.parameters)]
    turn = design.panels(names)
    turn = turn.split(turn.roots(turn.values["T_in"]).tolist())
    torque, way = turn.values["T_in"], design.direction
    by = {name: turn.values[f"T_in_wrt_{name}"] for name in design.parameters}
    alpha = design.numbers.get("alpha", 0.0)
    speed = np.sqrt(design.numbers["omega0"] ** 2 + 2.0 * alpha * turn.x)
    speed_by = {"omega0": design.numbers["omega0"] / speed, "alpha": turn.x / speed}
    period = turn.integral(1.0 / speed)
    mean = turn.integral(torque / speed) / period
    square = turn.integral(torque**2 / speed) / period
    net = way * turn.integral(torque)
    driven = way * torque > 0.0
    rms = sqrt(square)
    found |= {
        "period": period,
        "torque_mean": mean,
        "torque_rms": rms,
        "work_in": turn.integral(np.where(driven, way * torque, 0.0)),
        "work_out": turn.integral(np.where(driven, 0.0, -way * torque)),
        "power_mean": net / period,
    }
    before, after = turn.ends(torque)[:, 1], np.roll(turn.ends(torque)[:, 0], -1)
    jump, moves = before - after, design.moves(["T_in"], turn.edges[1:])
    rate = np.sqrt(design.numbers["omega0"] ** 2 + 2.0 * alpha * turn.edges[1:])

    def moving(name: str, jump: Array) -> float:
        """The derivative of an integral by an input that moves the jumps of what is integrated."""
        return float((jump * moves[name]).sum()) if name in moves else 0.0

    for name, slope in by.items():
        shorter = speed_by.get(name, 0.0) / speed**2 + 0.0 * speed  # what 1/speed loses
        longer = -turn.integral(shorter) + 0.0
        by_mean = turn.integral(slope / speed - torque * shorter) + moving(name, jump / rate)
        by_square = turn.integral(2.0 * torque * slope / speed - torque**2 * shorter)
        by_square += moving(name, (before**2 - after**2) / rate)
        by_net = turn.integral(slope) + moving(name, jump)
        by_in, by_out = (
            turn.integral(np.where(part, side * slope, 0.0))
            + moving(name, np.maximum(side * before, 0.0) - np.maximum(side * after, 0.0))
            for part, side in ((driven, way), (~driven, -way))
        )
        rows = {
            "period": longer,
            "torque_mean": (by_mean - mean * longer) / period,
            "torque_rms": (by_square - square * longer) / (2.0 * rms * period) if rms else 0.0,
            "work_in": by_in,
            "work_out": by_out,
            "power_mean": (way * by_net - net / period * longer) / period,
        }
        for figure, value in rows.items():
            slopes[figure][name] = value
    power_by = {n: way * (s * speed + torque * speed_by.get(n, 0.0)) for n, s in by.items()}
    power = way * torque * speed
    found["torque_peak"], place = _peak(design, "T_in", turn, torque, by, slopes["torque_peak"])
    found["power_peak"], _ = _peak(design, "power_in", turn, power, power_by, slopes["power_peak"])
    found["theta_peak"] = _in_cycle(place, design)
    course |= {"theta": turn.places, "T_in": turn.samples(torque), "power_in": turn.samples(power)}


def _peak(
    design: Turn,
    name: str,
    turn: Panels,
    values: Array,
    by: dict[str, Array],
    gradient: dict[str, float],
) -> tuple[float, float]:
    """The largest magnitude and its angle; the derivatives there."""
    value, place, inside = max(
        (turn.extreme(values, sign) for sign in (1.0, -1.0)), key=lambda one: abs(one[0])
    )
    if not inside:
        gradient |= _at_edge(design, name, "absmax", abs(value))
        return abs(value), place
    for parameter, slope in by.items():
        sign = copysign(1.0, value) if value else nan
        gradient[parameter] = sign * float(turn.at(np.array([place]), slope)[0])
    return abs(value), place


def _at_edge(design: Turn, name: str, kind: str, value: float, **other: Any) -> dict[str, float]:
    """The derivatives of an extreme value that is reached between panels, at a jump or kink that may move."""
    inputs = {n: x for n, x in {**design.numbers, **design.loads, **other}.items() if x is not None}
    found = peak(name, kind=kind, theta=design.ends, branch=design.branch, **inputs)
    same = abs(found["value"] - value) <= SAME * abs(value)
    return {p: found["gradient"].get(p, nan) if same else nan for p in design.parameters}


def _flywheel(
    design: Turn,
    fluctuation: float,
    found: dict[str, Any],
    slopes: dict[str, dict[str, float]],
    course: dict[str, Array],
) -> None:
    """The inertia and its derivatives; the speed over the turn with it."""
    wheel = flywheel_for(design, fluctuation)
    if wheel is None:
        return
    found |= {"flywheel_inertia": wheel.inertia, "flywheel_torque": wheel.torque}
    slopes |= {"flywheel_inertia": wheel.gradient, "flywheel_torque": wheel.torque_gradient}
    course |= {"theta_of_speed": wheel.theta, "speed": np.abs(wheel.omega)}


def _starting(
    design: Turn, reverse: bool, found: dict[str, Any], slopes: dict[str, dict[str, float]]
) -> None:
    """The torque that starts the crank from any standstill, forwards or, in reverse, either way."""
    names = [name for name in design.parameters if name not in ("omega0", "alpha")]
    wanted = ["T_in", *(f"T_in_wrt_{name}" for name in names)]
    best, gradient = -inf, dict.fromkeys(design.parameters, 0.0)
    for way in (design.direction, -design.direction)[: 2 if reverse else 1]:
        creep: dict[str, Any] = {"omega0": way * CREEP, "alpha": None}
        try:
            turn = design.panels(wanted, **creep)
        except NoCycleError as error:
            found["starting_torque"] = inf if error.status == JAMS else nan
            slopes["starting_torque"] = dict.fromkeys(design.parameters, nan)
            return
        value, place, inside = turn.extreme(way * turn.values["T_in"], 1.0)
        if value > best:
            best, found["theta_start"] = value, place % design.angle
            if inside:
                here = {n: float(turn.at(np.array([place]), turn.values[f"T_in_wrt_{n}"])[0]) for n in names}
            else:
                here = _at_edge(design, "T_in", "max" if way > 0.0 else "min", way * value, **creep)
            gradient |= {n: way * here[n] for n in names}
    found["starting_torque"] = best if abs(best) > CREEP else 0.0
    slopes["starting_torque"] = gradient


def _in_cycle(theta: float, design: Turn) -> float:
    """An angle shifted into the cycle; unchanged with alpha, where turns differ."""
    return theta if "alpha" in design.numbers else theta % design.angle
