"""The equations of motion, as first-order rates of (q, v, W).

With the effective moment of inertia M and the generalised torque Q of all that acts (paper C, section 3, by
Lagrange's equation), d(M omega^2/2)/dt = Q omega. In v = sqrt(M) omega that reads

    dtheta/dt = v / sqrt(M),    dv/dt = Q / sqrt(M),    dW/dt = (Q - gravity's part) omega

v^2/2 is the kinetic energy itself, M's derivative is not needed, and nothing grows without bound where M
does. q is the coordinate of `coordinate`; W is the work [J] of torque, load and friction.

Guide friction changes the acceleration, on which its force depends. T = M alpha + h + c |N|, c = mu |Y'|
sign(omega), where the normal force is N = n0 + n1 alpha + k |N| and k = branch tan(phi) mu sigma (paper C,
link 4). alpha eliminated,

    N = N_free + K |N|,    N_free = n0 + n1 alpha_free,    K = k - c n1 / M,

with alpha_free the acceleration without friction: one solution, which has the sign of N_free, where
-1 <= K sign(N_free) < 1; none above (the friction jams) and two below. Compiled loops evaluate all that
(`loops.law`); here they get the numbers of a design, and functions for what has no closed form.
"""

from collections.abc import Callable
from ctypes import CFUNCTYPE, c_double, c_int64, c_void_p, cast
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .drive import Called
from .loops import law as at
from .loops.compiled import NODES, run
from .loops.motions import LAW, single
from .model import Model
from .pieces import FunctionPieces, LawNumbers

Array = NDArray[np.float64]
JAMS_AT = 1.0 - 1e-6  # of K sign(N): a million times the force without friction counts as none
_CALLED = CFUNCTYPE(c_int64, c_int64, c_int64, c_int64)


class State(NamedTuple):
    """The state of the crank from (q, v): angle [rad] and speed [rad/s]."""

    theta: Any
    omega: Any


class Law:
    """The law of one design in compiled loops: its numbers, and the functions that they call.

    error, stops   what a function has raised, and whether that ends the motion
    """

    def __init__(self, model: Model) -> None:
        self.model, self.stops = model, False
        self.error: BaseException | None = None
        self._kept: list[Any] = []
        flat = {name: np.array([x]) for name, x in {**model.values, "mu": model.mu}.items()}
        arc = np.array([[model.coordinate.half, model.coordinate.first, model.coordinate.last]])
        terms = [(arm, factor, self._form(part)) for arm, factor, part in model.terms]
        self.known = LawNumbers(flat, model.branch, arc, model.family(), terms)
        self.numbers: Array = self.known.law[0]
        self.numbers[at.ANSWER] = self._address(self._answer)
        called = [part.needs for *_, part in model.terms if isinstance(part, Called)]
        self.timed = any("t" in needs for needs in called)
        steady = all(isinstance(part, float) for *_, part in model.terms)
        self.numbers[at.WAITS] = 0.0 if steady else 2.0 if self.timed else 1.0

    def at(self, t: Any, q: Any, v: Any, laws: Array, which: Any = None) -> Array:
        """The rows of `loops.law` at states; laws: numbers, or rows of them of which `which` says the row."""
        t, q, v = (np.ascontiguousarray(part, float) for part in np.broadcast_arrays(*np.atleast_1d(t, q, v)))
        which = np.zeros(t.size) if which is None else np.ascontiguousarray(which, float)
        out, self.error = np.empty((at.ROWS, t.size)), None
        laws = np.ascontiguousarray(np.atleast_2d(laws))
        code = run(single, work=LAW, laws=laws, which=which, t=t, q=q, v=v, data=self.known.data, out=out)
        if code == at.STOP and self.error is not None:
            raise self.error
        return out

    def alpha(self, t: float, theta: float, omega: float, law: Array) -> float:
        """The acceleration [rad/s^2] at an instant."""
        v = omega * np.sqrt(self.model.inertia(theta))
        return float(alpha_of(self.at(t, self.model.coordinate.q(theta), v, law))[0])

    # ---- what the loops call ------------------------------------------------------------------

    def _form(self, part: Any) -> Any:
        """A part of the drive as `LawNumbers` takes it."""
        if isinstance(part, float):
            return np.array([part])
        if not isinstance(part, Called):
            return part

        def values(direction: float, rows_at: int, _: int, __: int) -> None:
            rows = _memory(rows_at, 5 * NODES).reshape(5, NODES)
            instant = rows[0, 0] == rows[0, -1] and rows[1, 0] == rows[1, -1] and rows[2, 0] == rows[2, -1]
            t, theta, omega = rows[:3, :1] if instant else rows[:3]
            rows[3] = part.at(t, theta, omega, direction, *rows[4, :2].tolist())

        needs = set(part.needs)
        varies = float(bool(needs - {"t", "omega"})), float(not needs.isdisjoint({"omega", "V_C"}))
        ways = (1.0, -1.0) if part.directed else (0.0,)
        first, *_, last = [self._address(partial(values, way)) for way in ways * 2]
        return FunctionPieces((first, last), varies, *part.kinks)

    def _answer(self, rows_at: int, guide_at: int, _: int) -> None:
        """Fill in quantities, or the contact at the guide, where there is no kernel or it has no digits."""
        rows = _memory(rows_at, at.ROWS * NODES).reshape(at.ROWS, NODES)
        if not guide_at:
            theta = rows[at.ANGLE]
            theta = theta[:1] if theta[0] == theta[-1] else theta
            for k, values in enumerate(self.model.quantities(theta)):
                rows[k] = values
            return
        state = (rows[k] for k in (at.ANGLE, at.SPEED, at.ASIDE, at.PUSHED))
        for row, values in zip(
            _memory(guide_at, 4 * NODES).reshape(4, NODES), self.model.contact(*state), strict=True
        ):
            row[:] = values

    def _address(self, work: Callable[[int, int, int], None]) -> int:
        """The address of a function; loops go on after an error of a load, and stop after all others."""

        def guarded(first: int, second: int, third: int) -> int:
            if self.stops:
                return at.STOP
            try:
                work(first, second, third)
            except (ValueError, ArithmeticError) as raised:  # a load has no value: the panel may be shorter
                self.error = raised
                return at.NONE
            except BaseException as raised:
                self.error, self.stops = raised, True
                return at.STOP
            self.error = None
            return 0

        self._kept.append(_CALLED(guarded))
        return cast(self._kept[-1], c_void_p).value or 0


def alpha_of(rows: Array) -> Array:
    """The crank's acceleration [rad/s^2]: M alpha + M' omega^2/2 = Q."""
    inertia, bent = rows[at.INERTIA], 0.5 * rows[at.INERTIA_SLOPE] * rows[at.SPEED] ** 2
    return np.asarray((rows[at.RATE_V] * np.sqrt(inertia) - bent) / inertia)


def state_of(model: Model, q: Any, v: Any) -> State:
    """The crank's angle and speed."""
    arc = model.coordinate
    theta = arc.theta(q)
    inertia = model.inertia(theta)
    with np.errstate(invalid="ignore", divide="ignore"):
        omega = np.where(inertia > 0.0, v / np.sqrt(inertia), 0.0)
    return State(theta, omega) if np.ndim(q) else State(float(theta), float(omega))


def _memory(start: int, size: int) -> Array:
    memory: Any = (c_double * size).from_address(start)
    return np.frombuffer(memory)
