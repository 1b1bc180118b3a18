"""Many designs in their energy form: panels halved where they must be, one compiled loop, histories."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import NODES
from ..result import FAILED, LIMIT
from .course import accelerations, account
from .loops.compiled import TABLES, motions
from .panels import Designs, Fields, fields_of, first_edges, halved

Array = NDArray[np.float64]
PIECE = 24  # numbers of a piece: see `follow`
TOO_WIDE, NOT_HERE = 10, 11  # statuses of `follow`
ROUNDS = 14  # halvings of a panel
WITHIN = np.array([1e-13, 1e-9])  # rad: from a limit angle
FINEST, COARSEST = 3e-14, 1e-6  # how small the last terms of series must be at least and at most


class FollowedMotions(NamedTuple):
    """Motions at instants, the last of which is their end.

    numbers   end, largest energy residual, work, and the residual that rounding makes
    """

    theta: Array
    omega: Array
    alpha: Array
    status: NDArray[np.int8]
    numbers: Array


class Marched(NamedTuple):
    """Coordinates and their rates at start and instants, as `follow` finds them; ways at the start."""

    x: Array
    speed: Array
    status: NDArray[np.int8]
    numbers: Array
    way: Array


def follow_many(
    designs: Designs, times: Array, rtol: float, most: Array, kept: Array | None = None
) -> FollowedMotions:  # fmt: skip
    """The motions up to the last instant. Status NOT_HERE: the energy form does not serve.

    most   pieces of a motion: an array, which another thread may set to 0
    kept   of one design: room for all of its pieces, as `follow` keeps them; if it is too
           little, status 12
    """
    x, omega, status, numbers, way = _marched(designs, times, rtol, most, kept)
    if (status >= TOO_WIDE).all():
        return FollowedMotions(x[:, 1:], omega[:, 1:], omega[:, 1:], status, numbers[:, :4])
    limit = status == LIMIT
    ended = limit | (status == FAILED)
    x[ended, -1] = numbers[ended, 1]
    theta = x
    places = designs.at_angles(theta)
    at, slope = places.values, places.slope
    if limit.any():
        at[limit, 3:5, -1] = _at_limits(designs.some(limit), theta[limit, -1])
    if designs.tables:
        ways, known = np.where(omega == 0.0, way[:, None], omega * slope), places.known
        designs.add_tables(at[:, 1], theta, at[:, 3], known.get("Y_wrt_theta", theta), ways)
    omega[:, 0] = designs.omega_start
    alpha = accelerations(slope, at, omega)
    told = account(theta, slope, at, designs.loads, numbers, omega, alpha)
    begin = 1 + np.flatnonzero(times == 0.0)  # there pieces have rounded the start
    theta[:, begin], omega[:, begin] = theta[:, :1], omega[:, :1]
    told[:, 0] = np.where(ended, np.minimum(numbers[:, 0], times[-1]), times[-1])
    return FollowedMotions(theta[:, 1:], omega[:, 1:], alpha[:, 1:], status, told)


def _at_limits(designs: Designs, theta: Array) -> Array:
    """Y and potential energy of designs at limit angles, where S = 0.

    At the double next to such an angle Y keeps half of its digits, or is none. But for what the pin moves
    the energy is linear in Y: that of an angle just within the motion is carried on to the true Y.
    """
    inward = np.copysign(1.0, np.nan_to_num(designs.middle) - theta)
    near = designs.values(theta[:, None] + inward[:, None] * WITHIN)
    known, energy = near["Y"], near["potential_energy"]
    by_Y = (energy[:, 1] - energy[:, 0]) / (known[:, 1] - known[:, 0])
    Y = designs.length("AB") * np.cos(theta)
    return np.stack([Y, energy[:, 0] + by_Y * (Y - known[:, 0])], axis=1)


def _marched(
    designs: Designs, times: Array, rtol: float, most: Array, kept: Array | None
) -> Marched:  # fmt: skip
    """The motions in their coordinates; designs whose panels are too wide again, on halves of them."""
    tolerance = min(max(rtol, FINEST), COARSEST)
    edges = first_edges(designs, tolerance)
    found, bad = _tried(designs, edges, times, tolerance, most, kept)
    rows = np.flatnonzero(found.status == TOO_WIDE)
    edges, bad = edges[rows], bad[rows]
    for _ in range(ROUNDS):
        if not rows.size:
            return found
        part, edges = designs.some(rows), halved(edges, bad)
        answer, bad = _tried(part, edges, times, tolerance, most, kept)
        found.x[rows], found.speed[rows] = answer.x, answer.speed
        found.status[rows], found.numbers[rows] = answer.status, answer.numbers
        again = answer.status == TOO_WIDE
        rows, edges, bad = rows[again], edges[again], bad[again]
    found.status[rows] = NOT_HERE
    return found


def _tried(
    designs: Designs, edges: Array, times: Array, tolerance: float, most: Array, kept: Array | None
) -> tuple[Marched, NDArray[np.int8]]:  # fmt: skip
    """The motions on panels between these edges, and the panels that are too wide."""
    fields = fields_of(designs, edges)
    count, inertia = len(fields.edges), fields.inertia[:, 0]
    begin = np.argmax(fields.edges == designs.coordinates(designs.theta0)[:, None], axis=1)
    setup = np.empty((count, 6))
    with np.errstate(over="ignore"):  # a speed beyond every double ends with a status
        setup[:, 0] = energy = 0.5 * inertia * designs.omega_start**2
    setup[:, 1], setup[:, 3] = begin, np.where(designs.half == 0.0, designs.period, 0.0)
    setup[:, 2] = way = _ways(designs, fields, begin)
    setup[:, 4], setup[:, 5] = 0.0 if designs.turns_with_the_slider else 1.0, fields.back
    starts = np.isfinite(energy) & (inertia > 0.0) & (np.abs(way) == 1.0)
    status = np.where(starts, 0, NOT_HERE).astype(np.int8)
    bad = np.zeros((count, fields.rough.shape[1]), np.int8)
    x, speeds, numbers = (np.empty((count, n)) for n in (1 + times.size, 1 + times.size, 6))
    outs = x, speeds, status, bad, numbers
    pieces = np.empty((times.size + 1, PIECE)) if kept is None else kept
    pieces[:, 0] = np.nan  # of a row without a piece
    room = pieces[None], np.empty((1, times.size), np.int64)
    panels, how = (
        (fields.edges, fields.rough, fields.at.values),
        np.array([tolerance, kept is not None], float),
    )
    motions()(*panels, setup, times, how, most, *TABLES, *buffers(times.size, bad), *room, *outs)
    return Marched(x, speeds, status, numbers, way), bad


def buffers(instants: int, panels: NDArray[np.int8]) -> tuple[Array, Array, Array]:
    """The buffers of `motions`."""
    count = panels.shape[1]
    return np.empty((22, instants)), np.empty((2, count, 17)), np.empty((2, count))


def _ways(designs: Designs, fields: Fields, begin: NDArray[np.intp]) -> Array:
    """The ways in which designs set out, 1 or -1; another number where the energy form does not know."""
    speed, (forth, back) = designs.omega_start, fields.pushes
    rest = np.where(forth[:, 0] > 0.0, 1.0, np.where(back[:, 0] < 0.0, -1.0, 0.0))
    if designs.tables:  # a load may jump at the start: what is ahead decides
        row, count = np.arange(len(begin)), fields.rough.shape[1]
        edges = fields.edges
        last = (edges <= edges[row, begin][:, None]).sum(axis=1) - 1  # behind panels of no width
        ahead = forth[row, 1 + NODES * np.minimum(last, count - 1)]
        behind = back[row, NODES * np.where(begin > 0, begin, count)]
        rest[((rest > 0.0) & ~(ahead > 0.0)) | ((rest < 0.0) & ~(behind < 0.0))] = 0.0
    return np.where(speed == 0.0, rest, np.copysign(1.0, speed))
