"""A slider of mass under a force of pieces: torque, integrals and extremes from the raw loop closure alone.

The loop is solved where crank, rod and slider axis meet; Newton's law of the slider and virtual work give
the torque, T = (m a_C - F) dY/dtheta. A force is polynomials in its place, between ends at which the crank
angle is solved for: on each arc one polynomial holds. Numbers are mpmath's where digits count, else NumPy's.
"""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp, mpf
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

import desaxe as dx

PLACES, SHAPES = ("over_theta", "over_Y", "over_stroke", "function"), ("smooth", "kinked", "jumping")
# Loads over columns of the motion: how each is made, and the force by Y, V_C and the crank angle.
FOLLOWING = {
    "spring": lambda p: (dx.spring(p[0], free=p[1]), lambda Y, V, t: -p[0] * (Y - p[1])),
    "damper": lambda p: (
        dx.damper(linear=p[2], quadratic=p[3]), lambda Y, V, t: -(p[2] + p[3] * abs(V)) * V
    ),
    "over_V": lambda p: (dx.over_V([-p[4], 0, p[4]], [p[5], 0, -p[6]]), lambda Y, V, t: _bent(V, *p[4:])),
    "function of Y, V_C": lambda p: (
        dx.over_Y(lambda Y: -p[0] * Y**3, lambda Y: -3 * p[0] * Y**2)
        + dx.over_V(lambda V: -p[3] * V**3, derivative=lambda V: -3 * p[3] * V**2),
        lambda Y, V, t: -p[0] * Y**3 - p[3] * V**3,
    ),
    "sum": lambda p: (
        2 * dx.spring(p[0], free=p[1]) - dx.over_theta(*_wave(p[5]), kind="linear") + dx.damper(p[2]) + 7,
        lambda Y, V, t: -2 * p[0] * (Y - p[1]) - _saw(t, p[5]) - p[2] * V + 7,
    ),
}  # fmt: skip
LENGTHS, TURN, DIGITS = ("ec", "AB", "BC"), 2.0 * np.pi, 60
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


class Pieces(NamedTuple):
    """Polynomials over a place: piece k, lowest power first, in the distance from knots[max(k - 1, 0)]."""

    knots: list
    rows: list

    def at(self, x: Any, piece: int) -> Any:
        """The value of a piece."""
        s = x - self.knots[max(piece - 1, 0)]
        return sum(c * s**k for k, c in enumerate(self.rows[piece]))

    def piece(self, x: Any, up: bool = True) -> int:
        """The number of the piece at a place: on a knot the one ahead."""
        return sum(bool(knot <= x if up else knot < x) for knot in self.knots)


class Force(NamedTuple):
    """A load: its place, its pieces each way of the slider, and how it is given to a call."""

    place: str
    outward: Pieces
    inward: Pieces
    load: Any
    dead_centre: str = ""


def constant(value: float) -> Force:
    """A force that is a number."""
    pieces = Pieces([0.0], [[value], [value]])
    return Force("number", pieces, pieces, value)


def held(x: Any, y: Any, shape: str) -> Pieces:
    """The pieces between points, whose values at the ends hold beyond; a place given twice is a jump."""
    if shape == "smooth":
        rows = [list(column[::-1]) for column in CubicSpline(x, y).c.T]
    elif shape == "step":
        rows = [[value] for value in y[:-1]]
    else:
        spans = zip(pairwise(x), pairwise(y), strict=True)
        rows = [[p, (q - p) / (b - a) if b > a else 0.0] for (a, b), (p, q) in spans]
    return Pieces(list(x), [[y[0]], *rows, [y[-1]]])


def around(x: Any, y: Any, shape: str) -> Pieces:
    """The pieces of a table over theta, which repeats after a turn."""
    ends, values = [*x, x[0] + TURN], [*y, y[0]]
    if shape == "smooth":
        rows = [list(column[::-1]) for column in CubicSpline(ends, values, bc_type="periodic").c.T]
        return Pieces(list(x), [rows[-1], *rows])
    result = held(ends, values, "step" if shape == "jumping" else shape)
    return Pieces(list(x), result.rows[:-1])


def force_of(place: str, shape: str, design: dict, branch: int, draw: Any) -> Force:
    """A random force of a kind for a design."""
    if place in FOLLOWING:
        numbers = [draw.uniform(*ends) for ends in ((1e3, 4e3), (0, 0.2), (5, 90), (2, 9), (0.2, 0.6))]
        load, by = FOLLOWING[place]([*numbers, draw.uniform(50, 300), draw.uniform(50, 300)])
        return Force(place, by, by, load)
    values = [draw.uniform(-900.0, 300.0) for _ in range(5)]
    if place == "number":
        return constant(values[0])
    if place in ("over_theta", "function"):
        angles = sorted(0.1 + 1.2 * k + draw.uniform(0.0, 0.6) for k in range(5))
        pieces = around(angles, values, shape)
        kinds = {"smooth": "cubic", "kinked": "linear", "jumping": "step"}
        table = dx.over_theta(angles, values, kind=kinds[shape])
        return Force("theta", pieces, pieces, table if place == "over_theta" else _function(table, angles))
    low, high = sorted(float(dead_centre(design, branch, which)) for which in ("outer", "inner"))
    which = draw.choice(["outer", "inner"]) if place == "over_stroke" else ""
    first, wide = (0.0, high - low) if which else (low, high - low)
    reach = (0.0 if which else -0.1, 1.1) if shape == "smooth" else (0.05, 0.95)
    shares = sorted(draw.uniform(*reach) for _ in range(3))
    x = [first + wide * share for share in (reach[0], *shares, reach[1])]
    inward, kind = None, "cubic" if shape == "smooth" else "linear"
    if shape == "jumping":
        x[2] = x[1]
        inward = [draw.uniform(-300.0, 900.0) for _ in x] if draw.random() < 0.7 else None
        kind = "step" if draw.random() < 0.3 else kind
        x[2] += (kind == "step") * 0.1 * wide
        x.sort()
    make, more = (dx.over_stroke, {"dead_centre": which}) if which else (dx.over_Y, {})
    load = make(x, values, inward, kind=kind, **more)
    pieces = [held(x, y, "step" if kind == "step" else shape) for y in (values, inward or values)]
    return Force("stroke" if which else "Y", *pieces, load, which)


def _function(table: Any, nodes: list) -> Any:
    """A Python function of theta that is the table."""
    return dx.over_theta(lambda t: table.both(t)[0], lambda t: table.both(t)[1], nodes=nodes)


def _bent(V: Any, most: Any, inward: Any, outward: Any) -> Any:
    """A line for each way of the slider, held beyond its end."""
    share = V / most
    share = np.clip(share, -1.0, 1.0) if isinstance(V, np.ndarray) else max(min(share, 1), -1)
    return -share * (outward * (share > 0) + inward * (share < 0))


def _wave(size: float) -> tuple[list[float], list[float]]:
    """Points of a saw tooth over a turn."""
    return [0.0, 2.0, 5.0], [0.0, size, -size]


def _saw(theta: Any, size: Any) -> Any:
    """The saw tooth between its points."""
    (_, b, c), _ = _wave(size)
    t = theta - TURN * _lib(theta).floor(theta / TURN)
    lines = size * t / b, size - 2 * size * (t - b) / (c - b), -size + size * (t - c) / (TURN - c)
    if isinstance(t, np.ndarray):
        return np.where(t < b, lines[0], np.where(t < c, lines[1], lines[2]))
    return lines[0] if t < b else lines[1] if t < c else lines[2]


# ---- the mechanism -------------------------------------------------------------------------------------


def _lib(*values: Any) -> Any:
    return mp if any(isinstance(value, mpf) for value in values) else np


def dead_centre(design: dict, branch: int, which: str) -> Any:
    """The slider's position with crank and rod in line."""
    along = design["BC"] + design["AB"] * (1 if which == "outer" else -1)
    return branch * _lib(along, design["ec"]).sqrt(along**2 - design["ec"] ** 2)


def slider(theta: Any, design: dict, branch: int) -> tuple:
    """Y of the raw triangle, and its first two derivatives by theta."""
    ec, AB, BC = (design[n] for n in LENGTHS)
    lib = _lib(theta, ec, AB, BC)
    sine, cosine = AB * lib.sin(theta), AB * lib.cos(theta)
    across = ec + sine
    height = branch * lib.sqrt(BC**2 - across**2)
    slope = -sine - across * cosine / height
    bend = -cosine - (cosine**2 - across * sine) / height - (across * cosine) ** 2 / height**3
    return cosine + height, slope, bend


class Truth(NamedTuple):
    """A design, with m_slider and omega0 besides its lengths, under a force."""

    design: dict
    branch: int
    force: Force

    def turns(self, theta: Any) -> Any:
        """The whole turns since the first knot of a table over theta; else 0."""
        if self.force.place != "theta":
            return 0
        return _lib(theta).floor((theta - self.force.outward.knots[0]) / TURN)

    def place(self, theta: Any, turns: Any) -> Any:
        """The place at which the force is looked up."""
        if self.force.place == "theta":
            return theta - TURN * turns
        Y = slider(theta, self.design, self.branch)[0]
        if self.force.place != "stroke":
            return Y
        return abs(dead_centre(self.design, self.branch, self.force.dead_centre) - Y)

    def piece(self, theta: float) -> Any:
        """The piece that holds at an angle inside of an arc, and the whole turns up to there."""
        if self.force.place in FOLLOWING:
            return None
        inward = slider(theta, self.design, self.branch)[1] * self.design["omega0"] < 0.0
        pieces, turns = self.force.inward if inward else self.force.outward, self.turns(theta)
        return pieces, pieces.piece(self.place(theta, turns)), turns

    def torque(self, theta: Any, held: Any = None) -> Any:
        """T = (m a_C - F) dY/dtheta, of one piece of the force or of that which holds."""
        _, slope, bend = slider(theta, self.design, self.branch)
        return (self.inertia(bend) - self.load(theta, held)) * slope

    def inertia(self, bend: Any) -> Any:
        return self.design["m_slider"] * self.design["omega0"] ** 2 * bend

    def load(self, theta: Any, held: Any = None, omega: Any = None) -> Any:
        """The force on the slider; at another speed than that of the design."""
        if self.force.place in FOLLOWING:
            Y, slope, _ = slider(theta, self.design, self.branch)
            return self.force.outward(Y, slope * (self.design["omega0"] if omega is None else omega), theta)
        pieces, piece, turns = held or self.piece(float(theta))
        return pieces.at(self.place(theta, turns), piece)

    def shaking(self, theta: Any, held: Any = None) -> Any:
        """The force on the frame along Y: the load less the slider's inertia."""
        return self.load(theta, held) - self.inertia(slider(theta, self.design, self.branch)[2])

    def by(self, parameter: str, theta: float, of: str = "torque") -> mpf:
        """The total derivative at an angle, by a central difference at 60 digits."""
        with mp.workdps(DIGITS):
            h = mpf(10) ** -18
            ends = []
            for side in (1, -1):
                exact = {n: mpf(v) for n, v in self.design.items()} | {"theta": mpf(theta)}
                exact[parameter] += side * h
                angle = exact.pop("theta")
                ends.append(getattr(self._replace(design=exact), of)(angle))
            return (ends[0] - ends[1]) / (2 * h)

    # ---- over a turn

    def arcs(self, low: float = 0.0, high: float = TURN) -> list[tuple[float, float, Any]]:
        """The arcs of a range on each of which one piece holds: (from, to, the piece)."""
        ec, AB, BC = (self.design[n] for n in LENGTHS)
        sines = np.arcsin([-ec / (AB + BC), ec / (BC - AB)])
        spans = sorted({*self._repeated([sines[0], np.pi - sines[0], sines[1], np.pi - sines[1]], low, high)})
        turning = [a for a in spans if abs(slider(a, self.design, self.branch)[1]) < 1e-9 * AB]
        edges = {low, high, *turning}
        if self.force.place in FOLLOWING:
            edges |= {*self._repeated(_wave(1.0)[0], low, high)}
            edges |= self._at_speeds(getattr(self.force.load, "speeds", ()), low, high)
        if self.force.place == "theta":
            edges |= {*self._repeated(self.force.outward.knots, low, high)}
        elif self.force.place in ("Y", "stroke"):
            ends = sorted({low, *turning, high})
            for x in {*self.force.outward.knots}:
                for a, b in pairwise(ends):
                    at = [self.place(t, 0) - x for t in (a, b)]
                    if at[0] * at[1] < 0.0:
                        edges.add(brentq(lambda t, x=x: self.place(t, 0) - x, a, b, xtol=1e-15, rtol=1e-15))
        pairs = [(a, b) for a, b in pairwise(sorted(edges)) if b - a > 1e-12]
        return [(a, b, self.piece(0.5 * (a + b))) for a, b in pairs]

    def _at_speeds(self, speeds: Any, low: float, high: float) -> set[float]:
        """The angles at which the slider has these speeds."""

        def over(theta: Any, speed: float) -> Any:
            return slider(theta, self.design, self.branch)[1] * self.design["omega0"] - speed

        theta = np.linspace(low, high, 800)
        return {
            brentq(over, theta[k], theta[k + 1], (speed,), xtol=1e-15, rtol=1e-15)
            for speed in speeds
            for k in np.flatnonzero(np.diff(np.sign(over(theta, speed))))
        }

    def _repeated(self, angles: Any, low: float, high: float) -> list[float]:
        turns = range(int(np.floor(low / TURN)) - 1, int(np.ceil(high / TURN)) + 1)
        return [t for k in turns for a in angles if low < (t := float(a) + k * TURN) < high]

    def integral(self, function: Any, low: float = 0.0, high: float = TURN) -> float:
        """The integral of a function of angles and a piece, arc by arc, each in four panels."""
        total = 0.0
        for a, b, piece in self.arcs(low, high):
            for p, q in pairwise(np.linspace(a, b, 5)):
                theta = p + 0.5 * (q - p) * (NODES + 1.0)
                total += 0.5 * (q - p) * float(np.sum(WEIGHTS * function(theta, piece)))
        return total

    def mean(self, of: str = "torque", power: int = 1) -> float:
        """The mean over a turn of a quantity, or of its square."""
        return self.integral(lambda t, piece: getattr(self, of)(t, piece) ** power) / TURN

    def work(self, low: float, high: float) -> float:
        """The work of the force between two angles."""
        return self.integral(lambda t, p: self.load(t, p) * slider(t, self.design, self.branch)[1], low, high)

    def wave(self, order: int, of: str = "torque") -> complex:
        """The Fourier coefficient of cos - i sin over a turn."""
        return sum(
            part * self.integral(lambda t, p, f=f: getattr(self, of)(t, p) * f(order * t)) / np.pi
            for part, f in ((1, np.cos), (-1j, np.sin))
        )

    def largest(self, of: str = "torque") -> float:
        """The largest magnitude over a turn: of every arc, its ends among them."""
        best = 0.0
        for a, b, piece in self.arcs():
            theta = np.linspace(a, b, 400)
            values = np.abs(getattr(self, of)(theta, piece))
            k = int(np.argmax(values))
            ends = theta[max(k - 1, 0)], theta[min(k + 1, 399)]
            near = minimize_scalar(
                lambda t, p=piece: -abs(getattr(self, of)(t, p)), bounds=ends, method="bounded",
                options={"xatol": 1e-12},
            )  # fmt: skip
            best = max(best, float(values[k]), -float(near.fun))
        return best

    def moved(self, figure: Any, parameter: str, h: float = 1e-6) -> float:
        """The derivative of a figure of the whole turn by a parameter, by a central difference."""
        value = self.design[parameter]
        step = h * (abs(value) or self.design["AB"])
        ends = [self._replace(design=self.design | {parameter: value + s * step}) for s in (1, -1)]
        return (figure(ends[0]) - figure(ends[1])) / (2.0 * step)


def drawn(place: str, shape: str, draw: Any) -> Truth:
    """A random machine that turns fully, either way and on either branch, under a random force of a kind."""
    AB = draw.uniform(0.03, 0.06)
    BC = AB * draw.uniform(1.5, 3.0)
    design = {"ec": draw.uniform(-0.5, 0.5) * (BC - AB), "AB": AB, "BC": BC}
    branch = draw.choice([1, -1])
    force = force_of(place, shape, design, branch, draw)
    speed = draw.choice([1.0, -1.0]) * draw.uniform(10.0, 60.0)
    return Truth({**design, "omega0": speed, "m_slider": draw.uniform(0.3, 2.0)}, branch, force)


def given(truth: Truth) -> dict:
    """The inputs of a call."""
    return {**truth.design, "F_Y": truth.force.load, "branch": truth.branch}
