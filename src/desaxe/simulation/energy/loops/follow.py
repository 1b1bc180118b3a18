"""One motion in its energy form, in plain loops, whose text numba compiles (`compiled`).

It knows nothing of the mechanism. In a coordinate x with the inertia M(x) and the generalised torque Q(x),
both given at the start and at the Gauss nodes of panels, the kinetic energy is E(x) = E0 + integral of Q, and
the time

    t(x) = integral of sqrt(M / (2 E)) dx.

Panels of one turn serve all turns. Where E vanishes the crank stands still and turns round: with
x = x_s + span xi^2 the energy is xi^2 times a mean of Q, and dt/dxi is smooth. A piece of the motion is an x
that is quadratic in u from -1 to 1, and dt/du as a Legendre series; instants are found on it by Newton's
method. A piece whose series has not ended is cut.

rough    how exactly M and Q are known on each panel, as a share of them
setup    a row per design: E0, number of the edge at the start, way (-1 or 1), period or 0, 1 where Q does
         not depend on the way, the row of Q back
how      tolerance; 1 to keep every piece, else 0: those of instants, and whole turns pass by at once
most     pieces: an array of one, which another thread may set to 0
tables   nodes; weights; columns by which values become Legendre coefficients, running integrals, and means
         of 2 s f(s) from 0 to xi
kept     pieces: start, duration, x as c0 + c1 u + c2 u^2, kind, panel counted over turns, way, and the
         coefficients of dt/du; where there is room, the part of the panel (start, length, what lies beyond)
numbers  end, x and energy there, instants reached, pieces kept, pieces
"""

from __future__ import annotations

from math import floor, nan
from typing import TYPE_CHECKING

from numpy import empty, int64

from .instants import invert
from .pieces import (
    combined,
    energies,
    first_without,
    integral,
    lowest,
    mean_near,
    ordered,
    part_of,
    prepare,
    rates,
    rest_near,
    series,
    standstill,
    tail,
)
from .turns import turns_before

if TYPE_CHECKING:
    from typing import Any


SLOW = 0.1  # of the energy at one end of a piece: so little at the other may be next to one
NEAR = 0.01  # of a piece: next to it
MANY = 100.0  # turns: they pass by at once where no panel must be cut
SAME = 1e-13  # of half a panel: a standstill so little beyond its end is there


def put(parts: Any, top: Any, a: float, span: float, kind: float, over: float) -> Any:
    """One more part of a panel to follow: where it starts, how long, its kind, what of it lies beyond."""
    parts[top, 0], parts[top, 1], parts[top, 2], parts[top, 3] = a, span, kind, over
    return top + 1


def keep(
    piece: Any, start: float, duration: float, a: float, span: float, kind: Any, half: float, middle: float
) -> None:
    """When a piece is gone through, and x on it as a polynomial in its u."""
    bend = 0.0 if kind == 0 else (0.25 if kind == 1 else -0.25) * half * span
    place = a + (0.5 if kind == 0 else 0.0 if kind == 1 else 1.0) * span
    piece[0], piece[1], piece[2] = start, duration, middle + half * place + bend
    piece[3], piece[4], piece[5] = 0.5 * half * span, bend, kind


def too_wide(known: Any, bad: Any) -> bool:
    """Mark panels that had to be cut though the energy hardly changes on them; whether there are any."""
    found = False
    for panel in range(len(known)):
        if known[panel] == 2:
            bad[panel], found = 1, True
    return found


def follow(
    edges: Any,
    rough: Any,
    M: Any,
    forth: Any,
    back: Any,
    setup: Any,
    times: Any,
    how: Any,
    most: Any,
    tables: Any,
    kept: Any,
    which: Any,
    since: Any,
    bad: Any,
    work: Any,
    known: Any,
    last_push: Any,
    numbers: Any,
) -> int:
    """The pieces of a motion until the last instant.

    The status: 0 there, 2 at an end of the panels, 4 too many pieces, 10 some panels are marked as too wide,
    11 no energy form, 12 no room for more pieces.
    """
    rows, more, parts, series_of = empty((7, 16)), empty((7, 16)), empty((128, 4)), empty((2, 16))
    m, q = series_of[0], series_of[1]
    tolerance, energy, way, period = how[0], setup[0], setup[2], setup[3]
    t, turn, largest, last_stop, begin, room = 0.0, 0.0, energy, nan, 0.0, 0.0
    panel: Any = int64(setup[1]) - (1 if way < 0.0 else 0)
    row, stored, pieces = int64(0), int64(0), int64(0)
    rest, inside, marked, count = energy == 0.0, False, False, len(times)
    panels = len(edges) - 1
    smooth = False  # whether this turn's pieces have been whole panels so far
    began, known[:] = 0.0, 0
    while True:
        if panel < 0 or panel >= panels:
            if period == 0.0:
                numbers[0], numbers[1], numbers[2] = t, edges[0] if panel < 0 else edges[panels], energy
                numbers[3], numbers[4], numbers[5] = row, stored, pieces
                return 10 if marked else 2
            turn += way
            panel = panels - 1 if panel < 0 else int64(0)
        side = int64(0) if way > 0.0 else int64(1)
        if period != 0.0 and panel == (int64(0) if way > 0.0 else panels - 1):
            if smooth:
                passed, turns, gain, looked = turns_before(
                    times[row] - t, edges, M, work[side], energy, way, 1e-15 * largest,
                    0.5 * tolerance, (most[0] - pieces) / panels, tables, rows,
                )  # fmt: skip
                pieces += int64(looked) * panels
                t, turn, energy = t + passed, turn + way * turns, energy + turns * gain
                largest = max(largest, energy)
            elif how[1] == 0.0 and times[count - 1] - t > MANY * (t - began) and too_wide(known[side], bad):
                return 10
            smooth, began = how[1] == 0.0, t
        half = 0.5 * (edges[panel + 1] - edges[panel])
        if half <= 0.0:
            panel += 1 if way > 0.0 else -1
            continue
        nodes = 1 + 16 * panel  # the first of the panel's in a row
        inertia, done = M[nodes : nodes + 16], work[side, panel]
        Q = forth[nodes : nodes + 16] if way > 0.0 else back[nodes : nodes + 16]
        if known[side, panel] == 0:
            known[side, panel] = 1
            if not prepare(inertia, Q, half, energy, max(tolerance, rough[panel]), tables, done):
                bad[panel], marked = 1, True
        ready = inside or rest  # whether m and q are the series of this panel
        if ready:
            combined(inertia, tables[2], m)
            combined(Q, tables[2], q)
        if not inside:
            begin, room = -way, 2.0 * way
            left = energy - (0.0 if way > 0.0 else done[16])
        else:
            left = -half * integral(q, begin)
            if not series(q, begin) * way > 0.0:
                return 10 if marked else 11
        out = left + (done[16] if way > 0.0 else 0.0)
        if rest and abs(room) < NEAR:
            out = half * room * mean_near(q, begin, room)
        middle, depth, stopped = 0.5 * (edges[panel] + edges[panel + 1]) + turn * period, 0, False
        top = put(parts, int64(0), begin, room, 1.0 if rest else 0.0, 0.0)
        while top > 0:
            top -= 1
            a, span, kind, over = parts[top, 0], parts[top, 1], int64(parts[top, 2]), parts[top, 3]
            pieces += 1
            depth += 1
            if pieces > most[0]:
                numbers[0], numbers[1], numbers[2] = t, middle + half * a, nan
                numbers[3], numbers[4], numbers[5] = row, stored, pieces
                return 10 if marked else 4
            if depth > 100 or top > 120:
                return 10 if marked else 11
            last = top == 0  # it goes to the end of the panel
            if kind == 0 and span == 2.0 * way:
                ordered(inertia, done, left, way > 0.0, rows[1], rows[2])
            else:
                energies(a, span, kind, half, left, m, q, tables, rows)
            end = 1.0
            if kind != 2:
                end = out if last else left + half * integral(q, a + span)
            first, final = rows[2, 0], rows[2, 15]
            few = kind == 0 and (first < SLOW * final or final < SLOW * first)
            lost = first_without(rows[2])
            if not ready and (few or lost < 16 or not end > 0.0):
                combined(inertia, tables[2], m)
                combined(Q, tables[2], q)
                ready = True
            if kind == 0 and a == -way and ready and energy < NEAR * half * abs(series(q, a) * span):
                near = rest_near(q, half, energy, a)
                if near * way > 0.0:  # it comes to rest soon
                    top = put(parts, int64(0), a, near, 2.0, 0.0)
                else:  # as if it came from a rest before the panel
                    top = put(parts, top, a + near, span - near, 1.0, -near)
                continue
            if lost < 16 or not end > 0.0:
                if kind == 2 or (kind == 1 and lost == 0):
                    return 10 if marked else 11
                good = a if lost == 0 else a + span * part_of(tables[0][lost - 1], kind)
                none = a + span * (1.0 if lost == 16 else part_of(tables[0][lost], kind))
                far, start = standstill(q, half, left, good, none) - a, 0.0
                if kind == 1:
                    start = 0.5 * far
                top = put(parts, int64(0), a + start, far - start, 2.0, 0.0)
                if kind == 1:
                    top = put(parts, top, a, start, 1.0, over)
                continue
            if few and last and final < first and out <= -NEAR * half * series(q, way) * span:
                near = rest_near(q, half, out, way)
                near = 0.0 if abs(near) < SAME else near
                top = put(parts, top, a, span + near, 2.0, near)
                continue
            scale = half * abs(span) * (0.5 if kind == 0 else 1.0)
            duration = rates(kind, scale, tables[1], rows[1], rows[2], rows[0])
            noise = 2e-14
            if kind == 0:
                noise = 2e-15 * largest / lowest(rows[2])
            if not tail(rows[0], tables[2]) <= 0.5 * max(tolerance, noise) * duration:
                if kind == 0 and span == 2.0 * way and lowest(rows[2]) > 0.5 * largest:
                    known[side, panel] = 2
                cut = (0.5 if kind == 0 else 0.25 if kind == 1 else 0.75) * span
                if kind != 0 and abs(over) >= 0.25 * abs(span):
                    return 10 if marked else 11
                top = put(
                    parts, top, a + cut, span - cut, 2.0 if kind == 2 else 0.0, over if kind == 2 else 0.0
                )
                top = put(parts, top, a, cut, 1.0 if kind == 1 else 0.0, over if kind == 1 else 0.0)
                if not ready:
                    combined(inertia, tables[2], m)
                    combined(Q, tables[2], q)
                    ready = True
                continue
            beyond = 0.0
            if over != 0.0:  # the rest lies beyond the panel: that part takes no time
                energies(a if kind == 1 else a + span - over, over, kind, half, left, m, q, tables, more)
                beyond = rates(kind, half * abs(over), tables[1], more[1], more[2], more[0])
            start = t - beyond if kind == 1 else t
            t += duration - beyond
            if how[1] > 0.0 or times[row] <= t:
                if stored >= len(kept):
                    return 12
                keep(kept[stored], start, duration, a, span, kind, half, middle)
                kept[stored, 6], kept[stored, 7] = panel + panels * turn, way
                combined(rows[0], tables[2], kept[stored, 8:])
                if kept.shape[1] > 24:
                    kept[stored, 24], kept[stored, 25], kept[stored, 26] = a, span, over
                while row < count and times[row] <= t:
                    which[row], since[row] = stored, times[row] - start
                    row += 1
                stored += 1
            smooth = smooth and kind == 0 and span == 2.0 * way
            stopped, begin = kind == 2 and over == 0.0, a + span
            room = -span if a == -way else -way - begin
            if row >= count:
                numbers[0], numbers[3], numbers[4], numbers[5] = t, row, stored, pieces
                combined(Q, tables[2], last_push)
                last_push[16], last_push[17], last_push[18] = left, half, middle
                return 10 if marked else 0
        rest, inside = stopped, stopped
        if stopped:
            swing, last_stop = t - last_stop, t
            if setup[4] > 0.0 and how[1] == 0.0 and swing > 0.0:
                last_stop += 2.0 * max(floor((times[row] - t) / (2.0 * swing)), 0.0) * swing
                t = last_stop
            way, energy = -way, 0.0
        else:
            energy = out
            largest = max(largest, energy)
            panel += 1 if way > 0.0 else -1


def motions(
    edges: Any,
    rough: Any,
    fields: Any,
    setup: Any,
    times: Any,
    how: Any,
    most: Any,
    nodes: Any,
    weights: Any,
    coefficients: Any,
    running: Any,
    mean: Any,
    blocks: Any,
    lanes: Any,
    work: Any,
    known: Any,
    kept: Any,
    which: Any,
    x: Any,
    speed: Any,
    status: Any,
    bad: Any,
    numbers: Any,
) -> None:
    """Every design: x and its rate at all instants, NaN where the motion has ended; status and numbers.

    x, speed      their first column, of the start, is left alone
    kept, which   pieces, and those of the instants: of each design, or room for one
    lanes, work, known   buffers: 22 rows of instants, 2 x panels x 17, 2 x panels
    """
    tables, count = (nodes, weights, coefficients, running, mean, blocks), len(times)
    since, last = lanes[21], empty(19)
    for n in range(len(setup)):
        room = n if len(kept) == len(setup) else 0
        own, pieces = which[room], kept[room]
        place, rate, back = x[n, 1:], speed[n, 1:], int64(setup[n, 5])
        for i in range(count):
            place[i], rate[i] = nan, nan
        if status[n] > 0:
            continue
        numbers[n, 3] = 0.0
        status[n] = follow(
            edges[n], rough[n], fields[n, 0], fields[n, 1], fields[n, back], setup[n], times, how, most,
            tables, pieces, own, since, bad[n], work, known, last, numbers[n],
        )  # fmt: skip
        reached = int64(numbers[n, 3])
        if status[n] < 10 and reached > 0 and not invert(reached, own, since, pieces, place, rate, lanes):
            status[n] = 11
        if status[n] == 0:
            numbers[n, 2] = last[16] + last[17] * integral(last, (place[count - 1] - last[18]) / last[17])
