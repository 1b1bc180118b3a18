"""The derivatives of a torque by angle and speed: of a table, a motor, or by a user's own function."""

from collections.abc import Callable
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loads.load import Load, OverTheta
from ..loads.motors import Motor
from ..loads.resolve import as_load, roles_of
from ..support.checks import real_number
from ..support.shown import shown

Array = NDArray[np.float64]
ROLES = ("t", "theta", "omega")


class Slopes:
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
        roles = roles_of(derivative) if callable(derivative) else None
        if roles is None:
            raise TypeError(
                f"derivative = {shown(derivative)}: expected a function of the arguments of torque that "
                "returns dT/dtheta and dT/domega"
            )
        return roles

    def at(self, t: Array, theta: Array, omega: Array) -> tuple[Array, Array]:
        """Both derivatives at these instants."""
        none = np.zeros(t.shape)
        if self.derivative is not None:
            places = {"t": t, "theta": theta, "omega": omega}
            rows = zip(*(places[role].reshape(-1).tolist() for role in self.roles), strict=True)
            pairs = np.array([self._pair(row) for row in rows])
            return pairs[:, 0].reshape(t.shape), pairs[:, 1].reshape(t.shape)
        if isinstance(self.torque, Motor):
            return none, np.asarray(self.torque.both(omega, self.torque.numbers)[1]) + none
        if isinstance(self.torque, OverTheta):
            return np.asarray(self.torque.both(theta)[1]) + none, none
        return none, none

    def _pair(self, row: tuple[float, ...]) -> tuple[float, float]:
        assert self.derivative is not None
        found = self.derivative(*row)
        try:
            by_theta, by_omega = (real_number("derivative", part) for part in found)
        except (TypeError, ValueError):
            told = ", ".join(f"{role} = {x:g}" for role, x in zip(self.roles, row, strict=True))
            raise TypeError(
                f"derivative gave {shown(found)} at {told}: expected two numbers, dT/dtheta and dT/domega"
            ) from None
        if not isfinite(by_theta + by_omega) and all(map(isfinite, row)):
            raise ValueError(f"derivative gave {shown(found)}: both must be finite")
        return by_theta, by_omega
