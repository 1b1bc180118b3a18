"""A piece of a motion, in plain loops: its inertia, energy and dt/du at Gauss nodes, from series on a panel.

Loops that should run in the lanes of a vector end at a length that is read from an array: LLVM unrolls a
short loop whose length it knows before it looks for vectors.

See `follow`. Series are Legendre's, of 16 terms over u from -1 to 1; Q is that of the way in which the crank
turns, `half` half the width of the panel.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from ....compiler.llvm.loops import apart

if TYPE_CHECKING:
    from typing import Any


def combined(values: Any, columns: Any, out: Any) -> None:
    """The sum of columns by 16 values."""
    apart()
    count = columns.shape[1]
    for j in range(count):
        out[j] = 0.0
    for k in range(0, 16, 4):
        a, b, c, d = values[k], values[k + 1], values[k + 2], values[k + 3]
        for j in range(count):
            first = columns[k, j] * a + columns[k + 1, j] * b
            last = columns[k + 2, j] * c + columns[k + 3, j] * d
            out[j] += first + last


def tail(values: Any, columns: Any) -> float:
    """The larger of the last two Legendre coefficients of values at nodes: one is odd, one even."""
    apart()
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for k in range(0, 8, 2):
        a += columns[k, 14] * (values[k] + values[15 - k])
        b += columns[k, 15] * (values[k] - values[15 - k])
        c += columns[k + 1, 14] * (values[k + 1] + values[14 - k])
        d += columns[k + 1, 15] * (values[k + 1] - values[14 - k])
    return float(max(abs(a + c), abs(b + d)))


def series(c: Any, u: float) -> float:
    """A Legendre series."""
    before, now, total = 1.0, u, c[0] + c[1] * u
    for j in range(2, 16):
        before, now = now, ((2.0 * j - 1.0) * u * now - (j - 1.0) * before) / j
        total += c[j] * now
    return float(total)


def integral(c: Any, u: float) -> float:
    """The integral of a Legendre series from -1."""
    before, now, total = 1.0, u, c[0] * (u + 1.0)
    for j in range(1, 16):
        after = ((2.0 * j + 1.0) * u * now - j * before) / (j + 1.0)
        total += c[j] * (after - before) / (2.0 * j + 1.0)
        before, now = now, after
    return float(total)


def mean_near(q: Any, u: float, d: float) -> float:
    """The mean of a series from u to u + d, which is near: by three of Gauss's nodes."""
    side = 0.5 * sqrt(0.6) * d
    ends = series(q, u + 0.5 * d - side) + series(q, u + 0.5 * d + side)
    return (5.0 * ends + 8.0 * series(q, u + 0.5 * d)) / 18.0


def rest_near(q: Any, half: float, energy: float, u: float) -> float:
    """The distance from u, where there is little energy, to a standstill, exact relative to itself."""
    d = 0.0
    for _ in range(10):
        d = -energy / (half * mean_near(q, u, d))
    return d


def standstill(q: Any, half: float, left: float, good: float, bad: float) -> float:
    """The zero of left + half (integral of the series q), from a place with energy to one without."""
    u = 0.5 * (good + bad)
    for _ in range(80):
        here = left + half * integral(q, u)
        if here > 0.0:
            good = u
        else:
            bad = u
        slope = half * series(q, u)
        after = u - here / slope if slope != 0.0 else good
        if not (after - good) * (after - bad) < 0.0:
            after = 0.5 * (good + bad)
        if abs(after - u) <= 1e-16:
            break
        u = after
    return float(u)


def part_of(node: float, kind: Any) -> float:
    """The share of a piece that lies before a node of its u."""
    xi = 0.5 + 0.5 * node
    return xi * xi if kind == 1 else xi


def energies(
    a: float, span: float, kind: Any, half: float, left: float, m: Any, q: Any, tables: Any, rows: Any
) -> None:
    """Inertia and energy at the nodes of a piece that starts at a, into rows 1 and 2.

    kind: 0 in motion all along, 1 at rest at its start, 2 at its end. At rest the energy is that over xi^2,
    and the nodes go away from there.
    """
    sums(a, span, kind, m, q, tables[0], rows[0], rows[1], rows[3], rows[4], rows[5], rows[6])
    if kind == 0:
        shifted(left, half, rows[4], rows[2])
    else:
        combined(rows[3], tables[4], rows[2])
        shifted(0.0, half * span if kind == 1 else -half * span, rows[2], rows[2])


def shifted(left: float, half: float, values: Any, out: Any) -> None:
    """left + half (values)."""
    for k in range(len(out)):
        out[k] = left + half * values[k]


def sums(
    a: float, span: float, kind: Any, m: Any, q: Any, nodes: Any, u: Any, inertia: Any, push: Any, done: Any,
    before: Any, now: Any,
) -> None:  # fmt: skip
    """The series m and q, and the integral of q, at the nodes of a piece."""
    apart()
    for k in range(16):
        xi = 0.5 + 0.5 * nodes[k]
        u[k] = a + span * (xi if kind == 0 else xi * xi if kind == 1 else 1.0 - xi * xi)
        before[k], now[k] = 1.0, u[k]
        inertia[k], push[k], done[k] = m[0], q[0], q[0] * (u[k] + 1.0)
    for j in range(1, 16):
        one, two, share = (2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0), q[j] / (2.0 * j + 1.0)
        of_m, of_q = m[j], q[j]
        for k in range(16):
            after = one * u[k] * now[k] - two * before[k]
            inertia[k] += of_m * now[k]
            push[k] += of_q * now[k]
            done[k] += share * (after - before[k])
            before[k], now[k] = now[k], after


def ordered(M: Any, work: Any, left: float, forwards: bool, inertia: Any, energy: Any) -> None:
    """Inertia and energy at the nodes of a whole panel, in the way of the motion."""
    apart()
    count = len(M)
    if forwards:
        for k in range(count):
            inertia[k], energy[k] = M[k], left + work[k]
    else:
        for k in range(count):
            inertia[k], energy[k] = M[15 - k], left + work[15 - k]


def rates(kind: Any, scale: float, weights: Any, inertia: Any, energy: Any, rate: Any) -> float:
    """dt/du at the nodes of a piece, in their order; how long it takes."""
    apart()
    for k in range(len(weights)):
        rate[k] = scale * sqrt(inertia[k] / (2.0 * energy[k]))
    total = 0.0
    for k in range(8):
        total += weights[k] * rate[k] + weights[k + 8] * rate[k + 8]
    if kind == 2:
        for k in range(8):
            rate[k], rate[15 - k] = rate[15 - k], rate[k]
    return total


def lowest(values: Any) -> float:
    """The least of 16 values."""
    a, b = min(values[0], values[8]), min(values[1], values[9])
    for k in range(2, 8, 2):
        a, b = min(a, values[k], values[k + 8]), min(b, values[k + 1], values[k + 9])
    return float(min(a, b))


def first_without(values: Any) -> int:
    """The first node without energy; 16 where all have some."""
    if lowest(values) > 0.0:
        return 16
    for k in range(16):
        if not values[k] > 0.0:
            return k
    return 16


def prepare(M: Any, Q: Any, half: float, energy: float, tolerance: float, tables: Any, work: Any) -> bool:
    """The work done up to each node of a panel and up to its end; whether M and Q are resolved on it."""
    combined(Q, tables[3], work)
    total, push, inertia = 0.0, 0.0, 0.0
    for k in range(16):
        work[k] *= half
        total += tables[1][k] * Q[k]
        push, inertia = max(push, abs(Q[k])), max(inertia, M[k])
    work[16] = half * total
    reach = max(push, 0.1 * max(energy, abs(half * total)) / half)
    return bool(tail(Q, tables[2]) <= tolerance * reach and tail(M, tables[2]) <= tolerance * inertia)
