"""A load over the crank angle, the slider's position or its speed, each way of the slider, and its points."""

from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    force, column = load.values_in(units), units.of(load.needs[0])
    points = np.array([x for table in load.tables for x in table.knots])
    points = points % load.period if isinstance(load, OverTheta) else points
    values = np.array([y for table in load.tables for y in table.values])
    nodes = _nodes(load, points, None if over is None else [float(column.to_si(end)) for end in over])
    along: Any = column.shown
    label = f"{load.place.removeprefix('the ')} [{printed(column.unit)}]"
    if isinstance(load, OverTheta):
        along, label = np.degrees, "crank angle, theta [deg]"
        angle_ticks(axes.xaxis)
    ways = {"outward": 1.0, "inward": -1.0} if len(load.tables) > 1 else {"load": 1.0}
    lines: dict[str, Any] = {}
    for (name, way), style in zip(ways.items(), STYLES, strict=False):
        curve = along(nodes), force.shown(_values(load, nodes, way))
        (lines[name],) = axes.plot(*curve, linewidth=1.6, label=name, **style)
    if points.size:
        at = along(points), force.shown(values)
        (lines["points"],) = axes.plot(*at, "o", color="0.25", markersize=4)
    axes.set(xlabel=label, ylabel=f"load [{printed(force.unit)}]", xlim=tuple(along(nodes[[0, -1]])))
    head(axes, load.told(force)[1:-1], wrap=True)
    if len(ways) > 1:
        axes.legend(frameon=False, fontsize="small")
    finish(axes)
    return Picture(axes, lines)


def _values(load: Load, column: Array, way: float) -> Array:
    """The load at values of the column that it is over, for a slider that goes one way."""
    if isinstance(load, (OverTheta, OverY)):
        both = (column,) if isinstance(load, OverTheta) else (column, way)
        return np.asarray(load.value(*both))
    return np.asarray(load.partials({load.needs[0]: column}).value)


def _nodes(load: Load, points: Array, over: list[float] | None) -> Array:
    """Abscissae of a curve in SI units, those on both sides of each point among them, where it may jump."""
    if isinstance(load, OverTheta):
        low, high, points = 0.0, load.period, np.append(points, load.nodes(0.0, load.period, False))
    elif not isinstance(load, OverY) and len(load.needs) > 1:
        needs = ", ".join(load.needs)
        raise TypeError(f"{load!r} depends on {needs}: a picture is of a load over one of them")
    elif over is not None:
        low, high = over
    elif points.size:
        margin = BEYOND * float(np.ptp(points))
        low = max(float(points.min()) - margin, 0.0 if load.centre else -inf)
        high = float(points.max()) + margin
    else:
        raise TypeError(f"plot.load: over=(low, high) is missing, the range of {load.over} to draw")
    sides = np.concatenate([np.nextafter(points, -inf), points, np.nextafter(points, inf)])
    nodes: Array = np.unique(np.clip(np.concatenate([np.linspace(low, high, NODES), sides]), low, high))
    return nodes
