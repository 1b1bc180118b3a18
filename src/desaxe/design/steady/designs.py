"""Designs in rows: their inputs, and what the equation of motion needs of them at any angle.

The crank goes x = 0 ... period in its way of turning, theta = way x. With the kinetic energy
E = (M_eff + J) omega^2/2, J the flywheel,

    dE/dx = way (T - L - R),

T the motor's torque, L what loads and gravity hold against it, R the torque of guide friction, which is
`way |Y'| mu |N|`; the normal force N depends on the acceleration that it changes (simulation/law.py).
"""

from collections.abc import Callable, Mapping, Sequence
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...loads.along_motion import OfMotion, speeds_of
from ...loads.angles import meeting_angles
from ...loads.load import Load
from ...mechanism.closed.angles import dead_centres
from ...mechanism.names import LENGTHS
from ...support.panels import divided
from ..turn.cycle import Cycle
from .source import TorqueSource

Array = NDArray[Any]
CREEP = 1e-100  # rad/s: loads know the way of turning, inertia does not act
INSIDE = 1e-5  # of a panel: so far from its ends a value belongs to it
WIDEST = 0.65  # rad
NOTHING = 1e-12  # of the inertia elsewhere


class DesignRows(NamedTuple):
    """Rows of designs.

    numbers   inputs of the mechanism: a number for all, or an array with one for each
    motor     the same of the torque's parameters
    J, way    of each: the flywheel's inertia, and 1 or -1
    turn      of several sliders on one crankshaft, in place of numbers: their turn
    """

    size: int
    numbers: Mapping[str, Any]
    loads: Mapping[str, Load]
    branch: int
    source: TorqueSource
    motor: Mapping[str, Any]
    J: Array
    way: Array
    turns: int
    turn: Any = None

    def rows(self, index: Array) -> "DesignRows":
        """Some of the designs."""

        def picked(values: Mapping[str, Any]) -> dict[str, Any]:
            return {n: v[index] if np.ndim(v) else v for n, v in values.items()}

        return self._replace(
            size=len(index), numbers=picked(self.numbers), motor=picked(self.motor),
            J=self.J[index], way=self.way[index],
        )  # fmt: skip

    @property
    def period(self) -> float:
        """The angle after which everything repeats [rad]."""
        return 2.0 * pi * self.turns

    @property
    def has_friction(self) -> bool:
        """True where the guide of a design has friction."""
        return bool(np.any(self.numbers.get("mu", 0.0)))

    @property
    def switches(self) -> bool:
        """True if kinks of a motion depend on its speed."""
        return bool(self.source.knots or self.speeds) or self.has_friction

    @property
    def speeds(self) -> list[float]:
        """The slider's speeds at which a load has a kink."""
        return speeds_of(self.loads.values())

    def each(self, values: Any, ndim: int) -> Any:
        """Numbers of designs beside arrays of this many dimensions."""
        return np.reshape(values, (-1, *[1] * (ndim - 1))) if np.ndim(values) else values

    def theta(self, x: Array) -> Array:
        """The crank angle."""
        return np.asarray(self.each(self.way, x.ndim) * x)

    def row(self, ndim: int) -> dict[str, Any]:
        """The parameters of the torque beside arrays of this many dimensions."""
        return {name: self.each(value, ndim) for name, value in self.motor.items()}

    def values(self, names: Sequence[str], x: Array, **other: Any) -> dict[str, Array]:
        """Quantities at angles, by `evaluate`; `other` inputs replace those of the designs."""
        inputs: dict[str, Any] = {n: self.each(v, x.ndim) for n, v in self.numbers.items()}
        inputs |= {**self.loads, **({} if self.turn is None else {"sliders": self.turn.sliders}), **other}
        present = {n: v for n, v in inputs.items() if v is not None}
        found = evaluate(list(names), theta=self.theta(x), branch=self.branch, **present)
        return {name: np.broadcast_to(found[name], x.shape) for name in names}

    @property
    def cycle(self) -> Cycle:
        """The designs over their period, in the way of a crank that turns forwards."""
        return self.turn or Cycle(self.numbers, self.loads, self.branch, self.turns)

    def lengths(self) -> list[Array]:
        """ec, AB and BC of each design; several sliders have none in common."""
        if self.turn is not None:
            return [np.full(self.size, np.nan) for _ in LENGTHS]
        return [np.broadcast_to(np.asarray(self.numbers[n], float), (self.size,)) for n in LENGTHS]

    def kinks(self, load: Load) -> Array:
        """The places where a load has a kink or its pieces meet, NaN where a row has fewer."""
        found = meeting_angles([load], self.period, self.lengths(), self.branch) % self.period
        found = np.broadcast_to(found, (self.size, found.shape[1]))
        return np.where(self.way[:, None] < 0.0, self.period - found, found)

    def edges(self) -> Array:
        """The edges of panels: kinks of loads, dead centres under friction, and even ones between them."""
        period = self.period
        loads = [*self.loads.values(), *([self.source.load] if self.source.load is not None else [])]
        found = [np.tile([0.0, period], (self.size, 1)), *map(self.kinks, loads)]
        if self.turn is not None:
            found.append(self.turn.edges(["T_in"]) * self.way[:, None] % period)
        if self.has_friction or 0.0 in self.speeds:
            own = dead_centres(self.lengths()) * self.way[:, None]
            found += [(own + 2.0 * pi * k) % period for k in range(self.turns)]
        return divided(np.concatenate(found, axis=1), WIDEST)


def vanishing(designs: DesignRows) -> Array:
    """True for designs without any inertia at a dead centre."""
    if designs.turn is not None:  # each of several sliders has its own
        return np.zeros(designs.size, bool)
    x = np.nan_to_num(dead_centres(designs.lengths()))
    there = designs.values(["M_eff"], x)["M_eff"] + designs.J[:, None]
    between = designs.values(["M_eff"], x + 1.0)["M_eff"]
    return np.asarray((there <= NOTHING * between).any(1))


class Coefficients(NamedTuple):
    """The coefficients of the equation at places x: they do not depend on the speed.

    inertia, slope   M_eff + J, and its derivative by theta
    load             L
    guide            the normal force at rest, its parts by omega^2 and by T - L; K on one side, and the arm
    follow           loads that depend on the speed
    """

    theta: Array
    way: Any
    inertia: Array
    slope: Array
    load: Array
    guide: tuple[Array, ...] | None
    follow: tuple["Following", ...] = ()

    def some(self, at: Any) -> "Coefficients":
        """The coefficients at some of the places."""
        guide = None if self.guide is None else tuple(v[at] for v in self.guide)
        follow = tuple(one.some(at) for one in self.follow)
        theta, inertia, slope, load = (v[at] for v in (self.theta, self.inertia, self.slope, self.load))
        return Coefficients(theta, self.way, inertia, slope, load, guide, follow)


class Following(NamedTuple):
    """A load that depends on the speed, at places.

    columns  of the motion that do not depend on the speed
    travel   dY/dtheta
    arm      the torque [m] on the crank by the force
    normal   what the normal force grows by with the force
    """

    load: OfMotion
    columns: dict[str, Array]
    travel: Array
    arm: Array
    normal: Array | None

    def some(self, at: Any) -> "Following":
        """The load at some of the places."""
        columns = {name: column[at] for name, column in self.columns.items()}
        normal = None if self.normal is None else self.normal[at]
        return Following(self.load, columns, self.travel[at], self.arm[at], normal)

    def read(self, read: Callable[[Array], Array], theta: Array) -> "Following":
        """The load at other places, by a reader of panels."""
        columns = {name: read(column) for name, column in self.columns.items()} | {"theta": theta}
        normal = None if self.normal is None else read(self.normal)
        return Following(self.load, columns, read(self.travel), read(self.arm), normal)

    def at(self, omega: Array) -> tuple[Array, Array]:
        """The force and its derivative by the speed."""
        now = {**self.columns, "omega": omega, "V_C": self.travel * omega}
        now["way"] = np.sign(now["V_C"])
        value, by = self.load.partials(now)
        return value, by.get("omega", 0.0) + by.get("V_C", 0.0) * self.travel


def picked(fields: Any, rows: Array) -> Any:
    """Some rows of a named tuple of arrays, of tuples of them and of numbers."""

    def of(value: Any) -> Any:
        if isinstance(value, Following):
            return value.some(rows)
        if isinstance(value, tuple):
            return tuple(map(of, value))
        return value[rows] if isinstance(value, np.ndarray) else value

    return type(fields)(*map(of, fields))


def course_of(designs: DesignRows, x: Array) -> Coefficients:
    """The course of designs at places x: an array with a row for each."""
    way = designs.each(designs.way, x.ndim)
    still: dict[str, Any] = {"omega": way * CREEP, "alpha": 0.0}
    names = ["M_eff", "M_eff_wrt_theta", "T_in"]
    friction = designs.has_friction
    if friction:
        names += ["N_C", "N_C_wrt_alpha", "Y_wrt_theta", "phi"]
    follow = {n: a for n, a in designs.loads.items() if isinstance(a, OfMotion) and a.follows_speed}
    still |= dict.fromkeys(follow, 0.0)
    found = designs.values(names, x, **still, mu=None)
    inertia, slope = found["M_eff"] + designs.each(designs.J, x.ndim), found["M_eff_wrt_theta"]
    guide = None
    if friction:
        mu = designs.each(designs.numbers["mu"], x.ndim)
        free = dict.fromkeys(designs.loads, 0.0)
        by_square = designs.values(["N_C_wrt_omega"], x, **free, omega=1.0, alpha=0.0, mu=None)
        b = found["N_C_wrt_alpha"] / inertia
        a = 0.5 * (by_square["N_C_wrt_omega"] - slope * b)
        travel = found["Y_wrt_theta"]
        arm = mu * np.abs(travel) * way
        lean = designs.branch * np.tan(found["phi"]) * mu * np.sign(travel) * way
        guide = (found["N_C"], a, b, lean - arm * b, arm)
    following = tuple(_following(designs, name, load, x) for name, load in follow.items())
    return Coefficients(designs.theta(x), way, inertia, slope, found["T_in"], guide, following)


def _following(designs: DesignRows, force: str, load: OfMotion, x: Array) -> Following:
    """A load that depends on the speed, at places x."""
    free = {**dict.fromkeys(designs.loads, 0.0), "omega": 1.0, "alpha": 0.0, "mu": None}
    motion = [n for n in load.motion((), True) if n not in ("omega", "V_C")]
    slopes = [f"T_in_wrt_{force}", *([f"N_C_wrt_{force}"] if designs.has_friction else [])]
    found = designs.values([*motion, "Y_wrt_theta", *slopes], x, **free)
    columns = {**{name: found[name] for name in motion}, "theta": designs.theta(x)}
    return Following(
        load, columns, found["Y_wrt_theta"], -found[slopes[0]], found[slopes[1]] if slopes[1:] else None
    )


class Rate(NamedTuple):
    """dE/dx and its derivative by E, the speed, the torque, and under friction the sign of N and its K."""

    f: Array
    g: Array
    omega: Array
    torque: Array
    normal: Array | None = None
    wedge: Array | None = None


def rate(course: Coefficients, source: TorqueSource, row: Mapping[str, Any], E: Array) -> Rate:
    """The equation at an energy; NaN where that is not positive."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        square = 2.0 * E / course.inertia
        omega = course.way * np.sqrt(square)
        torque, by_omega = source.both(course.theta, omega, row)
        pressed_by: Any = 0.0
        by_pressed: Any = 0.0
        push = torque - course.load
        for one in course.follow:
            force, by_speed = one.at(omega)
            push, by_omega = push + one.arm * force, by_omega + one.arm * by_speed
            if one.normal is not None:
                pressed_by, by_pressed = pressed_by + one.normal * force, by_pressed + one.normal * by_speed
        steep = by_omega * omega / (2.0 * E)
        if course.guide is None:
            return Rate(course.way * push, course.way * steep, omega, torque)
        still, a, b, wedge, arm = course.guide
        normal = still + a * square + b * push + pressed_by
        pressed = np.copysign(1.0, normal)
        wedge = wedge * pressed
        rub = arm * pressed / (1.0 - wedge)
        f, g = (
            push - rub * normal,
            steep - rub * (2.0 * a / course.inertia + b * steep + by_pressed * omega / (2.0 * E)),
        )
        return Rate(course.way * f, course.way * g, omega, torque, normal, wedge)
