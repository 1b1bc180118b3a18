"""A load as the table of a scene file, from which an equal load is read."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..loads.along_motion import OverSpeed, SumOfLoads
from ..loads.elements import FREE, LINEAR, QUADRATIC, STIFFNESS, Damper, Spring
from ..loads.load import Load, OverY, TableOverTheta
from ..loads.stroke import OverStroke
from ..mechanism.inputs import INPUTS
from ..mechanism.quantity_units import UnitSystem
from ..units.system import Conversion

INLINE = 24  # points of a load that stand in the scene itself
WAYS = ("outward", "inward")
# A load of a table -> its key, that of the unit of its places, what they are and their SI unit.
PLACES: dict[type, tuple[str, str, str, str]] = {
    TableOverTheta: ("over_theta", "theta", "theta", "rad"),
    OverStroke: ("over_stroke", "distance", "Y", "m"),
    OverY: ("over_Y", "Y", "Y", "m"),
    OverSpeed: ("over_V", "V_C", "V_C", "m/s"),
}
ELEMENTS: dict[type, Any] = {
    Spring: {"spring": STIFFNESS, "free": FREE},
    Damper: {"damper": LINEAR, "quadratic": QUADRATIC},
}


def load_table(name: str, load: Load, units: UnitSystem, path: Path | None, texts: dict[Path, str]) -> Any:
    """The table of a load for a scene at this path, of a sum those of its parts; TypeError for a function.

    Points are in the units of the scene where these stand for the same doubles, else in SI units with all
    their digits, so that the load that is read equals this one; many are the text of a file beside the path.
    """
    if isinstance(load, SumOfLoads):
        terms = [(factor, load_table(name, part, units, path, texts)) for factor, part in load.terms]
        parts: list[Any] = [part if factor == 1.0 else {**part, "scale": factor} for factor, part in terms]
        return [*parts, *([f"{load.constant!r} N"] if load.constant else [])]
    if type(load) in ELEMENTS:
        rows = zip(ELEMENTS[type(load)].items(), load.numbers.values(), strict=True)
        return {key: f"{value!r} {row.unit}" for (key, row), value in rows}
    if type(load) not in PLACES:
        raise TypeError(
            f"{name}: {load!r} is not data, and cannot stand in a scene file; give tables, "
            "springs, dampers, or a sum of these"
        )
    over, key, place, si = PLACES[type(load)]
    period = [load.period] if isinstance(load, TableOverTheta) else []
    (places, own_period), along = _in_unit([load.tables[0].knots, period], units.of(place), si)
    columns, unit = [list(table.values) for table in load.tables], load.unit
    if unit is not None or units.of(name).si != 1:
        columns, unit = _in_unit(columns, units.of(name), unit or INPUTS[name].unit)
    more = {"kind": getattr(load, "kind", None), "dead_centre": getattr(load, "dead_centre", None)}
    more |= {"period": f"{own_period[0]!r} {along}" if own_period else None, key: along, "value": unit}
    points: Any = [list(row) for row in zip(places, *columns, strict=True)]
    if path is not None and len(points) > INLINE and over != "over_V":
        number = f"_{len(texts) + 1}" if path.with_name(f"{path.stem}_{name}.csv") in texts else ""
        file = path.with_name(f"{path.stem}_{name}{number}.csv")
        heads = [f"{name} {way}" for way in WAYS[: len(columns)]] if over != "over_theta" else [name]
        lines = [",".join([f"{key} [{along}]", *heads]), *(",".join(map(repr, row)) for row in points)]
        texts[file], points = "\n".join(lines) + "\n", file.name
    return {over: points, **{key: value for key, value in more.items() if value is not None}}


def _in_unit(
    columns: Sequence[Sequence[float]], conversion: Conversion, si: str
) -> tuple[list[list[float]], str]:
    """Columns of SI numbers in another unit, and that unit; as they are where it has no such doubles."""
    if conversion.si != 1:
        shown = [[_same_double(x, conversion) for x in column] for column in columns]
        if all(x is not None for column in shown for x in column):
            return shown, conversion.unit  # type: ignore[return-value]
    return [list(column) for column in columns], si


def _same_double(value: float, conversion: Conversion) -> float | None:
    """The shortest of some numbers that are read as this double; None without one."""
    numbers = (float(f"{conversion.shown(value):.{digits}g}") for digits in (15, 17))
    return next((n for n in numbers if float(Fraction(repr(n)) * conversion.si) == value), None)
