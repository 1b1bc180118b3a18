"""The nodes of a panel of the crank angle, in plain loops, which are compiled (see `over_angle`).

The kinetic energy E and the time obey

    dE/dtheta = torque(t, theta, omega) + loads - gravity's,    dt/dtheta = 1/omega = sqrt(M_eff / (2 E)),

and M_eff, loads and gravity are known at the nodes of a panel before E is. Only the torque asks for t and
omega there. Picard's iteration finds them: a sweep asks for the torque at all nodes and integrates twice, by
products with a constant matrix. Loops over the nodes run in the lanes of a vector, each design by itself;
such short loops are vectors where LLVM does not unroll them before.

table    a row for each node
room     a row for each value at the nodes, in the order below; the last two are coefficients of series
"""

from __future__ import annotations

from functools import cache
from math import copysign, inf, nan, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy import empty, int64
from numpy.polynomial import legendre

from ...compiler.helpers import mul_add
from ...compiler.llvm.loops import apart, call
from .state import (
    FORCE,
    FUNCTION,
    GRAVITY,
    INERTIA,
    OUTPUTS,
    POSITION,
    SIDEWAYS,
    TRAVEL,
    piece,
    quantities,
    reduced,
    torque,
)
from .state import TORQUE as TORQUE_OF

if TYPE_CHECKING:
    from typing import Any

NODES = int64(16)
MOBILITY, LOAD, WEIGHT, TORQUE, ENERGY, SLOWNESS, RATE, MISS, GAIN, PART = range(10)  # mobility: 1/M_eff
TIME, ANGLE, SPEED, NOW = 10, 11, 12, 13  # as the torque takes them
HEIGHT, OF_TIME, OF_ENERGY, ROWS = 14, 15, 16, 17
SERIES, PLACE, SHARE, LAST = 16, 33, 34, 35  # columns of the table, behind the integrals
SWEEPS = int64(24)
PUSHED = TORQUE_OF + 1  # of a law: the address of its torque
LINE, WIDTH = 8, 40  # numbers of a line of the cache, and of a row of the table


@cache
def nodes_table() -> Any:
    """A row for each Gauss node.

    The integrals of its Lagrange polynomial from 0 to every node, their series, its place in [0, 1], its
    weight, its weights in the last two terms of a Legendre series (over twice the degree and one). Rows start
    where lines of the processor's cache do.
    """
    x, weights = legendre.leggauss(int(NODES))
    terms = 0.5 * weights[:, None] * legendre.legvander(x, len(x) - 1)
    series = np.array([0.5 * legendre.legint(row, lbnd=-1) for row in terms * (2 * np.arange(len(x)) + 1)])
    others = 0.5 * (x[:, None] + 1.0), 0.5 * weights[:, None], terms[:, -2:]
    rows = np.hstack([legendre.legval(x, series.T), series, *others])
    room = np.zeros(rows.shape[0] * WIDTH + LINE)
    start = -(room.ctypes.data // room.itemsize) % LINE
    table = room[start : start + rows.shape[0] * WIDTH].reshape(-1, WIDTH)
    table[:, : rows.shape[1]] = rows
    return table


def still_at_nodes(theta: float, width: float, law: Any, data: Any, table: Any, room: Any) -> None:
    """Inertia, loads and gravity, which depend on the angle alone."""
    result: Any = empty((OUTPUTS + 1, 16))
    for i in range(NODES):
        room[ANGLE, i] = theta + width * table[i, PLACE]
        result[OUTPUTS, i] = reduced(room[ANGLE, i])
    quantities(result[OUTPUTS], law, data, result)
    for i in range(NODES):
        room[MOBILITY, i], room[HEIGHT, i] = 1.0 / result[INERTIA, i], result[POSITION, i]
        load = piece(law[FORCE:SIDEWAYS], room[ANGLE, i], 0.0, room[HEIGHT, i])[0]
        room[LOAD, i], room[WEIGHT, i] = load * result[TRAVEL, i], result[GRAVITY, i]


def integrate(start: float, width: float, table: Any, room: Any, rate: Any, out: Any) -> None:
    """The integral of a rate from the start of the panel, at every node."""
    apart()
    a, b, c, d = room[rate, 0], room[rate, 1], room[rate, 2], room[rate, 3]
    e, f, g, h = room[rate, 4], room[rate, 5], room[rate, 6], room[rate, 7]
    i, j, k, m = room[rate, 8], room[rate, 9], room[rate, 10], room[rate, 11]
    n, o, q, r = room[rate, 12], room[rate, 13], room[rate, 14], room[rate, 15]
    for at in range(NODES):
        one = mul_add(c, table[2, at], mul_add(b, table[1, at], a * table[0, at]))
        two = mul_add(f, table[5, at], mul_add(e, table[4, at], d * table[3, at]))
        three = mul_add(i, table[8, at], mul_add(h, table[7, at], g * table[6, at]))
        four = mul_add(m, table[11, at], mul_add(k, table[10, at], j * table[9, at]))
        five = mul_add(q, table[14, at], mul_add(o, table[13, at], n * table[12, at]))
        whole = (one + two) + (three + four) + mul_add(r, table[15, at], five)
        room[out, at] = mul_add(width, whole, start)


def guess(t: float, energy: float, first: float, width: float, table: Any, room: Any) -> None:
    """Speeds and instants at the nodes if what moves the crank stays as it is at first."""
    apart()
    push = width * (first + room[LOAD, 0] - room[WEIGHT, 0])
    way, least = copysign(1.0, width), 0.3 * energy
    begin = sqrt(2.0 * energy * room[MOBILITY, 0])
    for i in range(NODES):
        part = table[i, PLACE]
        speed = sqrt(2.0 * room[MOBILITY, i] * max(mul_add(push, part, energy), least))
        room[SPEED, i] = way * speed
        room[TIME, i] = t + 2.0 * abs(width) * part / (begin + speed)


def powers(room: Any) -> None:
    """The rate of E at the nodes."""
    apart()
    for i in range(NODES):
        room[RATE, i] = room[TORQUE, i] + room[LOAD, i] - room[WEIGHT, i]


def slowness(way: float, room: Any) -> None:
    """dt/dtheta at the nodes, but for its sign, and the speed."""
    apart()
    for i in range(NODES):
        speed = sqrt(2.0 * room[MOBILITY, i] * room[ENERGY, i])
        room[SLOWNESS, i] = 1.0 / speed
        room[SPEED, i] = way * speed


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


def ask(law: Any, room: Any) -> float:
    """The torque at all nodes; by how much it has changed at most, NaN where it is none."""
    if law[TORQUE_OF] == FUNCTION:
        if call(int64(law[PUSHED]), room[TIME], room.shape[1], NODES) != 0:
            return nan
    else:
        for i in range(NODES):
            angle, speed = room[ANGLE, i], room[SPEED, i]
            room[NOW, i] = piece(law[TORQUE_OF:FORCE], angle, speed, room[HEIGHT, i])[0]
    most, none = 0.0, 0.0
    for i in range(NODES):
        room[MISS, i] = room[NOW, i] - room[TORQUE, i]
        room[TORQUE, i] = room[NOW, i]
        most = max(most, abs(room[MISS, i]))
        none += 0.0 * room[MISS, i]
    return most + none


def bend_of(law: Any, room: Any) -> float:
    """The derivative of the torque by the speed in the middle of a panel, for the corrections alone."""
    t, angle, omega = room[TIME, 8], room[ANGLE, 8], room[SPEED, 8]
    step, Y = 1e-4 * omega, room[HEIGHT, 8]
    return float((torque(t, angle, omega + step, Y, law) - torque(t, angle, omega, Y, law)) / step)


def correct(bend: float, width: float, table: Any, room: Any) -> None:
    """Foresee what the torque's change makes of the speed, and that again of the torque: Newton's method."""
    integrate(0.0, width, table, room, int64(MISS), int64(GAIN))
    respond(bend, room)
    integrate(0.0, width, table, room, int64(PART), int64(GAIN))
    respond(bend, room)
    for i in range(NODES):
        room[TORQUE, i] += room[PART, i] - room[MISS, i]


def respond(bend: float, room: Any) -> None:
    """The torque's change by a gain of energy, besides that which is known."""
    apart()
    for i in range(NODES):
        by_energy = bend * room[SLOWNESS, i] * room[MOBILITY, i]  # domega/dE = 1/(M_eff omega)
        room[PART, i] = room[MISS, i] + by_energy * room[GAIN, i]


def sweep(
    t: float, energy: float, least: float, width: float, law: Any, rtol: float, table: Any, room: Any
) -> float:
    """Sweeps until the torque stays as it is: the least energy at the nodes; 0 where that fails."""
    before = inf
    bend = copysign(1.0, width) * bend_of(law, room)
    for _ in range(SWEEPS):
        if not least > 0.0:
            return 0.0
        change = ask(law, room) * abs(width) / least
        if not change < 0.7 * before:
            return least if change < max(1e-15, 0.01 * rtol) else 0.0
        if change > 0.0:
            correct(bend, width, table, room)
            least = course(t, energy, width, table, room)
        next_one = change * (change / before if before < inf else 1.0)
        if next_one < 0.01 * rtol:
            return least if least > 0.0 else 0.0
        before = change
    return 0.0
