"""Measures over the crank's turn and at one angle: ("rms", name), ("mean", name), ("at", "60 deg", name).

Averages are over the angle, by Gauss's rule on equal panels: of a smooth quantity all digits are right, and
kinks and jumps, which friction makes, cost some.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..mechanism.catalogue import has
from ..mechanism.inputs import INPUTS
from ..mechanism.names import sensitivity
from ..runtime.request import as_number

Array = NDArray[np.float64]
AVERAGES = ("mean", "rms")
PANELS, POINTS = 64, 8


def average(kind: str, name: str, designs: Mapping[str, Any], branch: int) -> tuple[Array, dict[str, Array]]:
    """The mean or the root of the mean square of a quantity over a turn, and its derivatives."""
    angles, weights = _rule()
    value, slopes = _along(name, angles, designs, branch)
    if kind == "mean":
        return value @ weights, {p: slope @ weights for p, slope in slopes.items()}
    with np.errstate(invalid="ignore", divide="ignore"):
        rms = np.sqrt((value * value) @ weights)
        return rms, {p: (value * slope) @ weights / rms for p, slope in slopes.items()}


def at_angle(
    angle: Any, name: str, designs: Mapping[str, Any], branch: int
) -> tuple[Array, dict[str, Array]]:
    """A quantity at one angle, and its derivatives."""
    value, slopes = _along(name, np.array([angle_of(angle)]), designs, branch)
    return value[..., 0], {p: slope[..., 0] for p, slope in slopes.items()}


def angle_of(angle: Any) -> float:
    """The angle of a measure in radians; ValueError or TypeError where it is none."""
    number = as_number("theta", angle, ("theta",), ("at",))
    if number is None:
        raise TypeError(f"at = {angle!r}: expected one angle, such as '60 deg'")
    return number


def _along(
    name: str, angles: Array, designs: Mapping[str, Any], branch: int
) -> tuple[Array, dict[str, Array]]:
    """Values and derivatives by the varying inputs (all inputs of one design): designs, then angles."""
    given = {p: v for p, v in designs.items() if v is not None and p in INPUTS and p != "theta"}
    wide: dict[str, Any]
    wide = {p: v if callable(v) else np.asarray(v, float)[..., None] for p, v in given.items()}
    state = "omega" in given
    varying = [p for p, v in given.items() if not callable(v) and np.ndim(v)]
    slopes = {p: sensitivity(name, p) for p in varying or given if not callable(given[p])}
    slopes = {p: slope for p, slope in slopes.items() if has(slope, state)}
    found = evaluate([name, *slopes.values()], theta=angles, branch=branch, **wide)
    shape = np.broadcast_shapes(*(np.shape(v) for v in wide.values() if not callable(v)), angles.shape)
    full = {n: np.broadcast_to(array, shape) for n, array in found.items()}
    return full[name], {p: full[slope] for p, slope in slopes.items()}


@cache
def _rule() -> tuple[Array, Array]:
    """Angles of one turn, and weights whose sum is 1."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    starts = np.arange(PANELS)[:, None]
    angles = (starts + 0.5 * (nodes + 1.0)) * (2.0 * np.pi / PANELS)
    return angles.reshape(-1), np.tile(weights / (2.0 * PANELS), PANELS)


class OwnMeasure:
    """A user's function of a design (a dict of parameters) that returns a value and a dict of derivatives."""

    def __init__(self, function: Any) -> None:
        self.function = function
        self.name = getattr(function, "__name__", "function")

    def __call__(self, designs: Mapping[str, Any]) -> tuple[Array, dict[str, Array]]:
        """Values and derivatives of designs, one after the other."""
        numbers = {p: np.asarray(v, float) for p, v in designs.items() if v is not None and not callable(v)}
        shape = np.broadcast_shapes(*(v.shape for v in numbers.values()))
        rows = {p: np.broadcast_to(v, shape).reshape(-1) for p, v in numbers.items()}
        size = int(np.prod(shape))
        answers = [self._one({p: float(v[row]) for p, v in rows.items()}) for row in range(size)]
        value = np.array([answer[0] for answer in answers]).reshape(shape)
        names = dict.fromkeys(p for _, gradient in answers for p in gradient)
        return value, {
            p: np.array([gradient.get(p, 0.0) for _, gradient in answers]).reshape(shape) for p in names
        }

    def _one(self, design: dict[str, float]) -> tuple[float, Mapping[str, float]]:
        try:
            value, gradient = self.function(design)
            return float(value), {p: float(slope) for p, slope in gradient.items()}
        except (TypeError, ValueError, AttributeError) as error:
            raise TypeError(
                f"{self.name}(design) must give (value, {{parameter: derivative}}) of numbers: {error}"
            ) from error
