"""The derivatives of one motion in its energy form by parameters, in plain loops, piece after piece.

At a fixed x the energy changes with a parameter by e(x) = e0 + integral of Q_p, and dt/du of a piece (see
`follow`), at a fixed u, by the share

    L = (x_u)_p / x_u + (M_p / M - E_p / E) / 2.

A piece between fixed places keeps x at u. The time until u changes by tau, that at the start of the piece and
the integral of dt/du L; so x at a fixed time by x_p - x' tau. Where Q jumps at an edge of panels that moves
with the parameter, e jumps. Swings that are left out are as long as the one before them.

fields  rows of M, Q and others at the start and the nodes of panels
by      rows of parameters: the rows of M_p, Q_p forth and Q_p back at a fixed x, -1 where they are 0
jumps   of e at the edge before each panel, forth and back
begin   rows of parameters: x_p, x'_p, e at the place of the start, and x' there
how     as for `follow`, and: tolerance of the derivatives; 1 under tables; 1 to take all as resolved; the
        rows of M_x and of Q back
kept    what `follow` keeps
out     rows of parameters at instants: x_p, x'_p + x'' tau, tau
ends    rows of parameters: tau and e where the panels end
"""

from __future__ import annotations

from math import inf, nan, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from .partly import bases, begun, lay_out, shares, times_by
from .pieces import combined, series
from .through import factors, prepare_panel, settle, through, through_turns

if TYPE_CHECKING:
    from typing import Any

    from ....compiler.llvm.loops import apart

COARSER = 3.0  # so much less exactly than inertia and torque their derivatives may be known
BARELY = 1e-6  # of the largest speed: slower, an edge is only touched
JUMP = 1e-9  # of e: less is rounding


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


def keep_whole(work: Any, rows: Any, state: Any, columns: Any, f: Any, slots: Any) -> None:
    """The coefficients of dt/du L on a whole panel, and the state before it."""
    for p in range(len(state)):
        for k in range(16):
            f[k] = rows[0, k] * work[p, 17 + k] - rows[1, k] * (work[p, 33 + k] + state[p, 1])
        combined(f, columns, slots[p])
        slots[p, 16], slots[p, 17] = state[p, 0], 0.0


def largest(fields: Any, by: Any, whatever: bool, scale: Any) -> None:
    """Rows of parameters: the largest M_p and Q_p, 0 for none; infinite where they count as resolved."""
    for p in range(len(by)):
        for k in range(2):
            most = 0.0
            for node in range(1, fields.shape[1] if by[p, k] >= 0 else 1):
                size = abs(fields[by[p, k], node])
                if size > most:
                    most = size
            scale[p, k] = inf if whatever and most > 0.0 else most


def keep_part(
    piece: Any, head: Any, fields: Any, by: Any, start: Any, scale: Any, first: bool, begin: Any, tables: Any,
    basis: Any, rows: Any, own: Any, series_of: Any, state: Any, holds: Any, f: Any, slots: Any,
) -> None:  # fmt: skip
    """Go through another piece with all parameters; where it holds instants, keep the same of it."""
    side = 1 if piece[7] > 0.0 else 2
    for p in range(len(state)):
        inertia, push = fields[by[p, 0], start : start + 16], fields[by[p, side], start : start + 16]
        shares(piece, head, inertia, push, scale[p], tables, basis, rows, own, state[p], f)
        begin[p, 4] = 1.0 if first else 0.0
        tau = times_by(piece, head, f, begin[p], series_of, state[p], tables)
        if holds:
            combined(f, tables[2], slots[p])
            slots[p, 16], slots[p, 17] = tau, state[p, 2]


def speed_at_end(piece: Any) -> float:
    """The speed of x where a piece ends."""
    u = 1.0 - 2.0 * sqrt(piece[26] / piece[25]) if piece[5] == 2.0 else 1.0
    return float(abs((piece[3] + 2.0 * u * piece[4]) / series(piece[8:24], u)))


def leave_out(swings: float, stops: Any, state: Any) -> None:
    """tau after whole swings; stops: rows of parameters: tau at the last two standstills."""
    for p in range(len(state)):
        state[p, 0] += swings * (stops[p, 1] - stops[p, 0])
        stops[p, 1] = state[p, 0]


def varied(
    edges: Any, rough: Any, fields: Any, by: Any, jumps: Any, begin: Any, how: Any, tables: Any, kept: Any,
    stored: Any, which: Any, work: Any, slots: Any, at: Any, ends: Any, bad: Any,
) -> bool:  # fmt: skip
    """The derivatives on all pieces; whether those of the fields are resolved on their panels.

    slots   a row for each piece that holds instants: of each parameter the coefficients of dt/du L, tau at
            its start, and the shift of its standstill
    at      the row of each instant
    """
    count, panels, fine = len(begin), len(edges) - 1, True
    rows, own, series_of, basis = empty((8, 16)), empty((10, 16)), zeros((4, 16)), empty((4, 17, 16))
    whole_turns = empty((panels, 3, 16))
    state, head, f, known = empty((count, 3)), empty(7), empty(16), zeros((2, panels), int64)
    lanes, stops, entry, scale = zeros((count, 16)), zeros((count, 2)), empty(count), empty((count, 2))
    largest(fields, by, how[4] > 0.0, scale)
    M, bend = fields[0], fields[int64(how[5])]
    row, slot, before, fastest, slow = int64(0), int64(0), int64(kept[0, 6]), 0.0, False
    for s in range(stored):
        counted, way, kind = int64(kept[s, 6]), kept[s, 7], int64(kept[s, 5])
        side = int64(0) if way > 0.0 else int64(1)
        if kind == 4:
            leave_out(kept[s, 0], stops, state)
            continue
        if kind == 3:
            through_turns(
                kept[s, :4], way, edges, work[side], jumps[side], tables, whole_turns, entry, state, lanes
            )  # fmt: skip
            before, slow = counted + int64(way) * (int64(kept[s, 0]) * panels - 1), False
            continue
        panel = counted % panels
        start, half = 1 + 16 * panel, 0.5 * (edges[panel + 1] - edges[panel])
        Q = fields[1 if way > 0.0 else int64(how[6]), start : start + 16]
        if how[3] > 0.0:
            crossed(state, jumps[side], before, counted, way, slow)
        before, inertia = counted, M[start : start + 16]
        if known[side, panel] == 0:
            known[side, panel], least = 1, COARSER * max(how[2], rough[panel])
            if not prepare_panel(
                fields, by, inertia, Q, start, half, way, scale, least, tables, work[side, panel]
            ):
                bad[panel], fine = 1, False
        whole, holds = kind == 0 and kept[s, 25] == 2.0 * way, row < len(which) and which[row] == s
        if s == 0 or not whole:
            settle(state, lanes)
            lay_out(kept[s], half, inertia, Q, bend[start : start + 16], tables, series_of, basis, rows, head)
            for p in range(count if s == 0 else 0):
                begun(kind, head, begin[p], series_of, state[p])
        if whole:
            factors(kept[s, 27:43], work[side, panel, count, 17:33], half, tables[1], rows)
            if holds:
                settle(state, lanes)
                keep_whole(work[side, panel], rows, state, tables[2], f, slots[slot])
            through(work[side, panel], rows[2], rows[3], state, lanes)
        else:
            keep_part(
                kept[s], head, fields, by, start, scale, s == 0, begin, tables, basis, rows, own, series_of,
                state, holds, f, slots[slot],
            )  # fmt: skip
            if kind == 2 and kept[s, 26] == 0.0:
                for p in range(count):
                    stops[p, 0], stops[p, 1] = stops[p, 1], state[p, 0]
        while row < len(which) and which[row] == s:
            at[row] = slot
            row += 1
        slot += 1 if holds else 0
        if how[3] > 0.0:
            speed = speed_at_end(kept[s])
            fastest = max(fastest, speed)
            slow = speed <= BARELY * fastest
    settle(state, lanes)
    for p in range(count):  # one array put into another can fail, and what can has no place on disk
        ends[p, 0], ends[p, 1] = state[p, 0], state[p, 1]
    return fine


def add_terms(count: Any, c: Any, value: Any, integral_of: Any, here: Any, until: Any) -> None:
    """A term more of a series and of its integral at places."""
    apart()
    for i in range(count):
        here[i] += c[i] * value[i]
        until[i] += c[i] * integral_of[i]


def instants_by(
    count: Any, which: Any, where: Any, at: Any, kept: Any, slots: Any, lanes: Any, polynomials: Any, out: Any
) -> None:
    """x_p, x'_p + x'' tau and tau at instants, whose u and dt/du are given."""
    u, rates, here, until, c = where[0], where[1], lanes[0], lanes[1], lanes[2]
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
    edges: Any, rough: Any, fields: Any, by: Any, jumps: Any, begin: Any, how: Any, nodes: Any, weights: Any,
    coefficients: Any, running: Any, mean: Any, blocks: Any, kept: Any, which: Any, where: Any, out: Any,
    ends: Any, status: Any, bad: Any, numbers: Any,
) -> None:  # fmt: skip
    """The derivatives of every design that `motions` has followed; the status becomes 10 on wide panels."""
    tables, count, panels = (
        (nodes, weights, coefficients, running, mean, blocks),
        out.shape[3],
        edges.shape[1] - 1,
    )
    parameters = begin.shape[1]
    lanes, at, polynomials = empty((3, count)), empty(count, int64), empty((2, 17, count))
    slots, work = empty((count + 1, parameters, 18)), empty((2, panels, parameters + 1, 49))
    for n in range(len(edges)):
        out[n, :, :, :], ends[n, :, :] = nan, nan
        reached, stored = int64(numbers[n, 3]), int64(numbers[n, 4])
        if status[n] >= 10 or stored == 0:
            continue
        if not varied(
            edges[n], rough[n], fields[n], by, jumps[n], begin[n], how, tables, kept[n], stored,
            which[n, :reached], work, slots, at, ends[n], bad[n],
        ):  # fmt: skip
            status[n] = 10
        elif reached > 0:
            instants_by(reached, which[n], where[n], at, kept[n], slots, lanes, polynomials, out[n])
