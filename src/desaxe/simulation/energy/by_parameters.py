"""The derivatives of inertia, torque and start of many designs by parameters, and those of their motions."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.load import Load, OverTheta, OverY
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ...support.panels import ENDS, NODES, nodes_of
from ..result import FAILED, LIMIT
from .compiled import TABLES, kernel, variations
from .panels import Designs, Fields

Array = NDArray[np.float64]
STARTS = ("theta0", "omega_start", "torque")  # parameters that are no inputs of the mechanism
DEAD = 1e-6  # of the crank: dY/dtheta next to a dead centre, where a load that jumps does no work
PIECE = 43  # numbers of a piece: see `follow`
ROOM, MORE_ROOM, FULL = 64, 8, 12  # pieces of a motion; the status of `follow` without room for more
ENERGIES = ("M_eff", "T_in", "potential_energy")


class Arcs(NamedTuple):
    """The slopes by a parameter of middle and half of the arc between limit angles; 0 where there is none."""

    middle: Array
    half: Array

    def angle(self, sine: Array) -> Array:
        """The slope of the crank angle at a fixed coordinate, whose sine is given."""
        return self.middle[:, None] + self.half[:, None] * sine


def arcs(designs: Designs, parameter: str) -> Arcs:
    """The slopes of the arcs: at a limit ec + AB sin(theta) = BC or -BC."""
    if parameter not in LENGTHS or not designs.half.any():
        return Arcs(np.zeros(len(designs.theta0)), np.zeros(len(designs.theta0)))
    ec, AB, _ = designs.lengths
    slopes = []
    for theta in (designs.middle - designs.half, designs.middle + designs.half):
        side, sine = np.copysign(1.0, ec + AB * np.sin(theta)), np.sin(theta)
        with np.errstate(divide="ignore", invalid="ignore"):
            moved: Array = {"ec": -np.ones_like(sine), "AB": -sine, "BC": side}[parameter]
            slope = moved / (AB * np.cos(theta))
        slopes.append(np.where(designs.half == 0.0, 0.0, slope))
    return Arcs(0.5 * (slopes[0] + slopes[1]), 0.5 * (slopes[1] - slopes[0]))


class Derived(NamedTuple):
    """Derivatives of fields at a fixed coordinate: rows of designs and parameters (see `varied`).

    potential  energy at the start and, last, at the limit angle of each way
    """

    bend: Array
    inertia: Array
    push: Array
    back: Array
    jumps: Array
    begin: Array
    potential: Array


class Sensitivities(NamedTuple):
    """Derivatives of motions: rows of designs and parameters.

    out    x_p, x'_p + x'' tau, tau at each instant
    ends   tau and energy at a limit angle; both energies at the start, and potential energy at both limits
    """

    out: Array
    ends: Array


def names_of(designs: Designs) -> list[str]:
    """The derivatives that are needed."""
    inputs = [p for p in designs.wrt if p not in STARTS]
    names = [f"{name}_wrt_{p}" for name in ENERGIES for p in inputs]
    names += ["T_in_wrt_theta", "potential_energy_wrt_theta"]
    if isinstance(designs.force, Load):
        names += ["Y_wrt_theta_theta", *(f"Y_wrt{by}{p}" for p in LENGTHS for by in ("_", "_theta_"))]
    return names


class Pushed:
    """Torque and load of designs at angles, their slopes, and what they do at their jumps."""

    def __init__(self, designs: Designs, theta: Array, found: Mapping[str, Array], way: float) -> None:
        self.designs, self.found, self.force = designs, found, designs.force
        self.torque, self.torque_slope = np.zeros(theta.shape), np.zeros(theta.shape)
        self.load, self.load_slope = self.torque, self.torque
        if isinstance(designs.torque, OverTheta):
            self.torque, self.torque_slope = (np.asarray(v) for v in designs.torque.both(theta))
        if isinstance(self.force, OverTheta):
            self.load, self.load_slope = (np.asarray(v) for v in self.force.both(theta))
        elif isinstance(self.force, OverY):
            self.motion = dict(found)
            if self.force.centre:
                names = self.force.centre, *(f"{self.force.centre}_wrt_{p}" for p in LENGTHS)
                form = closed_form(DEAD_CENTRES, names, branch=float(designs.branch))
                zeros = form.arrays(*designs.lengths)
                self.motion |= {n: values[:, None] for n, values in zip(names, zeros, strict=True)}
            self.load, slope = self.force.both(self.force.along(self.motion), way * found["Y_wrt_theta"])
            self.slope = slope
            self.load_slope = slope * self.force.moved("theta", self.motion)

    def by_theta(self) -> Array:
        """The slope of the generalised torque by the crank angle."""
        found = self.found
        push = self.torque_slope - found["T_in_wrt_theta"]
        if isinstance(self.force, Load):
            push = push + self.load_slope * found["Y_wrt_theta"] + self.load * found["Y_wrt_theta_theta"]
        return np.asarray(push)

    def by(self, parameter: str) -> Any:
        """The slope of the generalised torque by a parameter at a fixed crank angle."""
        if parameter in STARTS:
            return 1.0 if parameter == "torque" else 0.0
        found, push = self.found, -self.found[f"T_in_wrt_{parameter}"]
        if isinstance(self.force, Load) and parameter in LENGTHS:
            push = push + self.load * found[f"Y_wrt_theta_{parameter}"]
            if isinstance(self.force, OverY):
                push += self.slope * self.force.moved(parameter, self.motion) * found["Y_wrt_theta"]
        return push

    def jumps(self, parameter: str, angle: Array) -> Array:
        """By how much the energy's slope jumps before each panel; angle: that of the crank angle."""
        found = self.found
        jumps = _before(self.torque)[0] * _before(angle)[1]
        if isinstance(self.force, OverTheta):
            jumps += _before(self.load)[0] * _before(found["Y_wrt_theta"] * angle)[1]
        elif isinstance(self.force, OverY):
            moved = np.zeros(angle.shape)
            if parameter in LENGTHS:
                moved = found[f"Y_wrt_{parameter}"] + found["Y_wrt_theta"] * angle
                if self.force.centre:
                    moved = moved - self.motion[f"{self.force.centre}_wrt_{parameter}"]
            step, _ = _before(self.load)
            _, speed = _before(found["Y_wrt_theta"])
            dead = np.abs(speed) < DEAD * self.designs.length("AB")[:, None]
            jumps += np.where(dead, 0.0, step * _before(moved)[1])
        return jumps


def _before(values: Array) -> tuple[Array, Array]:
    """The jump of values before each panel, and the value where it begins."""
    ends = values[:, 1:].reshape(len(values), -1, NODES) @ ENDS.T
    return ends[..., 0] - np.roll(ends[..., 1], 1, axis=1), ends[..., 0]


def places_of(designs: Designs, edges: Array) -> tuple[Array, Array, Any]:
    """The coordinates of the start and of all nodes, the angles there, and their slope."""
    x = np.empty((len(edges), 1 + NODES * (edges.shape[1] - 1)))
    x[:, 0] = designs.coordinates(designs.theta0)
    x[:, 1:] = nodes_of(edges[:, :-1], edges[:, 1:]).reshape(len(edges), -1)
    theta, slope = designs.place(x)
    if theta is not x:
        theta[:, 0] = designs.theta0
    return x, theta, slope


def derived_of(designs: Designs, fields: Fields) -> Derived:
    """The derivatives of the fields of designs."""
    x, theta, slope = places_of(designs, fields.edges)
    found = {**designs.values(theta), **designs.values(theta, names_of(designs))}
    count, nodes, rocks = len(x), x.shape[1] - 1, bool(designs.half.any())
    ways = [1.0, -1.0] if designs.turns_with_the_slider else [1.0]
    pushed = [Pushed(designs, theta, found, way) for way in ways]
    shape = count, len(designs.wrt), nodes
    inertia, begin = np.empty(shape), np.empty((*shape[:2], 5))
    push, potential = [np.empty(shape) for _ in ways], np.zeros((*shape[:2], 3))
    jumps = np.zeros((count, 2, len(designs.wrt), nodes // NODES))
    none, sine = np.zeros((1, nodes + 1)), np.sin(x) if rocks else x
    with np.errstate(divide="ignore", invalid="ignore"):
        for k, p in enumerate(designs.wrt):
            arc, angle = arcs(designs, p), none
            of_M = found.get(f"M_eff_wrt_{p}", none)
            every = [of_M, *(own.by(p) + none for own in pushed)]
            if rocks:
                angle, share = arc.angle(sine), np.where(designs.half == 0.0, 0.0, arc.half / designs.half)
                every[0] = (of_M + found["M_eff_wrt_theta"] * angle) * slope * slope
                every[0] += 2.0 * fields.inertia * share[:, None]
                for way, (own, pushes) in enumerate(zip(pushed, fields.pushes, strict=False)):
                    every[1 + way] = (every[1 + way] + own.by_theta() * angle) * slope + pushes * share[
                        :, None
                    ]
                potential[:, k, 1:] = _at_limits(found, p, angle, np.diff(fields.edges) > 0.0)
            for column, values in zip((inertia, *push), every, strict=True):
                column[:, k] = values[:, 1:]
            for way, own in enumerate(pushed if designs.tables else ()):
                jumps[:, way, k] = own.jumps(p, np.broadcast_to(angle, theta.shape))
            begin[:, k] = _begin(designs, p, arc, x[:, 0], found).T
            by_p, by_theta = found.get(f"potential_energy_wrt_{p}", none), found["potential_energy_wrt_theta"]
            potential[:, k, 0] = by_p[:, 0] + by_theta[:, 0] * float(p == "theta0")
        bend = found["M_eff_wrt_theta"]
        if rocks:
            turn = np.where(designs.half[:, None] == 0.0, 0.0, np.tan(x))
            bend = bend * slope**3 - 2.0 * fields.inertia * turn
    if len(ways) == 1:
        jumps[:, 1] = jumps[:, 0]
    return Derived(np.ascontiguousarray(bend), inertia, push[0], push[-1], jumps, begin, potential)


def _at_limits(found: Mapping[str, Array], p: str, angle: Array, wide: NDArray[np.bool_]) -> Array:
    """The derivative of potential energy at a fixed coordinate at both limit angles.

    From the first and the last panel that have a width: Y_theta is infinite there.
    """
    at_nodes = found.get(f"potential_energy_wrt_{p}", 0.0) + found["potential_energy_wrt_theta"] * angle
    panels, rows = at_nodes[:, 1:].reshape(*wide.shape, NODES), np.arange(len(wide))
    first, last = np.argmax(wide, axis=1), wide.shape[1] - 1 - np.argmax(wide[:, ::-1], axis=1)
    return np.stack([panels[rows, first] @ ENDS[0], panels[rows, last] @ ENDS[1]], axis=1)


def _begin(designs: Designs, p: str, arc: Arcs, x: Array, found: Mapping[str, Array]) -> Array:
    """The rows of `begin` (see `varied`), of one parameter."""
    half, omega = designs.half, designs.omega_start
    theta_p, omega_p = float(p == "theta0"), float(p == "omega_start")
    by = np.broadcast_to(found.get(f"M_eff_wrt_{p}", 0.0), found["M_eff"].shape)[:, 0]
    of_M = by + found["M_eff_wrt_theta"][:, 0] * theta_p
    energy = 0.5 * omega * omega * of_M + found["M_eff"][:, 0] * omega * omega_p
    slope = np.where(half == 0.0, 1.0, half * np.cos(x))
    place = (theta_p - arc.middle - arc.half * np.sin(x)) / slope
    steeper = arc.half * np.cos(x) - half * np.sin(x) * place
    speed = omega / slope
    return np.stack([place, (omega_p - steeper * speed) / slope, energy, speed, np.zeros(len(x))])


def sensitivities_of(
    designs: Designs, fields: Fields, setup: Array, times: Array, tolerance: float, most: Array,
    outs: Sequence[Any], last: bool,
) -> Sensitivities:  # fmt: skip
    """Follow motions on these panels, and their derivatives.

    outs   as `follow` fills them in: the status is that of too wide panels where they are for derivatives
    last   to take derivatives as resolved, whatever they look like
    """
    own = derived_of(designs, fields)
    count, parameters = own.begin.shape[:2]
    out, ends = np.empty((count, parameters, 3, times.size)), np.empty((count, parameters, 2))
    scale = np.stack([np.abs(v).max(axis=2, initial=0.0) for v in (own.inertia, own.push)], axis=2)
    if last:
        scale[:] = np.inf
    panels = fields.edges, fields.rough, np.ascontiguousarray(fields.inertia)
    pushes = (np.ascontiguousarray(push) for push in fields.pushes)
    derived = *panels, *pushes, own.bend, own.inertia, own.push, own.back, own.jumps, own.begin, scale
    tables = bool(designs.tables)
    how = np.array([tolerance, 2.0 if tables else 1.0, tolerance, float(tables)])
    left, room = [slice(0, count)], ROOM + times.size
    while left:
        rows = left.pop()
        size, (x, speeds, status, bad, numbers) = rows.stop - rows.start, (array[rows] for array in outs)
        kept, where = np.empty((size, room, PIECE)), np.empty((size, 2, times.size))
        followed = kept, np.empty((size, times.size), np.int64), where
        begin = fields.edges[rows], fields.rough[rows], fields.values[rows], setup[rows], times, how, most
        kernel()(*begin, *TABLES, *followed, x, speeds, status, bad, numbers)
        given = *(array[rows] for array in derived), how, *TABLES, *followed
        variations()(*given, out[rows], ends[rows], status, bad, numbers)
        full = np.flatnonzero(status == FULL)
        if full.size:  # each alone, with more room
            status[full] = 0
            left += [slice(rows.start + row, rows.start + row + 1) for row in full.tolist()]
            room *= MORE_ROOM
    whole = np.concatenate([ends, own.potential], axis=2)
    whole[:, :, 2] += own.begin[:, :, 2]
    return Sensitivities(out, whole)


class Histories(NamedTuple):
    """The derivatives of histories, of the end and of the work: designs, parameters, instants."""

    theta: Array
    omega: Array
    t_last: Array
    work: Array


def histories_of(
    designs: Designs, own: Sensitivities, x: Array, speed: Array, motion: Mapping[str, Array],
    status: NDArray[np.int8],
) -> Histories:  # fmt: skip
    """The derivatives of motions whose coordinates and their rates are given.

    motion   theta, omega, alpha and, at the angles, M_eff and M_eff_wrt_theta
    """
    place, rate, tau = (own.out[:, :, k] for k in range(3))
    if designs.half.any():
        theta, omega = np.empty(place.shape), np.empty(place.shape)
        half = np.where(designs.half == 0.0, 0.0, designs.half)[:, None]
        sine, cosine = np.sin(x), np.cos(x)
        slope = np.where(half == 0.0, 1.0, half * cosine)
        for k, p in enumerate(designs.wrt):
            arc = arcs(designs, p)
            theta[:, k] = arc.angle(sine) + slope * place[:, k]
            moved = place[:, k] + speed * tau[:, k]
            steeper = arc.half[:, None] * cosine - half * sine * moved
            omega[:, k] = steeper * speed + slope * rate[:, k]
    else:
        theta, omega = place, rate
    omega = omega - motion["alpha"][:, None] * tau
    limit = status == LIMIT
    t_last = np.where(limit[:, None], own.ends[..., 0], 0.0)
    t_last[status == FAILED] = np.nan
    work = _energies(designs, motion, theta[..., -1], omega[..., -1])
    far = np.where(x[:, -1:] > 0.0, own.ends[..., 4], own.ends[..., 3])
    work = np.where(limit[:, None], own.ends[..., 1] + far, work) - own.ends[..., 2]
    work[status == FAILED] = np.nan
    return Histories(theta, omega, t_last, work)


def _energies(designs: Designs, motion: Mapping[str, Array], theta_p: Array, omega_p: Array) -> Array:
    """The derivatives of kinetic and potential energy at the last instant."""
    theta = np.repeat(np.nan_to_num(motion["theta"][:, -1:]), 2, axis=1)  # without an end none is read
    found = {name: values[:, 0] for name, values in designs.values(theta, names_of(designs)).items()}
    omega, inertia, bend = (motion[n][:, -1] for n in ("omega", "M_eff", "M_eff_wrt_theta"))
    rows = []
    for k, p in enumerate(designs.wrt):
        of_M = found.get(f"M_eff_wrt_{p}", 0.0) + bend * theta_p[:, k]
        of_V = found.get(f"potential_energy_wrt_{p}", 0.0)
        of_V = of_V + found["potential_energy_wrt_theta"] * theta_p[:, k]
        rows.append(inertia * omega * omega_p[:, k] + 0.5 * omega * omega * of_M + of_V)
    return np.stack(rows, axis=1)
