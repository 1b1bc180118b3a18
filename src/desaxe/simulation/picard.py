"""Panels of the crank angle for one motion, in plain loops, whose text numba compiles (`compiled`).

Away from standstills the crank angle is a good variable: the kinetic energy E and the time obey

    dE/dtheta = torque(t, theta, omega) + loads - gravity's,    dt/dtheta = 1/omega = sqrt(M_eff / (2 E)),

and M_eff, loads and gravity are known at the nodes of a panel before E is. Only the torque asks for t and
omega there. Picard's iteration finds them: a sweep asks for the torque at all nodes and integrates twice, by
products with a constant matrix. Loops over the nodes run in the lanes of a vector, each design by itself;
such short loops are vectors where LLVM does not unroll them before (`short_loops` of a module).
Gauss nodes make the end of a panel far more exact than its inside, by which its width is chosen.

table    of `nodes`: a row for each node
room     a row for each value at the nodes, in the order below; the last three are coefficients of series
memory   the width of the next panel [rad], steps in time to wait before it is tried, how far the step in time
         before went [rad], the width of this panel with its sign
"""

from __future__ import annotations

from math import copysign, inf, nan, sqrt
from typing import TYPE_CHECKING

from numpy import int64

if TYPE_CHECKING:
    from typing import Any

    def torque(t: float, theta: float, omega: float, number: float) -> float:
        """The torque [N m]."""

    def asked_at_nodes(number: float, room: Any, first: Any, count: Any) -> bool:
        """Fill in the torques at the nodes, in the fourth row from one on; True if they could be had."""

    def apart() -> None:
        """The promise that arrays share no memory."""

    def mul_add(a: float, b: float, c: float) -> float:
        """a * b + c, rounded once where the machine can."""

    def still_in_lanes(theta: float, branch: float, p: Any) -> tuple[float, float, float]:
        """`still` with sine and cosine written out, so that a loop of it vectorises."""


NODES = int64(16)
INERTIA, LOAD, WEIGHT, TORQUE, ENERGY, SLOWNESS, RATE, MISS, GAIN, PART = range(10)
TIME, ANGLE, SPEED, NOW = 10, 11, 12, 13  # as the torque takes them
OF_TIME, OF_ENERGY, PLACES, ROWS = 14, 15, 16, 17
PLACE, SHARE, LAST, INTEGRALS, SERIES = 0, 1, 2, 4, 20
SWEEPS, TRIALS = int64(24), int64(8)
FAR = 1e5  # rad: beyond, an angle has lost digits that the tolerance asks for
WIDEST, LEAST = 2.5, 0.02  # rad
INSIDE = 3.0  # of rtol: the error inside of a panel
WAIT = 8.0  # steps in time after a panel that failed
FAR_TOO_WIDE = 3.0  # times the largest error, with a torque that is not quite right yet


def furnish(table: Any, room: Any) -> None:
    """The places of the nodes as a row, for a loop down a column is no loop of vectors."""
    for i in range(NODES):
        room[PLACES, i] = table[i, PLACE]


def still_at_nodes(theta: float, width: float, p: Any, setup: Any, room: Any) -> None:
    """Inertia, loads and gravity, which depend on the angle alone."""
    apart()
    for i in range(NODES):
        angle = theta + width * room[PLACES, i]
        inertia, weight, travel = still_in_lanes(angle, setup[0], p)
        room[ANGLE, i] = angle
        room[INERTIA, i] = inertia
        room[LOAD, i] = setup[5] * travel
        room[WEIGHT, i] = weight


def integrate(start: float, width: float, table: Any, room: Any, rate: Any, out: Any) -> None:
    """The integral of a rate from the start of the panel, at every node."""
    apart()
    for i in range(NODES):
        room[out, i] = start
    for j in range(0, NODES, 8):  # eight at once: a shorter loop would be unrolled, not vectorised
        a, b, c, d = room[rate, j], room[rate, j + 1], room[rate, j + 2], room[rate, j + 3]
        e, f, g, h = room[rate, j + 4], room[rate, j + 5], room[rate, j + 6], room[rate, j + 7]
        for i in range(NODES):
            k = INTEGRALS + i
            first = mul_add(
                d, table[j + 3, k], mul_add(c, table[j + 2, k], mul_add(b, table[j + 1, k], a * table[j, k]))
            )
            last = mul_add(
                h,
                table[j + 7, k],
                mul_add(g, table[j + 6, k], mul_add(f, table[j + 5, k], e * table[j + 4, k])),
            )
            room[out, i] = mul_add(width, first + last, room[out, i])


def powers(room: Any) -> None:
    """dE/dtheta at the nodes."""
    apart()
    for i in range(NODES):
        room[RATE, i] = room[TORQUE, i] + room[LOAD, i] - room[WEIGHT, i]


def slowness(way: float, room: Any) -> None:
    """dt/dtheta at the nodes, but for its sign, and the speed."""
    apart()
    for i in range(NODES):
        slow = sqrt(0.5 * room[INERTIA, i] / room[ENERGY, i])
        room[SLOWNESS, i] = slow
        room[SPEED, i] = way / slow


def course(t: float, energy: float, width: float, table: Any, room: Any) -> float:
    """Energies, speeds and instants at the nodes from the torque there; the least energy."""
    powers(room)
    integrate(energy, width, table, room, int64(RATE), int64(ENERGY))
    least = inf
    for i in range(NODES):
        least = min(least, room[ENERGY, i])
    if least > 0.0:  # else NaN would slow down what follows
        slowness(copysign(1.0, width), room)
        integrate(t, abs(width), table, room, int64(SLOWNESS), int64(TIME))
    return least


def ask(number: float, room: Any) -> float:
    """The torque at all nodes; by how much it has changed at most, NaN where it is none."""
    if not asked_at_nodes(number, room, int64(TIME), NODES):
        return nan
    differ(room)
    most, none = 0.0, 0.0
    for i in range(NODES):
        change = abs(room[MISS, i])
        most = max(most, change)
        none += 0.0 * change
    return most + none


def differ(room: Any) -> None:
    """The torque's change at the nodes, and the new one."""
    apart()
    for i in range(NODES):
        room[MISS, i] = room[NOW, i] - room[TORQUE, i]
        room[TORQUE, i] = room[NOW, i]


def bend_of(number: float, room: Any) -> float:
    """The derivative of the torque by the speed in the middle of a panel, for the corrections alone."""
    t, angle, omega = room[TIME, 8], room[ANGLE, 8], room[SPEED, 8]
    step = 1e-4 * omega
    return float((torque(t, angle, omega + step, number) - torque(t, angle, omega, number)) / step)


def correct(bend: float, width: float, table: Any, room: Any) -> None:
    """Foresee what the torque's change makes of the speed, and that again of the torque: Newton's method."""
    integrate(0.0, width, table, room, int64(MISS), int64(GAIN))
    respond(bend, room)
    integrate(0.0, width, table, room, int64(PART), int64(GAIN))
    respond(bend, room)
    foresee(room)


def foresee(room: Any) -> None:
    """Add to the torque what its last change makes of it."""
    apart()
    for i in range(NODES):
        room[TORQUE, i] += room[PART, i] - room[MISS, i]


def respond(bend: float, room: Any) -> None:
    """The torque's change by a gain of energy, besides that which is known."""
    apart()
    for i in range(NODES):
        by_energy = bend / (2.0 * room[ENERGY, i] * room[SLOWNESS, i])
        room[PART, i] = room[MISS, i] + by_energy * room[GAIN, i]


def sweep(
    t: float, energy: float, least: float, width: float, number: float, rtol: float, table: Any, room: Any
) -> float:
    """Sweeps until the torque stays as it is: the least energy at the nodes; 0 where that fails."""
    before = inf
    bend = copysign(1.0, width) * bend_of(number, room)
    for _ in range(SWEEPS):
        if not least > 0.0:
            return 0.0
        change = ask(number, room) * abs(width) / least
        if not change < 0.7 * before:
            return 0.0 if not change < 1e-15 else least
        if change > 0.0:
            correct(bend, width, table, room)
            least = course(t, energy, width, table, room)
        next_one = change * (change / before if before < inf else 1.0)
        if next_one < 0.01 * rtol:
            return least if least > 0.0 else 0.0
        before = change
    return 0.0


def sums(table: Any, room: Any) -> Any:
    """Over the whole of a panel, for each radian of it: gain of energy, work, time."""
    gain, work, time = 0.0, 0.0, 0.0
    for i in range(NODES):
        share = table[i, SHARE]
        gain += share * room[RATE, i]
        work += share * (room[TORQUE, i] + room[LOAD, i])
        time += share * room[SLOWNESS, i]
    return gain, work, time


def error_inside(width: float, least: float, table: Any, room: Any) -> float:
    """The error inside of a panel: of the speed, relative, or of the angle [rad]."""
    a, b, c, d, quickest = 0.0, 0.0, 0.0, 0.0, inf
    for i in range(NODES):
        first, last, rate, slow = table[i, LAST], table[i, LAST + 1], room[RATE, i], room[SLOWNESS, i]
        a += first * rate
        b += last * rate
        c += first * slow
        d += last * slow
        quickest = min(quickest, slow)
    return abs(width) * max(0.5 * (abs(a) + abs(b)) / least, (abs(c) + abs(d)) / quickest)


def jumps(outside: float, room: Any, at: Any, way: Any) -> bool:
    """True where the torque jumps between an end of a panel and the node next to it, which no node sees."""
    a, b, c = room[TORQUE, at], room[TORQUE, at + way], room[TORQUE, at + 2 * way]
    return bool(abs(outside - a) > 2.0 * (abs(a - b) + abs(b - c)) + 1e-6 * abs(a))


def panel(
    t: float, y: Any, width: float, p: Any, setup: Any, rtol: float, table: Any, room: Any, new: Any
) -> Any:
    """The state and the time at the end of a panel, the error inside of it as a multiple of rtol."""
    energy = 0.5 * y[1] * y[1]
    still_at_nodes(y[0], width, p, setup, room)
    first = torque(t, y[0], copysign(sqrt(2.0 * energy / room[INERTIA, 0]), width), setup[4])
    for i in range(NODES):
        room[TORQUE, i] = first
    least = course(t, energy, width, table, room)
    if not least > 0.0:
        return t, inf
    error = error_inside(width, least, table, room) / (INSIDE * rtol)
    if not error < FAR_TOO_WIDE:  # the torque will not mend that
        return t, error
    least = sweep(t, energy, least, width, setup[4], rtol, table, room)
    if not least > 0.0:
        return t, inf
    gain, work, time = sums(table, room)
    after = energy + width * gain
    if not after > 0.0:
        return t, inf
    new[0] = y[0] + width
    new[1] = copysign(sqrt(2.0 * after), width)
    new[2] = y[2] + width * work
    end = t + abs(width) * time
    omega = copysign(1.0 / room[SLOWNESS, 15], width)
    last = torque(end, new[0], omega, setup[4])
    if jumps(first, room, 0, 1) or jumps(last, room, 15, -1):
        return end, inf
    return end, error_inside(width, least, table, room) / (INSIDE * rtol)


def by_panel(
    t: float,
    y: Any,
    longest: float,
    p: Any,
    setup: Any,
    rtol: float,
    table: Any,
    room: Any,
    memory: Any,
    new: Any,
) -> float:
    """The end of the next panel; -1 where steps in time go on."""
    if y[1] == 0.0:
        memory[1] = WAIT
    if memory[1] > 0.0 or abs(y[0]) > FAR:
        memory[0], memory[1] = max(0.5, 3.0 * memory[2]), memory[1] - 1.0
        return -1.0
    width = memory[0]
    for _ in range(TRIALS):
        if width < max(LEAST, 1.5 * memory[2]):
            break
        memory[3] = copysign(width, y[1])
        end, error = panel(t, y, memory[3], p, setup, rtol, table, room, new)
        factor = min(2.0, max(0.25, (0.3 / error) ** 0.0625)) if error > 0.0 else 2.0
        if error <= 1.0 and end - t <= longest:
            memory[0] = min(width * factor, WIDEST)
            return float(end)
        width *= min(factor, 0.8) if error > 1.0 else 0.9 * longest / (end - t)
    memory[1] = WAIT
    return -1.0


def expand(start: float, width: float, table: Any, room: Any, rate: Any, out: Any) -> None:
    """The Legendre series of the integral of a rate over a panel."""
    for k in range(len(table) + 1):
        room[out, k] = 0.0
        for j in range(NODES):
            room[out, k] += width * table[j, SERIES + k] * room[rate, j]
    room[out, 0] += start


def along(x: float, room: Any, row: Any) -> Any:
    """A series and its derivative at the part x of a panel."""
    at = 2.0 * x - 1.0
    value, slope = room[row, 0] + room[row, 1] * at, room[row, 1]
    before, now, slower, steep = 1.0, at, 0.0, 1.0
    for n in range(1, NODES):
        before, now, slower, steep = (
            now,
            ((2 * n + 1) * at * now - n * before) / (n + 1),
            steep,
            slower + (2 * n + 1) * now,
        )
        value += room[row, n + 1] * now
        slope += room[row, n + 1] * steep
    return value, 2.0 * slope


def part_at(instant: float, x: float, room: Any) -> float:
    """The part of a panel at which the time is given, by Newton's method; x is a guess."""
    for _ in range(8):
        now, slope = along(x, room, int64(OF_TIME))
        step = (instant - now) / slope
        x = min(max(x + step, 0.0), 1.0)
        if not abs(step) > 1e-14:
            break
    return x
