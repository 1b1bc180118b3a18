"""Many designs in their energy form: panels halved where they must be, one compiled loop, histories."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import NODES
from ..residual import ROUNDED
from ..result import FAILED, LIMIT
from .by_parameters import Histories, Sensitivities, histories_of, sensitivities_of
from .compiled import TABLES, kernel
from .panels import Designs, Fields, fields_of, first_edges, halved

Array = NDArray[np.float64]
PIECE = 24  # numbers of a piece: see `follow`
TOO_WIDE, NOT_HERE = 10, 11  # statuses of `follow`
ROUNDS = 14  # halvings of a panel
RESOLVED = 4  # after so many what is left of derivatives by parameters is rounding
WITHIN = np.array([1e-13, 1e-9])  # rad: from a limit angle
LOST_DIGITS = 0.03  # of dtheta/dx at most: of angles so near to a limit angle
FINEST, COARSEST = 3e-14, 1e-6  # how small the last terms of series must be at least and at most


class Found(NamedTuple):
    """Motions at instants, the last of which is their end.

    numbers   end, largest energy residual, work, and the residual that rounding makes
    """

    theta: Array
    omega: Array
    alpha: Array
    status: NDArray[np.int8]
    numbers: Array
    by: Histories | None = None


class Marched(NamedTuple):
    """The answer of `follow`: coordinates and their rates at instants, status and numbers; what starts."""

    x: Array
    speed: Array
    status: NDArray[np.int8]
    numbers: Array
    start: dict[str, Array]
    by: Sensitivities | None = None


def follow_many(designs: Designs, times: Array, rtol: float, most: Array) -> Found:
    """The motions up to the last instant. Status NOT_HERE: the energy form does not serve.

    most   pieces of a motion: an array, which another thread may set to 0
    """
    x, speed, status, numbers, start, by = _marched(designs, times, rtol, most)
    if (status >= TOO_WIDE).all():
        return Found(x, speed, speed, status, numbers[:, :4])
    limit, short = status == LIMIT, status == FAILED
    ended = limit | short
    t_last = np.where(ended, np.minimum(numbers[:, 0], times[-1]), times[-1])
    x[ended, -1] = numbers[ended, 1]
    theta, slope = designs.place(x)
    at, omega = designs.values(theta), speed * slope
    inertia, slider = at["M_eff"], at["Y"]
    if limit.any():
        ends = _at_limits(designs.some(limit), theta[limit, -1])
        slider[limit, -1], at["potential_energy"][limit, -1] = ends
    half_square = 0.5 * omega * omega
    with np.errstate(invalid="ignore"):
        push = designs.push(theta, at, np.where(omega == 0.0, start["way"][:, None], omega))
    alpha = (push - at["M_eff_wrt_theta"] * half_square) / inertia
    first = 0.5 * start["M_eff"] * designs.omega_start**2
    kinetic = inertia * half_square
    if designs.tables:
        # Of instants within the motion that of the end alone is known by itself.
        work = kinetic + at["potential_energy"] - (first + start["potential_energy"])[:, None]
        work[:, -1] = numbers[:, 2] - first + at["potential_energy"][:, -1] - start["potential_energy"]
    else:
        work = designs.torque[:, None] * (theta - designs.theta0[:, None])
        if designs.force.any():
            work += designs.force[:, None] * (slider - start["Y"][:, None])
    largest = np.fmax(np.fmax.reduce(kinetic, axis=1), first)
    energy = kinetic + at["potential_energy"]
    initial = first + start["potential_energy"]
    heaviest = np.fmax(np.fmax.reduce(np.abs(energy), axis=1), np.abs(initial))
    energy -= work
    energy -= initial[:, None]
    if designs.half.any():  # next to a limit angle M_eff has lost the digits that would tell
        energy[np.abs(slope) < LOST_DIGITS * designs.half[:, None]] = 0.0
    off = np.fmax.reduce(np.abs(energy), axis=1)
    turned = np.nansum(np.abs(np.diff(work, axis=1, prepend=0.0)), axis=1)
    scale = np.maximum(largest, turned)
    still = ~(scale > 0.0)
    scale[still] = 1.0
    rounded = np.where(still, np.inf, ROUNDED * numbers[:, 5] * (1.0 + heaviest / scale))
    told = np.stack([t_last, np.where(still, 0.0, off / scale), work[:, -1], rounded], axis=1)
    found = Found(theta, omega, alpha, status, told)
    if by is None:
        return found
    motion = {"theta": theta, "omega": omega, "alpha": alpha, **at}
    return found._replace(by=histories_of(designs, by, x, speed, motion, status))


def _at_limits(designs: Designs, theta: Array) -> tuple[Array, Array]:
    """Y and potential energy of designs at limit angles, where S = 0.

    At the double next to such an angle Y keeps half of its digits, or is none. But for what the pin moves
    the energy is linear in Y: that of an angle just within the motion is carried on to the true Y.
    """
    inward = np.copysign(1.0, np.nan_to_num(designs.middle) - theta)
    near = designs.values(theta[:, None] + inward[:, None] * WITHIN)
    known, energy = near["Y"], near["potential_energy"]
    by_Y = (energy[:, 1] - energy[:, 0]) / (known[:, 1] - known[:, 0])
    Y = designs.length("AB") * np.cos(theta)
    return Y, energy[:, 0] + by_Y * (Y - known[:, 0])


def _marched(designs: Designs, times: Array, rtol: float, most: Array) -> Marched:
    """The motions in their coordinates; designs whose panels are too wide again, on halves of them."""
    tolerance = min(max(rtol, FINEST), COARSEST)
    edges = first_edges(designs, tolerance)
    found, bad = _tried(designs, edges, times, tolerance, most, False)
    rows = np.flatnonzero(found.status == TOO_WIDE)
    edges, bad = edges[rows], bad[rows]
    for halving in range(ROUNDS):
        if not rows.size:
            return found
        part, edges = designs.some(rows), halved(edges, bad)
        answer, bad = _tried(part, edges, times, tolerance, most, halving >= RESOLVED)
        found.x[rows], found.speed[rows] = answer.x, answer.speed
        found.status[rows], found.numbers[rows] = answer.status, answer.numbers
        for name, values in answer.start.items():
            found.start[name][rows] = values
        for own, values in zip(found.by or (), answer.by or (), strict=True):
            own[rows] = values
        again = answer.status == TOO_WIDE
        rows, edges, bad = rows[again], edges[again], bad[again]
    found.status[rows] = NOT_HERE
    return found


def _tried(
    designs: Designs, edges: Array, times: Array, tolerance: float, most: Array, last: bool
) -> tuple[Marched, NDArray[np.int8]]:
    """The motions on panels between these edges, and the panels that are too wide.

    last   to take derivatives by parameters as resolved
    """
    fields = fields_of(designs, edges)
    count, start = len(fields.edges), fields.start
    begin = np.argmax(fields.edges == designs.coordinates(designs.theta0)[:, None], axis=1)
    start["way"] = way = _ways(designs, fields, begin)
    energy = 0.5 * start["M_eff"] * designs.omega_start**2
    period = np.where(designs.half == 0.0, designs.period, 0.0)
    same = np.full(count, 0.0 if designs.turns_with_the_slider else 1.0)
    setup = np.stack([energy, begin, way, period, same], axis=1)
    starts = np.isfinite(energy) & (start["M_eff"] > 0.0) & (np.abs(way) == 1.0)
    status = np.where(starts, 0, NOT_HERE).astype(np.int8)
    bad, kept = np.zeros((count, fields.rough.shape[1]), np.int8), np.empty((times.size + 1, PIECE))
    x, speeds, numbers = np.empty((count, times.size)), np.empty((count, times.size)), np.empty((count, 6))
    panels = fields.edges, fields.rough, fields.inertia, fields.push, fields.back
    outs = kept, x, speeds, status, bad, numbers
    kernel()(*panels, setup, times, np.array([tolerance, 0.0]), most, *TABLES, *outs)
    by = None
    if designs.wrt:
        by = sensitivities_of(designs, fields, setup, times, tolerance, most, status, bad, last)
    return Marched(x, speeds, status, numbers, fields.start, by), bad


def _ways(designs: Designs, fields: Fields, begin: NDArray[np.intp]) -> Array:
    """The ways in which designs set out, 1 or -1; another number where the energy form does not know."""
    speed, start = designs.omega_start, fields.start
    rest = np.where(start["push"] > 0.0, 1.0, np.where(start["back"] < 0.0, -1.0, 0.0))
    if designs.tables:  # a load may jump at the start: what is ahead decides
        row, count = np.arange(len(begin)), fields.rough.shape[1]
        edges = fields.edges
        last = (edges <= edges[row, begin][:, None]).sum(axis=1) - 1  # behind panels of no width
        ahead = fields.push[row, 1 + NODES * np.minimum(last, count - 1)]
        behind = fields.back[row, NODES * np.where(begin > 0, begin, count)]
        rest[((rest > 0.0) & ~(ahead > 0.0)) | ((rest < 0.0) & ~(behind < 0.0))] = 0.0
    return np.where(speed == 0.0, rest, np.copysign(1.0, speed))
