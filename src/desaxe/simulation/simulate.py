"""`simulate`: the motion of the crank under a torque."""

from collections.abc import Callable, Sequence
from typing import Any

from ..evaluation.labelled import refuse_other_labels, with_labelled
from ..loads.motors import Motor
from ..mechanism.inputs import TINY
from ..runtime.request import check_common, check_sliders, with_known_inputs
from ..support.checks import whole_number
from ..support.deadline import Deadline
from .checks import check_names, read_knots, read_rtol, read_times, read_until, read_wrt, scalar
from .drive import torque_derivative
from .march import Ask
from .request import one_motion
from .result import Simulation
from .rows import is_array, simulate_rows


@with_known_inputs
def simulate(
    *,
    torque: Any,
    t_end: Any,
    AB: Any = None,
    BC: Any = None,
    ec: Any = None,
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
    times: Any = None,
    until: Any = None,
    knots: Any = None,
    wrt: str | Sequence[str] = (),
    derivative: Callable[..., Any] | None = None,
    max_steps: int = 1_000_000,
    threads: int | None = None,
    timeout: float | None = 600.0,
    sliders: Any = None,
) -> Simulation:
    """The motion of the crank under a torque.

    torque       on the crank [N m], positive like theta: a number, `over_theta`, a motor, `over_omega` or
                 `kloss`, or a function, called by the names of its arguments: t, theta, omega, and of the
                 slider Y, s, V_C, in any order; an argument with a default keeps it
    t_end        how long to follow the motion [s]
    theta0, omega_start   crank angle [rad] and speed [rad/s] at t = 0; the speed of a Machine is its own
    AB, BC, ec, branch, masses, centres of mass, gravity, mu   as in `evaluate`
    F_X, F_Y     external force on the slider [N]: the same, `over_Y`, `over_stroke`, `over_V`, `spring`,
                 `damper` or a sum; the integration starts again at the kinks and jumps of tables over
                 angle and position, and at the nodes of a function
    names        quantities and sensitivities of a given state along the motion, by `evaluate`: NaN at
                 a limit angle, and where no or two sets of forces balance the acceleration as given
    rtol         relative tolerance: the largest errors of theta and omega are about rtol of their largest
                 values
    times        instants of the histories [s]; by default 1001 from start to end
    knots        instants [s] at which a function of t jumps or bends, such as start and end of a push: they
                 cut panels, also at rest. Without them a push that is shorter than t_end/2000 may be missed
    until        crank angle or angles [rad]: the first that is reached ends the motion
    wrt          parameters by which the motion is differentiated: inputs of the mechanism that are numbers,
                 "theta0", "omega_start", "torque" where it is a number, numbers of loads such as
                 "F_Y.stiffness", and those of `kloss` such as "gear"
    derivative   for wrt, of a torque that is a function: one of t, theta, omega that returns dT/dtheta
                 and dT/domega; and dT/dt, without which the instants of "break-away" have no derivative
    max_steps    more panels than this are a failure
    timeout      seconds of computing, None for no limit: then one motion ends with status 4 and what there is
                 of it, and many designs with a TimeoutError
    sliders      filled in by a `Crankshaft`, whose torque is of t, theta, omega
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
    method           "panels" of time: collocation
    t_last           when the motion ends [s]
    solution         function t -> dict of theta and omega, anywhere up to the end
    theta_wrt_<p>, omega_wrt_<p>   for each p of wrt: derivatives of the histories at each instant
    t_last_wrt_<p>, work_wrt_<p>   of the end of the motion, and of the work up to there

    With wrt each event has `wrt`, parameter -> dt/dp. The derivatives are exact but for the integration's own
    error, across jumps of loads, standstills and friction, too. They are NaN where there are none, and
    `message` says so: at an angle or a standstill that is only touched, and after a jump there.

    Many designs at once: lengths, masses, constant loads, theta0, omega_start, a constant torque and the
    numbers of `kloss` may be arrays that broadcast like NumPy. Histories then have the shape
    (designs..., times), 101 instants without `times`, NaN where a motion has ended. status (also 6: bad
    input, no mechanism at the start, or not the dead centre that a load is over), energy_residual, work,
    t_last and method have the shape of the designs; there are no events and no solution.

    Equation: M_eff alpha + M_eff' omega^2/2 = torque - static torque - friction (paper C, section 3).
    Raises ValueError where no motion can start (no mechanism there, no inertia) and for a bad value.

    See docs/choose.md: which call for which question.
    """
    inputs = {
        "AB": AB, "BC": BC, "ec": ec, "m_crank": m_crank, "m_rod": m_rod, "m_slider": m_slider,
        "I_crank": I_crank, "I_rod": I_rod, "r_crank": r_crank, "r_rod": r_rod, "F_X": F_X, "F_Y": F_Y,
        "g_X": g_X, "g_Y": g_Y, "mu": mu,
    }  # fmt: skip
    inputs = with_labelled(inputs)
    check_common({}, branch, threads)
    check_sliders(sliders)
    requested = check_names(names, sliders is None)
    max_steps = whole_number("max_steps", max_steps, 1, 10**9)
    deadline = Deadline("simulate", timeout)
    end = scalar("t_end", t_end, "s", TINY, "a finite time > 0")
    instants, angles, rtol = read_times(times, end), read_until(until), read_rtol(rtol)
    starts = {"theta0": theta0, "omega_start": omega_start, "torque": torque}
    refuse_other_labels({**inputs, **starts})
    by = read_wrt(wrt, {**inputs, **starts, **({} if sliders is None else sliders.numbers())})
    slopes = torque_derivative(torque, derivative) if by else None
    ask = Ask(end, requested, int(branch), rtol, max_steps, deadline, by, slopes, angles, read_knots(knots))
    if sliders is not None:
        motion: Simulation = sliders.motion(ask, inputs, starts, instants)
        return motion
    motors = torque.numbers.values() if isinstance(torque, Motor) else ()
    if any(map(is_array, (*inputs.values(), *starts.values(), *motors))):
        result: Simulation = simulate_rows(ask, inputs, starts, instants, threads)
        result.inputs = {**inputs, **starts}
        return result
    return one_motion(ask, inputs, starts, instants)
