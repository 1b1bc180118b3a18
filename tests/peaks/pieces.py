"""The truth of a peak under loads that jump: constant forces, arc by arc of the crank angle.

An arc ends where the raw loop closure reaches a position of a table, at a dead centre, or at an angle of a
table over theta, all solved for in mpmath. On it forces are numbers; `desaxe.peak` for numbers is the truth.
"""

import bisect
from itertools import pairwise
from math import inf, nextafter
from typing import Any, NamedTuple

import mpmath

import desaxe as dx

DIGITS = 60  # with which to call these functions
TINY = mpmath.mpf(10) ** -52
WIDER = mpmath.mpf("0.01")  # rad: ends of a range may be next to a jump
LENGTHS = ("ec", "AB", "BC")
SIGN = {"absmax": abs, "max": lambda x: x, "min": lambda x: -x}


class Stroke(NamedTuple):
    """A step table over Y."""

    positions: tuple
    outward: tuple
    inward: tuple | None

    @property
    def load(self):
        return dx.over_Y(self.positions, self.outward, self.inward, kind="step")

    def force(self, theta, closure, way):
        Y, slope = closure(theta)
        values = self.inward if self.inward is not None and slope * way < 0 else self.outward
        return values[max(bisect.bisect_right(self.positions, Y) - 1, 0)]


class FromCentre(NamedTuple):
    """A step table over the distance from a dead centre, which is at `zero` on this branch."""

    distances: tuple
    outward: tuple
    inward: tuple | None
    dead_centre: str
    zero: Any

    @property
    def load(self):
        return dx.over_stroke(self.distances, self.outward, self.inward, "step", dead_centre=self.dead_centre)

    @property
    def positions(self):
        return [self.zero + side * mpmath.mpf(d) for d in self.distances for side in (1, -1) if d]

    def force(self, theta, closure, way):
        Y, slope = closure(theta)
        values = self.inward if self.inward is not None and slope * way < 0 else self.outward
        return values[max(bisect.bisect_right(self.distances, abs(self.zero - Y)) - 1, 0)]


class Turn(NamedTuple):
    """A step table over the crank angle."""

    angles: tuple
    values: tuple
    period: float

    @property
    def load(self):
        return dx.over_theta(self.angles, self.values, "step", self.period)

    def force(self, theta, closure, way):
        first = mpmath.mpf(self.angles[0])
        return self.values[
            bisect.bisect_right(self.angles, first + (theta - first) % mpmath.mpf(self.period)) - 1
        ]


class Arc(NamedTuple):
    """An arc, what it begins and ends with (see `edges`; None if unknown), and the forces on it."""

    low: Any
    high: Any
    marks: tuple
    forces: dict
    before: dict  # the forces beyond its ends
    after: dict


class Top(NamedTuple):
    """The extremum of an arc."""

    value: float
    theta: float
    gradient: dict
    status: int
    arc: Arc
    ends: tuple  # its first and last double


def closure_of(design, branch):
    """Y and its slope from the raw loop closure, as a function of the angle."""
    ec, AB, BC = (mpmath.mpf(design[name]) for name in LENGTHS)

    def closure(theta):
        sine, cosine = mpmath.sin(theta), mpmath.cos(theta)
        across = ec + AB * sine
        rise = branch * mpmath.sqrt(BC**2 - across**2)
        return AB * cosine + rise, -AB * sine - across * AB * cosine / rise

    return closure


def repeated(angles, period, low, high):
    """Angles of a period in a range."""
    result = []
    for angle in angles:
        first = int(mpmath.floor((low - angle) / period))
        result += [angle + k * period for k in range(first, first + int((high - low) / period) + 3)]
    return sorted(a for a in result if low <= a <= high)


def dead_centres(design, low, high):
    """The angles of crank and rod in line."""
    ec, AB, BC = (mpmath.mpf(design[name]) for name in LENGTHS)
    result = [mpmath.asin(sine) for sine in (-ec / (AB + BC), ec / (BC - AB)) if abs(sine) <= 1]
    return repeated([*result, *(mpmath.pi - a for a in result)], 2 * mpmath.pi, low, high)


def crossing(x, closure, a, b):
    """The angle at which Y passes x between angles without a dead centre between; None if there is none."""
    at_a, at_b = (closure(t)[0] - x for t in (a, b))
    if min(abs(at_a), abs(at_b)) < TINY or (at_a > 0) == (at_b > 0):
        return None
    while abs(b - a) > mpmath.mpf(10) ** -50:
        middle = (a + b) / 2
        there = closure(middle)
        step = middle - (there[0] - x) / there[1] if there[1] else middle  # Newton, where it stays inside
        for t in (middle, step, step - TINY * 100, step + TINY * 100):
            if a < t < b:
                if (closure(t)[0] - x > 0) == (at_a > 0):
                    a = t
                else:
                    b = t
    return (a + b) / 2


def edges(design, branch, loads, low, high):
    """The angles at which forces may change, and what keeps them: a position, "dead centre" or "angle"."""
    closure = closure_of(design, branch)
    turning = dead_centres(design, low - 7, high + 7)
    result = [(t, "dead centre") for t in turning]
    for load in loads.values():
        if isinstance(load, Turn):
            result += [
                (t, "angle")
                for t in repeated(map(mpmath.mpf, load.angles), mpmath.mpf(load.period), low, high)
            ]
        else:
            for x in load.positions:
                places = (crossing(mpmath.mpf(x), closure, a, b) for a, b in pairwise(turning))
                result += [(t, "position") for t in places if t is not None]
    return sorted(edge for edge in result if low <= edge[0] <= high)


def arcs(design, branch, loads, theta):
    """The arcs of a range of angles on which forces are constant."""
    low, high = map(mpmath.mpf, theta)
    way = 1 if design.get("omega0", design.get("omega", 1.0)) >= 0 else -1
    closure = closure_of(design, branch)
    marks = [
        (low - WIDER, None),
        *edges(design, branch, loads, low - WIDER, high + WIDER),
        (high + WIDER, None),
    ]
    result = []
    for first, last in pairwise(marks):
        if last[0] - first[0] < TINY:
            continue
        middle = (first[0] + last[0]) / 2
        forces = {name: load.force(middle, closure, way) for name, load in loads.items()}
        if result and result[-1].forces == forces and not (design.get("mu") and first[1] == "dead centre"):
            result[-1] = result[-1]._replace(high=last[0], marks=(result[-1].marks[0], last[1]))
        else:
            result.append(Arc(first[0], last[0], (first[1], last[1]), forces, {}, {}))
    result += _touches(design, loads, closure, way)
    result = [arc for arc in result if doubles(arc, (-inf, inf))]  # what a double of it has before and after
    result.sort(key=lambda arc: (arc.low, arc.high))
    result = [
        arc._replace(before=result[max(k - 1, 0)].forces, after=result[min(k + 1, len(result) - 1)].forces)
        for k, arc in enumerate(result)
    ]
    return [arc for arc in result if arc.high >= low and arc.low <= high]


def _touches(design, loads, closure, way):
    """A position of a table that is only just reached, at the angle 0, which is a double: there it counts."""
    values, slopes = closure(mpmath.mpf(0)), closure(mpmath.mpf(10) ** -20)
    touched = [
        x for load in loads.values() if isinstance(load, Stroke) for x in load.positions if values[0] == x
    ]
    if design["ec"] or not touched or slopes[1] > 0:  # from below: the piece to the right holds there alone
        return []
    zero = mpmath.mpf(0)
    forces = {n: load.force(zero, lambda t: (values[0], slopes[1]), way) for n, load in loads.items()}
    return [Arc(zero, zero, (None, None), forces, {}, {})]


def doubles(arc, theta):
    """The first and the last double of an arc in a range; None where there is none."""
    first, last = float(arc.low), float(arc.high)
    while first < arc.low:
        first = nextafter(first, inf)
    while last > arc.high or (last == arc.high and arc.marks[1] == "angle"):  # the value there is the next
        last = nextafter(last, -inf)
    first, last = max(first, theta[0]), min(last, theta[1])
    return (first, last) if first <= last else None


def tops(name, kind, design, branch, loads, theta):
    """The extremum of every arc that has a double, the best first."""
    result = []
    for arc in arcs(design, branch, loads, theta):
        ends = doubles(arc, theta)
        if ends is not None and design.get("mu"):
            ends = _moving(design, branch, ends)
        if ends is not None:
            own = dx.peak(name, kind=kind, branch=branch, theta=ends, **design, **arc.forces)
            result.append(Top(own["value"], own["theta"], own["gradient"], own["status"], arc, ends))
    result = [top for top in result if top.value == top.value]
    return sorted(result, key=lambda top: -SIGN[kind](top.value))


def _moving(design, branch, ends):
    """The ends without doubles at which V_C rounds to 0, where friction has no side; None for no other."""
    lengths = {name: design[name] for name in LENGTHS}

    def rests(theta):
        return dx.evaluate("V_C", theta=theta, branch=branch, omega0=1.0, **lengths) == 0.0

    first, last = ends
    while first <= last and rests(first):
        first = nextafter(first, inf)
    while first <= last and rests(last):
        last = nextafter(last, -inf)
    return (first, last) if first <= last else None


def sides(name, design, branch, top, room):
    """The sides of jumps of a quantity that an extremum may be reported on."""
    own = dx.evaluate(name, theta=top.theta, branch=branch, **design, **top.arc.forces)
    result = set()
    ends = zip((1, -1), top.ends, top.arc.marks, (top.arc.before, top.arc.after), strict=True)
    for side, end, mark, forces in ends:
        jump = top.arc.low if side > 0 else top.arc.high
        there = dx.evaluate(name, theta=top.theta, branch=branch, **design, **forces) if forces else own
        if mark and max(abs(top.theta - end), abs(end - jump)) <= 4e-15 and not abs(there - own) <= room:
            result.add(side)
    return result if len(result) == 1 else {0, *result}
