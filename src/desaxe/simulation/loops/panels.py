"""The next panel of time in plain loops, which are compiled: as long as the tolerance and the cuts allow.

clock    instant, suggested length, end of the motion, largest error of an angle next to a limit angle, 1
         where the motion starts from an angle that it does not reach again, the side of the guide after a
         change of side or 0, 1 where pieces and signs are chosen, the next knot of time or the end
kinks    rows of angles at which the motion is cut, the periods in which they repeat, or inf, and the status
         of a motion that ends there, or -1
head     of a panel: start, length, error, q, v and W at the start, instant up to which it holds
"""

from __future__ import annotations

from math import copysign, floor, inf, pi, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, nextafter

from ...compiler.llvm.loops import apart
from . import law as layout
from .law import law_at, motion
from .newton import DEVIATES, ENDS, POINTS, TAIL, newton, product

if TYPE_CHECKING:
    from typing import Any

T, WISH, T_END, SHARP, LEFT, FLIPPED, CHOSEN, PAUSE = range(8)  # of the clock
GOES_ON, FAILED, STOPPED = range(3)
AHEAD = 1.3  # of a panel: so far its series guess the next one, from there on straight lines
BEYOND = 1.15  # of a panel: so far its series reach a limit angle, next to which S has no digits
BEHIND, ABOUT = 1.1, 1.01  # of the way to a cut: pieces go on smoothly, but those of a function end
AIM = 0.01  # tolerances: the error that the next length is chosen for
GROWTH = 2.0  # from panel to panel
LEAST_H = 1e-6  # of the motion: no panel is shortened to less to tell a limit angle
MOST = 1000.0 * 2.0 * pi  # rad in one panel
LAST_BITS = 1e-15  # of an instant: within a panel that ends where a function jumps
NEAR = 1e-9  # rad: an angle that a stretch starts from is not reached at once


def value(series: Any, start: float, s: float) -> float:
    """A coordinate at a part of a panel."""
    x = 2.0 * s - 1.0
    before, now, total = 1.0, x, series[0] + series[1] * x
    for n in range(1, 16):
        before, now = now, (2.0 * n + 1.0) / (n + 1.0) * (x * now) - n / (n + 1.0) * before
        total += series[n + 1] * now
    return float(start + total)


def guess(t: float, h: float, y: Any, last: Any, series: Any, table: Any, rows: Any, state: Any) -> None:
    """The state at the nodes, by the panel before; by the rates if that has no length."""
    if last[1] == 0.0:
        speed, rate, bend = rows[layout.RATE_Q, 0], rows[layout.RATE_V, 0], rows[layout.CURVED, 0]
        for i in range(16):
            s = h * table[0, i]
            state[i] = y[0] + speed * s + (0.5 * bend * s * s if speed == 0.0 else 0.0)
            state[16 + i] = y[1] + rate * s
        return
    nodes: Any = empty((4, 16))
    for i in range(16):
        nodes[0, i] = (t + h * table[0, i] - last[0]) / last[1]
        nodes[1, i], nodes[2, i] = 2.0 * min(nodes[0, i], AHEAD) - 1.0, 1.0
        nodes[3, i] = nodes[1, i]
        state[i] = last[3] + series[0, 0] + series[0, 1] * nodes[1, i]
        state[16 + i] = last[4] + series[1, 0] + series[1, 1] * nodes[1, i]
    for n in range(1, 16):
        term(2.0 - 1.0 / (n + 1.0), 1.0 - 1.0 / (n + 1.0), series[0, n + 1], series[1, n + 1], nodes, state)
    for k in range(2):
        far, near = value(series[k], last[3 + k], AHEAD), value(series[k], last[3 + k], AHEAD - 1e-3)
        for i in range(16):
            state[16 * k + i] += (far - near) / 1e-3 * max(nodes[0, i] - AHEAD, 0.0)


def term(up: float, down: float, of_q: float, of_v: float, nodes: Any, state: Any) -> None:
    """Add the next polynomial of a series at all nodes, from the two before."""
    apart()
    for i in range(16):
        one = up * (nodes[1, i] * nodes[3, i]) - down * nodes[2, i]
        nodes[2, i], nodes[3, i] = nodes[3, i], one
        state[i] += of_q * one
        state[16 + i] += of_v * one


def time_over(gap: float, speed: float, bend: float) -> float:
    """The time over a distance at a speed that grows steadily; infinite where it ends before."""
    square = speed * speed + 2.0 * bend * gap
    if square < 0.0:
        return inf
    below = speed + sqrt(square)
    return 2.0 * gap / below if below > 0.0 else inf


def gap_to(kink: Any, theta: float, way: float, least: float) -> float:
    """The distance to an angle ahead, or to its next repetition beyond `least`; infinite if there is none."""
    gap: float = (kink[0] - theta) * way
    if kink[1] < inf:
        gap -= kink[1] * floor(gap / kink[1])
        return gap if gap > least else gap + kink[1]
    return gap if gap > least else inf


def next_kink(theta: float, way: float, least: float, kinks: Any, law: Any) -> Any:
    """The distance to the next angle that cuts the motion, its row, and the angle.

    The first is one that ends it; the row is -1 where the piece of a load ends.
    """
    best, row, ends, angle = inf, -1, False, 0.0
    for k in range(int64(law[layout.COUNT])):
        end = law[layout.TERMS + layout.TERM * k + layout.END]
        gap = (end - theta) * way
        if gap > 0.0 and gap < best:
            best, angle = gap, end
    for k in range(len(kinks)):
        gap, last = gap_to(kinks[k], theta, way, least), kinks[k, 2] >= 0.0
        if gap < best - NEAR or (gap < best and ends == last) or (last and not ends and gap < best + NEAR):
            best, row, ends, angle = gap, k, last, kinks[k, 0]
            if kinks[k, 1] < inf:
                angle += kinks[k, 1] * floor((theta + way * gap - angle) / kinks[k, 1] + 0.5)
    return best, row, angle


def until_cut(y: Any, law: Any, kinks: Any, rows: Any) -> float:
    """The time to a little behind the next angle that cuts the motion, or to before a limit angle."""
    speed, bend, theta = rows[layout.RATE_Q, 0], rows[layout.CURVED, 0], rows[layout.ANGLE, 0]
    way = copysign(1.0, speed if speed != 0.0 else bend)
    shortest = inf
    if law[layout.HALF] > 0.0:
        shortest = 0.95 * time_over(0.5 * pi - y[0] * way, speed * way, bend * way)
    else:
        gap, _, _ = next_kink(theta, way, NEAR, kinks, law)
        if gap < inf:
            beyond = ABOUT if law[layout.CALLS] == 2.0 else BEHIND
            shortest = beyond * time_over(gap, speed * way, bend * way)
    return shortest if shortest > 0.0 else inf


def blurs(error: float, h: float, y: Any, law: Any, clock: Any, rtol: float, series: Any) -> bool:
    """True where the series of a panel do not reach a limit angle with the digits that are asked for."""
    at_end, beyond = value(series[0], y[0], 1.0), value(series[0], y[0], BEYOND)
    end = copysign(0.5 * pi, beyond - at_end)
    if (at_end - end) * (beyond - end) >= 0.0:
        return False
    x = 2.0 * root(series[0], y[0], end, 1.0, BEYOND) - 1.0
    growth = (x + sqrt(x * x - 1.0)) ** 16.0
    return bool(error * TAIL * rtol * growth > max(rtol, clock[SHARP]) and h > LEAST_H * clock[T_END])


def root(series: Any, start: float, aim: float, a: float, b: float) -> float:
    """The part of a panel between two at which a series has a value that it passes there."""
    at_a, at_b = value(series, start, a) - aim, value(series, start, b) - aim
    if at_a == 0.0 or at_b == 0.0 or not at_a * at_b < 0.0:
        return a if abs(at_a) < abs(at_b) else b
    for _ in range(100):  # regula falsi; an end that stays counts half
        s = b - at_b * (b - a) / (at_b - at_a)
        now = value(series, start, s) - aim
        if now * at_b < 0.0:
            a, at_a = b, at_b
        else:
            at_a *= 0.5
        done = now == 0.0 or abs(s - b) <= 1e-15
        b, at_b = s, now
        if done:
            break
    return b


def jumps(
    t: float, h: float, y: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any, series: Any
) -> bool:  # fmt: skip
    """True where a function jumps between an end of a panel and the node next to it, which no node sees."""
    still, end, other = empty(32), empty(3), empty((layout.ROWS, 16))
    first, last = product(table[ENDS], rows[layout.RATE_V]), product(table[ENDS + 1], rows[layout.RATE_V])
    for k in range(3):
        end[k] = value(series[k], y[k], 1.0)
    if motion(t * (1.0 + LAST_BITS), y, law, data, other, still) != 0:
        return True
    first -= other[layout.RATE_V, 0]
    if motion((t + h) * (1.0 - LAST_BITS), end, law, data, other, still) != 0:
        return True
    worst = max(abs(first), abs(last - other[layout.RATE_V, 0]))
    return bool(h * worst > DEVIATES * TAIL * scales[0] * scales[2])


def missed(
    t: float, h: float, y: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any, series: Any
) -> float:  # fmt: skip
    """A shorter length for a panel whose nodes have missed what a function does in time; 0 for none."""
    every, state, other, rates = law[layout.PROBE], empty(32), empty((layout.ROWS, 16)), empty(17)
    for j in range(16):
        rates[j] = product(table[POINTS + j], rows[layout.RATE_V])
    rates[16] = 0.0
    k, last = floor(t / every) + 1.0, (t + h) / every
    while k < last:
        for i in range(16):
            other[layout.TIME, i] = every * min(k + i, max(k, floor(last) - (floor(last) == last)))
            s = (other[layout.TIME, i] - t) / h
            state[i], state[16 + i] = value(series[0], y[0], s), value(series[1], y[1], s)
        if law_at(state, law, data, other, 0) != 0:
            return 0.0
        for i in range(16):
            s = (other[layout.TIME, i] - t) / h
            off = h * abs(other[layout.RATE_V, i] - value(rates, 0.0, s))
            if off > DEVIATES * TAIL * scales[0] * max(scales[1], abs(state[16 + i])):
                return float(max(other[layout.TIME, i] - t - every, 0.5 * (other[layout.TIME, i] - t)))
        k += 16.0
    return 0.0


def one(
    y: Any, clock: Any, scales: Any, kinks: Any, sheets: Any, law: Any, data: Any, table: Any, rows: Any,
    matrix: Any, last: Any, before: Any, head: Any, series: Any,
) -> int:  # fmt: skip
    """The longest panel that the tolerance allows: GOES_ON, FAILED or STOPPED."""
    state: Any = empty(32)
    t, bends = clock[T], law[layout.HALF] > 0.0 or len(kinks) > 0 or len(sheets) > 0
    if bends or last[1] == 0.0 or clock[WISH] == 0.0:
        code = motion(t, y, law, data, rows, state)
        if code == layout.STOP:
            return STOPPED
        if code != 0:
            return FAILED
    limited, wish = until_cut(y, law, kinks, rows) if bends else inf, clock[WISH]
    if wish == 0.0:
        speed, bend = abs(rows[layout.RATE_Q, 0]), abs(rows[layout.CURVED, 0])
        wish = min(1.0 / speed if speed > 0.0 else inf, sqrt(2.0 / bend) if bend > 0.0 else inf, clock[T_END])
    h, least = min(wish, limited, clock[PAUSE] - t), 10.0 * (nextafter(t, inf) - t)
    while h >= least:
        if last[1] == 0.0 and motion(t, y, law, data, rows, state) == layout.STOP:
            return STOPPED
        guess(t, h, y, last, before, table, rows, state)
        error = newton(t, h, y, state, scales, law, data, table, rows, matrix, series)
        if error == -float(layout.STOP):
            return STOPPED
        if error < 0.0:
            h *= 0.3
            continue
        turned = abs(value(series[0], 0.0, 1.0))
        factor = (AIM / error) ** 0.0625 if error > 0.0 else inf
        if error > 1.0 or turned > MOST:
            h *= max(0.1, min(0.7, factor, 0.5 * MOST / turned if turned > 0.0 else inf))
            continue
        if law[layout.HALF] > 0.0 and blurs(error, h, y, law, clock, scales[0], series):
            h *= 0.5
            continue
        shorter = missed(t, h, y, scales, law, data, table, rows, series) if law[layout.PROBE] > 0.0 else 0.0
        if shorter > 0.0:
            h = shorter
            continue
        if law[layout.CALLS] > 0.0 and jumps(t, h, y, scales, law, data, table, rows, series):
            h *= 0.5
            continue
        grown = h * min(GROWTH, max(factor, 0.5))
        clock[WISH] = max(grown, wish) if h == limited else grown
        keep(head, t, h, error, y)
        return GOES_ON
    return FAILED


def keep(head: Any, t: float, h: float, error: float, y: Any) -> None:
    """Record a panel's start, length, error and state."""
    head[0], head[1], head[2], head[3], head[4], head[5], head[6] = t, h, error, y[0], y[1], y[2], t + h
