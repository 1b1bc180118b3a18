"""What all pictures share: which values are drawn, what labels say, how curves are told apart."""

import re
import textwrap
from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

MOST_IN_LEGEND = 10  # curves; more get a colour bar
WIDE = 58  # letters of a label in one line


def chosen(dataset: "xr.Dataset", name: str, over: str, family: str | None) -> "xr.DataArray":
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


def drawn(ax: "Axes", horizontal: NDArray[np.float64], array: "xr.DataArray", beside: bool) -> "list[Line2D]":
    """The curves of (family, over) or (over), with a legend where they are a family."""
    family = array[array.dims[0]] if array.ndim > 1 else None
    members = [None] if family is None else family
    lines: list[Line2D] = []
    for member, values, colour in zip(
        members, np.atleast_2d(array.values), colours(len(members)), strict=True
    ):
        label = None if member is None else f"{float(shown(member)):.6g}"
        lines += ax.plot(horizontal, values, color=colour, linewidth=1.6, label=label)
    if family is not None:
        _explain(ax, family, lines, beside)
    return lines


def shown(array: "xr.DataArray") -> NDArray[np.float64]:
    """The values as they are shown: angles in degrees."""
    values: NDArray[np.float64] = np.asarray(array.values, dtype=np.float64)
    return values * degrees(1.0) if array.attrs.get("units") == "rad" else values


def worth_showing(curves: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """Where curves with gaps may grow without bound, the range to show; None where there is no gap.

    It is that of the curves without gaps. Where each has some, it is that of most values, unless
    this is nearly the range of all.
    """
    whole = [values for values in curves if np.isfinite(values).all()]
    if len(whole) == len(curves):
        return None
    if whole:
        low, high = min(v.min() for v in whole), max(v.max() for v in whole)
    else:
        every = np.concatenate([values[np.isfinite(values)] for values in curves])
        if not every.size:
            return None
        low, high = np.percentile(every, [5.0, 95.0])
        if np.ptp(every) <= 2.0 * (high - low):
            return None
    room = 0.25 * (high - low) or 1.0
    return float(low - room), float(high + room)


def unit_of(array: "xr.DataArray") -> str:
    """The unit for a label: degrees for an input that is an angle, m/s^2 with a raised 2, N m."""
    unit = str(array.attrs.get("units", ""))
    if unit == "rad" and array.ndim == 1 and array.name in array.dims:
        return "[deg]"
    raised = re.sub(r"\^(-?[0-9]+)", r"$^{\1}$", unit).replace("*", " ")
    return f"[{raised}]" if unit and unit != "1" else ""


def label_of(array: "xr.DataArray") -> str:
    """Meaning, name and unit; a long one in several lines."""
    meaning = str(array.attrs.get("long_name", "")).partition(",")[0].partition(":")[0]
    symbol = f"{array.name} {unit_of(array)}".rstrip()
    if not meaning:
        return symbol
    whole = f"{meaning}, {symbol}"
    return whole if len(whole) <= WIDE else f"{textwrap.fill(f'{meaning},', WIDE)}\n{symbol}"


def colours(count: int) -> list[Any]:
    """Evenly spaced from viridis, without its palest end: told apart by the colour-blind and in print."""
    from matplotlib import colormaps

    return [colormaps["viridis"](0.9 * k / max(1, count - 1)) for k in range(count)]


def _explain(ax: "Axes", family: "xr.DataArray", lines: "list[Line2D]", beside: bool) -> None:
    """A legend, beside the curves where there is room, or a colour bar where they are many."""
    title = f"{family.name} {unit_of(family)}".rstrip()
    if len(lines) <= MOST_IN_LEGEND:
        place = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)} if beside else {"loc": "best"}
        ax.legend(title=title, frameon=False, **place)
        return
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    values = shown(family)
    scale = Normalize(float(values.min()), float(values.max()))
    bar = ScalarMappable(scale, ListedColormap(colours(256)))
    ax.figure.colorbar(bar, ax=ax, label=title)
