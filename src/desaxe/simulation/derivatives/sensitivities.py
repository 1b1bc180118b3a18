"""The sensitivities of a motion: exact derivatives of histories, events, end and work by parameters."""

from collections.abc import Mapping, Sequence
from math import copysign, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..history import add_slopes
from ..march import March
from ..result import FAILED, JAMS, Event, Simulation
from .cuts import TOUCHED
from .slopes import TorqueSlopes
from .variational import Variations
from .work import of_work

Array = NDArray[np.float64]
BARELY = 1e-30  # rad/s: turning, for friction; without an effect of its own
ENDS = ("angle", "standstill", "limit", "no inertia")


def add_sensitivities(
    result: Simulation, run: March, wrt: Sequence[str], given: Mapping[str, Any], slopes: TorqueSlopes
) -> None:
    """Add theta_wrt_<p>, omega_wrt_<p>, t_last_wrt_<p> and work_wrt_<p>, and `wrt` of each event."""
    with np.errstate(all="ignore"):
        found = Variations(run, wrt, given, slopes)
        theta, omega = found.course.at(result["t"])
        of_events = [of_event(found, event) for event in run.events]
        ended = of_end(found, of_events)
        work = of_work(found, ended)
    add_slopes(result, wrt, (theta.T, omega.T, ended, work), of_events, found.cuts.notes)


def of_event(own: Variations, event: Event) -> Array:
    """dt/dp of an event, from the side it is met from."""
    x, v = (part[0] for part in own.course.at(np.array([event.t])))
    if event.kind in ("dead centre", "no inertia"):
        return own.cuts.passage(event.t, event.omega, own.cuts.dead_centre(event.theta), x)
    if event.kind == "angle" or (event.kind == "limit" and not own.run.model.coordinate.half):
        shift = own.cuts.limit(event.theta) if event.kind == "limit" else np.zeros(x.size)
        return own.cuts.passage(event.t, event.omega, shift, x)
    if event.kind == "limit":  # a standstill
        slopes: Array = -v / own.at_limit(lambda along: along.alpha)
        return slopes
    if event.kind == "standstill":
        piece = next(one for one in own.pieces if one.stop >= event.t)
        return own.cuts.standstill(event.t, float(piece.law.alpha(event.t, event.theta, 0.0)), v)
    if event.kind == "break-away":
        return _break_away(own, event, x)
    own.cuts.notes.append(f"NaN of {event.kind} at t = {event.t:.6g} s")
    return np.full(x.size, nan)


def _break_away(own: Variations, event: Event, x: Array) -> Array:
    """dt/dp of the instant from which the torque moves the crank: T(t, theta, 0) = T_in at barely a speed."""
    after = next((one for one in own.pieces if one.start >= event.t), None)
    by_time = own.slopes.by_time(event.t, event.theta, 0.0)
    if after is None or by_time != by_time:
        own.cuts.notes.append(
            f"NaN of break-away at t = {event.t:.6g} s, but for a derivative= that returns dT/dt, too"
        )
        return np.full(x.size, nan)
    if abs(after.law.alpha(event.t, event.theta, 0.0)) * own.run.t > TOUCHED * own.cuts.fastest:
        return np.zeros(x.size)  # the torque jumps at an instant of its own
    way = copysign(BARELY, own.cuts.state(after, 0.5 * (after.start + after.stop)).omega)
    names = [f"T_in_wrt_{p}" for p in ("theta", *own.inputs)]
    found = {name: float(value) for name, value in own.values(names, event.theta, way).items()}
    instant = (np.array([number]) for number in (event.t, event.theta, 0.0))
    by_theta = float(own.slopes.at(*instant)[0][0]) - found["T_in_wrt_theta"]
    pushes = np.array([float(p == "torque") - found.get(f"T_in_wrt_{p}", 0.0) for p in own.wrt])
    slopes: Array = -(by_theta * x + pushes) / by_time
    return slopes


def of_end(own: Variations, of_events: Sequence[Array]) -> Array:
    """The derivative of the instant at which the motion ends."""
    run = own.run
    if run.status in (FAILED, JAMS):
        return np.full(len(own.wrt), nan)
    ended = run.events and run.events[-1].t == run.t and run.events[-1].kind in ENDS
    return of_events[-1] if ended else np.zeros(len(own.wrt))
