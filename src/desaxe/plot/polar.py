"""Round diagrams: a torque or force over the crank angle as the crank turns; the star of a harmonic."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..runtime.request import several
from ..support.forks import IMPORTS
from .curves import limits_of
from .dataset import chosen, input_in_si
from .picture import Picture
from .style import axes_of, drawn, finish, head, label_of, title_of

if TYPE_CHECKING:
    import xarray as xr

SIZE, STAR = (6.4, 6.0), (5.2, 5.0)  # inches
TITLE = 56  # letters in a line
FREE = 22.5 + 45.0 * np.arange(8)  # deg: between the angles that are named
NOTHING = 1e-9  # of the largest arrow: a sum that is none


def polar(
    dataset: "xr.Dataset", name: str | tuple[str, str], *, family: str | None = None, ax: Any = None
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
    axes = axes_of("polar", ax, SIZE, projection="polar")
    names = [name] if isinstance(name, str) else list(several(name))
    parts = [chosen(dataset, part, "theta", family) for part in names]
    array = parts[0] if isinstance(name, str) else _magnitude(parts)
    if axes.name != "polar":
        raise ValueError("ax: expected polar Axes, such as figure.add_subplot(projection='polar')")
    lines = drawn(axes, input_in_si(array["theta"]), array, ax is None)
    _finish(axes, array, lines)
    if ax is None:
        head(axes, title_of(dataset, names, TITLE), pad=12)
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


def _finish(axes: Any, array: "xr.DataArray", lines: list[Any]) -> None:
    """Up is where the slider is; the radial axis ends where nothing is left to see."""
    with IMPORTS:
        from matplotlib.ticker import MaxNLocator

    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    theta = np.asarray(lines[0].get_xdata(), dtype=np.float64)
    values = [np.asarray(line.get_ydata(), dtype=np.float64) for line in lines]
    finite = np.concatenate([v[np.isfinite(v)] for v in values])
    least, most = finite.min(initial=0.0), finite.max(initial=0.0)
    low, high = limits_of(values) or (least, most)
    if least >= 0.0:
        axes.set_ylim(0.0, 1.05 * high or 1.0)
    else:
        axes.set_ylim(low - 0.35 * (high - low), high + 0.05 * (high - low))
        axes.plot(np.linspace(0.0, 2.0 * np.pi, 361), np.zeros(361), color="0.35", linewidth=1.0, zorder=1)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel(f"{label_of(array)}\nover the {label_of(array['theta'])}", labelpad=12)
    for text in axes.yaxis.get_ticklabels():
        text.set_bbox({"facecolor": "w", "edgecolor": "none", "alpha": 0.75, "pad": 0.8})
    there = [np.interp(np.radians(FREE), theta, v, period=2.0 * np.pi) for v in values]
    clear = np.nan_to_num(np.abs(there - np.mean(axes.get_ylim())), nan=np.inf).min(axis=0)
    axes.set_rlabel_position(float(FREE[clear.argmax()]))  # the numbers, furthest from all curves
    finish(axes, without=["polar"])


def star(arrows: Mapping[str, complex], title: str = "", unit: str = "", *, ax: Any = None) -> Picture:
    """Draw complex amplitudes as arrows from the centre, and tip to tail; a Picture of the arrows.

    arrows  label -> amplitude exp(i phase); the phase counts like theta: 0 is up, and it turns to the right
    title   by default none
    unit    of the amplitudes

    Tip to tail, thin, the arrows end where the sum does: at the centre where they balance.
    """
    axes = axes_of("star", ax, STAR)
    total, pictured = 0j, []
    for number, (label, value) in enumerate(arrows.items()):
        colour = f"C{number}"
        style = {"arrowstyle": "-|>", "color": colour, "lw": 2.0, "shrinkA": 0, "shrinkB": 0}
        pictured.append(axes.annotate("", (value.imag, value.real), (0.0, 0.0), arrowprops=style))
        axes.update_datalim([(value.imag, value.real)])  # which annotations do not
        end = total + value
        axes.plot([total.imag, end.imag], [total.real, end.real], color=colour, lw=1.0, ls="--", label=label)
        total = end
    size = max((abs(value) for value in arrows.values()), default=1.0) or 1.0
    axes.plot(total.imag, total.real, "ko", ms=5, label="sum")
    amplitude = "0" if abs(total) <= NOTHING * size else f"{abs(total):.4g} {unit}".strip()
    head(axes, f"{title}; sum {amplitude}".removeprefix("; "))
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    units = f" [{unit}]" if unit else ""
    axes.set(xlabel=f"sine part{units}", ylabel=f"cosine part{units}")
    axes.axhline(0.0, color="0.7", lw=0.8, zorder=0)
    axes.axvline(0.0, color="0.7", lw=0.8, zorder=0)
    axes.legend(frameon=False, fontsize="small")
    finish(axes)
    return Picture(axes, pictured)
