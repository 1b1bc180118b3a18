"""One design over a cycle: the turn, or the turns after which its loads repeat.

Quantities at equal steps of the crank angle, by the fast Fourier transform, where they are smooth; else in
panels between the angles at which friction and tables of loads have kinks and jumps.
"""

from collections.abc import Callable, Mapping, Sequence
from math import copysign, fsum, pi
from typing import Any

import numpy as np
from numpy.fft import rfft
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...evaluation.extremes import check_range
from ...evaluation.under_loads.loaded import loads_of
from ...loads.angles import crossings, kinks_between, turns_of
from ...loads.load import OverY
from ...loads.resolve import VARIABLE
from ...mechanism.closed import TURN
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.inputs import INPUTS
from ...mechanism.keywords import check_inputs
from ...mechanism.names import LENGTHS
from ...mechanism.read import read
from ...mechanism.spoken import spoken
from ...mechanism.status import PointStatus
from ...runtime.request import as_number, check_common, is_steady, request
from ...support.computed import computed_once
from ...support.panels import Array, Panels, resolved

LEAST, MOST = 128, 131072  # steps of a turn
MOST_TURNS = 4  # after which the loads must repeat; two in a four-stroke engine
CONVERGED = 1e-14  # of the largest coefficient: what halving the steps may change
CREEP = 1e-100  # rad/s: friction and loads have their way, inertia does nothing; a torque below it is none
NEAR = 1e-9  # rad: an edge is where a load jumps
JAMS = int(PointStatus.NO_FORCE_BALANCE)
Motion = Callable[[Array], dict[str, Array]]  # angles -> omega and alpha there


class NoCycleError(ValueError):
    """A quantity is undefined at some angle of the turn; `status` is the reason."""

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status


class Turn:
    """The inputs of one design, checked; its quantities over its cycle."""

    def __init__(
        self, caller: str, inputs: Mapping[str, Any], branch: int, accelerates: bool = False
    ) -> None:
        inputs = {name: v for name, v in inputs.items() if name != "alpha" or not is_steady(v)}
        known = [n for n in INPUTS if n not in ("theta", "omega") and (accelerates or n != "alpha")]
        check_inputs(caller, inputs, known)
        check_common({}, branch)
        self.branch = int(branch)
        given, self.loads = loads_of({name: value for name, value in inputs.items() if value is not None})
        self.turns = turns_of(caller, self.loads, MOST_TURNS)
        self.numbers = {name: _number(caller, name, value) for name, value in given.items()}
        for name in LENGTHS:
            if name not in self.numbers:
                as_number(name, None, LENGTHS, (caller,))

    @computed_once
    def parameters(self) -> tuple[str, ...]:
        """The inputs that are numbers and matter to the torque."""
        return self._parameters(self.numbers)

    @computed_once
    def moving_parameters(self) -> tuple[str, ...]:
        """The inputs that are numbers and matter to the torque at a varying speed, but for the speed."""
        state = {"omega": 1.0, "alpha": 1.0}
        numbers = {n: value for n, value in self.numbers.items() if n != "omega0"}
        return tuple(n for n in self._parameters({**numbers, **state}) if n not in state)

    def _parameters(self, numbers: Mapping[str, float]) -> tuple[str, ...]:
        asked = request(("T_in",), {**numbers, **self.loads}, self.branch, "standard")
        return tuple(n for n in asked.inputs if n != "theta" and n not in self.loads)

    @property
    def direction(self) -> float:
        """1 where the crank turns forwards, -1 backwards."""
        return copysign(1.0, self.numbers.get("omega0", 1.0))

    @property
    def angle(self) -> float:
        """The angle of the cycle [rad], > 0."""
        return 2.0 * pi * self.turns

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest angle of the cycle; it begins at 0, in the way of turning."""
        return (0.0, self.angle) if self.direction > 0.0 else (-self.angle, 0.0)

    @property
    def margin(self) -> float:
        """BC - AB - |ec|, rounded once."""
        return fsum((self.numbers["BC"], -self.numbers["AB"], -abs(self.numbers["ec"])))

    @property
    def has_friction(self) -> bool:
        """True if the guide has friction."""
        return bool(self.numbers.get("mu"))

    def values(
        self, names: Sequence[str], theta: Array, motion: Motion | None = None, **other: Any
    ) -> dict[str, Array]:
        """Quantities at angles. `motion` returns the state there; `other` replaces inputs of the design."""
        state = {} if motion is None else {**motion(theta), "omega0": None}
        inputs = {**self.numbers, **self.loads, **state, **other}
        present = {name: value for name, value in inputs.items() if value is not None}
        found = evaluate([*names, "status"], theta=theta, branch=self.branch, **present)
        status = found.pop("status")
        bad = ~np.isfinite([found[name] for name in names]).all(0)
        if bad.any():
            codes, k = status[bad], int(np.argmax(bad))
            why = JAMS if JAMS in codes else int(codes[0]) or 4
            angle = spoken("theta", theta[k], ".6g")
            told = f"{', '.join(names)}: no value at theta = {angle} (status {status[k]})"
            raise NoCycleError(told, why)
        return {name: np.broadcast_to(found[name], theta.shape) for name in names}

    @computed_once
    def kinks(self) -> list[float]:
        """The angles at which pieces of a load meet."""
        lengths = [self.numbers[name] for name in LENGTHS]
        return kinks_between(self.loads.values(), *self.ends, lengths, self.branch, smooth=True)

    def moves(self, angles: Array) -> dict[str, Array]:
        """By how much each length moves angles [1/m] at which a load over the slider jumps; 0 elsewhere."""
        lengths: dict[str, Any] = {name: self.numbers[name] for name in LENGTHS}
        sides = [np.array([length]) for length in lengths.values()]
        found = {name: np.zeros(angles.shape) for name in LENGTHS}
        for load in self.loads.values():
            if not isinstance(load, OverY) or not load.jumps:
                continue
            gap = np.abs(np.subtract.outer(angles, crossings(load, load.jumps, sides, self.branch)[0])) % TURN
            own = (np.minimum(gap, TURN - gap) < NEAR).any(-1)
            at = evaluate(
                load.motion(("theta", *LENGTHS)), theta=angles[own], branch=self.branch, omega0=1.0, **lengths
            )
            along = load.moved("theta", at)
            for name in LENGTHS:  # at a dead centre the torque does not jump
                found[name][own] = np.where(along == 0.0, 0.0, -load.moved(name, at) / along)
        return found

    def breaks(self, motion: Motion | None = None, edges: Sequence[float] = (), **other: Any) -> list[float]:
        """The ends of the cycle, the angles at which the torque has a kink, and `edges`, in order."""
        low, high = self.ends
        places = closed_form(DEAD_CENTRES, ("theta_outer", "theta_inner"), branch=float(self.branch))
        own = [
            low + (angle - low) % (2.0 * pi) for angle in places.point(*(self.numbers[n] for n in LENGTHS))
        ]
        own = [angle + 2.0 * pi * k for angle in own for k in range(self.turns)]
        found = sorted({low, *own, *edges, *self.kinks, high})
        if self.has_friction:

            def normal_force(theta: Array) -> dict[str, Array]:
                return self.values(["N_C"], theta, motion, **other, mu=None)

            smooth = resolved(normal_force, found)
            found += smooth.roots(smooth.values["N_C"]).tolist()
        return sorted(found)

    def panels(self, names: Sequence[str], **other: Any) -> Panels:
        """Quantities over the cycle, in panels on which each is a polynomial."""
        return resolved(lambda theta: self.values(names, theta, **other), self.breaks(**other))

    def samples(self, names: Sequence[str], points: int) -> dict[str, Array]:
        """The quantities at `points` equal steps of one turn from theta = 0."""
        return self.values(names, 2.0 * pi * np.arange(points) / points)

    def spectrum(
        self, names: Sequence[str], least: int = LEAST
    ) -> tuple[dict[str, NDArray[np.complex128]], float]:
        """Complex Fourier coefficients c_0, c_1, ... of exp(i n theta), and their error.

        Steps are halved until that changes the lower half of the coefficients by no more than rounding. What
        it changed is the error of the coarser ones, so it bounds that of the finer.
        """
        points = max(LEAST, 1 << (2 * least - 1).bit_length())
        before: dict[str, NDArray[np.complex128]] = {}
        while True:
            now = {n: rfft(v) / v.size for n, v in self.samples(names, points).items()}
            half = points // 4
            errors = [float(np.abs(now[n][:half] - before[n][:half]).max()) for n in before]
            size = max(float(np.abs(c).max()) for c in now.values())
            error = max(errors, default=np.inf)
            if error <= CONVERGED * size or points >= MOST:
                return now, max(error, float(np.finfo(float).eps) * size)
            before, points = now, 2 * points


def one_turn(caller: str, inputs: Mapping[str, Any], branch: int) -> Turn:
    """A design that turns fully, under loads that repeat after a turn, at constant speed."""
    turn = Turn(caller, inputs, branch)
    turns_of(caller, turn.loads, 1)
    if turn.margin < 0.0:
        raise cannot_turn(caller, turn)
    return turn


def cannot_turn(caller: str, turn: Turn) -> ValueError:
    """The error for a design whose crank cannot turn fully."""
    margin = spoken("margin", turn.margin, "g", says_unit=True)
    return ValueError(f"{caller}: the crank cannot turn fully, margin = {margin} is less than 0")


def extreme(values: Array, sign: float) -> tuple[float, float]:
    """The largest (sign 1) or smallest (-1) value over a turn and its angle, by a parabola."""
    k = int(np.argmax(sign * values))
    before, top, after = (float(values[(k + i) % values.size]) for i in (-1, 0, 1))
    bend = before - 2.0 * top + after
    shift = 0.5 * (before - after) / bend if bend else 0.0
    theta = 2.0 * pi * (k + shift) / values.size
    return top - 0.25 * (before - after) * shift, theta % (2.0 * pi)


def _number(caller: str, name: str, value: Any) -> float:
    more = " or a function of theta, over_theta or over_Y" if name in VARIABLE else ""
    each = f"[desaxe.{caller}({name}=value, ...) for value in values]"
    one = f"one number{more}, for one design; call it for each of them, as in {each}"
    return check_range(caller, name, read(INPUTS[name], value, caller, one))
