"""A torque of any kind over angle and speed, for rows of designs: value, slope, and derivatives."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import number_or_array
from ...loads.arguments import arguments_of, by_position, required
from ...loads.function import called
from ...loads.load import Load, OverTheta
from ...loads.motors import Motor
from ...loads.resolve import as_load
from ...mechanism.inputs import Input
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

    both      from angle, speed and parameters to the torque and its derivative with respect to the speed
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


def source_of(torque: Any) -> TorqueSource:
    """The source that `torque=` stands for."""
    if torque is None:
        raise TypeError(f"torque is missing: {EXPECTED}")
    if isinstance(torque, Motor):
        most = torque.numbers.get("synchronous_speed")
        way = np.where(np.asarray(max(torque.knots, key=abs) if most is None else most) < 0.0, -1.0, 1.0)
        return TorqueSource(
            lambda theta, omega, row: torque.both(omega, row), torque.numbers, torque.by, torque.speeds,
            torque.knots, way=way,
        )  # fmt: skip
    if isinstance(torque, Load):
        load = as_load("torque", torque)
        if not isinstance(load, OverTheta):
            raise TypeError(f"torque = {load!r}: a torque over theta or omega is expected")
        return TorqueSource(
            lambda theta, omega, row: (load.value(theta) + 0.0 * omega, 0.0 * omega), varies=False, load=load
        )
    if not callable(torque):
        numbers = {"torque": number_or_array(Input("torque", "N*m", ""), torque)}
        return TorqueSource(
            lambda theta, omega, row: (row["torque"] + 0.0 * omega, 0.0 * omega), numbers,
            lambda omega, row: {"torque": np.ones_like(omega)}, varies=False,
        )  # fmt: skip
    passes_time = "t" in required("torque", torque)  # of which it must not depend
    roles = arguments_of("torque", torque, ("theta", "omega", "t")[: 2 + passes_time])
    if roles == ("theta",):
        return source_of(as_load("torque", torque))
    return TorqueSource(_differences(torque, roles), of_speed_alone=roles == ("omega",))


def _differences(torque: Callable[..., Any], roles: tuple[str, ...]) -> Any:
    """The torque of a function of t, theta and omega, of which time must not matter, and its slope."""
    function = by_position(torque)
    if hasattr(torque, "py_func"):  # compiled by numba: for one point, which may branch
        with IMPORTS:
            import numba

        function = numba.vectorize(torque.py_func)  # type: ignore[no-untyped-call]

    def value(theta: Array, omega: Array, t: float = 0.0) -> Array:
        columns = {"t": np.full_like(omega, t), "theta": theta, "omega": omega}
        result = called(function, {role: columns[role] for role in roles}, "torque")
        return np.asarray(np.broadcast_to(result, omega.shape))

    def both(theta: Array, omega: Array, row: Mapping[str, Any]) -> tuple[Array, Array]:
        h = STEP * np.abs(omega)
        differences = (
            w * (value(theta, omega + k * h) - value(theta, omega - k * h)) for k, w in WEIGHTS.items()
        )
        return value(theta, omega), np.asarray(sum(differences) / h)

    theta = np.linspace(0.0, 6.0, 7)
    if (
        "t" in roles
        and (value(theta, theta + 1.0, INSTANTS[0]) != value(theta, theta + 1.0, INSTANTS[1])).any()
    ):
        raise ValueError(
            "torque: a function that changes with t has no steady state; give one of theta and omega"
        )
    return both
