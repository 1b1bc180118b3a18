"""Polar diagrams: a torque or force over the crank angle, drawn as the crank turns."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..runtime.request import several
from ..support.extras import needed
from ..support.forks import IMPORTS
from .jumps import with_jumps
from .picture import Picture
from .shared import chosen, drawn, finish, input_in_si, label_of, worth_showing
from .titles import title_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

SIZE = (6.4, 6.0)  # inches
TITLE = 56  # letters in a line
BESIDE = 0.2  # rad: as far a number reaches
FREE = 22.5 + 45.0 * np.arange(8)  # deg: between the angles that are named


def polar(
    dataset: "xr.Dataset",
    name: str | tuple[str, str],
    *,
    family: str | None = None,
    ax: "Axes | None" = None,
) -> Picture:
    """Draw a quantity over the crank angle in polar coordinates; a Picture of the lines.

    dataset  the result of `desaxe.grid` or of a scene, with the dimension theta
    name     the quantity, such as "T_in"; or two, such as ("F_B_X", "F_B_Y"), whose magnitude is drawn
    family   the dimension that tells the curves apart; by default the other one, if there is one
    ax       where to draw: polar Axes; by default those of a new Figure

    theta is where the crank is: 0 is up, along the slider axis, and it turns towards the right. A
    quantity of either sign is 0 on the dark circle, positive outside of it and negative inside.
    Labels, gaps and complaints are those of `curves`.
    """
    with needed("plot.polar"):
        from matplotlib.figure import Figure
    names = [name] if isinstance(name, str) else list(several(name))
    parts = [with_jumps(dataset, chosen(dataset, part, "theta", family), "theta") for part in names]
    array = parts[0] if isinstance(name, str) else _magnitude(parts)
    beside = ax is None
    axes: Any = Figure(figsize=SIZE, layout="constrained").add_subplot(projection="polar") if beside else ax
    if axes.name != "polar":
        raise ValueError("ax: expected polar Axes, such as figure.add_subplot(projection='polar')")
    lines = drawn(axes, input_in_si(array["theta"]), array, beside)
    _finish(axes, array, lines)
    if beside:
        axes.set_title(title_of(dataset, names, TITLE), loc="left", fontsize="medium", pad=12)
    return Picture(axes, lines)


def _magnitude(parts: "list[xr.DataArray]") -> "xr.DataArray":
    """The length of the vector with these two components, under their common name."""
    if len(parts) != 2:
        raise ValueError(f"name: one quantity or the two components of a vector, got {len(parts)}")
    first, second = parts
    if first.attrs.get("units") != second.attrs.get("units"):
        raise ValueError(
            f"name: {first.name} and {second.name} are not components of one vector: their units differ"
        )
    meaning = str(first.attrs.get("long_name", "")).removesuffix(" along X")
    attributes = {"units": first.attrs.get("units", ""), "long_name": f"magnitude of the {meaning}"}
    length: Any = np.hypot(first, second)
    named: xr.DataArray = length.assign_attrs(attributes).rename(str(first.name).removesuffix("_X"))
    return named


def _finish(axes: Any, array: "xr.DataArray", lines: "list[Line2D]") -> None:
    """Up is where the slider is; the radial axis ends where nothing is left to see."""
    with IMPORTS:
        from matplotlib.ticker import MaxNLocator

    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    values = [np.asarray(line.get_ydata(), dtype=np.float64) for line in lines]
    finite = np.concatenate([v[np.isfinite(v)] for v in values])
    low, high = worth_showing(values) or (finite.min(initial=0.0), finite.max(initial=0.0))
    if finite.min(initial=0.0) >= 0.0:
        axes.set_ylim(0.0, 1.05 * high or 1.0)
    else:
        axes.set_ylim(low - 0.35 * (high - low), high + 0.05 * (high - low))
        axes.plot(np.linspace(0.0, 2.0 * np.pi, 361), np.zeros(361), color="0.35", linewidth=1.0, zorder=1)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel(f"{label_of(array)}\nover the {label_of(array['theta'])}", labelpad=12)
    for text in axes.yaxis.get_ticklabels():
        text.set_bbox({"facecolor": "w", "edgecolor": "none", "alpha": 0.75, "pad": 0.8})
    axes.set_rlabel_position(_free_angle(axes, lines))
    finish(axes, without=["polar"])


def _free_angle(axes: Any, lines: "list[Line2D]") -> float:
    """The angle [deg] at which the numbers of the radial axis lie furthest from all curves."""
    low, high = axes.get_ylim()
    ticks = [float(tick) for tick in axes.yaxis.get_majorticklocs() if low < tick < high]
    free = [
        sum(_clearance(lines, np.radians(angle), tick, 0.3 * (high - low)) for tick in ticks)
        for angle in FREE
    ]
    return float(FREE[int(np.argmax(free))])


def _clearance(lines: "list[Line2D]", angle: float, tick: float, most: float) -> float:
    """The distance of a number on the radial axis from the curves beside it, at most `most`."""
    for line in lines:
        theta, values = (np.asarray(data, dtype=np.float64) for data in line.get_data())
        beside = np.abs((theta - angle + np.pi) % (2.0 * np.pi) - np.pi) < BESIDE
        near = values[beside & np.isfinite(values)]
        if near.size:
            most = min(most, max(near.min() - tick, tick - near.max(), 0.0))
    return most
