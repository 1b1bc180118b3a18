"""Families of curves: a quantity over one input, one curve for each value of another."""

from typing import TYPE_CHECKING

import numpy as np

from ..extras import needed
from .parts import chosen, drawn, label_of, shown, worth_showing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

SIZE = (8.0, 4.8)  # inches


def curves(
    dataset: "xr.Dataset",
    name: str,
    *,
    over: str = "theta",
    family: str | None = None,
    ax: "Axes | None" = None,
) -> "list[Line2D]":
    """Draw a quantity over one input, one curve for each value of another; returns the lines.

    dataset  the result of `desaxe.grid` or of a scene
    name     the quantity
    over     the dimension along the horizontal axis; angles are shown in degrees
    family   the dimension that tells the curves apart; by default the other one, if there is one
    ax       where to draw: a matplotlib Axes; by default a new Figure (`lines[0].figure`)

    Labels and units come from the dataset. Points that are infeasible, or at which friction jams, are
    gaps. A curve may grow without bound towards its gaps, so the vertical axis is that of the curves
    without, or of most values where each has gaps. Raises ValueError for a name or dimension that the
    dataset does not have, or that is left over.
    """
    with needed("plot.curves"):
        from matplotlib.figure import Figure
    array = chosen(dataset, name, over, family)
    beside = ax is None
    ax = Figure(figsize=SIZE, layout="constrained").add_subplot() if ax is None else ax
    lines = drawn(ax, shown(array[over]), array, beside)
    _finish(ax, array, over, lines)
    return lines


def _finish(ax: "Axes", array: "xr.DataArray", over: str, lines: "list[Line2D]") -> None:
    """Labels, ticks, limits."""
    ax.set_xlabel(label_of(array[over]))
    ax.set_ylabel(label_of(array))
    horizontal = shown(array[over])
    if horizontal.size > 1:
        ax.set_xlim(float(horizontal.min()), float(horizontal.max()))
    if array[over].attrs.get("units") == "rad" and np.ptp(horizontal) >= 180.0:
        from matplotlib.ticker import MaxNLocator

        ax.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 3, 4.5, 6, 9, 10]))
    limits = worth_showing([np.asarray(line.get_ydata(), dtype=np.float64) for line in lines])
    if limits is not None:
        ax.set_ylim(*limits)
    ax.grid(True, color="0.9", linewidth=0.8)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
