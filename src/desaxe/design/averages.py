"""Measures over the crank's turn and at one angle: ("rms", name), ("mean", name), ("at", "60 deg", name).

Averages are over the angle, by Gauss's rule on panels between the angles at which a load has kinks or jumps,
over as many turns as it takes to repeat: all digits are right but next to a kink that friction makes.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..loads.angles import crossings, meeting_angles, turns_of
from ..loads.load import Load, OverY
from ..mechanism.catalogue import has
from ..mechanism.closed.angles import dead_centres, repeated
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, sensitivity
from ..runtime.request import as_number

Array = NDArray[np.float64]
AVERAGES = ("mean", "rms")
PANELS, POINTS = 64, 8
BESIDE = 1e-11  # rad from a jump: what is rounded of its angle is less
MOST_TURNS = 4  # after which loads repeat


def average(kind: str, name: str, designs: Mapping[str, Any], branch: int) -> tuple[Array, dict[str, Array]]:
    """The mean or the root of the mean square of a quantity over a turn, and its derivatives."""
    angles, weights = _rule(designs, branch)
    value, slopes = _along(name, angles, designs, branch)

    def mean(values: Array) -> Array:
        return np.asarray((values * weights).sum(axis=-1))

    moving = _jumps_that_move(kind, name, designs, branch)
    if kind == "mean":
        return mean(value), {p: mean(slope) + moving.get(p, 0.0) for p, slope in slopes.items()}
    with np.errstate(invalid="ignore", divide="ignore"):
        rms = np.sqrt(mean(value * value))
        return rms, {p: (mean(value * slope) + 0.5 * moving.get(p, 0.0)) / rms for p, slope in slopes.items()}


def _jumps_that_move(kind: str, name: str, designs: Mapping[str, Any], branch: int) -> dict[str, Array]:
    """The derivative of a mean, or a mean square, by each length that comes from jumps that move.

    Jumps of loads over the stroke do. One at the angle t adds (before - after) dt/dp. It stays at a position,
    Y(t, p) = Y_k, at a distance from a dead centre, Y(t, p) = Y_dc(p) + d_k, or at one, Y_wrt_theta = 0.
    """
    found: dict[str, Array] = {}
    loads = [load for load in designs.values() if isinstance(load, OverY)]
    if not loads:
        return found
    end = 2.0 * np.pi * turns_of("an average", _loads(designs), MOST_TURNS)
    lengths = {n: np.asarray(designs[n], float) for n in LENGTHS}
    sides = [side.ravel() for side in np.broadcast_arrays(*(np.atleast_1d(v) for v in lengths.values()))]
    shape = np.broadcast_shapes(*(v.shape for v in lengths.values()))
    moving = [(load.kept, crossings(load, load.jumps, sides, branch)) for load in loads]
    if any(load.inward is not None for load in loads):
        moving.append((("Y_wrt_theta",), dead_centres(sides)))
    for (fixed, *centre), angles in moving:
        places = repeated(angles, 0.0, end).reshape(*shape, -1)
        here = np.where(np.isnan(places), 1.0, places)
        before, after = (_along(name, here + side * BESIDE, designs, branch)[0] for side in (-1.0, 1.0))
        jump = before - after if kind == "mean" else before**2 - after**2
        names = [sensitivity(fixed, "theta"), *(sensitivity(n, p) for n in (fixed, *centre) for p in LENGTHS)]
        wide: dict[str, Any] = {n: v[..., None] for n, v in lengths.items()}
        by = evaluate(names, theta=here, branch=branch, **wide)
        for p in LENGTHS:
            slope = by[sensitivity(fixed, p)] - sum(by[sensitivity(n, p)] for n in centre)
            terms = np.where(np.isnan(places), 0.0, -jump * slope / by[names[0]])
            found[p] = found.get(p, 0.0) + terms.sum(axis=-1) / end
    return found


def _loads(designs: Mapping[str, Any]) -> dict[str, Load]:
    return {p: load for p, load in designs.items() if isinstance(load, Load)}


def at_angle(
    angle: Any, name: str, designs: Mapping[str, Any], branch: int
) -> tuple[Array, dict[str, Array]]:
    """A quantity at one angle, and its derivatives."""
    value, slopes = _along(name, np.array([angle_of(angle)]), designs, branch)
    return value[..., 0], {p: slope[..., 0] for p, slope in slopes.items()}


def angle_of(angle: Any) -> float:
    """The angle of a measure in radians; ValueError or TypeError where it is none."""
    number = as_number("theta", angle, ("theta",), ("at",))
    if number is None:
        raise TypeError(f"at = {angle!r}: expected one angle, such as '60 deg'")
    return number


def _along(
    name: str, angles: Array, designs: Mapping[str, Any], branch: int
) -> tuple[Array, dict[str, Array]]:
    """Values and derivatives by the varying inputs (all inputs of one design): designs, then angles."""
    given = {p: v for p, v in designs.items() if v is not None and p in INPUTS and p != "theta"}
    wide: dict[str, Any]
    wide = {p: v if callable(v) else np.asarray(v, float)[..., None] for p, v in given.items()}
    state = "omega" in given
    varying = [p for p, v in given.items() if not callable(v) and np.ndim(v)]
    slopes = {p: sensitivity(name, p) for p in varying or given if not callable(given[p])}
    slopes = {p: slope for p, slope in slopes.items() if has(slope, state)}
    found = evaluate([name, *slopes.values()], theta=angles, branch=branch, **wide)
    shape = np.broadcast_shapes(*(np.shape(v) for v in wide.values() if not callable(v)), angles.shape)
    full = {n: np.broadcast_to(array, shape) for n, array in found.items()}
    return full[name], {p: full[slope] for p, slope in slopes.items()}


def _rule(designs: Mapping[str, Any], branch: int) -> tuple[Array, Array]:
    """Angles, and weights whose sum is 1; a row for each design where the kinks of a load move with it."""
    loads = _loads(designs)
    turns = turns_of("an average", loads, MOST_TURNS)
    edges = np.linspace(0.0, 2.0 * np.pi * turns, PANELS * turns + 1)
    if loads:
        lengths = np.broadcast_arrays(*(np.atleast_1d(np.asarray(designs[n], float)) for n in LENGTHS))
        kinks = meeting_angles(loads.values(), float(edges[-1]), [side.ravel() for side in lengths], branch)
        kinks = np.where(np.isnan(kinks), 0.0, kinks)
        equal = np.broadcast_to(edges, (kinks.shape[0], edges.size))
        edges = np.sort(np.concatenate([equal, kinks], axis=1), axis=1)
        edges = edges[0] if edges.shape[0] == 1 else edges.reshape(*lengths[0].shape, -1)
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    middle, half = 0.5 * (edges[..., 1:] + edges[..., :-1]), 0.5 * np.diff(edges)
    angles = middle[..., None] + half[..., None] * nodes
    shares = half[..., None] * weights / (2.0 * np.pi * turns)
    rows = (*edges.shape[:-1], -1)
    return angles.reshape(rows), np.broadcast_to(shares, angles.shape).reshape(rows)
