"""The smallest flywheel for a required fluctuation of a machine on its motor."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...support.panels import Panels
from ..drive.inertia import storing
from .designs import DesignRows, course_of
from .states import states_of

Array = NDArray[Any]
ROUNDS = 60
SETTLED = 4e-15  # of the fluctuation
LEAST = 1e-12  # kg m2
DOUBLED = 40  # times that a heavier wheel is tried


def with_flywheels(designs: DesignRows, required: Array) -> DesignRows:
    """The designs with the smallest flywheels that keep their required fluctuations."""
    low = np.zeros(designs.size)
    there, _ = _fluctuation(designs, low)
    high = np.where(there <= required, 0.0, _estimate(designs, required))
    for _ in range(DOUBLED):
        there, slope = _fluctuation(designs, high)
        if not (short := there > required).any():
            break
        low, high = np.where(short, high, low), np.where(short, 4.0 * high, high)
    J = high.copy()
    for _ in range(ROUNDS):
        done = (J == 0.0) | (np.abs(there - required) <= SETTLED * required) | (there > 1e300)
        if done.all():
            break
        high, low = np.where(there <= required, J, high), np.where(there > required, J, low)
        with np.errstate(all="ignore"):  # 1/fluctuation is nearly straight over the inertia
            trial = J + (1.0 / required - 1.0 / there) * there**2 / -slope
        trial = np.where((trial >= low) & (trial <= high), trial, 0.5 * (low + high))
        if (np.abs(trial - J)[~done] <= 2e-16 * J[~done]).all():
            break
        J = np.where(done, J, trial)
        there, slope = _fluctuation(designs, J)
    return designs._replace(J=J)


def _fluctuation(designs: DesignRows, J: Array) -> tuple[Array, Array]:
    """The fluctuation of each design with a flywheel, infinite without a steady state; its slope by J."""
    states = states_of(designs._replace(J=J))
    best = states.fastest()
    there, size, slope = best >= 0, np.full(len(J), np.inf), np.full(len(J), np.nan)
    if there.any():
        for into, key in ((size, "fluctuation"), (slope, ("fluctuation", "flywheel_inertia"))):
            into[there] = states.figures[key][best[there]]
    return size, slope


def _estimate(designs: DesignRows, required: Array) -> Array:
    """The flywheel under a constant torque at a speed of the motor, twice that: a generous one."""
    panels = Panels(designs.edges())
    course = course_of(designs, panels.x)
    load = designs.each(designs.way, 3) * course["load"]
    work = panels.running((panels.integral(load) / designs.period)[:, None, None] - load)
    speeds = designs.source.speeds(designs.motor) * np.ones((designs.size, 1))
    typical = np.nanmedian(np.where(speeds * designs.way[:, None] > 0.0, np.abs(speeds), np.nan), axis=1)
    J, *_ = storing(panels, work, course["inertia"], typical, required)
    return np.asarray(np.maximum(2.0 * J, LEAST))
