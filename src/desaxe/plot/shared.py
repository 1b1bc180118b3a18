"""Shared by all pictures: selection of values, labels, colours and legends."""

import re
import textwrap
from collections.abc import Sequence
from math import degrees, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.inputs import INPUTS
from ..mechanism.names import parts
from ..mechanism.read import read_array
from ..support.forks import IMPORTS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

BLUE, ORANGE = "#0072B2", "#D55E00"  # of Okabe and Ito, distinct for the colour-blind
MOST_IN_LEGEND = 10  # curves; more get a colour bar
BOUNDED = 3.0  # of the range of curves without gaps: others that stay within that are shown whole
WIDE = 58  # letters of a label in one line
ROOM, NEAR = 0.02, 0.01  # of an axis: beside a jump that is as near to its end
MINUTE = 30.0 / pi  # rpm in a rad/s
LEAST = 1e-6  # of the largest step between samples: a jump


def chosen(dataset: "xr.Dataset", name: str, over: str, family: str | None) -> "xr.DataArray":
    """The quantity with the dimensions (family, over) or (over)."""
    if name not in dataset:
        raise ValueError(f"no {name!r} in this dataset, it has: {', '.join(map(str, dataset.data_vars))}")
    if family is None:
        rest = [str(dim) for dim in dataset[name].dims if dim != over]
        family = rest[0] if len(rest) == 1 else None
    if family == over:
        raise ValueError(f"family = {family!r}: it must be another dimension than over")
    return choose(dataset, name, [*([family] if family else []), over])


def choose(dataset: "xr.Dataset", name: str, dims: Sequence[str]) -> "xr.DataArray":
    """The quantity with these dimensions, and no others."""
    if name not in dataset:
        raise ValueError(f"no {name!r} in this dataset, it has: {', '.join(map(str, dataset.data_vars))}")
    array = dataset[name]
    for dim in reversed(dims):
        if dim not in array.dims:
            raise ValueError(
                f"{name} has no dimension {dim!r}, it has: {', '.join(map(str, array.dims)) or 'none'}"
            )
    rest = [str(dim) for dim in array.dims if dim not in dims]
    if rest:
        wanted = ", ".join(f"{dim}=..." for dim in rest)
        raise ValueError(
            f"{name} varies with {', '.join(rest)} too: choose a value first, dataset.sel({wanted})"
        )
    return array.transpose(*dims)


def drawn(
    ax: "Axes", horizontal: NDArray[np.float64], array: "xr.DataArray", beside: bool | None
) -> "list[Line2D]":
    """The curves of (family, over) or (over); of a family with a legend, beside them or among them."""
    family = array[array.dims[0]] if array.ndim > 1 else None
    members = [None] if family is None else family
    lines: list[Line2D] = []
    for member, values, colour in zip(
        members, np.atleast_2d(array.values), colours(len(members)), strict=True
    ):
        label = None if member is None else f"{float(shown(member)):.6g}"
        lines += ax.plot(horizontal, values, color=colour, linewidth=1.6, label=label)
    if family is not None and beside is not None:
        _explain(ax, family, lines, beside)
    return lines


def mark_gaps(ax: "Axes", lines: "Sequence[Line2D]") -> None:
    """Hatch where no curve has a value; mark the gaps of one of several at the foot, in its colour."""
    across = ax.get_xaxis_transform()
    values = [np.asarray(line.get_ydata(), dtype=np.float64) for line in lines]
    if not values or values[0].size < 2:
        return
    angles = np.asarray(lines[0].get_xdata(), dtype=np.float64)
    everywhere = np.all([np.isnan(v) for v in values], axis=0)
    note = "no value"
    for low, high in _spans(angles, everywhere):
        ax.axvspan(low, high, facecolor="0.95", edgecolor="0.75", hatch="////", linewidth=0.0, zorder=0)
        ax.text((low + high) / 2, 0.5, note, transform=across, rotation=90, color="0.35",
                ha="center", va="center", fontsize="small", zorder=1)  # fmt: skip
        note = ""
    middle, top = 0.0, 0.0
    for k, (line, own) in enumerate(zip(lines, values, strict=True)):
        foot = 0.008 + 0.016 * k
        for low, high in _spans(angles, np.isnan(own) & ~everywhere):
            ax.plot([low, high], [foot, foot], color=line.get_color(), linewidth=3.0, alpha=0.55,
                    transform=across, solid_capstyle="butt", zorder=3)  # fmt: skip
            middle, top = (low + high) / 2, foot
    if top and note:
        ax.text(middle, top + 0.015, note, transform=across, color="0.35", ha="center", fontsize="small",
                zorder=3)  # fmt: skip


def _spans(places: NDArray[np.float64], missing: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """The intervals of missing values, from the last value before to the first one after."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], missing, [False]]).astype(np.int8)))
    last = places.size - 1
    return [
        (float(places[max(start - 1, 0)]), float(places[min(stop, last)]))
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
    ]


def shown(array: "xr.DataArray") -> NDArray[np.float64]:
    """The values as they are shown: angles in degrees."""
    values: NDArray[np.float64] = np.asarray(array.values, dtype=np.float64)
    return values * degrees(1.0) if array.attrs.get("units") == "rad" else values


def input_in_si(array: "xr.DataArray") -> NDArray[np.float64]:
    """The values of a labelled input in its SI unit, whatever it is labelled in."""
    return read_array(INPUTS[str(array.name)], array)


def worth_showing(curves: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """The range to show for curves with gaps, which may be unbounded; None without gaps.

    It is that of the curves without gaps. Where each has some, it is that of most values. If this is
    nearly the range of all, nothing is cut.
    """
    whole = [values for values in curves if np.isfinite(values).all()]
    every = np.concatenate([values[np.isfinite(values)] for values in curves])
    if len(whole) == len(curves) or not every.size:
        return None
    if whole:
        low, high = min(v.min() for v in whole), max(v.max() for v in whole)
    else:
        low, high = np.percentile(every, [5.0, 95.0])
    if np.ptp(every) <= BOUNDED * (high - low):
        return None
    room = 0.25 * (high - low) or 1.0
    return float(low - room), float(high + room)


def around_level(curves: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """The range to show for curves that are level but for rounding, which no axis magnifies; else None."""
    every = np.concatenate([values[np.isfinite(values)] for values in curves])
    level = float(np.abs(every).max(initial=0.0))
    if not level or np.ptp(every) > 1e-9 * level:
        return None
    middle = float(every[0])
    return middle - 0.05 * level, middle + 0.05 * level


def unit_of(array: "xr.DataArray") -> str:
    """The unit for a label: degrees for an input that is an angle, m/s^2 with a raised 2, N m."""
    unit = str(array.attrs.get("units", ""))
    if unit == "rad" and array.ndim == 1 and array.name in array.dims:
        return "[deg]"
    return raised(unit)


def raised(unit: str) -> str:
    """A unit in brackets, its powers raised; nothing for a plain number."""
    powers = re.sub(r"\^(-?[0-9]+)", r"$^{\1}$", unit).replace("*", " ")
    return f"[{powers}]" if unit and unit != "1" else ""


def meaning_of(array: "xr.DataArray") -> str:
    """The meaning of a quantity in a few words."""
    told = str(array.attrs.get("long_name", ""))
    if parts(str(array.name))[1]:
        return told  # "derivative of Y by theta, theta" says two things
    peak, colon, rest = told.partition(" over a turn: ")
    return f"{peak} of the {rest}" if colon else told.partition(",")[0].partition(":")[0]


def finish(axes: Any, grid: str = "both", without: Sequence[str] = ("top", "right")) -> None:
    """The style of every picture: a pale grid behind the curves, and a frame without some of its sides."""
    if grid:
        axes.grid(True, axis=grid, color="0.9", linewidth=0.8)
        axes.set_axisbelow(True)
    for side in without:
        axes.spines[side].set_visible(False)


def turn_axis(axes: Any, low: float, high: float) -> None:
    """A horizontal axis of whole turns in degrees, with a tick at every eighth of a turn."""
    with IMPORTS:
        from matplotlib.ticker import MultipleLocator

    ends = [360.0 * round(end / 360.0) for end in (low, high)]
    axes.set_xlim(*ends)
    axes.xaxis.set_major_locator(MultipleLocator(45.0 * max(1.0, round((ends[1] - ends[0]) / 360.0))))


def rpm_for(unit: str) -> tuple[str, float]:
    """The unit in which a speed is shown, and its factor: rpm for rad/s."""
    return ("rpm", MINUTE) if unit == "rad/s" else (unit, 1.0)


def finish_axis(axis: Any, input_: "xr.DataArray") -> None:
    """Label, limits and ticks of an axis along an input; angles in degrees that divide a turn."""
    values = shown(input_)
    vertical = axis.axis_name == "y"
    (axis.axes.set_ylabel if vertical else axis.axes.set_xlabel)(label_of(input_))
    if values.size > 1:
        limits = float(values.min()), float(values.max())
        (axis.axes.set_ylim if vertical else axis.axes.set_xlim)(*limits)
    if unit_of(input_) == "[deg]" and np.ptp(values) >= 180.0:
        with IMPORTS:
            from matplotlib.ticker import MaxNLocator

        axis.set_major_locator(MaxNLocator(9, steps=[1, 3, 4.5, 6, 9, 10]))


def room_at_jumps(ax: "Axes", places: NDArray[np.float64], curves: NDArray[np.float64]) -> None:
    """Widen the axis where a curve jumps at an end of it: the frame would hide the jump.

    places  of the samples along the axis, ascending: two in one place are the sides of a jump
    curves  the values there, of one curve or several
    """
    if places.size < 2:
        return
    with np.errstate(invalid="ignore"):
        wide, rise = float(np.ptp(places)), np.abs(np.diff(np.atleast_2d(curves)))
    leaps = (rise > LEAST * np.nanmax(rise, initial=0.0)).any(axis=0)
    jumps = places[1:][leaps & (np.diff(places) <= 1e-9 * wide)]
    low, high = ax.get_xlim()
    left = ROOM * wide * bool((jumps <= places[:1] + NEAR * wide).any())
    right = ROOM * wide * bool((jumps >= places[-1:] - NEAR * wide).any())
    ax.set_xlim(low - left, high + right)


def label_of(array: "xr.DataArray") -> str:
    """Meaning, name and unit; a long one in several lines."""
    meaning = meaning_of(array)
    symbol = f"{array.name} {unit_of(array)}".rstrip()
    if not meaning:
        return symbol
    if meaning.replace(" ", "_") == array.name:
        return f"{meaning} {unit_of(array)}".rstrip()
    whole = f"{meaning}, {symbol}"
    return whole if len(whole) <= WIDE else f"{textwrap.fill(f'{meaning},', WIDE)}\n{symbol}"


def colours(count: int) -> list[Any]:
    """Evenly spaced colours of viridis without its palest end, distinct for the colour-blind and in print."""
    with IMPORTS:
        from matplotlib import colormaps

    return [colormaps["viridis"](0.9 * k / max(1, count - 1)) for k in range(count)]


def _explain(ax: "Axes", family: "xr.DataArray", lines: "list[Line2D]", beside: bool) -> None:
    """Add a legend, beside the curves where there is space, or a colour bar for many curves."""
    title = f"{family.name} {unit_of(family)}".rstrip()
    if len(lines) <= MOST_IN_LEGEND:
        place = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)} if beside else {"loc": "best"}
        ax.legend(title=title, frameon=False, **place)
        return
    with IMPORTS:
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import ListedColormap, Normalize

    values = shown(family)
    scale = Normalize(float(values.min()), float(values.max()))
    bar = ScalarMappable(scale, ListedColormap(colours(256)))
    ax.figure.colorbar(bar, ax=ax, label=title)
