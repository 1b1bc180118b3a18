"""The motion that a torque causes: its histories over time, one above the other, and its events."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.quantity_units import SI
from ..support.extras import needed
from .from_motion import dataset_of_motion, is_motion
from .panels import panels
from .picture import Picture
from .shared import ORANGE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEAST, FINE, MOST = 24, 60, 30_000  # instants: of a turn that a line shows, of one that is redrawn, of all
STEP = 2e-4  # of a turn: the step of the difference that is the acceleration
MARKED = 40  # events of a kind; of more the legend has the number
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
    if np.size(result["t"]) < LEAST * _turns(result):
        _redraw(picture, result)
    if result.get("events"):
        _mark(picture.axes[0], result["events"])
    return picture


def _turns(result: Mapping[str, Any]) -> float:
    """The turns that a motion would make at its largest speed."""
    system = getattr(result, "system", None) or SI
    fastest = float(np.nanmax(np.abs(result["omega"]), initial=0.0)) * float(system.of("omega").si)
    return fastest * float(result["t"][-1]) * float(system.of("t").si) / (2.0 * np.pi)


def _redraw(picture: Picture, result: Mapping[str, Any]) -> None:
    """Draw the motion at many instants, and other histories as points: a line between few is no curve."""
    t = np.linspace(0.0, float(result["t"][-1]), min(MOST, int(FINE * _turns(result))))
    own = _dense(result, t) if "solution" in result else {}
    for axis, (name, lines) in zip(picture.axes, picture.artists.items(), strict=True):
        for line in lines:
            if name in own:
                line.set_data(t, own[name])
            else:
                line.set(linestyle="none", marker=".", markersize=3.0)
        axis.relim()
        axis.autoscale_view()


def _dense(result: Mapping[str, Any], t: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Angle, speed and acceleration at instants from the first to the last, in the units of the result."""
    system, solution = getattr(result, "system", None) or SI, result["solution"]
    step = STEP * t[-1] / max(1.0, _turns(result))
    sides = np.clip(t - step, 0.0, t[-1]), np.clip(t + step, 0.0, t[-1])
    before, after = (solution(side)["omega"] for side in sides)
    omega, time, alpha = (float(system.of(name).si) for name in ("omega", "t", "alpha"))
    slope = (after - before) / (sides[1] - sides[0]) * (omega / time / alpha)
    slope[[0, -1]] = result["alpha"][[0, -1]]
    return {**solution(t), "alpha": slope}


def _mark(ax: "Axes", events: list[Any]) -> None:
    """Mark the events on the curve of the crank angle, each kind by its own sign, unless there are many."""
    for kind in dict.fromkeys(event.kind for event in events):
        own = [event for event in events if event.kind == kind]
        many = len(own) > MARKED
        label = f"{kind}: {len(own)}, not marked" if many else kind
        style: dict[str, Any] = {
            "color": ORANGE,
            "markerfacecolor": "none" if kind == "standstill" else ORANGE,
            "zorder": 4,
        }
        drawn = [] if many else own
        ax.plot([e.t for e in drawn], [e.theta for e in drawn], MARKS.get(kind, "X"), label=label, **style)
    ax.legend(frameon=False, fontsize="small", loc="best")
