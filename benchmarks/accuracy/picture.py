"""The audit as a picture: worst error over time, a marker for every contender, the best ones joined."""

from typing import TYPE_CHECKING, Any, NamedTuple

from .contenders import NAMES
from .errors import TOP, ULPS
from .report import beaten_by, measures
from .run import Audit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (13.5, 5.8)  # inches
KINDS = {
    "desaxe": "desaxe",
    "textbook": "textbook formula in doubles",
    "digits": "textbook formula in 50 digits",
}
COLOURS = {"desaxe": "#0072B2", "textbook": "#C44E00", "digits": "#444444"}  # distinct for the colour-blind
MARKERS = {"desaxe": "o", "textbook": "D", "digits": "s"}
ORDER = {"digits": 3, "textbook": 3, "desaxe": 4}  # what is drawn over what
TITLE = (
    f"Worst error over time per point, for {', '.join(NAMES)}. Lower left is better; "
    "the grey line joins those that no other dominates."
)
LEAST, ABOVE = 1e-4, 1e3  # of the error axis: its lower end, and what is above its top
FONT = 9.0
MARGIN = 1.5  # points around a name

Box = tuple[float, float, float, float]  # left, low, right, high in points (1/72 inch)


class Panel(NamedTuple):
    """One panel of the picture: a measure of error, its title and axis label, the promised bounds."""

    measure: str
    title: str
    label: str
    promises: dict[str, float]
    top: float


EXCUSED = "worst error, as a multiple of what the inputs'\nlast digits excuse: 8 ulp x (1 + condition)"
STANDARD = {"standard": 1.0}
PANELS = (
    Panel("at generic points", "Generic points", EXCUSED, STANDARD, TOP / ULPS),
    Panel("in the hardest family", "Everyone's hardest family of points", EXCUSED, STANDARD, TOP / ULPS),
    Panel(
        "in plain ulp",
        "All points, with nothing excused",
        "worst error in units of the last bit (ulp)",
        {"extended": 2.0},
        TOP,
    ),
)


def draw(result: Audit) -> "Figure":
    """Three panels, one for each measure."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    figure.suptitle(TITLE, fontsize=12)
    for panel, ax in zip(PANELS, figure.subplots(1, len(PANELS)), strict=True):
        _scales(ax, result, panel)
    marks = [
        figure.axes[0].plot([], [], MARKERS[kind], color=COLOURS[kind], markersize=7, label=text)[0]
        for kind, text in KINDS.items()
        if any(one.kind == kind for one in result.who)
    ]
    figure.axes[0].legend(handles=marks, loc="upper right", bbox_to_anchor=(1.0, 0.78), frameon=False)
    figure.draw_without_rendering()  # now it is known how large the panels are
    for panel, ax in zip(PANELS, figure.axes, strict=True):
        _points(ax, result, panel)
    return figure


def _scales(ax: "Axes", result: Audit, panel: Panel) -> None:
    """Axes, promises and the top."""
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlim(min(result.ratios.values()) / 6, max(result.ratios.values()) * 4)
    ax.set_ylim(LEAST, ABOVE * panel.top)
    kept = next(iter(panel.promises.values()))
    ax.axhspan(LEAST, kept, color=COLOURS["desaxe"], alpha=0.10, linewidth=0)
    ax.axhspan(panel.top / 10, ABOVE * panel.top, color="0.5", alpha=0.15, linewidth=0)
    for promise in panel.promises.values():
        ax.axhline(promise, color=COLOURS["desaxe"], linewidth=1.0, linestyle=(0, (5, 3)))
    ax.set_title(panel.title, fontsize=11, loc="left")
    ax.set_xlabel("time per point, as a multiple of desaxe standard")
    ax.set_ylabel(panel.label)
    ax.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    ax.set_yticks([10.0**k for k in range(-4, 17, 2)])
    ax.minorticks_off()
    ax.grid(True, color="0.9", linewidth=0.8)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _points(ax: "Axes", result: Audit, panel: Panel) -> None:
    """Draw the markers, the line through the unbeaten contenders, and the names."""
    errors = {one.name: max(measures(result, one.name)[panel.measure], LEAST * 3) for one in result.who}
    unbeaten = [name for name in errors if not beaten_by(result, name, panel.measure)]
    front = sorted((result.ratios[name], errors[name]) for name in unbeaten)
    ax.plot(*zip(*front, strict=True), color="0.6", linewidth=1.2, drawstyle="steps-post", zorder=1)
    taken = [_around(ax, result.ratios[name], y) for name, y in errors.items()]
    words = {f"promise of {tier}": 1.9 * y for tier, y in panel.promises.items()}
    for text, y in {**words, "no digit right, or no number": 30 * panel.top}.items():
        taken.append(_remark(ax, y, text))
    for one in result.who:
        at = result.ratios[one.name], errors[one.name]
        ax.plot(*at, MARKERS[one.kind], color=COLOURS[one.kind], markersize=7, zorder=ORDER[one.kind])
        _name(ax, at, one.name.removeprefix("desaxe "), COLOURS[one.kind], taken)


def _points_of(ax: "Axes", extent: Any) -> Box:
    scale = 72 / ax.figure.dpi
    return extent.x0 * scale, extent.y0 * scale, extent.x1 * scale, extent.y1 * scale


def _remark(ax: "Axes", y: float, text: str) -> Box:
    """A small text at the right end; the box it takes."""
    across = ax.get_yaxis_transform()
    remark = ax.text(
        0.99, y, text, transform=across, ha="right", va="center", fontsize=FONT - 0.5, color="0.35"
    )
    return _points_of(ax, remark.get_window_extent())


def _around(ax: "Axes", x: float, y: float) -> Box:
    """The box of a marker."""
    across, up = ax.transData.transform((x, y)) * 72 / ax.figure.dpi
    return across - 5, up - 5, across + 5, up + 5


def _name(ax: "Axes", at: tuple[float, float], name: str, colour: str, taken: list[Box]) -> None:
    """Label a marker at the nearest free position, with a thin line to the marker if that is far."""
    from matplotlib.patheffects import withStroke

    left, low, right, high = _around(ax, *at)
    across, up = (left + right) / 2, (low + high) / 2
    text = ax.annotate(name, at, (0, 0), textcoords="offset points", va="center", fontsize=FONT, color=colour)
    text.set_path_effects([withStroke(linewidth=2.5, foreground="white", alpha=0.8)])
    text.set_zorder(5)
    size = _points_of(ax, text.get_window_extent())
    wide, tall = size[2] - size[0], size[3] - size[1]
    edges, places = _points_of(ax, ax.get_window_extent()), {}
    for rise in range(-120, 121, 3):
        for shift in (8.0, -8.0 - wide, -wide / 2, 18.0, -18.0 - wide):
            here = across + shift, up + rise - tall / 2, across + shift + wide, up + rise + tall / 2
            if _is_free(here, taken, edges):
                places[abs(rise) + 0.12 * abs(shift + wide / 2), shift, rise] = here
    if not places:  # no free place: on the right, where one looks first
        places[0.0, 8.0, 0] = size
    _, shift, rise = nearest = min(places)
    taken.append(places[nearest])
    text.set_position((shift, rise))
    if abs(rise) > 16:
        towards = shift if shift > 0 else shift + wide if shift + wide < 0 else shift + wide / 2
        edge = towards, rise - (tall / 2 if rise > 0 else -tall / 2)
        line = {"arrowstyle": "-", "color": colour, "linewidth": 0.7, "shrinkA": 0, "shrinkB": 3}
        ax.annotate("", at, edge, textcoords="offset points", arrowprops=line, zorder=2)


def _is_free(here: Box, taken: list[Box], edges: Box) -> bool:
    """True if a box lies inside the axes and touches no other."""
    inside = here[0] > edges[0] and here[1] > edges[1] and here[2] < edges[2] and here[3] < edges[3]
    low, high = (here[0] - MARGIN, here[1] - MARGIN), (here[2] + MARGIN, here[3] + MARGIN)
    apart = (high[0] <= t[0] or low[0] >= t[2] or high[1] <= t[1] or low[1] >= t[3] for t in taken)
    return inside and all(apart)
