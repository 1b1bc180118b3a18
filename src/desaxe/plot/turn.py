"""A machine over a turn or cycle: the torque of its drive, or its steady state on a motor."""

from math import degrees, isfinite
from typing import Any

import numpy as np

from ..mechanism.quantity_units import SI
from ..support.shown import printed
from .picture import Picture
from .style import BLUE, ORANGE, angle_ticks, figure_type, filled, finish, head, raised, rpm_for

WIDTH, PANEL = 8.0, 2.6  # inches: the height of a panel


def drive(result: Any, *, ax: Any = None) -> Picture:
    """Draw the drive torque over a turn with its mean and peak, and the speed with the flywheel.

    result  of `desaxe.drive`
    ax      where to draw the torque alone: a matplotlib Axes; by default a new Figure with the torque above
            and the speed below

    Returns a Picture of the lines by name: T_in, mean, peak, and speed where there is a flywheel. Raises
    ValueError for a result without a cycle, whose `status` says why.
    """
    course = result.course
    flywheel = "speed" in course and isfinite(result["flywheel_inertia"])
    axes = _panels("drive", ax, 2 if flywheel else 1)
    if "T_in" not in course:
        raise ValueError(f"this drive has no torque to draw, status {result['status']}")
    scale = {"rad": degrees(1.0), "deg": 1.0}.get(result.unit("theta")) or 360.0 / result.whole_turn
    theta = course["theta"] * scale
    lines = _torque(axes[0], result, theta, scale)
    if len(axes) > 1:
        unit, factor = rpm_for(result.unit("speed"))
        speed = course["theta_of_speed"] * scale, factor * course["speed"]
        (lines["speed"],) = axes[1].plot(*speed, color=BLUE, linewidth=1.6)
        axes[1].set_ylabel(f"speed of the crank [{unit}]")
        inertia = f"{result['flywheel_inertia']:.4g} {raised(result.unit('flywheel_inertia'))[1:-1]}"
        fluctuation = f"fluctuation {100 * result['fluctuation']:.3g} %"
        head(axes[1], f"with a flywheel of {inertia} under a constant torque, {fluctuation}")
    for panel in axes:
        panel.margins(y=0.15)
        _over_turn(panel, theta)
    axes[-1].set_xlabel("crank angle, theta [deg]")
    return Picture(axes if len(axes) > 1 else axes[0], lines)


def _torque(ax: Any, result: Any, theta: Any, scale: float) -> dict[str, Any]:
    torque = result.course["T_in"]
    (curve,) = ax.plot(theta, torque, color=BLUE, linewidth=1.6, label="T_in")
    mean = ax.axhline(result["torque_mean"], color=ORANGE, linewidth=1.2, label="mean")
    ax.fill_between(theta, torque, result["torque_mean"], color=BLUE, alpha=0.12, linewidth=0.0)
    at, top = result["theta_peak"] * scale, max((torque.max(), torque.min()), key=abs)
    (peak,) = ax.plot([at], [top], "o", color=BLUE, markersize=5, label="peak")
    left = 2.0 * at > theta.min() + theta.max()
    ax.annotate(f"{result['torque_peak']:.4g} {result.unit('torque_peak')} at {at:.1f} deg", (at, top),
                (-8 if left else 8, 5), textcoords="offset points", va="center",
                ha="right" if left else "left", fontsize="small")  # fmt: skip
    ax.set_ylabel(f"torque of the drive, T_in [{result.unit('T_in')}]")
    design = filled([raised(one)[1:-1] for one in result.design()])
    figures = (("mean", "torque_mean"), ("rms", "torque_rms"), ("mean power", "power_mean"))
    words = (f"{label} {result[name]:.4g} {result.unit(name)}" for label, name in figures)
    head(ax, f"{design}\n{', '.join(words)}")
    return {"T_in": curve, "mean": mean, "peak": peak}


def steady(result: Any, *, ax: Any = None) -> Picture:
    """Draw speed and torque over a period, and the motor's curve with the loop that the machine works on.

    result  of `desaxe.steady`, of one design
    ax      where to draw the motor's curve with the loop alone: a matplotlib Axes; by default a new Figure
            with all three

    Returns a Picture of the lines by name: omega, T_motor, loop, and motor where its torque depends on the
    speed alone. Raises ValueError for a result without a steady state, whose `message` says why.
    """
    if getattr(result["period"], "shape", ()):
        raise ValueError("plot.steady draws one design, not an array of them")
    if not isfinite(result["period"]):
        raise ValueError(f"this machine has no steady state to draw: {result['message']}")
    axes = _panels("steady", ax, 3)
    units = result.system or SI
    unit, factor = rpm_for(units.of("omega").unit)
    labels = f"crank speed [{unit}]", f"motor torque [{printed(units.of('T_motor').unit)}]"
    values = factor * result["omega"], result["T_motor"]
    theta = [degrees(units.of("theta").to_si(angle)) for angle in result["theta"].tolist()]
    lines: dict[str, Any] = {}
    for panel, name, label, column in zip(axes[:-1], ("omega", "T_motor"), labels, values, strict=False):
        (lines[name],) = panel.plot(theta, column, color=BLUE, linewidth=1.6)
        panel.set_ylabel(label)
        _over_turn(panel, theta)
    if len(axes) > 1:
        axes[0].sharex(axes[1])
        axes[1].set_xlabel("crank angle, theta [deg]")
        power = f"{result['power_mean']:.4g} {units.of('power_mean').unit}"
        fluctuation = f"fluctuation {100 * result['fluctuation']:.3g} %"
        head(axes[0], f"mean speed {factor * result['omega_mean']:.5g} {unit}, {fluctuation}, {power}")
    ax, curve = axes[-1], result.motor_curve()
    if curve is not None:
        motor = factor * units.of("omega").shown(curve[0]), units.of("T_motor").shown(curve[1])
        (lines["motor"],) = ax.plot(*motor, color="0.6", linewidth=1.2, label="motor")
    (lines["loop"],) = ax.plot(*values, color=ORANGE, linewidth=2.4, label="over a period")
    ax.set(xlabel=labels[0], ylabel=labels[1])
    ax.legend(frameon=False, fontsize="small")
    finish(ax)
    return Picture(axes if len(axes) > 1 else ax, lines)


def _panels(name: str, ax: Any, count: int) -> list[Any]:
    """The axes that are passed alone, or those of a new figure, one above the other."""
    figure = figure_type(name)
    if ax is not None:
        return [ax]
    new = figure(figsize=(WIDTH, 0.4 + PANEL * max(count, 2)), layout="constrained")
    return list(new.subplots(count, squeeze=False)[:, 0])


def _over_turn(ax: Any, theta: Any) -> None:
    """Finish axes along the crank angle in degrees."""
    ax.set_xlim(*np.round((min(theta), max(theta)), 6))
    angle_ticks(ax.xaxis)
    finish(ax)
