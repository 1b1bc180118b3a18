"""The motion of one design in plain loops, which are compiled: pieces, panel, cut, and again.

sheets   pieces of loads: rows of angles (or speeds) from which they hold, and their numbers for both ways
knots    speeds at which pieces meet
records  series of panels
ends     kind of the cut at the end of a panel (RESTING: nothing moves), row of its angle
laws     the law that holds on a panel
sums     first energy, work done either way, largest kinetic energy, energy residual, the one before the last
         state, largest energy, work so far
"""

from __future__ import annotations

from math import copysign, floor, inf, nan
from typing import TYPE_CHECKING

from numpy import empty, int64

from . import cuts
from . import law as layout
from .cuts import earliest
from .law import acceleration, motion, place, start, still_at
from .newton import newton
from .panels import CHOSEN, FLIPPED, GOES_ON, LEFT, PAUSE, STOPPED, T_END, WISH, T, guess, keep, one, value

if TYPE_CHECKING:
    from typing import Any

BEGIN, DONE, KINETIC, OFF, BEFORE, ENERGY, WORK, SUMS = range(8)  # of the sums
RESTING = -1.0  # in place of a cut: nothing has moved
RESTS, NO_BALANCE, TWO_BALANCES, CUT, CHATTERS, UNMOVED = range(3, 9)  # besides those of `panels`
JAMS_AT = 1.0 - 1e-6  # see `..law`
AHEAD = 1e-9  # rad: which piece follows an angle
BEHIND = 1e-8  # of the largest speed of a motor's table: which piece of it follows a speed
TURNED_ON = 1e-6  # rad: so far from a dead centre the slider has left its position
PROBES = 2000  # instants of a motion at which loads that depend on time are asked
SOON = 1e-6  # of the motion: then a normal force has left 0
EXACT = 0.02  # tolerances: a panel whose inside is so exact need not be solved again up to a cut
SAME = 1e-13  # of an instant: a knot that is nearer has been reached
INSIDE = 1e-12  # rad, and last bits of an angle: so far inside of its piece a function is evaluated
CROWD, NARROW, BESIDE = 64, 0.1, 0.005  # so many panels, rad that they turn, of a speed on either side of it


def piece_of(term: Any, angle: float, speed: float, way: float, sheets: Any, law: Any) -> None:
    """The piece of a load that holds at an angle or a speed, and the angle at which it ends."""
    first, count, period = int64(term[layout.SHEET]), int64(term[layout.PIECES]), term[layout.PERIOD]
    turned, x, behind = 0.0, speed, inf
    term[layout.END] = copysign(inf, way)
    if count == 0:
        return
    if period > 0.0:
        turned = period * floor((angle - sheets[first, 0]) / period)
        x = angle - turned
    low, high = first, first + count
    while high - low > 1:
        middle = int64(0.5 * (low + high))
        if sheets[middle, 0] <= x:
            low = middle
        else:
            high = middle
    for k in range(layout.SLOTS):
        term[layout.KIND + k] = sheets[low, (1 if way > 0.0 else 1 + layout.SLOTS) + k]
    if period == 0.0:
        return
    behind = turned + (sheets[low + 1, 0] if low + 1 < first + count else sheets[first, 0] + period)
    end = behind if way > 0.0 else turned + sheets[low, 0]
    if law[layout.FIRST] < end and end < law[layout.LAST]:
        term[layout.END] = end
    if term[layout.KIND] == layout.OVER_THETA:
        term[layout.KIND + 1] += turned
    elif term[layout.KIND] == layout.FUNCTION:
        inside = INSIDE + 4e-16 * abs(angle)
        term[layout.KIND + 2], term[layout.KIND + 3] = turned + sheets[low, 0] + inside, behind - inside


def pieces(
    theta: float, omega: float, way: float, growing: float, fast: float, sheets: Any, law: Any
) -> None:
    """The pieces of all loads that hold from a state on."""
    law[layout.DIRECTION] = way
    for n in range(int64(law[layout.COUNT])):
        at, speed = layout.TERMS + layout.TERM * n, omega + copysign(BEHIND * fast, growing)
        piece_of(law[at : at + layout.TERM], theta + copysign(AHEAD, way), speed, way, sheets, law)


def balances(rows: Any) -> tuple[float, int]:
    """The side of the guide at the first node, with the positive one held, and the sets of forces."""
    side = copysign(1.0, rows[layout.NORMAL, 0])
    share = rows[layout.WEDGE, 0] * side
    return side, 0 if share >= JAMS_AT else 2 if share < -1.0 else 1


def law_for(
    t: float, y: Any, way: float, fast: float, sheets: Any, law: Any, data: Any, rows: Any, still: Any
) -> tuple[int, int, float, float]:
    """The law for one way of turning: code of an error, sets of forces, acceleration, side of the guide."""
    code, side, solutions, growing = 0, 1.0, 1, 1.0
    for trial in range(2):
        pieces(rows[layout.ANGLE, 0], rows[layout.SPEED, 0], way, growing, fast, sheets, law)
        law[layout.PRESSED] = 1.0
        code = motion(t, y, law, data, rows, still)
        if law[layout.RUBS] > 0.0 and code == 0:
            side, solutions = balances(rows)
            law[layout.PRESSED] = side
            code = motion(t, y, law, data, rows, still)
        if trial == 1 or not fast > 0.0 or code != 0:
            break
        growing = copysign(1.0, acceleration(rows, 0))
    return code, solutions, acceleration(rows, 0), side


def lean(y: Any, t: float, way: float, law: Any, data: Any, rows: Any, still: Any) -> int:
    """The sign of Y' where the crank is, or just ahead of it at a dead centre."""
    ahead: Any = empty(3)
    travel, code = rows[layout.TRAVEL, 0], 0
    if abs(travel) <= law[layout.TINY]:
        ahead[0], ahead[1], ahead[2] = y[0] + TURNED_ON * way / rows[layout.SLOPE, 0], y[1], y[2]
        code = motion(t, ahead, law, data, rows, still)
        travel = rows[layout.TRAVEL, 0]
        code = motion(t, y, law, data, rows, still) if code == 0 else code
    law[layout.SIDE] = copysign(1.0, travel)
    law[layout.DRAG] = law[layout.MU] * law[layout.SIDE] * way
    return code


def soon_pressed(t: float, y: Any, clock: Any, law: Any, data: Any, rows: Any, still: Any) -> float:
    """The side of the guide just after the normal force has vanished, from the motion as it is."""
    later: Any = empty(3)
    side, ahead = law[layout.PRESSED], SOON * clock[T_END]
    if clock[WISH] > 0.0:
        ahead = min(ahead, clock[WISH])
    if motion(t, y, law, data, rows, still) != 0:
        return float(side)
    for k in range(3):
        later[k] = y[k] + ahead * rows[layout.RATE_Q + k, 0]
    law[layout.PRESSED] = 1.0
    code, normal = motion(t + ahead, later, law, data, rows, still), rows[layout.NORMAL, 0]
    if code == 0 and abs(normal) > rows[layout.UNSURE, 0]:
        side = copysign(1.0, normal)
    law[layout.PRESSED] = side
    return float(side)


def choose(y: Any, clock: Any, knots: Any, sheets: Any, law: Any, data: Any, rows: Any, still: Any) -> int:
    """Choose direction, pieces and signs that hold from a state on: GOES_ON, or why none does."""
    t, fast, starts = clock[T], 0.0, 0
    for k in range(len(knots)):
        fast = max(fast, abs(knots[k]))
    if y[1] != 0.0 and law[layout.RUBS] == 0.0 and fast == 0.0:
        clock[CHOSEN] = 1.0
        pieces(place(y[0], law), 0.0, copysign(1.0, y[1]), 1.0, fast, sheets, law)
        return GOES_ON
    law[layout.PRESSED] = 1.0
    code = motion(t, y, law, data, rows, still)
    if code != 0:
        return code
    first, last = (copysign(1.0, y[1]), 1) if y[1] != 0.0 else (1.0, 2)
    way, chosen, side = first, 0.0, 1.0
    for trial in range(last):
        way = first if trial == 0 else -first
        code = lean(y, t, way, law, data, rows, still) if law[layout.RUBS] > 0.0 else 0
        if code != 0:
            return code
        code, solutions, alpha, pressed = law_for(t, y, way, fast, sheets, law, data, rows, still)
        if code != 0:
            return code
        if y[1] != 0.0:
            if solutions != 1:
                return NO_BALANCE if solutions == 0 else TWO_BALANCES
            starts, chosen, side = 1, way, pressed
        elif law[layout.RUBS] == 0.0 and way * alpha >= 0.0:
            starts, chosen = 1, way
            break
        elif law[layout.RUBS] > 0.0 and solutions == 1 and way * alpha > 0.0:
            starts, chosen, side = starts + 1, way, pressed
        elif law[layout.RUBS] > 0.0 and solutions == 2:
            law[layout.PRESSED] = -pressed
            code = motion(t, y, law, data, rows, still)
            if code != 0:
                return code
            if way * alpha > 0.0 or way * acceleration(rows, 0) > 0.0:
                return TWO_BALANCES  # at rest nothing says on which side the guide presses
    if starts != 1:
        return RESTS if starts == 0 else TWO_BALANCES
    if chosen != way:
        if law[layout.RUBS] > 0.0:
            code = lean(y, t, chosen, law, data, rows, still)
        code, solutions, alpha, side = law_for(t, y, chosen, fast, sheets, law, data, rows, still)
    if law[layout.RUBS] > 0.0:
        law[layout.PRESSED] = 1.0
        code = motion(t, y, law, data, rows, still)
        unsure = abs(rows[layout.NORMAL, 0]) <= rows[layout.UNSURE, 0]
        law[layout.PRESSED] = clock[FLIPPED] if clock[FLIPPED] != 0.0 else side
        if unsure:
            law[layout.PRESSED] = soon_pressed(t, y, clock, law, data, rows, still)
        clock[FLIPPED] = 0.0
    clock[CHOSEN] = 1.0
    return code


def wait(y: Any, clock: Any, knots: Any, sheets: Any, law: Any, data: Any, rows: Any, head: Any) -> int:
    """Rest until a load moves the crank, or to the next knot: GOES_ON, or what a function has raised.

    Asked at many instants: a push that is over sooner than that is not noticed.
    """
    still: Any = empty(32)
    start, end, before, code = clock[T], clock[PAUSE], clock[T], RESTS
    now = end
    for k in range(1, PROBES + 1):
        if law[layout.WAITS] == 2.0:
            clock[T] = start + (end - start) * (k / PROBES)
            code = choose(y, clock, knots, sheets, law, data, rows, still)
            if code != RESTS:
                now = clock[T]
                break
            before = clock[T]
    while code != RESTS and before < 0.5 * (before + now) < now:
        clock[T] = 0.5 * (before + now)
        other = choose(y, clock, knots, sheets, law, data, rows, still)
        if 0 < other < RESTS:
            return other
        if other == RESTS:
            before = clock[T]
        else:
            now = clock[T]
    if 0 < code < RESTS:
        return code
    clock[T], clock[WISH], clock[CHOSEN] = now, 0.0, 0.0
    keep(head, start, 0.0, 0.0, y)
    head[6] = now
    return GOES_ON


def shortened(
    y: Any, clock: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any, matrix: Any, head: Any,
    series: Any, cut: Any,
) -> None:  # fmt: skip
    """Solve a panel again up to its cut, where its inside is not exact."""
    state, part, copy = empty(32), empty((3, 17)), empty((layout.ROWS, 16))
    h = cut[cuts.PART] * head[1]
    if not (head[2] > EXACT and cut[cuts.PART] > 1e-6 and cut[cuts.PART] <= 1.0):
        return
    guess(clock[T], h, y, head, series, table, rows, state)
    error = newton(clock[T], h, y, state, scales, law, data, table, copy, matrix, part)
    if error < 0.0:
        return
    head[1], head[2], cut[cuts.PART] = h, error, 1.0
    for j in range(17):
        for k in range(3):
            series[k, j] = part[k, j]
    for k in range(layout.ROWS):
        for i in range(16):
            rows[k, i] = copy[k, i]


def cut_at(
    y: Any, clock: Any, law: Any, data: Any, still: Any, head: Any, series: Any, cut: Any, new: Any
) -> float:  # fmt: skip
    """The instant of a cut, and the state there."""
    rows: Any = empty((layout.ROWS, 16))
    t, h, at = clock[T] + cut[cuts.PART] * head[1], head[1], int64(cut[cuts.PLACE])
    for k in range(3):
        new[k] = value(series[k], y[k], cut[cuts.PART])
    if cut[cuts.PLACE] < 0.0:
        return float(t)
    if (
        not (cut[cuts.KIND] == cuts.LIMIT and law[layout.HALF] > 0.0)
        and motion(t, new, law, data, rows, still) == 0
    ):
        rate = rows[layout.RATE_Q + at, 0]
        later = t + (cut[cuts.VALUE] - new[at]) / rate if rate != 0.0 else t
        if later == later:
            t = min(max(later, clock[T]), clock[PAUSE])
            for k in range(3):
                new[k] = value(series[k], y[k], (t - clock[T]) / h)
    new[at] = cut[cuts.VALUE]
    return float(t)


def step(
    y: Any, clock: Any, scales: Any, kinks: Any, knots: Any, sheets: Any, law: Any, data: Any, table: Any,
    rows: Any, matrix: Any, last: Any, before: Any, head: Any, series: Any, cut: Any, new: Any,
) -> int:  # fmt: skip
    """The next panel, up to its cut: GOES_ON or CUT, and the state at its end, or why there is none."""
    still: Any = empty(32)
    if clock[CHOSEN] == 0.0:
        code = choose(y, clock, knots, sheets, law, data, rows, still)
        if code != GOES_ON:
            return STOPPED if code == 2 else code
    code = one(y, clock, scales, kinks, sheets, law, data, table, rows, matrix, last, before, head, series)
    if code != GOES_ON:
        return code
    earliest(y, law, kinks, knots, table, rows, series, clock, cut)
    clock[LEFT] = 0.0
    if cut[cuts.PART] <= 2.0 and clock[T] + cut[cuts.PART] * head[1] <= clock[PAUSE]:
        lost = cut[cuts.LOST_AT] <= cut[cuts.PART] + cuts.SAME
        shortened(y, clock, scales, law, data, table, rows, matrix, head, series, cut)
        head[6] = cut_at(y, clock, law, data, still, head, series, cut, new)
        clock[LEFT] = 1.0 if cut[cuts.PLACE] == 0.0 else 0.0
        clock[CHOSEN] = 0.0
        clock[FLIPPED] = -law[layout.PRESSED] if lost else 0.0
        code = CUT
    else:
        cut[cuts.KIND] = cuts.NO_CUT
        for k in range(3):
            new[k] = value(series[k], y[k], 1.0)
        if head[6] >= clock[PAUSE] * (1.0 - 1e-15):
            head[6] = clock[PAUSE]
    clock[T], scales[1] = head[6], max(scales[1], abs(new[1]))
    return code


def ends_motion(cut: Any, kinks: Any) -> bool:
    """True where a motion ends at a cut."""
    if cut[cuts.KIND] == cuts.KINK:
        return bool(cut[cuts.ROW] >= 0.0 and kinks[int64(cut[cuts.ROW]), 2] >= 0.0)
    return bool(cut[cuts.KIND] == cuts.LIMIT or cut[cuts.KIND] == cuts.JAMMED)


def slides(t: float, y: Any, law: Any, data: Any, scales: Any) -> bool:
    """True if a torque that jumps at a speed drives the crank back to it from either side: it chatters.

    scales   its last number becomes that v
    """
    rows, still, trial, rates = empty((layout.ROWS, 16)), empty(32), empty(3), empty(2)
    low, high = y[1] - BESIDE * abs(y[1]), y[1] + BESIDE * abs(y[1])
    trial[0] = y[0]
    for k in range(2):
        trial[1] = low if k == 0 else high
        rates[k] = rows[layout.RATE_V, 0] if motion(t, trial, law, data, rows, still) == 0 else nan
    gap = rates[0] - rates[1]
    for _ in range(64):  # to the half with the larger part of the difference
        trial[1] = 0.5 * (low + high)
        here = rows[layout.RATE_V, 0] if motion(t, trial, law, data, rows, still) == 0 else nan
        if rates[0] - here > here - rates[1]:
            high, rates[1] = trial[1], here
        else:
            low, rates[0] = trial[1], here
    scales[2] = high
    return bool(gap > 0.0 and rates[0] - rates[1] > 0.5 * gap)


def account(y: Any, law: Any, data: Any, sums: Any, first: bool) -> None:
    """Take the energy of a state into account."""
    state, angles, rows = empty(32), empty(16), empty((layout.ROWS, 16))
    for i in range(16):
        state[i] = y[0]
    still_at(state, law, data, rows, angles)
    energy = 0.5 * y[1] * y[1] + rows[layout.POTENTIAL, 0]
    if first:
        sums[BEGIN] = energy
    off = abs(energy - y[2] - sums[BEGIN])
    sums[DONE] += abs(y[2] - sums[WORK])
    sums[KINETIC] = max(sums[KINETIC], 0.5 * y[1] * y[1])
    sums[BEFORE] = sums[OFF]
    sums[OFF] = max(sums[OFF], off) if off == off else sums[OFF]
    sums[ENERGY], sums[WORK] = max(sums[ENERGY], abs(energy)), y[2]


def pause(clock: Any, knots: Any, first: int) -> None:
    """Set the next instant at which panels are cut, from the first of some numbers on."""
    before = clock[PAUSE]
    clock[PAUSE] = clock[T_END]
    for k in range(first, len(knots)):
        if clock[T] < knots[k] * (1.0 - SAME) and knots[k] < clock[PAUSE] * (1.0 - SAME):
            clock[PAUSE] = knots[k]
    if clock[PAUSE] != before:
        clock[CHOSEN] = 0.0


def advance(
    y: Any, clock: Any, scales: Any, kinks: Any, knots: Any, sheets: Any, law: Any, data: Any, table: Any,
    rows: Any, matrix: Any, heads: Any, records: Any, ends: Any, laws: Any, count: Any,
    sums: Any,
) -> int:  # fmt: skip
    """Panels to a knot, or until the motion ends or stands still, or the records are full: GOES_ON.

    count   in: 1 where the first row has the panel before; out: panels of this call
    """
    cut, new = empty(6), empty(3)
    made, most, code = 0, len(heads) - 1, GOES_ON
    if count[0] == 0.0:
        heads[0, 1] = 0.0
        code = start(law, data, clock[T_END], y, scales, rows)
        if code != 0 or not scales[1] < inf:
            return STOPPED if code == STOPPED else UNMOVED
        account(y, law, data, sums, True)
    while made < most and clock[T] < clock[PAUSE]:
        head, series = heads[made + 1], records[made + 1]
        code = step(
            y, clock, scales, kinks, knots, sheets, law, data, table, rows, matrix, heads[made],
            records[made], head, series, cut, new,
        )  # fmt: skip
        if code == RESTS and law[layout.WAITS] > 0.0:
            code = wait(y, clock, knots, sheets, law, data, rows, head)
            cut[cuts.KIND], new[0], new[1], new[2] = RESTING, y[0], y[1], y[2]
            for j in range(17):
                series[0, j], series[1, j], series[2, j] = 0.0, 0.0, 0.0
        if code != GOES_ON and code != CUT:
            break
        made += 1
        ends[made, 0], ends[made, 1] = cut[cuts.KIND], cut[cuts.ROW]
        for k in range(len(law)):
            laws[made, k] = law[k]
        for k in range(3):
            y[k] = new[k]
        account(y, law, data, sums, False)
        if code == CUT and (ends_motion(cut, kinks) or cut[cuts.KIND] == cuts.STANDSTILL):
            break
        code = GOES_ON
    count[0] = made
    crowd = code == GOES_ON and made >= CROWD and law[layout.CALLS] > 0.0 and abs(y[0] - heads[1, 3]) < NARROW
    return CHATTERS if crowd and slides(clock[T], y, law, data, scales) else code
