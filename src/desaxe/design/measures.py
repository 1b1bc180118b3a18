"""Quantities of a whole design by name, for many designs at once: value and exact derivatives.

A measure is a quantity of the whole design, the largest speed of a stroke, a peak or an average over the
crank angle as (kind, quantity), or a quantity at one angle: "margin", "stroke", ("absmax", "a_C"),
("rms", "T_in"), ("at", "60 deg", "Y"). It may also be a function of a design (a dict) that gives its value
and a dict of its derivatives.

Averages are over the angle, over as many turns as it takes loads to repeat, by Gauss's rule on panels from
edge to edge that are halved until value and derivatives are resolved.
"""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple
from warnings import catch_warnings, simplefilter

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..evaluation.reductions.own_measure import OwnMeasure
from ..loads.angles import turns_of
from ..loads.load import LoadWarning
from ..mechanism.catalogue import has, of_design, quantities, quantity
from ..mechanism.closed.limits import margin_of
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, WHOLE, parts, sensitivity
from ..mechanism.spelling import meant
from ..peaks.designs import KINDS
from ..peaks.peak import peak
from ..runtime.request import as_number
from ..support.shown import shown
from .events.events import VELOCITIES, events_of_arrays
from .turn.cycle import MOST_TURNS, Cycle, input_rows, integrated

Array = NDArray[np.float64]

AVERAGES = ("mean", "rms")
BLOCK = 512  # designs whose panels are in memory at a time


def average(kind: str, name: str, designs: Mapping[str, Any], branch: int) -> tuple[Array, dict[str, Array]]:
    """The mean or the root of the mean square of a quantity over a turn, and its derivatives."""
    if "sliders" in designs:
        slopes, shape, cycles = designs["sliders"].cycles(f"{kind} of {name}", name, designs)
    else:
        inputs = _inputs(designs)
        slopes, rows = _slopes(name, inputs), input_rows(f"{kind} of {name}", inputs)
        turns, shape = turns_of(f"the {kind} of {name}", rows.loads, MOST_TURNS), rows.shape
        cycle = Cycle(rows.numbers, rows.loads, branch, turns)
        firsts = range(0, rows.size, BLOCK)
        cycles = [cycle.part(np.arange(first, min(first + BLOCK, rows.size))) for first in firsts]
    averages = [_averages(kind, [name, *slopes.values()], cycle, slopes) for cycle in cycles]
    value, *gradient = np.concatenate(averages, axis=1).reshape(-1, *shape)
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
    result = evaluate([name, *slopes.values()], branch=branch, **given)
    shape = np.broadcast_shapes(*(np.shape(given[p]) for p in varying))
    full = {n: np.broadcast_to(array, shape) for n, array in result.items()}
    return full[name], {p: full[slope] for p, slope in slopes.items()}


def angle_of(angle: Any) -> float:
    """The angle of a measure in radians; ValueError or TypeError where it is none."""
    number = as_number("theta", angle, ("theta",), ("at",))
    if number is None:
        raise TypeError(f"at = {angle!r}: expected one angle, such as '60 deg'")
    return number


def _inputs(designs: Mapping[str, Any]) -> dict[str, Any]:
    inputs = {p: v for p, v in designs.items() if v is not None and p in INPUTS and p != "theta"}
    return {p: v if callable(v) else np.asarray(v, float) for p, v in inputs.items()}


def _slopes(name: str, inputs: Mapping[str, Any]) -> dict[str, str]:
    """The names of the derivatives with respect to the inputs that vary, by all inputs of one design."""
    varying = [p for p, v in inputs.items() if not callable(v) and np.ndim(v)]
    slopes = {p: sensitivity(name, p) for p in varying or inputs if not callable(inputs[p])}
    return {p: slope for p, slope in slopes.items() if has(slope, "omega" in inputs)}


Measure = str | tuple[Any, ...] | OwnMeasure
NAMED = ("margin", *WHOLE, *VELOCITIES)


class Measured(NamedTuple):
    """Values of one measure over designs, and their derivatives with respect to its parameters."""

    value: Array
    gradient: Mapping[str, Array]


def is_named(measure: Any) -> bool:
    """True for the name of a measure: a quantity of the whole design, no derivative, or a velocity."""
    if not isinstance(measure, str) or not (measure in VELOCITIES or has(measure)):
        return False
    return measure in VELOCITIES or (of_design(measure) and not parts(measure)[1])


def checked(measure: Any) -> Measure:
    """A measure in its canonical form; ValueError that lists the valid ones."""
    if isinstance(measure, OwnMeasure):
        return measure
    if callable(measure):
        return OwnMeasure(measure)
    pair = isinstance(measure, (tuple, list)) and len(measure) == 2 and isinstance(measure[0], str)
    if pair and measure[0] in (*KINDS, *AVERAGES):
        quantity(measure[1])
        return str(measure[0]), str(measure[1])
    if isinstance(measure, (tuple, list)) and len(measure) == 3 and measure[0] == "at":
        angle_of(measure[1])
        quantity(measure[2])
        return "at", measure[1], str(measure[2])
    if is_named(measure):
        return str(measure)
    pair = isinstance(measure, (tuple, list)) and len(measure) == 2 and isinstance(measure[0], str)
    near = meant(measure[0], KINDS) if pair else meant(measure, NAMED) if isinstance(measure, str) else []
    hint = f"did you mean {((near[0], measure[1]) if pair else near[0])!r}? " if near else ""
    if isinstance(measure, str) and not near and (peaks := meant(measure, quantities())):
        hint = f"did you mean ('absmax', {peaks[0]!r})? "
    there = f"{'There' if hint else 'there'} are {', '.join(NAMED)}"
    raise ValueError(
        f"{shown(measure)} is not a quantity of a design; {hint}{there} and the peaks, "
        f'such as ("absmax", "a_C"), of the kinds {", ".join((*KINDS, *AVERAGES))}, '
        'and ("at", "60 deg", "a_C")'
    )


def text_of(measure: Measure) -> str:
    """The name of a measure for messages."""
    if isinstance(measure, OwnMeasure):
        return measure.name
    return measure if isinstance(measure, str) else " ".join(map(str, measure))


def measured(
    measures: Iterable[Measure], designs: Mapping[str, Any], branch: int = 1
) -> dict[Measure, Measured]:
    """Every measure over designs: parameters by name, numbers and arrays of one shape."""
    result: dict[Measure, Measured] = {}
    requested = list(dict.fromkeys(measures))
    message = _events(requested, designs, branch)
    for measure in requested:
        if measure == "margin":
            result[measure] = _margin(*(np.asarray(designs[n], float) for n in LENGTHS))
        elif isinstance(measure, str):
            own = None if measure in message else _own(measure, designs, branch)
            result[measure] = own or Measured(message[measure], message["gradient"][measure])
        elif callable(measure):
            result[measure] = Measured(*measure(designs))
        elif measure[0] == "at":
            result[measure] = Measured(*at_angle(measure[1], measure[2], designs, branch))
        elif measure[0] in AVERAGES:
            result[measure] = Measured(*average(measure[0], measure[1], designs, branch))
        else:
            kind, name = measure
            with catch_warnings():
                simplefilter("ignore", LoadWarning)  # of an array of forces: here they are of designs
                top = peak(name, kind=kind, branch=branch, **designs)
            slopes = {p: np.asarray(slope) for p, slope in top["gradient"].items()}
            result[measure] = Measured(np.asarray(top["value"]), slopes)
    return result


def _own(name: str, designs: Mapping[str, Any], branch: int) -> Measured:
    """A quantity of a user's own."""
    speed = {"omega0": designs["omega0"]} if designs.get("omega0") is not None else {}
    slopes = {p: sensitivity(name, p) for p in LENGTHS}
    inputs = {n: designs[n] for n in LENGTHS}
    result = evaluate([name, *slopes.values()], branch=branch, **inputs, **speed)
    return Measured(np.asarray(result[name]), {p: np.asarray(result[slope]) for p, slope in slopes.items()})


def _margin(ec: Array, AB: Array, BC: Array) -> Measured:
    value = margin_of(ec, AB, BC)
    one = np.ones_like(value)
    return Measured(value, {"ec": -np.sign(ec) * one, "AB": -one, "BC": one})


def _events(requested: list[Measure], designs: Mapping[str, Any], branch: int) -> dict[str, Any]:
    names = [name for name in requested if name in WHOLE or name in VELOCITIES]
    if not names:
        return {}
    speed = designs.get("omega0")
    inputs = {**{n: designs[n] for n in LENGTHS}, "omega0": 1.0 if speed is None else speed}
    return events_of_arrays(inputs, branch, speed is not None, any(n in VELOCITIES for n in names))
