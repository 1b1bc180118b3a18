"""Dead centres, stroke, time ratio and extreme rod angles in closed form, with their derivatives.

Crank and rod are in line with S = AB + BC between A and C (outer), or D = BC - AB (inner):

    Y_o = sqrt((S - ec) (S + ec)),   theta_o = -asin(ec/S)
    Y_i = sqrt((D - ec) (D + ec)),   theta_i = pi - asin(ec/D)

Differences of these are rewritten so that nothing cancels. With Y_o^2 - Y_i^2 = 4 AB BC,

    stroke = Y_o - Y_i = 4 AB BC/(Y_o + Y_i)
    beta = asin(ec/D) - asin(ec/S) = atan2(ec stroke, Y_o Y_i + ec^2)

beta, the angle between the dead centres as seen from A, is what one stroke turns more than half a turn and
the other less. The differences S - |ec|, D - |ec| are exact sums rounded once; lengths are scaled by a power
of two, so that no square leaves the range of doubles.
"""

from math import pi
from typing import Any, NamedTuple

from ..number_or_array import Maths, sum_of_three

HALF_TURN_ON = {"theta_outer": -1, "theta_inner": 1}  # name -> the branch on which it is near pi
MIRRORED = (*HALF_TURN_ON, "Y_outer", "Y_inner")
VELOCITIES = {"V_outward": 1, "V_inward": -1}  # name -> direction along the stroke


class Known(NamedTuple):
    """A value, its derivatives by ec, AB, BC, and the power of length that it is."""

    value: Any
    slopes: tuple[Any, Any, Any]
    power: int = 0


class Sides(NamedTuple):
    """The right-angled triangles of the two dead centres, and of the rod at its steepest."""

    ec: Any
    side: Any  # the sign of ec
    AB: Any
    BC: Any
    S: Any
    D: Any
    outer: Any  # Y_o
    inner: Any  # |Y_i|
    turning: Any  # Y_i where the crank turns fully, else NaN
    reach: Any  # AB + |ec|, how far the rod leans out at most
    height: Any  # sqrt(BC^2 - reach^2)


def closed_form(ec: Any, AB: Any, BC: Any, maths: Maths) -> dict[str, Known]:
    """All events by name, for branch 1 and a crank that turns forwards; NaN where one does not exist.

    `theta_inner` is told from pi on: on the other branch it is near 0, with all its digits.
    """
    longest = maths.choose(AB > BC, AB, BC)
    power = -maths.exponent(maths.choose(abs(ec) > longest, abs(ec), longest))
    ec, AB, BC = (maths.ldexp(x, power) for x in (ec, AB, BC))
    sides = _sides(ec, AB, BC, maths)
    found = {**_dead_centres(sides, maths), **_strokes(sides, maths), **_rod_angles(sides, maths)}
    return {name: _unscaled(known, power, maths) for name, known in found.items()}


def _unscaled(known: Known, power: Any, maths: Maths) -> Known:
    value = maths.ldexp(known.value, -power * known.power)
    return Known(value, tuple(maths.ldexp(s, power * (1 - known.power)) for s in known.slopes))


def _sides(ec: Any, AB: Any, BC: Any, maths: Maths) -> Sides:
    away = abs(ec)
    margin = sum_of_three(BC, -AB, -away)
    inner = maths.choose(BC > AB, margin, sum_of_three(AB, -BC, -away))  # |D| - |ec|
    length = abs(BC - AB)
    across = maths.sqrt(inner * (length + away))
    return Sides(
        ec,
        maths.choose(ec > 0.0, 1.0, maths.choose(ec < 0.0, -1.0, 0.0 * ec)),
        AB,
        BC,
        AB + BC,
        BC - AB,
        maths.sqrt(sum_of_three(AB, BC, -away) * (AB + BC + away)),
        across,
        maths.choose(margin >= 0.0, across, float("nan")),
        AB + away,
        maths.sqrt(margin * (BC + (AB + away))),
    )


def _dead_centres(t: Sides, maths: Maths) -> dict[str, Known]:
    over = maths.over
    sign = maths.choose(t.D >= 0.0, 1.0, -1.0)  # of Y_i: a long crank takes the slider past A
    out, lean = over(t.S, t.outer), over(t.ec, t.outer)
    into, back = over(abs(t.D), t.inner), over(t.ec, t.inner)
    turn = over(t.ec, t.S * t.outer)
    inner_turn = over(t.ec, t.D * t.inner) * sign
    return {
        "theta_outer": Known(-maths.atan2(t.ec, t.outer), (-over(1.0, t.outer), turn, turn)),
        "theta_inner": Known(
            -maths.atan2(sign * t.ec, t.inner), (-sign * over(1.0, t.inner), -inner_turn, inner_turn)
        ),
        "Y_outer": Known(t.outer, (-lean, out, out), 1),
        "Y_inner": Known(sign * t.inner, (-sign * back, -into, into), 1),
    }


def _strokes(t: Sides, maths: Maths) -> dict[str, Known]:
    over, outer, inner, S, D = maths.over, t.outer, t.turning, t.S, t.D
    stroke = maths.choose(t.AB == 0.0, 0.0 * inner, over(4.0 * t.AB * t.BC, outer + inner))
    both, cross = outer * inner, S * inner + D * outer
    stroke_slopes = (
        over(t.ec * stroke, both),
        over(S, outer) + over(D, inner),
        over(-4.0 * t.ec * t.ec * t.AB * t.BC, both * cross),
    )
    beta = maths.atan2(t.ec * stroke, both + t.ec * t.ec)
    far = S * outer + D * inner
    beta_slopes = (
        over(stroke, both),
        over(t.ec, D * inner) + over(t.ec, S * outer),
        over(-4.0 * t.AB * t.BC * t.ec * (S * S + inner * inner), D * inner * S * outer * far),
    )
    short = pi - abs(beta)
    grows = t.side * over(2.0 * pi, short * short)
    return {
        "stroke": Known(stroke, stroke_slopes, 1),
        "advance_angle": Known(pi + beta, beta_slopes),
        "return_angle": Known(pi - beta, tuple(-s for s in beta_slopes)),
        "time_ratio": Known(1.0 + 2.0 * abs(beta) / short, tuple(grows * s for s in beta_slopes)),
    }


def _rod_angles(t: Sides, maths: Maths) -> dict[str, Known]:
    """The rod is steepest where the crank points away from the slider's axis; it may not come upright."""
    over = maths.over
    per = over(1.0, t.height)
    steep = (t.side * per, per, -over(t.reach, t.BC * t.height))
    least = maths.choose(abs(t.ec) > t.AB, abs(t.ec) - t.AB, 0.0 * t.height)
    rise = maths.sqrt((t.BC - least) * (t.BC + least))
    tilted = maths.choose(least > 0.0, over(1.0, rise), 0.0 * rise)
    flat = (t.side * tilted, -tilted, -over(least, t.BC) * tilted)
    return {
        "max_pressure_angle": Known(maths.atan2(t.reach, t.height), steep),
        "min_transmission_angle": Known(maths.atan2(t.height, t.reach), _negative(steep)),
        "min_pressure_angle": Known(maths.atan2(least, rise), flat),
        "max_transmission_angle": Known(maths.atan2(rise, least), _negative(flat)),
    }


def _negative(slopes: tuple[Any, Any, Any]) -> tuple[Any, Any, Any]:
    a, b, c = slopes
    return -a, -b, -c


def placed(known: dict[str, Known], branch: int, turn: int) -> dict[str, Known]:
    """The events on this branch (mirrored across X for -1) and for this direction of rotation."""
    found = dict(known)
    for name in MIRRORED:
        value, (a, b, c), power = known[name]
        half = pi if HALF_TURN_ON.get(name) == branch else 0.0
        found[name] = Known(half + branch * value, (branch * a, branch * b, branch * c), power)
    if turn < 0:
        found["advance_angle"], found["return_angle"] = known["return_angle"], known["advance_angle"]
    return found


def stroke_ends(known: dict[str, Known], side: int, branch: int) -> tuple[Any, Any]:
    """The crank angles, ascending, between which Y grows (side 1) or falls (-1) as the angle does."""
    outer, inner = known["theta_outer"].value, known["theta_inner"].value
    top, bottom = (outer, inner) if branch > 0 else (inner, outer)
    return (bottom - 2.0 * pi, top) if side > 0 else (top, bottom)
