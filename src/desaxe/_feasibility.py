"""`feasibility`: can the mechanism be assembled, can it turn, at which crank angles."""

from math import asin, fsum, pi, sqrt, ulp
from typing import Any

from ._request import as_number, with_known_inputs

CHANGE_POINT_ULPS = 4  # |margin| within so many last bits of BC is called a change-point design


@with_known_inputs
def feasibility(*, ec: Any, AB: Any, BC: Any) -> dict[str, Any]:
    """Where a design can be assembled.

    ec, AB, BC: numbers (or text with a unit) in metres, or arrays, which broadcast like NumPy. Gives a dict:

    margin           BC - AB - |ec| [m], of the doubles given, rounded once
    gradient         its derivatives by ec, AB, BC (at ec = 0 that by ec is taken as 0)
    can_turn         whether the crank can turn fully (margin >= 0)
    theta_intervals  list of (first, last) crank angles [rad] in which it can be assembled; an
                     interval that crosses 2 pi goes on beyond it. [(0, 2 pi)] where it can turn
    kind             "crank" (turns fully), "change point" (|margin| within 4 last bits of BC), "rocker"
                     (turns partly), "none"
    grashof          whether the shorter of crank and rod can turn fully: |ec| <= |BC - AB|
    status           0 the crank turns fully, 1 it does not, 2 at a change point (margin = 0), 4 bad input

    For arrays each is an array: `theta_intervals` has two intervals in its last two axes, NaN where there
    are fewer, and `kind` is "bad input" where a length is none. `design_map` labels outer products.

    Raises ValueError for a bad value. Source: paper A (6), where |u| <= BC.

        >>> import desaxe as dx
        >>> found = dx.feasibility(ec=0.125, AB=0.125, BC=0.375)
        >>> found["kind"], found["can_turn"], found["margin"]
        ('crank', True, 0.125)
    """
    given = {"ec": ec, "AB": AB, "BC": BC}
    lengths = {name: as_number(name, value, tuple(given), ("feasibility",)) for name, value in given.items()}
    if None in lengths.values():
        return _of_arrays(given)
    ec, AB, BC = lengths.values()
    margin = fsum((BC, -AB, -abs(ec)))
    intervals = theta_intervals(ec, AB, BC)
    near = abs(margin) <= CHANGE_POINT_ULPS * ulp(BC)
    kind = "change point" if near else "crank" if margin > 0.0 else "rocker" if intervals else "none"
    slope = 0.0 if ec == 0.0 else (-1.0 if ec > 0.0 else 1.0)
    return {
        "margin": margin,
        "gradient": {"ec": slope, "AB": -1.0, "BC": 1.0},
        "can_turn": margin >= 0.0,
        "theta_intervals": intervals,
        "kind": kind,
        "grashof": fsum((max(AB, BC), -min(AB, BC), -abs(ec))) >= 0.0,
        "status": 2 if margin == 0.0 else 0 if margin > 0.0 else 1,
    }


def _of_arrays(given: dict[str, Any]) -> dict[str, Any]:
    from ._arrays import as_array, broadcast_shape
    from ._design.feasible import of_arrays

    arrays = {name: as_array(name, value, tuple(given), ("feasibility",)) for name, value in given.items()}
    broadcast_shape(arrays)
    return of_arrays(*arrays.values())


def theta_intervals(ec: float, AB: float, BC: float) -> list[tuple[float, float]]:
    """The crank angles from 0 on at which |ec + AB sin(theta)| <= BC, as closed intervals.

    Each side of the crank has its own margin; where it is negative, the angles nearer to that
    quarter than `gap` are lost.
    """
    upper, lower = fsum((BC, -AB, -ec)), fsum((BC, -AB, ec))  # margins at pi/2 and -pi/2
    if min(upper, lower) >= 0.0:
        return [(0.0, 2.0 * pi)]
    over, under = fsum((BC, AB, -ec)), fsum((BC, AB, ec))  # what is left at the opposite quarters
    if AB == 0.0 or min(over, under) < 0.0:
        return []
    top, bottom = _gap(upper, over, AB), _gap(lower, under, AB)
    if bottom == 0.0:
        return [(pi / 2 + top, 2.5 * pi - top)]
    if top == 0.0:
        return (
            [(3 * pi / 2 + bottom, 3.5 * pi - bottom)]
            if bottom < pi / 2
            else [(bottom - pi / 2, 3 * pi / 2 - bottom)]
        )
    return [(pi / 2 + top, 3 * pi / 2 - bottom), (3 * pi / 2 + bottom, 2.5 * pi - top)]


def _gap(margin: float, rest: float, AB: float) -> float:
    """How far from a quarter the crank must stay for this margin there.

    1 - cos(gap) = -margin/AB, and 1 + cos(gap) = rest/AB where the gap is wide: neither cancels.
    """
    if margin >= 0.0:
        return 0.0
    return (
        2.0 * asin(sqrt(-margin / (2.0 * AB))) if -margin < AB else pi - 2.0 * asin(sqrt(rest / (2.0 * AB)))
    )
