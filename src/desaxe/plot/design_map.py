"""Design maps: a quantity over two inputs, with what is infeasible hatched."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.names import LENGTHS
from ..support.extras import needed
from ..support.forks import IMPORTS
from .picture import Picture
from .shared import choose, finish_axis, label_of, shown
from .titles import title_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

SIZE = (7.6, 5.2)  # inches
LEVELS = 12
GROWS = 1.0  # what lies further from most values than their range grows without bound
LONG, APART, CLEAR = 0.2, 0.08, 0.03  # shares of the axes: of a line with a label, from others, around it
HATCH, SHADE, LINE = "////", "0.93", "0.25"
FEASIBLE = (0, 2)  # status: ok, and at a change point
GEOMETRIC = (0, 1, 2)  # what the lengths alone decide


def design_map(
    dataset: "xr.Dataset", name: str, *, x: str | None = None, y: str | None = None, ax: "Axes | None" = None
) -> Picture:
    """Draw a quantity over two inputs as filled contours; a Picture of matplotlib's ContourSet.

    dataset  the result of `desaxe.design_map` or `desaxe.grid`, with `status` or `margin`
    name     the quantity
    x, y     the dimensions along the axes; by default the first and the other one; angles in degrees
    ax       where to draw: a matplotlib Axes; by default those of a new Figure

    Infeasible points are hatched; the edge is exact where the lengths decide, else halfway between points.
    A quantity that grows without bound towards the edge is shown up to most of its values. Raises
    ValueError for a name or dimension that the dataset does not have, or that is left over.
    """
    with needed("plot.design_map"):
        from matplotlib.figure import Figure
    array, x, y = _plane(dataset, name, x, y)
    own = ax is None
    axes: Any = Figure(figsize=SIZE, layout="constrained").add_subplot() if ax is None else ax
    edge = _infeasible(dataset, array, x, y)
    values = np.where(edge > 0.0, np.nan, np.asarray(array.values, dtype=np.float64))
    across, up = shown(array[x]), shown(array[y])
    levels, extend = _levels(values)
    drawn = axes.contourf(across, up, _widened(values), levels, extend=extend, cmap="viridis")
    lines = axes.contour(across, up, _widened(values), levels, colors="w", linewidths=0.6)
    _label(axes, lines, across, up)
    _hatch(axes, across, up, edge)
    axes.figure.colorbar(drawn, ax=axes, label=label_of(array))
    finish_axis(axes.xaxis, array[x])
    finish_axis(axes.yaxis, array[y])
    if own:
        axes.set_title(title_of(dataset, [name]), loc="left", fontsize="medium")
    return Picture(axes, [drawn], drawn)


def _plane(dataset: "xr.Dataset", name: str, x: str | None, y: str | None) -> tuple["xr.DataArray", str, str]:
    """The quantity with the dimensions (y, x)."""
    dims = [str(d) for d in dataset[name].dims] if name in dataset else []
    x = x or next((d for d in dims if d != y), "x")
    y = y or next((d for d in dims if d != x), "y")
    if x == y:
        raise ValueError(f"x = y = {x!r}: expected two dimensions")
    return choose(dataset, name, [y, x]), x, y


def _infeasible(dataset: "xr.Dataset", array: "xr.DataArray", x: str, y: str) -> NDArray[np.float64]:
    """A field over (y, x) that is above 0 where a design is infeasible."""
    margin, status = (dataset.get(n) for n in ("margin", "status"))
    geometric = status is None or bool(status.isin(GEOMETRIC).all())
    edge: Any
    if geometric and {"theta", *LENGTHS} <= set(array.coords):
        ec, AB, BC, theta = (array[n] for n in (*LENGTHS, "theta"))
        edge = np.abs(ec + AB * np.sin(theta)) - BC
    elif geometric and margin is not None and set(margin.dims) <= {x, y}:
        edge = -margin
    elif status is not None and set(status.dims) <= {x, y}:
        edge = (~status.isin(FEASIBLE)).astype(float) - 0.5
    else:
        edge = np.isnan(array).astype(float) - 0.5
    wide: NDArray[np.float64] = edge.broadcast_like(array).transpose(y, x).values
    return wide


def _levels(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], str]:
    """Round levels over the range of the values, or of most where the rest grows without bound."""
    with IMPORTS:
        from matplotlib.ticker import MaxNLocator

    known = values[np.isfinite(values)]
    if not known.size:
        return np.array([0.0, 1.0]), "neither"
    low, high = known.min(), known.max()
    least, most = np.percentile(known, [5.0, 95.0])
    reach = GROWS * (most - least)
    above, below = high > most + reach, low < least - reach
    high, low = (most if above else high), (least if below else low)
    top = high if high > low else low + (abs(low) or 1.0)
    levels = np.asarray(MaxNLocator(LEVELS).tick_values(low, top), dtype=np.float64)
    extend = {(True, True): "both", (True, False): "max", (False, True): "min"}.get((above, below), "neither")
    return levels, extend


def _widened(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fill each NaN next to a number with its value, so that colours reach under the hatching."""
    wide = values
    for axis in (0, 1):
        for step in (1, -1):
            beside = np.roll(wide, step, axis)
            edge = [slice(None)] * 2
            edge[axis] = slice(0, 1) if step > 0 else slice(-1, None)
            beside[tuple(edge)] = np.nan
            wide = np.where(np.isnan(wide), beside, wide)
    return wide


def _label(axes: Any, lines: Any, across: Any, up: Any) -> None:
    """Label the contours that are long enough, each where it is furthest from others, if there is space."""
    with IMPORTS:
        from matplotlib.patheffects import withStroke

    size = np.array([np.ptp(across) or 1.0, np.ptp(up) or 1.0])
    scaled = [[(piece - (np.min(across), np.min(up))) / size for piece in level] for level in lines.allsegs]
    whole = [np.concatenate([np.empty((0, 2)), *pieces]) for pieces in scaled]
    taken = np.empty((0, 2))
    for number, pieces in enumerate(scaled):
        long = [p for p in pieces if np.linalg.norm(np.diff(p, axis=0), axis=1).sum() > LONG]
        points = np.concatenate([np.empty((0, 2)), *long])
        points = points[((points > APART) & (points < 1.0 - APART)).all(axis=1)]
        lines_apart = _distances(points, np.concatenate([*whole[:number], *whole[number + 1 :], taken]))
        gaps = np.where(_distances(points, taken) > 1.5 * APART, lines_apart, 0.0)
        if gaps.max(initial=0.0) > CLEAR:
            taken = np.append(taken, points[[gaps.argmax()]], axis=0)
    places = taken * size + (np.min(across), np.min(up))
    for text in axes.clabel(lines, manual=[tuple(p) for p in places], fontsize=8) if len(places) else ():
        text.set_path_effects([withStroke(linewidth=1.5, foreground="0.2")])


def _distances(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """The distance of each point from the nearest of others; 1 where there are none."""
    far = np.linalg.norm(points[:, None] - others[None], axis=-1)
    nearest: NDArray[np.float64] = far.min(axis=1, initial=1.0)
    return nearest


def _hatch(axes: Any, across: Any, up: Any, edge: NDArray[np.float64]) -> None:
    with IMPORTS:
        from matplotlib.patches import Patch

    if not (edge > 0.0).any():
        return
    top = float(edge.max()) + 1.0
    region = axes.contourf(across, up, edge, [0.0, top], colors=[SHADE], hatches=[HATCH], zorder=2.5)
    region.set_edgecolor("0.6")
    region.set_linewidth(0.0)
    if (edge <= 0.0).any():
        axes.contour(across, up, edge, [0.0], colors=LINE, linewidths=1.2, zorder=3)
    patch = Patch(facecolor=SHADE, edgecolor="0.6", hatch=HATCH, label="infeasible")
    axes.legend(handles=[patch], loc="best", framealpha=1.0)
