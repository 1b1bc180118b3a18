"""`events`: the dead centres of a design, its strokes, and the extremes of its rod and slider."""

from collections.abc import Callable, Mapping
from math import copysign, inf, nan, pi, ulp
from typing import Any, NamedTuple

from ...evaluation.evaluate import evaluate
from ...mechanism.closed.dead_centres import DEAD_CENTRES, PLACES, SENSITIVITIES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS, WHOLE, sensitivity
from ...mechanism.quantity_units import slopes_of, unit_of, units_by_name
from ...mechanism.status import TurnStatus
from ...runtime.request import as_number, check_common, with_known_inputs
from ...support.answer import Answer
from ...support.forks import IMPORTS
from ...support.roots import root, roots

VELOCITIES = {"V_outward": 1, "V_inward": -1}  # name -> direction along the stroke
BESIDE = 4.0 * ulp(pi)  # rad: next to an angle, on whichever side of it rounding has put that
SPEEDS = ["V_C", *(f"V_C_wrt_{p}" for p in (*LENGTHS, "omega0"))]
NAMES = (*WHOLE, *SENSITIVITIES, *PLACES)


class Numbers(NamedTuple):
    """The operations on values of designs: `FLOATS` of one in plain Python, else those of NumPy."""

    choose: Callable[[Any, Any, Any], Any]
    root: Callable[..., Any]  # of a function between two ends, and its values there
    copysign: Callable[[float, Any], Any]


FLOATS = Numbers(lambda condition, a, b: a if condition else b, lambda f, a, b, *_: root(f, a, b), copysign)


@with_known_inputs
def events(*, ec: Any, AB: Any, BC: Any, branch: int = 1, omega0: Any = None) -> dict[str, Any]:
    """Timing of the stroke: dead centres, advance and return, and the extremes in between, of designs.

    ec, AB, BC  lengths [m], numbers or texts with a unit or arrays, which broadcast like NumPy
    branch      +1 or -1
    omega0      constant speed of the crank [rad/s]; negative turns backwards. Without it the crank turns
                forwards, and velocities are per angle that it turns [m/rad]

    Returns a dict, floats for one design and arrays for many. Angles are in the turn from -pi/2 to
    3 pi/2, in which dead centres move without a jump when `ec` changes its sign:

    theta_outer, theta_inner    crank angles [rad] at which the slider is farthest from the crank and nearest
                                to it: near 0 and near pi (the other way round on branch -1)
    Y_outer, Y_inner            where the slider is then [m]
    stroke                      the distance between them [m]
    advance_angle               the angle [rad] that the crank turns while the slider moves outward
    return_angle                and while it moves inward; both together are 2 pi
    time_ratio                  the longer of both over the shorter, at constant speed; at least 1
    slow_stroke                 which is the longer: +1 outward, -1 inward, 0 both the same or none
    max_pressure_angle, min_transmission_angle   of the rod [rad], both at `theta_max_pressure_angle`
    min_pressure_angle, max_transmission_angle   both at `theta_min_pressure_angle` (one of two angles
                                                 where |ec| < AB)
    V_outward, V_inward         the largest speed of the slider in each stroke, at `theta_V_outward`
                                and `theta_V_inward`
    gradient                    dict name -> dict ec, AB, BC (omega0) -> exact derivative. Where |ec| has a
                                kink, at ec = 0, the mean of both sides; at a change point what is
                                infinite is infinite
    status                      0 the crank turns fully; 1 it does not: dead centres are given if there are
                                such, all else is NaN; 2 at a change point, margin = 0; 4 bad input

    Closed forms in which nothing cancels (`mechanism/closed/dead_centres.py`), but for the velocities: those
    are refined between the dead centres by the exact acceleration. Source: paper B, Secs. 2 and
    4.2.1, Eq. 51, where advance is the stroke outward. Raises as `evaluate` does.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.events(ec=0.020, AB=0.040, BC=0.064)
        >>> round(found["stroke"], 5), round(found["time_ratio"], 4), found["slow_stroke"]
        (0.08879, 1.6737, 1)
    """
    check_common({}, branch)
    units = _units_per_angle if omega0 is None else units_by_name
    inputs = {"ec": ec, "AB": AB, "BC": BC, "omega0": 1.0 if omega0 is None else omega0}
    numbers = {name: as_number(name, value, tuple(inputs), ("events",)) for name, value in inputs.items()}
    if None in numbers.values():
        return Answer(events_of_arrays(inputs, int(branch), omega0 is not None), units, TurnStatus)
    lengths = tuple(float(numbers[name] or 0.0) for name in LENGTHS)
    omega = float(numbers["omega0"] or 0.0)
    outputs = closed_form(DEAD_CENTRES, branch=float(branch)).point(*lengths, -1.0 if omega < 0.0 else 1.0)
    parts = FLOATS, dict(zip(NAMES, outputs, strict=False)), outputs[-1], lengths, omega
    return Answer(_results(*parts, int(branch), omega0 is not None), units, TurnStatus)


def events_of_arrays(
    inputs: dict[str, Any], branch: int, with_speed: bool, with_velocities: bool = True
) -> dict[str, Any]:
    """The results of `events` in the broadcast shape of the inputs."""
    with IMPORTS:
        import numpy as np

        from ...evaluation.arrays import as_array, broadcast_shape
        from ...evaluation.labelled import refuse_other_labels
        from ..feasibility.feasibility import only_good

    refuse_other_labels(inputs)
    arrays = {n: as_array(n, value, tuple(inputs), ("events",)) for n, value in inputs.items()}
    shape = broadcast_shape(arrays)
    ec, AB, BC, omega = (np.broadcast_to(a, shape) for a in arrays.values())
    bad, good = only_good(ec, AB, BC)
    bad |= ~np.isfinite(omega)
    lengths, omega = [np.where(bad, np.nan, length) for length in good], np.where(bad, np.nan, omega)
    form, turning = closed_form(DEAD_CENTRES, branch=float(branch)), np.where(omega < 0.0, -1.0, 1.0)
    outputs = [np.array(np.broadcast_to(output, shape)) for output in form.arrays(*lengths, turning)]
    status = np.where(bad, 4, outputs[-1]).astype(np.int8)
    numbers = Numbers(np.where, roots, np.copysign)
    with np.errstate(invalid="ignore"):
        parts = numbers, dict(zip(NAMES, outputs, strict=False)), status, tuple(lengths), omega
        result = _results(*parts, branch, with_speed, with_velocities)
    return {**result, "slow_stroke": result["slow_stroke"].astype(np.int8)}


def _results(
    numbers: Numbers, values: dict[str, Any], status: Any, lengths: tuple[Any, ...], omega: Any, branch: int,
    with_speed: bool, with_velocities: bool = True,
) -> dict[str, Any]:  # fmt: skip
    """The results of designs from the outputs of the closed form by name."""
    ec, turning = lengths[0], numbers.choose(omega < 0.0, -branch, branch)
    slow = numbers.choose((status == 0) | (status == 2), turning * (1 * (ec > 0.0) - 1 * (ec < 0.0)), 0)
    gradient = {name: {p: values[sensitivity(name, p)] for p in LENGTHS} for name in WHOLE}
    result = {name: values[name] for name in WHOLE}
    result |= {"slow_stroke": slow, **{name: values[name] for name in PLACES}}
    for name, direction in VELOCITIES.items() if with_velocities else ():
        here = _velocity(numbers, direction, values, status, lengths, omega, branch)
        result[name], result[f"theta_{name}"], *slopes = here
        gradient[name] = dict(zip((*LENGTHS, *(["omega0"] if with_speed else [])), slopes, strict=False))
    return {**result, "gradient": gradient, "status": status}


def _stroke_ends(values: dict[str, Any], side: Any, branch: int, numbers: Numbers) -> tuple[Any, Any]:
    """The crank angles, ascending, between which Y grows (side 1) or falls (-1) as the angle does.

    At a change point the angle next to it within the stroke is meant: the speed jumps there. A slider whose
    crank is as long as its rod, in line with A, rests there for half of the turn.
    """
    outer, inner = values["theta_outer"], values["theta_inner"]
    jumps = values["Y_inner"] == 0.0
    within = BESIDE * jumps + (pi / 2) * (jumps & (values["advance_angle"] == pi))
    inner = inner + side * branch * within
    top, bottom = (outer, inner) if branch > 0 else (inner, outer)
    return numbers.choose(side > 0, bottom - 2.0 * pi, top), numbers.choose(side > 0, top, bottom)


def _velocity(
    numbers: Numbers, direction: int, values: dict[str, Any], status: Any, lengths: tuple[Any, ...],
    omega: Any, branch: int,
) -> list[Any]:  # fmt: skip
    """The largest |V_C| between two dead centres: value, crank angle, derivatives (lengths, omega0).

    That is where the acceleration vanishes; without a crank, or at a change point, it may be an end itself,
    from which it grows as a root of the margin.
    """
    if status == 1 if numbers is FLOATS else ((status == 1) | (status == 4)).all():
        return [values["stroke"] * nan for _ in range(6)]
    design = dict(zip(LENGTHS, lengths, strict=True))

    def at(theta: Any, names: Any, omega0: Any = 1.0) -> Any:
        return evaluate(names, theta=theta, omega0=omega0, branch=branch, **design)

    side = direction * branch  # of Y
    first, last = _stroke_ends(values, numbers.choose(omega < 0.0, -side, side), branch, numbers)
    before, after = at(first, "a_C"), at(last, "a_C")
    crosses = before * after < 0.0
    inside = numbers.root(lambda x: at(x, "a_C"), first, numbers.choose(crosses, last, first), before, after)
    sharper = abs(at(first, "V_C")) >= abs(at(last, "V_C"))
    theta = numbers.choose(crosses, inside, numbers.choose(sharper, first, last))
    theta = numbers.choose(status == 1, nan, theta)
    here = at(theta, SPEEDS, omega)
    value, *slopes = (side * here[name] for name in SPEEDS)
    steep = (status == 2) & (value != 0.0) & (not crosses if numbers is FLOATS else ~crosses)
    slopes[:3] = [numbers.choose(steep, numbers.copysign(inf, slope), slope) for slope in slopes[:3]]
    return [value, theta + 2.0 * pi * (theta < -pi / 2) - 2.0 * pi * (theta > 1.5 * pi), *slopes]


def _units_per_angle(result: Mapping[str, Any]) -> dict[str, Any]:
    """The units of an answer without a speed, whose velocities are slopes of the position."""
    units = units_by_name(result)
    units |= dict.fromkeys(VELOCITIES, unit_of("Y", "theta"))
    units["gradient"] |= {name: slopes_of("Y_wrt_theta", LENGTHS) for name in VELOCITIES}
    return units
