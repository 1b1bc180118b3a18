"""The steady state of a machine on its motor: speed and torque over a period, and the working loop."""

from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

from ..mechanism.quantity_units import SI
from ..support.extras import needed
from ..support.shown import printed
from .picture import Picture
from .shared import BLUE, ORANGE, finish, rpm_for, turn_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = (8.0, 7.2)  # inches


def steady(result: Any, *, ax: "Axes | None" = None) -> Picture:
    """Draw speed and torque over a period, and the motor's curve with the loop that the machine works on.

    result  of `desaxe.steady`, of one design
    ax      where to draw the motor's curve with the loop alone: a matplotlib Axes; by default a new Figure
            with all three

    Returns a Picture of the lines by name: omega, T_motor, loop, and motor where its torque depends on the
    speed alone. Raises ValueError for a result without a steady state, whose `message` says why.
    """
    with needed("plot.steady"):
        from matplotlib.figure import Figure
    if getattr(result["period"], "shape", ()):
        raise ValueError("plot.steady draws one design, not an array of them")
    if not isfinite(result["period"]):
        raise ValueError(f"this machine has no steady state to draw: {result['message']}")
    units = result.system or SI
    unit, factor = rpm_for(units.of("omega").unit)
    labels = {
        "omega": f"crank speed [{unit}]",
        "T_motor": f"motor torque [{printed(units.of('T_motor').unit)}]",
    }
    values = {"omega": factor * result["omega"], "T_motor": result["T_motor"]}
    lines: dict[str, Any] = {}
    if ax is None:
        axes = list(Figure(figsize=SIZE, layout="constrained").subplots(3))
        axes[0].sharex(axes[1])
        theta = [degrees(units.of("theta").to_si(angle)) for angle in result["theta"].tolist()]
        for one, name in zip(axes, values, strict=False):
            (lines[name],) = one.plot(theta, values[name], color=BLUE, linewidth=1.6)
            one.set(ylabel=labels[name], xlabel="crank angle, theta [deg]")
            turn_axis(one, theta[0], theta[-1])
        axes[0].set_xlabel("")
        axes[0].set_title(
            f"mean speed {factor * result['omega_mean']:.5g} {unit}, fluctuation "
            f"{100 * result['fluctuation']:.3g} %, {result['power_mean']:.4g} {units.of('power_mean').unit}",
            loc="left", fontsize="medium",
        )  # fmt: skip
    else:
        axes = [ax]
    lines |= _loop(axes[-1], result, values, labels, factor)
    for one in axes:
        finish(one)
    return Picture(axes if len(axes) > 1 else axes[0], lines)


def _loop(
    ax: "Axes", result: Any, values: dict[str, Any], labels: dict[str, str], factor: float
) -> dict[str, Any]:
    """The motor's curve, and what of it the machine works on."""
    lines = {}
    curve = result.motor_curve()
    if curve is not None:
        units = result.system or SI
        speed, torque = factor * units.of("omega").shown(curve[0]), units.of("T_motor").shown(curve[1])
        (lines["motor"],) = ax.plot(speed, torque, color="0.6", linewidth=1.2, label="motor")
    (lines["loop"],) = ax.plot(
        values["omega"], values["T_motor"], color=ORANGE, linewidth=2.4, label="over a period"
    )
    ax.set(xlabel=labels["omega"], ylabel=labels["T_motor"])
    ax.legend(frameon=False, fontsize="small")
    return lines
