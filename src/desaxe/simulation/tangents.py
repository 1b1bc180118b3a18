"""The derivatives of a state and its rates by q, v and parameters: exact, at one instant.

Friction takes the torque k N, of the normal force N without friction at the acceleration alpha:

    M alpha + h + k N = Q,    k = mu s Y'/(1 - mu s lean),    lean = branch tan(phi),

with s the product of the signs of N and of the slider's velocity (paper C, link 4).
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..loads.along_motion import OfMotion
from ..loads.motors import Motor
from ..mechanism.catalogue import has
from ..mechanism.names import sensitivity
from .model import Model

Array = NDArray[np.float64]
STARTS = ("theta0", "omega_start")
CREEP = 1e-100  # rad/s: a load knows the direction of the crank, inertia does not act


class Tangents:
    """The derivatives of a design's state, in rows: by q, by v, and by each parameter at fixed q and v.

    inputs  of the mechanism: numbers, and loads that vary with the motion
    """

    def __init__(self, model: Model, wrt: Sequence[str], inputs: Mapping[str, Any]) -> None:
        self.model, self.wrt, self.inputs = model, tuple(wrt), inputs
        follow = {n: a for n, a in inputs.items() if isinstance(a, OfMotion) and a.follows_speed}
        self.still = {**inputs, **dict.fromkeys(follow, 0.0)} if follow else None
        self.several = "sliders" in inputs  # whose sums have derivatives with respect to every input
        if self.several and (still := inputs["sliders"].without_speed()):
            self.still = {"sliders": still}
        torque = model.drive.torque.value
        self.motor = torque if isinstance(torque, Motor) else None
        own = self.motor.numbers if self.motor else {}
        self.of_design = [p for p in wrt if p not in (*STARTS, "torque", *own)]
        arc = model.coordinate
        self.of_limits = [self.limit(end) for end in (arc.first, arc.last)] if arc.half else []

    def flags(self, *names: str) -> Array:
        """1 for the parameters of these names, 0 for others."""
        return np.array([float(p in names) for p in self.wrt])

    def by_lengths(self, slopes: Mapping[str, float]) -> Array:
        """Derivatives by the parameters of what depends on lengths alone."""
        return np.array([slopes.get(p, 0.0) for p in self.wrt])

    def limit(self, theta: float) -> Array:
        """The shift of a limit angle."""
        return self.by_lengths(self.model.limit(theta))

    def values(
        self,
        names: Sequence[str],
        theta: Any,
        omega: Any = CREEP,
        alpha: Any = 0.0,
        mu: float | None = 0.0,
        still: bool = False,
    ) -> dict[str, Array]:
        """Quantities along the motion; loads see the direction of the crank, at rest too.

        still   without loads that depend on the speed
        """
        known = self.still if still and self.still else self.inputs
        inputs = {**known, "theta": theta, "omega": omega, "alpha": alpha, "mu": mu}
        parts = {name: name.partition(".") for name in names}
        result = evaluate(list(dict.fromkeys(head for head, *_ in parts.values())), **inputs)
        for name, (head, _, number) in parts.items():
            if number:  # by a number of a load: that by the load times the load's own
                load = known[head.rpartition("_wrt_")[2]]
                by = load.by_at(partial(evaluate, **inputs), theta, omega) if callable(load) else {}
                result[name] = result[head] * by.get(number, 0.0)
        return {name: np.broadcast_to(result[name], np.shape(theta)) for name in names}

    def _names(self, name: str, *state: str) -> list[str]:
        """A quantity and its derivatives with respect to these variables of the state and by the inputs."""
        slopes = [sensitivity(name, p) for p in ("theta", *state, *self.of_design) if not _is_mu(p)]
        return [name, *(slope for slope in slopes if self.several or has(slope.partition(".")[0], True))]

    def _rows(self, name: str, known: Mapping[str, Array], by_theta: Array, by_omega: Any = None) -> Array:
        """The derivatives of a quantity, from those of angle and speed."""
        rows = known[sensitivity(name, "theta")] * by_theta
        if by_omega is not None:
            rows = rows + known[sensitivity(name, "omega")] * by_omega
        for k, p in enumerate(self.wrt, 2):
            if p in self.of_design and p != "mu":
                rows[k] += known.get(sensitivity(name, p), 0.0)
        return rows

    def angles(self, q: Any) -> tuple[Array, Array, Array]:
        """The crank angle, its derivatives, and those of dtheta/dq."""
        arc, rows = self.model.coordinate, np.zeros((2, 2 + len(self.wrt), *np.shape(q)))
        rows[0, 0], theta = 1.0, np.asarray(arc.theta(q))
        if arc.half:
            gap = np.minimum(
                theta - arc.first, arc.last - theta
            )  # of the rounded angle, as quantities see it
            cosine = np.sqrt(np.maximum(gap * (2.0 * arc.half - gap), 0.0)) / arc.half
            sine = np.copysign(1.0 - gap / arc.half, q)
            first, last = self.of_limits
            middle, half = 0.5 * (first + last), 0.5 * (last - first)
            rows[0, 0], rows[1, 0] = arc.half * cosine, -arc.half * sine
            rows[0, 2:] = np.multiply.outer(half, sine) + middle.reshape(-1, *[1] * np.ndim(q))
            rows[1, 2:] = np.multiply.outer(half, cosine)
        return theta, rows[0], rows[1]

    def angle(self, q: float, y: Array) -> Array:
        """The derivative of the crank angle by the parameters at a fixed time; y: those of q and v."""
        _, rows, _ = self.angles(q)
        return np.asarray(rows[0] * y[0] + rows[2:])

    def speeds(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The derivatives of angle and speed."""
        theta, by_theta, _ = self.angles(q)
        known = self.values(self._names("M_eff"), theta)
        root = np.sqrt(known["M_eff"])
        rows = -v / root * (self._rows("M_eff", known, by_theta) / (2.0 * known["M_eff"]))
        rows[1] += 1.0 / root
        return by_theta, rows

    def rates(self, t: Array, q: Array, v: Array, signs: Array, alpha: Any) -> Array:
        """The derivatives of the rates of q and v: two rows of them.

        signs   of the slider's velocity over that of the crank, and of the normal force, held under friction
        alpha   the acceleration, for several sliders
        """
        theta, by_theta, bent = self.angles(q)
        names = [*self._names("M_eff"), *self._names("T_in")]
        known = self.values(names, theta, np.copysign(CREEP, v), still=True)
        inertia, slope = known["M_eff"], by_theta[0]
        root, log = np.sqrt(inertia), self._rows("M_eff", known, by_theta) / (2.0 * inertia)
        omega = v / root
        by_omega = -omega * log
        by_omega[1] += 1.0 / root
        flat = self.model.drive.torque.slopes(*(part.reshape(-1) for part in (t, theta, omega)))
        torque, *slopes = (np.broadcast_to(part, t.size).reshape(t.shape) for part in flat)
        of_torque = slopes[0] * by_theta + slopes[1] * by_omega
        of_torque[2:] += self.flags("torque").reshape(-1, *[1] * t.ndim)
        for name, by_number in (self.motor.by(omega, self.motor.numbers) if self.motor else {}).items():
            of_torque[2:] += np.multiply.outer(self.flags(name), by_number)
        push = torque - known["T_in"]
        of_push = of_torque - self._rows("T_in", known, by_theta)
        if self.still:
            for sign, still in ((1.0, False), (-1.0, True)):  # inertia cancels
                moving = self.values(self._names("T_in", "omega"), theta, omega, still=still)
                push = push - sign * moving["T_in"]
                of_push = of_push - sign * self._rows("T_in", moving, by_theta, by_omega)
        if self.model.friction != 0.0 or "mu" in self.wrt:
            state = _State(theta, omega, by_theta, by_omega)
            if self.several:
                taken, of_taken = self._of_guides(state, alpha, of_torque)
            else:
                taken, of_taken = self._friction(state, inertia, torque, of_torque, signs)
            push, of_push = push - taken, of_push - of_taken
        return np.stack([(by_omega - omega * bent / slope) / slope, (of_push - push * log) / root])

    def _friction(
        self, state: "_State", inertia: Array, torque: Any, of_torque: Array, signs: Array
    ) -> tuple[Array, Array]:
        """The torque that friction takes, and its derivatives."""
        theta, omega, by_theta, by_omega = state
        names = ["N_C_wrt_alpha", *self._names("phi"), *self._names("Y_wrt_theta")]
        known = self.values(["T_in", "N_C", *names], theta, omega)
        mu, normal, by_alpha = self.model.mu, known["N_C"], known["N_C_wrt_alpha"]
        side = signs[0] * signs[1]
        lean, travel = self.model.branch * np.tan(known["phi"]), known["Y_wrt_theta"]
        room = 1.0 - mu * side * lean
        arm = mu * side * travel / room
        alpha = (torque - known["T_in"] - arm * normal) / (inertia + arm * by_alpha)
        names = [*self._names("T_in", "omega"), *self._names("N_C", "omega")]
        known |= self.values(names, theta, omega, alpha)
        if not mu:  # no sign is held
            side = np.sign(travel * omega * known["N_C"])
        of_mu = np.array([0.0, 0.0, *self.flags("mu")]).reshape(-1, *[1] * theta.ndim)
        of_lean = self.model.branch / np.cos(known["phi"]) ** 2 * self._rows("phi", known, by_theta)
        of_arm = side * (of_mu * travel + mu * self._rows("Y_wrt_theta", known, by_theta)) / room
        of_arm += arm * side * (of_mu * lean + mu * of_lean) / room
        of_normal = self._rows("N_C", known, by_theta, by_omega)
        of_alpha = of_torque - self._rows("T_in", known, by_theta, by_omega)
        of_alpha = (of_alpha - of_arm * known["N_C"] - arm * of_normal) / (inertia + arm * by_alpha)
        return arm * known["N_C"], of_arm * known["N_C"] + arm * (of_normal + by_alpha * of_alpha)

    def _of_guides(self, state: "_State", alpha: Any, of_torque: Array) -> tuple[Array, Array]:
        """The torque that the guides of several sliders take: that with friction less that without."""
        theta, omega, *by_state = state
        names = self._names("T_in", "omega", "alpha")
        of_mu = {k: f"T_in_wrt_{p}" for k, p in enumerate(self.wrt, 2) if _is_mu(p)}
        there = self.values([*names, *of_mu.values()], theta, omega, alpha, mu=None)
        free = self.values(names, theta, omega, alpha)
        of_there = self._rows("T_in", there, *by_state)
        for k, name in of_mu.items():
            of_there[k] = there[name]
        of_alpha = (of_torque - of_there) / there["T_in_wrt_alpha"]
        more = (there["T_in_wrt_alpha"] - free["T_in_wrt_alpha"]) * of_alpha
        return there["T_in"] - free["T_in"], of_there - self._rows("T_in", free, *by_state) + more

    def energy(self, q: Any, v: Any, y: Array) -> Array:
        """The derivatives of the energy by the parameters at a fixed time; y: those of q and v."""
        theta, by_theta, _ = self.angles(q)
        rows = self._rows("potential_energy", self.values(self._names("potential_energy"), theta), by_theta)
        return np.asarray(rows[0] * y[0] + v * y[1] + rows[2:])


def _is_mu(parameter: str) -> bool:
    """True for the friction of a guide, or of a slider's."""
    return parameter.partition("[")[0] == "mu"


class _State(NamedTuple):
    """Angle, speed and their derivatives."""

    theta: Array
    omega: Array
    by_theta: Array
    by_omega: Array
