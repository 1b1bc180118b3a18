"""One design in its energy form: its result, and the derivatives of its events, end and work."""

from collections.abc import Mapping, Sequence
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ..history import Ended, add_slopes, instants_of, result_of
from ..result import FAILED, LIMIT, Event, Simulation
from .many import FollowedMotions
from .motion import MotionOverAngle
from .one_design import one_design
from .panels import Designs
from .pushed import arcs
from .serves import ENERGY

Array = NDArray[np.float64]
TOUCHED = 1e-6  # of the largest speed, or of its change in the motion's time: less is none
BEFORE = 1e-13  # of the motion's time, or an instant's last bits: so much ahead of an event its side holds


def result_alone(
    motion: MotionOverAngle, names: Sequence[str], times: Any, given: Mapping[str, Any]
) -> Simulation | None:
    """The result of a motion, with its derivatives; None where the energy form does not resolve those.

    given   its inputs, for `names`
    """
    t = instants_of(times, motion.t)
    found = motion.found(t)
    if motion.designs.wrt and found.by is None:
        return None
    histories = [history[0, : t.size] for history in (found.theta, found.omega, found.alpha)]
    _, residual, work, rounded = found.numbers[0].tolist()
    told = motion.t, motion.status, motion.message, motion.events, ENERGY, motion.rtol
    ended = Ended(*told, residual, rounded, work, motion.states)
    result = result_of(t, histories, ended, names, given)
    if motion.designs.wrt:
        _add_slopes(result, motion, found)
    return result


def _add_slopes(result: Simulation, motion: MotionOverAngle, found: FollowedMotions) -> None:
    """Add theta_wrt_<p>, omega_wrt_<p>, t_last_wrt_<p> and work_wrt_<p>, and `wrt` of each event."""
    assert found.by is not None
    notes: list[str] = []
    size, wrt = len(result["t"]), motion.designs.wrt
    fastest = float(np.nanmax(np.abs(found.omega)))
    events = _of_events(motion, found, fastest, notes)
    ended, work = np.zeros(len(wrt)), found.by.work[0].copy()
    if motion.status == FAILED:
        ended[:], work[:] = nan, nan
    elif motion.status == LIMIT:
        ended = events[-1]
    elif motion.events and motion.events[-1].t == motion.t and motion.events[-1].kind == "angle":
        ended = events[-1]
        work += _power(motion.designs, found) * ended
    if motion.status == LIMIT:  # omega is 0 there, at another instant for another p
        ends = np.flatnonzero(result["t"] >= motion.t)
        far = np.copysign(1.0, motion.events[-1].theta - motion.designs.middle)
        for k, p in enumerate(wrt):
            found.by.theta[0, k, ends] = arcs(motion.designs, p).angle(far)[0]
            found.by.omega[0, k, ends] = -motion.alpha * ended[k]
    histories = (history[0, :, :size] for history in (found.by.theta, found.by.omega))
    add_slopes(result, wrt, (*histories, ended, work), events, notes)


def _of_events(
    motion: MotionOverAngle, found: FollowedMotions, fastest: float, notes: list[str]
) -> list[Array]:
    """dt/dp of each event, from the side that it is met from."""
    assert found.by is not None
    t = np.array([event.t for event in motion.events if event.kind != "limit"])
    slopes: list[Array] = []
    if t.size:
        before = np.maximum(t - np.maximum(BEFORE * motion.t, 4.0 * np.spacing(t)), 0.0)
        there = motion._replace(asked=None).found(before)
        assert there.by is not None
        for k, event in enumerate(motion.events[: t.size]):
            theta_p, omega_p = there.by.theta[0, :, k], there.by.omega[0, :, k]
            if event.kind == "standstill":
                alpha = float(there.alpha[0, k])
                touched, slope = abs(alpha) * motion.t <= TOUCHED * fastest, -omega_p / (alpha or nan)
            else:
                touched = abs(event.omega) <= TOUCHED * fastest
                slope = (_shift(motion.designs, event) - theta_p) / (event.omega or nan)
            if touched:
                what = "a standstill" if event.kind == "standstill" else "an angle"
                notes.append(f"NaN where {what} is only touched, at t = {event.t:.6g} s")
            slopes.append(np.full(slope.size, nan) if touched else slope)
    return slopes if motion.status != LIMIT else [*slopes, found.by.t_last[0].copy()]


def _shift(designs: Designs, event: Event) -> Array:
    """By how much the angle of an event moves with each parameter."""
    if event.kind != "dead centre":
        return np.zeros(len(designs.wrt))
    names = tuple(f"theta_{event.which}_wrt_{p}" for p in LENGTHS)
    form = closed_form(DEAD_CENTRES, names, branch=float(designs.branch))
    moved = dict(zip(LENGTHS, form.point(*(x.item() for x in designs.lengths)), strict=True))
    return np.array([moved.get(p, 0.0) for p in designs.wrt])


def _power(designs: Designs, found: FollowedMotions) -> float:
    """The power of torque and loads at the end: of both energies."""
    theta, omega, alpha = found.theta[:, -1:], found.omega[0, -1], found.alpha[0, -1]
    names = "M_eff", "M_eff_wrt_theta", "potential_energy_wrt_theta"
    with one_design():
        inertia, bend, gravity = (v.item() for v in designs.values(theta, names).values())
    return float((inertia * alpha + 0.5 * bend * omega * omega + gravity) * omega)
