"""Tornado diagrams: what a change of each input does to a quantity, the largest on top."""

from collections.abc import Mapping
from math import degrees
from typing import Any

from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.quantity_units import UnitSystem
from ..mechanism.read import number_of, read
from ..support.shown import shown
from .picture import Picture
from .style import BLUE, ORANGE, axes_of, finish, head, raised

WIDTH, BAR = 7.6, 0.42  # inches: of all, the height of a bar


def tornado(
    result: Any,
    changes: Mapping[str, Any],
    *,
    name: str = "",
    units: str | Mapping[str, str] | UnitSystem | None = None,
    title: str | None = None,
    ax: Any = None,
) -> Picture:
    """Draw what a change of each input does to a quantity, by its exact sensitivities; a Picture of the bars.

    result   a dict with `value` and `gradient`, as `desaxe.peak` and `desaxe.tolerance` give for one design
    changes  dict input -> half its range: in the units of the result, or texts such as "0.1 mm"; signs do
             not matter
    name     the quantity, for the label
    units    the units of its numbers ("mm, deg, rpm"); those of an answer of a machine, SI units without
    title    what it is headed with; by default the value, and where it is reached
    ax       where to draw: a matplotlib Axes; by default a new Figure

    To first order: each bar ends at value -+ slope times change, orange where the input is larger, blue where
    it is smaller. Raises ValueError for a change of an input whose slope the result does not have.
    """
    if not isinstance(changes, Mapping):
        raise TypeError(f"changes = {shown(changes)}: expected a dict input -> half its range")
    axes = axes_of("tornado", ax, (WIDTH, 1.5 + BAR * len(changes)))
    system = UnitSystem.read(getattr(result, "system", None) if units is None else units)
    value, slopes = _value_and_slopes(result, changes)
    moves = {p: slopes[p] * abs(_number(p, change, system)) for p, change in changes.items()}
    order = sorted(moves, key=lambda p: abs(moves[p]))
    bars = [
        axes.barh(range(len(order)), [sign * moves[p] for p in order], left=value, color=colour, height=0.65,
                  label=label)
        for sign, colour, label in ((1.0, ORANGE, "input larger"), (-1.0, BLUE, "input smaller"))
    ]  # fmt: skip
    axes.set_yticks(range(len(order)), [f"{p} ± {_text(p, changes[p], system)}" for p in order])
    axes.axvline(value, color="0.2", linewidth=1.0)
    unit = raised(system.of(name).unit) if name else ""
    axes.set_xlabel(f"{quantity(name).meaning}, {name} {unit}".rstrip() if name else "value")
    axes.locator_params(axis="x", nbins=6)
    finish(axes, "x", ("top", "right", "left"))
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    head(axes, value_text(result, name, system) if title is None else title)
    return Picture(axes, bars)


def _value_and_slopes(result: Any, changes: Mapping[str, Any]) -> tuple[float, dict[str, float]]:
    """The value, and its derivatives with respect to the changed inputs."""
    if not isinstance(result, Mapping) or "gradient" not in result:
        raise TypeError(f"plot.tornado: expected a dict with value and gradient, got {shown(result)}")
    gradient = result["gradient"]
    missing = [p for p in changes if p not in gradient]
    if missing:
        there = ", ".join(gradient) or "none"
        raise ValueError(f"changes: no slope by {missing[0]} in this result, there are: {there}")
    return _scalar(result["value"]), {p: _scalar(gradient[p]) for p in changes}


def value_text(result: Mapping[str, Any], name: str, system: UnitSystem) -> str:
    """The value of a dict with its unit, and the angle at which it is reached."""
    unit = raised(system.of(name).unit)[1:-1] if name else ""
    words = f"{name or 'value'} = {_scalar(result['value']):.6g} {unit}".rstrip()
    if "theta" not in result:
        return words
    angle = result["theta"]
    with_unit = isinstance(angle, str) or hasattr(angle, "magnitude")
    theta = read(INPUTS["theta"], angle, "tornado") if with_unit else system.of("theta").to_si(angle)
    return f"{words} at theta = {degrees(theta):.4g} deg"


def _scalar(value: Any) -> float:
    try:
        return float(value)
    except TypeError:
        raise ValueError("a tornado is of one design: choose it first, dataset.sel(...)") from None


def _number(parameter: str, change: Any, system: UnitSystem) -> float:
    if parameter not in INPUTS:
        raise TypeError(f"changes: no input {parameter!r}")
    if isinstance(change, (int, float)):
        return float(change)
    half = number_of(INPUTS[parameter]._replace(least=None, limit="a finite number"), change)
    if half is None:
        raise TypeError(
            f"changes: {parameter} = {shown(change)}: half its range is a number or a text with a unit"
        )
    return float(system.of(parameter).shown(half))


def _text(parameter: str, change: Any, system: UnitSystem) -> str:
    if not isinstance(change, (int, float)):
        return str(change)
    return f"{abs(change):.4g} {raised(system.of(parameter).unit)[1:-1]}".rstrip()
