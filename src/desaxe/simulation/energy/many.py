"""Many designs in their energy form: panels halved where they must be, one compiled loop, histories."""

from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..residual import ROUNDED
from ..result import FAILED, LIMIT
from .compiled import TABLES, kernel
from .panels import Designs, Fields, fields_of, first_edges, halved

Array = NDArray[np.float64]
PIECE = 24  # numbers of a piece: see `follow`
TOO_WIDE, NOT_HERE = 10, 11  # statuses of `follow`
ROUNDS = 14  # halvings of a panel
SHARE, FINEST, COARSEST = 0.1, 3e-14, 1e-9  # of rtol: how small the last terms of series must be


class Found(NamedTuple):
    """Motions at instants, the last of which is their end.

    numbers   end, largest energy residual, work, and the residual that rounding makes
    """

    theta: Array
    omega: Array
    alpha: Array
    status: NDArray[np.int8]
    numbers: Array


class Marched(NamedTuple):
    """The answer of `follow`: coordinates and their rates at instants, status and numbers."""

    x: Array
    speed: Array
    status: NDArray[np.int8]
    numbers: Array


def follow_many(designs: Designs, times: Array, rtol: float, most: Array) -> Found:
    """The motions up to the last instant. Status NOT_HERE: the energy form does not serve.

    most   pieces of a motion: an array, which another thread may set to 0
    """
    found = _marched(designs, times, rtol, most)
    x, speed, status, numbers = found
    limit, short = status == LIMIT, status == FAILED
    ends = np.where(limit | short, numbers[:, 1], x[:, -1])
    t_last = np.where(limit | short, numbers[:, 0], times[-1])
    places = np.concatenate([designs.coordinates()[:, None], x[:, :-1], ends[:, None]], axis=1)
    theta, slope = designs.place(places)
    at = designs.values(np.concatenate([designs.theta0[:, None], theta[:, 1:]], axis=1))
    slider = at["Y"]
    # There S = 0, of which Y would keep half its digits only.
    slider[limit, -1] = (designs.length("AB") * np.cos(theta[:, -1]))[limit]
    omega = speed * (slope[:, 1:] if designs.half.any() else 1.0)
    push = designs.torque[:, None] - at["T_in"][:, 1:]
    alpha = (push - 0.5 * at["M_eff_wrt_theta"][:, 1:] * omega * omega) / at["M_eff"][:, 1:]
    work = designs.torque[:, None] * (theta - designs.theta0[:, None])
    work += designs.force[:, None] * (slider - slider[:, :1])
    first = 0.5 * at["M_eff"][:, 0] * designs.omega_start**2
    kinetic = np.concatenate([first[:, None], 0.5 * at["M_eff"][:, 1:] * omega * omega], axis=1)
    energy = kinetic + at["potential_energy"]
    off = np.fmax.reduce(np.abs(energy - work - energy[:, :1]), axis=1)
    turned = np.nansum(np.abs(np.diff(work, axis=1)), axis=1)
    scale = np.maximum(np.fmax.reduce(kinetic, axis=1), turned)
    heaviest = np.fmax.reduce(np.abs(energy), axis=1)
    still = ~(scale > 0.0)
    scale = np.where(still, 1.0, scale)
    rounded = np.where(still, np.inf, ROUNDED * numbers[:, 5] * (1.0 + heaviest / scale))
    told = np.stack([t_last, np.where(still, 0.0, off / scale), work[:, -1], rounded], axis=1)
    return Found(theta[:, 1:], omega, alpha, status, told)


def _marched(designs: Designs, times: Array, rtol: float, most: Array) -> Marched:
    """The motions in their coordinates; designs whose panels are too wide again, on halves of them."""
    count = len(designs.theta0)
    found = Marched(
        np.full((count, times.size), np.nan),
        np.full((count, times.size), np.nan),
        np.full(count, NOT_HERE, np.int8),
        np.full((count, 6), np.nan),
    )
    rows, edges = np.arange(count), first_edges(designs)
    tolerance = min(max(SHARE * rtol, FINEST), COARSEST)
    for _ in range(ROUNDS):
        if not rows.size:
            break
        part = designs.some(rows)
        answer, bad = _tried(part, fields_of(part, edges), times, tolerance, most)
        good, again = answer.status < TOO_WIDE, answer.status == TOO_WIDE
        found.x[rows[good]], found.speed[rows[good]] = answer.x[good], answer.speed[good]
        found.status[rows[good]], found.numbers[rows[good]] = answer.status[good], answer.numbers[good]
        rows, edges = rows[again], halved(edges[again], bad[again])
    return found


def _tried(
    designs: Designs, fields: Fields, times: Array, tolerance: float, most: Array
) -> tuple[Marched, NDArray[np.int8]]:
    """The motions on these panels, and the panels that are too wide."""
    count, width = fields.inertia.shape[:2]
    speed, push = designs.omega_start, fields.first_push
    way = np.where(speed == 0.0, np.sign(push), np.copysign(1.0, speed))
    energy = 0.5 * fields.first_inertia * speed**2
    begin = np.argmax(fields.edges == designs.coordinates()[:, None], axis=1)
    period = np.where(designs.half == 0.0, 2.0 * pi, 0.0)
    setup = np.stack([energy, begin, way, period, np.ones(count)], axis=1)
    status, bad = np.full(count, NOT_HERE, np.int8), np.zeros((count, width), np.int8)
    answer = Marched(
        np.full((count, times.size), np.nan), np.full((count, times.size), np.nan), status,
        np.full((count, 6), np.nan),
    )  # fmt: skip
    starts = np.isfinite(energy) & (fields.first_inertia > 0.0) & np.isin(way, (-1.0, 1.0))
    status[starts] = 0
    kept = np.empty((times.size + 1, PIECE))
    how = np.array([tolerance, 0.0])
    panels = fields.edges, fields.rough, fields.inertia, fields.push, fields.push
    kernel()(
        *panels, setup, times, how, most, *TABLES, kept, answer.x, answer.speed, status, bad, answer.numbers
    )
    return answer, bad
