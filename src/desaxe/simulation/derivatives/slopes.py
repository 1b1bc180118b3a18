"""The derivatives of a torque by angle and speed: of a table, a motor, or by a user's own function."""

from collections.abc import Callable
from math import isfinite, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.arguments import arguments_of, by_position
from ...loads.load import Load, OverTheta
from ...loads.motors import Motor
from ...loads.resolve import as_load
from ...support.checks import real_number
from ...support.shown import shown

Array = NDArray[np.float64]
ROLES = ("t", "theta", "omega")


class TorqueSlopes:
    """dT/dtheta and dT/domega along a motion; TypeError for a function whose derivative is not given."""

    def __init__(self, torque: Any, derivative: Callable[..., Any] | None) -> None:
        self.torque, self.derivative = torque, derivative
        self.roles: tuple[str, ...] = ()
        if derivative is not None:
            self.roles = self._roles_of(derivative)
        elif callable(torque) and not isinstance(torque, Motor):
            load = torque if isinstance(torque, Load) else None
            if load is None or not load.has_slope:
                raise TypeError(
                    "torque: wrt= of a function needs its derivative: give derivative=, a function of the "
                    "same arguments that returns dT/dtheta and dT/domega"
                )
            self.torque = as_load("torque", load)

    def _roles_of(self, derivative: Any) -> tuple[str, ...]:
        if not callable(self.torque) or isinstance(self.torque, (Load, Motor)):
            raise TypeError(
                "derivative: it is for a torque that is a function; tables and motors know theirs"
            )
        if not callable(derivative):
            raise TypeError(
                f"derivative = {shown(derivative)}: expected a function of the arguments of torque that "
                "returns dT/dtheta and dT/domega"
            )
        self.derivative = by_position(derivative)
        return arguments_of("derivative", derivative, ROLES)

    def at(self, t: Array, theta: Array, omega: Array) -> tuple[Array, Array]:
        """Both derivatives at these instants."""
        none = np.zeros(t.shape)
        if self.derivative is not None:
            places = {"t": t, "theta": theta, "omega": omega}
            rows = zip(*(places[role].reshape(-1).tolist() for role in self.roles), strict=True)
            told = np.array([self._told(row)[:2] for row in rows])
            return told[:, 0].reshape(t.shape), told[:, 1].reshape(t.shape)
        if isinstance(self.torque, Motor):
            return none, np.asarray(self.torque.both(omega, self.torque.numbers)[1]) + none
        if isinstance(self.torque, OverTheta):
            return np.asarray(self.torque.both(theta)[1]) + none, none
        return none, none

    def by_time(self, t: float, theta: float, omega: float) -> float:
        """dT/dt at an instant, if the derivative tells it as a third number; else NaN."""
        if "t" not in self.roles:
            return 0.0
        now = {"t": t, "theta": theta, "omega": omega}
        told = self._told(tuple(now[role] for role in self.roles))
        return told[2] if len(told) > 2 else nan

    def _told(self, row: tuple[float, ...]) -> list[float]:
        assert self.derivative is not None
        found = self.derivative(*row)
        try:
            told = [real_number("derivative", part) for part in found]
            if len(told) not in (2, 3):
                raise ValueError
        except (TypeError, ValueError):
            place = ", ".join(f"{role} = {x:g}" for role, x in zip(self.roles, row, strict=True))
            raise TypeError(
                f"derivative gave {shown(found)} at {place}: expected two numbers, dT/dtheta and dT/domega"
            ) from None
        if not isfinite(sum(told)) and all(map(isfinite, row)):
            raise ValueError(f"derivative gave {shown(found)}: they must be finite")
        return told
