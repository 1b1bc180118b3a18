"""A load over the crank angle, the slider's position or its speed, each way of the slider, and its points."""

from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loads.along_motion import OfMotion
from ..loads.load import Load, OverTheta, OverY
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.shown import printed
from .picture import Picture
from .style import BLUE, ORANGE, angle_ticks, axes_of, finish, head

Array = NDArray[np.float64]
SIZE = (7.0, 3.6)  # inches
NODES = 1001  # of a curve, beside those on both sides of each point
STYLES: tuple[dict[str, Any], ...] = ({"color": BLUE}, {"color": ORANGE, "linestyle": "--"})
BEYOND = 0.08  # of the range of positions: so far it is shown how the values at the ends hold
Curves = tuple[Array, dict[str, Array], Array]  # abscissae, curves by name, abscissae of points


def load(
    load: Load,
    *,
    over: tuple[float, float] | None = None,
    ax: Any = None,
    units: UnitSystem | None = None,
) -> Picture:
    """Draw a load over its period, over the slider's position, distance from a dead centre or speed.

    load   of `over_theta`, `over_Y`, `over_stroke`, `over_V`, `spring`, `damper`; of a function of one column
    over   the range of positions or speeds in these units, of a load that has no points
    ax     where to draw; by default a new Figure
    units  a unit system; by default that of the machine which made the load. Angles are in degrees

    Returns a Picture of the lines by name: load, or outward and inward where each has its own, and the points
    of a table. The curve is that which is computed with, between the points and beyond the first and last.
    """
    axes = axes_of("load", ax, SIZE)
    units = units or load.shown_in or SI
    force = load.values_in(units)
    values = np.array([y for table in load.tables for y in table.values])
    along: Any
    if isinstance(load, OverTheta):
        along, label = np.degrees, "crank angle, theta [deg]"
        abscissae, curves, points = _over_theta(load)
        angle_ticks(axes.xaxis)
    elif isinstance(load, OverY):
        along, label = units.of("Y").shown, f"{load.place.removeprefix('the ')} [{units.of('Y').unit}]"
        abscissae, curves, points = _over_position(load)
    else:
        assert isinstance(load, OfMotion)
        column = units.of(load.needs[0])
        along, label = column.shown, f"{load.over} [{printed(column.unit)}]"
        abscissae, curves, points = _over_column(load, None if over is None else [*map(column.to_si, over)])
        values = _at(load, points) if points.size else points
    lines: dict[str, Any] = {}
    for (name, curve), style in zip(curves.items(), STYLES, strict=False):
        (lines[name],) = axes.plot(along(abscissae), force.shown(curve), linewidth=1.6, label=name, **style)
    if points.size:
        at = along(points), force.shown(values)
        (lines["points"],) = axes.plot(*at, "o", color="0.25", markersize=4)
    axes.set(xlabel=label, ylabel=f"load [{printed(force.unit)}]", xlim=tuple(along(abscissae[[0, -1]])))
    head(axes, load.told(force)[1:-1], wrap=True)
    if len(curves) > 1:
        axes.legend(frameon=False, fontsize="small")
    finish(axes)
    return Picture(axes, lines)


def _over_theta(load: OverTheta) -> Curves:
    """A load over one period from 0, in SI units."""
    knots = np.array([x for table in load.tables for x in table.knots]) % load.period
    abscissae = _nodes(0.0, load.period, np.append(knots, load.nodes(0.0, load.period, False)))
    return abscissae, {"load": load.value(abscissae)}, knots


def _over_position(load: OverY) -> Curves:
    """A load over the range of its positions and a little beyond, each way of the slider, in SI units."""
    knots = np.array(load.outward.knots)
    margin = BEYOND * (knots[-1] - knots[0])
    abscissae = _nodes(max(knots[0] - margin, 0.0 if load.centre else -inf), knots[-1] + margin, knots)
    ways = {"load": 1.0} if load.inward is None else {"outward": 1.0, "inward": -1.0}
    curves = {name: load.value(abscissae, way) for name, way in ways.items()}
    return abscissae, curves, np.tile(knots, len(load.tables))


def _over_column(load: OfMotion, over: list[float] | None) -> Curves:
    """A load over the slider's position or speed, in SI units."""
    if len(load.needs) > 1:
        raise TypeError(
            f"{load!r} depends on {', '.join(load.needs)}: a picture is of a load over one of them"
        )
    knots = np.array(load.speeds if load.tables else [])
    if over is None and not knots.size:
        raise TypeError(f"plot.load: over=(low, high) is missing, the range of {load.over} to draw")
    margin = BEYOND * np.ptp(knots) if knots.size else 0.0
    low, high = (knots[0] - margin, knots[-1] + margin) if over is None else over
    abscissae = _nodes(float(low), float(high), knots)
    return abscissae, {"load": _at(load, abscissae)}, knots


def _at(load: OfMotion, column: Array) -> Array:
    """The values of a load at those of its one column."""
    return np.asarray(load.partials({load.needs[0]: column}).value)


def _nodes(low: float, high: float, knots: Array) -> Array:
    """Abscissae between two ends, those on both sides of each knot among them, where it may jump."""
    sides = np.concatenate([np.nextafter(knots, -inf), knots, np.nextafter(knots, inf)])
    nodes: Array = np.unique(np.clip(np.concatenate([np.linspace(low, high, NODES), sides]), low, high))
    return nodes
