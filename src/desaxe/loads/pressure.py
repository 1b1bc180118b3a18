"""Pressures on the slider, a piston, as forces: F_Y = -(p - ambient) area, towards the crank."""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Any

from ..mechanism.inputs import TINY, Input
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import read
from ..units.system import Conversion
from .columns import Column, column_of

AREA = Input("area", "m^2", "of the piston", TINY, "an area > 0")
BORE = Input("bore", "m", "diameter of the piston", TINY, "a length > 0")
AMBIENT = Input("ambient", "Pa", "pressure on the other side of the piston", 0.0, "a finite pressure >= 0")


@dataclass(frozen=True)
class Piston:
    """A piston whose cylinder lies beyond it: gas pushes the slider towards the crank."""

    area: float
    ambient: float

    def force(self, pressure: Any) -> Any:
        """The force along Y of a pressure [Pa]."""
        return -(pressure - self.ambient) * self.area

    def functions(self, function: Any, derivative: Any) -> tuple[Any, Any]:
        """A function that returns pressures [Pa], and its derivative, as ones of forces."""
        slope = None if derivative is None else ForceOfPressure(derivative, self.area, 0.0)
        return ForceOfPressure(function, self.area, self.ambient), slope

    def column(self, pressures: Column) -> Column:
        """A column of pressures as one of forces."""
        return Column([self.force(value) for value in pressures.values], "N")


@dataclass(frozen=True)
class ForceOfPressure:
    """A function that returns pressures, or their derivative, as one that returns forces."""

    function: Callable[[Any], Any]
    area: float
    ambient: float

    @property
    def __name__(self) -> str:
        """The name of the function."""
        return getattr(self.function, "__name__", type(self.function).__name__)

    def __call__(self, at: Any) -> Any:
        """The force, or its derivative."""
        return -(self.function(at) - self.ambient) * self.area


def piston_of(name: str, area: Any, bore: Any, ambient: Any, units: UnitSystem | None) -> Piston | None:
    """The piston of the arguments of a load; None where none is given."""
    system = units or SI
    if area is None and bore is None:
        if ambient is not None:
            raise TypeError(f"{name}: ambient is a pressure, which needs area= or bore=")
        return None
    if area is not None and bore is not None:
        raise TypeError(f"{name}: area and bore both say how large the piston is; give one of them")
    if bore is not None:
        size = 0.25 * pi * read(BORE, bore, name, "a length", system) ** 2
    else:
        size = read(AREA, area, name, "an area", system)
    less = 0.0 if ambient is None else read(AMBIENT, ambient, name, "a pressure", system)
    return Piston(size, less)


def forces_of(
    what: str,
    values: Any,
    units: tuple[str, ...],
    plain: Conversion | None,
    piston: Piston | None,
    system: Any,
) -> Column:
    """A column of forces or torques, or of pressures on a piston."""
    if piston is not None:
        return piston.column(column_of(what, values, ("Pa",), pressure_unit(system)))
    try:
        return column_of(what, values, units, plain)
    except ValueError:
        if is_pressure(what, values):
            raise needs_piston(what) from None
        raise


def needs_piston(what: str) -> ValueError:
    """The error for a pressure without the size of its piston."""
    return ValueError(f'{what}: a pressure needs the size of the piston: area="54 cm2" or bore="83 mm"')


def is_pressure(what: str, values: Any) -> bool:
    """True for numbers with a unit of pressure."""
    try:
        return column_of(what, values, ("Pa",), None).unit is not None
    except (TypeError, ValueError):
        return False


def pressure_unit(units: UnitSystem | None) -> Conversion | None:
    """The unit of plain pressures of a machine; None without any."""
    return None if units is None else units.of_unit("Pa")
