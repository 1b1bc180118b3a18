"""Designs in rows: their inputs, and what the equation of motion needs of them at any angle.

The crank goes x = 0 ... period in its way of turning, theta = way x. With the kinetic energy
E = (M_eff + J) omega^2/2, J the flywheel,

    dE/dx = way (T - L - R),

T the motor's torque, L what loads and gravity hold against it, R the torque of guide friction, which is
`way |Y'| mu |N|`; the normal force N depends on the acceleration that it changes (simulation/law.py).
"""

from collections.abc import Mapping, Sequence
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import are_good
from ...evaluation.evaluate import evaluate
from ...loads.along_motion import OfMotion, speeds_of
from ...loads.angles import meeting_angles
from ...loads.load import Load
from ...mechanism.closed.angles import dead_centres, repeated
from ...mechanism.names import LENGTHS
from ...support.panels import Panels, divided
from ..turn.cycle import Cycle
from .source import TorqueSource

Array = NDArray[Any]
Course = dict[str, Array]  # coefficients of the equation by name; see `course_of`
CREEP = 1e-100  # rad/s: loads know the way of turning, inertia does not act
WIDEST = 0.65  # rad
NOTHING = 1e-12  # of the inertia elsewhere
SIDES, EXACT = 4, 1e-14  # steps of Newton's method for each guide; of an acceleration, the last one


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
        numbers, motor, J, way = (picked(v, index) for v in (self.numbers, self.motor, self.J, self.way))
        return self._replace(size=J.size, numbers=numbers, motor=motor, J=J, way=way)

    @property
    def period(self) -> float:
        """The angle after which everything repeats [rad]."""
        return 2.0 * pi * self.turns

    @property
    def has_friction(self) -> bool:
        """True where the guide of a design has friction."""
        return bool(np.any(self.numbers.get("mu", 0.0)))

    @property
    def speeds(self) -> list[float]:
        """The slider's speeds at which a load has a kink."""
        return speeds_of(self.loads.values())

    @property
    def switches(self) -> bool:
        """True if kinks of a motion depend on its speed."""
        return bool(self.source.knots or self.speeds) or self.has_friction or self.by_state

    @property
    def by_state(self) -> bool:
        """True for several sliders of which friction or a load depends on how fast the crank turns."""
        return self.turn is not None and (
            self.turn.has_friction or self.turn.sliders.without_speed() is not None
        )

    @property
    def following(self) -> dict[str, OfMotion]:
        """The loads that depend on the speed."""
        loads = self.loads.items()
        return {name: load for name, load in loads if isinstance(load, OfMotion) and load.follows_speed}

    def each(self, values: Any, ndim: int) -> Any:
        """Numbers of designs beside arrays of this many dimensions."""
        return np.reshape(values, (-1, *[1] * (ndim - 1))) if np.ndim(values) else values

    def theta(self, x: Array) -> Array:
        """The crank angle."""
        return np.asarray(self.each(self.way, x.ndim) * x)

    def torque(self, theta: Array, omega: Array) -> tuple[Array, Array]:
        """The motor's torque and its derivative with respect to the speed."""
        return self.source.both(theta, omega, {n: self.each(v, omega.ndim) for n, v in self.motor.items()})

    def values(self, names: Sequence[str], x: Array, **other: Any) -> dict[str, Array]:
        """Quantities at angles, by `evaluate`; `other` inputs replace those of the designs."""
        inputs: dict[str, Any] = {n: self.each(v, x.ndim) for n, v in self.numbers.items()}
        inputs |= {**self.loads, **({} if self.turn is None else {"sliders": self.turn.sliders}), **other}
        present = {n: v for n, v in inputs.items() if v is not None}
        result = evaluate(list(names), theta=self.theta(x), branch=self.branch, **present)
        return {name: np.broadcast_to(result[name], x.shape) for name in names}

    def at_state(self, names: Sequence[str], x: Array, omega: Array, alpha: Array) -> dict[str, Array]:
        """Quantities by speed and acceleration, NaN where the motor has no torque at a trial energy."""
        known = are_good("omega", omega) & are_good("alpha", alpha)
        state = {n: np.where(known, v, 0.0) for n, v in {"omega": omega, "alpha": alpha}.items()}
        return {n: np.where(known, v, np.nan) for n, v in self.values(names, x, **state).items()}

    @property
    def cycle(self) -> Cycle:
        """The designs over their period, in the way of a crank that turns forwards."""
        return self.turn or Cycle(self.numbers, self.loads, self.branch, self.turns)

    def lengths(self) -> list[Array]:
        """ec, AB and BC of each design; several sliders have none in common."""
        several = dict.fromkeys(LENGTHS, np.nan) if self.turn is not None else self.numbers
        return [np.broadcast_to(np.asarray(several[name], float), (self.size,)) for name in LENGTHS]

    def edges(self) -> Array:
        """The edges of panels: kinks of loads, dead centres under friction, and even ones between them."""
        loads = [*self.loads.values(), *([self.source.load] if self.source.load is not None else [])]
        marks = [meeting_angles(loads, self.period, self.lengths(), self.branch)]
        if self.turn is not None:
            marks.append(self.turn.edges(["T_in"])[None])
        if self.has_friction or 0.0 in self.speeds:
            marks.append(repeated(dead_centres(self.lengths()), 0.0, self.period))
        every = np.concatenate([np.broadcast_to(m, (self.size, m.shape[1])) for m in marks], axis=1)
        ends = np.tile([0.0, self.period], (self.size, 1))
        return divided(np.concatenate([ends, every * self.way[:, None] % self.period], axis=1), WIDEST)


def vanishing(designs: DesignRows) -> Array:
    """True for designs without any inertia at a dead centre."""
    if designs.turn is not None:  # each of several sliders has its own
        return np.zeros(designs.size, bool)
    x = np.nan_to_num(dead_centres(designs.lengths()))
    there = designs.values(["M_eff"], x)["M_eff"] + designs.J[:, None]
    between = designs.values(["M_eff"], x + 1.0)["M_eff"]
    return np.asarray((there <= NOTHING * between).any(1))


def picked(value: Any, index: Any) -> Any:
    """Some rows of arrays, and of designs, mappings and tuples of them; numbers stay."""
    if isinstance(value, DesignRows):
        return value.rows(index)
    if isinstance(value, np.ndarray):
        return value[index]
    if isinstance(value, Mapping):
        return {name: picked(one, index) for name, one in value.items()}
    if isinstance(value, tuple):
        rows = [picked(one, index) for one in value]
        return type(value)(*rows) if hasattr(value, "_fields") else tuple(rows)
    return value


def course_of(designs: DesignRows, x: Array) -> Course:
    """The coefficients of the equation at places x, which do not depend on the speed.

    inertia, slope             M_eff + J, and its derivative with respect to theta
    load                       L, without loads that depend on the speed
    still, square, push        under friction the normal force at rest, by omega^2 and by T - L
    wedge, arm                 K on one side of the guide, and the arm of the friction
    travel, <force>, N_<force> dY/dtheta; torque and normal force by a load that depends on the speed
    """
    ndim, friction, following = x.ndim, designs.has_friction, designs.following
    way = designs.each(designs.way, ndim)
    still: dict[str, Any] = {"omega": way * CREEP, "alpha": 0.0, **dict.fromkeys(following, 0.0)}
    names = ["M_eff", "M_eff_wrt_theta", "T_in"]
    names += ["N_C", "N_C_wrt_alpha", "phi"] if friction else []
    names += ["Y_wrt_theta"] if friction or following else []
    at = designs.values(names, x, **still, mu=None if designs.turn is None else 0.0)
    inertia, slope = at["M_eff"] + designs.each(designs.J, ndim), at["M_eff_wrt_theta"]
    course = {"theta": designs.theta(x), "inertia": inertia, "slope": slope, "load": at["T_in"]}
    free = {**dict.fromkeys(designs.loads, 0.0), "omega": 1.0, "alpha": 0.0, "mu": None}
    if friction:
        mu, travel = designs.each(designs.numbers["mu"], ndim), at["Y_wrt_theta"]
        push = at["N_C_wrt_alpha"] / inertia
        square = 0.5 * (designs.values(["N_C_wrt_omega"], x, **free)["N_C_wrt_omega"] - slope * push)
        arm = mu * np.abs(travel) * way
        lean = designs.branch * np.tan(at["phi"]) * mu * np.sign(travel) * way
        course |= {"still": at["N_C"], "square": square, "push": push, "wedge": lean - arm * push, "arm": arm}
    for force, load in following.items():
        motion = [name for name in load.motion((), True) if name not in ("omega", "V_C")]
        slopes = [f"T_in_wrt_{force}", *([f"N_C_wrt_{force}"] if friction else [])]
        at |= designs.values([*motion, *slopes], x, **free)
        course |= {name: at[name] for name in motion}
        course |= {"travel": at["Y_wrt_theta"], force: -at[slopes[0]], f"N_{force}": at[slopes[-1]]}
    return course


def course_at(designs: DesignRows, edges: Array, course: Course, x: Array) -> Course:
    """The coefficients at any places within the edges, from those at nodes."""
    read = Panels(edges).reader(x)
    return {**{name: read(v) for name, v in course.items() if name != "theta"}, "theta": designs.theta(x)}


class Rate(NamedTuple):
    """dE/dx and its derivative by E, the speed, the torque, and under friction the sign of N and its K."""

    f: Array
    g: Array
    omega: Array
    torque: Array
    normal: Array | None = None
    wedge: Array | None = None


def rate(designs: DesignRows, course: Course, E: Array) -> Rate:
    """The equation at an energy; NaN where that is not positive."""
    if designs.by_state:
        return _rate_by_state(designs, course, E)
    way, inertia = designs.each(designs.way, E.ndim), course["inertia"]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        square = 2.0 * E / inertia
        omega = way * np.sqrt(square)
        torque, by_omega = designs.torque(course["theta"], omega)
        push, pressed_by, by_pressed = torque - course["load"], 0.0, 0.0
        for name, load in designs.following.items():
            speed = course["travel"] * omega
            force, by = load.partials({**course, "omega": omega, "V_C": speed, "way": np.sign(speed)})
            by_speed = by.get("omega", 0.0) + by.get("V_C", 0.0) * course["travel"]
            push, by_omega = push + course[name] * force, by_omega + course[name] * by_speed
            pressed_by, by_pressed = (
                total + course[f"N_{name}"] * part
                for total, part in ((pressed_by, force), (by_pressed, by_speed))
            )
        steep = by_omega * omega / (2.0 * E)
        if "arm" not in course:
            return Rate(way * push, way * steep, omega, torque)
        normal = course["still"] + course["square"] * square + course["push"] * push + pressed_by
        pressed = np.copysign(1.0, normal)
        wedge = course["wedge"] * pressed
        rub = course["arm"] * pressed / (1.0 - wedge)
        by_E = 2.0 * course["square"] / inertia + course["push"] * steep + by_pressed * omega / (2.0 * E)
        return Rate(way * (push - rub * normal), way * (steep - rub * by_E), omega, torque, normal, wedge)


def _rate_by_state(designs: DesignRows, course: Course, E: Array) -> Rate:
    """The equation of several sliders by their torque at a state, which knows the side of each guide."""
    way, inertia, slope = designs.each(designs.way, E.ndim), course["inertia"], course["slope"]
    J, names = designs.each(designs.J, E.ndim), ["T_in", "T_in_wrt_alpha", "T_in_wrt_omega"]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        x, omega = np.broadcast_arrays(way * course["theta"], way * np.sqrt(2.0 * E / inertia))
        torque, by_omega = designs.torque(course["theta"], omega)
        alpha = (torque - course["load"] - 0.5 * slope * omega**2) / inertia
        for _ in range(SIDES * len(designs.turn.own)):  # linear but where a guide changes sides
            at = designs.at_state(names, x, omega, alpha)
            mass = at["T_in_wrt_alpha"] + J
            change = (torque - at["T_in"] - J * alpha) / mass
            alpha = alpha + change
            if not (np.abs(change) > EXACT * (np.abs(alpha) + omega**2)).any():
                break
        steep = (by_omega - at["T_in_wrt_omega"]) / mass
        f = way * (inertia * alpha + 0.5 * slope * omega**2)
        return Rate(f, way * (inertia * steep + slope * omega) / (inertia * omega), omega, torque)


def kinks_of(designs: DesignRows, course: Course, here: Rate, x: Array) -> list[Array]:
    """Functions that change sign where friction or a load over the slider's speed has a kink."""
    if not designs.by_state:
        normal = [] if here.normal is None else [here.normal]
        return [*(course["travel"] * here.omega - speed for speed in designs.speeds), *normal]
    alpha = (here.f * designs.each(designs.way, x.ndim) - 0.5 * course["slope"] * here.omega**2) / course[
        "inertia"
    ]
    marks = {f"V_C[{k}]": speeds_of(own.loads.values()) for k, own in enumerate(designs.turn.own)}
    marks |= {f"N_C[{k}]": [0.0] for k, own in enumerate(designs.turn.own) if own.has_friction}
    names = [name for name, values in marks.items() if values]
    at = designs.at_state(names, x, here.omega, alpha)
    return [at[name] - value for name in names for value in marks[name]]
