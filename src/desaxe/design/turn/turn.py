"""Quantities over one whole turn at constant speed, at equal steps of the crank angle."""

from collections.abc import Callable, Mapping, Sequence
from math import fsum, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...mechanism.inputs import INPUTS
from ...runtime.request import as_number, check_common, check_inputs

Array = NDArray[np.float64]
LEAST, MOST = 128, 131072  # steps of a turn
CONVERGED = 1e-14  # of the largest coefficient: what halving the steps may change
FUNCTIONS = ("F_X", "F_Y")  # loads that may change over the turn


class Turn:
    """One design over a turn: its inputs, checked."""

    def __init__(self, caller: str, inputs: Mapping[str, Any], branch: int) -> None:
        known = tuple(name for name in INPUTS if name not in ("theta", "alpha", "omega"))
        check_inputs(caller, inputs, known)
        check_common({}, branch)
        self.branch = branch
        self.functions: dict[str, Callable[[Array], Any]] = {
            name: value for name, value in inputs.items() if callable(value) and name in FUNCTIONS
        }
        given = {n: v for n, v in inputs.items() if v is not None and n not in self.functions}
        self.numbers = {name: _number(caller, name, value) for name, value in given.items()}
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
        theta = 2.0 * pi * np.arange(points) / points
        loads = {name: _loads(name, function, theta) for name, function in self.functions.items()}
        inputs: dict[str, Any] = {**self.numbers, **loads, **other}
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
            now = {n: np.fft.rfft(v) / v.size for n, v in self.values(names, points).items()}
            half = points // 4
            errors = [float(np.abs(now[n][:half] - before[n][:half]).max()) for n in before]
            size = max(float(np.abs(c).max()) for c in now.values())
            error = max(errors, default=np.inf)
            if error <= CONVERGED * size or points >= MOST:
                return now, max(error, float(np.finfo(float).eps) * size)
            before, points = now, 2 * points


def _loads(name: str, function: Callable[[Array], Any], theta: Array) -> Array:
    """A load at these angles, of a function of an array or of one angle; an error that names the load."""
    try:
        found = np.asarray(function(theta), float)
    except Exception:  # such as math.cos(theta), or a condition on theta: it takes one angle
        found = np.array([_load(name, function, angle) for angle in theta.tolist()])
    if found.shape not in ((), theta.shape):
        raise ValueError(f"{name}: a function of {theta.shape[0]} angles gave the shape {found.shape}")
    if not np.isfinite(found).all():
        raise ValueError(f"{name}: the function gave {found[~np.isfinite(found)].flat[0]}; it must be finite")
    return np.broadcast_to(found, theta.shape)


def _load(name: str, function: Callable[[Any], Any], angle: float) -> float:
    try:
        return float(function(angle))
    except Exception as error:
        raise ValueError(f"{name}: the function failed at theta = {angle:.6g}: {error!r}") from error


def extreme(values: Array, sign: float) -> tuple[float, float]:
    """The largest (sign 1) or smallest (-1) value over a turn and its angle, by a parabola."""
    k = int(np.argmax(sign * values))
    before, top, after = (float(values[(k + i) % values.size]) for i in (-1, 0, 1))
    bend = before - 2.0 * top + after
    shift = 0.5 * (before - after) / bend if bend else 0.0
    theta = 2.0 * pi * (k + shift) / values.size
    return top - 0.25 * (before - after) * shift, theta % (2.0 * pi)


def _number(caller: str, name: str, value: Any) -> float:
    number = as_number(name, value, (name,), (caller,))
    if number is None:
        more = " or a function of theta" if name in FUNCTIONS else ""
        raise TypeError(f"{name}: {caller} takes a number{more}, got {type(value).__name__}")
    return number
