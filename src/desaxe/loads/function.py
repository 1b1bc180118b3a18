"""A user's function of the crank angle as a load."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any

from ..mechanism.closed import TURN
from ..mechanism.messages import Message, listed, message_of, named
from ..support.computed import computed_once
from ..support.lazy import np
from .load import OverTheta
from .table import SAME

SAMPLES = 1024  # of a function, by which it is distinguished from others
ROUNDED = 8  # last bits of an angle: so far from its node a user's function may jump
BESIDE = 1e-9  # rad: more than these are
PROBES, GOLDEN = (
    128,
    0.6180339887498949,
)  # angles of a period at which values are compared, none at a round one
REPEATED = 1e-9  # of the largest value: what rounding of angles may change


@dataclass(frozen=True, repr=False)
class FunctionOverTheta(OverTheta):
    """A user's function of the crank angle, which is called with the angle as it is."""

    function: Callable[[Any], Any]
    derivative: Callable[[Any], Any] | None = None
    angles: tuple[float, ...] = ()  # nodes
    every: float = TURN  # the angle after which the nodes repeat

    @property
    def period(self) -> float:
        """The angle after which the nodes, and a periodic function, repeat [rad]."""
        return self.every

    @computed_once
    def is_periodic(self) -> bool:
        """True where the function has the same values a period earlier and later, but for rounding."""
        angles = self.every * ((np.arange(PROBES) + 0.25) * GOLDEN % 1.0)
        shifted = angles + self.every * np.array([[0.0], [-1.0], [1.0]])
        values = called(self.function, {"theta": shifted.ravel()}, "the load").reshape(shifted.shape)
        return bool(np.ptp(values, axis=0).max() <= REPEATED * np.abs(values).max())

    @computed_once
    def has_slope(self) -> bool:
        """True where the derivative was given."""
        return self.derivative is not None

    def both(self, theta: Any) -> tuple[Any, Any]:
        """The load and, where it is known, its derivative."""
        at, slope = {"theta": theta}, None
        if self.derivative is not None:
            slope = called(self.derivative, at, "the load's derivative")
        return called(self.function, at, "the load"), slope

    def nodes(self, low: float, high: float, smooth: bool) -> list[float]:
        """The nodes in a range, one at a jump moved by what is rounded to the first angle after it."""
        near = [a for a in self._repeated(self.angles, low, high) if low - BESIDE <= a <= high + BESIDE]
        return [a for a in self._after_jumps(sorted(near)) if low <= a <= high] if near else []

    def _after_jumps(self, angles: list[float]) -> list[float]:
        nodes = np.array(angles)[:, None]
        near = nodes + np.spacing(np.abs(nodes)) * np.arange(-ROUNDED, ROUNDED + 1)
        values = called(self.function, {"theta": near}, "the load")
        change = np.abs(np.diff(values, axis=1))
        at = np.arange(len(angles)), change.argmax(axis=1)
        jumps = change[at] > SAME * np.abs(values).max(axis=1)
        result: list[float] = np.where(jumps, near[:, 1:][at], nodes[:, 0]).tolist()
        return result

    def _content(self) -> str:
        angles = [self.every * k / SAMPLES for k in range(SAMPLES)]
        return f"{[self.value(angle) for angle in angles]} {self.angles} {self.every}"

    def told(self, conversion: Any = None) -> str:
        """The function's name in a line."""
        return f"<load over theta: the function {name_of(self.function)}>"


def name_of(function: Any) -> str:
    """The name of a user's function in messages."""
    return str(getattr(function, "__name__", type(function).__name__))


def called(function: Callable[..., Any], columns: Mapping[str, Any], what: str) -> Any:
    """Call a user's function with numbers or arrays, by position; point by point if it takes no arrays.

    columns  of its arguments, in its order, by their names; where one is not finite the value is NaN
    """
    if all(isinstance(column, float) for column in columns.values()):
        return _one(function, columns, what)
    arrays = np.broadcast_arrays(*(np.asarray(column, float) for column in columns.values()))
    good, shape = np.logical_and.reduce([np.isfinite(array) for array in arrays]), arrays[0].shape
    passed = [*arrays] if good.all() else [array[good] for array in arrays]
    try:
        result = np.asarray(function(*passed))
    except Exception:  # math.sin, or a condition: it takes numbers only; what it says of a number counts
        rows = zip(*(array.reshape(-1).tolist() for array in passed), strict=True)
        points = [_one(function, dict(zip(columns, row, strict=True)), what) for row in rows]
        result = np.array(points).reshape(passed[0].shape)
    if result.dtype.kind not in "fiub" or result.shape not in ((), passed[0].shape):
        places = "angles" if tuple(columns) == ("theta",) else "points"
        raise ValueError(
            f"{what}: a function of {passed[0].size} {places} gave the shape {result.shape} of "
            f"{result.dtype}; expected numbers of the shape {passed[0].shape}"
        )
    result = np.broadcast_to(result.astype(float), passed[0].shape)
    bad = ~np.isfinite(result)
    if bad.any():
        where = listed([named(n, x[bad].flat[0], "g") for n, x in zip(columns, passed, strict=True)])
        value = f"{what}: the function gave {result[bad].flat[0]} at " + where
        raise ValueError(value + ": it must be finite")
    if good.all():
        return result
    whole = np.full(shape, np.nan)
    whole[good] = result
    return whole


def _one(function: Callable[..., Any], columns: Mapping[str, float], what: str) -> float:
    if not all(map(isfinite, columns.values())):
        return nan

    def where() -> Message:
        return listed([named(name, value, "g") for name, value in columns.items()])

    try:
        result = function(*columns.values())
    except Exception as error:
        failed = f"{what}: the function failed at " + where()
        raise ValueError(failed + f": {type(error).__name__}: " + message_of(error)) from error
    try:
        number = float(result)
    except (TypeError, ValueError):
        raise TypeError(
            f"{what}: the function gave {result!r} at " + where() + ": expected a number"
        ) from None
    if not isfinite(number):
        raise ValueError(f"{what}: the function gave {number} at " + where() + ": it must be finite")
    return number


@contextmanager
def naming(name: str) -> Iterator[None]:
    """Errors of a user's function name the input that it is given for."""
    try:
        yield
    except (TypeError, ValueError) as error:
        message = message_of(error)
        if not message.startswith("the load"):
            raise
        raise type(error)(f"{name}: " + message.removeprefix("the load: ")) from error.__cause__
