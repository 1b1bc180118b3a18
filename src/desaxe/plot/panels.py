"""Several quantities over one input, one above the other."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..support.extras import needed
from .curves import draw
from .from_dict import as_dataset
from .jumps import with_jumps
from .picture import Picture
from .shared import chosen, meaning_of, unit_of
from .titles import title_of

if TYPE_CHECKING:
    import xarray as xr

WIDTH, HEIGHT = 8.0, 1.9  # inches: of all, of a panel
ALWAYS = ("status", "margin")


def panels(
    dataset: "xr.Dataset | Mapping[str, Any]",
    names: Sequence[str] | None = None,
    *,
    over: str = "theta",
    family: str | None = None,
    ax: Any = None,
    **inputs: Any,
) -> Picture:
    """Draw several quantities over one input, one above the other; a Picture of the lines by name.

    dataset  the result of `desaxe.grid` or of a scene; or the dict that `desaxe.evaluate` gives
    names    the quantities, from top to bottom; by default all that vary with `over`
    over     the dimension along the horizontal axis; angles are shown in degrees
    family   the dimension that tells the curves apart; by default the other one, if there is one
    ax       where to draw: a matplotlib Axes for each name, in a list; by default those of a new Figure
    inputs   of a dict of arrays that does not know its own: theta=angles, ...

    Labels, gaps and complaints are those of `curves`.
    """
    with needed("plot.panels"):
        from matplotlib.figure import Figure
    dataset = as_dataset(dataset, over, inputs)
    if names is None:
        names = [str(n) for n, a in dataset.data_vars.items() if over in a.dims and n not in ALWAYS]
    arrays = [with_jumps(dataset, chosen(dataset, name, over, family), over) for name in names]
    if not arrays:
        raise ValueError(f"nothing in this dataset varies with {over!r}")
    if ax is None:
        figure = Figure(figsize=(WIDTH, 0.8 + HEIGHT * len(arrays)), layout="constrained")
        axes = list(figure.subplots(len(arrays), sharex=True, squeeze=False)[:, 0])
        figure.suptitle(title_of(dataset, names), x=0.01, ha="left", fontsize="medium")
    else:
        axes = list(ax) if hasattr(ax, "__len__") else [ax]
        if len(axes) != len(arrays):
            raise ValueError(
                f"ax: expected {len(arrays)} Axes, one for each of {', '.join(names)}; got {len(axes)}"
            )
    drawn = {}
    for place, (array, axis) in enumerate(zip(arrays, axes, strict=True)):
        lines = draw(axis, array, over, beside=True if place == 0 else None)
        axis.set_title(meaning_of(array), loc="left", fontsize="small", color="0.3")
        between = "\n" if "_wrt_" in str(array.name) else " "  # as long as a panel is high
        axis.set_ylabel(f"{array.name}{between}{unit_of(array)}".rstrip())
        if place < len(arrays) - 1:
            axis.set_xlabel("")
        drawn[str(array.name)] = lines
    if ax is None:
        figure.align_ylabels(axes)
    return Picture(axes, drawn)
