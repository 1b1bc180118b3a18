"""Design maps: a quantity over two inputs, with what is infeasible hatched."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.names import LENGTHS
from ..support.forks import IMPORTS
from .dataset import choose
from .picture import Picture
from .style import axes_of, finish_axis, head, label_of, shown, title_of

if TYPE_CHECKING:
    import xarray as xr

SIZE = (7.6, 5.2)  # inches
LEVELS = 12
GROWS = 1.0  # what lies further from most values than their range grows without bound
APART = 0.08  # of the axes: of a label from others and from the frame
HATCH, SHADE, LINE = "////", "0.93", "0.25"
FEASIBLE = (0, 2)  # status: ok, and at a change point
GEOMETRIC = (0, 1, 2)  # what the lengths alone decide


def design_map(
    dataset: "xr.Dataset", name: str, *, x: str | None = None, y: str | None = None, ax: Any = None
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
    axes = axes_of("design_map", ax, SIZE)
    array, x, y = _plane(dataset, name, x, y)
    edge = _infeasible(dataset, array, x, y)
    values = np.where(edge > 0.0, np.nan, np.asarray(array.values, dtype=np.float64))
    across, up = shown(array[x]), shown(array[y])
    levels, extend = _levels(values)
    wide = _widened(values)
    drawn = axes.contourf(across, up, wide, levels, extend=extend, cmap="viridis")
    _label(axes, axes.contour(across, up, wide, levels, colors="w", linewidths=0.6), across, up, values)
    _hatch(axes, across, up, edge)
    axes.figure.colorbar(drawn, ax=axes, label=label_of(array))
    finish_axis(axes.xaxis, array[x])
    finish_axis(axes.yaxis, array[y])
    if ax is None:
        head(axes, title_of(dataset, [name]))
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
    with IMPORTS:
        from pandas import DataFrame

    wide = DataFrame(values)
    for axis in (0, 1):
        wide = wide.ffill(axis=axis, limit=1).bfill(axis=axis, limit=1)
    return np.asarray(wide, dtype=np.float64)


def _label(axes: Any, lines: Any, across: Any, up: Any, values: NDArray[np.float64]) -> None:
    """Label contours where they are apart from other labels, the frame and what is infeasible."""
    with IMPORTS:
        from matplotlib.patheffects import withStroke

    low, size = np.array([np.min(across), np.min(up)]), np.array([np.ptp(across) or 1.0, np.ptp(up) or 1.0])
    labels = np.empty((0, 2))
    for text in axes.clabel(lines, inline=False, fontsize=8):
        x, y = text.get_position()
        place = ((x, y) - low) / size
        value = values[np.abs(up - y).argmin(), np.abs(across - x).argmin()]
        crowded = np.linalg.norm(labels - place, axis=1).min(initial=1.0) < 1.5 * APART
        if crowded or place.min() < APART or place.max() > 1.0 - APART or np.isnan(value):
            text.remove()
        else:
            labels = np.append(labels, [place], axis=0)
            text.set_path_effects([withStroke(linewidth=1.5, foreground="0.2")])


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
