"""Torque and forces along a motion, each a number, a load, a motor or a function.

Compiled loops know numbers, tables and motors by their coefficients (`pieces`); all else they call.
"""

from collections.abc import Callable, Mapping
from math import inf, isfinite, isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.along_motion import OfMotion, SumOfLoads
from ..loads.angles import zero_of
from ..loads.arguments import arguments_of, by_position
from ..loads.function import FunctionOverTheta
from ..loads.load import Load, OverTheta, OverY, TableOverTheta
from ..loads.motors import Motor
from ..loads.table import polynomial
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres
from ..mechanism.messages import listed, named
from ..support.checks import real_number
from ..support.deadline import Deadline
from ..support.shown import shown
from .pieces import meeting_angles

Array = NDArray[np.float64]
ROLES = ("t", "theta", "omega")
Lengths = tuple[float, ...]


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


class UserFunction:
    """A user's function of the motion, called with numbers and checked wherever it is called."""

    def __init__(
        self,
        name: str,
        function: Callable[..., Any],
        arguments: tuple[str, ...],
        unit: str,
        deadline: Deadline,
        derivative: TorqueDerivative | None = None,
    ) -> None:
        self.name, self.function, self.unit, self.deadline = name, by_position(function), unit, deadline
        self.needs, self.derivative = arguments, derivative

    def at(self, now: Mapping[str, Any]) -> Any:
        """The values at columns of the motion, one by one."""
        columns = [now[argument].tolist() for argument in self.needs]
        good = isfinite(sum(map(sum, columns)))
        check, function, result = self.deadline.check, self.function, []
        for row in zip(*columns, strict=True):
            check()
            result.append(function(*row) if good or all(map(isfinite, row)) else nan)
        if all(type(value) is float and isfinite(value) for value in result):
            return np.array(result)
        rows = zip(*(column.tolist() for column in now.values()), strict=True)
        return np.array(
            [self._one(x, dict(zip(now, row, strict=True))) for x, row in zip(result, rows, strict=True)]
        )

    def _one(self, value: Any, now: dict[str, float]) -> float:
        """The value at an instant, checked."""
        if not all(map(isfinite, (now[argument] for argument in self.needs))):
            return float("nan")
        try:
            number = value if type(value) is float else real_number(self.name, value)
        except (TypeError, ValueError):
            raise TypeError(
                f"{self.name} gave {shown(value)} at t = {now['t']:g}: expected a number in {self.unit}"
            ) from None
        if not isfinite(number):
            where = listed([named(argument, x, "g") for argument, x in now.items()])
            limit = f": it must be a finite number in {self.unit}"
            raise ValueError(f"{self.name} gave {number} at " + where + limit)
        return number


class Acting(NamedTuple):
    """A torque [N m] on the crank or a force [N] on the slider."""

    value: float | Load | Motor | UserFunction

    @property
    def is_number(self) -> bool:
        """True for a number."""
        return isinstance(self.value, float)

    @property
    def terms(self) -> list[tuple[float, Any]]:
        """Factors and what they multiply; all members of a sum."""
        if isinstance(self.value, SumOfLoads):
            return [*self.value.terms, (1.0, self.value.constant)]
        return [(1.0, self.value)]

    def slopes(self, t: Array, theta: Array, omega: Array) -> tuple[Any, Any, Any]:
        """A torque of theta, omega and t, and its exact derivatives with respect to theta and omega."""
        value = self.value
        if isinstance(value, Motor):
            torque, slope = value.both(omega, value.numbers)
            return torque, 0.0, slope
        if isinstance(value, OverTheta):
            return *value.both(theta), 0.0
        if isinstance(value, UserFunction) and value.derivative is not None:
            torque = value.at({"t": t, "theta": theta, "omega": omega})
            return torque, *value.derivative.at(t, theta, omega)
        return value, 0.0, 0.0

    def by_time(self, t: float, theta: float, omega: float) -> float:
        """The derivative with respect to time, NaN where it is not known."""
        value = self.value
        if isinstance(value, UserFunction) and value.derivative is not None:
            return value.derivative.by_time(t, theta, omega)
        return 0.0


class Actuation(NamedTuple):
    """The torque [N m] and the forces on the slider [N] that drive the mechanism."""

    torque: Acting
    F_X: Acting
    F_Y: Acting


NOTHING = Actuation(Acting(0.0), Acting(0.0), Acting(0.0))


class Slider(NamedTuple):
    """The slider of a design at crank angles: lengths, branch, and a function of Y, s and Y_wrt_theta."""

    lengths: Lengths
    branch: int
    at: Callable[[Any], tuple[Any, Any, Any]]

    def zero(self, load: Any) -> float:
        """The position from which a load is measured; ValueError for a missing dead centre."""
        zero = float(zero_of(load, [np.array([length]) for length in self.lengths], self.branch)[0])
        if isnan(zero):
            raise ValueError(f"{load!r}: this design has no {load.centre.removeprefix('Y_')} dead centre")
        return zero


def needs_of(part: float | Load | Motor | UserFunction) -> tuple[str, ...]:
    """The columns of the motion on which a torque or force depends."""
    return () if isinstance(part, float) else ("omega",) if isinstance(part, Motor) else part.needs


class Called:
    """A load, a motor or a function that compiled loops call, or a number.

    directed   True where the way in which the crank turns matters
    """

    directed = False

    def __init__(self, part: float | Load | Motor | UserFunction, slider: Slider) -> None:
        self.part, self.slider, self.needs = part, slider, needs_of(part)
        self.zero = slider.zero(part) if isinstance(part, Load) and part.centre else 0.0

    def at(
        self, t: Any, theta: Any, omega: Any, direction: float = 0.0, low: float = -inf, high: float = inf
    ) -> Any:
        """The values at instants.

        direction   of the crank, where it is not that of omega
        low, high   angles between which one piece holds, which goes on smoothly, or as it is there
        """
        part, middle = self.part, 0.5 * (low + high)
        if isinstance(part, float):
            return part
        if isinstance(part, Motor):
            return part.both(omega, part.numbers)[0]
        if isinstance(part, TableOverTheta) and isfinite(middle):
            reduced = part.table.reduced(middle)
            piece = part.table.piece(reduced)
            origin = middle - (reduced - part.table.origin(piece))
            return polynomial(part.table.rows[piece], theta - origin)[0]
        if isinstance(part, OverTheta):
            return part.value(np.clip(theta, low, high))
        now = {"t": t, "theta": theta, "omega": omega}
        if not {"Y", "s", "V_C"}.isdisjoint(self.needs):
            now["Y"], now["s"], slope = self.slider.at(theta)
            now["V_C"], now["way"] = slope * omega, slope * (direction or np.copysign(1.0, omega))
        if isinstance(part, UserFunction):
            now.pop("way", None)
            return part.at(now)
        now[part.centre] = self.zero
        if isinstance(part, OverY) and isfinite(middle):
            Y, _, slope = self.slider.at(middle)
            place = float(part.along({"Y": Y, part.centre: self.zero}))
            return part.held(part.along(now), int(part.piece(place, float(slope * direction))))[0]
        return part.partials(now).value

    @property
    def kinks(self) -> tuple[float, Array]:
        """The period, and the angles in it at which pieces meet."""
        return kinks_of(self.part, self.slider)

    def moves(self, theta: float) -> Mapping[str, float]:
        """By how much inputs move a kink at an angle."""
        return {}


def kinks_of(load: Any, slider: Slider) -> tuple[float, Array]:
    """The period of a load, and the angles in it at which its pieces meet."""
    lengths = [np.array([x]) for x in slider.lengths]
    if isinstance(load, TableOverTheta):
        return load.period, np.array(load.table.knots)
    if isinstance(load, FunctionOverTheta):
        return load.period, np.array(load.angles)
    if isinstance(load, OverY):
        angles = meeting_angles(load, lengths, slider.branch)[0]
        return TURN, angles[np.isfinite(angles)]
    bends = isinstance(load, OfMotion) and 0.0 in load.speeds
    return TURN, dead_centres(lengths)[0] if bends else np.empty(0)
