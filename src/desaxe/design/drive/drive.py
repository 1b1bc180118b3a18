"""`drive`: torque, power, work, flywheel and starting torque required over a turn."""

from math import inf, nan, sqrt
from typing import Any

import numpy as np

from ...mechanism.inputs import Input
from ...mechanism.keywords import with_known_keywords
from ...mechanism.read import number_of
from ...mechanism.status import DriveStatus
from ...peaks.peak import peak
from ...runtime.request import as_number
from ...support.panels import Array
from ...support.shown import shown
from ..turn.cycle import integrated
from ..turn.turn import CREEP, JAMS, NoCycleError, Turn, turn_of
from .inertia import flywheel_for
from .result import FIGURES, Drive

STALLED = 3
FLUCTUATION = Input(
    "fluctuation", "1", "", 1e-9, "a number of at least 1e-9, and below 2, where the crank stops"
)
TWO_BALANCES = int(DriveStatus.TWO_FORCE_BALANCES)
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
                              and loads over the speed are those of that motion. 0 if none is needed, NaN
                              with alpha and where none settles
    flywheel_torque           that constant torque [N m]: torque_mean where neither friction nor a load
                              depends on the speed, next to it for a small fluctuation
    starting_torque           what it takes to start from the worst standstill [N m], positive in the way of
                              turning: the largest torque over theta that loads, gravity and friction hold
                              against; at `theta_start` [rad]. Infinite where friction jams
    period, fluctuation       time of a turn, or of those after which loads repeat [s]; as given
    gradient                  dict name -> dict input -> exact derivative, of all but the angles, by each
                              input that is a number and matters; of the flywheel by `fluctuation` too. At
                              a jump or kink of a load it is that of the limit, which moves along; NaN at
                              a kink that friction makes
    status                    0 ok; 1 the crank cannot turn fully; 2 at a change point (derivatives with
                              respect to the lengths are NaN); 3 stalls within the turn; 5 friction jams, 6
                              two sets of forces balance. All is NaN but for 0 and 2

    Integrals are taken to rounding, by Gauss's rule between the angles at which friction or a load has kinks,
    on panels that are halved until the torque and its derivatives are resolved. Raises ValueError for a bad
    input and for a crank at rest, TypeError for a missing input or an array.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.drive(ec=0.01, AB=0.05, BC=0.2, omega0=30.0, m_slider=2.0, F_Y=-500.0, mu=0.1)
        >>> [round(found[name], 3) for name in ("torque_mean", "torque_peak", "flywheel_inertia")]
        [0.323, 26.468, 1.845]
    """
    required = number_of(FLUCTUATION, fluctuation)
    if required is None or required >= 2.0:
        raise ValueError(f"fluctuation = {shown(fluctuation)}: it must be {FLUCTUATION.limit}")
    design = turn_of("drive", inputs, branch, sliders, accelerates=True)
    if "omega0" not in design.numbers:
        as_number("omega0", None, ("ec", "AB", "BC", "omega0"), ("drive",))
    if not design.numbers["omega0"]:
        raise ValueError("drive: omega0 = 0 gives no cycle; it must be the speed of the crank")
    status = _status(design)
    result: dict[str, Any] = dict.fromkeys(FIGURES, nan)
    slopes = {name: dict.fromkeys(design.parameters, nan) for name in DIFFERENTIATED}
    course: dict[str, Array] = {}
    try:
        if status in (0, 2):
            course = _over_a_turn(design, result, slopes)
            wheel = flywheel_for(design, required) if "alpha" not in design.numbers else None
            if wheel is not None:
                motion, by = wheel
                result |= {"flywheel_torque": motion.torque, "flywheel_inertia": motion.inertia}
                for k, figure in enumerate(("flywheel_torque", "flywheel_inertia")):
                    slopes[figure] = {name: pair[k] for name, pair in by.items()}
                speed = np.abs(motion.panels.values["omega"]).ravel()
                course |= {"theta_of_speed": motion.panels.x.ravel(), "speed": speed}
            _starting(design, reverse, result, slopes)
    except NoCycleError as error:
        status, course = error.status, {}
        result = dict.fromkeys(FIGURES, nan)
    if status:
        lost = design.parameters if status != 2 else [n for n in ("ec", "AB", "BC") if n in design.parameters]
        for gradient in slopes.values():
            gradient.update(dict.fromkeys(lost, nan))
    figures = {name: float(value) for name, value in result.items()}
    gradients = {name: {by: float(slope) for by, slope in own.items()} for name, own in slopes.items()}
    about = {"fluctuation": required, "gradient": gradients, "status": status}
    inputs = {**design.numbers, **design.loads}
    return Drive({**figures, **about}, inputs, design.branch, course, design.turns)


def _status(design: Turn) -> int:
    """The status from geometry and speed alone, without forces."""
    if design.margin < 0.0:
        return 1
    way = 2.0 * design.angle * design.direction
    last = design.numbers["omega0"] ** 2 + way * design.numbers.get("alpha", 0.0)
    if last <= 0.0:
        return STALLED
    return 2 if design.margin == 0.0 else 0


def _integrands(torque: Array, speed: Array) -> dict[str, tuple[Array, Any, Any]]:
    """Integrands over the angle, and their derivatives with respect to torque and speed."""
    driven = torque > 0.0
    return {
        "time": (1.0 / speed, 0.0, -1.0 / speed**2),
        "mean": (torque / speed, 1.0 / speed, -torque / speed**2),
        "square": (torque**2 / speed, 2.0 * torque / speed, -((torque / speed) ** 2)),
        "net": (torque, 1.0, 0.0),
        "work_in": (np.where(driven, torque, 0.0), np.where(driven, 1.0, 0.0), 0.0),
        "work_out": (np.where(driven, 0.0, -torque), np.where(driven, 0.0, -1.0), 0.0),
    }


def _over_a_turn(
    design: Turn, result: dict[str, Any], slopes: dict[str, dict[str, float]]
) -> dict[str, Array]:
    """The figures other than flywheel and starting torque; arrays of torque and power."""
    names, way = ["T_in", *(f"T_in_wrt_{name}" for name in design.parameters)], design.direction
    turn = design.panels(names)
    turn = turn.split(turn.roots(turn.values["T_in"]).tolist())
    torque = way * turn.values["T_in"]
    start, alpha = design.numbers["omega0"], design.numbers.get("alpha", 0.0)
    speed, rate = (np.sqrt(start**2 + 2.0 * alpha * theta) for theta in (turn.x, turn.edges[1:]))
    speed_by = {"omega0": start / speed, "alpha": turn.x / speed}
    after, before = turn.ends(torque).T
    jumps = _integrands(before, rate), _integrands(np.roll(after, -1), rate)
    moves = design.moves(["T_in"], turn.edges[1:])
    total: dict[str, float] = {}
    by: dict[str, dict[str, float]] = {}
    for key, (value, by_torque, by_speed) in _integrands(torque, speed).items():
        each = {
            p: by_torque * way * turn.values[f"T_in_wrt_{p}"] + by_speed * speed_by.get(p, 0.0 * speed)
            for p in design.parameters
        }
        total[key], by[key] = integrated(turn, value, jumps[0][key][0] - jumps[1][key][0], each, moves)
    period, longer = total["time"], by["time"]
    mean, power = total["mean"] / period, total["net"] / period
    rms = sqrt(total["square"] / period)
    result |= {
        "period": period, "torque_mean": way * mean, "torque_rms": rms, "power_mean": power,
        "work_in": total["work_in"], "work_out": total["work_out"],
    }  # fmt: skip
    for p in design.parameters:
        rows = {
            "period": longer[p],
            "torque_mean": way * (by["mean"][p] - mean * longer[p]) / period,
            "torque_rms": (by["square"][p] - rms**2 * longer[p]) / (2.0 * rms * period) if rms else 0.0,
            "work_in": by["work_in"][p],
            "work_out": by["work_out"][p],
            "power_mean": (by["net"][p] - power * longer[p]) / period,
        }
        for figure, slope in rows.items():
            slopes[figure][p] = slope
    for figure, name in (("torque_peak", "T_in"), ("power_peak", "power_in")):
        top = _peak(design, name, "absmax")
        result[figure], slopes[figure] = top["value"], top["gradient"]
        result["theta_peak"] = top["theta"] if name == "T_in" else result["theta_peak"]
    if "alpha" not in design.numbers:  # else turns differ
        result["theta_peak"] %= design.angle
    samples = turn.samples(torque)
    return {"theta": turn.places, "T_in": way * samples, "power_in": samples * turn.samples(speed)}


def _peak(design: Turn, name: str, kind: str, **other: Any) -> dict[str, Any]:
    """The extreme value over the cycle, its angle, and its derivatives with respect to the parameters."""
    inputs = {n: x for n, x in {**design.numbers, **design.loads, **other}.items() if x is not None}
    top = peak(name, kind=kind, theta=design.ends, branch=design.branch, **inputs)
    return {**top, "gradient": {p: top["gradient"].get(p, 0.0) for p in design.parameters}}


def _starting(
    design: Turn, reverse: bool, result: dict[str, Any], slopes: dict[str, dict[str, float]]
) -> None:
    """The torque that starts the crank from any standstill, forwards or, in reverse, either way."""
    result["starting_torque"] = -inf
    for way in (design.direction, -design.direction)[: 2 if reverse else 1]:
        top = _peak(design, "T_in", "max" if way > 0.0 else "min", omega0=way * CREEP, alpha=None)
        if top["status"] in (JAMS, TWO_BALANCES):
            result["starting_torque"] = inf if top["status"] == JAMS else nan
            slopes["starting_torque"] = dict.fromkeys(design.parameters, nan)
            return
        if way * top["value"] > result["starting_torque"]:
            result["starting_torque"], result["theta_start"] = way * top["value"], top["theta"] % design.angle
            still = {p: 0.0 if p in ("omega0", "alpha") else way * by for p, by in top["gradient"].items()}
            slopes["starting_torque"] = still
    if abs(result["starting_torque"]) <= CREEP:
        result["starting_torque"] = 0.0
