"""A scene as the text of a file: its numbers, its loads and motors, TOML."""

import json
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..loads.along_motion import SumOfLoads
from ..loads.load import Load, TableOverTheta
from ..loads.motors import ROWS, Kloss, OverOmega
from ..mechanism.inputs import INPUTS
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.shown import with_unit
from ..units.system import Conversion
from .loads import WAYS, kind_of
from .schema import SceneError

INLINE = 24  # points of a load that stand in the scene itself


# ---- numbers ---------------------------------------------------------------------------------------


def number_text(units: UnitSystem, name: str, value: float) -> float | str:
    """An input: in the unit that it is shown in where that is the same double, else in SI units."""
    conversion = units.of(name)
    if conversion.si == 1:
        return value
    number = same_double(value, conversion)
    if number is None:
        return f"{value!r} {INPUTS[name].unit}"
    return f"{repr(number).removesuffix('.0')} {conversion.unit}"


def same_double(value: float, conversion: Conversion) -> float | None:
    """The shortest of some numbers that are read as this double; None without one."""
    numbers = (float(f"{conversion.shown(value):.{digits}g}") for digits in (15, 17))
    return next((n for n in numbers if float(Fraction(repr(n)) * conversion.si) == value), None)


def _in_unit(
    columns: Sequence[Sequence[float]], conversion: Conversion, si: str
) -> tuple[list[list[float]], str]:
    """Columns of SI numbers in another unit, and that unit; as they are where it has no such doubles."""
    if conversion.si != 1:
        converted = [[same_double(x, conversion) for x in column] for column in columns]
        if all(x is not None for column in converted for x in column):
            return converted, conversion.unit  # type: ignore[return-value]
    return [list(column) for column in columns], si


# ---- loads and motors ------------------------------------------------------------------------------


def load_table(name: str, load: Load, units: UnitSystem, path: Path | None, texts: dict[Path, str]) -> Any:
    """The table of a load for a scene at this path, of a sum those of its parts; TypeError for a function.

    Points are in the units of the scene where these stand for the same doubles, else in SI units with all
    their digits, so that the load that is read equals this one; many are the text of a file beside the path.
    """
    if isinstance(load, SumOfLoads):
        terms = [(factor, load_table(name, part, units, path, texts)) for factor, part in load.terms]
        parts: list[Any] = [part if factor == 1.0 else {**part, "scale": factor} for factor, part in terms]
        return [*parts, *([f"{load.constant!r} N"] if load.constant else [])]
    over, kind = kind_of(load)
    if kind is None:
        raise TypeError(
            f"{name}: {load!r} is not data, and cannot stand in a scene file; give tables, "
            "springs, dampers, or a sum of these"
        )
    if kind.numbers:
        numbers = zip((over, *kind.options), kind.numbers, load.numbers.values(), strict=True)
        return {key: f"{value!r} {row.unit}" for key, row, value in numbers}
    tables, period = load.tables, [load.period] if isinstance(load, TableOverTheta) else []
    si = SI.of(kind.along).unit
    (places, own_period), along = _in_unit([tables[0].knots, period], units.of(kind.along), si)
    columns, unit = [list(table.values) for table in tables], load.unit
    if unit is not None or units.of(name).si != 1:
        columns, unit = _in_unit(columns, units.of(name), unit or INPUTS[name].unit)
    more = {"kind": getattr(load, "kind", None), "dead_centre": getattr(load, "dead_centre", None)}
    more |= {"period": f"{own_period[0]!r} {along}" if period else None, kind.units[0]: along, "value": unit}
    points: Any = [list(row) for row in zip(places, *columns, strict=True)]
    if path is not None and len(points) > INLINE and over != "over_V":
        number = f"_{len(texts) + 1}" if path.with_name(f"{path.stem}_{name}.csv") in texts else ""
        file = path.with_name(f"{path.stem}_{name}{number}.csv")
        heads = [f"{name} {way}" for way in WAYS[: len(columns)]] if over != "over_theta" else [name]
        rows = [[f"{kind.units[0]} [{along}]", *heads], *([*map(repr, row)] for row in points)]
        texts[file], points = "".join(",".join(row) + "\n" for row in rows), file.name
    return {over: points, **{key: value for key, value in more.items() if value is not None}}


def motor_table(motor: Any) -> Any:
    """The data of a motor in a scene, in SI units with all its digits; anything else as it is."""
    if isinstance(motor, OverOmega):
        rows = zip(motor.table.knots, motor.table.values, strict=True)
        return {"over_omega": [[f"{x!r} rad/s", f"{y!r} N m"] for x, y in rows], "kind": motor.kind}
    if isinstance(motor, Kloss):
        return {"kloss": {row.name: with_unit(repr(motor.numbers[row.name]), row.unit) for row in ROWS}}
    return motor


# ---- TOML ------------------------------------------------------------------------------------------


def toml(data: Mapping[str, Any]) -> str:
    """Plain data as TOML: values first, then tables, then lists of tables."""
    lines = [f"{key} = {value_text(value)}" for key, value in data.items() if not _tables(value)]
    for key, value in data.items():
        head = f"[{key}]" if isinstance(value, Mapping) else f"[[{key}]]"
        for table in _tables(value):
            lines += ["", head, *(f"{_key(name)} = {value_text(part)}" for name, part in table.items())]
    return "\n".join(lines).lstrip("\n") + "\n"


def _tables(value: Any) -> Sequence[Mapping[str, Any]]:
    """The tables that a value is, or that are its items; none of any other value."""
    every = [value] if isinstance(value, Mapping) else value
    is_list = isinstance(every, (list, tuple)) and all(isinstance(part, Mapping) for part in every)
    return every if is_list else ()


def value_text(value: Any) -> str:
    """A value as TOML in a line; SceneError for what is no data."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {value_text(part)}" for name, part in value.items()) + " }"
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Iterable):
        return "[" + ", ".join(value_text(part) for part in value) + "]"
    if isinstance(value, (int, float)):
        return repr(value)
    raise SceneError(f"{value!r} cannot stand in a scene file")


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() else json.dumps(name)
