"""The crank angles at which a design can be assembled: a Program.

A side of the crank whose margin is negative loses the angles within a gap of its quarter: 1 - cos(gap) =
-margin/AB and 1 + cos(gap) = (margin + 2 AB)/AB, so that tan(gap/2) has no cancellation.
"""

from collections.abc import Sequence
from math import pi
from typing import Any

from . import TURN
from .functions import closed_form

LIMITS = f'''def limits(ec, AB, BC):
    """The crank angles at which |ec + AB sin(theta)| <= BC."""
    room = BC - AB
    lost = two_sum_error(BC, -AB)
    upper = (room - ec) + (two_sum_error(room, -ec) + lost)  # m | margin at theta = pi/2
    lower = (room + ec) + (two_sum_error(room, ec) + lost)  # m | margin at theta = -pi/2
    reach = BC + AB
    reach_lost = two_sum_error(BC, AB)
    over = (reach - ec) + (two_sum_error(reach, -ec) + reach_lost)
    under = (reach + ec) + (two_sum_error(reach, ec) + reach_lost)
    top = 2.0 * atan2(sqrt(-upper), sqrt(over)) if upper < 0.0 else 0.0  # rad | lost on each side of pi/2
    bottom = 2.0 * atan2(sqrt(-lower), sqrt(under)) if lower < 0.0 else 0.0  # rad | at -pi/2
    turns = 0.0 <= upper and 0.0 <= lower
    none = not turns and (AB == 0.0 or not (0.0 <= over and 0.0 <= under))
    above = bottom == 0.0
    below = top == 0.0
    wraps = bottom < {pi / 2!r}
    start_below = {1.5 * pi!r} + bottom if wraps else bottom - {pi / 2!r}
    end_below = {3.5 * pi!r} - bottom if wraps else {1.5 * pi!r} - bottom
    start = {pi / 2!r} + top if above else (start_below if below else {pi / 2!r} + top)
    end = {2.5 * pi!r} - top if above else (end_below if below else {1.5 * pi!r} - bottom)
    first_start = nan if none else (0.0 if turns else start)
    first_end = nan if none else ({2 * pi!r} if turns else end)
    single = none or (turns or (above or below))
    second_start = nan if single else {1.5 * pi!r} + bottom
    second_end = nan if single else {2.5 * pi!r} - top
    margin = upper if upper < lower else lower  # m | BC - AB - |ec|
    status = 2 if margin == 0.0 else (0 if turns else 1)
    long = BC if AB < BC else AB
    short = AB if AB < BC else BC
    apart = long - short
    left = apart - fabs(ec)
    left_lost = two_sum_error(apart, -fabs(ec)) + two_sum_error(long, -short)
    link_margin = left + left_lost  # m | where it is not negative, the shorter of crank and rod turns fully
    return first_start, first_end, second_start, second_end, status, margin, link_margin
'''
ANGLES = ("first_start", "first_end", "second_start", "second_end")
WHOLE_TURN = [(0.0, TURN)]  # the feasible angles of a design that turns fully
CHANGE_POINT_ULPS = 4  # |margin| within this number of ulp of BC is called a change-point design


def theta_intervals(ec: float, AB: float, BC: float) -> list[tuple[float, float]]:
    """The crank angles from 0 on at which |ec + AB sin(theta)| <= BC, as closed intervals."""
    return in_intervals(closed_form(LIMITS, ANGLES).point(ec, AB, BC))


def in_intervals(angles: Sequence[float]) -> list[tuple[float, float]]:
    """The limit angles in pairs, without those that there are not."""
    pairs = (angles[0:2], angles[2:4])
    return [(start, end) for start, end in pairs if start == start]


def margin_of(ec: Any, AB: Any, BC: Any) -> Any:
    """BC - AB - |ec| of arrays, rounded once."""
    return closed_form(LIMITS, ("margin",)).arrays(ec, AB, BC)[0]


def margins_of(ec: Any, AB: Any, BC: Any) -> Any:
    """BC - AB - ec and BC - AB + ec of arrays, rounded once: the margins at pi/2 and at -pi/2."""
    return closed_form(LIMITS, ("upper", "lower")).arrays(ec, AB, BC)
