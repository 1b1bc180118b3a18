"""The places of motions at instants, in plain loops: times on a piece, series of u, by Newton's method."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from ....compiler.llvm.loops import apart

if TYPE_CHECKING:
    from typing import Any

CLOSE = 1e-7  # of u: the step of Newton's method after this one is rounding


def guess_lanes(count: Any, c: Any, d: Any, u: Any, since: Any) -> None:
    """The place at an instant from the first two terms of dt/du."""
    apart()
    for i in range(count):
        left = since[i] - c[i] + 0.5 * d[i]
        root = sqrt(max(c[i] * c[i] + 2.0 * d[i] * left, 0.0))
        u[i] = min(max(2.0 * left / (c[i] + root), -1.0), 1.0)


def begin_lanes(count: Any, c: Any, u: Any, since: Any, f: Any, g: Any, before: Any, now: Any) -> None:
    """The first term of the time until u, less `since`, and of its rate."""
    apart()
    for i in range(count):
        before[i], now[i] = 1.0, u[i]
        f[i], g[i] = c[i] * (u[i] + 1.0) - since[i], c[i]


def add_lanes(count: Any, j: Any, c: Any, u: Any, f: Any, g: Any, before: Any, now: Any) -> None:
    """The j-th term of both."""
    apart()
    one, two, share = (2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0), 1.0 / (2.0 * j + 1.0)
    for i in range(count):
        after = one * u[i] * now[i] - two * before[i]
        f[i] += c[i] * (after - before[i]) * share
        g[i] += c[i] * now[i]
        before[i], now[i] = now[i], after


def improve_lanes(count: Any, u: Any, f: Any, g: Any) -> float:
    """A step of Newton's method; the largest change."""
    apart()
    change = 0.0
    for i in range(count):
        after = min(max(u[i] - f[i] / g[i], -1.0), 1.0)
        change = max(change, abs(after - u[i]))
        u[i] = after
    return change


def invert(count: Any, which: Any, since: Any, kept: Any, x: Any, speed: Any, lanes: Any) -> bool:
    """x and its rate at instants of pieces, all at once; whether each was found."""
    u, f, g, before, now = lanes[16], lanes[17], lanes[18], lanes[19], lanes[20]
    for i in range(count):
        for j in range(16):
            lanes[j, i] = kept[which[i], 8 + j]
    guess_lanes(count, lanes[0], lanes[1], u, since)
    done = False
    for _ in range(40):
        begin_lanes(count, lanes[0], u, since, f, g, before, now)
        for j in range(1, 16):
            add_lanes(count, j, lanes[j], u, f, g, before, now)
        if done:
            break
        done = improve_lanes(count, u, f, g) < CLOSE
    for i in range(count):
        piece = kept[which[i]]
        x[i] = piece[2] + u[i] * (piece[3] + u[i] * piece[4])
        speed[i] = (piece[3] + 2.0 * u[i] * piece[4]) / g[i]
    return done
