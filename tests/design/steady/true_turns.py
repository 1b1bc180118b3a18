"""Turns of a machine on its motor at 60 digits: Taylor series over the crank angle, by python-flint.

Nothing of desaxe is used. Lagrange's equation of the loop closure, with the guide's force from the rod's
moments about B; pieces end where a table has a knot, at dead centres, and where the guide changes sides.
"""

from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_series, ctx

ORDER, STEP = 24, 0.2
BITS = 200
PARTS = 4  # of a step, at whose ends signs are looked at
SIDE = arb(2) ** -36  # half of a difference


class Table(NamedTuple):
    """A force along Y, piecewise linear over Y, the distance from a dead centre, or theta."""

    over: str  # "Y", "outer", "inner" or "theta"
    places: tuple
    outward: tuple
    inward: tuple

    def at(self, way, here, place):
        """The force on the piece that holds at `here`, a float, as a series of the place."""
        x, y = self.places, self.outward if way > 0 else self.inward
        if not x[0] < here < x[-1]:
            return arb(y[0] if here <= x[0] else y[-1])
        k = next(k for k in range(len(x) - 1) if here < x[k + 1])
        steep = (arb(y[k + 1]) - y[k]) / (arb(x[k + 1]) - x[k])
        return (place - x[k]) * steep + y[k]


class Machine:
    """A design, its load and motor: every number an `arb`."""

    def __init__(self, values, load, motor, branch, way):
        self.p, self.load, self.motor, self.branch, self.way = values, load, motor, branch, way
        ec, AB, BC = (self.p[n] for n in ("ec", "AB", "BC"))
        outer, inner = (ec / (BC + AB)).asin(), (ec / (BC - AB)).asin()
        pi = arb.pi()
        self.outer, self.inner = (-outer, pi - inner) if branch > 0 else (pi + outer, inner)
        self.centre = {
            "outer": ((BC + AB) ** 2 - ec**2).sqrt() * branch,
            "inner": ((BC - AB) ** 2 - ec**2).sqrt() * branch,
        }

    def joints(self, theta):
        """u, the rod's rise and Y at an angle or along a series."""
        u = theta.sin() * self.p["AB"] + self.p["ec"]
        rise = (u * -u + self.p["BC"] ** 2).sqrt() * self.branch
        return u, rise, theta.cos() * self.p["AB"] + rise

    def place(self, Y, theta):
        """The place that the load is a table over."""
        if self.load.over == "Y":
            return Y
        if self.load.over == "theta":
            return theta
        gap = Y - self.centre[self.load.over]
        inside = self.branch if self.load.over == "inner" else -self.branch
        return gap * inside

    def cuts(self):
        """The angles between which the load is one line and the slider goes one way, from 0 to the period."""
        turn = 2 * arb.pi()
        first, second = sorted((self.outer, self.inner), key=float)
        found = [a - turn * (a / turn).floor() for a in (self.outer, self.inner)]
        if self.load is not None:
            for knot in self.load.places:
                if self.load.over == "theta":
                    found.append(arb(knot))
                    continue
                for low, high in ((first, second), (second - turn, first)):
                    angle = self.angle(knot, low, high)
                    found += [] if angle is None else [angle - turn * (angle / turn).floor()]
        if self.way < 0:
            found = [turn - angle for angle in found]
        inner = sorted((a for a in found if 1e-9 < float(a) < float(turn) - 1e-9), key=float)
        return [arb(0), *inner, turn]

    def angle(self, knot, low, high):
        """The angle between dead centres at which the load reaches a knot, None if it does not."""

        def gap(theta):
            return self.place(self.joints(theta)[2], theta) - knot

        low, high = low + arb(2) ** -30, high - arb(2) ** -30
        below = gap(low)
        if float(below) * float(gap(high)) >= 0:
            return None
        for _ in range(40):
            middle = ((low + high) / 2).mid()
            if float(gap(middle)) * float(below) > 0:
                low = middle
            else:
                high = middle
        theta = low
        for _ in range(4):
            series = gap(arb_series([theta, 1]))
            theta = (theta - series[0] / series[1]).mid()
        return theta

    def course(self, theta, x, direction):
        """Inertia, half its slope, the loads' work by dtheta, Y', and the parts of the guide's force."""
        p = self.p
        s, c = theta.sin(), theta.cos()
        u, rise, Y = self.joints(theta)
        u1, u2 = c * p["AB"], s * -p["AB"]
        v1 = -(u * u1) / rise
        v2 = -(u1 * u1 + u * u2 + v1 * v1) / rise
        B1, B2 = (c * p["AB"], s * -p["AB"]), (s * -p["AB"], c * -p["AB"])
        share = p["r_rod"] / p["BC"]
        G1 = B1[0] - u1 * share, B1[1] + v1 * share
        G2 = B2[0] - u2 * share, B2[1] + v2 * share
        Y1, Y2 = B1[1] + v1, B2[1] + v2
        turn1, turn2 = ((v * -u + rise * w) / p["BC"] ** 2 for v, w in ((v1, u1), (v2, u2)))
        m, mr, inertia = p["m_slider"], p["m_rod"], p["I_rod"]
        M = (
            (G1[0] * G1[0] + G1[1] * G1[1]) * mr
            + turn1 * turn1 * inertia
            + Y1 * Y1 * m
            + p["I_crank"]
            + p["J"]
        )
        H = (G1[0] * G2[0] + G1[1] * G2[1]) * mr + turn1 * turn2 * inertia + Y1 * Y2 * m
        force = p["F_Y"] + m * p["g_Y"]
        if self.load is not None:
            there = self.place(self.joints(x)[2], x)
            force = force + self.load.at(direction, float(there), self.place(Y, theta))
        Q = Y1 * force + G1[1] * (mr * p["g_Y"])
        # The rod's moments about B, N dy = u R_Y + K; parts at rest, by omega^2 and by alpha
        arm = u * -share, rise * share
        K = arm[0] * (mr * p["g_Y"])
        K2, K1 = (-(arm[0] * a[1] - arm[1] * a[0]) * mr - t * inertia for a, t in ((G2, turn2), (G1, turn1)))
        return M, H, Q, Y1, (K - u * force, K2 + u * Y2 * m, K1 + u * Y1 * m, u, rise)


class Turn(NamedTuple):
    """The state after a period, its time and work, and the extremes of omega^2."""

    z: arb
    time: arb
    work: arb
    fastest: arb
    slowest: arb


def turn(machine, z):
    """The period that begins with omega^2 = z."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = BITS, ORDER
    try:
        return _Run(machine, z).done()
    finally:
        ctx.prec, ctx.cap = before


class _Run:
    """A period: the state at an angle, the side on which the guide presses, the line of the motor's table."""

    def __init__(self, machine, z):
        self.m, self.z, self.time, self.work = machine, z, arb(0), arb(0)
        self.high = self.low = z
        self.piece = sum(float(z.sqrt()) * machine.way >= knot for knot in machine.motor.knots)

    def done(self):
        cuts = self.m.cuts()
        for start, stop in pairwise(cuts):
            middle = self.m.way * (start + stop) / 2
            Y = self.m.joints(arb_series([middle, 1]))[2]
            self.goes = 1 if float(Y[1]) * self.m.way > 0 else -1
            self.pressed, x = None, start
            while float(stop - x) > 1e-25:
                left = (stop - x).mid()
                x = (x + self.step(x, left if float(left) < 1.5 * STEP else arb(STEP), middle)).mid()
        return Turn(self.z, self.time, self.work, self.high, self.low)

    def step(self, x, h, middle):
        """Go on by h, or to where the guide changes sides or the motor has a knot; returns how far."""
        way, motor = self.m.way, self.m.motor
        course = self.m.course(arb_series([way * x, way]), middle, self.goes)
        rubs = float(self.m.p["mu"]) > 0
        for pressed in (self.pressed,) if self.pressed else (1, -1):
            z, N = self.along(course, pressed)
            if not rubs or float(_value(N, h * arb(2) ** -20)) * pressed > 0:
                break
        omega, self.pressed = z.sqrt() * way, pressed
        events = [(N, None)] if rubs else []
        events += [
            (omega - knot, k) for k, knot in enumerate(motor.knots) if self.piece - 1 <= k <= self.piece
        ]
        torque = motor.torque(omega, self.piece)
        piece = self.piece
        for series, k in events:
            at = _first(series, h)
            if at is not None and float(at) < float(h):
                h, self.pressed = at, -pressed if k is None else pressed
                piece = self.piece if k is None else k + (float(_value(series.derivative(), at)) > 0)
        self.take(z, h)
        self.time += _value((way / omega).integral(), h)
        self.work += _value(torque.integral(), h) * way
        self.z, self.piece = _value(z, h), piece
        return h

    def along(self, course, pressed):
        """omega^2 and the guide's force as series, by Picard's iteration."""
        way, motor = self.m.way, self.m.motor
        M, H, Q, Y1, (n0, n2, n1, u, rise) = course
        drag = self.m.p["mu"] * (self.goes * pressed)
        under = rise - u * drag
        n0, n2, n1 = n0 / under, n2 / under, n1 / under
        inertia = M + Y1 * n1 * drag
        z = arb_series([self.z])
        for known in range(2, ORDER + 1):
            ctx.cap = known
            torque = motor.torque(z.sqrt() * way, self.piece)
            alpha = (Q + torque - H * z - (n0 + n2 * z) * Y1 * drag) / inertia
            z = (alpha * (2 * way)).integral() + self.z
        return z, n0 + n2 * z + n1 * alpha

    def take(self, z, h):
        """The extremes within a step and at its end."""
        found, at = [_value(z, h)], _first(z.derivative(), h)
        if at is not None:
            found.append(_value(z, at))
        self.high, self.low = max(self.high, *found), min(self.low, *found)


def _value(series, h):
    """A series at h."""
    found = arb(0)
    for k in range(ORDER - 1, -1, -1):
        found = found * h + series[k]
    return found.mid()


def _first(series, h):
    """The first place behind the start where a series changes its sign, None where it does not."""
    size = max(abs(float(series[k])) * float(h) ** k for k in range(3)) or 1.0
    low = h * arb(2) ** -14
    below = float(_value(series, low))
    for k in range(1, PARTS + 1):
        high = h * k / PARTS
        above = float(_value(series, high))
        if below * above < 0 and max(abs(below), abs(above)) > 1e-20 * size:
            x = low + (high - low) * (below / (below - above))
            slope = series.derivative()
            for _ in range(9):
                x = (x - _value(series, x) / _value(slope, x)).mid()
            return x
        low, below = high, above
    return None


class Kloss:
    """An induction motor."""

    knots = ()

    def __init__(self, values):
        self.p = values

    def torque(self, omega, piece):
        """The torque on the crank."""
        p = self.p
        slip = 1 - omega * (p["gear"] / p["synchronous_speed"])
        sign = 1 if float(p["synchronous_speed"]) > 0 else -1
        top = 2 * sign * p["gear"] * p["breakdown_torque"] * p["breakdown_slip"]
        return slip * top / (slip * slip + p["breakdown_slip"] ** 2)


class Curve:
    """A table over the speed, linear between."""

    def __init__(self, speeds, torques):
        self.knots, self.torques = speeds, torques

    def torque(self, omega, piece):
        """The torque on the crank."""
        x, y = self.knots, self.torques
        if piece in (0, len(x)):
            return arb_series([arb(y[0 if piece == 0 else -1])])
        steep = (arb(y[piece]) - y[piece - 1]) / (arb(x[piece]) - x[piece - 1])
        return (omega - x[piece - 1]) * steep + y[piece - 1]


KEYS = ("period", "omega_mean", "fluctuation", "power_mean")


def figures(machine, z):
    """omega^2 after the period that begins with omega^2 = z, and its figures."""
    end = turn(machine, z)
    mean = 2 * arb.pi() / end.time
    ripple = (end.fastest.sqrt() - end.slowest.sqrt()) / mean
    return [end.z, end.time, machine.way * mean, ripple, end.work / end.time]


def truth(make, values, start, multiplier, names):
    """The multiplier, the figures and their total derivatives by parameters, near a start."""
    before, ctx.prec = ctx.prec, BITS
    try:
        values = {name: arb(value) for name, value in values.items()}
        machine, z = make(values), arb(start) ** 2
        z = (z - (turn(machine, z).z - z) / (multiplier - 1)).mid()
        here = figures(machine, z)
        by_z = _difference(lambda side: figures(machine, z + side))
        by = {}
        for name in names:

            def moved(side, name=name):
                return figures(make({**values, name: values[name] + side}), z)

            own = _difference(moved)
            rise = own[0] / (1 - by_z[0])
            by[name] = dict(
                zip(KEYS, (float(a + b * rise) for a, b in zip(own[1:], by_z[1:], strict=True)), strict=True)
            )
        return float(by_z[0]), dict(zip(KEYS, map(float, here[1:]), strict=True)), by
    finally:
        ctx.prec = before


def _difference(values):
    """Central differences of a list."""
    return [(a - b) / (2 * SIDE) for a, b in zip(values(SIDE), values(-SIDE), strict=True)]
