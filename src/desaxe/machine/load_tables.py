"""Loads that vary with the motion as the data of a scene: points in it, or a CSV file beside it."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

from ..loads.along_motion import FunctionOfMotion
from ..loads.load import Load, OverTheta, OverY, TableOverTheta
from ..loads.motors import ROWS, Kloss, OverOmega
from ..loads.stroke import OverStroke
from ..mechanism.inputs import INPUTS
from ..mechanism.quantity_units import SI, UnitSystem
from ..units.system import Conversion

INLINE = 24  # points that stand in the scene itself
PLACES = {"over_theta": "theta", "over_Y": "Y", "over_stroke": "distance"}  # keys of the unit of places


class LoadTable(NamedTuple):
    """The data of a load in a scene, and the file of its points, if they are many."""

    data: dict[str, Any]
    file: Path | None = None
    text: str = ""


def load_table(name: str, load: Load, scene: Path, units: UnitSystem = SI, inline: bool = False) -> LoadTable:
    """The table of a load for a scene at this path; TypeError for a load that is a function.

    Points are in the units of the scene where these stand for the same doubles, else in SI units with all
    their digits, so that the load that is read equals this one.
    """
    more: dict[str, Any] = {"kind": load.kind} if isinstance(load, (TableOverTheta, OverY)) else {}
    if isinstance(load, TableOverTheta):
        over, first, place, si = "over_theta", "theta", "theta", "rad"
        heads = [name]
    elif isinstance(load, OverY):
        over, first, place, si = "over_Y", "Y", "Y", "m"
        if isinstance(load, OverStroke):
            over, first = "over_stroke", "distance"
            more["dead_centre"] = load.dead_centre
        heads = [f"{name} {way}" for way in ("outward", "inward")[: len(load.tables)]]
    else:
        what = "a function" if isinstance(load, (OverTheta, FunctionOfMotion)) else f"{load!r}"
        raise TypeError(f"{name}: {what} is not data, and cannot stand in a scene file; give a table")
    period = [load.period] if isinstance(load, TableOverTheta) else []
    (places, own_period), along = _in_unit([load.tables[0].knots, period], units.of(place), si)
    ways, unit = [list(table.values) for table in load.tables], load.unit
    if unit is not None or units.of(name).si != 1:
        ways, unit = _in_unit(ways, units.of(name), unit or INPUTS[name].unit)
    if own_period:
        more["period"] = own_period[0] if along == si else f"{own_period[0]!r} {along}"
    more |= {first: along} | ({"value": unit} if unit is not None else {})
    rows = list(zip(places, *ways, strict=True))
    if inline or len(rows) <= INLINE:
        return LoadTable({over: [list(row) for row in rows], **more})
    file = scene.with_name(f"{scene.stem}_{name}.csv")
    lines = [",".join([f"{first} [{along}]", *heads]), *(",".join(map(repr, row)) for row in rows)]
    return LoadTable({over: file.name, **more}, file, "\n".join(lines) + "\n")


def load_call(name: str, load: Load, units: UnitSystem) -> str:
    """The call of Python that makes a load again; its repr where it is a function."""
    try:
        data = load_table(name, load, Path("scene.toml"), units, inline=True).data
    except TypeError:
        return repr(load)
    over, rows = next(iter(data.items()))
    along, value = (data.pop(key, None) for key in (PLACES[over], "value"))
    columns = [
        [f"{x!r} {unit}" if unit else x for x in column]
        for column, unit in zip(zip(*rows, strict=True), (along, value, value), strict=False)
    ]
    options = [f"{key}={option!r}" for key, option in data.items() if key != over]
    return f"desaxe.{over}({', '.join([*map(repr, columns), *options])})"


def _in_unit(
    columns: Sequence[Sequence[float]], conversion: Conversion, si: str
) -> tuple[list[list[float]], str]:
    """Columns of SI numbers in another unit, and that unit; as they are where it has no such doubles."""
    if conversion.si != 1:
        shown = [[_written(x, conversion) for x in column] for column in columns]
        if all(x is not None for column in shown for x in column):
            return shown, conversion.unit  # type: ignore[return-value]
    return [list(column) for column in columns], si


def _written(value: float, conversion: Conversion) -> float | None:
    """The shortest of some numbers that are read as this double; None without one."""
    for digits in (15, 17):
        number = float(f"{conversion.shown(value):.{digits}g}")
        if float(Fraction(repr(number)) * conversion.si) == value:
            return number
    return None


def motor_table(motor: Any) -> Any:
    """The data of a motor in a scene, in SI units with all its digits; anything else as it is."""
    if isinstance(motor, OverOmega):
        rows = zip(motor.table.knots, motor.table.values, strict=True)
        return {"over_omega": [[f"{x!r} rad/s", f"{y!r} N m"] for x, y in rows], "kind": motor.kind}
    if isinstance(motor, Kloss):
        units = {row.name: row.unit for row in ROWS}
        told = {name: f"{value!r} {units[name]}" for name, value in motor.numbers.items()}
        return {"kloss": {name: text.removesuffix(" 1") for name, text in told.items()}}
    return motor
