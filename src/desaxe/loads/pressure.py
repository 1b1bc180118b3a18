"""Pressures on the slider, a piston, as forces: F_Y = -(p - ambient) area, towards the crank."""

from dataclasses import dataclass
from math import log, pi
from typing import Any
from warnings import warn

from ..mechanism.inputs import TINY, Input
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import read
from ..mechanism.slips import UnitWarning
from ..units.system import Conversion
from .columns import Column, column_of
from .load import outside

AREA = Input("area", "m^2", "of the piston", TINY, "an area > 0")
BORE = Input("bore", "m", "diameter of the piston", TINY, "a length > 0")
AMBIENT = Input("ambient", "Pa", "pressure on the other side of the piston", 0.0, "a finite pressure >= 0")
PISTON = (AREA, BORE, AMBIENT)
ATMOSPHERE = 1e5  # Pa
OF_PRESSURES = ("over_theta", "over_Y", "over_stroke")  # calls that have a piston
VACUUM, PRESSED = 1e3, 1e4  # Pa: nobody works against a vacuum below the one with pressures above the other
UNITS = {"bar": 1e5, "kPa": 1e3, "MPa": 1e6, "psi": 6894.757}


@dataclass(frozen=True)
class Piston:
    """A piston whose cylinder lies beyond it: gas pushes the slider towards the crank."""

    area: float
    ambient: float
    written: float = 0.0  # a plain number of pascals that stood for the ambient pressure

    def force(self, pressure: Any) -> Any:
        """The force along Y of a pressure [Pa]."""
        return (self.ambient - pressure) * self.area

    def column(self, pressures: Column) -> Column:
        """A column of pressures as one of forces; warns of an ambient pressure far below them."""
        self._warn_of_ambient(max(map(abs, pressures.values), default=0.0))
        return Column([self.force(value) for value in pressures.values], "N", pressures.plain, "pressure")

    def _warn_of_ambient(self, largest: float) -> None:
        if not (self.written and 0.0 < self.ambient < VACUUM and largest > PRESSED):
            return
        as_meant = {unit: abs(log(self.written * size / ATMOSPHERE)) for unit, size in UNITS.items()}
        meant = min(as_meant, key=as_meant.__getitem__)
        warn(
            f"ambient = {self.written:.6g} Pa beside pressures up to {largest:.6g} Pa, surely a slip: "
            f'write ambient = "{self.written:.6g} {meant}"',
            UnitWarning,
            stacklevel=outside(),
        )


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
        width = read(BORE, bore, name, "a length", system)
        size = 0.25 * pi * width * width
    else:
        size = read(AREA, area, name, "an area", system)
    less = 0.0 if ambient is None else read(AMBIENT, ambient, name, "a pressure", system)
    in_pascals = isinstance(ambient, (int, float)) and system.of_unit("Pa").si == 1
    return Piston(size, less, ambient if in_pascals else 0.0)


def forces_of(
    what: str, values: Any, units: tuple[str, ...], plain: Conversion | None, piston: Piston | None
) -> Column:
    """A column of forces or torques, which pressures on a piston become."""
    try:
        column = column_of(what, values, units, plain)
    except ValueError:
        if piston is None and what.startswith(OF_PRESSURES) and is_pressure(what, values):
            raise needs_piston(what) from None
        raise
    return column if piston is None else piston.column(column)


def needs_piston(what: str) -> ValueError:
    """The error for a pressure without the size of its piston."""
    return ValueError(f'{what}: a pressure needs the size of the piston: area="54 cm2" or bore="83 mm"')


def is_pressure(what: str, values: Any) -> bool:
    """True for numbers with a unit of pressure."""
    try:
        return column_of(what, values, ("Pa",), None).unit is not None
    except (TypeError, ValueError):
        return False
