"""The crank angles at which a design can be assembled, in closed form."""

from math import asin, fsum, pi, sqrt

CHANGE_POINT_ULPS = 4  # |margin| within this number of ulp of BC is called a change-point design


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
    """The smallest feasible angle between crank and quarter turn, for this margin there.

    1 - cos(gap) = -margin/AB, and 1 + cos(gap) = rest/AB where the gap is wide: neither cancels.
    """
    if margin >= 0.0:
        return 0.0
    return (
        2.0 * asin(sqrt(-margin / (2.0 * AB))) if -margin < AB else pi - 2.0 * asin(sqrt(rest / (2.0 * AB)))
    )
