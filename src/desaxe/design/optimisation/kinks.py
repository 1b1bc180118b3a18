"""Measures with a kink, such as one of |ec|, as the largest or the smallest of smooth ones."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ...mechanism.closed.limits import margins_of
from ...mechanism.names import LENGTHS
from ..measures import Array, Measure, Measured, measured

Smooth = Measure | Callable[[Mapping[str, Any]], Measured]


class Sides(NamedTuple):
    """The measure is the largest (or else the smallest) of sign * smooth."""

    largest: bool
    parts: tuple[tuple[Smooth, float], ...]


def sides_of(measure: Measure) -> Sides:
    """The smooth parts of a measure; itself where it has no kink."""
    if isinstance(measure, tuple) and measure[0] == "absmax":
        return Sides(True, ((("max", measure[1]), 1.0), (("min", measure[1]), -1.0)))
    alone = Sides(True, ((measure, 1.0),))
    return _SIDES.get(measure, alone) if isinstance(measure, str) else alone


def _both(function: Callable[[Mapping[str, Any], float], Measured]) -> tuple[tuple[Smooth, float], ...]:
    return (lambda designs: function(designs, 1.0), 1.0), (lambda designs: function(designs, -1.0), 1.0)


def _margin(designs: Mapping[str, Any], side: float) -> Measured:
    """BC - AB - side ec."""
    ec, AB, BC = _lengths(designs)
    value = margins_of(side * ec, AB, BC)[0]
    one = np.ones_like(value)
    return Measured(value, {"ec": -side * one, "AB": -one, "BC": one})


def _lean(designs: Mapping[str, Any], side: float) -> Measured:
    """asin((AB + side ec)/BC)."""
    ec, AB, BC = _lengths(designs)
    reach = AB + side * ec
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = np.sqrt(margins_of(side * ec, AB, BC)[0] * (BC + reach))
        return Measured(
            np.arctan2(reach, rise), {"ec": side / rise, "AB": 1.0 / rise, "BC": -reach / (BC * rise)}
        )


def _transmission(designs: Mapping[str, Any], side: float) -> Measured:
    """acos((AB + side ec)/BC)."""
    lean = _lean(designs, side)
    return Measured(np.pi / 2 - lean.value, {p: -slope for p, slope in lean.gradient.items()})


def _ratio(designs: Mapping[str, Any], side: float) -> Measured:
    """Advance over return angle, or return over advance."""
    found = measured(["advance_angle", "return_angle"], designs)
    over, under = (found[n] for n in (("advance_angle", "return_angle")[:: int(side)]))
    ratio = over.value / under.value
    slopes = {p: (over.gradient[p] - ratio * under.gradient[p]) / under.value for p in LENGTHS}
    return Measured(ratio, slopes)


def _lengths(designs: Mapping[str, Any]) -> tuple[Array, Array, Array]:
    ec, AB, BC = (np.asarray(designs[name], float) for name in LENGTHS)
    return ec, AB, BC


_SIDES = {
    "margin": Sides(False, _both(_margin)),
    "max_pressure_angle": Sides(True, _both(_lean)),
    "min_transmission_angle": Sides(False, _both(_transmission)),
    "time_ratio": Sides(True, _both(_ratio)),
}
