"""Derivatives of motions by parameters: those of their fields and their start, and the compiled loops."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import ENDS, NODES
from .loops.compiled import TABLES, motions, variations
from .panels import STARTS, Designs, Fields
from .pushed import Pushed, arcs

Array = NDArray[np.float64]
PIECE = 43  # numbers of a piece: see `follow`
ROOM, MORE_ROOM, FULL = 64, 8, 12  # pieces of a motion; the status of `follow` without room for more
NONE = -1  # the row of a derivative that is 0


class Derived(NamedTuple):
    """Derivatives of fields at a fixed coordinate, in rows of the fields (see `varied`).

    rows        a row per parameter: that of M_p, of Q_p forth and of Q_p back
    potential   energy of designs by parameters at the start and, last, at the limit angle of each way
    """

    rows: NDArray[np.int64]
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


def derived_of(designs: Designs, fields: Fields) -> Derived:
    """The derivatives of the fields of designs, which take the places of those at a fixed angle."""
    known, wrt = fields.at.known, designs.wrt
    count, panels = fields.rough.shape
    rows, free = _rows(designs, fields), bool(designs.half.any())
    jumps, potential = np.zeros((count, 2, len(wrt), panels)), np.zeros((count, len(wrt), 3))
    for k, p in enumerate(wrt):
        if p not in STARTS:
            potential[:, k, 0] = known[f"potential_energy_wrt_{p}"][:, 0]
        elif p == "theta0":
            potential[:, k, 0] = known["potential_energy_wrt_theta"][:, 0]
    begin = _begin(designs, known)
    if free or designs.tables:
        _to_coordinates(designs, fields, rows, jumps, potential)
    else:
        values = fields.at.values
        for k, p in enumerate(wrt):
            if p == "torque":
                values[:, rows[k, 1]] = 1.0
            elif p not in STARTS:
                np.negative(values[:, rows[k, 1]], out=values[:, rows[k, 1]])
    return Derived(rows, jumps, begin, potential)


def _rows(designs: Designs, fields: Fields) -> NDArray[np.int64]:
    """The rows of `Derived`; those on the way back are others where loads are tables."""
    names, more, loaded = fields.at.names, fields.more, fields.back != 1
    rows = np.full((len(designs.wrt), 3), NONE, np.int64)
    for k, p in enumerate(designs.wrt):
        if p not in STARTS:
            rows[k] = names.index(f"M_eff_wrt_{p}"), *(names.index(f"T_in_wrt_{p}"),) * 2
        elif p == "torque":
            rows[k, 1:] = more + loaded * len(designs.wrt)
        if loaded and rows[k, 1] != NONE:
            rows[k, 2] = more + k
    return rows


def _to_coordinates(
    designs: Designs, fields: Fields, rows: NDArray[np.int64], jumps: Array, potential: Array
) -> None:
    """Put the derivatives at a fixed coordinate, of which limit angles move, in the place of the others."""
    known, values, slope = fields.at.known, fields.at.values, fields.at.slope
    ways = [1.0, -1.0] if fields.back != 1 else [1.0]
    pushed = [Pushed(designs, fields.theta, known, way) for way in ways]
    half, middle = designs.half[:, None], np.nan_to_num(designs.middle)[:, None]
    rocks, none = half != 0.0, np.zeros((1, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        sine = np.where(rocks, (fields.theta - middle) / half, 0.0)
        for k, p in enumerate(designs.wrt):
            arc = arcs(designs, p)
            angle, share = arc.angle(sine), np.where(rocks, arc.half[:, None] / half, 0.0)
            if p not in STARTS and rocks.any():
                potential[:, k, 1:] = _at_limits(known, p, angle, np.diff(fields.edges) > 0.0)
            of_M = known.get(f"M_eff_wrt_{p}", none) + known["M_eff_wrt_theta"] * angle
            of_Q = [
                (own.by(p) + own.by_theta() * angle) * slope + push * share
                for own, push in zip(pushed, fields.pushes, strict=False)
            ]
            for way in (0, 1) if designs.tables else ():
                jumps[:, way, k] = pushed[way % len(ways)].jumps(p, np.broadcast_to(angle, slope.shape))
            if rows[k, 0] != NONE:
                values[:, rows[k, 0]] = of_M * slope * slope + 2.0 * fields.inertia * share
            for way, own_Q in enumerate(of_Q):
                if rows[k, 1 + way] != NONE:
                    values[:, rows[k, 1 + way]] = own_Q
        bend = known["M_eff_wrt_theta"]
        turn = np.where(rocks, -half * sine / slope, 0.0)  # the slope of the slope, of the slope
        bend[:] = np.where(rocks, bend * slope**3 + 2.0 * fields.inertia * turn, bend)


def _at_limits(found: Mapping[str, Array], p: str, angle: Array, wide: NDArray[np.bool_]) -> Array:
    """The derivative of potential energy at a fixed coordinate at both limit angles.

    From the first and the last panel that have a width: Y_theta is infinite there.
    """
    at_nodes = found.get(f"potential_energy_wrt_{p}", 0.0) + found["potential_energy_wrt_theta"] * angle
    panels, rows = at_nodes[:, 1:].reshape(*wide.shape, NODES), np.arange(len(wide))
    first, last = np.argmax(wide, axis=1), wide.shape[1] - 1 - np.argmax(wide[:, ::-1], axis=1)
    return np.stack([panels[rows, first] @ ENDS[0], panels[rows, last] @ ENDS[1]], axis=1)


def _begin(designs: Designs, known: Mapping[str, Array]) -> Array:
    """The rows of `begin` (see `varied`), of designs and parameters."""
    half, omega, wrt = designs.half[:, None], designs.omega_start[:, None], designs.wrt
    theta_p, omega_p = (np.array([float(p == name) for p in wrt]) for name in STARTS[:2])
    of_M = np.zeros((len(half), len(wrt)))
    for k, p in enumerate(wrt):
        if p not in STARTS:
            of_M[:, k] = known[f"M_eff_wrt_{p}"][:, 0]
    of_M += known["M_eff_wrt_theta"][:, :1] * theta_p
    begin = np.zeros((*of_M.shape, 5))
    with np.errstate(over="ignore", invalid="ignore"):  # a speed beyond every double ends with a status
        begin[..., 2] = 0.5 * omega * omega * of_M + known["M_eff"][:, :1] * omega * omega_p
    if not half.any():
        begin[..., 0], begin[..., 1], begin[..., 3] = theta_p, omega_p, omega
        return begin
    x = designs.coordinates(designs.theta0)[:, None]
    own = [arcs(designs, p) for p in wrt]
    middles, halves = (np.stack([arc[part] for arc in own], axis=1) for part in (0, 1))
    slope = np.where(half == 0.0, 1.0, half * np.cos(x))
    begin[..., 0] = (theta_p - middles - halves * np.sin(x)) / slope
    steeper = halves * np.cos(x) - half * np.sin(x) * begin[..., 0]
    begin[..., 3] = omega / slope
    begin[..., 1] = (omega_p - steeper * begin[..., 3]) / slope
    return begin


def sensitivities_of(
    designs: Designs, fields: Fields, setup: Array, times: Array, tolerance: float, most: Array,
    outs: Sequence[Any], last: bool,
) -> Sensitivities:  # fmt: skip
    """Follow motions on these panels, and their derivatives.

    outs   as `follow` fills them in: the status is that of too wide panels where they are for derivatives
    last   to take derivatives as resolved, whatever they look like
    """
    own, values = derived_of(designs, fields), fields.at.values
    count, parameters = own.begin.shape[:2]
    out, ends = np.empty((count, parameters, 3, times.size)), np.empty((count, parameters, 2))
    tables, bend = bool(designs.tables), fields.at.names.index("M_eff_wrt_theta")
    keep = 2.0 if tables else 1.0
    how = np.array([tolerance, keep, tolerance, tables, last, bend, fields.back], np.float64)
    left, room = [slice(0, count)], ROOM + times.size
    while left:
        rows = left.pop()
        size, (x, speeds, status, bad, numbers) = rows.stop - rows.start, (array[rows] for array in outs)
        kept, where = np.empty((size, room, PIECE)), np.empty((size, 2, times.size))
        followed = kept, np.empty((size, times.size), np.int64), where
        panels = fields.edges[rows], fields.rough[rows], values[rows]
        lanes = np.empty((22, times.size)), np.empty((2, bad.shape[1], 17)), np.empty((2, bad.shape[1]))
        to = x, speeds, status, bad, numbers
        motions()(*panels, setup[rows], times, how, most, *TABLES, *lanes, *followed, *to)
        given = *panels, own.rows, own.jumps[rows], own.begin[rows], how, *TABLES, *followed
        variations()(*given, out[rows], ends[rows], status, bad, numbers)
        full = np.flatnonzero(status == FULL)
        if full.size:  # each alone, with more room
            status[full] = 0
            left += [slice(rows.start + row, rows.start + row + 1) for row in full.tolist()]
            room *= MORE_ROOM
    whole = np.concatenate([ends, own.potential], axis=2)
    whole[:, :, 2] += own.begin[:, :, 2]
    return Sensitivities(out, whole)
