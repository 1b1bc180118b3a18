"""Quantities over one input: families of curves, panels one above the other, the histories of a motion."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.quantity_units import SI
from .dataset import as_dataset, chosen, dataset_of_motion, is_motion
from .picture import Picture
from .style import (
    ORANGE,
    axes_of,
    drawn,
    figure_type,
    finish,
    finish_axis,
    head,
    label_of,
    meaning_of,
    shown,
    title_of,
    unit_of,
)

if TYPE_CHECKING:
    import xarray as xr

SIZE, PANEL = (8.0, 4.8), 1.9  # inches: of a picture, the height of a panel
ALWAYS = ("status", "margin")
BOUNDED = 3.0  # of the range of curves without gaps: others that stay within that are shown whole
LEVEL = 1e-9  # of a value: what changes less is level but for rounding
MARGIN, NEAR = 0.02, 0.01  # of an axis: beside a jump that is as near to its end
LEAP = 1e-6  # of the largest step between samples: a jump
# ---- of a motion
LEAST, FINE, MOST = 24, 60, 30_000  # instants: of a turn that a line shows, of one that is redrawn, of all
STEP = 2e-4  # of a turn: the step of the difference that is the acceleration
MARKED = 40  # events of a kind; of more the legend has the number
MARKS = {"dead centre": "|", "standstill": "o", "angle": "D", "break-away": "^"}  # others end the motion: X


def curves(
    dataset: "xr.Dataset | Mapping[str, Any]",
    name: str,
    *,
    over: str = "theta",
    family: str | None = None,
    ax: Any = None,
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
    axes = axes_of("curves", ax, SIZE)
    dataset = as_dataset(dataset, over, inputs)
    lines = _draw(axes, chosen(dataset, name, over, family), over, beside=ax is None)
    if ax is None:
        head(axes, title_of(dataset, [name]))
    return Picture(axes, lines)


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
    new = figure_type("panels")
    dataset = as_dataset(dataset, over, inputs)
    if names is None:
        names = [str(n) for n, a in dataset.data_vars.items() if over in a.dims and n not in ALWAYS]
    arrays = [chosen(dataset, name, over, family) for name in names]
    if not arrays:
        raise ValueError(f"nothing in this dataset varies with {over!r}")
    if ax is None:
        figure = new(figsize=(SIZE[0], 0.8 + PANEL * len(arrays)), layout="constrained")
        axes = list(figure.subplots(len(arrays), sharex=True, squeeze=False)[:, 0])
        figure.suptitle(title_of(dataset, names), x=0.01, ha="left", fontsize="medium")
    else:
        axes = list(ax) if hasattr(ax, "__len__") else [ax]
    if len(axes) != len(arrays):
        requested = f"expected {len(arrays)} Axes, one for each of {', '.join(names)}"
        raise ValueError(f"ax: {requested}; got {len(axes)}")
    lines = {}
    for index, (array, axis) in enumerate(zip(arrays, axes, strict=True)):
        lines[str(array.name)] = _draw(axis, array, over, beside=True if index == 0 else None)
        axis.set_title(meaning_of(array), loc="left", fontsize="small", color="0.3")
        between = "\n" if "_wrt_" in str(array.name) else " "  # as long as a panel is high
        axis.set_ylabel(f"{array.name}{between}{unit_of(array)}".rstrip())
        if index < len(arrays) - 1:
            axis.set_xlabel("")
    if ax is None:
        figure.align_ylabels(axes)
    return Picture(axes, lines)


def _draw(ax: Any, array: "xr.DataArray", over: str, beside: bool | None) -> list[Any]:
    """The curves of (family, over) or (over), with labels, ticks and limits."""
    lines = drawn(ax, shown(array[over]), array, beside)
    finish_axis(ax.xaxis, array[over])
    _widen_at_jumps(ax, shown(array[over]), array.values)
    ax.set_ylabel(label_of(array))
    values = [np.asarray(line.get_ydata(), dtype=np.float64) for line in lines]
    _mark_gaps(ax, lines, shown(array[over]), values)
    limits = limits_of(values)
    if limits is not None:
        ax.set_ylim(*limits)
    finish(ax)
    return lines


def limits_of(curves: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """The range to show of curves with gaps, which may be unbounded, or level but for rounding; else None.

    That of the curves without gaps, or of most values where each has some. If this is nearly the range of
    all, nothing is cut.
    """
    every = np.concatenate([values[np.isfinite(values)] for values in curves])
    level = float(np.abs(every).max(initial=0.0))
    if level and np.ptp(every) <= LEVEL * level:
        return float(every[0]) - 0.05 * level, float(every[0]) + 0.05 * level
    whole = [values for values in curves if np.isfinite(values).all()]
    if len(whole) == len(curves) or not every.size:
        return None
    low, high = (np.min(whole), np.max(whole)) if whole else np.percentile(every, [5.0, 95.0])
    if np.ptp(every) <= BOUNDED * (high - low):
        return None
    margin = 0.25 * (high - low) or 1.0
    return float(low - margin), float(high + margin)


def _mark_gaps(ax: Any, lines: Sequence[Any], across: Any, values: Sequence[NDArray[np.float64]]) -> None:
    """Hatch where no curve has a value; mark the gaps of one of several at the foot, in its colour."""
    missing = [np.isnan(v) for v in values]
    everywhere = np.logical_and.reduce(missing)
    style: dict[str, Any] = {"transform": ax.get_xaxis_transform(), "zorder": 3}
    notes = []
    for low, high in _spans(across, everywhere):
        ax.axvspan(low, high, facecolor="0.95", edgecolor="0.75", hatch="////", linewidth=0.0, zorder=0)
        notes.append((0.5 * (low + high), 0.5, 90))
    for k, line in enumerate(lines):
        foot = 0.008 + 0.016 * k
        for low, high in _spans(across, missing[k] & ~everywhere):
            ax.plot([low, high], [foot, foot], color=line.get_color(), linewidth=3.0, alpha=0.55,
                    solid_capstyle="butt", **style)  # fmt: skip
            notes.append((0.5 * (low + high), foot + 0.023, 0))
    if notes:
        x, y, turned = notes[0] if everywhere.any() else notes[-1]
        words = {"ha": "center", "va": "center", "color": "0.35", "fontsize": "small", "rotation": turned}
        ax.text(x, y, "no value", **words, **style)


def _spans(across: NDArray[np.float64], missing: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """The intervals of missing values, from the last value before to the first one after."""
    edges = np.flatnonzero(np.diff(missing.astype(np.int8), prepend=0, append=0))
    last = across.size - 1
    return [
        (float(across[max(start - 1, 0)]), float(across[min(stop, last)]))
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
        if last
    ]


def _widen_at_jumps(ax: Any, across: NDArray[np.float64], curves: NDArray[np.float64]) -> None:
    """Widen the axis where a curve jumps at an end of it: the frame would hide the jump.

    across  the samples along the axis, ascending: two that are equal are the sides of a jump
    curves  the values there, of one curve or several
    """
    if across.size < 2:
        return
    with np.errstate(invalid="ignore"):
        width, rise = float(np.ptp(across)), np.abs(np.diff(np.atleast_2d(curves)))
    leaps = (rise > LEAP * np.nanmax(rise, initial=0.0)).any(axis=0)
    jumps = across[1:][leaps & (np.diff(across) <= 1e-9 * width)]
    low, high = ax.get_xlim()
    left = MARGIN * width * bool((jumps <= across[:1] + NEAR * width).any())
    right = MARGIN * width * bool((jumps >= across[-1:] - NEAR * width).any())
    ax.set_xlim(low - left, high + right)


# ---- motions -------------------------------------------------------------------------------------


def motion(result: Mapping[str, Any], *, ax: Any = None) -> Picture:
    """Draw the histories of a motion over time, one above the other, with its events on the crank angle.

    result  of `desaxe.simulate`, of one design or of many, each of which has its curve then
    ax      where to draw: a matplotlib Axes for each history, in a list; by default those of a new Figure

    Returns a Picture of the lines by name: theta, omega, alpha, the quantities asked for and sensitivities.
    """
    figure_type("motion")
    if not is_motion(result):
        raise TypeError("plot.motion draws a result of desaxe.simulate")
    dataset = dataset_of_motion(result, "t")
    picture = panels(dataset, list(map(str, dataset.data_vars)), over="t", ax=ax)
    units = getattr(result, "system", None) or SI
    turns = float(np.nanmax(np.abs(result["omega"]), initial=0.0)) * float(units.of("omega").si)
    turns *= float(result["t"][-1]) * float(units.of("t").si) / (2.0 * np.pi)  # at the largest speed
    if np.size(result["t"]) < LEAST * turns:
        _redraw(picture, result, units, turns)
    if result.get("events"):
        _mark_events(picture.axes[0], result["events"])
    return picture


def _redraw(picture: Picture, result: Mapping[str, Any], units: Any, turns: float) -> None:
    """Draw the motion at many instants, and other histories as points: a line between few is no curve."""
    t = np.linspace(0.0, float(result["t"][-1]), min(MOST, int(FINE * turns)))
    dense = _dense(result, t, units, turns) if "solution" in result else {}
    for axis, (name, lines) in zip(picture.axes, picture.artists.items(), strict=True):
        for line in lines:
            if name in dense:
                line.set_data(t, dense[name])
            else:
                line.set(linestyle="none", marker=".", markersize=3.0)
        axis.relim()
        axis.autoscale_view()


def _dense(result: Mapping[str, Any], t: NDArray[np.float64], units: Any, turns: float) -> dict[str, Any]:
    """Angle, speed and acceleration at instants from the first to the last, in the units of the result."""
    step = STEP * t[-1] / max(1.0, turns)
    sides = np.clip(t - step, 0.0, t[-1]), np.clip(t + step, 0.0, t[-1])
    before, after = (result["solution"](side)["omega"] for side in sides)
    omega, time, alpha = (float(units.of(name).si) for name in ("omega", "t", "alpha"))
    slope = (after - before) / (sides[1] - sides[0]) * (omega / time / alpha)
    slope[[0, -1]] = result["alpha"][[0, -1]]
    return {**result["solution"](t), "alpha": slope}


def _mark_events(ax: Any, events: list[Any]) -> None:
    """Mark the events on the curve of the crank angle, each kind by its own sign, unless there are many."""
    for kind in dict.fromkeys(event.kind for event in events):
        marked = [event for event in events if event.kind == kind]
        label = kind
        if len(marked) > MARKED:
            label, marked = f"{kind}: {len(marked)}, not marked", []
        face = "none" if kind == "standstill" else ORANGE
        ax.plot([e.t for e in marked], [e.theta for e in marked], MARKS.get(kind, "X"), label=label,
                color=ORANGE, markerfacecolor=face, zorder=4)  # fmt: skip
    ax.legend(frameon=False, fontsize="small", loc="best")
