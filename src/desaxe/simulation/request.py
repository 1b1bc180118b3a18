"""The request of a simulation, and the motion of one design that answers it."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..loads.load import Load
from .checks import check_inertia, design_values, drive_of, model_of, scalar
from .history import FORCES, integrated
from .march import Ask, March
from .model import Model
from .result import Simulation
from .slopes import add_slopes


def one_motion(ask: Ask, inputs: Mapping[str, Any], starts: Mapping[str, Any], times: Any) -> Simulation:
    """The motion of one design."""
    torque = starts["torque"]
    start = scalar("theta0", starts["theta0"], "rad"), scalar("omega_start", starts["omega_start"], "rad/s")
    drive = drive_of(torque, inputs["F_X"], inputs["F_Y"], ask.deadline, ask.derivative)
    values = design_values(inputs)
    model = model_of(values, ask.branch, start[0], drive)
    check_inertia(model, start[0])
    known: dict[str, Any] = {**values, "branch": ask.branch}
    kept = zip(FORCES, drive[1:], strict=True)
    loads = {name: acting.value for name, acting in kept if isinstance(acting.value, Load)}
    return in_time(ask, model, start, times, known, loads)


def in_time(
    ask: Ask,
    model: Model,
    start: tuple[float, float],
    times: Any,
    known: Mapping[str, Any],
    loads: Mapping[str, Any],
) -> Simulation:
    """The motion of a model by panels of time.

    known, loads   its inputs for names, and those that vary with the motion, for derivatives
    """
    with np.errstate(all="ignore"):  # values beyond every double end the motion with a status
        run = March(model, start, ask)
        run.to_the_end()
        result = integrated(run, ask.names, times, known)
    if ask.wrt:
        add_slopes(result, run, ask.wrt, {**known, **loads})
    return result
