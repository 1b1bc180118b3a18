"""The smallest flywheel for a required fluctuation of a machine on its motor."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...support.panels import Panels
from ..drive.inertia import storing
from .designs import DesignRows, course_of
from .states import States, main_of, states_of

Array = NDArray[Any]
ROUNDS = 60
SETTLED = 4e-15  # of the fluctuation
LEAST = 1e-12  # kg m2
DOUBLED = 40  # times that a heavier wheel is tried


class Wheel:
    """The fluctuation of designs over the inertia of their flywheels."""

    def __init__(self, designs: DesignRows) -> None:
        self.designs = designs

    def at(self, J: Array) -> tuple[States, Array, Array, Array]:
        """The steady states with these flywheels; of each design the row, the fluctuation, its slope."""
        states = states_of(self.designs._replace(J=J))
        main = main_of(states, self.designs.size)
        there = main >= 0
        shown, slope = np.full(len(J), np.inf), np.full(len(J), np.nan)
        shown[there] = states.figures.values["fluctuation"][main[there]] if there.any() else 0.0
        if there.any():
            slope[there] = states.figures.gradient["fluctuation"]["flywheel_inertia"][main[there]]
        return states, main, shown, slope


def with_flywheels(designs: DesignRows, wanted: Array) -> DesignRows:
    """The designs with the smallest flywheels that keep their required fluctuations."""
    wheel, low = Wheel(designs), np.zeros(designs.size)
    *_, there, _ = wheel.at(low)
    high = np.where(there <= wanted, 0.0, _estimate(designs, wanted))
    for _ in range(DOUBLED):
        _, _, there, slope = wheel.at(high)
        if not (short := there > wanted).any():
            break
        low, high = np.where(short, high, low), np.where(short, 4.0 * high, high)
    J = high.copy()
    for _ in range(ROUNDS):
        done = (J == 0.0) | (np.abs(there - wanted) <= SETTLED * wanted) | (there > 1e300)
        if done.all():
            break
        high, low = np.where(there <= wanted, J, high), np.where(there > wanted, J, low)
        with np.errstate(all="ignore"):  # 1/fluctuation is nearly straight over the inertia
            step = (1.0 / wanted - 1.0 / there) * there**2 / -slope
        trial = J + step
        outside = ~((trial >= low) & (trial <= high))
        trial = np.where(outside, 0.5 * (low + high), trial)
        if (np.abs(trial - J)[~done] <= 2e-16 * J[~done]).all():
            break
        J = np.where(done, J, trial)
        _, _, there, slope = wheel.at(J)
    return designs._replace(J=J)


def _estimate(designs: DesignRows, wanted: Array) -> Array:
    """The flywheel under a constant torque at a speed of the motor, twice that: a generous one."""
    panels = Panels(designs.edges())
    course = course_of(designs, panels.x)
    load = designs.each(designs.way, 3) * course.load
    work = panels.running((panels.integral(load) / designs.period)[:, None, None] - load)
    speeds = designs.source.speeds(designs.motor) * np.ones((designs.size, 1))
    typical = np.nanmedian(np.where(speeds * designs.way[:, None] > 0.0, np.abs(speeds), np.nan), axis=1)
    J, *_ = storing(panels, work, course.inertia, typical, wanted)
    return np.asarray(np.maximum(2.0 * J, LEAST))
