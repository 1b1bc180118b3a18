"""A load over the crank angle or the slider's place, each way of the slider, and its points."""

from math import ceil, inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..loads.along_motion import OfMotion
from ..loads.load import Load, OverTheta, OverY
from ..mechanism.closed import TURN
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.extras import needed
from ..support.shown import printed
from .picture import Picture
from .shared import BLUE, ORANGE, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
SIZE = (7.0, 3.6)  # inches
NODES = 1001  # of a curve, beside those on both sides of each point
STYLES: tuple[dict[str, Any], ...] = ({"color": BLUE}, {"color": ORANGE, "linestyle": "--"})
BEYOND = 0.08  # of the range of positions: so far it is shown how the values at the ends hold


def load(
    load: Load,
    *,
    over: tuple[float, float] | None = None,
    ax: "Axes | None" = None,
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
    with needed("plot.load"):
        from matplotlib.figure import Figure
        from matplotlib.ticker import MultipleLocator
    if ax is None:
        ax = Figure(figsize=SIZE, layout="constrained").subplots()
    units = units or load.shown_in or SI
    force = load.values_in(units)
    along: Any
    if isinstance(load, OverTheta):
        places, curves, points = _over_theta(load)
        along, what = np.degrees, "crank angle, theta [deg]"
        ax.xaxis.set_major_locator(MultipleLocator(45.0 * ceil(load.period / TURN)))
    elif isinstance(load, OfMotion):
        places, curves, points = _over_column(load, over, units)
        along = units.of(load.needs[0]).shown
        what = f"{load.over} [{printed(units.of(load.needs[0]).unit)}]"
    else:
        assert isinstance(load, OverY)
        places, curves, points = _over_position(load)
        along, what = units.of("Y").shown, f"{load.place.removeprefix('the ')} [{units.of('Y').unit}]"
    lines: dict[str, Any] = {}
    for (name, values), style in zip(curves.items(), STYLES, strict=False):
        (lines[name],) = ax.plot(along(places), force.shown(values), linewidth=1.6, label=name, **style)
    if points[0].size:
        (lines["points"],) = ax.plot(
            along(points[0]), force.shown(points[1]), "o", color="0.25", markersize=4
        )
    ax.set(xlabel=what, ylabel=f"load [{printed(force.unit)}]", xlim=tuple(along(places[[0, -1]])))
    ax.set_title(load.told(force)[1:-1], loc="left", fontsize="medium", wrap=True)
    if len(curves) > 1:
        ax.legend(frameon=False, fontsize="small")
    finish(ax)
    return Picture(ax, lines)


Drawn = tuple[Array, dict[str, Array], tuple[Array, Array]]  # places, curves by name, points


def _over_theta(load: OverTheta) -> Drawn:
    """A load over one period from 0, in SI units."""
    knots = np.array([x for table in load.tables for x in table.knots]) % load.period
    values = np.array([y for table in load.tables for y in table.values])
    places = _nodes(0.0, load.period, np.append(knots, load.nodes(0.0, load.period, False)))
    return places, {"load": load.value(places)}, (knots, values)


def _over_position(load: OverY) -> Drawn:
    """A load over the range of its positions and a little beyond, each way of the slider, in SI units."""
    knots = np.array(load.outward.knots)
    room = BEYOND * (knots[-1] - knots[0])
    places = _nodes(max(knots[0] - room, 0.0 if load.centre else -inf), knots[-1] + room, knots)
    ways = {"load": 1.0} if load.inward is None else {"outward": 1.0, "inward": -1.0}
    curves = {name: load.value(places, way) for name, way in ways.items()}
    values = np.array([y for table in load.tables for y in table.values])
    return places, curves, (np.tile(knots, len(load.tables)), values)


def _over_column(load: OfMotion, over: tuple[float, float] | None, units: UnitSystem) -> Drawn:
    """A load over the slider's position or speed, in SI units."""
    if len(load.needs) > 1:
        raise TypeError(
            f"{load!r} depends on {', '.join(load.needs)}: a picture is of a load over one of them"
        )
    knots = np.array(load.speeds if load.tables else [])
    if over is None and not knots.size:
        raise TypeError(f"plot.load: over=(low, high) is missing, the range of {load.over} to draw")
    room = BEYOND * (knots[-1] - knots[0]) if knots.size else 0.0
    column = units.of(load.needs[0])
    low, high = (column.to_si(x) for x in over) if over is not None else (knots[0] - room, knots[-1] + room)
    places = _nodes(float(low), float(high), knots)

    def values(x: Array) -> Array:
        return np.asarray(load.partials({load.needs[0]: x}).value)

    return places, {"load": values(places)}, (knots, values(knots) if knots.size else knots)


def _nodes(low: float, high: float, knots: Array) -> Array:
    """Places between two ends, those on both sides of each knot among them, where it may jump."""
    sides = np.concatenate([np.nextafter(knots, -inf), knots, np.nextafter(knots, inf)])
    places: Array = np.unique(np.clip(np.concatenate([np.linspace(low, high, NODES), sides]), low, high))
    return places
