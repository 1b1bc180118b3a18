"""Makers of tables from columns: places, and the values there, of lists or a file."""

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from ..mechanism.slips import warn_of_slips
from ..support.forks import IMPORTS
from ..units.system import Conversion
from .columns import Column, column_of, places_and_values
from .load import outside
from .maker import Maker, naming
from .pressure import Piston, forces_of, piston_of
from .units import force_unit


class MakeTable(Maker):
    """A maker of tables.

    places  the argument that has them
    ways    those that have the values, of which the first one is required
    over    the quantity that places are, in the SI unit `si`
    values  SI units of the values
    """

    places: ClassVar[str]
    ways: ClassVar[tuple[str, ...]] = ("outward", "inward")
    over: ClassVar[str] = "Y"
    si: ClassVar[str] = "m"
    values: ClassVar[tuple[str, ...]] = ("N",)
    __call__: Callable[..., Any]

    def piston(self, area: Any, bore: Any, ambient: Any) -> Piston | None:
        """The piston on which values are pressures; None without."""
        return piston_of(self.name, area, bore, ambient, self.units)

    def columns(self, places: Any, *values: Any, piston: Piston | None = None) -> list[Column]:
        """The places and the values of each way in SI units; those of a later way may be None."""
        places, first = places_and_values(places, values[0])
        x = column_of(f"{self.name}: {self.places}", places, (self.si,), self.unit(self.over))
        if first is None:
            raise TypeError(f"{self.name}: {self.ways[0]} is missing: the load at each of the {self.places}")
        if x.plain and self.over != "theta" and self.units is None and type(places) in (list, tuple):
            warn_of_slips({self.over: max(x.values, key=abs)}, stacklevel=outside() + 1)
        units, plain = ("Pa",) if piston else self.values, self._plain_unit(piston)
        every = zip(self.ways, (first, *values[1:]), strict=True)
        ways = {way: column for way, column in every if column is not None}
        return [x, *forces_of(self.name, ways, units, plain, piston)]

    def from_file(self, source: Any, units: Mapping[str, str | None], **options: Any) -> Any:
        """The result of the call for columns of a file or a frame; units: of places and values."""
        with IMPORTS:
            from .column_files import Requested, read_columns

        pressures = options.get("area") is not None or options.get("bore") is not None
        values = ("Pa",) if pressures else self.values
        (name, unit), (_, unit_of_values) = units.items()
        requested = [Requested(way.rstrip("s"), unit_of_values, values) for way in self.ways]
        columns = read_columns(source, [Requested(name, unit, (self.si,)), *requested])
        with naming(source):
            return self(**dict(zip((self.places, *self.ways), columns, strict=False)), **options)

    def _plain_unit(self, piston: Piston | None) -> Conversion | None:
        """The unit of plain values: of pressures where there is a piston."""
        if self.units is None:
            return None
        if piston is not None:
            return self.units.of_unit("Pa")
        return self.units.of("torque") if self.values == ("N*m",) else force_unit(self.units)
