"""The derivative of the work of torque, loads and friction, which is the change of both energies."""

from math import cos, sin

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ...loads.load import OverTheta, OverY
from ...mechanism.names import LENGTHS
from ..panel import NODES, ONCE, PLACES, SERIES
from .variational import Along, Variations

Array = NDArray[np.float64]
ENERGIES = ("kinetic_energy", "potential_energy")


def of_work(own: Variations, of_end: Array) -> Array:
    """The derivative of the work up to the end, which comes at an instant of its own."""
    first, last = own.pieces[0], own.pieces[-1]
    start = _energy(own, own.at(first, first.start))[:-1, 0]
    if own.grows:
        return _to_limit(own, of_end) - start
    end = _energy(own, own.at(last, last.stop))[:, 0]
    power = end[-1] * of_end if of_end.any() else 0.0
    found: Array = end[:-1] + power - start
    return found


def _energy(own: Variations, along: Along) -> Array:
    """dE/dp at a fixed time, a row for each parameter; and the power as the last row."""
    by = ("theta", "omega", *own.inputs)
    found = own.values([f"{one}_wrt_{p}" for one in ENERGIES for p in by], along.theta, along.omega)
    whole = {p: found[f"{ENERGIES[0]}_wrt_{p}"] + found[f"{ENERGIES[1]}_wrt_{p}"] for p in by}
    x, v = _course(own, along)
    rows = [
        whole["theta"] * x[k] + whole["omega"] * v[k] + (whole[p] if p in own.inputs else 0.0)
        for k, p in enumerate(own.wrt)
    ]
    return np.stack([*rows, whole["theta"] * along.omega + whole["omega"] * along.alpha])


def _course(own: Variations, along: Along) -> tuple[Array, Array]:
    x, v = (part.T.reshape(-1, *along.t.shape) for part in own.course.at(along.t.reshape(-1)))
    return x, v


def _to_limit(own: Variations, of_end: Array) -> Array:
    """The derivative of both energies at a limit angle where the inertia grows without bound.

    They are evaluated where the last panel starts; from there on torque, load and friction do work. At the
    limit the slider stands at AB cos(theta).
    """
    model = own.run.model
    # Behind the start of the panel, at which a load may jump, and omega_p with it.
    begin = own.at(own.pieces[-1], float(np.nextafter(own.course.start[-1], np.inf)))
    along = own.last_panel
    x, v = _course(own, along)
    by_theta, by_omega = own.slopes.at(along.t, along.theta, along.omega)
    drive = own.pieces[-1].law.drive
    torque = drive.torque.at(along.t[0], along.theta[0], along.omega[0])
    push = by_theta * x + by_omega * v + np.array([float(p == "torque") for p in own.wrt])[:, None, None]
    power = (push * along.omega + torque * v)[:, 0]
    found: Array = _energy(own, begin)[:-1, 0] + _integral(own, power) + _of_load(own, begin)
    return found - _of_friction(own, along, of_end) if model.mu else found


def _of_friction(own: Variations, along: Along, of_end: Array) -> Array:
    """The derivative of the work that friction takes on the last panel."""
    x, v = _course(own, along)
    by = ("theta", "omega", "alpha", *own.inputs)
    piece = np.array([len(own.pieces) - 1])
    slopes, taken = own.rubbing(along, piece, by)
    bend = (legendre.legvander(2.0 * PLACES - 1.0, NODES - 1) @ own.course.series[-1]).T / own.course.h[
        -1
    ] ** 2
    rows = [
        slopes["theta"] * x[k] + slopes["omega"] * v[k] + slopes["alpha"] * bend[k] + slopes.get(p, 0.0)
        for k, p in enumerate(own.wrt)
    ]
    last = own.at_limit(lambda along: own.rubbing(along, piece, ())[1] * along.omega)
    found: Array = _integral(own, (np.array(rows) * along.omega + taken * v)[:, 0]) + last * of_end
    return found


def _of_load(own: Variations, begin: Along) -> Array:
    """The derivative of the work of F_Y from an instant up to the limit angle.

    By parts that of the integral of F dY is [F dY/dp] + integral of (dF/dp dY - dF dY/dp), 0 but for a load
    over theta; a load over the stroke goes with Y less the position of its dead centre.
    """
    _, AB, _ = own.run.model.lengths
    limit, load = own.run.events[-1].theta, own.given["F_Y"]
    before, place = _shifts(own, begin)
    forces = [
        float(own.pieces[-1].law.drive.F_Y.at(*(float(one[0]) for one in begin[:3]))),  # behind a jump
        _at_limit(own, limit, AB * cos(limit)),
    ]
    after = np.array([cos(limit) * (p == "AB") for p in own.wrt]) - AB * sin(limit) * own.cuts.limit(limit)
    zero = np.zeros(after.size)
    if isinstance(load, OverY) and load.centre:
        names = {p: f"{load.centre}_wrt_{p}" for p in own.wrt if p in LENGTHS}
        found = own.values(tuple(names.values()), limit) if names else {}
        zero = np.array([float(found[names[p]]) if p in names else 0.0 for p in own.wrt])
    result: Array = forces[1] * (after - zero) - forces[0] * (before[:, 0] - zero)
    result += np.array([(AB * cos(limit) - float(place[0])) * (p == "F_Y") for p in own.wrt])
    if isinstance(load, OverTheta):
        along = own.last_panel
        x, _ = _course(own, along)
        speed = own.values(("V_C",), along.theta, along.omega)["V_C"]
        moves = x[:, 0] * speed[0] - _shifts(own, along)[0].reshape(x[:, 0].shape) * along.omega[0]
        result += _integral(own, np.asarray(load.both(along.theta[0])[1]) * moves)
    return result


def _at_limit(own: Variations, theta: float, Y: float) -> float:
    """F_Y at the limit angle, where the slider is at Y."""
    load = own.given["F_Y"]
    if not isinstance(load, OverY):
        return float(load.value(theta) if callable(load) else load)
    motion = {"Y": Y}
    if load.centre:
        motion[load.centre] = float(own.values((load.centre,), theta)[load.centre])
    last = own.last_panel
    way = own.values(("V_C",), last.theta, last.omega)["V_C"][0, -1]
    return float(load.value(load.along(motion), float(way)))


def _shifts(own: Variations, along: Along) -> tuple[Array, Array]:
    """dY/dp at a fixed time, a row for each parameter, and Y."""
    found = own.values(("Y", *(f"Y_wrt_{p}" for p in ("theta", *LENGTHS))), along.theta)
    x, _ = _course(own, along)
    rows = [found["Y_wrt_theta"] * x[k] + found.get(f"Y_wrt_{p}", 0.0) for k, p in enumerate(own.wrt)]
    return np.array(rows), found["Y"]


def _integral(own: Variations, values: Array) -> Array:
    """The integral, from the start of the last panel to the end of the motion, of values at its nodes."""
    start, h = float(own.course.start[-1]), float(own.course.h[-1])
    end = np.array([2.0 * (own.run.t - start) / h - 1.0])
    found: Array = h * (values @ SERIES.T @ ONCE.T @ legendre.legvander(end, NODES)[0])
    return found
