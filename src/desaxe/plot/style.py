"""The style of all pictures: axes, labels, units, titles, colours and legends."""

import re
import textwrap
from collections.abc import Collection, Iterator, Sequence
from math import degrees, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.catalogue import has, law_name
from ..mechanism.inputs import INPUTS
from ..mechanism.names import CENTRES, LOADS, parts
from ..mechanism.program import Variant, program_of
from ..support.extras import needed
from ..support.forks import IMPORTS

if TYPE_CHECKING:
    import xarray as xr

BLUE, ORANGE = "#0072B2", "#D55E00"  # of Okabe and Ito, distinct for the colour-blind
MOST_IN_LEGEND = 10  # curves; more get a colour bar
LABEL, TITLE = 58, 80  # letters in a line
MINUTE = 30.0 / pi  # rpm in a rad/s
ACTING = ("alpha", *(name for name in LOADS if name not in CENTRES))  # nothing where they are 0
_LOADS = re.compile(r"(\w+): <(.*?)>(?=; \w+: <|$)")
_POINTS = re.compile(r"\bload (?=over)|: [0-9]+ points, \w+(?=,)| \(points .*?\)")  # left out of a title
_RANGE = re.compile(r" to [^ ]+$")  # without its unit


def figure_type(name: str) -> Any:
    """The class Figure of matplotlib, for a picture of this name; pyplot and its global state stay out."""
    with needed(f"plot.{name}"):
        from matplotlib.figure import Figure
    return Figure


def axes_of(name: str, ax: Any, size: tuple[float, float], **options: Any) -> Any:
    """Some axes, or those of a new figure of a size in inches."""
    figure = figure_type(name)
    return figure(figsize=size, layout="constrained").add_subplot(**options) if ax is None else ax


def finish(axes: Any, grid: str = "both", without: Sequence[str] = ("top", "right")) -> None:
    """The style of every picture: a pale grid behind the curves, and a frame without some of its sides."""
    if grid:
        axes.grid(True, axis=grid, color="0.9", linewidth=0.8)
        axes.set_axisbelow(True)
    for side in without:
        axes.spines[side].set_visible(False)


def angle_ticks(axis: Any) -> None:
    """Ticks in degrees that divide a turn."""
    with IMPORTS:
        from matplotlib.ticker import MaxNLocator

    axis.set_major_locator(MaxNLocator(9, steps=[1, 3, 4.5, 6, 9, 10]))


def finish_axis(axis: Any, array: "xr.DataArray") -> None:
    """Label, limits and ticks of an axis along an input."""
    values = shown(array)
    vertical = axis.axis_name == "y"
    axis.set_label_text(label_of(array))
    if values.size > 1:
        limits = float(values.min()), float(values.max())
        (axis.axes.set_ylim if vertical else axis.axes.set_xlim)(*limits)
    if unit_of(array) == "[deg]" and np.ptp(values) >= 180.0:
        angle_ticks(axis)


# ---- words ---------------------------------------------------------------------------------------


def shown(array: "xr.DataArray") -> NDArray[np.float64]:
    """The values as they are shown: angles in degrees."""
    values: NDArray[np.float64] = np.asarray(array.values, dtype=np.float64)
    return values * degrees(1.0) if array.attrs.get("units") == "rad" else values


def raised(unit: str) -> str:
    """A unit in brackets, its powers raised; nothing for a plain number."""
    powers = re.sub(r"\^(-?[0-9]+)", r"$^{\1}$", unit).replace("*", " ")
    return f"[{powers}]" if unit and unit != "1" else ""


def unit_of(array: "xr.DataArray") -> str:
    """The unit for a label: degrees for an input that is an angle, m/s^2 with a raised 2, N m."""
    unit = str(array.attrs.get("units", ""))
    angle = unit == "rad" and array.ndim == 1 and array.name in array.dims
    return "[deg]" if angle else raised(unit)


def rpm_for(unit: str) -> tuple[str, float]:
    """The unit in which a speed is shown, and its factor: rpm for rad/s."""
    return ("rpm", MINUTE) if unit == "rad/s" else (unit, 1.0)


def meaning_of(array: "xr.DataArray") -> str:
    """The meaning of a quantity in a few words."""
    words = str(array.attrs.get("long_name", ""))
    if parts(str(array.name))[1]:
        return words  # "derivative of Y by theta, theta" says two things
    peak, colon, rest = words.partition(" over a turn: ")
    return f"{peak} of the {rest}" if colon else words.partition(",")[0].partition(":")[0]


def label_of(array: "xr.DataArray") -> str:
    """Meaning, name and unit; a long one in several lines."""
    meaning, unit = meaning_of(array), unit_of(array)
    symbol = f"{array.name} {unit}".rstrip()
    if not meaning:
        return symbol
    if meaning.replace(" ", "_") == array.name:
        return f"{meaning} {unit}".rstrip()
    whole = f"{meaning}, {symbol}"
    return whole if len(whole) <= LABEL else f"{textwrap.fill(f'{meaning},', LABEL)}\n{symbol}"


def head(axes: Any, text: str, **options: Any) -> Any:
    """Set a title, at the left; the text."""
    return axes.set_title(text, loc="left", fontsize="medium", **options)


def filled(words: Sequence[str], width: int = TITLE) -> str:
    """Words in lines; none is broken but those that are longer than a line."""
    whole = (one.replace(" ", "\u00a0") if len(one) < width else one for one in words)
    return textwrap.fill(", ".join(whole), width)


def title_of(dataset: "xr.Dataset", names: Sequence[str], width: int = TITLE) -> str:
    """The inputs of these quantities that have one value, and the loads that vary with the motion."""
    state = "omega" in dataset.coords
    needs: Collection[str] = INPUTS
    if all(has(name, state) for name in names):
        needs = program_of(tuple(law_name(n) if state else n for n in names), Variant(state)).inputs
    loads = _LOADS.findall(str(dataset.attrs.get("loads", "")))
    words = [*_numbers(dataset, needs)]
    for name, text in loads:
        if name in needs:
            brief = f"{name} {raised(_POINTS.sub('', text))[1:-1]}"
            words.append(f"{brief} {INPUTS[name].unit}" if _RANGE.search(brief) else brief)
    if dataset.attrs.get("branch") == -1:
        words.append("branch = -1")
    return filled(words, width)


def _numbers(dataset: "xr.Dataset", needs: Collection[str]) -> Iterator[str]:
    for name, value in dataset.coords.items():
        unneeded = value.ndim or "units" not in value.attrs or (name in LOADS and name not in needs)
        if unneeded or (float(value) == 0.0 and name in ACTING):
            continue
        unit = "[deg]" if value.attrs["units"] == "rad" else raised(str(value.attrs["units"]))
        yield f"{name} = {float(shown(value)):.6g} {unit[1:-1]}".rstrip()


# ---- families of curves --------------------------------------------------------------------------


def colours(count: int) -> list[Any]:
    """Evenly spaced colours of viridis without its palest end, distinct for the colour-blind and in print."""
    with IMPORTS:
        from matplotlib import colormaps

    return [colormaps["viridis"](0.9 * k / max(1, count - 1)) for k in range(count)]


def drawn(ax: Any, horizontal: NDArray[np.float64], array: "xr.DataArray", beside: bool | None) -> list[Any]:
    """The curves of (family, over) or (over); of a family with a legend, beside them or among them."""
    values = np.atleast_2d(array.values)
    family = array[array.dims[0]] if array.ndim > 1 else None
    labels = [None] * len(values) if family is None else _labels(family)
    lines = [
        ax.plot(horizontal, row, color=colour, linewidth=1.6, label=label)[0]
        for label, row, colour in zip(labels, values, colours(len(labels)), strict=True)
    ]
    if family is not None and beside is not None:
        _explain(ax, family, len(lines), beside)
    return lines


def _labels(family: "xr.DataArray") -> list[str]:
    """The texts of a family, or its values."""
    return [*family.values] if family.dtype.kind == "U" else [f"{x:.6g}" for x in shown(family)]


def _explain(ax: Any, family: "xr.DataArray", count: int, beside: bool) -> None:
    """Add a legend, beside the curves where there is space, or a colour bar for many curves."""
    title = f"{family.name} {unit_of(family)}".rstrip()
    if count <= MOST_IN_LEGEND:
        corner = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)} if beside else {"loc": "best"}
        ax.legend(title=title, frameon=False, **corner)
        return
    with IMPORTS:
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import ListedColormap, Normalize

    values = np.arange(count) if family.dtype.kind == "U" else shown(family)
    scale = Normalize(float(values.min()), float(values.max()))
    ax.figure.colorbar(ScalarMappable(scale, ListedColormap(colours(256))), ax=ax, label=title)
