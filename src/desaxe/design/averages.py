"""Measures over the crank's turn and at one angle: ("rms", name), ("mean", name), ("at", "60 deg", name).

Averages are over the angle, over as many turns as it takes loads to repeat, by Gauss's rule on panels from
edge to edge that are halved until value and derivatives are resolved.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..evaluation.under_loads.loaded import loads_of
from ..loads.angles import turns_of
from ..mechanism.catalogue import has
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, sensitivity
from ..runtime.request import as_number
from .turn.cycle import MOST_TURNS, Cycle

Array = NDArray[np.float64]
AVERAGES = ("mean", "rms")
BLOCK = 512  # designs whose panels are in memory at a time


def average(kind: str, name: str, designs: Mapping[str, Any], branch: int) -> tuple[Array, dict[str, Array]]:
    """The mean or the root of the mean square of a quantity over a turn, and its derivatives."""
    if "sliders" in designs:
        raise TypeError(f"{kind} of {name}: `drive` has those of a crankshaft's torque, `harmonics` the mean")
    inputs = _inputs(designs)
    for length in LENGTHS:
        if length not in inputs:
            as_number(length, None, LENGTHS, (f"{kind} of {name}",))
    numbers, loads = loads_of(inputs)
    turns = turns_of(f"the {kind} of {name}", loads, MOST_TURNS)
    slopes = _slopes(name, inputs)
    shape = np.broadcast_shapes(*(np.shape(v) for v in numbers.values()))
    rows = {p: np.broadcast_to(v, shape).ravel() if np.ndim(v) else v for p, v in numbers.items()}
    size = int(np.prod(shape))
    found = np.empty((1 + len(slopes), size))
    for first in range(0, size, BLOCK):
        part = slice(first, first + BLOCK)
        block = {p: v[part] if np.ndim(v) else v for p, v in rows.items()}
        found[:, part] = _averages(kind, [name, *slopes.values()], Cycle(block, loads, branch, turns), slopes)
    value, *gradient = found.reshape(-1, *shape)
    return value, dict(zip(slopes, gradient, strict=True))


def _averages(kind: str, names: list[str], cycle: Cycle, parameters: Mapping[str, str]) -> Array:
    """The average of each design and its derivatives: a jump of the quantity moves with the lengths."""
    panels = cycle.panels(names)
    value, *slopes = (panels.values[name] for name in names)
    power = 1 if kind == "mean" else 2
    after, before = (end**power for end in np.moveaxis(panels.ends(value), -1, 0))
    jump = before - np.roll(after, -1, axis=-1)
    moves = cycle.moves(names[:1], panels.edges[:, 1:])
    mean = panels.integral(value**power) / cycle.angle
    sums = [panels.integral(power * value ** (power - 1) * slope) for slope in slopes]
    moved = [(jump * moves[p]).sum(-1) if p in moves else 0.0 for p in parameters]
    gradient = [(a + b) / cycle.angle for a, b in zip(sums, moved, strict=True)]
    if kind == "mean":
        return np.array([mean, *gradient])
    with np.errstate(invalid="ignore", divide="ignore"):
        rms = np.sqrt(mean)
        return np.array([rms, *(slope / (2.0 * rms) for slope in gradient)])


def at_angle(
    angle: Any, name: str, designs: Mapping[str, Any], branch: int
) -> tuple[Array, dict[str, Array]]:
    """A quantity at one angle, and its derivatives."""
    inputs, sliders = _inputs(designs), designs.get("sliders")
    slopes = _slopes(name, inputs)
    if sliders is not None:
        inputs = {p: v for p, v in designs.items() if v is not None and p != "theta"}
        slopes = {p: f"{name}_wrt_{p}" for p, v in inputs.items() if np.ndim(v)}
    found = evaluate([name, *slopes.values()], theta=angle_of(angle), branch=branch, **inputs)
    shape = np.broadcast_shapes(*(np.shape(v) for v in inputs.values() if np.ndim(v)))
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
