"""Derivatives on a piece of a motion that is no whole panel, or the first, in plain loops.

At one with a standstill x_s, which moves by -e/Q there, x moves by x_s,p (1 - xi^2), and E_p and E both grow
with xi^2 (see `varied`).
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from numpy import int64

from .pieces import combined, integral, series
from .through import total_of

if TYPE_CHECKING:
    from typing import Any

    from ....compiler.llvm.loops import apart


SHORT, STEP = 3e-6, 1e-3  # of a panel: a short piece, and a step by which Q's slope is found


def in_order(values: Any, forwards: bool, out: Any) -> None:
    """Values at the nodes of a panel in the way of the motion."""
    apart()
    if forwards:
        for k in range(16):
            out[k] = values[k]
    else:
        for k in range(16):
            out[k] = values[15 - k]


def in_motion(
    left: float, half: float, speed: float, of_M: Any, done: Any, M: Any, rate: Any, out: Any
) -> None:
    """dt/du L at the nodes of a piece in motion; done: the integral of Q_p, speed: x_u."""
    apart()
    for k in range(16):
        share = 2.0 * rate[k] * rate[k] / (speed * speed)
        out[k] = 0.5 * rate[k] * (of_M[k] - (left + half * done[k]) * share) / M[k]


def near_rest(
    head: Any, short: bool, shift: float, nodes: Any, of_M: Any, mean: Any, M: Any, Q: Any, bend: Any,
    rate: Any, out: Any,
) -> None:  # fmt: skip
    """dt/du L at the nodes of a piece with a standstill.

    short   so short that Q is a line: its differences would be rounding, and count as much as it is short
    shift   of the standstill
    mean    of Q_p, as E/xi^2 is one of Q
    """
    apart()
    far, pushed, slope = head[1], head[2], head[6] * head[1] / head[0]
    for k in range(16):
        xi = 0.5 + 0.5 * nodes[k]
        steeper = slope if short else (Q[k] - pushed) / (xi * xi)
        grown = far * mean[k] + shift * (steeper - Q[k])
        inertia = of_M[k] + bend[k] * shift * (1.0 - xi * xi)
        share = 2.0 * rate[k] * rate[k] / (far * far)
        out[k] = rate[k] * (0.5 * (inertia - grown * share) / M[k] - shift / far)


def bases(count: Any, u: Any, values: Any, integrals: Any) -> None:
    """Legendre polynomials at places, and their integrals from -1: a row for each."""
    apart()
    for i in range(count):
        values[0, i], values[1, i], integrals[0, i] = 1.0, u[i], u[i] + 1.0
    for j in range(1, 16):
        one, two, share = (2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0), 1.0 / (2.0 * j + 1.0)
        for i in range(count):
            after = one * u[i] * values[j, i] - two * values[j - 1, i]
            integrals[j, i] = share * (after - values[j - 1, i])
            values[j + 1, i] = after


def to_places(piece: Any, head: Any, tables: Any, basis: Any, u: Any) -> None:
    """Legendre polynomials at the nodes of a piece (0) and at places of `head` (2); integrals (1, 3)."""
    a, span, kind = piece[24], piece[25], piece[5]
    for k in range(16):
        xi = 0.5 + 0.5 * tables[0][k]
        u[k] = a + span * (xi if kind == 0 else xi * xi if kind == 1 else 1.0 - xi * xi)
    bases(int64(16), u, basis[0], basis[1])
    for k in range(3):
        u[k] = head[3 + k]
    bases(int64(3), u, basis[2], basis[3])


def at_place(coefficients: Any, basis: Any, place: Any) -> float:
    """A series, or its integral, at one of the places of `head`."""
    a, b = 0.0, 0.0
    for j in range(0, 16, 2):
        a += coefficients[j] * basis[j, place]
        b += coefficients[j + 1] * basis[j + 1, place]
    return a + b


def lay_out(
    piece: Any, half: float, M: Any, Q: Any, bend: Any, tables: Any, series_of: Any, basis: Any, rows: Any,
    head: Any,
) -> None:  # fmt: skip
    """Fill in what all parameters share: inertia, torque, M_x, dt/du in rows 0, 1, 6, 7, and `head`.

    head   half the panel, x_u or the length away from a standstill, Q there; where on the panel it is valid
           that e has been, where the piece ends on it, and where the standstill is; the slope of Q there
    """
    a, span, over, kind = piece[24], piece[25], piece[26], int64(piece[5])
    head[0], head[1], head[2] = half, 0.5 * half * span, 0.0
    head[3], head[4], head[5] = a, a + span, a
    if kind == 1:
        head[1], head[3] = half * span, a + over
    if kind == 2:
        head[1], head[4], head[5] = -half * span, a + span - over, a + span
    to_places(piece, head, tables, basis, rows[3])
    for values, coefficients, row in ((M, 0, 0), (Q, 1, 1), (bend, 2, 6)):
        combined(values, tables[2], series_of[coefficients])
        combined(series_of[coefficients], basis[0], rows[row])
    in_order(piece[27:43], kind != 2, rows[7])
    if kind != 0:
        head[2] = at_place(series_of[1], basis[2], 2)
        head[6] = (series(series_of[1], head[5] + STEP) - series(series_of[1], head[5] - STEP)) / (2.0 * STEP)


def begun(kind: Any, head: Any, start: Any, series_of: Any, state: Any) -> None:
    """tau, e and the shift of a standstill where the motion starts: all at a fixed x, or at rest there."""
    push = series(series_of[1], head[3])
    state[1], state[2] = start[2] - push * start[0], start[0]
    if kind == 1:
        state[0] = -start[1] * series(series_of[0], head[3]) / push
    else:
        state[0] = -start[0] / start[3]


def spread(of_M: Any, of_Q: Any, scale: Any, tables: Any, basis: Any, own: Any) -> None:
    """M_p, Q_p and the integral of Q_p at the nodes of a piece, in rows 0 to 2; series in rows 8 and 9."""
    if scale[0] != 0.0:
        combined(of_M, tables[2], own[8])
        combined(own[8], basis[0], own[0])
    else:
        own[0, :] = 0.0
    if scale[1] != 0.0:
        combined(of_Q, tables[2], own[9])
        combined(own[9], basis[0], own[1])
        combined(own[9], basis[1], own[2])
    else:
        own[9, :], own[1, :], own[2, :] = 0.0, 0.0, 0.0


def shares(
    piece: Any, head: Any, of_M: Any, of_Q: Any, scale: Any, tables: Any, basis: Any, rows: Any, own: Any,
    state: Any, f: Any,
) -> None:  # fmt: skip
    """dt/du L at the nodes by a parameter; e goes on to the end of the piece, a standstill is shifted."""
    kind, half = int64(piece[5]), head[0]
    spread(of_M, of_Q, scale, tables, basis, own)
    first, last = at_place(own[9], basis[3], 0), at_place(own[9], basis[3], 1)
    if kind == 0:
        in_motion(state[1] - half * first, half, head[1], own[0], own[2], rows[0], rows[7], f)
        state[1] += half * (last - first)
        return
    rest = at_place(own[9], basis[3], 2)
    if kind == 2 or piece[26] != 0.0:
        state[2] = -(state[1] + half * (rest - first)) / head[2]
    if scale[1] != 0.0:
        combined(own[1], tables[4], own[6])
    else:
        own[6, :] = 0.0
    near_rest(
        head, abs(piece[25]) < SHORT, state[2], tables[0], own[0], own[6], rows[0], rows[1], rows[6], rows[7],
        own[7],
    )  # fmt: skip
    in_order(own[7], kind == 1, f)
    state[1] = -head[2] * state[2] + half * (last - rest)


def times_by(piece: Any, head: Any, f: Any, start: Any, series_of: Any, state: Any, tables: Any) -> float:
    """tau at the start of a piece, from state and what f holds; state[0] becomes that at its end.

    A piece with a rest beyond the panel starts or ends at another place than its u: at a fixed x there.
    """
    kind, over, far, shift = int64(piece[5]), piece[26], head[1], state[2]
    begin, whole = state[0], total_of(f, tables[1])
    if over == 0.0:
        state[0] = begin + whole
        return float(begin)
    share = over / piece[25]
    xi = sqrt(share)
    u, sign = (2.0 * xi - 1.0, 1.0) if kind == 1 else (1.0 - 2.0 * xi, -1.0)
    coefficients = series_of[3]
    combined(f, tables[2], coefficients)
    rate, moved, steep = series(piece[8:24], u), shift * (1.0 - share), sign * far * xi
    until = integral(coefficients, u)
    if kind == 2:
        state[0] = begin + until - rate / steep * moved
        return float(begin)
    if start[4] != 0.0:  # the motion starts here
        force = series(series_of[1], head[3]) - 0.5 * series(series_of[2], head[3]) * start[3] ** 2
        slope = (-sign * shift * xi - steep * series(coefficients, u) / rate) / rate
        begin = (slope - start[1]) * series(series_of[0], head[3]) / force
    else:
        begin += rate / steep * moved
    state[0] = begin - until + whole
    return float(begin - until)
