"""Drive diagrams: torque and power over a turn, and the speed that a flywheel leaves."""

import textwrap
from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

from ..support.extras import needed
from .picture import Picture
from .shared import BLUE, ORANGE, finish, raised, rpm_for, turn_axis
from .titles import WIDTH as TITLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

SIZE = (8.0, 5.6)  # inches


def drive(result: Any, *, ax: "Axes | None" = None) -> Picture:
    """Draw the drive torque over a turn with its mean and peak, and the speed with the flywheel.

    result  of `desaxe.drive`
    ax      where to draw the torque alone: a matplotlib Axes; by default a new Figure with the torque above
            and the speed below

    Returns a Picture of the lines by name: T_in, mean, peak, and speed where there is a flywheel. Raises
    ValueError for a result without a cycle, whose `status` says why.
    """
    with needed("plot.drive"):
        from matplotlib.figure import Figure
    course = result.course
    if "T_in" not in course:
        raise ValueError(f"this drive has no torque to draw, status {result['status']}")
    turns = "speed" in course and isfinite(result["flywheel_inertia"])
    if ax is None:
        figure = Figure(figsize=SIZE, layout="constrained")
        axes = list(figure.subplots(2 if turns else 1, sharex=True, squeeze=False)[:, 0])
    else:
        axes = [ax]
    lines = _torque(axes[0], result)
    if turns and len(axes) > 1:
        lines["speed"] = _speed(axes[1], result)
    for one in axes:
        theta = _degrees(result, "theta")
        turn_axis(one, theta.min(), theta.max())
        one.margins(y=0.15)
        finish(one)
    axes[-1].set_xlabel("crank angle, theta [deg]")
    return Picture(axes if len(axes) > 1 else axes[0], lines)


def _torque(ax: "Axes", result: Any) -> "dict[str, Line2D]":
    theta, torque = _degrees(result, "theta"), result.course["T_in"]
    (curve,) = ax.plot(theta, torque, color=BLUE, linewidth=1.6, label="T_in")
    mean = ax.axhline(result["torque_mean"], color=ORANGE, linewidth=1.2, label="mean")
    ax.fill_between(theta, torque, result["torque_mean"], color=BLUE, alpha=0.12, linewidth=0.0)
    place = result["theta_peak"] * _scale(result)
    top = max((torque.max(), torque.min()), key=abs)
    (peak,) = ax.plot([place], [top], "o", color=BLUE, markersize=5, label="peak")
    told = f"{result['torque_peak']:.4g} {result.unit('torque_peak')} at {place:.1f} deg"
    left = 2.0 * place > theta.min() + theta.max()
    ax.annotate(told, (place, top), (-8 if left else 8, 5), textcoords="offset points", va="center",
                ha="right" if left else "left", fontsize="small")  # fmt: skip
    ax.set_ylabel(f"torque of the drive, T_in [{result.unit('T_in')}]")
    inputs = [raised(one)[1:-1] for one in result.design()]
    design = ", ".join(one.replace(" ", "\u00a0") if len(one) < TITLE // 2 else one for one in inputs)
    ax.set_title(
        f"{textwrap.fill(design, TITLE)}\n"
        f"mean {result['torque_mean']:.4g} {result.unit('torque_mean')}, rms {result['torque_rms']:.4g} "
        f"{result.unit('torque_rms')}, mean power {result['power_mean']:.4g} {result.unit('power_mean')}",
        loc="left", fontsize="medium",
    )  # fmt: skip
    return {"T_in": curve, "mean": mean, "peak": peak}


def _speed(ax: "Axes", result: Any) -> "Line2D":
    unit, factor = rpm_for(result.unit("speed"))
    (curve,) = ax.plot(
        _degrees(result, "theta_of_speed"), factor * result.course["speed"], color=BLUE, linewidth=1.6
    )
    ax.set_ylabel(f"speed of the crank [{unit}]")
    inertia = f"{result['flywheel_inertia']:.4g} {raised(result.unit('flywheel_inertia'))[1:-1]}"
    ax.set_title(
        f"with a flywheel of {inertia} under a constant torque, "
        f"fluctuation {100 * result['fluctuation']:.3g} %",
        loc="left", fontsize="medium",
    )  # fmt: skip
    return curve


def _scale(result: Any) -> float:
    """The factor from the angles of the result to degrees."""
    return {"rad": degrees(1.0), "deg": 1.0}.get(result.unit("theta")) or 360.0 / result.whole_turn


def _degrees(result: Any, name: str) -> Any:
    return result.course[name] * _scale(result)
