"""Quantities over one whole turn at constant speed.

At equal steps of the crank angle, by the fast Fourier transform, where they are smooth; across kinks and
jumps, which a table over the angle or the stroke has, in panels between them.
"""

from collections.abc import Mapping, Sequence
from math import fsum, pi
from typing import Any

import numpy as np
from numpy.fft import rfft
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...evaluation.extremes import check_range
from ...evaluation.loaded import loads_of
from ...loads.angles import kinks_between, turns_of
from ...loads.resolve import VARIABLE
from ...mechanism.inputs import INPUTS
from ...mechanism.names import LENGTHS
from ...mechanism.read import read
from ...runtime.request import as_number, check_common, check_inputs, is_steady
from ...support.computed import computed_once
from ..drive.panels import Panels, resolved

Array = NDArray[np.float64]
LEAST, MOST = 128, 131072  # steps of a turn
AT_REST = "_at_rest"
CONVERGED = 1e-14  # of the largest coefficient: what halving the steps may change


class Turn:
    """One design over a turn: its inputs, checked."""

    def __init__(self, caller: str, inputs: Mapping[str, Any], branch: int, turns: int = 1) -> None:
        inputs = {name: value for name, value in inputs.items() if name != "alpha" or not is_steady(value)}
        known = tuple(name for name in INPUTS if name not in ("theta", "alpha", "omega"))
        check_inputs(caller, inputs, known)
        check_common({}, branch)
        self.branch = branch
        given, self.loads = loads_of({n: v for n, v in inputs.items() if v is not None})
        self.numbers = {name: _number(caller, name, value) for name, value in given.items()}
        self.turns = turns_of(caller, self.loads, turns)
        for name in ("ec", "AB", "BC"):
            if name not in self.numbers:
                as_number(name, None, ("ec", "AB", "BC"), (caller,))
        lengths = (self.numbers["BC"], -self.numbers["AB"], -abs(self.numbers["ec"]))
        if fsum(lengths) < 0.0:
            raise ValueError(
                f"{caller}: the crank cannot turn fully, margin = {fsum(lengths):g} m is less than 0"
            )

    def values(self, names: Sequence[str], points: int, **other: float) -> dict[str, Array]:
        """The quantities at `points` equal steps from theta = 0; `other` inputs replace those given."""
        theta = 2.0 * pi * self.turns * np.arange(points) / points
        inputs: dict[str, Any] = {**self.numbers, **self.loads, **other}
        return self._at(names, theta, inputs)

    def panels(self, names: Sequence[str], at_rest: Sequence[str] = ()) -> Panels:
        """The quantities in panels between the angles at which a load has a kink.

        Those of `at_rest`, at the speed 0, are called `<name>_at_rest`.
        """
        inputs: dict[str, Any] = {**self.numbers, **self.loads}
        end = 2.0 * pi * self.turns

        def functions(theta: Array) -> dict[str, Array]:
            found = self._at(names, theta, inputs)
            rest = self._at(at_rest, theta, {**inputs, "omega0": 0.0}) if at_rest else {}
            found |= {f"{name}{AT_REST}": value for name, value in rest.items()}
            return {name: np.broadcast_to(value, theta.shape) for name, value in found.items()}

        breaks = sorted({0.0, *self.kinks, end})
        if self.numbers.get("mu"):
            free = {**inputs, "mu": 0.0}
            smooth = resolved(lambda theta: self._at(["N_C"], theta, free), breaks)
            breaks = sorted({*breaks, *smooth.roots(smooth.values["N_C"])})
        return resolved(functions, breaks)

    @computed_once
    def kinks(self) -> list[float]:
        """The angles at which pieces of a load meet."""
        end = 2.0 * pi * self.turns
        lengths = [self.numbers[name] for name in LENGTHS]
        return kinks_between(self.loads.values(), 0.0, end, lengths, self.branch, smooth=True)

    def _at(self, names: Sequence[str], theta: Array, inputs: Mapping[str, Any]) -> dict[str, Array]:
        """The quantities at angles; ValueError where one of them has no value."""
        found = evaluate([*names, "status"], theta=theta, branch=self.branch, **inputs)
        bad = ~np.isfinite([found[name] for name in names]).all(axis=0)
        if bad.any():
            k = int(np.argmax(bad))
            raise ValueError(
                f"{', '.join(names)}: no value at theta = {theta[k]:.6g} (status {found['status'][k]})"
            )
        return {name: found[name] for name in names}

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
            now = {n: rfft(v) / v.size for n, v in self.values(names, points).items()}
            half = points // 4
            errors = [float(np.abs(now[n][:half] - before[n][:half]).max()) for n in before]
            size = max(float(np.abs(c).max()) for c in now.values())
            error = max(errors, default=np.inf)
            if error <= CONVERGED * size or points >= MOST:
                return now, max(error, float(np.finfo(float).eps) * size)
            before, points = now, 2 * points


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
    return check_range(caller, name, read(INPUTS[name], value, caller, f"a number{more}"))
