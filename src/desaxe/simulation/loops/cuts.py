"""The earliest cut of a panel in plain loops, which are compiled: all roots are those of its series.

cut      part of the panel, kind, row of an angle, coordinate that has a value there (0 q, 1 v, -1 none), that
         value, part at which the normal force changes its side
"""

from __future__ import annotations

from math import copysign, inf, pi
from typing import TYPE_CHECKING

from numpy import empty

from .law import FIRST, HALF, LAST, NORMAL, RUBS, SPEED, UNSURE, WEDGE, coordinate, place
from .newton import POINTS, product
from .panels import BEYOND, LEFT, NEAR, next_kink, root, value

if TYPE_CHECKING:
    from typing import Any

PART, KIND, ROW, PLACE, VALUE, LOST_AT = range(6)
NO_CUT, KINK, STANDSTILL, KNOT, LOST, JAMMED, LIMIT = range(7)
NONE = 9.0  # parts: there is no root
SAME = 1e-9  # of a panel: events so close together are one instant
LEAVES = 1e-6  # of a panel: there a coordinate that starts at 0 has left it
ROUNDED = 1e-13  # of a series: less is none
SAMPLES = 32
JAMS_AT = 1.0 - 1e-6  # see `..law`
MARGIN = 1e-7  # of the largest speed of a motor's table: a speed so near to one starts there


def slope(series: Any, s: float) -> float:
    """The derivative of a series by the part of its panel, but for a factor of 2."""
    x = 2.0 * s - 1.0
    before, now, slower, steep, total = 1.0, x, 0.0, 1.0, series[1]
    for n in range(1, 16):
        before, now, slower, steep = (
            now,
            ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0),
            steep,
            slower + (2.0 * n + 1.0) * now,
        )
        total += series[n + 1] * steep
    return float(total)


def first_root(series: Any, start: float, at_zero: bool) -> float:
    """The first part of a panel, behind its start, at which a series changes its sign."""
    size, rest = abs(start + series[0]), 0.0
    for j in range(1, 17):
        rest += abs(series[j])
    if size > rest or rest == 0.0:
        return NONE
    a = LEAVES if at_zero else 0.0
    at_a = value(series, start, a)
    if at_zero and abs(at_a) < ROUNDED * (size + rest):
        at_a = value(series, start, 1.0 / SAMPLES)
    steep = slope(series, a)
    for k in range(1, SAMPLES + 1):
        b = k / SAMPLES
        at_b, next_steep = value(series, start, b), slope(series, b)
        if at_a * at_b < 0.0:
            return root(series, start, 0.0, a, b)
        if at_b == 0.0:
            return b
        if at_a * steep < 0.0 and at_b * next_steep > 0.0:  # it may pass twice
            low, high = a, b
            for _ in range(40):
                middle = 0.5 * (low + high)
                if slope(series, middle) * at_a < 0.0:
                    low = middle
                else:
                    high = middle
            if value(series, start, low) * at_a < 0.0:
                return root(series, start, 0.0, a, low)
        a, at_a, steep = b, at_b, next_steep
    return NONE


def points(values: Any, table: Any, start: float, series: Any) -> None:
    """The series of values at the nodes, less a value."""
    for j in range(16):
        series[j] = product(table[POINTS + j], values)
    series[0] -= start
    series[16] = 0.0


def take(cut: Any, part: float, kind: Any, row: Any, at: Any, number: float) -> None:
    """Take a cut that comes before the one so far."""
    if part < cut[PART] - SAME:
        cut[PART], cut[KIND], cut[ROW], cut[PLACE], cut[VALUE] = part, kind, row, at, number


def at_angles(y: Any, law: Any, kinks: Any, rows: Any, series: Any, clock: Any, end: float, cut: Any) -> None:
    """The next angle, up to a part of the panel, before which the crank turns one way."""
    theta, last = place(y[0], law), value(series[0], y[0], end)
    way, angle = copysign(1.0, last - y[0]), place(last, law)
    gap, row, reached = next_kink(theta, way, NEAR if clock[LEFT] > 0.0 else 0.0, kinks, law)
    if gap <= abs(angle - theta):
        q = coordinate(reached, law)
        take(cut, root(series[0], y[0], q, 0.0, end), KINK, row, 0, q)
    if law[HALF] > 0.0:
        beyond = value(series[0], y[0], BEYOND)
        bound = copysign(0.5 * pi, beyond)
        if end == 1.0 and abs(beyond) >= 0.5 * pi:
            part = root(series[0], y[0], bound, 0.0, BEYOND)
            take(cut, part, LIMIT, 0 if bound < 0.0 else 1, 0, bound)
    elif last <= law[FIRST] or last >= law[LAST]:
        bound = law[FIRST] if last <= law[FIRST] else law[LAST]
        take(cut, root(series[0], y[0], bound, 0.0, end), LIMIT, 0 if last <= law[FIRST] else 1, 0, bound)


def at_knots(knots: Any, rows: Any, table: Any, cut: Any) -> None:
    """The speeds at which pieces of a motor's table meet."""
    series: Any = empty(17)
    slow, fast, size = inf, -inf, 0.0
    for i in range(16):
        slow, fast = min(slow, rows[SPEED, i]), max(fast, rows[SPEED, i])
    for k in range(len(knots)):
        size = max(size, abs(knots[k]))
    margin = 0.1 * (fast - slow) + MARGIN * size
    for k in range(len(knots)):
        if slow - margin <= knots[k] <= fast + margin:
            points(rows[SPEED], table, knots[k], series)
            at_start = abs(value(series, 0.0, 0.0)) <= MARGIN * size
            take(cut, first_root(series, 0.0, at_start), KNOT, k, -1, 0.0)


def at_guide(rows: Any, table: Any, cut: Any) -> None:
    """The change of side of the normal force, and the jam of the friction."""
    series: Any = empty(17)
    noise, before, a = 0.0, 0.0, 0.0
    for i in range(16):
        noise = max(noise, rows[UNSURE, i])
    points(rows[NORMAL], table, 0.0, series)
    for k in range(SAMPLES + 1):  # at the start its sign is rounding
        now = value(series, 0.0, k / SAMPLES)
        if k > 0 and now < -noise:
            cut[LOST_AT] = root(series, 0.0, 0.0, a, k / SAMPLES) if before > 0.0 else a
            take(cut, cut[LOST_AT], LOST, 0, -1, 0.0)
            break
        before, a = now, k / SAMPLES
    for side in range(-1, 2, 2):
        points(rows[WEDGE], table, side * JAMS_AT, series)
        beyond = first_root(series, 0.0, False)
        if beyond > 0.0 and beyond < NONE and slope(series, beyond) * side > 0.0:
            take(cut, beyond, JAMMED, side, -1, 0.0)


def earliest(
    y: Any, law: Any, kinks: Any, knots: Any, table: Any, rows: Any, series: Any, clock: Any, cut: Any
) -> None:  # fmt: skip
    """The earliest cut of a panel; its part is NONE where there is none."""
    cut[PART], cut[KIND], cut[LOST_AT] = NONE, NO_CUT, NONE
    end = first_root(series[1], y[1], y[1] == 0.0)
    at_angles(y, law, kinks, rows, series, clock, min(end, 1.0), cut)
    take(cut, end, STANDSTILL, 0, 1, 0.0)
    if len(knots) > 0:
        at_knots(knots, rows, table, cut)
    if law[RUBS] > 0.0:
        at_guide(rows, table, cut)
