"""Loads over columns of the motion: functions, springs, dampers, tables over the speed, and sums of loads.

A load of this kind tells its value and its derivative by each column that it needs. By the chain rule the
rest follows: dF/dp is the sum of dF/dcolumn dcolumn/dp.
"""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from ..mechanism.catalogue import has
from ..mechanism.inputs import Input
from ..mechanism.names import LENGTHS
from ..mechanism.quantity_units import SI, si_unit
from ..mechanism.read import in_si
from ..support.computed import computed_once
from ..support.forks import IMPORTS
from ..support.shown import with_unit
from ..units.system import Conversion
from .function import called
from .load import POSITION, Load, OverTheta, OverY
from .stroke import OverStroke
from .table import Arrays, Table, arrays_of

COLUMNS = ("theta", "omega", "Y", "s", "V_C")  # that functions take, besides t
SPEEDS = ("omega0", "omega", "alpha")  # inputs that say how fast the crank turns
MOVING = ("omega", "V_C")  # columns that depend on it
BY: dict[str, tuple[str, ...]] = {  # the parameters that a column depends on
    "theta": ("theta",),
    "omega": ("theta", "omega0", "alpha", "omega"),
    "V_C": ("theta", *LENGTHS, "omega0", "alpha", "omega"),
}
# Central differences of order 8: (distance in steps, weight).
STENCIL = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))
STEP = 2.0**-6  # of the scale of a column
SAMPLES = 97  # by which functions are told apart


class Partials(NamedTuple):
    """The value of a load and its derivatives by the columns of the motion."""

    value: Any
    slopes: dict[str, Any]


class OfMotion(Load):
    """A load over columns of the motion: theta, omega, Y, s, V_C, the position of a dead centre."""

    over = "the motion"
    needs: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[str, ...]:  # type: ignore[override]
        """The parameters that the columns depend on."""
        return tuple(dict.fromkeys(p for c in self.needs for p in BY.get(c, ("theta", *LENGTHS))))

    @property
    def variant(self) -> tuple[Any, ...]:
        """The key of the load in a request."""
        return (*super().variant, self.needs, self.has_ways)

    @property
    def follows_speed(self) -> bool:
        """True where the load depends on how fast the crank turns."""
        return not set(MOVING).isdisjoint(self.needs)

    @property
    def speeds(self) -> tuple[float, ...]:
        """The slider's speeds at which the load has a kink."""
        return ()

    @property
    def has_ways(self) -> bool:
        """True where the direction of the slider matters, `way` of the columns."""
        return False

    @abstractmethod
    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The value and the derivatives at columns of the motion."""

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives of the load by its numbers."""
        return {}

    def by_at(
        self, values: Callable[[list[str]], Mapping[str, Any]], theta: Any, omega: Any
    ) -> dict[str, Any]:
        """The derivatives by its numbers along a motion; values: of names there, by name."""
        motion = values([name for name in self.motion((), True) if name != "omega"])
        way = motion.get("V_C", motion.get("Y_wrt_theta"))
        return self.by({**motion, "theta": theta, "omega": omega, "way": way})

    def motion(self, parameters: Iterable[str], state: bool) -> tuple[str, ...]:
        """The names of the motion from which the load and its derivatives by these parameters follow.

        state  whether omega is an input
        """
        names = list(POSITION) if self.has_ways else []
        for column in self.needs:
            if column == "theta":
                continue
            by = () if column == "omega" and state else parameters
            names += [column, *(n for p in by if has(n := f"{column}_wrt_{p}", state))]
        return tuple(dict.fromkeys(names))

    def total(self, slopes: Mapping[str, Any], parameter: str, motion: Mapping[str, Any]) -> Any:
        """The derivative by a parameter, from those by the columns."""
        moved = {c: 1.0 if c == parameter else motion.get(f"{c}_wrt_{parameter}", 0.0) for c in slopes}
        return sum(slope * moved[column] for column, slope in slopes.items())

    def __call__(self, *columns: Any, **named: Any) -> Any:
        """The load at columns, by name or in the order of `needs`, in the units of the maker's machine."""
        given = dict(zip(self.needs, columns, strict=False)) | named
        missing = [name for name in self.needs if name not in given]
        if missing or len(columns) > len(self.needs):
            raise TypeError(f"{self!r} is called with {', '.join(self.needs)}")
        units = self.shown_in
        for name in self.needs:
            given[name] = in_si(Input(name, si_unit(name), ""), given[name], units)
        now = {"way": 1.0, **{n: _plain(x) for n, x in given.items()}}
        value = self.partials(now).value
        return value if units is None else self.values_in(units).shown(value)


@dataclass(frozen=True, repr=False)
class FunctionOfMotion(OfMotion):
    """A user's function of columns of the motion.

    function    called with the arguments in their order
    derivatives by each argument; None where they are not known
    centre      the dead centre from which an argument Y is measured, as a distance
    """

    function: Callable[..., Any]
    arguments: tuple[str, ...]
    derivatives: tuple[Callable[..., Any], ...] | None = None
    centre: str = ""

    @property
    def over(self) -> str:  # type: ignore[override]
        """The names of the arguments."""
        return ", ".join(self.arguments)

    @property
    def needs(self) -> tuple[str, ...]:  # type: ignore[override]
        """The columns of its arguments, and the dead centre."""
        return (*self.arguments, self.centre) if self.centre else self.arguments

    @property
    def has_slope(self) -> bool:
        """True where the derivatives are known."""
        return self.derivatives is not None

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The function, and its derivatives where they are known."""
        columns, sign = {name: now[name] for name in self.arguments}, None
        if self.centre:
            away = now["Y"] - now[self.centre]
            columns["Y"], sign = abs(away), _sign(away)
        value = called(self.function, columns, "the load")
        slopes = {
            name: called(derivative, columns, "the load's derivative")
            for name, derivative in zip(self.arguments, self.derivatives or (), strict=False)
        }
        if sign is not None and slopes:
            slopes["Y"] = slopes["Y"] * sign
            slopes[self.centre] = -slopes["Y"]
        return Partials(value, slopes)

    def differentiated(self, scales: Mapping[str, float]) -> "FunctionOfMotion":
        """The load with derivatives by differences; scales: of the columns."""
        if self.derivatives is not None:
            return self
        by = tuple(
            Difference(self.function, k, STEP * (scales.get(name) or 1.0))
            for k, name in enumerate(self.arguments)
        )
        return replace(self, derivatives=by)

    def _content(self) -> str:
        name = getattr(self.function, "__qualname__", type(self.function).__name__)
        try:
            at = [0.37 + 0.013 * k for k in range(SAMPLES)]
            values = [self.function(*(x * (1.0 + n) for n in range(len(self.arguments)))) for x in at]
        except Exception:  # outside of its domain: the name is all that is known
            values = []
        return f"{name} {self.arguments} {self.centre} {values}"

    def told(self, conversion: Any = None) -> str:
        """The function's name in a line."""
        name = getattr(self.function, "__name__", type(self.function).__name__)
        over = f"the distance from {self.centre}" if self.centre else self.over
        return f"<load over {over}: the function {name}>"


@dataclass(frozen=True)
class Difference:
    """The derivative of a function by one of its arguments, by differences."""

    function: Callable[..., Any]
    number: int
    step: float

    def __call__(self, *columns: Any) -> Any:
        """The derivative."""
        total, names = 0.0, [f"argument {k}" for k in range(len(columns))]
        for distance, weight in STENCIL:
            for side in (1.0, -1.0):
                moved = [x + (k == self.number) * side * distance * self.step for k, x in enumerate(columns)]
                values = called(self.function, dict(zip(names, moved, strict=True)), "the load")
                total = total + side * weight * values
        return total / self.step


@dataclass(frozen=True, repr=False)
class OverSpeed(OfMotion):
    """A table over the slider's speed, held beyond its ends."""

    table: Table
    kind: str
    unit: str | None = None
    plain: tuple[str, ...] = field(default=(), compare=False)

    call = "over_V"
    over = "V_C"
    needs = ("V_C",)

    @property
    def tables(self) -> tuple[Table, ...]:  # type: ignore[override]
        """The table."""
        return (self.table,)

    def arrays(self) -> Arrays:
        """The knots and coefficients of the table."""
        return arrays_of(self.table)

    @property
    def speeds(self) -> tuple[float, ...]:
        """The speeds of the table."""
        return self.table.knots

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The table at the speed."""
        value, slope = self.table.both(now["V_C"])
        return Partials(value, {"V_C": slope})

    def _content(self) -> str:
        return f"over V_C {self.table!r}"

    def told(self, conversion: Any = None) -> str:
        """The table in a line."""
        return f"<load over V_C: {len(self.table.knots)} points, {self.kind}>"


@dataclass(frozen=True, repr=False)
class Spring(OfMotion):
    """A spring between slider and frame: F = -stiffness (Y - free)."""

    stiffness: float
    free: float
    plain: tuple[str, ...] = field(default=(), compare=False)

    call = "spring"
    over = "Y"
    needs = ("Y",)
    unit = "N"

    @property
    def numbers(self) -> Mapping[str, float]:  # type: ignore[override]
        """The stiffness and the position of the slider at which it is free."""
        return {"stiffness": self.stiffness, "free": self.free}

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The force, and its derivative by Y."""
        stretch = now["Y"] - self.free
        return Partials(-self.stiffness * stretch, {"Y": 0.0 * stretch - self.stiffness})

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives by stiffness and free position."""
        stretch = now["Y"] - self.free
        return {"stiffness": -stretch, "free": 0.0 * stretch + self.stiffness}

    def _content(self) -> str:
        return f"spring {self.stiffness!r} {self.free!r}"

    def told(self, conversion: Any = None) -> str:
        """The spring in a line."""
        units = self.shown_in or SI
        stiffness, free = (_told(x, units.of(f"F_Y.{name}")) for name, x in self.numbers.items())
        return f"<spring: {stiffness}, free at {free}>"


@dataclass(frozen=True, repr=False)
class Damper(OfMotion):
    """A damper between slider and frame: F = -linear V_C - quadratic |V_C| V_C."""

    linear: float
    quadratic: float
    plain: tuple[str, ...] = field(default=(), compare=False)

    call = "damper"
    over = "V_C"
    needs = ("V_C",)
    unit = "N"

    @property
    def numbers(self) -> Mapping[str, float]:  # type: ignore[override]
        """Both coefficients."""
        return {"linear": self.linear, "quadratic": self.quadratic}

    @property
    def speeds(self) -> tuple[float, ...]:
        """The speed 0 of a quadratic damper, whose slope has a kink there."""
        return (0.0,) if self.quadratic else ()

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The force, and its derivative by V_C."""
        V = now["V_C"]
        size = abs(V)
        return Partials(
            -(self.linear + self.quadratic * size) * V, {"V_C": -self.linear - 2.0 * self.quadratic * size}
        )

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives by both coefficients."""
        V = now["V_C"]
        return {"linear": -V, "quadratic": -abs(V) * V}

    def _content(self) -> str:
        return f"damper {self.linear!r} {self.quadratic!r}"

    def told(self, conversion: Any = None) -> str:
        """The damper in a line."""
        units = self.shown_in or SI
        parts = [_told(x, units.of(f"F_Y.{name}")) for name, x in self.numbers.items() if x]
        return f"<damper: {' and '.join(parts) or 'none'}>"


@dataclass(frozen=True, repr=False)
class SumOfLoads(OfMotion):
    """Multiples of loads of any kind, and a number."""

    terms: tuple[tuple[float, Load], ...]
    constant: float = 0.0

    @computed_once
    def needs(self) -> tuple[str, ...]:
        """The columns of all members."""
        return tuple(dict.fromkeys(column for _, load in self.terms for column in needs_of(load)))

    @property
    def variant(self) -> tuple[Any, ...]:
        """The key of the load in a request: its members have a table each, or are functions."""
        return (*super().variant, *(load.variant for load in self.members))

    @property
    def members(self) -> tuple[Load, ...]:
        """The loads that are summed."""
        return tuple(load for _, load in self.terms)

    @property
    def unit(self) -> str | None:  # type: ignore[override]
        """The unit of those that have one."""
        return next((load.unit for load in self.members if load.unit is not None), None)

    @property
    def has_slope(self) -> bool:
        """True where the derivatives of all are known."""
        return all(load.has_slope for load in self.members)

    @property
    def has_ways(self) -> bool:
        """True with a load over the slider's position."""
        return any(isinstance(load, OverY) for load in self.members)

    @property
    def speeds(self) -> tuple[float, ...]:
        """The speeds of the members."""
        return tuple(sorted({v for m in self.members if isinstance(m, OfMotion) for v in m.speeds}))

    @computed_once
    def _named(self) -> dict[str, tuple[int, str]]:
        """The names of numbers, each with its member and its name there."""
        result: dict[str, tuple[int, str]] = {}
        for k, load in enumerate(self.members):
            for name in load.numbers:
                same = sum(n == name or n.startswith(f"{name}_") for n in result)
                result[f"{name}_{same + 1}" if same else name] = k, name
        return result

    @property
    def numbers(self) -> Mapping[str, float]:  # type: ignore[override]
        """The numbers of all members; a second spring has stiffness_2."""
        return {name: self.members[k].numbers[own] for name, (k, own) in self._named.items()}

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The sums."""
        value: Any = self.constant
        slopes: dict[str, Any] = {}
        for factor, load in self.terms:
            part = partials_of(load, now)
            value = value + factor * part.value
            for column, slope in part.slopes.items():
                slopes[column] = slopes.get(column, 0.0) + factor * slope
        return Partials(value, slopes)

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives by the numbers of all members."""
        parts = [load.by(now) if isinstance(load, OfMotion) else {} for load in self.members]
        return {name: self.terms[k][0] * parts[k][own] for name, (k, own) in self._named.items()}

    def _content(self) -> str:
        return f"{self.constant!r} {[(factor, load.identity) for factor, load in self.terms]}"

    def told(self, conversion: Any = None) -> str:
        """All members in a line."""
        parts = [("" if f == 1.0 else f"{f:g} ") + load.told(conversion)[1:-1] for f, load in self.terms]
        return f"<{' + '.join([*parts, *([f'{self.constant:g}'] if self.constant else [])])}>"


def needs_of(load: Load) -> tuple[str, ...]:
    """The columns of the motion that a load of any kind needs."""
    if isinstance(load, OfMotion):
        return load.needs
    if isinstance(load, OverTheta):
        return ("theta",)
    return ("Y", load.centre) if load.centre else ("Y",)


def partials_of(load: Load, now: Mapping[str, Any]) -> Partials:
    """The value and derivatives of a load of any kind; `way` of the columns is the slider's direction."""
    if isinstance(load, OfMotion):
        return load.partials(now)
    if isinstance(load, OverTheta):
        value, slope = load.both(now["theta"])
        return Partials(value, {} if slope is None else {"theta": slope})
    assert isinstance(load, OverY)
    value, slope = load.both(load.along(now), now["way"])
    if not isinstance(load, OverStroke):
        return Partials(value, {"Y": slope})
    slope = slope * _sign(now["Y"] - now[load.centre])
    return Partials(value, {"Y": slope, load.centre: -slope})


def members_of(loads: Iterable[Load]) -> list[Load]:
    """The loads, and in place of a sum its members."""
    return [
        part
        for load in loads
        for part in (members_of(load.members) if isinstance(load, SumOfLoads) else [load])
    ]


def speeds_of(loads: Iterable[Load]) -> list[float]:
    """The slider's speeds at which loads have kinks."""
    return sorted({v for load in loads if isinstance(load, OfMotion) for v in load.speeds})


def with_derivatives(loads: Mapping[str, Load], inputs: Mapping[str, Any]) -> dict[str, Load]:
    """The loads, with the derivatives of functions of the motion by differences where they are not known.

    inputs  numbers or arrays, which say how large the columns are
    """

    def largest(name: str) -> float:
        return max(map(abs, _flat(inputs.get(name, 0.0))), default=0.0)

    reach, speed = largest("AB"), largest("omega") or largest("omega0")
    scales = {"theta": 1.0, "omega": speed, "Y": reach, "s": reach, "V_C": reach * speed}
    return {name: _differentiated(load, scales) for name, load in loads.items()}


def _differentiated(load: Load, scales: Mapping[str, float]) -> Load:
    if isinstance(load, FunctionOfMotion):
        return load.differentiated(scales)
    if isinstance(load, SumOfLoads):
        return replace(load, terms=tuple((f, _differentiated(m, scales)) for f, m in load.terms))
    return load


def _flat(value: Any) -> list[float]:
    return value.reshape(-1).tolist() if hasattr(value, "reshape") else [float(value or 0.0)]


def _told(number: float, unit: Conversion) -> str:
    return with_unit(f"{unit.shown(number):g}", unit.unit)


def _plain(x: Any) -> Any:
    return float(x) if isinstance(x, (int, float)) else x


def _sign(x: Any) -> Any:
    if isinstance(x, float):
        return 1.0 if x >= 0.0 else -1.0
    with IMPORTS:
        import numpy as np

    return np.where(x >= 0.0, 1.0, -1.0)
