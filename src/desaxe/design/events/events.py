"""`events`: the dead centres of a design, its strokes, and the extremes of its rod and slider."""

from collections.abc import Mapping
from math import nan
from typing import Any

from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import slopes_of, unit_of, units_by_name
from ...mechanism.status import TurnStatus
from ...runtime.request import as_number, check_common, with_known_inputs
from ...support.answer import Answer
from ...support.forks import IMPORTS
from .closed_form import VELOCITIES, DesignEvents, velocity


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
        with IMPORTS:
            from .arrays import events_of_arrays

        found_of = events_of_arrays(inputs, int(branch), omega0 is not None)
        return Answer(found_of, units, TurnStatus)
    e, crank, rod, omega = (float(value or 0.0) for value in numbers.values())
    lengths, forward = {"ec": e, "AB": crank, "BC": rod}, -1 if omega < 0.0 else 1
    found = DesignEvents(closed_form(DEAD_CENTRES, branch=float(branch)).point(e, crank, rod, float(forward)))
    slow = int(branch) * forward * ((e > 0.0) - (e < 0.0)) if found.status != 1 else 0
    result, gradient = {**found.values, "slow_stroke": slow, **found.places}, found.gradient
    parameters = (*LENGTHS, "omega0") if omega0 is not None else LENGTHS
    for name, direction in VELOCITIES.items():
        value, theta, *slopes = [nan] * 6
        if found.status != 1:
            sharp = found.status == 2
            value, theta, *slopes = velocity(direction, found.values, int(branch), omega, lengths, sharp)
        result |= {name: value, f"theta_{name}": theta}
        gradient[name] = dict(zip(parameters, slopes, strict=False))
    return Answer({**result, "gradient": gradient, "status": found.status}, units, TurnStatus)


def _units_per_angle(result: Mapping[str, Any]) -> dict[str, Any]:
    """The units of an answer without a speed, whose velocities are slopes of the position."""
    units = units_by_name(result)
    units |= dict.fromkeys(VELOCITIES, unit_of("Y", "theta"))
    units["gradient"] |= {name: slopes_of("Y_wrt_theta", LENGTHS) for name in VELOCITIES}
    return units
