"""Families of curves: a quantity over one input, one curve for each value of another."""

import os
import re
from math import degrees
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..extras import needed

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

MOST_IN_LEGEND = 10  # curves; more get a colour bar
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

    Labels and units come from the dataset. Points that are infeasible are gaps; where a curve has
    gaps it may grow without bound, so the vertical axis is that of the curves without. Raises
    ValueError for a name or dimension that the dataset does not have, or that is left over.
    """
    with needed("plot.curves"):
        from matplotlib.figure import Figure
    array = _chosen(dataset, name, over, family)
    family = next((str(dim) for dim in array.dims if dim != over), None)
    beside = ax is None
    ax = Figure(figsize=SIZE, layout="constrained").add_subplot() if ax is None else ax
    members = array[family] if family else [None]
    colours = _colours(len(members))
    horizontal = _shown(array[over])
    lines: list[Line2D] = []
    for member, values, colour in zip(members, np.atleast_2d(array.values), colours, strict=True):
        label = None if member is None else f"{float(_shown(member)):.6g}"
        lines += ax.plot(horizontal, values, color=colour, linewidth=1.6, label=label)
    _finish(ax, array, over, lines)
    if family:
        _explain(ax, array[family], lines, beside)
    return lines


def save(figure: Any, path: str | PathLike[str], dpi: float = 150.0) -> Path:
    """Write a figure to a file of the kind that its name says; folders are made as needed."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    staged = target.with_name(f".{target.stem}.new{target.suffix}")
    try:
        figure.savefig(staged, dpi=dpi)
        os.replace(staged, target)
    finally:
        staged.unlink(missing_ok=True)
    return target


def _chosen(dataset: "xr.Dataset", name: str, over: str, family: str | None) -> "xr.DataArray":
    """The quantity with the dimensions (family, over) or (over)."""
    if name not in dataset:
        raise ValueError(f"no {name!r} in this dataset, it has: {', '.join(map(str, dataset.data_vars))}")
    array = dataset[name]
    for dim in (over, family):
        if dim is not None and dim not in array.dims:
            raise ValueError(
                f"{name} has no dimension {dim!r}, it has: {', '.join(map(str, array.dims)) or 'none'}"
            )
    if family == over:
        raise ValueError(f"family = {family!r}: it must be another dimension than over")
    rest = [str(dim) for dim in array.dims if dim not in (over, family)]
    if family is None and len(rest) == 1:
        family, rest = rest[0], []
    if rest:
        wanted = ", ".join(f"{dim}=..." for dim in rest)
        raise ValueError(
            f"{name} varies with {', '.join(rest)} too: choose a value first, dataset.sel({wanted})"
        )
    return array.transpose(*([family] if family else []), over)


def _shown(array: "xr.DataArray") -> NDArray[np.float64]:
    """The values as they are shown: angles in degrees."""
    values: NDArray[np.float64] = np.asarray(array.values, dtype=np.float64)
    return values * degrees(1.0) if array.attrs.get("units") == "rad" else values


def _unit(array: "xr.DataArray") -> str:
    """The unit for a label: degrees for an input that is an angle, m/s^2 with a raised 2."""
    unit = str(array.attrs.get("units", ""))
    if unit == "rad" and array.ndim == 1 and array.name in array.dims:
        return "[deg]"
    raised = re.sub(r"\^(-?[0-9]+)", r"$^{\1}$", unit)
    return f"[{raised}]" if unit and unit != "1" else ""


def _label(array: "xr.DataArray") -> str:
    meaning = str(array.attrs.get("long_name", "")).partition(",")[0].partition(":")[0]
    symbol = str(array.name)
    return " ".join(part for part in (f"{meaning}, {symbol}" if meaning else symbol, _unit(array)) if part)


def _finish(ax: "Axes", array: "xr.DataArray", over: str, lines: "list[Line2D]") -> None:
    """Labels, ticks, limits."""
    ax.set_xlabel(_label(array[over]))
    ax.set_ylabel(_label(array))
    horizontal = _shown(array[over])
    if horizontal.size > 1:
        ax.set_xlim(float(horizontal.min()), float(horizontal.max()))
    if array[over].attrs.get("units") == "rad" and np.ptp(horizontal) >= 180.0:
        from matplotlib.ticker import MaxNLocator

        ax.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 3, 4.5, 6, 9, 10]))
    _limit(ax, lines)
    ax.grid(True, color="0.9", linewidth=0.8)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _limit(ax: "Axes", lines: "list[Line2D]") -> None:
    """Where some curves have gaps, the vertical axis is that of the curves without."""
    values = [np.asarray(line.get_ydata(), dtype=np.float64) for line in lines]
    whole = [v for v in values if np.isfinite(v).all()]
    if whole and len(whole) < len(values):
        low, high = min(v.min() for v in whole), max(v.max() for v in whole)
        room = 0.25 * (high - low) or 1.0
        ax.set_ylim(low - room, high + room)


def _colours(count: int) -> list[Any]:
    """Evenly spaced from viridis, without its palest end: told apart by the colour-blind and in print."""
    from matplotlib import colormaps

    return [colormaps["viridis"](0.9 * k / max(1, count - 1)) for k in range(count)]


def _explain(ax: "Axes", family: "xr.DataArray", lines: "list[Line2D]", beside: bool) -> None:
    """A legend, beside the curves where there is room, or a colour bar where they are many."""
    title = f"{family.name} {_unit(family)}".rstrip()
    if len(lines) <= MOST_IN_LEGEND:
        place = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)} if beside else {"loc": "best"}
        ax.legend(title=title, frameon=False, **place)
        return
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    shown = _shown(family)
    scale = Normalize(float(shown.min()), float(shown.max()))
    bar = ScalarMappable(scale, ListedColormap(_colours(256)))
    ax.figure.colorbar(bar, ax=ax, label=title)
