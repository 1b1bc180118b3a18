"""The derivatives of a torque that is a user's function, by the function that is passed for them."""

from collections.abc import Callable
from math import isfinite, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.arguments import arguments_of, by_position
from ..loads.load import Load
from ..loads.motors import Motor
from ..support.checks import real_number
from ..support.shown import shown

Array = NDArray[np.float64]
ROLES = ("t", "theta", "omega")


class TorqueDerivative(NamedTuple):
    """A function of some of t, theta and omega that returns dT/dtheta, dT/domega and, perhaps, dT/dt."""

    function: Callable[..., Any]
    roles: tuple[str, ...]

    def at(self, t: Any, theta: Any, omega: Any) -> tuple[Any, Any]:
        """dT/dtheta and dT/domega at instants."""
        instants = dict(zip(ROLES, np.broadcast_arrays(t, theta, omega), strict=True))
        rows = zip(*(instants[role].reshape(-1).tolist() for role in self.roles), strict=True)
        slopes = np.array([self._checked(row)[:2] for row in rows]).T.reshape(2, *np.shape(instants["t"]))
        return slopes[0], slopes[1]

    def by_time(self, t: float, theta: float, omega: float) -> float:
        """dT/dt at an instant, if the function returns it as a third number; else NaN."""
        if "t" not in self.roles:
            return 0.0
        instant = dict(zip(ROLES, (t, theta, omega), strict=True))
        slopes = self._checked(tuple(instant[role] for role in self.roles))
        return slopes[2] if len(slopes) > 2 else nan

    def _checked(self, row: tuple[float, ...]) -> list[float]:
        result = self.function(*row)
        try:
            slopes = [real_number("derivative", part) for part in result]
            if len(slopes) not in (2, 3):
                raise ValueError
        except (TypeError, ValueError):
            where = ", ".join(f"{role} = {x:g}" for role, x in zip(self.roles, row, strict=True))
            raise TypeError(
                f"derivative gave {shown(result)} at {where}: expected two numbers, dT/dtheta and dT/domega"
            ) from None
        if not isfinite(sum(slopes)) and all(map(isfinite, row)):
            raise ValueError(f"derivative gave {shown(result)}: they must be finite")
        return slopes


def torque_derivative(torque: Any, derivative: Callable[..., Any] | None) -> TorqueDerivative | None:
    """The derivatives of a torque that does not know its own; TypeError where they are missing."""
    function = callable(torque) and not isinstance(torque, (Load, Motor))
    if derivative is None:
        if function or (isinstance(torque, Load) and not torque.has_slope):
            raise TypeError(
                "torque: wrt= of a function needs its derivative: give derivative=, a function of the "
                "same arguments that returns dT/dtheta and dT/domega"
            )
        return None
    if not function:
        raise TypeError("derivative: it is for a torque that is a function; tables and motors know theirs")
    if not callable(derivative):
        raise TypeError(
            f"derivative = {shown(derivative)}: expected a function of the arguments of torque that "
            "returns dT/dtheta and dT/domega"
        )
    return TorqueDerivative(by_position(derivative), arguments_of("derivative", derivative, ROLES))
