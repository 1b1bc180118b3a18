"""Pressures on the slider, a piston, as forces: F_Y = -(p - ambient) area, towards the crank."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log, pi, sqrt
from typing import Any
from warnings import warn

from ..mechanism.inputs import TINY, Input
from ..mechanism.public import FARTHEST, SIZE
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import read
from ..mechanism.slips import SHORTEST, UnitWarning
from ..support.shown import with_unit
from ..units.system import Conversion
from .columns import Column, column_of
from .load import outside

AREA = Input("area", "m^2", "of the piston", TINY, "an area > 0")
BORE = Input("bore", "m", "diameter of the piston", TINY, "a length > 0")
AMBIENT = Input("ambient", "Pa", "pressure on the other side of the piston", 0.0, "a finite pressure >= 0")
PISTON = (AREA, BORE, AMBIENT)
ATMOSPHERE = 1e5  # Pa
OF_PRESSURES = ("over_theta", "over_Y", "over_stroke", "over_V")  # calls that have a piston
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

    def columns(self, pressures: list[Column]) -> list[Column]:
        """Columns of pressures as ones of forces; warns of pressures and an ambient in another unit."""
        self._warn_of_units(pressures)
        return [
            Column([self.force(value) for value in one.values], "N", one.plain, "pressure")
            for one in pressures
        ]

    def _warn_of_units(self, pressures: list[Column]) -> None:
        largest = max((abs(value) for one in pressures for value in one.values), default=0.0)
        plain = all(one.unit is None for one in pressures)
        if plain and 0.0 < largest < VACUUM:
            slip = f"pressures up to {largest:.6g} Pa"
            remedy = f'plain numbers are in pascals, write "{largest:.6g} bar" or another unit'
        elif self.written and 0.0 < self.ambient < VACUUM and largest > PRESSED:
            as_meant = {unit: abs(log(self.written * size / ATMOSPHERE)) for unit, size in UNITS.items()}
            meant = min(as_meant, key=as_meant.__getitem__)
            slip = f"ambient = {self.written:.6g} Pa beside pressures up to {largest:.6g} Pa"
            remedy = f'write ambient = "{self.written:.6g} {meant}"'
        else:
            return
        warn(f"{slip}, surely a slip: {remedy}", UnitWarning, stacklevel=outside())


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
    _warn_of_size(*((AREA, area) if bore is None else (BORE, bore)), size, system)
    less = 0.0 if ambient is None else read(AMBIENT, ambient, name, "a pressure", system)
    in_pascals = isinstance(ambient, (int, float)) and system.of_unit("Pa").si == 1
    return Piston(size, less, ambient if in_pascals else 0.0)


def _warn_of_size(row: Input, written: Any, size: float, system: UnitSystem) -> None:
    """Warn of a piston of this size [m^2] that is almost certainly in another unit."""
    conversion, width = system.of_unit(row.unit), sqrt(4.0 * size / pi)
    small = conversion.si != 1 and width < SHORTEST
    if not isinstance(written, (int, float)) or not (small or FARTHEST < width <= SIZE.beyond):
        return
    other = row.unit if small else row.unit.replace("m", "mm") if conversion.si == 1 else ""
    remedy = f', write {row.name} = "{written:.6g} {other}"' if other else ""
    text = with_unit(f"almost certainly a slip: {row.name} = {written:.6g}", conversion.unit) + remedy
    warn(text, UnitWarning, stacklevel=outside())


def forces_of(
    name: str,
    ways: Mapping[str, Any],
    units: tuple[str, ...],
    plain: Conversion | None,
    piston: Piston | None,
) -> list[Column]:
    """Columns of forces or torques, which pressures on a piston become."""
    columns = []
    for way, values in ways.items():
        what = f"{name}: {way}"
        try:
            columns.append(column_of(what, values, units, plain))
        except ValueError:
            if piston is None and name in OF_PRESSURES and is_pressure(what, values):
                raise needs_piston(what) from None
            raise
    return columns if piston is None else piston.columns(columns)


def needs_piston(what: str) -> ValueError:
    """The error for a pressure without the size of its piston."""
    return ValueError(f'{what}: a pressure needs the size of the piston: area="54 cm2" or bore="83 mm"')


def is_pressure(what: str, values: Any) -> bool:
    """True for numbers with a unit of pressure."""
    try:
        return column_of(what, values, ("Pa",), None).unit is not None
    except (TypeError, ValueError):
        return False
