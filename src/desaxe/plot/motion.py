"""The motion that a torque causes: its histories over time, one above the other, and its events."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..support.extras import needed
from .from_motion import dataset_of_motion, is_motion
from .panels import panels
from .picture import Picture
from .shared import ORANGE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARKS = {"dead centre": "|", "standstill": "o", "angle": "D", "break-away": "^"}  # others end the motion: X


def motion(result: Mapping[str, Any], *, ax: Any = None) -> Picture:
    """Draw the histories of a motion over time, one above the other, with its events on the crank angle.

    result  of `desaxe.simulate`, of one design or of many, each of which has its curve then
    ax      where to draw: a matplotlib Axes for each history, in a list; by default those of a new Figure

    Returns a Picture of the lines by name: theta, omega, alpha, the quantities asked for and sensitivities.
    """
    with needed("plot.motion"):
        dataset = dataset_of_motion(result, "t") if is_motion(result) else None
    if dataset is None:
        raise TypeError("plot.motion draws a result of desaxe.simulate")
    picture = panels(dataset, list(map(str, dataset.data_vars)), over="t", ax=ax)
    first = picture.axes[0]
    if result.get("events"):
        _mark(first, result["events"])
    return picture


def _mark(ax: "Axes", events: list[Any]) -> None:
    """Mark the events on the curve of the crank angle, each kind by its own sign."""
    kinds = dict.fromkeys(event.kind for event in events)
    for kind in kinds:
        own = [event for event in events if event.kind == kind]
        ax.plot(
            [event.t for event in own], [event.theta for event in own], MARKS.get(kind, "X"),
            color=ORANGE, markerfacecolor="none" if kind == "standstill" else ORANGE, label=kind, zorder=4,
        )  # fmt: skip
    ax.legend(frameon=False, fontsize="small", loc="best")
