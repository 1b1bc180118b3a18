"""Panel after panel in plain loops, until something may cut the motion (see `march`).

clock    instant, suggested length, end of the motion, largest error of an angle next to a limit angle
kinks    rows of angles at which the motion is cut, and the periods in which they repeat, or inf
knots    speeds at which it is cut
heads    rows of panels: start, length, error, q, v and W at the start
records  series of panels; at their nodes the rates of q, v and W, the speed, and under friction the normal
         force, its wedging and its rounding
"""

from __future__ import annotations

from math import copysign, floor, inf, pi, sqrt
from typing import TYPE_CHECKING

from numpy import empty, nextafter

from .newton import (
    ANGLE,
    CURVED,
    DEVIATES,
    ENDS,
    NORMAL,
    RATE_Q,
    RATE_V,
    ROWS,
    SPEED,
    STOP,
    TAIL,
    TIME,
    WEDGE,
    law_at,
    newton,
    product,
)
from .state import FIRST, FUNCTION, HALF, KERNEL, LAST, RUBS, TORQUE

if TYPE_CHECKING:
    from typing import Any

T, WISH, T_END, SHARP = 0, 1, 2, 3  # of the clock
GOES_ON, FAILED, STOPPED, MAY_CUT = range(4)
AHEAD = 1.3  # of a panel: so far its series guess the next one, from there on straight lines
BEYOND = 1.15  # of a panel: so far its series reach a limit angle, next to which S has no digits
AIM = 0.01  # tolerances: the error that the next length is chosen for
GROWTH = 2.0  # from panel to panel
LEAST_H = 1e-6  # of the motion: no panel is shortened to less to tell a limit angle
MOST = 1000.0 * 2.0 * pi  # rad in one panel
NEAR = 1e-9  # rad: an angle that a stretch starts from is not reached at once
STEADY = 0.9  # of the wedging of friction: beyond, it may jam
MARGIN = 1e-7  # of a speed: so near to a knot it may be passed


def value(series: Any, start: float, s: float) -> float:
    """A coordinate at a part of a panel."""
    x = 2.0 * s - 1.0
    before, now, total = 1.0, x, series[0] + series[1] * x
    for n in range(1, 16):
        before, now = now, ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0)
        total += series[n + 1] * now
    return float(start + total)


def motion(t: float, y: Any, law: Any, data: Any, rows: Any, still: Any) -> int:
    """The rates at the start of a panel, at the first node of `rows`."""
    for i in range(16):
        rows[TIME, i], still[i], still[16 + i] = t, y[0], y[1]
    return law_at(still, law, data, rows, 0)


def guess(t: float, h: float, y: Any, last: Any, series: Any, table: Any, rows: Any, state: Any) -> None:
    """The state at the nodes, by the panel before; by the rates if that has no length."""
    if last[1] == 0.0:
        speed, rate, bend = rows[RATE_Q, 0], rows[RATE_V, 0], rows[CURVED, 0]
        for i in range(16):
            s = h * table[0, i]
            state[i] = y[0] + speed * s + (0.5 * bend * s * s if speed == 0.0 else 0.0)
            state[16 + i] = y[1] + rate * s
        return
    for k in range(2):
        far, near = value(series[k], last[3 + k], AHEAD), value(series[k], last[3 + k], AHEAD - 1e-3)
        for i in range(16):
            s = (t + h * table[0, i] - last[0]) / last[1]
            ahead = value(series[k], last[3 + k], min(s, AHEAD))
            state[16 * k + i] = ahead + (far - near) / 1e-3 * max(s - AHEAD, 0.0)


def time_over(gap: float, speed: float, bend: float) -> float:
    """The time over a distance at a speed that grows steadily; infinite where it ends before."""
    square = speed * speed + 2.0 * bend * gap
    if square < 0.0:
        return inf
    below = speed + sqrt(square)
    return 2.0 * gap / below if below > 0.0 else inf


def until_cut(y: Any, law: Any, kinks: Any, rows: Any) -> float:
    """The time to a little behind the next angle that cuts the motion, or to before a limit angle."""
    speed, bend, theta = rows[RATE_Q, 0], rows[CURVED, 0], rows[ANGLE, 0]
    way = copysign(1.0, speed if speed != 0.0 else bend)
    shortest = inf
    if law[HALF] > 0.0:
        shortest = 0.95 * time_over(0.5 * pi - y[0] * way, speed * way, bend * way)
    else:
        gap = inf
        for k in range(len(kinks)):
            left, every = (kinks[k, 0] - theta) * way, kinks[k, 1]
            if every < inf:
                left -= every * floor(left / every)
            gap = min(gap, left) if left > NEAR else gap
        if gap < inf:
            shortest = 1.1 * time_over(gap, speed * way, bend * way)
    return shortest if shortest > 0.0 else inf


def blurs(error: float, h: float, y: Any, law: Any, clock: Any, rtol: float, series: Any) -> bool:
    """True where the series of a panel do not reach a limit angle with the digits that are asked for."""
    at_end, beyond = value(series[0], y[0], 1.0), value(series[0], y[0], BEYOND)
    end = copysign(0.5 * pi, beyond - at_end)
    if (at_end - end) * (beyond - end) >= 0.0:
        return False
    low, high = 1.0, BEYOND
    for _ in range(50):
        s = 0.5 * (low + high)
        if (value(series[0], y[0], s) - end) * (at_end - end) > 0.0:
            low = s
        else:
            high = s
    x = 2.0 * high - 1.0
    growth = (x + sqrt(x * x - 1.0)) ** 16.0
    return bool(error * TAIL * rtol * growth > max(rtol, clock[SHARP]) and h > LEAST_H * clock[T_END])


def reaches(low: float, high: float, angle: float, every: float) -> bool:
    """True if an angle, or one of its repetitions, lies in a range."""
    if every < inf:
        angle += every * floor((high - angle) / every)
    return low <= angle <= high


def friction_may_change(law: Any, rows: Any) -> bool:
    """True where the normal force may change its sign in a panel, or the friction may jam."""
    if law[KERNEL] == 0.0:
        return True
    low, high, least, most = inf, -inf, inf, -inf
    for i in range(16):
        low, high = min(low, rows[NORMAL, i]), max(high, rows[NORMAL, i])
        least, most = min(least, rows[WEDGE, i]), max(most, rows[WEDGE, i])
    wide = 0.2 * (most - least)
    safe = low > 0.2 * (high - low) and most + wide < STEADY and least - wide > -STEADY
    return not safe


def may_cut(y: Any, end: Any, law: Any, kinks: Any, knots: Any, rows: Any, series: Any) -> bool:
    """True where a kink, a knot, a limit angle or a standstill may lie in a panel."""
    if (law[RUBS] > 0.0 and friction_may_change(law, rows)) or end[1] * y[1] <= 0.0:
        return True
    rest, mean = 0.0, y[1] + series[1, 0]
    for j in range(1, 17):
        rest += abs(series[1, j])
    if abs(mean) <= rest:
        return True
    far = value(series[0], y[0], BEYOND)
    if law[HALF] > 0.0 and abs(far) >= 0.5 * pi:
        return True
    if law[HALF] == 0.0:
        low, high = min(y[0], end[0]), max(y[0], end[0])
        if low <= law[FIRST] or high >= law[LAST]:
            return True
        for k in range(len(kinks)):
            if reaches(low - NEAR, high + NEAR, kinks[k, 0], kinks[k, 1]):
                return True
    elif len(kinks) > 0:
        return True
    slow, fast, size = inf, -inf, 0.0
    for i in range(16):
        slow, fast = min(slow, rows[SPEED, i]), max(fast, rows[SPEED, i])
    for k in range(len(knots)):
        size = max(size, abs(knots[k]))
    margin = 0.1 * (fast - slow) + MARGIN * size
    found = False
    for k in range(len(knots)):
        found = found or slow - margin <= knots[k] <= fast + margin
    return found


def jumps(
    t: float, h: float, y: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any, series: Any
) -> bool:  # fmt: skip
    """True where a function jumps between an end of a panel and the node next to it, which no node sees."""
    still, end, other = empty(32), empty(3), empty((ROWS, 16))
    first, last = product(table[ENDS], rows[RATE_V]), product(table[ENDS + 1], rows[RATE_V])
    for k in range(3):
        end[k] = value(series[k], y[k], 1.0)
    if motion(t, y, law, data, other, still) != 0:
        return True
    first -= other[RATE_V, 0]
    if motion(t + h, end, law, data, other, still) != 0:
        return True
    worst = max(abs(first), abs(last - other[RATE_V, 0]))
    return bool(h * worst > DEVIATES * TAIL * scales[0] * scales[2])


def keep(head: Any, t: float, h: float, error: float, y: Any) -> None:
    """Record a panel's start, length, error and state."""
    head[0], head[1], head[2], head[3], head[4], head[5] = t, h, error, y[0], y[1], y[2]


def one(
    y: Any, clock: Any, scales: Any, kinks: Any, law: Any, data: Any, table: Any, rows: Any, matrix: Any,
    last: Any, before: Any, head: Any, series: Any,
) -> int:  # fmt: skip
    """The longest panel that the tolerance allows: GOES_ON, FAILED or STOPPED."""
    state: Any = empty(32)
    t, bends = clock[T], law[HALF] > 0.0 or len(kinks) > 0
    if bends or last[1] == 0.0 or clock[WISH] == 0.0:
        code = motion(t, y, law, data, rows, state)
        if code == STOP:
            return STOPPED
        if code != 0:
            return FAILED
    limited, wish = until_cut(y, law, kinks, rows) if bends else inf, clock[WISH]
    if wish == 0.0:
        speed, bend = abs(rows[RATE_Q, 0]), abs(rows[CURVED, 0])
        wish = min(1.0 / speed if speed > 0.0 else inf, sqrt(2.0 / bend) if bend > 0.0 else inf, clock[T_END])
    h, least = min(wish, limited, clock[T_END] - t), 10.0 * (nextafter(t, inf) - t)
    while h >= least:
        if last[1] == 0.0 and motion(t, y, law, data, rows, state) == STOP:
            return STOPPED
        guess(t, h, y, last, before, table, rows, state)
        error = newton(t, h, y, state, scales, law, data, table, rows, matrix, series)
        if error == -float(STOP):
            return STOPPED
        if error < 0.0:
            h *= 0.3
            continue
        turned = abs(value(series[0], 0.0, 1.0))
        factor = (AIM / error) ** 0.0625 if error > 0.0 else inf
        if error > 1.0 or turned > MOST:
            h *= max(0.1, min(0.7, factor, 0.5 * MOST / turned if turned > 0.0 else inf))
            continue
        if law[HALF] > 0.0 and blurs(error, h, y, law, clock, scales[0], series):
            h *= 0.5
            continue
        if law[TORQUE] == FUNCTION and jumps(t, h, y, scales, law, data, table, rows, series):
            h *= 0.5
            continue
        grown = h * min(GROWTH, max(factor, 0.5))
        clock[WISH] = max(grown, wish) if h == limited else grown
        keep(head, t, h, error, y)
        return GOES_ON
    return FAILED


def advance(
    y: Any, clock: Any, scales: Any, kinks: Any, knots: Any, law: Any, data: Any, table: Any, rows: Any,
    matrix: Any, heads: Any, records: Any, rates: Any, count: Any,
) -> int:  # fmt: skip
    """Panels until one may be cut, or the memory of records is full; the last one is not accepted.

    count   in: 1 where the first row has the panel before; out: panels of this call
    """
    made, room = 0, len(heads) - 1
    if count[0] == 0.0:
        heads[0, 1] = 0.0
    answer = GOES_ON
    while made < room and clock[T] < clock[T_END]:
        head, series = heads[made + 1], records[made + 1]
        answer = one(
            y, clock, scales, kinks, law, data, table, rows, matrix, heads[made], records[made], head, series
        )
        if answer != GOES_ON:
            break
        made += 1
        for i in range(16):
            for k in range(3):
                rates[made, k, i] = rows[RATE_Q + k, i]
            rates[made, 3, i] = rows[SPEED, i]
            for k in range(3):
                rates[made, 4 + k, i] = rows[NORMAL + k, i]
        end: Any = empty(3)
        for k in range(3):
            end[k] = value(series[k], y[k], 1.0)
        if may_cut(y, end, law, kinks, knots, rows, series) or made == room:
            answer = MAY_CUT
            break
        clock[T] += head[1]
        if clock[T] >= clock[T_END] * (1.0 - 1e-15):
            clock[T] = clock[T_END]
        for k in range(3):
            y[k] = end[k]
        scales[1] = max(scales[1], abs(y[1]))
    count[0] = made
    return answer
