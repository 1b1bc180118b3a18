"""`events` for arrays of designs: closed forms in NumPy; velocities where the acceleration vanishes."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...compiler.languages.arrays import compile_arrays
from ...evaluation.arrays import as_array, broadcast_shape
from ...evaluation.evaluate import evaluate
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ...mechanism.program import Variant
from ...runtime.specialise import specialise
from ...runtime.threads import have_wide_margins
from ...support.roots import roots
from ..feasibility.arrays import only_good
from .found import VELOCITIES, DesignEvents, stroke_ends

Array = NDArray[np.float64]


def events_of_arrays(
    given: dict[str, Any], branch: int, with_speed: bool, with_velocities: bool = True
) -> dict[str, Any]:
    """The results of `events` in the broadcast shape of the inputs."""
    inputs = {n: as_array(n, value, tuple(given), ("events",)) for n, value in given.items()}
    shape = broadcast_shape(inputs)
    ec, AB, BC, omega = (np.broadcast_to(a, shape) for a in inputs.values())
    bad, lengths = only_good(ec, AB, BC)
    bad |= ~np.isfinite(omega)
    ec, AB, BC, omega = (np.where(bad, np.nan, a) for a in (*lengths, omega))
    turning = np.where(omega < 0.0, -1.0, 1.0)
    outputs = closed_form(DEAD_CENTRES, branch=float(branch)).arrays(ec, AB, BC, turning)
    found = DesignEvents(tuple(np.array(np.broadcast_to(output, shape)) for output in outputs))
    status = np.where(bad, 4, found.status).astype(np.int8)
    slow = np.where(bad | (status == 1), 0, branch * turning * np.sign(np.nan_to_num(ec))).astype(np.int8)
    result: dict[str, Any] = {**found.values, "slow_stroke": slow, **found.places}
    gradient = found.gradient
    if with_velocities:
        for name, own in _velocities(found.values, branch, status, (ec, AB, BC, omega)).items():
            value, theta, slopes = own
            result |= {name: value, f"theta_{name}": theta}
            gradient[name] = slopes if with_speed else {p: slopes[p] for p in LENGTHS}
    return {**result, "gradient": gradient, "status": status}


def _velocities(
    values: dict[str, Any], branch: int, status: NDArray[np.int8], inputs: tuple[Array, ...]
) -> dict[str, tuple[Array, Array, dict[str, Array]]]:
    """The largest |V_C| while the slider moves outward and inward: values, crank angles, derivatives."""
    turns = (status == 0) | (status == 2)
    *lengths, omega = (np.tile(a[turns], 2) for a in inputs)  # the designs outward, then inward
    here: dict[str, Any] = {**dict(zip(LENGTHS, lengths, strict=True)), "branch": branch}
    names = ["V_C", *(f"V_C_wrt_{p}" for p in (*LENGTHS, "omega0"))]
    side = np.repeat([direction * branch for direction in VELOCITIES.values()], omega.size // 2)
    ends = [np.stack(stroke_ends(values, way, branch))[:, turns] for way in (1, -1)]
    growing = np.where((side > 0) == (omega >= 0.0), *(np.tile(end, 2) for end in ends))
    theta, within = _fastest(growing[0], growing[1], here) if omega.size else (omega, omega > 0.0)
    found = evaluate(names, theta=theta, omega0=omega, **here) if omega.size else dict.fromkeys(names, omega)
    told = {name: side * found[name] for name in names} | {
        "theta": np.where(theta < -np.pi / 2, theta + 2 * np.pi, theta)
    }
    sharp = np.tile(status[turns] == 2, 2) & ~within & (told["V_C"] != 0.0)
    for name in names[1:4]:  # by the lengths: what is fastest at a change point grows as a root of the margin
        told[name] = np.where(sharp, np.copysign(np.inf, told[name]), told[name])
    rows = {}
    for place, name in enumerate(VELOCITIES):
        spread = {each: np.full(turns.shape, np.nan) for each in told}
        for each, column in told.items():
            spread[each][turns] = column.reshape(2, -1)[place]
        slopes = {p: spread[f"V_C_wrt_{p}"] for p in (*LENGTHS, "omega0")}
        rows[name] = spread["V_C"], spread["theta"], slopes
    return rows


def _fastest(a: Array, b: Array, here: dict[str, Any]) -> tuple[Array, NDArray[np.bool_]]:
    """The crank angles at which |V_C| is largest: where the acceleration vanishes between a and b, or an end.

    Which of them are between a and b.
    """
    ends = evaluate(["V_C", "a_C"], theta=np.stack([a, b]), omega0=1.0, **here)
    (one, other), (first, last) = np.abs(ends["V_C"]), ends["a_C"]
    end = np.where(one >= other, a, b)  # no crank, or fastest at a change point
    within = np.sign(first) * np.sign(last) < 0.0
    sides = [here[name][within] for name in LENGTHS]
    unit = np.frexp(sides[2])[1]  # in which no square leaves the range of doubles
    sides = [np.ldexp(side, -unit) for side in sides]
    acceleration = _acceleration(here["branch"], have_wide_margins(Variant(), *sides))
    inside = (v[within] for v in (a, b, first, last))
    end[within] = roots(lambda theta: acceleration(theta, *sides)[0], *inside)
    return end, within


@lru_cache(maxsize=4)
def _acceleration(branch: int, wide: bool) -> Callable[..., tuple[Array, ...]]:
    """a_C at a speed of 1 rad/s, for arrays of angles and lengths: a root needs no other inputs checked."""
    fixed = ("branch", float(branch)), ("omega0", 1.0), ("alpha", 0.0)
    program = specialise(("a_C",), Variant(wide_margins=wide), fixed)
    return np.errstate(all="ignore")(compile_arrays(program._replace(inputs=("theta", *LENGTHS)), np))
