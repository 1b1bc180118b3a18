"""Inertia and torque of many designs at the nodes of panels, over the coordinate of their motion."""

from collections.abc import Mapping, Sequence
from math import ceil, nan, pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...loads.angles import meeting_angles, turns_of, zero_of
from ...loads.load import Load, OverTheta, OverY
from ...mechanism.closed import TURN
from ...mechanism.names import LENGTHS
from ...support.panels import NODE, NODES, nodes_of, padded

Array = NDArray[np.float64]
LOST = 2.0**-53  # of an angle: its rounding, in the last terms of a series
SAME = 1e-12  # rad: edges that are no farther apart are one
MOST_TURNS = 4  # after which loads must repeat
FIRST = 1.65  # times 1/tolerance^(1/16): panels of a turn, or between limit angles, that most designs need
FIELDS, SLIDER = ("M_eff", "T_in"), ("Y", "Y_wrt_theta")  # at nodes; of a load that varies
QUANTITIES = ("M_eff", "T_in", "M_eff_wrt_theta", "Y", "potential_energy")


class Designs(NamedTuple):
    """Designs without friction: inputs of the mechanism, numbers or arrays (designs,), and their starts.

    torque, force  on crank and slider: arrays, or tables
    middle, half   of the arc between limit angles; half is 0 where the crank turns fully, middle NaN where no
                   inertia grows there
    """

    inputs: Mapping[str, Any]
    branch: int
    torque: Any
    force: Any
    theta0: Array
    omega_start: Array
    middle: Array
    half: Array

    def some(self, rows: Any) -> "Designs":
        """The designs of some rows."""
        inputs = {name: v if isinstance(v, float) else v[rows] for name, v in self.inputs.items()}
        torque, force = (v if isinstance(v, Load) else v[rows] for v in (self.torque, self.force))
        theta0, omega_start, middle, half = (column[rows] for column in self[4:8])
        return Designs(inputs, self.branch, torque, force, theta0, omega_start, middle, half)

    @property
    def tables(self) -> dict[str, Load]:
        """The loads that vary with the motion."""
        return {n: v for n, v in (("torque", self.torque), ("F_Y", self.force)) if isinstance(v, Load)}

    @property
    def lengths(self) -> list[Array]:
        """Eccentricity, crank and rod [m] of each design."""
        return [self.length(name) for name in LENGTHS]

    @property
    def period(self) -> float:
        """The angle after which all repeats where the crank turns fully [rad]."""
        return TURN * turns_of("simulate", self.tables, MOST_TURNS)

    @property
    def turns_with_the_slider(self) -> bool:
        """True where the force depends on the direction of the slider."""
        return isinstance(self.force, OverY) and self.force.turns

    def add_tables(self, push: Array, theta: Array, Y: Array, Y_wrt_theta: Array, way: Any) -> None:
        """Add what the loads that vary do to the torque that moves the crank."""
        if isinstance(self.torque, OverTheta):
            push += self.torque.value(theta)
        if isinstance(self.force, OverY):
            zero = zero_of(self.force, self.lengths, self.branch)[:, None]
            along = self.force.along({"Y": Y, self.force.centre: zero})
            push += self.force.value(along, way * Y_wrt_theta) * Y_wrt_theta
        elif isinstance(self.force, OverTheta):
            push += self.force.value(theta) * Y_wrt_theta

    @property
    def loads(self) -> Array:
        """Torque and force of each design, NaN where they are tables, and half of the arc."""
        rows = np.empty((len(self.half), 3))
        for column, load in enumerate((self.torque, self.force, self.half)):
            rows[:, column] = nan if isinstance(load, Load) else load
        return rows

    def at_angles(self, x: Array, edges: Array | None = None, more: int = 0) -> "AtPlaces":
        """The quantities of panels between edges, or of motions at coordinates.

        x      coordinates behind the start; those of nodes are filled in; angles take their places
        more   so many empty rows at the end
        """
        loaded = isinstance(self.force, Load)
        names = QUANTITIES if edges is None else FIELDS
        names = (*names, *(name for name in SLIDER if loaded and name not in names))
        slope, values = np.empty(x.shape), np.empty((len(x), len(names) + more, x.shape[1]))
        if edges is not None:
            x[:, 1:] = nodes_of(edges[:, :-1], edges[:, 1:]).reshape(len(x), -1)
        x[:, 1:], slope[:, 1:] = self.place(x[:, 1:])
        x[:, 0], slope[:, 0] = self.theta0, 1.0
        found = self.values(x, names)
        for row, name in enumerate(names):
            values[:, row] = found[name]
        values[:, 1] = (0.0 if isinstance(self.torque, Load) else self.torque[:, None]) - values[:, 1]
        if edges is not None:
            values[:, 0] *= slope * slope
            values[:, 1] *= slope
        return AtPlaces(names, values, slope)

    def length(self, name: str) -> Array:
        """A length of each design."""
        return np.broadcast_to(self.inputs[name], self.theta0.shape)

    def values(self, theta: Array, names: Sequence[str] = ()) -> dict[str, Array]:
        """The quantities of the designs at rest, each at angles of its own."""
        inputs = {name: v if isinstance(v, float) else v[:, None] for name, v in self.inputs.items()}
        state: dict[str, Any] = {"theta": theta, "omega": 0.0, "alpha": 0.0, **inputs}
        known = [*QUANTITIES, "Y_wrt_theta"] if isinstance(self.force, Load) else list(QUANTITIES)
        return dict(evaluate(list(names) or known, branch=self.branch, threads=1, **state))

    def place(self, x: Array) -> tuple[Array, Any]:
        """Crank angles and their derivatives by the coordinate (see `coordinate`)."""
        if not self.half.any():
            return x, 1.0
        half, middle = self.half[:, None], self.middle[:, None]
        turns = half == 0.0
        return np.where(turns, x, middle + half * np.sin(x)), np.where(turns, 1.0, half * np.cos(x))

    def coordinates(self, theta: Array) -> Array:
        """The coordinates of crank angles, measured from the nearer limit, so that no digit is lost."""
        shape = (-1, *(1,) * (theta.ndim - 1))
        middle, half = self.middle.reshape(shape), self.half.reshape(shape)
        before = theta < middle
        gap = np.where(before, theta - middle, middle - theta) + half
        with np.errstate(invalid="ignore", divide="ignore"):
            quarter = 0.5 * pi - 2.0 * np.arcsin(np.sqrt(np.maximum(gap, 0.0) / (2.0 * half)))
        return np.where(half == 0.0, theta, np.where(before, -quarter, quarter))


class AtPlaces(NamedTuple):
    """Quantities of designs at angles, a row for each, and the slopes of the angles by the coordinate.

    Instead of T_in there is the torque that is left to move the crank.
    """

    names: tuple[str, ...]
    values: Array
    slope: Array

    @property
    def known(self) -> dict[str, Array]:
        """The quantities by name."""
        return {name: self.values[:, row] for row, name in enumerate(self.names)}


class Fields(NamedTuple):
    """Edges of panels, and inertia and torque of the coordinate at the start and at all nodes.

    rough   how exactly they are known: next to a limit angle a rounded angle has lost digits
    theta   the angles
    at      quantities there, the first two of the coordinate
    back    the row of the torque on the way back
    """

    edges: Array
    rough: Array
    theta: Array
    at: AtPlaces
    back: int

    @property
    def inertia(self) -> Array:
        """The inertia of each design."""
        return self.at.values[:, 0]

    @property
    def pushes(self) -> tuple[Array, Array]:
        """The torque on both ways."""
        return self.at.values[:, 1], self.at.values[:, self.back]


def fields_of(designs: Designs, edges: Array) -> Fields:
    """The fields of designs on panels."""
    count, panels = len(edges), edges.shape[1] - 1
    theta = np.empty((count, 1 + NODES * panels))
    loaded = isinstance(designs.force, Load)
    at = designs.at_angles(theta, edges, int(loaded))
    values, slope, known = at.values, at.slope, at.known
    rough, back = np.zeros((count, panels)), len(at.names) if loaded else 1
    if designs.half.any():
        rough = _rough(designs, edges)
    if loaded:
        values[:, back] = values[:, 1]
        for row, way in ((1, 1.0), (back, -1.0)):
            own = np.zeros(theta.shape)
            designs.add_tables(own, theta, known["Y"], known["Y_wrt_theta"], way)
            values[:, row] += own * slope
    elif designs.tables:
        own = np.zeros(theta.shape)
        designs.add_tables(own, theta, theta, theta, 1.0)
        values[:, 1] += own * slope
    return Fields(edges, rough, theta, at, back)


def _rough(designs: Designs, edges: Array) -> Array:
    """The share of the fields that rounding of angles leaves open on each panel."""
    half, (first, last) = designs.half[:, None], NODE[[0, -1]]
    middle, width = 0.5 * (edges[:, 1:] + edges[:, :-1]), 0.5 * np.diff(edges)
    ends = np.maximum(np.abs(np.sin(middle + width * first)), np.abs(np.sin(middle + width * last)))
    nearest = np.maximum(1.0 - ends, 2.0**-53) * half
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = LOST * (np.abs(designs.middle[:, None]) + half) / nearest
    return np.where(half == 0.0, 0.0, lost)


def first_edges(designs: Designs, tolerance: float) -> Array:
    """Edges of panels over a period from the start, or over the arc: at the start and where loads meet."""
    start = designs.coordinates(designs.theta0)[:, None]
    free, period = designs.half[:, None] == 0.0, designs.period
    count = ceil(FIRST * tolerance ** (-1.0 / NODES)) * round(period / TURN)
    steps = np.arange(count + 1) / count
    if free.all() and not designs.tables:
        return np.asarray(start + period * steps)
    edges = [start, np.where(free, start + period * steps, pi * steps - 0.5 * pi)]
    if designs.tables:
        edges.append(_meeting(designs, start, period))
    every = np.sort(np.concatenate(edges, axis=1), axis=1)
    row, place = np.nonzero(np.diff(every, axis=1, prepend=-np.inf))
    return np.sort(padded(row, every[row, place], len(every), start[:, 0]), axis=1)


def _meeting(designs: Designs, start: Array, period: float) -> Array:
    """The coordinates at which pieces of loads meet; the start in empty places."""
    angles = meeting_angles(designs.tables.values(), period, designs.lengths, designs.branch)
    angles = np.broadcast_to(angles, (len(start), angles.shape[1]))
    with np.errstate(invalid="ignore"):
        ahead = np.remainder(angles - start, period)
        ahead = np.where((ahead > SAME) & (ahead < period - SAME), start + ahead, start)
        middle, half = designs.middle[:, None], designs.half[:, None]
        near = angles + period * np.round((middle - angles) / period)
        every = np.concatenate([near - period, near, near + period], axis=1)
        x = designs.coordinates(every)
        inside = (np.abs(every - middle) < half - SAME) & (np.abs(x - start) > SAME)
    own = np.where(inside, x, start)
    free = half == 0.0
    return np.where(free, np.concatenate([ahead, np.repeat(start, own.shape[1] - ahead.shape[1], 1)], 1), own)


def halved(edges: Array, bad: NDArray[np.int8]) -> Array:
    """Edges with the middles of bad panels among them; panels of no width fill the rows."""
    row, panel = np.nonzero(bad)
    middles = 0.5 * (edges[row, panel] + edges[row, panel + 1])
    return np.sort(np.concatenate([edges, padded(row, middles, len(edges), edges[:, 0])], axis=1), axis=1)
