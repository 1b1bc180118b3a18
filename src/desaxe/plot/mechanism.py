"""The mechanism to scale at a crank angle; and as it turns, beside a quantity's curve."""

from collections.abc import Mapping
from math import cos, degrees, isfinite, pi, sin
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.evaluate import evaluate
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import read
from ..runtime.request import check_common, with_known_inputs
from ..support.extras import needed
from ..support.forks import IMPORTS
from ..units.system import Conversion
from .curves import curves
from .dataset import choose, input_in_si
from .picture import Picture
from .style import BLUE, ORANGE, axes_of, figure_type, finish, head, shown

if TYPE_CHECKING:
    import xarray as xr

HEIGHT, TALL, WIDE = 6.0, 4.6, 5.0  # inches: of a sketch, of an animation; the width of its curve
BLOCK = (0.16, 0.22)  # half width and height of the slider, in cranks
CLEAR = 0.2  # rad: of half an angle whose name has space beside the crank
ANGLES = np.linspace(0.0, 2.0 * pi, 361)
NAMES = ("A", "B", "C", "AB", "BC", "theta")
DASHED: dict[str, Any] = {"color": "0.8", "linewidth": 0.8, "linestyle": "-.", "zorder": 0}


class Sketch:
    """A drawn mechanism, which `turn` moves: `links` (crank and rod), `slider`, `pins`, `arc`, `note`."""

    def __init__(self, lengths: Mapping[str, float], branch: int, length: Conversion, ax: Any) -> None:
        """Draw it; lengths in metres, along axes in the unit of `length`."""
        self.lengths: dict[str, Any] = dict(lengths)
        self.branch, self.length = branch, length
        self.ec, self.AB = (float(length.shown(lengths[name])) for name in ("ec", "AB"))
        reach = np.array([self._position(angle) for angle in ANGLES[::3]])
        margin, ends = 0.45 * self.AB, [-self.AB, self.AB, *reach[np.isfinite(reach)]]
        left, right = min(-self.AB, -self.ec) - margin, max(self.AB, -self.ec) + margin
        bottom, top = min(ends) - margin, max(ends) + margin
        wide = max(3.2, 1.2 + HEIGHT * (right - left) / (top - bottom))
        self.axes = axes_of("mechanism", ax, (wide, HEIGHT))
        self.axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal", xlabel=f"X [{length.unit}]",
                      ylabel=f"Y, along the slider's axis [{length.unit}]")  # fmt: skip
        finish(self.axes, grid="")
        self._draw_frame(reach, bottom)
        self._draw_links()

    @property
    def artists(self) -> list[Any]:
        """The moving artists."""
        return [*self.links, self.slider, self.pins, self.arc, *self.names, self.note]

    def turn(self, theta: Any) -> list[Any]:
        """Move to a crank angle; without rod and slider where the mechanism cannot be assembled."""
        angle, ec, AB = _number("theta", theta), self.ec, self.AB
        Y, half = self._position(angle), 0.5 * (angle % (2.0 * pi))
        points = np.array([(0.0, 0.0), (AB * sin(angle), AB * cos(angle)), (-ec, Y)])
        for link, ends in zip(self.links, (points[:2], points[1:]), strict=True):
            link.set_data(*ends.T)
        self.pins.set_data(*points.T)
        self.slider.set_xy((-ec - BLOCK[0] * AB, Y - BLOCK[1] * AB))
        self.slider.set_visible(isfinite(Y))
        part = np.linspace(0.0, 2.0 * half, 50)
        self.arc.set_data(0.35 * AB * np.sin(part), 0.35 * AB * np.cos(part))
        self._place_names(points, half)
        stuck = "" if isfinite(Y) else ", cannot be assembled"
        self.note.set_text(f"theta = {degrees(angle):.4g} deg{stuck}")
        return self.artists

    def _position(self, theta: float) -> float:
        """Y at a crank angle, in the unit shown."""
        return float(self.length.shown(evaluate("Y", theta=theta, branch=self.branch, **self.lengths)))

    def _place_names(self, points: Any, half: float) -> None:
        """Put each name beside its joint, link or angle, to the side that is free; `half` of the angle."""
        pin = points[1]
        away = -1.0 if sin(2.0 * half) >= 0.0 else 1.0  # where the crank does not point to
        across = 1.0 if pin[0] < -self.ec else -1.0  # of the guide, away from the rod
        arc = 0.35 * self.AB * np.array([sin(half), cos(half)])
        edge = points[2] + (across * BLOCK[0] * self.AB, 0.0)
        anchors = points[0], pin, edge, 0.5 * (points[0] + pin), 0.5 * (pin + points[2]), arc
        offsets = (
            (12.0 * away, 3.0), (-12.0 * away, 0.0), (9.0 * across, 0.0), _beside(*points[:2]),
            _beside(*points[1:]), (20.0 * sin(half), 9.0 * cos(half)),
        )  # points  # fmt: skip
        for text, anchor, offset in zip(self.names, anchors, offsets, strict=True):
            text.xy = tuple(anchor)
            text.set_position(offset)
            text.set_visible(isfinite(anchor[1]))
        self.names[-1].set_visible(half > CLEAR)

    def _draw_frame(self, reach: Any, bottom: float) -> None:
        """Draw the fixed parts: the crank's circle, its bearing, the guide, the eccentricity."""
        with IMPORTS:
            from matplotlib.patches import Polygon

        ax, ec, AB = self.axes, self.ec, self.AB
        ax.plot(AB * np.sin(ANGLES), AB * np.cos(ANGLES), ":", color="0.6", linewidth=1.0)
        foot = np.array([(0.0, 0.0), (-0.14, -0.2), (0.14, -0.2)]) * AB
        ax.add_patch(Polygon(foot, facecolor="0.8", edgecolor="0.3", hatch="///", zorder=1))
        ax.axvline(0.0, **DASHED)
        if np.isfinite(reach).any():
            low, high = np.nanmin(reach) - BLOCK[1] * AB, np.nanmax(reach) + BLOCK[1] * AB
            for side in (-ec - BLOCK[0] * AB, -ec + BLOCK[0] * AB):
                ax.plot([side, side], [low, high], color="0.3", linewidth=1.5, zorder=1)
            ax.plot([-ec, -ec], [low, high], **DASHED)
        if ec:
            at = bottom + 0.12 * AB
            ends = {"arrowstyle": "<->", "color": "0.3", "shrinkA": 0, "shrinkB": 0}
            ax.plot([-ec, -ec], [at, 0.0], **DASHED)
            ax.annotate("", (0.0, at), (-ec, at), arrowprops=ends)
            ax.annotate(f"ec = {ec:.4g} {self.length.unit}", (max(0.0, -ec), at), (5, 0),
                        textcoords="offset points", va="center")  # fmt: skip

    def _draw_links(self) -> None:
        """Draw the moving parts, at no angle yet."""
        with IMPORTS:
            from matplotlib.patches import Rectangle

        ax, (width, height) = self.axes, (2 * side * self.AB for side in BLOCK)
        thick: dict[str, Any] = {"linewidth": 5.0, "solid_capstyle": "round"}
        self.links = tuple(ax.plot([], [], color=colour, zorder=3, **thick)[0] for colour in (ORANGE, BLUE))
        self.slider = ax.add_patch(
            Rectangle((0, 0), width, height, facecolor="0.85", edgecolor="0.2", zorder=2)
        )
        (self.pins,) = ax.plot([], [], "o", color="w", markeredgecolor="0.1", markersize=7, zorder=4)
        (self.arc,) = ax.plot([], [], color="0.2", linewidth=1.0, zorder=5)
        self.names = tuple(
            ax.annotate(name, (0, 0), (0, 0), textcoords="offset points", zorder=5, ha="center", va="center",
                        fontweight="bold" if len(name) == 1 else "normal")
            for name in NAMES
        )  # fmt: skip
        self.note = head(ax, "")


def _beside(first: Any, last: Any) -> tuple[float, float]:
    """The offset of the name of a link from its middle, in points, to the side away from the axis."""
    across, up = last - first
    length = float(np.hypot(across, up)) or 1.0
    side = 13.0 if up > 0.0 else -13.0
    return (side * up / length, -side * across / length)


def _number(name: str, value: Any) -> float:
    return float(
        read(INPUTS[name], value, "plot.mechanism", "a number: a sketch shows one design at one angle")
    )


@with_known_inputs
def mechanism(*, theta: Any, ec: Any, AB: Any, BC: Any, branch: int = 1, ax: Any = None) -> Picture:
    """Draw the mechanism to scale at a crank angle; a Picture, which `turn(theta)` moves.

    theta       crank angle [rad], or a text such as "60 deg"
    ec, AB, BC  lengths [m], or texts such as "125 mm"
    branch      +1 or -1
    ax          where to draw: a matplotlib Axes; by default a new Figure

    X to the right, Y up, along the slider's axis, as in the frame of README. The dotted circle is the
    crank pin's, the guide is as long as the stroke. Where it cannot be assembled there is only the crank.
    """
    return sketched(theta, {"ec": ec, "AB": AB, "BC": BC}, branch, SI, ax)


def sketched(
    theta: Any, inputs: Mapping[str, Any], branch: int, units: UnitSystem, ax: Any = None
) -> Picture:
    """The picture of `mechanism`, with axes in these units."""
    figure_type("mechanism")
    check_common({}, branch)
    lengths = {name: _number(name, inputs[name]) for name in LENGTHS}
    sketch = Sketch(lengths, int(branch), units.of("ec"), ax)
    return Picture(sketch.axes, sketch.turn(theta), sketch)


# ---- animations ----------------------------------------------------------------------------------


def animate(
    dataset: "xr.Dataset", name: str | None = None, *, frames: int = 60, seconds: float = 3.0, ax: Any = None
) -> Picture:
    """The mechanism of a dataset as it turns, and where it is on a quantity's curve; a Picture, animated.

    dataset  the result of `desaxe.grid` over theta alone, with ec, AB and BC
    name     the quantity whose curve is drawn beside it; without one there is only the mechanism
    frames   how many pictures, evenly among the angles of the dataset, for a turn of so many `seconds`
    ax       where to draw: an Axes for the mechanism, and a second one in a pair for the curve; by default
             those of a new Figure

    `picture.save("press.gif")` or `"press.html"` writes it; in a notebook show
    `IPython.display.HTML(picture.to_jshtml())`. Raises ValueError where the dataset lacks what is needed.
    """
    with needed("plot.animate"):
        from matplotlib.animation import FuncAnimation
    design = _design(dataset, str(next(iter(dataset), "")) if name is None else name)
    left, right = _axes(design, name is not None, ax)
    theta = input_in_si(dataset["theta"])
    units = UnitSystem.read({"ec": dataset["ec"].attrs.get("units", "m")})
    sketch = sketched(theta[0], design, int(dataset.attrs.get("branch", 1)), units, left)
    moving: Any = None
    if name is not None:
        curves(dataset, name, ax=right)
        (moving,) = right.plot([], [], "o", color=ORANGE, markersize=8, zorder=5)
        across, up = shown(dataset["theta"]), np.asarray(dataset[name].values, dtype=np.float64)

    def at(index: int) -> list[Any]:
        artists: list[Any] = sketch.turn(theta[index])
        if moving is None:
            return artists
        moving.set_data(across[index : index + 1], up[index : index + 1])
        return [*artists, moving]

    whole = theta.size > 1 and abs(theta[-1] - theta[0] - 2.0 * np.pi) < 1e-9  # its last angle is its first
    indices = np.linspace(0, theta.size - 1, min(frames, theta.size) + whole).round().astype(int).tolist()
    every = indices[:-1] if whole and len(indices) > 1 else indices
    movie = FuncAnimation(left.figure, at, every, interval=1000.0 * seconds / len(every))
    return Picture([left, right] if moving is not None else left, at(0), movie)


def _design(dataset: "xr.Dataset", name: str) -> dict[str, float]:
    """The lengths of a dataset over the crank angle alone."""
    choose(dataset, name, ["theta"])
    missing = [n for n in LENGTHS if n not in dataset.coords]
    if missing:
        raise ValueError(f"animate: the dataset has no {missing[0]}")
    return {n: float(input_in_si(dataset[n])) for n in LENGTHS}


def _axes(design: dict[str, float], both: bool, ax: Any) -> tuple[Any, Any]:
    """The axes of the mechanism, and those of the curve or None."""
    if ax is None:
        narrow = 2.0 * (design["AB"] + abs(design["ec"])) / (2.0 * design["AB"] + design["BC"])
        width = max(2.6, 1.2 + TALL * min(narrow, 1.0))
        widths = [width, WIDE] if both else [width]
        figure = figure_type("animate")(figsize=(sum(widths), TALL), layout="constrained")
        ax = figure.subplots(1, len(widths), width_ratios=widths, squeeze=False)[0]
    left, *rest = np.atleast_1d(ax)
    if both and not rest:
        raise ValueError("ax: expected two Axes, for the mechanism and for the curve")
    return left, rest[0] if rest else None
