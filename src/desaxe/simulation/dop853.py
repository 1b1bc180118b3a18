"""DOP853 for one design after the other, in plain loops, whose text numba compiles (`compiled`).

It stands in a module with the functions `still`, `moving`, `potential` and `torque` that are written from
the Program for the designs at hand. The method is that of Hairer, Norsett and Wanner, "Solving
Ordinary Differential Equations I", section II, with the step control, the error norm and the dense output
of `stepper`: one design takes the steps that `simulate` takes for it alone. A constant that is passed on is
an int64, for numba compiles a function anew for each literal.

setup   a row per design: branch, limit angles, half of the arc (see `chart`), torque, F_Y, theta0,
        omega_start, an energy that the loads suggest
tables  A, B, C, E3, E5, D and the rows of A and C for the dense output; that of the panels

A crank that turns fully goes by panels of the crank angle (`picard`) where its speed lets it.
"""

from __future__ import annotations

from math import asin, copysign, cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, nextafter, zeros

from .picard import (
    INERTIA,
    OF_ENERGY,
    OF_TIME,
    RATE,
    ROWS,
    SLOWNESS,
    along,
    by_panel,
    expand,
    furnish,
    panel,
    part_at,
)  # fmt: skip

if TYPE_CHECKING:
    from typing import Any

    def still(theta: float, branch: float, p: Any) -> tuple[float, float, float]:
        """M_eff [kg m^2], the torque of gravity [N m] and Y' [m]."""

    def moving(theta: float, branch: float, p: Any) -> tuple[float, float, float, float]:
        """M_eff, its derivative by theta, the torque of gravity and Y'."""

    def potential(theta: float, branch: float, p: Any) -> float:
        """The potential energy [J]."""

    def torque(t: float, theta: float, omega: float, number: float) -> float:
        """The torque [N m]."""


def place(q: float, setup: Any) -> Any:
    """theta, dtheta/dq and the branch at the coordinate q."""
    if setup[3] > 0.0:
        slope = setup[3] * cos(q)
        return 0.5 * (setup[1] + setup[2]) + setup[3] * sin(q), slope, copysign(1.0, slope)
    return min(max(q, setup[1] + 1e-13), setup[2] - 1e-13), 1.0, 1.0


def rates(t: float, y: Any, p: Any, setup: Any, out: Any) -> None:
    """The rates of q, v and W: the law without friction."""
    theta, slope, side = place(y[0], setup)
    inertia, weight, travel = still(theta, side * setup[0], p)
    if not (0.0 < inertia < inf) or slope == 0.0:
        out[:] = nan
        return
    root = sqrt(inertia)
    omega = side * y[1] / root
    push = torque(t, theta, omega, setup[4]) + setup[5] * travel
    out[0] = y[1] / (root * abs(slope))
    out[1] = side * (push - weight) / root
    out[2] = push * omega


def square(x: float) -> float:
    """x^2: numba compiles a loop for a power."""
    return x * x


def combined(K: Any, weights: Any, count: Any, column: int) -> float:
    """The sum of the first stages by their weights."""
    total = 0.0
    for j in range(count):
        total += K[j, column] * weights[j]
    return total


def advance(y: Any, h: float, K: Any, weights: Any, count: Any, out: Any) -> None:
    """y + h times the sum of the first stages by their weights, half of which are 0."""
    q, v, w = 0.0, 0.0, 0.0
    for j in range(count):
        weight = weights[j]
        if weight != 0.0:
            q += K[j, 0] * weight
            v += K[j, 1] * weight
            w += K[j, 2] * weight
    out[0], out[1], out[2] = y[0] + h * q, y[1] + h * v, y[2] + h * w


def trial(t: float, y: Any, h: float, p: Any, setup: Any, tables: Any, K: Any, new: Any) -> None:
    """A step of order 8: its stages and its end. K[0] has the rates at its start."""
    A, B, C = tables[0], tables[1], tables[2]
    for s in range(1, 12):
        advance(y, h, K, A[s], s, new)
        rates(t + C[s] * h, new, p, setup, K[s])
    advance(y, h, K, B, int64(12), new)
    rates(t + h, new, p, setup, K[12])


def error_of(h: float, y: Any, new: Any, rtol: Any, atol: Any, size: Any, tables: Any, K: Any) -> float:
    """The error of a step relative to the tolerance: see `Dop853._error`."""
    fifth, third, cubic, tightest = 0.0, 0.0, 0.0, inf
    for i in range(3):
        largest = max(abs(y[i]), abs(new[i]))
        scale = atol[i] + largest * rtol[i]
        whole = size[i] + (largest if i > 0 else 0.0)
        rate = combined(K, tables[3], int64(13), i)
        fifth += square(combined(K, tables[4], int64(13), i) / scale)
        third += square(rate / scale)
        cubic += square(h * rate / whole)
        tightest = min(tightest, scale / whole)
    if fifth == 0.0 and third == 0.0:
        return 0.0
    error: float = abs(h) * fifth / sqrt((fifth + 0.01 * third) * 3.0)
    return max(error, 0.1 * cubic / tightest)


def share_of(angle: float) -> float:
    """By how much the error of a step counts more in a long motion: see `Dop853._error`."""
    return min(4.0, max(1.0, angle / 100.0))


def first_step(t_end: float, y: Any, p: Any, setup: Any, rtol: Any, atol: Any, K: Any, new: Any) -> float:
    """A first step from the sizes of state, rates and their change. K[0] has the rates."""
    d0, d1, d2 = 0.0, 0.0, 0.0
    for i in range(3):
        scale = atol[i] + abs(y[i]) * rtol[i]
        d0 += square(y[i] / scale) / 3.0
        d1 += square(K[0, i] / scale) / 3.0
    d0, d1 = sqrt(d0), sqrt(d1)
    h = min(1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1, t_end)
    for i in range(3):
        new[i] = y[i] + h * K[0, i]
    rates(h, new, p, setup, K[1])
    for i in range(3):
        scale = atol[i] + abs(y[i]) * rtol[i]
        d2 += square((K[1, i] - K[0, i]) / scale) / 3.0
    d2 = sqrt(d2) / h
    then = max(1e-6, h * 1e-3) if d1 <= 1e-15 and d2 <= 1e-15 else (0.01 / max(d1, d2)) ** 0.125
    return min(100.0 * h, then, t_end)


def dense(t: float, y: Any, h: float, new: Any, p: Any, setup: Any, tables: Any, K: Any, F: Any) -> None:
    """The polynomial of a step: its coefficients, from three more stages."""
    D, A, C = tables[5], tables[6], tables[7]
    state = empty(3)
    for s in range(3):
        advance(y, h, K, A[s], 13 + s, state)
        rates(t + C[s] * h, state, p, setup, K[13 + s])
    for i in range(3):
        change = new[i] - y[i]
        F[0, i] = change
        F[1, i] = h * K[0, i] - change
        F[2, i] = 2.0 * change - h * (K[12, i] + K[0, i])
        for row in range(4):
            F[3 + row, i] = h * combined(K, D[row], int64(16), i)


def inside(x: float, y: Any, F: Any, i: Any) -> float:
    """A coordinate at the part x of a step."""
    total = 0.0
    for k in range(7):
        total = (total + F[6 - k, i]) * (x if k % 2 == 0 else 1.0 - x)
    return float(total + y[i])


def crossing(y: Any, F: Any, bound: float) -> float:
    """The part of a step at which q passes a bound, by halving."""
    low, high = 0.0, 1.0
    before = y[0] < bound
    for _ in range(60):
        x = 0.5 * (low + high)
        if (inside(x, y, F, int64(0)) < bound) == before:
            low = x
        else:
            high = x
    return 0.5 * (low + high)


def over_limit(before: float, after: float, first: float, last: float) -> float:
    """By what to change a step that ends near a limit angle, where S has lost its digits; 0 if it may stay.

    The step over a limit is a short one from a little before it, for the dense output is less exact.
    """
    way = after - before
    left = last - before if way > 0.0 else before - first
    if way == 0.0 or (left > 0.5 and abs(way) < 0.5):
        return 0.0  # it comes from the limit
    if abs(way) >= left and abs(way) < 1.2e-2:
        return 0.0
    wanted = left - 5e-3 if left > 8e-3 else left + 3e-3
    return min(wanted / abs(way), 3.0)


def tell(
    t: float, q: float, v: float, p: Any, setup: Any, theta: Any, omega: Any, alpha: Any, row: Any
) -> None:
    """Angle, speed and acceleration of a state, into the histories."""
    angle, _, side = place(q, setup)
    inertia, slope, weight, travel = moving(angle, side * setup[0], p)
    speed = side * v / sqrt(inertia)
    push = torque(t, angle, speed, setup[4]) + setup[5] * travel - weight
    theta[row], omega[row] = angle, speed
    alpha[row] = (push - 0.5 * slope * speed * speed) / inertia


def energy_of(y: Any, p: Any, setup: Any) -> float:
    """Kinetic and potential energy."""
    theta, _, side = place(y[0], setup)
    return float(0.5 * y[1] * y[1]) + potential(theta, side * setup[0], p)


def start(p: Any, setup: Any, rtol: float, t_end: float, y: Any, atol: Any, size: Any) -> bool:
    """The state at the start, the tolerances and sizes; whether there is an inertia to move."""
    inertia, weight, _ = still(setup[6], setup[0], p)
    if not (0.0 < inertia < inf):
        return False
    if setup[3] > 0.0:
        lower = setup[6] < 0.5 * (setup[1] + setup[2])
        gap = setup[6] - setup[1] if lower else setup[2] - setup[6]
        quarter = pi / 2 - 2.0 * asin(sqrt(gap / (2.0 * setup[3])))
        y[0] = -quarter if lower else quarter
    else:
        y[0] = setup[6]
    y[1] = setup[7] * sqrt(inertia)
    y[2] = 0.0
    energy = max(0.5 * y[1] * y[1], abs(potential(setup[6], setup[0], p)), abs(weight), setup[8])
    for k in range(9):
        here = abs(torque(t_end * k / 8, setup[6], setup[7], setup[4]))
        if here < inf:
            energy = max(energy, here)
    if energy == 0.0:
        energy = inertia / square(t_end)
    size[0], size[1], size[2] = 1.0, sqrt(energy), energy
    atol[0], atol[1], atol[2] = 0.03 * rtol, 0.01 * rtol * size[1], 0.01 * rtol * size[2]
    return True


def account(y: Any, new: Any, p: Any, setup: Any, sums: Any) -> None:
    """Take a step into account, and make it.

    sums: first energy, work done either way, largest kinetic energy, residual now and before, largest energy.
    """
    energy = energy_of(new, p, setup)
    off = abs(energy - new[2] - sums[0])
    sums[1] += abs(new[2] - y[2])
    sums[2] = max(sums[2], 0.5 * new[1] * new[1])
    sums[4] = sums[3]
    sums[3] = max(sums[3], off) if off == off else sums[3]
    sums[5] = max(sums[5], abs(energy))
    for i in range(3):
        y[i] = new[i]


def land(
    t: float,
    end: float,
    t_end: float,
    y: Any,
    p: Any,
    setup: Any,
    rtol: float,
    panels: Any,
    room: Any,
    memory: Any,
    K: Any,
    new: Any,
) -> float:
    """Make the series of a panel, shortened where it goes beyond the end of the motion; its end."""
    width = memory[3]
    expand(t, abs(width), panels, room, int64(SLOWNESS), int64(OF_TIME))
    if end > t_end:
        memory[3] = width * part_at(t_end, (t_end - t) / (end - t), room)
        end, _ = panel(t, y, memory[3], p, setup, rtol, panels, room, new)
        rates(end, new, p, setup, K[1])
        for i in range(3):
            new[i] += (t_end - end) * K[1, i]
        expand(t, abs(memory[3]), panels, room, int64(SLOWNESS), int64(OF_TIME))
        end = t_end
    expand(0.5 * y[1] * y[1], memory[3], panels, room, int64(RATE), int64(OF_ENERGY))
    return end


def tell_inside(
    t: float,
    end: float,
    instant: float,
    y: Any,
    p: Any,
    setup: Any,
    room: Any,
    memory: Any,
    theta: Any,
    omega: Any,
    alpha: Any,
    row: Any,
) -> None:
    """Angle, speed and acceleration at an instant inside of a panel, into the histories."""
    x = part_at(instant, (instant - t) / (end - t), room)
    energy, _ = along(x, room, int64(OF_ENERGY))
    speed = copysign(sqrt(2.0 * energy), memory[3])
    tell(instant, y[0] + memory[3] * x, speed, p, setup, theta, omega, alpha, row)


def follow(
    p: Any,
    setup: Any,
    times: Any,
    how: Any,
    tables: Any,
    theta: Any,
    omega: Any,
    alpha: Any,
    K: Any,
    F: Any,
) -> Any:
    """The motion of one design; status, end, energy residual, work, residual by rounding, number of panels.

    how: relative tolerance, t_end, longest step, most steps, whether panels may be taken.
    """
    rtol, t_end, longest = how[0], how[1], how[2]
    y, new, atol, relative, size = empty(3), empty(3), empty(3), empty(3), empty(3)
    relative[0], relative[1], relative[2] = 1e-16, rtol, rtol
    theta[:], omega[:], alpha[:] = nan, nan, nan
    if not start(p, setup, rtol, t_end, y, atol, size):
        return 6, nan, nan, nan, nan, 0
    first, last = (-pi / 2, pi / 2) if setup[3] > 0.0 else (setup[1], setup[2])
    t, row, count = 0.0, int64(0), len(times)
    while row < count and times[row] <= 0.0:
        tell(0.0, y[0], y[1], p, setup, theta, omega, alpha, row)
        row += 1
    rates(0.0, y, p, setup, K[0])
    h = first_step(t_end, y, p, setup, relative, atol, K, new)
    sums, memory, room = zeros(6), zeros(4), empty((ROWS, 17))
    sums[0], sums[2], memory[0] = energy_of(y, p, setup), 0.5 * y[1] * y[1], 0.5
    sums[5] = abs(sums[0])
    turns, stale, panels, made = how[4] > 0.0 and setup[1] == -inf, False, tables[8], 0
    furnish(panels, room)
    status, rejected, steps, tries, wished = -1, False, 0, 0, inf
    least, most = inf, still(setup[6], setup[0], p)[0]
    while status < 0:
        smallest = 10.0 * (nextafter(t, inf) - t)
        h = min(h, longest)
        if not rejected:
            h = max(h, smallest)
        end = by_panel(t, y, longest, p, setup, rtol, panels, room, memory, new) if turns else -1.0
        if end > t and steps < how[3]:
            if end > t_end or (row < count and times[row] <= end):
                end = land(t, end, t_end, y, p, setup, rtol, panels, room, memory, K, new)
            while row < count and times[row] <= end:
                tell_inside(t, end, times[row], y, p, setup, room, memory, theta, omega, alpha, row)
                row += 1
            for i in range(16):
                least = min(least, room[INERTIA, i])
            account(y, new, p, setup, sums)
            h, wished, t, stale = 0.1 * (end - t), inf, end, True
            status, steps, made = 0 if end >= t_end else -1, steps + 1, made + 1
            continue
        if stale:
            rates(t, y, p, setup, K[0])
            stale = False
        if not h >= smallest or steps >= how[3]:
            near = (
                min(last - y[0], y[0] - first) < 1e-3
            )  # a load on a massless slider grows without bound there
            status = 2 if near else 5 if least < 1e-8 * most else 4
            break
        t_new = min(t + h, t_end)
        h = t_new - t
        trial(t, y, h, p, setup, tables, K, new)
        error = error_of(h, y, new, relative, atol, size, tables, K) * share_of(
            abs(new[0] - y[0]) / h * t_end
        )
        beyond = new[0] >= last or new[0] <= first
        smooth = setup[3] > 0.0
        # At a limit angle the error is that of S, which has lost its digits: a short step over it may pass.
        if not error < 1.0 and not (smooth and beyond and abs(new[0] - y[0]) < 1.2e-2):
            h *= max(0.2, 0.9 * error**-0.125) if error > 0.0 else 0.2  # NaN: a trial beyond a limit
            rejected = True
            continue
        if smooth and tries < 20 and min(last - new[0], new[0] - first) < 2e-3:
            longer = over_limit(y[0], new[0], first, last)
            if longer > 0.0:
                h *= longer
                rejected, tries = True, tries + 1
                continue
        tries = 0
        steps += 1
        stop, end = 1.0, t_new
        if beyond or (row < count and times[row] <= t_new):
            dense(t, y, h, new, p, setup, tables, K, F)
        if beyond:
            stop = crossing(y, F, last if new[0] >= last else first)
            status, end = 2, t + stop * h
            for i in range(3):
                new[i] = inside(stop, y, F, i)
        while row < count and times[row] <= end:
            x = (times[row] - t) / h
            q, v = inside(x, y, F, int64(0)), inside(x, y, F, int64(1))
            tell(times[row], q, v, p, setup, theta, omega, alpha, row)
            row += 1
        memory[2] = abs(new[0] - y[0])
        account(y, new, p, setup, sums)
        sums[3] = sums[4] if status == 2 else sums[3]  # at a limit angle Y has half its digits
        growth = min(10.0, 0.9 * error**-0.125) if error > 0.0 else 10.0
        wish = h * (min(1.0, growth) if rejected else growth)
        h, wished = min(wish, wished), wish
        rejected = False
        t = end
        for i in range(3):
            K[0, i] = K[12, i]
        least = min(least, still(place(y[0], setup)[0], setup[0], p)[0])
        if status < 0 and t >= t_end:
            status = 0
    scale = max(sums[1], sums[2])
    if not scale > 0.0:
        return status, t, 0.0, y[2], inf, made
    rounded = 2e-17 * steps * (1.0 + sums[5] / scale)  # `residual.ROUNDED`
    return status, t, sums[3] / scale, y[2], rounded, made


def designs(
    p: Any,
    setup: Any,
    times: Any,
    how: Any,
    A: Any,
    B: Any,
    C: Any,
    E3: Any,
    E5: Any,
    D: Any,
    A_more: Any,
    C_more: Any,
    panels: Any,
    theta: Any,
    omega: Any,
    alpha: Any,
    status: Any,
    numbers: Any,
) -> None:
    """Every design: histories, status, and end, energy residual, work, rounding and panels as numbers."""
    K, F = empty((16, 3)), empty((7, 3))
    tables = (A, B, C, E3, E5, D, A_more, C_more, panels)
    for n in range(len(setup)):
        if status[n] < 0:
            told = follow(p[n], setup[n], times, how, tables, theta[n], omega[n], alpha[n], K, F)
            status[n] = told[0]
            numbers[n, 0], numbers[n, 1], numbers[n, 2], numbers[n, 3] = told[1], told[2], told[3], told[4]
            numbers[n, 4] = told[5]
