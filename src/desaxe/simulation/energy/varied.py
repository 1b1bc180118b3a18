"""The derivatives of one motion in its energy form by parameters, in plain loops, piece after piece.

At a fixed x the energy changes with a parameter by e(x) = e0 + integral of Q_p, and dt/du of a piece (see
`follow`), at a fixed u, by the share

    L = (x_u)_p / x_u + (M_p / M - E_p / E) / 2.

A piece between fixed places keeps x at u. At one with a standstill x_s, which moves by -e/Q there, x moves by
x_s,p (1 - xi^2), and E_p and E both grow with xi^2. The time until u changes by tau, that at the start of the
piece and the integral of dt/du L; so x at a fixed time by x_p - x' tau. Where Q jumps at an edge of panels
that moves with the parameter, e jumps.

by      M_p, Q_p forth, Q_p back at a fixed x: rows of parameters at the nodes of panels
jumps   of e at the edge before each panel, forth and back
begin   rows of parameters: x_p, x'_p, e at the place of the start, and x' there
out     rows of parameters at instants: x_p, x'_p + x'' tau, tau
ends    rows of parameters: tau and e where the panels end
"""

from __future__ import annotations

from math import nan, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from .follow import follow, invert
from .pieces import combined, integral, series, sums, tail

if TYPE_CHECKING:
    from typing import Any

    from .pieces import apart

COARSER = 3.0  # so much less exactly than inertia and torque their derivatives may be known
BARELY = 1e-6  # of the largest speed: slower, an edge is only touched
JUMP = 1e-9  # of e: less is rounding


def total_of(values: Any, weights: Any) -> float:
    """The integral of values at the nodes from -1 to 1."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for k in range(4):
        a += weights[k] * values[k]
        b += weights[k + 4] * values[k + 4]
        c += weights[k + 8] * values[k + 8]
        d += weights[k + 12] * values[k + 12]
    return (a + b) + (c + d)


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
    far: float, shift: float, pushed: float, nodes: Any, of_M: Any, mean: Any, M: Any, Q: Any, bend: Any,
    rate: Any, out: Any,
) -> None:  # fmt: skip
    """dt/du L at the nodes of a piece with a standstill.

    far     its length, away from there
    shift   of the standstill
    pushed  Q there; mean: of Q_p, as E/xi^2 is one of Q
    """
    apart()
    for k in range(16):
        xi = 0.5 + 0.5 * nodes[k]
        grown = far * mean[k] + shift * ((Q[k] - pushed) / (xi * xi) - Q[k])
        inertia = of_M[k] + bend[k] * shift * (1.0 - xi * xi)
        share = 2.0 * rate[k] * rate[k] / (far * far)
        out[k] = rate[k] * (0.5 * (inertia - grown * share) / M[k] - shift / far)


def panel_by(
    of_M: Any, of_Q: Any, M: Any, nodes: Any, half: float, way: float, scale: Any, tolerance: float,
    tables: Any, work: Any,
) -> bool:  # fmt: skip
    """Fill in what a motion through a whole panel needs; whether M_p and Q_p are resolved on it.

    work   the integral of Q_p up to each node and up to the end; M_p/M at the nodes in the way of the motion,
           and by how much e has grown there
    """
    fine = True
    for p in range(len(of_M)):
        inertia, push, own = of_M[p, nodes : nodes + 16], of_Q[p, nodes : nodes + 16], work[p]
        combined(push, tables[3], own)
        own[16] = total_of(push, tables[1])
        fine = fine and tail(inertia, tables[2]) <= tolerance * scale[p, 0]
        fine = fine and tail(push, tables[2]) <= tolerance * scale[p, 1]
        for k in range(16):
            node, entry = (k, 0.0) if way > 0.0 else (15 - k, own[16])
            own[17 + k], own[33 + k] = inertia[node] / M[node], half * (own[node] - entry)
    return fine


def factors(kept: Any, s: Any, M: Any, start: Any, half: float, weights: Any, rows: Any) -> None:
    """The factors of M_p/M and of -e in dt/du L on a whole panel, rows 0 and 1, and with weights 2 and 3."""
    forwards = kept[s, 7] > 0.0
    for k in range(16):
        rate, inertia = kept[s, 27 + k], M[start + k if forwards else start + 15 - k]
        rows[0, k], rows[1, k] = 0.5 * rate, rate * rate * rate / (half * half * inertia)
    for k in range(16):
        rows[2, k], rows[3, k] = weights[k] * rows[0, k], weights[k] * rows[1, k]


def through(work: Any, side: Any, panel: Any, step: float, rows: Any, state: Any) -> None:
    """tau and e through a whole panel, of all parameters; step: half the panel, in the way of the motion."""
    for p in range(len(state)):
        a, b, c, d, e = 0.0, 0.0, 0.0, 0.0, state[p, 1]
        for k in range(4):
            a += rows[2, k] * work[side, panel, p, 17 + k] - rows[3, k] * (work[side, panel, p, 33 + k] + e)
            b += rows[2, k + 4] * work[side, panel, p, 21 + k]
            b -= rows[3, k + 4] * (work[side, panel, p, 37 + k] + e)
            c += rows[2, k + 8] * work[side, panel, p, 25 + k]
            c -= rows[3, k + 8] * (work[side, panel, p, 41 + k] + e)
            d += rows[2, k + 12] * work[side, panel, p, 29 + k]
            d -= rows[3, k + 12] * (work[side, panel, p, 45 + k] + e)
        state[p, 0] += (a + b) + (c + d)
        state[p, 1] = e + step * work[side, panel, p, 16]


def keep_through(work: Any, rows: Any, state: Any, columns: Any, f: Any, slots: Any) -> None:
    """The coefficients of dt/du L on a whole panel, and the state before it."""
    for p in range(len(state)):
        for k in range(16):
            f[k] = rows[0, k] * work[p, 17 + k] - rows[1, k] * (work[p, 33 + k] + state[p, 1])
        combined(f, columns, slots[p])
        slots[p, 16], slots[p, 17] = state[p, 0], 0.0


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


def add_terms(count: Any, c: Any, value: Any, integral_of: Any, here: Any, until: Any) -> None:
    """A term more of a series and of its integral at places."""
    apart()
    for i in range(count):
        here[i] += c[i] * value[i]
        until[i] += c[i] * integral_of[i]


def spread(piece: Any, M: Any, Q: Any, series_of: Any, tables: Any, rows: Any) -> None:
    """Inertia, torque and its integral from -1 at the nodes of a piece, to rows 0, 1 and 2."""
    combined(M, tables[2], series_of[0])
    combined(Q, tables[2], series_of[1])
    sums(
        piece[24], piece[25], int64(piece[5]), series_of[0], series_of[1], tables[0], rows[3], rows[0],
        rows[1], rows[2], rows[4], rows[5],
    )  # fmt: skip


def lay_out(
    piece: Any, half: float, M: Any, Q: Any, bend: Any, tables: Any, series_of: Any, rows: Any, head: Any
) -> None:  # fmt: skip
    """Fill in what all parameters share: inertia, torque, M_x, dt/du in rows 0, 1, 6, 7, and `head`.

    head   half the panel, x_u or the length away from a standstill, Q there; where on the panel it is valid
           that e has been, where the piece ends on it, and where the standstill is
    """
    a, span, over, kind = piece[24], piece[25], piece[26], int64(piece[5])
    if kind != 0:  # first, since they share rows
        combined(bend, tables[2], series_of[2])
        sums(
            a, span, kind, series_of[2], series_of[2], tables[0], rows[3], rows[6], rows[1], rows[2], rows[4],
            rows[5],
        )  # fmt: skip
    spread(piece, M, Q, series_of, tables, rows)
    in_order(piece[27:43], kind != 2, rows[7])
    head[0], head[1], head[2] = half, 0.5 * half * span, 0.0
    head[3], head[4], head[5] = a, a + span, a
    if kind == 1:
        head[1], head[3] = half * span, a + over
    if kind == 2:
        head[1], head[4], head[5] = -half * span, a + span - over, a + span
    if kind != 0:
        head[2] = series(series_of[1], head[5])


def begun(kind: Any, head: Any, start: Any, series_of: Any, state: Any) -> None:
    """tau, e and the shift of a standstill where the motion starts: all at a fixed x, or at rest there."""
    push = series(series_of[1], head[3])
    state[1], state[2] = start[2] - push * start[0], start[0]
    if kind == 1:
        state[0] = -start[1] * series(series_of[0], head[3]) / push
    else:
        state[0] = -start[0] / start[3]


def shares(
    piece: Any, head: Any, of_M: Any, of_Q: Any, tables: Any, rows: Any, own: Any, state: Any, f: Any
) -> None:
    """dt/du L at the nodes by a parameter; e goes on to the end of the piece, a standstill is shifted."""
    kind, half, series_of = int64(piece[5]), head[0], own[8:10]
    spread(piece, of_M, of_Q, series_of, tables, own)
    first, last = integral(series_of[1], head[3]), integral(series_of[1], head[4])
    if kind == 0:
        in_motion(state[1] - half * first, half, head[1], own[0], own[2], rows[0], rows[7], f)
        state[1] += half * (last - first)
        return
    rest = integral(series_of[1], head[5])
    if kind == 2 or piece[26] != 0.0:
        state[2] = -(state[1] + half * (rest - first)) / head[2]
    combined(own[1], tables[4], own[6])
    near_rest(
        head[1], state[2], head[2], tables[0], own[0], own[6], rows[0], rows[1], rows[6], rows[7], own[7]
    )
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


def crossed(state: Any, jumps: Any, before: Any, panel: Any, way: float, slow: bool) -> None:
    """The jumps of e between two panels, both counted over turns."""
    while before != panel:
        edge = (before if way < 0.0 else before + 1) % jumps.shape[1]
        for p in range(len(state)):
            jump = way * jumps[p, edge]
            if slow and abs(jump) > JUMP * abs(state[p, 1]):
                state[p, 0] = nan
            state[p, 1] += jump
        before += 1 if way > 0.0 else -1


def varied(
    edges: Any, rough: Any, M: Any, forth: Any, back: Any, bend: Any, of_M: Any, of_forth: Any, of_back: Any,
    jumps: Any, begin: Any, scale: Any, how: Any, tables: Any, kept: Any, stored: Any, which: Any, work: Any,
    slots: Any, at: Any, ends: Any, bad: Any,
) -> bool:  # fmt: skip
    """The derivatives on all pieces; whether those of the fields are resolved on their panels.

    slots   a row for each piece that holds instants: of each parameter the coefficients of dt/du L, tau at
            its start, and the shift of its standstill
    at      the row of each instant
    """
    count, panels, fine = len(begin), len(edges) - 1, True
    rows, own, series_of = empty((8, 16)), empty((10, 16)), zeros((4, 16))
    state, head, f, known = empty((count, 3)), empty(6), empty(16), zeros((2, panels), int64)
    row, slot, before, fastest, slow = int64(0), int64(0), int64(kept[0, 6]), 0.0, False
    for s in range(stored):
        counted, way, kind = int64(kept[s, 6]), kept[s, 7], int64(kept[s, 5])
        panel, side = counted % panels, int64(0) if way > 0.0 else int64(1)
        start, nodes, half = 1 + 16 * panel, 16 * panel, 0.5 * (edges[panel + 1] - edges[panel])
        if how[3] > 0.0:
            crossed(state, jumps[side], before, counted, way, slow)
        before = counted
        if known[side, panel] == 0:
            known[side, panel], least = 1, COARSER * max(how[2], rough[panel])
            of_Q, own_M = of_forth if way > 0.0 else of_back, M[start : start + 16]
            if not panel_by(of_M, of_Q, own_M, nodes, half, way, scale, least, tables, work[side, panel]):
                bad[panel], fine = 1, False
        whole, holds = kind == 0 and kept[s, 25] == 2.0 * way, row < len(which) and which[row] == s
        if s == 0 or not whole:
            piece, inertia, Q = kept[s], M[start : start + 16], forth if way > 0.0 else back
            Q = Q[start : start + 16]
            lay_out(piece, half, inertia, Q, bend[start : start + 16], tables, series_of, rows, head)
            for p in range(count if s == 0 else 0):
                begun(kind, head, begin[p], series_of, state[p])
        if whole:
            factors(kept, s, M, start, half, tables[1], rows)
            if holds:
                keep_through(work[side, panel], rows, state, tables[2], f, slots[slot])
            through(work, side, panel, way * half, rows, state)
        else:
            of_Q = of_forth if way > 0.0 else of_back
            for p in range(count):
                of_M_here, of_Q_here = of_M[p, nodes : nodes + 16], of_Q[p, nodes : nodes + 16]
                shares(kept[s], head, of_M_here, of_Q_here, tables, rows, own, state[p], f)
                begin[p, 4] = 1.0 if s == 0 else 0.0
                tau = times_by(kept[s], head, f, begin[p], series_of, state[p], tables)
                if holds:
                    combined(f, tables[2], slots[slot, p])
                    slots[slot, p, 16], slots[slot, p, 17] = tau, state[p, 2]
        while row < len(which) and which[row] == s:
            at[row] = slot
            row += 1
        slot += 1 if holds else 0
        if how[3] > 0.0:
            u = 1.0 - 2.0 * sqrt(kept[s, 26] / kept[s, 25]) if kind == 2 else 1.0
            speed = abs((kept[s, 3] + 2.0 * u * kept[s, 4]) / series(kept[s, 8:24], u))
            fastest = max(fastest, speed)
            slow = speed <= BARELY * fastest
    for p in range(count):  # one array put into another can fail, and what can has no place on disk
        ends[p, 0], ends[p, 1] = state[p, 0], state[p, 1]
    return fine


def instants_by(
    count: Any, which: Any, at: Any, kept: Any, slots: Any, lanes: Any, polynomials: Any, out: Any
) -> None:
    """x_p, x'_p + x'' tau and tau at instants, whose u and dt/du `invert` has left."""
    u, rates, here, until, c = lanes[16], lanes[18], lanes[0], lanes[1], lanes[2]
    values, integrals = polynomials[0], polynomials[1]
    bases(count, u, values, integrals)
    for p in range(out.shape[0]):
        here[:], until[:] = 0.0, 0.0
        for j in range(16):
            for i in range(count):
                c[i] = slots[at[i], p, j]
            add_terms(count, c, values[j], integrals[j], here, until)
        for i in range(count):
            piece, shift = kept[which[i]], slots[at[i], p, 17]
            kind, steep, moved, bent = int64(piece[5]), piece[3] + 2.0 * u[i] * piece[4], 0.0, 0.0
            if kind != 0:
                sign = 1.0 if kind == 1 else -1.0
                xi = 0.5 + 0.5 * sign * u[i]
                moved, bent = shift * (1.0 - xi * xi), -sign * shift * xi
            tau = slots[at[i], p, 16] + until[i]
            out[p, 0, i] = moved - steep / rates[i] * tau
            out[p, 1, i] = (bent - steep * here[i] / rates[i]) / rates[i]
            out[p, 2, i] = tau


def variations(
    edges: Any, rough: Any, M: Any, forth: Any, back: Any, bend: Any, of_M: Any, of_forth: Any, of_back: Any,
    jumps: Any, begin: Any, scale: Any, setup: Any, times: Any, how: Any, most: Any, nodes: Any, weights: Any,
    coefficients: Any, running: Any, mean: Any, kept: Any, out: Any, ends: Any, status: Any, bad: Any,
    numbers: Any,
) -> None:  # fmt: skip
    """Every design that has an energy form: its motion once more, and its derivatives.

    The status becomes 10 where some panels are too wide for them, 12 where there is no room for all pieces.
    """
    tables, count, panels = (nodes, weights, coefficients, running, mean), len(times), edges.shape[1] - 1
    parameters = begin.shape[1]
    which, since, lanes, at = empty(count, int64), empty(count), empty((21, count)), empty(count, int64)
    x, speed, polynomials = empty(count), empty(count), empty((2, 17, count))
    work, known, last = empty((2, panels, 17)), empty((2, panels), int64), empty(19)
    slots, work_by = empty((count, parameters, 18)), empty((2, panels, parameters, 49))
    for n in range(len(setup)):
        out[n, :, :, :], ends[n, :, :] = nan, nan
        if status[n] >= 10:
            continue
        found = follow(
            edges[n], rough[n], M[n], forth[n], back[n], setup[n], times, how, most, tables, kept, which,
            since, bad[n], work, known, last, numbers[n],
        )  # fmt: skip
        reached, stored = int64(numbers[n, 3]), int64(numbers[n, 4])
        if found >= 10 or (found == 4 and status[n] == 0):  # swings that the motion has left out
            status[n] = found
            continue
        if stored == 0:
            continue
        if not varied(
            edges[n], rough[n], M[n], forth[n], back[n], bend[n], of_M[n], of_forth[n], of_back[n], jumps[n],
            begin[n], scale[n], how, tables, kept, stored, which[:reached], work_by, slots, at, ends[n],
            bad[n],
        ):  # fmt: skip
            status[n] = 10
        elif reached > 0 and invert(reached, which, since, kept, x, speed, lanes):
            instants_by(reached, which, at, kept, slots, lanes, polynomials, out[n])
