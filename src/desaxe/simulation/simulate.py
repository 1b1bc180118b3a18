"""`simulate`: the motion of the crank under a torque."""

from collections.abc import Callable, Mapping, Sequence
from math import inf, sqrt
from typing import Any

import numpy as np

from ..evaluation.arrays import as_array
from ..evaluation.under_loads.loaded import with_labelled
from ..loads.load import Load as LoadOverMotion
from ..loads.motors import Motor
from ..mechanism.inputs import TINY
from ..mechanism.names import LENGTHS
from ..runtime.request import check_common, with_known_inputs
from ..support.checks import whole_number
from ..support.deadline import Deadline
from ..support.forks import IMPORTS
from .checks import (
    check_names,
    design_values,
    drive_of,
    follows_the_slider,
    model_of,
    read_method,
    read_rtol,
    read_times,
    read_until,
    read_wrt,
    scalar,
)
from .derivatives.slopes import TorqueSlopes
from .each_design import simulate_each
from .energy.alone import result_alone
from .energy.motion import design_of, motion_of
from .energy.serves import ENERGY, INTEGRATOR, PANELS, no_energy_form, refuse, tables_alone
from .held import Held
from .history import instants_of, integrated
from .many_designs import is_array, simulate_many
from .model import Load, Model
from .one_design import MotionRun, StepControl
from .result import Simulation

LEAST_ATOL = 1e-100  # with none at all a state of 0 would have no scale


@with_known_inputs
def simulate(
    *,
    torque: Any,
    t_end: Any,
    AB: Any,
    BC: Any,
    ec: Any,
    theta0: Any = 0.0,
    omega_start: Any = 0.0,
    names: str | Sequence[str] = (),
    branch: int = 1,
    m_crank: Any = None,
    m_rod: Any = None,
    m_slider: Any = None,
    I_crank: Any = None,
    I_rod: Any = None,
    r_crank: Any = None,
    r_rod: Any = None,
    F_X: Any = None,
    F_Y: Any = None,
    g_X: Any = None,
    g_Y: Any = None,
    mu: Any = None,
    rtol: float = 1e-10,
    atol: Any = None,
    method: str | None = None,
    times: Any = None,
    until: Any = None,
    wrt: str | Sequence[str] = (),
    derivative: Callable[..., Any] | None = None,
    max_step: Any = None,
    max_steps: int = 1_000_000,
    threads: int | None = None,
    timeout: float | None = 600.0,
) -> Simulation:
    """The motion of the crank under a torque.

    torque       on the crank [N m], positive like theta: a number, `over_theta`, a motor, `over_omega` or
                 `kloss`, or a function, called by the names of its arguments: t, theta, omega, and of the
                 slider Y, s, V_C, in any order; an argument with a default keeps it
    t_end        how long to follow the motion [s]
    theta0, omega_start   crank angle [rad] and speed [rad/s] at t = 0; the speed of a Machine is its own
    AB, BC, ec, branch, masses, centres of mass, gravity, mu   as in `evaluate`
    F_X, F_Y     external force on the slider [N]: the same, or `over_Y`; the integration starts again at
                 the kinks and jumps of tables, and at the nodes of a function
    names        quantities and sensitivities of a given state along the motion, by `evaluate`: NaN at
                 a limit angle, and where no or two sets of forces balance the acceleration as given
    rtol, atol   tolerances: the largest errors of theta and omega are about rtol of their largest values.
                 atol of a step, for the angle [rad], sqrt(kinetic energy) and work, is by default rtol times
                 0.03 rad (by SciPy 0.001) and a hundredth of the energy that start and loads suggest
    method       "energy": the crank angle is the independent variable, energy and time are integrals over it;
                 the default where torque and loads are numbers or tables, without friction. "panels": so, the
                 torque found by iteration, while a crank that turns fully is not near rest; the default for
                 many designs under a function. Else DOP853, the default for all other motions, or by SciPy
                 (extra `simulate`) RK45, RK23, Radau, BDF, LSODA
    times        instants of the histories [s]; by default 1001 from start to end
    until        crank angle or angles [rad]: the first that is reached ends the motion
    wrt          parameters by which the motion is differentiated: inputs of the mechanism that are numbers,
                 "theta0", "omega_start", "torque" where it is a number
    derivative   for wrt, of a torque that is a function: one of t, theta, omega that returns dT/dtheta
                 and dT/domega; and dT/dt, without which the instants of "break-away" have no derivative
    max_step     longest step [s] of an integrator, for loads that act briefly
    max_steps    more steps than this, in the energy form pieces of panels, are a failure
    timeout      seconds of computing, None for no limit: then one motion ends with status 4 and what there is
                 of it, and many designs with a TimeoutError
    threads      for many designs: how many threads share them, all there are without

    Returns a dict that shows itself on one screen:

    t, theta, omega, alpha, <names>   histories, as far as the motion goes
    events           named tuples (kind, t, theta, omega, which): "dead centre", "standstill", "angle",
                     "limit", "friction jams", "break-away", "no inertia"
    status, message  0 reached t_end or an angle, 1 at rest for good, 2 at a limit angle, 3 friction jams,
                     4 integration failed, 5 the effective inertia vanishes at a dead centre
    energy_residual  |kinetic + potential - work - initial| at most, relative to all work done or the largest
                     kinetic energy; above 100 times what is usual at this rtol, `message` ends with it and
                     the rtol to repeat with
    work             of torque, loads and friction, gravity not included [J]
    method           the way that was taken
    t_last           when the motion ends [s]
    solution         function t -> dict of theta and omega, anywhere up to the end
    theta_wrt_<p>, omega_wrt_<p>   for each p of wrt: derivatives of the histories at each instant
    t_last_wrt_<p>, work_wrt_<p>   of the end of the motion, and of the work up to there

    With wrt each event has `wrt`, parameter -> dt/dp. The derivatives are exact but for the integration's own
    error, across jumps of loads, standstills and friction, too. They are NaN where there are none, and
    `message` says so: at an angle or a standstill that is only touched, and after a jump there.

    Many designs at once: lengths, masses, constant loads, theta0, omega_start, a constant torque and the
    numbers of `kloss` may be arrays that broadcast like NumPy. Without friction they run in compiled code:
    under numbers and tables that repeat after at most four turns in the energy form; under a torque function,
    which numba compiles, by panels; under numbers where these do not serve, such as at an unstable
    equilibrium, by DOP853. All others,
    also those with `until`, and with wrt where there is no energy form, run one after the other. Histories
    then have the shape (designs..., times), 101 instants without `times`, NaN where a motion has ended.
    status (also 6: bad input, no mechanism at the start, or not the dead centre that a load is over),
    energy_residual, work, t_last and method have the shape of the designs; there are no events and no
    solution.

    Equation: M_eff alpha + M_eff' omega^2/2 = torque - static torque - friction (paper C, section 3).
    Raises ValueError where no motion can start (no mechanism there, no inertia) and for a bad value.

    See docs/choose.md: which call for which question.
    """
    given = {
        "AB": AB, "BC": BC, "ec": ec, "m_crank": m_crank, "m_rod": m_rod, "m_slider": m_slider,
        "I_crank": I_crank, "I_rod": I_rod, "r_crank": r_crank, "r_rod": r_rod, "F_X": F_X, "F_Y": F_Y,
        "g_X": g_X, "g_Y": g_Y, "mu": mu,
    }  # fmt: skip
    given = with_labelled(given)
    check_common({}, branch, threads)
    wanted = check_names(names)
    max_steps = whole_number("max_steps", max_steps, 1, 10**9)
    deadline = Deadline("simulate", timeout)
    end = scalar("t_end", t_end, "s", TINY, "a finite time > 0")
    longest = inf if max_step is None else scalar("max_step", max_step, "s", TINY, "a finite time > 0")
    instants, angles, rtol = read_times(times, end), read_until(until), read_rtol(rtol)
    starts = {"theta0": theta0, "omega_start": omega_start, "torque": torque}
    by = read_wrt(wrt, {**given, **starts})
    slopes = TorqueSlopes(torque, derivative) if by else None
    motors = torque.numbers.values() if isinstance(torque, Motor) else ()
    several = any(map(is_array, (*given.values(), *starts.values(), *motors)))
    if method == ENERGY:
        options = {"max_step=": max_step is not None, "atol=": atol is not None, "wrt = 'mu'": "mu" in by}
        refuse({"torque": torque, "F_X": F_X, "F_Y": F_Y}, given["mu"], options)
    elif method == PANELS and (by or not several):
        raise ValueError("method = 'panels': it is for many designs, without wrt=")
    if several:
        _check_many(method, atol)
        varying = any(map(callable, (given["F_X"], given["F_Y"])))
        alone = isinstance(torque, (LoadOverMotion, Motor)) or follows_the_slider(torque)
        if by or angles or varying or alone or _rubs(given["mu"]):
            if method == PANELS:
                raise ValueError(
                    "method = 'panels': it is for loads that are numbers, without mu, until=, wrt="
                )

            def one(
                inputs: Mapping[str, Any], begin: Mapping[str, Any], t: Any, way: str | None
            ) -> Simulation:
                deadline.check()
                return simulate(
                    **inputs, **begin, t_end=end, names=wanted, branch=branch, rtol=rtol, times=t,
                    max_step=None if longest == inf else longest, max_steps=max_steps,
                    timeout=deadline.left(), wrt=by, derivative=derivative, until=angles or None, method=way,
                )  # fmt: skip

            how = (rtol, end, longest, max_steps)
            ways = method, not angles
            return simulate_each(
                one, given, starts, int(branch), wanted, by, instants, end, how, threads, deadline, *ways
            )
        how = (rtol, end, longest, max_steps)
        return simulate_many(given, starts, int(branch), wanted, instants, how, threads, deadline, method)
    start = scalar("theta0", theta0, "rad"), scalar("omega_start", omega_start, "rad/s")
    drive = drive_of(torque, given["F_X"], given["F_Y"], deadline)
    values = design_values(given)
    model = model_of(values, int(branch), start[0], drive)
    known: dict[str, Any] = {**values, "branch": int(branch)}
    loads = {name: value for name in ("F_X", "F_Y") if callable(value := given[name])}
    tables = tables_alone({**loads, **({"torque": torque} if callable(torque) else {})}, model.mu)
    if method in (None, ENERGY) and tables and longest == inf and atol is None and "mu" not in by:
        pushes = torque if callable(torque) else drive.torque(0.0, *start)
        designs = design_of(values, model, pushes, loads.get("F_Y", values["F_Y"]), start)
        asked = np.append(instants_of(instants, end), end)
        how_told = wanted, instants, {**known, **loads}
        with np.errstate(all="ignore"):  # values beyond every double: the integrator tells
            motion = motion_of(model, designs._replace(wrt=by), angles, asked, rtol, max_steps, deadline)
            result = None if motion is None else result_alone(motion, *how_told)
        if result is not None:
            return result
    if method == ENERGY:
        raise ValueError(no_energy_form("this design has"))
    energy = energy_scale(model, *start, end)
    size = np.array([1.0, sqrt(energy), energy])
    by_method = read_method(method or INTEGRATOR)
    tolerance = StepControl(by_method, rtol, _atol(atol, rtol, size, by_method), size, longest, max_steps)
    v = start[1] * sqrt(model.inertia(start[0]))
    run = MotionRun(model, np.array([model.coordinate.q(start[0]), v, 0.0]), end, angles, tolerance, deadline)
    with np.errstate(all="ignore"):  # values beyond every double end the motion with a status
        run.to_the_end()
    result = integrated(run, wanted, instants, {**known, "F_X": drive.F_X, "F_Y": drive.F_Y})
    if slopes is not None:
        with IMPORTS:
            from .derivatives.sensitivities import add_sensitivities

        own = {"F_X": drive.F_X, "F_Y": drive.F_Y}
        held = {name: load.load for name, load in own.items() if isinstance(load, Held)}
        add_sensitivities(result, run, by, {**known, **held}, slopes)
    return result


def _rubs(mu: Any) -> bool:
    """True if any design has friction."""
    return mu is not None and bool(np.any(as_array("mu", mu, LENGTHS, ("simulate",)) != 0.0))


def _check_many(method: str | None, atol: Any) -> None:
    """Reject options that are for one design at a time."""
    given = {
        "method": method not in (None, ENERGY, PANELS, INTEGRATOR),
        "atol": atol is not None,
    }
    for name, there in given.items():
        if there:
            raise ValueError(
                f"{name}= is for one design at a time: many run over the crank angle or by DOP853"
            )


def _atol(atol: Any, rtol: float, size: Any, method: str) -> Any:
    """Absolute tolerances for (q, v, W): those of DOP853 make the errors of motions what rtol says."""
    if atol is not None:
        several = atol if isinstance(atol, (list, tuple, np.ndarray)) else [atol]
        number = np.array(
            [scalar("atol", a, "1", LEAST_ATOL, f"a number, at least {LEAST_ATOL}") for a in several]
        )
        if number.size not in (1, 3):
            raise ValueError(f"atol: one number or three (angle, v, work), got {number.size}")
        return np.broadcast_to(number, 3)
    return rtol * size * (0.03 if method == "DOP853" else 1e-3, 0.01, 0.01)


def energy_scale(model: Model, theta: float, omega: float, t_end: float) -> float:
    """An energy [J] of the size that the motion will have.

    Of the start, of gravity, of what torque and load do in a radian and a crank length; where all are
    nothing, that of a turn in t_end.
    """
    inertia, weight, _ = model.still(theta, model.sign)
    kinetic, potential = model.kinetic_and_potential(theta, model.sign, omega)
    instants = [t_end * k / 8 for k in range(9)]
    torque = max(_size(model.drive.torque, t, theta, omega) for t in instants)
    force = max(_size(model.drive.F_Y, t, theta, omega) for t in instants) * model.values["AB"]
    return max(kinetic, abs(potential), abs(weight), torque, force) or inertia / t_end**2


def _size(load: Load, t: float, theta: float, omega: float) -> float:
    """The magnitude of a load; 0 without a value or time for it: the motion tells, if it gets there."""
    try:
        return abs(load(t, theta, omega))
    except (ValueError, TimeoutError):
        return 0.0
