"""Users' functions in a machine's units, or of pressures, as functions in SI units."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from inspect import Parameter, Signature
from typing import Any

from ..mechanism.quantity_units import SI, UnitSystem
from ..units.system import Conversion
from .along_motion import FunctionOfMotion
from .arguments import by_position, of_one
from .function import name_of
from .pressure import Piston


@dataclass(frozen=True)
class Converted:
    """A function in other units, called with SI units, as one in SI units.

    units   of the arguments
    piston  on which its values are pressures
    """

    function: Callable[..., Any]
    units: tuple[Conversion, ...]
    value: Conversion
    arguments: tuple[str, ...] = ("theta",)
    piston: Piston | None = None

    @property
    def __name__(self) -> str:
        """The name of the function."""
        return name_of(self.function)

    @property
    def __signature__(self) -> Signature:
        return _signature(self.arguments)

    def __call__(self, *columns: Any) -> Any:
        """The value in SI units."""
        shown = (unit.shown(x) for unit, x in zip(self.units, columns, strict=True))
        value = self.value.to_si(self.function(*shown))
        return value if self.piston is None else self.piston.force(value)


def functions_over(
    name: str,
    column: str,
    functions: Sequence[Any],
    units: UnitSystem | None,
    piston: Piston | None = None,
) -> tuple[Any, Any]:
    """A function of a column and its derivative, from those that a maker takes, in SI units.

    functions  what the maker was given: a function, its derivative or None, and derivative=
    """
    function, values, derivative = functions
    if derivative is None and callable(values):  # over_theta(f, derivative)
        derivative, values = values, None
    if not callable(function):
        raise TypeError(f"{name}: derivative= belongs to a function; a table has its own")
    if values is not None:
        raise TypeError(f"{name}: values = {values!r} beside a function; give values or a function")
    if derivative is not None and not callable(derivative):
        raise TypeError(f"{name}: derivative = {derivative!r}: expected a function of {column}")
    function = of_one(name, function)
    slope = None if derivative is None else of_one(name, derivative)
    if units is None and piston is None:
        return function, slope
    own = (units or SI).of(column)
    value = force_unit(units or SI) if piston is None else (units or SI).of_unit("Pa")
    if slope is not None:
        against_vacuum = None if piston is None else replace(piston, ambient=0.0)
        slope = Converted(slope, (own,), value.per([own]), piston=against_vacuum)
    return Converted(function, (own,), value, piston=piston), slope


def load_over(
    name: str,
    column: str,
    functions: Sequence[Any],
    units: UnitSystem | None,
    piston: Piston | None = None,
    centre: str = "",
) -> FunctionOfMotion:
    """A load by a function of a column; the arguments are those of `functions_over`."""
    function, slope = functions_over(name, column, functions, units, piston)
    return FunctionOfMotion(function, (column,), None if slope is None else (slope,), centre)


def function_in_si(name: str, function: Any, arguments: Sequence[str], units: UnitSystem) -> Any:
    """A bare function of named arguments for an input, in a machine's units, as one in SI units."""
    own, value = tuple(units.of(argument) for argument in arguments), units.of(name)
    if all(unit.si == 1 for unit in (*own, value)):
        return function
    return Converted(by_position(function), own, value, tuple(arguments))


def slopes_in_si(function: Any, arguments: Sequence[str], units: UnitSystem) -> Any:
    """A function that returns dT/dtheta, dT/domega, perhaps dT/dt in a machine's units, as one in SI."""
    own, torque = tuple(units.of(argument) for argument in arguments), units.of("torque")
    by = [torque.per([units.of(name)]) for name in ("theta", "omega", "t")]
    if all(unit.si == 1 for unit in (*own, *by)):
        return function

    def slopes(*columns: Any) -> tuple[Any, ...]:
        passed = (unit.shown(x) for unit, x in zip(own, columns, strict=True))
        result = by_position(function)(*passed)
        return tuple(unit.to_si(x) for unit, x in zip(by, result, strict=False))

    slopes.__signature__ = _signature(arguments)  # type: ignore[attr-defined]
    return slopes


def _signature(arguments: Sequence[str]) -> Signature:
    return Signature([Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in arguments])


def force_unit(units: UnitSystem) -> Conversion:
    """The unit of plain forces; ValueError where F_X and F_Y have different ones."""
    one, other = units.of("F_X"), units.of("F_Y")
    if one != other:
        raise ValueError(
            f"a load in a machine whose F_X is in {one.unit} and F_Y in {other.unit}: give texts with units"
        )
    return one
