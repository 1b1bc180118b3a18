"""The flywheel for a required fluctuation of speed under a constant drive torque T, friction included.

With z = omega^2 over the crank angle, J the flywheel, M the effective inertia and L the torque of loads,
gravity and friction, (J + M) z/2 = C + W. Here W is the integral of T - L, and T the mean of L. If the speed
is between (1 - f/2) and (1 + f/2) times its mean Omega, then with b and a half the squares of these

    max(W - a M) = a J - C,   min(W - b M) = b J - C,   J = (max(W - a M) - min(W - b M))/(f Omega^2).

Friction and loads over the speed depend on z and its slope, so L is corrected until it stays, from that at
the mean speed on. The derivatives follow from those of
the torque: with G(theta, z, alpha) + J alpha = T and alpha = z'/2, the change z_p by a parameter p obeys

    z_p' = 2 (T_p - G_z z_p - G_p - J_p alpha)/(G_alpha + J),

a linear equation, in which z_p jumps by (z'_left - z'_right) times what it moves by where a jump of a load
moves with a length. It is solved for the three constants by which z_p is periodic and has its given values at
the fastest and the slowest angle.
"""

from collections.abc import Callable
from functools import partial
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np

from ...support.panels import WEIGHT, Array, Panels, resolved
from ...support.roots import root
from ..turn.turn import CREEP, Turn

ROUNDS = 60  # of corrections of the torque
SETTLED = 1e-12  # of the inertia: what a correction may still change


class FlywheelMotion(NamedTuple):
    """The motion with a flywheel, on panels: `omega`, `alpha`; where it is fastest and slowest."""

    panels: Panels
    inertia: float
    torque: float
    fastest: float
    slowest: float

    def motion(self, theta: Array) -> dict[str, Array]:
        """Speed and acceleration at angles."""
        return {name: self.panels.at(theta, v) for name, v in self.panels.values.items()}


def flywheel_for(
    design: Turn, fluctuation: float
) -> tuple[FlywheelMotion, dict[str, tuple[float, float]]] | None:
    """The motion with the smallest flywheel that keeps the required fluctuation, None if none settles.

    Besides, by each input and by `fluctuation`, the derivatives of torque and inertia.
    """
    state = _store(design, fluctuation, None)
    varies = design.has_friction or design.follows_speed
    for _ in range(ROUNDS if varies else 0):
        before, state = state, _store(design, fluctuation, state)
        if abs(state.inertia - before.inertia) <= SETTLED * abs(state.inertia):
            break
    else:
        if varies:
            return None
    return state, _gradient(design, fluctuation, state)


def _store(design: Turn, fluctuation: float, before: FlywheelMotion | None) -> FlywheelMotion:
    """One iteration: the flywheel under the loads and the friction of the previous motion."""
    names = ["T_in", "M_eff", "M_eff_wrt_theta"]
    motion = None if before is None else before.motion

    def without_friction(theta: Array) -> dict[str, Array]:
        if not design.follows_speed:
            return design.values(names, theta, omega0=design.direction * CREEP, mu=None)
        result = design.values(names, theta, motion=motion, mu=None)
        now = {"omega": design.numbers["omega0"], "alpha": 0.0} if motion is None else motion(theta)
        inertial = result["M_eff"] * now["alpha"] + 0.5 * result["M_eff_wrt_theta"] * now["omega"] ** 2
        return {**result, "T_in": result["T_in"] - inertial}

    def loads(theta: Array, row: Array) -> dict[str, Array]:
        result = without_friction(theta)
        if design.has_friction:
            rough = design.values(["T_in"], theta, motion=motion)["T_in"]
            smooth = design.values(["T_in"], theta, motion=motion, mu=None)["T_in"]
            result["T_in"] = result["T_in"] + rough - smooth
        return result

    edges = design.edges(["T_in"], motion)
    panels = resolved(loads, edges if before is None else np.append(edges, before.panels.edges))
    load, M, slope = (panels.values[name] for name in names)
    speed, drive = abs(design.numbers["omega0"]), panels.integral(load) / design.angle
    work = panels.running(drive - load)
    stored = partial(storing, panels, work, M, speed)
    J, C, fastest, slowest = stored(fluctuation)
    if J <= 0.0:  # the mechanism itself stores more than is needed
        without = _without(lambda share: stored(share)[0], fluctuation, J)
        (_, C, fastest, slowest), J = stored(max(without, 1e-9 * fluctuation)), 0.0
    inertia = np.maximum(J + M, 1e-300)
    z = np.maximum(2.0 * (C + work) / inertia, 0.0) if (J + M).any() else np.full_like(M, speed**2)
    values = {
        "omega": design.direction * np.sqrt(z),
        "alpha": (drive - load - 0.5 * slope * z) / inertia,
    }
    return FlywheelMotion(Panels(panels.edges, values), J, drive, fastest, slowest)


def storing(panels: Panels, work: Array, M: Array, speed: Any, share: Any) -> tuple[Any, Any, Any, Any]:
    """The flywheels of designs for a fluctuation, their constants C, the fastest and the slowest angles."""
    a, b = (0.5 * (speed * (1.0 + side * share / 2.0)) ** 2 for side in (1.0, -1.0))
    high, fastest, _ = panels.extreme(work - _beside(a, M) * M, 1.0)
    low, slowest, _ = panels.extreme(work - _beside(b, M) * M, -1.0)
    J = (high - low) / (share * speed**2)
    return J, a * J - high, fastest, slowest


def _beside(values: Any, nodes: Array) -> Any:
    """Numbers of designs beside the nodes of their panels."""
    return np.reshape(values, (*np.shape(values), 1, 1)) if np.ndim(values) else values


def _without(inertia: Callable[[float], float], fluctuation: float, J: float) -> float:
    """The fluctuation that needs no flywheel; infinite if the crank would stop."""
    if J == 0.0:
        return fluctuation if inertia(0.5 * fluctuation) > 0.0 else 0.0
    low, high = (1e-9 * fluctuation, fluctuation) if J < 0.0 else (fluctuation, 2.0)
    if inertia(low) <= 0.0:
        return 0.0
    return root(inertia, low, high) if inertia(high) < 0.0 else inf


def _gradient(design: Turn, fluctuation: float, state: FlywheelMotion) -> dict[str, tuple[float, float]]:
    """The derivatives of torque and inertia by parameters and fluctuation; see the head of this file."""
    own = design.moving_parameters
    if not state.inertia:  # none is needed, and a little more or less of anything changes nothing
        return dict.fromkeys((*own, "omega0", "fluctuation"), (nan, 0.0))
    names = ["T_in_wrt_omega", "T_in_wrt_alpha", *(f"T_in_wrt_{name}" for name in own)]
    panels = state.panels
    omega, alpha = panels.values["omega"], panels.values["alpha"]
    along = design.values(names, panels.x.ravel(), motion=state.motion)
    flat = {name: v.reshape(omega.shape) for name, v in along.items()}
    mass = flat["T_in_wrt_alpha"] + state.inertia
    rate = flat["T_in_wrt_omega"] / omega / mass
    growth, per_panel = panels.running(rate), np.cumsum((rate @ WEIGHT) * panels.half[:, 0])
    last = per_panel[-1]
    extremes = np.array([state.fastest, state.slowest])

    def response(forcing: Array, jump: Any = 0.0) -> tuple[float, float, float]:
        """z_p from 0, with jumps at ends of panels: at the end, the fastest and the slowest angle."""
        forced = np.exp(growth) * 2.0 * forcing / mass
        jumps = np.exp(per_panel) * jump
        inner = np.exp(-growth) * (panels.running(forced) + (np.cumsum(jumps) - jumps)[:, None])
        fastest, slowest = panels.at(extremes, inner)
        return float(np.exp(-last) * (panels.integral(forced) + jumps.sum())), float(fastest), float(slowest)

    free = [np.exp(-last) - 1.0, *panels.at(extremes, np.exp(-growth))]
    columns = np.array([free, response(np.ones_like(alpha)), response(-alpha)]).T
    speed = design.numbers["omega0"]
    high, low = 1.0 + fluctuation / 2.0, 1.0 - fluctuation / 2.0
    ends, slopes = panels.ends(2.0 * alpha), panels.at(extremes, 2.0 * alpha)
    jump, moves = ends[:, 1] - np.roll(ends[:, 0], -1), design.moves(["T_in"], panels.edges[1:])
    extremes_move = design.moves(["T_in"], extremes)
    sides = {}
    for name in own:
        result = np.array(response(-flat[f"T_in_wrt_{name}"], jump * moves.get(name, 0.0)))
        result[1:] += slopes * extremes_move.get(name, 0.0)
        sides[name] = -result
    sides["omega0"] = np.array([0.0, 2.0 * speed * high**2, 2.0 * speed * low**2])
    sides["fluctuation"] = np.array([0.0, speed**2 * high, -(speed**2) * low])
    solved = np.linalg.solve(columns, np.array(list(sides.values())).T)[1:]
    return {name: (float(T), float(J)) for name, T, J in zip(sides, *solved, strict=True)}
