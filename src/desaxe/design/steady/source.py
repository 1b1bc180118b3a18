"""A torque of any kind over angle and speed, for rows of designs: value, slope, and derivatives."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import number_or_array
from ...loads.arguments import arguments_of, by_position, required
from ...loads.load import Load, OverTheta
from ...loads.motors import Motor
from ...loads.resolve import as_load
from ...mechanism.inputs import Input
from ...mechanism.messages import listed, message_of, named
from ...support.forks import IMPORTS

Array = NDArray[Any]
# Central differences of order 8 of a user's function over the speed, which has no derivative of its own.
WEIGHTS = {1: 4.0 / 5.0, 2: -1.0 / 5.0, 3: 4.0 / 105.0, 4: -1.0 / 280.0}
STEP = 1e-3  # of the speed
INSTANTS = (0.0, 0.371)  # s: a function of time is not the same at both
SPEEDS = np.outer([-1.0, 1.0], np.geomspace(1e-2, 1e5, 141))
EXPECTED = (
    "expected a number, a motor (desaxe.kloss, desaxe.over_omega), a load over theta, or a function of theta "
    "and omega"
)


@dataclass(frozen=True)
class TorqueSource:
    """The torque of a call.

    both      from angle, speed and parameters to the torque and its derivative by the speed
    numbers   its parameters, by which there are derivatives: `by` returns them
    speeds    among which turns are tried
    knots     speeds at which it has a kink
    varies    whether it depends on the speed, of_speed_alone: on nothing else
    way       the way in which it turns the crank, None where it has none of its own
    """

    both: Callable[[Array, Array, Mapping[str, Any]], tuple[Array, Array]]
    numbers: Mapping[str, Any] = field(default_factory=dict)
    by: Callable[[Array, Mapping[str, Any]], dict[str, Array]] = lambda omega, row: {}
    speeds: Callable[[Mapping[str, Any]], Array] = lambda row: np.ravel(SPEEDS)
    knots: tuple[float, ...] = ()
    varies: bool = True
    of_speed_alone: bool = True
    load: Load | None = None
    way: Any = None


def _constant(value: Any) -> TorqueSource:
    """A number, or one for each design."""
    return TorqueSource(
        lambda theta, omega, row: (row["torque"] + 0.0 * omega, 0.0 * omega), {"torque": value},
        lambda omega, row: {"torque": np.ones_like(omega)}, varies=False,
    )  # fmt: skip


def _over_angle(load: OverTheta) -> TorqueSource:
    """A load over theta."""
    return TorqueSource(
        lambda theta, omega, row: (load.value(theta) + 0.0 * omega, 0.0 * omega), varies=False, load=load
    )


def _of_motor(motor: Motor) -> TorqueSource:
    """A motor: a table or Kloss's formula."""
    most = motor.numbers.get("synchronous_speed")
    if most is None:
        most = max(motor.knots, key=abs)
    way = np.where(np.asarray(most) < 0.0, -1.0, 1.0)
    return TorqueSource(
        lambda theta, omega, row: motor.both(omega, row), motor.numbers, motor.by, motor.speeds, motor.knots,
        way=way,
    )  # fmt: skip


class TorqueFunction:
    """A function of t, theta and omega, of which time must not matter."""

    def __init__(self, function: Callable[..., Any], roles: tuple[str, ...]) -> None:
        self.roles, self.name = roles, getattr(function, "__name__", type(function).__name__)
        self.function, self.takes_arrays = by_position(function), True
        if hasattr(function, "py_func"):  # compiled by numba: for one point, which may branch
            with IMPORTS:
                import numba

            self.function = numba.vectorize(function.py_func)  # type: ignore[no-untyped-call]

    def _value(self, theta: Array, omega: Array, t: float = 0.0) -> Array:
        places = {"t": np.full_like(omega, t), "theta": np.broadcast_to(theta, omega.shape), "omega": omega}
        arrays = [places[role] for role in self.roles]
        found: Any = None
        if self.takes_arrays:
            try:
                found = np.asarray(self.function(*arrays), float)
            except Exception:
                self.takes_arrays = False
        if found is None:
            columns = (array.reshape(-1).tolist() for array in arrays)
            found = np.array([self._one(row) for row in zip(*columns, strict=True)]).reshape(omega.shape)
        if found.shape not in ((), omega.shape):
            raise ValueError(f"torque: {self.name} of {omega.size} points gave the shape {found.shape}")
        found = np.broadcast_to(found, omega.shape)
        bad = ~np.isfinite(found) & np.isfinite(omega)
        if bad.any():
            where = named("omega", omega[bad].flat[0], "g")
            what = f"torque: {self.name} gave {found[bad].flat[0]} at " + where
            raise ValueError(what + ": it must be a finite number in N*m")
        return np.asarray(found)

    def _one(self, row: tuple[float, ...]) -> float:
        if not np.isfinite(row).all():
            return float("nan")
        try:
            return float(self.function(*row))
        except (TypeError, ValueError) as error:
            where = listed([named(role, value, "g") for role, value in zip(self.roles, row, strict=True)])
            failed = f"torque: {self.name} failed at " + where + ": " + message_of(error)
            raise type(error)(failed) from error

    def both(self, theta: Array, omega: Array, row: Mapping[str, Any]) -> tuple[Array, Array]:
        """The function's torque; its slope from eight values around the speed."""
        torque = self._value(theta, omega)
        h = STEP * np.abs(omega)
        slope = sum(
            w * (self._value(theta, omega + k * h) - self._value(theta, omega - k * h))
            for k, w in WEIGHTS.items()
        )
        return torque, np.asarray(slope / h)

    def check_time(self, theta: Array, omega: Array) -> None:
        """ValueError for a torque that depends on time: it has no steady state."""
        if "t" in self.roles:
            one, other = (self._value(theta, omega, t) for t in INSTANTS)
            if (one != other).any():
                raise ValueError(
                    "torque: a function that changes with t has no steady state; give one of theta and omega"
                )


def source_of(torque: Any) -> TorqueSource:
    """The source that `torque=` stands for."""
    if torque is None:
        raise TypeError(f"torque is missing: {EXPECTED}")
    if isinstance(torque, Motor):
        return _of_motor(torque)
    if isinstance(torque, Load):
        load = as_load("torque", torque)
        if not isinstance(load, OverTheta):
            raise TypeError(f"torque = {load!r}: a torque over theta or omega is expected")
        return _over_angle(load)
    if not callable(torque):
        return _constant(number_or_array(Input("torque", "N*m", ""), torque))
    passes_time = "t" in required("torque", torque)  # of which it must not depend
    roles = arguments_of("torque", torque, ("theta", "omega", "t")[: 2 + passes_time])
    if roles == ("theta",):
        return source_of(as_load("torque", torque))
    function, theta = TorqueFunction(torque, roles), np.linspace(0.0, 6.0, 7)
    function.check_time(theta, theta + 1.0)
    return TorqueSource(function.both, of_speed_alone=roles == ("omega",))
