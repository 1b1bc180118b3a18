"""The mechanism to scale: crank, rod and slider at a crank angle."""

from dataclasses import dataclass
from math import cos, degrees, isfinite, pi, sin
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.evaluate import evaluate
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS
from ..mechanism.read import read
from ..runtime.request import check_common, with_known_inputs
from ..support.extras import needed
from ..support.forks import IMPORTS
from ..units.system import Conversion
from .picture import Picture
from .shared import BLUE, ORANGE, finish

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

HEIGHT = 6.0  # inches
BLOCK = (0.16, 0.22)  # half width and height of the slider, in cranks
ROOM = 0.2  # rad: of half an angle whose name has space beside the crank
ANGLES = np.linspace(0.0, 2.0 * pi, 361)


@dataclass(frozen=True)
class Sketch:
    """A drawn mechanism, which `turn` moves: `links` (crank and rod), `slider`, `pins`, `arc`, `note`."""

    axes: "Axes"
    links: tuple[Any, Any]
    slider: Any
    pins: Any
    arc: Any
    names: tuple[Any, ...]
    note: Any
    lengths: dict[str, Any]
    branch: int

    @property
    def artists(self) -> "list[Artist]":
        """The moving artists."""
        return [*self.links, self.slider, self.pins, self.arc, *self.names, self.note]

    def turn(self, theta: Any) -> "list[Artist]":
        """Move to a crank angle; without rod and slider where the mechanism cannot be assembled."""
        angle = float(_number("theta", theta))
        ec, AB = self.lengths["ec"], self.lengths["AB"]
        Y = float(evaluate("Y", theta=angle, branch=self.branch, **self.lengths))
        pin, block = (AB * sin(angle), AB * cos(angle)), (-ec, Y)
        points = np.array([(0.0, 0.0), pin, block])
        for link, (first, last) in zip(self.links, ((0, 1), (1, 2)), strict=True):
            link.set_data(points[[first, last], 0], points[[first, last], 1])
        self.pins.set_data(points[:, 0], points[:, 1])
        self.slider.set_xy((-ec - BLOCK[0] * AB, Y - BLOCK[1] * AB))
        self.slider.set_visible(isfinite(Y))
        left = -1.0 if sin(angle) >= 0.0 else 1.0  # where the crank does not point to
        edge = -ec + (BLOCK[0] * AB if pin[0] < -ec else -BLOCK[0] * AB), Y  # of the guide, away from the rod
        half = 0.5 * (angle % (2.0 * pi))
        middle = (0.35 * AB * sin(half), 0.35 * AB * cos(half))  # of the angle's arc
        anchors = (points[0], pin, edge, 0.5 * (points[0] + points[1]), 0.5 * (points[1] + points[2]), middle)
        beside: Any = (
            (12.0 * left, 3.0),
            (-12.0 * left, 0.0),
            (9.0 if pin[0] < -ec else -9.0, 0.0),
            *(_beside(*ends) for ends in (points[:2], points[1:])),
            (20.0 * sin(half), 9.0 * cos(half)),
        )  # points
        for text, place, offset in zip(self.names, anchors, beside, strict=True):
            text.xy = tuple(place)
            text.set_position(tuple(offset))
            text.set_visible(isfinite(place[1]))
        self.names[-1].set_visible(half > ROOM)
        part = np.linspace(0.0, angle % (2.0 * pi), 50)
        self.arc.set_data(0.35 * AB * np.sin(part), 0.35 * AB * np.cos(part))
        stuck = "" if isfinite(Y) else ", cannot be assembled"
        self.note.set_text(f"theta = {degrees(angle):.4g} deg{stuck}")
        return self.artists


@with_known_inputs
def mechanism(*, theta: Any, ec: Any, AB: Any, BC: Any, branch: int = 1, ax: "Axes | None" = None) -> Picture:
    """Draw the mechanism to scale at a crank angle; a Picture, which `turn(theta)` moves.

    theta       crank angle [rad], or a text such as "60 deg"
    ec, AB, BC  lengths [m], or texts such as "125 mm"
    branch      +1 or -1
    ax          where to draw: a matplotlib Axes; by default a new Figure

    X to the right, Y up, along the slider's axis, as in the frame of README. The dotted circle is the
    crank pin's, the guide is as long as the stroke. Where it cannot be assembled there is only the crank.
    """
    with needed("plot.mechanism"):
        from matplotlib.figure import Figure
    check_common({}, branch)
    lengths: dict[str, Any] = {n: float(_number(n, v)) for n, v in zip(LENGTHS, (ec, AB, BC), strict=True)}
    reach = np.array([evaluate("Y", theta=angle, branch=branch, **lengths) for angle in ANGLES[::3]])
    box = _box(lengths, reach)
    if ax is None:
        wide = (box[1] - box[0]) / (box[3] - box[2])
        size = (max(3.2, 1.2 + HEIGHT * wide), HEIGHT)
        ax = Figure(figsize=size, layout="constrained").add_subplot()
    _frame(ax, lengths, reach, box)
    links, slider, pins, arc, names, note = _moving(ax, lengths["AB"])
    sketch = Sketch(ax, links, slider, pins, arc, names, note, lengths, int(branch))
    return Picture(ax, sketch.turn(theta), sketch)


def _beside(first: Any, last: Any) -> tuple[float, float]:
    """The offset of the name of a link from its middle, in points, to the side away from the axis."""
    across, up = last - first
    length = float(np.hypot(across, up)) or 1.0
    side = 13.0 if up > 0.0 else -13.0
    return (side * up / length, -side * across / length)


def _number(name: str, value: Any) -> float:
    return read(INPUTS[name], value, "plot.mechanism", "a number: a sketch shows one design at one angle")


def _box(lengths: dict[str, float], reach: Any) -> tuple[float, float, float, float]:
    """The limits of the axes: crank circle and slider at all angles."""
    ec, AB = lengths["ec"], lengths["AB"]
    room = 0.45 * AB
    ends = [-AB, AB, *(reach[np.isfinite(reach)])]
    return min(-AB, -ec) - room, max(AB, -ec) + room, min(ends) - room, max(ends) + room


def _frame(ax: "Axes", lengths: dict[str, float], reach: Any, box: tuple[float, ...]) -> None:
    """Draw the fixed parts: the crank's circle, its bearing, the guide, the eccentricity, the axes."""
    with IMPORTS:
        from matplotlib.patches import Polygon

    ec, AB = lengths["ec"], lengths["AB"]
    ax.plot(AB * np.sin(ANGLES), AB * np.cos(ANGLES), ":", color="0.6", linewidth=1.0)
    foot = np.array([(0.0, 0.0), (-0.14, -0.2), (0.14, -0.2)]) * AB
    ax.add_patch(Polygon(foot, facecolor="0.8", edgecolor="0.3", hatch="///", zorder=1))
    ax.axvline(0.0, color="0.8", linewidth=0.8, linestyle="-.", zorder=0)
    if np.isfinite(reach).any():
        low, high = np.nanmin(reach) - BLOCK[1] * AB, np.nanmax(reach) + BLOCK[1] * AB
        for side in (-1.0, 1.0):
            ax.plot([-ec + side * BLOCK[0] * AB] * 2, [low, high], color="0.3", linewidth=1.5, zorder=1)
        ax.plot([-ec, -ec], [low, high], "-.", color="0.8", linewidth=0.8, zorder=0)
    if ec:
        at = box[2] + 0.12 * AB
        ends = {"arrowstyle": "<->", "color": "0.3", "shrinkA": 0, "shrinkB": 0}
        ax.plot([-ec, -ec], [at, 0.0], color="0.8", linewidth=0.8, linestyle="-.", zorder=0)
        ax.annotate("", (0.0, at), (-ec, at), arrowprops=ends)
        ax.annotate(f"ec = {ec:.4g} m", (max(0.0, -ec), at), (5, 0), textcoords="offset points", va="center")
    ax.set(xlim=box[:2], ylim=box[2:], xlabel="X [m]", ylabel="Y, along the slider's axis [m]")
    ax.set_aspect("equal")
    finish(ax, grid="")


def _moving(ax: "Axes", AB: float) -> tuple[Any, ...]:
    """Crank and rod, slider, pins, the angle's arc, the names of the joints, the note."""
    with IMPORTS:
        from matplotlib.patches import Rectangle

    thick: dict[str, Any] = {"linewidth": 5.0, "solid_capstyle": "round"}
    links = tuple(ax.plot([], [], color=colour, zorder=3, **thick)[0] for colour in (ORANGE, BLUE))
    slider = Rectangle(
        (0, 0), 2 * BLOCK[0] * AB, 2 * BLOCK[1] * AB, facecolor="0.85", edgecolor="0.2", zorder=2
    )
    ax.add_patch(slider)
    (pins,) = ax.plot([], [], "o", color="w", markeredgecolor="0.1", markersize=7, zorder=4)
    (arc,) = ax.plot([], [], color="0.2", linewidth=1.0, zorder=5)
    centred: dict[str, Any] = {"ha": "center", "va": "center"}
    names = tuple(
        ax.annotate(name, (0, 0), (0, 0), textcoords="offset points", zorder=5, **style)
        for name, style in [*((n, {**centred, "fontweight": "bold"}) for n in "ABC"),
                            *((n, centred) for n in ("AB", "BC", "theta"))]
    )  # fmt: skip
    note = ax.set_title("", loc="left", fontsize="medium")
    return links, slider, pins, arc, names, note


def label_lengths(ax: Any, length: Conversion) -> None:
    """Show the axes of a sketch, and the lengths written in it, in another unit than metres."""
    if length.si == 1:
        return
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(lambda value, _: f"{length.shown(value):g}")
        axis.set_label_text(axis.get_label_text().replace("[m]", f"[{length.unit}]"))
    for text in ax.texts:
        written = text.get_text()
        if written.startswith("ec = ") and written.endswith(" m"):
            text.set_text(f"ec = {length.shown(float(written[5:-2])):.4g} {length.unit}")
