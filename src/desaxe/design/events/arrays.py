"""`events` for arrays of designs: closed forms in NumPy; velocities where the acceleration vanishes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import as_array, broadcast_shape
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ...peaks.peak import peak
from ..feasibility.arrays import only_good
from .closed_form import VELOCITIES, DesignEvents, in_turn, velocity

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
    turns, sharp = status == 0, np.argwhere(status == 2)
    ec, AB, BC, omega = (part[turns] for part in inputs)
    size, way = np.abs(omega), np.where(omega < 0.0, -1.0, 1.0)
    rows = {}
    for name, direction in VELOCITIES.items():
        table = np.full((6, *status.shape), np.nan)
        if turns.any():
            kind = "max" if direction * branch > 0 else "min"
            top = peak("V_C", kind=kind, ec=ec, AB=AB, BC=BC, omega0=way, branch=branch)
            speed = np.abs(top["value"])
            slopes = [direction * branch * size * top["gradient"][p] for p in LENGTHS]
            table[:, turns] = size * speed, in_turn(top["theta"]), *slopes, way * speed
        for k in map(tuple, sharp):
            e, crank, rod, at = (float(part[k]) for part in inputs)
            ends = {key: v[k] for key, v in values.items()}
            table[:, *k] = velocity(direction, ends, branch, at, {"ec": e, "AB": crank, "BC": rod}, True)
        value, theta, *gradient = table
        rows[name] = value, theta, dict(zip((*LENGTHS, "omega0"), gradient, strict=True))
    return rows
