"""Measures over the crank's turn and at one angle: ("rms", name), ("mean", name), ("at", "60 deg", name).

Averages are over the angle, over as many turns as it takes loads to repeat, by Gauss's rule on panels from
edge to edge that are halved until value and derivatives are resolved.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..loads.angles import turns_of
from ..mechanism.catalogue import has
from ..mechanism.inputs import INPUTS
from ..mechanism.names import sensitivity
from ..runtime.request import as_number
from .turn.cycle import MOST_TURNS, Cycle, integrated
from .turn.rows import input_rows

Array = NDArray[np.float64]
AVERAGES = ("mean", "rms")
BLOCK = 512  # designs whose panels are in memory at a time


def average(kind: str, name: str, designs: Mapping[str, Any], branch: int) -> tuple[Array, dict[str, Array]]:
    """The mean or the root of the mean square of a quantity over a turn, and its derivatives."""
    if "sliders" in designs:
        raise TypeError(f"{kind} of {name}: `drive` has those of a crankshaft's torque, `harmonics` the mean")
    inputs = _inputs(designs)
    slopes, rows = _slopes(name, inputs), input_rows(f"{kind} of {name}", inputs)
    turns = turns_of(f"the {kind} of {name}", rows.loads, MOST_TURNS)
    cycle = Cycle(rows.numbers, rows.loads, branch, turns)
    blocks = [np.arange(first, min(first + BLOCK, rows.size)) for first in range(0, rows.size, BLOCK)]
    averages = [_averages(kind, [name, *slopes.values()], cycle.part(block), slopes) for block in blocks]
    value, *gradient = np.concatenate(averages, axis=1).reshape(-1, *rows.shape)
    return value, dict(zip(slopes, gradient, strict=True))


def _averages(kind: str, names: list[str], cycle: Cycle, parameters: Mapping[str, str]) -> Array:
    """The average of each design and its derivatives: a jump of the quantity moves with the lengths."""
    panels = cycle.panels(names)
    value, *slopes = (panels.values[name] for name in names)
    power = 1 if kind == "mean" else 2
    after, before = (end**power for end in np.moveaxis(panels.ends(value), -1, 0))
    by = dict(zip(parameters, (power * value ** (power - 1) * slope for slope in slopes), strict=True))
    moves = cycle.moves(names[:1], panels.edges[:, 1:])
    total, gradient = integrated(panels, value**power, before - np.roll(after, -1, axis=-1), by, moves)
    means = np.array([total, *gradient.values()]) / cycle.angle
    if kind == "rms":
        with np.errstate(invalid="ignore", divide="ignore"):
            means[0] = np.sqrt(means[0])
            means[1:] /= 2.0 * means[0]
    return means


def at_angle(
    angle: Any, name: str, designs: Mapping[str, Any], branch: int
) -> tuple[Array, dict[str, Array]]:
    """A quantity at one angle, or at the angle of each design where `angle` is None, and its derivatives."""
    given = {p: v for p, v in designs.items() if v is not None and p != "theta"}
    given["theta"] = designs.get("theta") if angle is None else angle_of(angle)
    varying = {p: f"{name}_wrt_{p}" for p, v in given.items() if np.ndim(v)}
    inputs = {p: v for p, v in given.items() if p != "theta" or p in varying}
    slopes = varying if "sliders" in given else _slopes(name, inputs)
    found = evaluate([name, *slopes.values()], branch=branch, **given)
    shape = np.broadcast_shapes(*(np.shape(given[p]) for p in varying))
    full = {n: np.broadcast_to(array, shape) for n, array in found.items()}
    return full[name], {p: full[slope] for p, slope in slopes.items()}


def angle_of(angle: Any) -> float:
    """The angle of a measure in radians; ValueError or TypeError where it is none."""
    number = as_number("theta", angle, ("theta",), ("at",))
    if number is None:
        raise TypeError(f"at = {angle!r}: expected one angle, such as '60 deg'")
    return number


def _inputs(designs: Mapping[str, Any]) -> dict[str, Any]:
    given = {p: v for p, v in designs.items() if v is not None and p in INPUTS and p != "theta"}
    return {p: v if callable(v) else np.asarray(v, float) for p, v in given.items()}


def _slopes(name: str, inputs: Mapping[str, Any]) -> dict[str, str]:
    """The names of the derivatives by the inputs that vary, by all inputs of one design."""
    varying = [p for p, v in inputs.items() if not callable(v) and np.ndim(v)]
    slopes = {p: sensitivity(name, p) for p in varying or inputs if not callable(inputs[p])}
    return {p: slope for p, slope in slopes.items() if has(slope, "omega" in inputs)}
