"""Torque and forces along a motion: values and slopes, on a stretch of it one smooth piece each.

A load that has pieces (a table, the nodes of a function, a motor's table) is asked for the piece ahead of a
state. That piece goes on smoothly a little beyond the kink at which the motion is cut.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from math import copysign, inf, isfinite, isnan, nextafter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.along_motion import OfMotion, SumOfLoads
from ..loads.angles import zero_of
from ..loads.arguments import by_position
from ..loads.function import FunctionOverTheta
from ..loads.load import Load, OverTheta, OverY, TableOverTheta
from ..loads.motors import Motor, OverOmega
from ..loads.table import polynomial
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres
from ..mechanism.messages import listed, named
from ..support.checks import real_number
from ..support.deadline import Deadline
from ..support.shown import shown
from .pieces import compiles, meeting_angles
from .torque_derivative import TorqueDerivative

Array = NDArray[np.float64]
AHEAD = 1e-9  # rad: which piece of a table follows an angle
AHEAD_OF_Y = 1e-6  # rad: so far from a dead centre the slider has left its position
BEHIND = 1e-8  # of the largest speed of a motor's table: which piece of it follows a speed
STEP = 1e-7  # of an angle or a speed: a difference has seven digits


class Slopes(NamedTuple):
    """A value and its derivatives by theta and omega at instants."""

    value: Any
    theta: Any = 0.0
    omega: Any = 0.0


class SliderDesign(ABC):
    """The slider of a design at crank angles."""

    @abstractmethod
    def slider(self, theta: Any) -> tuple[Any, Any, Any]:
        """Y, s and Y_wrt_theta."""


class Curve(ABC):
    """A torque or force along the motion, or the smooth piece of one."""

    knots: tuple[float, ...] = ()  # speeds at which pieces meet
    depends_on_time = False
    form: Any = None  # numbers, a table or a motor, which compiled loops know

    @abstractmethod
    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The value at instants: of arrays of them, or of one."""

    @abstractmethod
    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The value and its derivatives; value: that, where it is known."""

    def by_time(self, t: float, theta: float, omega: float) -> float:
        """The derivative by time, NaN where it is not known."""
        return 0.0

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> "Curve":
        """The piece that holds from a state on: for this way of turning, and this sign of domega/dt."""
        return self

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """The angles of one period at which pieces meet, and that period [rad]."""
        return []

    def moves(self, theta: float) -> Mapping[str, float]:
        """By how much inputs move a kink at an angle, where that is not the design's to say."""
        return {}

    def stand(self, design: SliderDesign, lengths: tuple[float, ...], branch: int) -> None:  # noqa: B027
        """Stand in a design; ValueError where it has not the dead centre that a load is measured from."""


class ConstantCurve(Curve):
    """A number."""

    def __init__(self, value: float) -> None:
        self.value, self.form = value, np.array([value])

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The number."""
        return self.value

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The number, and none."""
        return Slopes(self.value)


class MotorCurve(Curve):
    """A motor, or the piece of its table between two speeds."""

    def __init__(self, motor: Motor, piece: int | None = None) -> None:
        self.motor, self.piece, self.knots, self.numbers = motor, piece, motor.knots, motor.numbers
        self.form = motor

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The torque."""
        return self.slopes(t, theta, omega).value

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The torque and its slope."""
        if self.piece is None or not isinstance(self.motor, OverOmega):
            value, slope = self.motor.both(omega, self.numbers)
        else:
            table = self.motor.table
            value, slope = polynomial(table.rows[self.piece], omega - table.origin(self.piece))
        return Slopes(value, 0.0, slope)

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """The piece of the table above or below a speed."""
        if not isinstance(self.motor, OverOmega):
            return self
        speed = omega + copysign(BEHIND * max(map(abs, self.knots)), growing)
        return MotorCurve(self.motor, self.motor.table.piece(speed))


class AngleCurve(Curve):
    """A load over the crank angle."""

    def __init__(self, load: Any) -> None:
        self.load, self.form = load, load if isinstance(load, TableOverTheta) else None

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The load."""
        return self.load.value(theta)

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The load and its slope, by differences where that is not known."""
        if self.load.has_slope:
            return Slopes(*self.load.both(theta))
        value = self.at(t, theta, omega) if value is None else value
        return Slopes(value, difference(lambda x: self.at(t, x, omega), theta, 1.0, value))

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """The piece ahead of an angle."""
        load, angle = self.load, theta + copysign(AHEAD, direction)
        if isinstance(load, TableOverTheta):
            reduced = load.table.reduced(angle)
            piece = load.table.piece(reduced)
            return CubicCurve(load.table.rows[piece], angle - (reduced - load.table.origin(piece)))
        if isinstance(load, FunctionOverTheta) and load.angles:
            nodes = load.nodes(angle - 2.0 * load.period, angle + 2.0 * load.period, smooth=False)
            low = max(node for node in nodes if node <= angle)
            high = min(node for node in nodes if node > angle)
            return BoundedCurve(load, low, nextafter(high, -inf))
        return self

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """All knots of a table: a panel cannot resolve a function over one, however smooth it is there."""
        if isinstance(self.load, TableOverTheta):
            return [(angle, self.load.period) for angle in dict.fromkeys(self.load.table.knots)]
        angles = self.load.angles if isinstance(self.load, FunctionOverTheta) else ()
        return [(angle, self.load.period) for angle in angles]


class CubicCurve(Curve):
    """One cubic of a table over theta."""

    def __init__(self, row: Any, origin: float) -> None:
        self.row, self.origin = row, origin

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The cubic."""
        return polynomial(self.row, theta - self.origin)[0]

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The cubic and its slope."""
        return Slopes(*polynomial(self.row, theta - self.origin))


class BoundedCurve(AngleCurve):
    """A function between two of its nodes, and beyond them what it is there."""

    def __init__(self, load: OverTheta, low: float, high: float) -> None:
        super().__init__(load)
        self.low, self.high = low, high

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The function."""
        return self.load.value(np.clip(theta, self.low, self.high))

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The function and its slope, beyond the nodes as at them."""
        result = super().slopes(t, np.clip(theta, self.low, self.high), omega)
        return result._replace(value=self.at(t, theta, omega))

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """Another piece, by another node."""
        return AngleCurve(self.load).ahead(theta, omega, direction)


class PositionCurve(Curve):
    """A load over the slider's position, or one piece of its table."""

    def __init__(self, load: OverY, piece: int | None = None) -> None:
        self.load, self.piece = load, piece
        self.design: SliderDesign | None = None
        self.zero = 0.0  # the position from which it is measured

    def stand(self, design: SliderDesign, lengths: tuple[float, ...], branch: int) -> None:
        """Stand in a design; ValueError where it has not the dead centre that a load is measured from."""
        self.design, self.zero = design, _zero_in(self.load, lengths, branch)
        self.form = self.load if compiles(self.load, *lengths[1:]) else None

    def along(self, theta: Any) -> tuple[Any, Any]:
        """The position or distance at an angle, and the slope of Y."""
        assert self.design is not None
        Y, _, slope = self.design.slider(theta)
        return self.load.along({"Y": Y, self.load.centre: self.zero}), slope

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The load; at rest the sign of omega's zero is the way in which the crank starts."""
        return self.slopes(t, theta, omega).value

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The load and its slope."""
        place, slope = self.along(theta)
        if self.piece is None:
            value, bend = self.load.both(place, slope * np.copysign(1.0, omega))
        else:
            value, bend = self.load.held(place, self.piece)
        assert self.design is not None
        side = np.copysign(1.0, self.design.slider(theta)[0] - self.zero) if self.load.centre else 1.0
        return Slopes(value, bend * slope * side)

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """The piece ahead of an angle, for the way in which the slider goes there."""
        place, slope = self.along(theta + copysign(AHEAD_OF_Y, direction))
        result = PositionCurve(self.load, int(self.load.piece(float(place), float(slope * direction))))
        result.design, result.zero = self.design, self.zero
        return result

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """The angles at the table's positions, and the dead centres where another table holds behind them."""
        angles = meeting_angles(self.load, [np.array([x]) for x in lengths], branch)[0]
        return [(angle, TURN) for angle in angles[np.isfinite(angles)].tolist()]


class FunctionCurve(Curve):
    """A user's function, called with numbers and checked wherever it is called."""

    def __init__(
        self,
        name: str,
        function: Callable[..., Any],
        arguments: tuple[str, ...],
        unit: str,
        deadline: Deadline,
        derivative: TorqueDerivative | None = None,
    ) -> None:
        self.derivative = derivative
        self.name, self.function, self.unit, self.deadline = name, by_position(function), unit, deadline
        self.arguments = arguments
        self.depends_on_time = "t" in arguments
        self.follows_the_slider = not {"Y", "s", "V_C"}.isdisjoint(arguments)
        self.design: SliderDesign | None = None

    def stand(self, design: SliderDesign, lengths: tuple[float, ...], branch: int) -> None:
        """Stand in a design, whose slider the function may follow."""
        self.design = design

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The values, one by one."""
        if np.ndim(theta) != np.ndim(omega) or np.ndim(t) != np.ndim(omega):
            t, theta, omega = np.broadcast_arrays(t, theta, omega)
        now = self.columns(t, theta, omega)
        if not np.ndim(omega):
            return self._one({name: float(value) for name, value in now.items()})
        columns = [now[argument].tolist() for argument in self.arguments]
        check, function, result = self.deadline.check, self.function, []
        for row in zip(*columns, strict=True):
            check()
            result.append(function(*row))
        if all(type(value) is float and isfinite(value) for value in result):
            return np.array(result)
        rows = zip(*(now[name].tolist() for name in now), strict=True)
        return np.array([self._one(dict(zip(now, row, strict=True))) for row in rows])

    def columns(self, t: Any, theta: Any, omega: Any) -> dict[str, Any]:
        """The columns of the motion at instants, by name."""
        now = {"t": t, "theta": theta, "omega": omega}
        if self.follows_the_slider:
            assert self.design is not None
            now["Y"], now["s"], slope = self.design.slider(theta)
            now["V_C"] = slope * omega
        return now

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The values, and their differences."""
        roles, by_theta, by_omega = set(self.arguments), 0.0, 0.0
        value = self.at(t, theta, omega) if value is None else value
        if self.derivative is not None:
            return Slopes(value, *self.derivative.at(t, theta, omega))
        if roles - {"t", "omega"}:
            by_theta = difference(lambda x: self.at(t, x, omega), theta, 1.0, value)
        if roles & {"omega", "V_C"}:
            size = float(np.max(np.abs(omega)))
            by_omega = difference(lambda x: self.at(t, theta, x), omega, size, value)
        return Slopes(value, by_theta, by_omega)

    def by_time(self, t: float, theta: float, omega: float) -> float:
        """dT/dt, if it is known; else NaN."""
        return 0.0 if self.derivative is None else self.derivative.by_time(t, theta, omega)

    def _one(self, now: dict[str, float]) -> float:
        """The value at an instant, checked."""
        passed = [now[argument] for argument in self.arguments]
        if not all(map(isfinite, passed)):
            return float("nan")
        self.deadline.check()
        value = self.function(*passed)
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


class MotionCurve(FunctionCurve):
    """A load over columns of the motion."""

    def __init__(self, load: OfMotion) -> None:
        self.load, self.arguments, self.depends_on_time = load, load.needs, False
        self.design: SliderDesign | None = None
        self.zero, self.derivative = 0.0, None
        self.follows_the_slider = not {"Y", "s", "V_C"}.isdisjoint(load.needs)

    def stand(self, design: SliderDesign, lengths: tuple[float, ...], branch: int) -> None:
        """Stand in a design; ValueError where it has not the dead centre that a load is measured from."""
        self.design, self.zero = design, _zero_in(self.load, lengths, branch)

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """The dead centres, where a load has a kink at rest of the slider."""
        if 0.0 not in self.load.speeds:
            return []
        return [(angle, TURN) for angle in dead_centres([np.array([x]) for x in lengths])[0].tolist()]

    def columns(self, t: Any, theta: Any, omega: Any) -> dict[str, Any]:
        """The columns that the load needs."""
        return {**super().columns(t, theta, omega), self.load.centre: self.zero}

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The load."""
        return self.load.partials(self.columns(t, theta, omega)).value


class SumCurve(Curve):
    """Multiples of loads, and a number."""

    def __init__(self, load: Any, factors: Sequence[float], parts: Sequence[Curve], constant: float) -> None:
        self.load, self.factors, self.members, self.constant = load, factors, parts, constant

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The sum."""
        terms = zip(self.factors, self.members, strict=True)
        return sum((factor * part.at(t, theta, omega) for factor, part in terms), self.constant)

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The sum and its slopes."""
        parts = [part.slopes(t, theta, omega) for part in self.members]
        sums = (
            sum(f * x for f, x in zip(self.factors, row, strict=True)) for row in zip(*parts, strict=True)
        )
        value, *slopes = sums
        return Slopes(value + self.constant, *slopes)

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """The sum of the pieces ahead."""
        parts = [part.ahead(theta, omega, direction, growing) for part in self.members]
        return SumCurve(self.load, self.factors, parts, self.constant)

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """The kinks of all members."""
        return [kink for part in self.members for kink in part.kinks(lengths, branch)]

    def stand(self, design: SliderDesign, lengths: tuple[float, ...], branch: int) -> None:
        """Stand in a design."""
        for part in self.members:
            part.stand(design, lengths, branch)


LOADED = (AngleCurve, PositionCurve, MotionCurve, SumCurve)  # which stand for a load


def _zero_in(load: Load, lengths: tuple[float, ...], branch: int) -> float:
    """The position from which a load is measured; ValueError where a design has not the dead centre."""
    zero = float(zero_of(load, [np.array([length]) for length in lengths], branch)[0])
    if isnan(zero):
        raise ValueError(f"{load!r}: this design has no {load.centre.removeprefix('Y_')} dead centre")
    return zero


def difference(function: Callable[[Any], Any], x: Any, size: float, value: Any) -> Any:
    """A forward difference, good enough for an iteration; size: of what x is measured by."""
    step = STEP * (size or 1.0)
    return (function(x + step) - value) / step


def curve_of(load: Load | Motor) -> Curve:
    """The curve of a motor or a load."""
    if isinstance(load, Motor):
        return MotorCurve(load)
    if isinstance(load, SumOfLoads):
        factors = [factor for factor, _ in load.terms]
        return SumCurve(load, factors, [curve_of(part) for part in load.members], load.constant)
    if isinstance(load, OfMotion):
        return MotionCurve(load)
    return PositionCurve(load) if isinstance(load, OverY) else AngleCurve(load)
