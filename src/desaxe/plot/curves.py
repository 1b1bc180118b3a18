"""Families of curves: a quantity over one input, one curve for each value of another."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..support.extras import needed
from .from_dict import as_dataset
from .jumps import with_jumps
from .picture import Picture
from .shared import (
    around_level,
    chosen,
    drawn,
    finish,
    finish_axis,
    label_of,
    mark_gaps,
    room_at_jumps,
    shown,
    worth_showing,
)
from .titles import title_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

SIZE = (8.0, 4.8)  # inches


def curves(
    dataset: "xr.Dataset | Mapping[str, Any]",
    name: str,
    *,
    over: str = "theta",
    family: str | None = None,
    ax: "Axes | None" = None,
    **inputs: Any,
) -> Picture:
    """Draw a quantity over one input, one curve for each value of another; a Picture of the lines.

    dataset  the result of `desaxe.grid` or of a scene; or what `desaxe.evaluate` or `simulate` gives
    name     the quantity
    over     the dimension along the horizontal axis; angles are shown in degrees; of a motion t or theta
    family   the dimension that tells the curves apart; by default the other one, if there is one
    ax       where to draw: a matplotlib Axes; by default a new Figure, whose title tells the inputs that
             matter
    inputs   of a dict of arrays that does not know its own: theta=angles, ...

    Labels and units come from the dataset. Where a load jumps each side gets a node, besides the samples.
    Points that are infeasible, or at which friction jams, are gaps: hatched where no curve has a value, else
    marked at the foot in the colour of theirs. A curve may grow without bound towards its gaps, so the
    vertical axis is that of the curves without, or of most values where each has gaps. Raises ValueError for
    a name or dimension that the dataset does not have, or that is left over.
    """
    with needed("plot.curves"):
        from matplotlib.figure import Figure
    dataset = as_dataset(dataset, over, inputs)
    array = with_jumps(dataset, chosen(dataset, name, over, family), over)
    own = ax is None
    ax = Figure(figsize=SIZE, layout="constrained").add_subplot() if ax is None else ax
    lines = draw(ax, array, over, beside=own)
    if own:
        ax.set_title(title_of(dataset, [name]), loc="left", fontsize="medium")
    return Picture(ax, lines)


def draw(ax: "Axes", array: "xr.DataArray", over: str, beside: bool | None) -> "list[Line2D]":
    """The curves of (family, over) or (over), with labels, ticks and limits."""
    lines = drawn(ax, shown(array[over]), array, beside)
    finish_axis(ax.xaxis, array[over])
    room_at_jumps(ax, shown(array[over]), array.values)
    ax.set_ylabel(label_of(array))
    mark_gaps(ax, lines)
    values = [np.asarray(line.get_ydata(), dtype=np.float64) for line in lines]
    limits = worth_showing(values) or around_level(values)
    if limits is not None:
        ax.set_ylim(*limits)
    finish(ax)
    return lines
