"""Loads of a scene that vary with the motion: from a file or from points, over any place."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...loads.load import Load
from ...loads.motors import Motor
from ...loads.pressure import PISTON
from ...loads.resolve import plain_units
from ...loads.tabulated import over_stroke, over_theta, over_Y
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.read import in_si
from ...support.extras import MissingExtraError
from ..schema import Range, SceneError, Varying, shown
from .values import Value, values_of

RANGE = ("start", "stop", "num", "step")
BOTH = ("kind", "value", *(row.name for row in PISTON))  # keys of a table over either
WAYS = ("outward", "inward")
OWN = {
    "over_theta": ("values", "period", "theta", *BOTH),
    "over_Y": (*WAYS, "Y", *BOTH),
    "over_stroke": (*WAYS, "dead_centre", "distance", *BOTH),
}
COLUMNS = {"over_theta": ("values",), "over_Y": WAYS, "over_stroke": WAYS}
UNITS = {"over_theta": "theta", "over_Y": "Y", "over_stroke": "distance"}
POINTS = {
    "over_theta": "[[0, 0], [1.57, -400]]",
    "over_Y": "[[0.2, 0], [0.37, -400]], or [[0.2, 0, 0], [0.37, -400, -50]] with the way inward",
    "over_stroke": "[[0, -400], [0.005, 0]], or [[0, -400, 0], [0.005, 0, 0]] with the way inward",
}
MAKE: dict[str, Any] = {"over_theta": over_theta, "over_Y": over_Y, "over_stroke": over_stroke}


def without_objects(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data of a scene with each Load or Motor object replaced by a number, for the schema."""
    return {
        section: {name: 0.0 if isinstance(value, (Load, Motor)) else value for name, value in table.items()}
        if section in ("loads", "steady") and isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }


def varying(key: str, name: str, written: Varying, folder: Path | None, units: UnitSystem) -> Value:
    """The values of a range, or a load that varies with the motion."""
    if any(getattr(written, over) is not None for over in OWN):
        return load_of(key, written, folder, units)
    given = {n: getattr(written, n) for n in written.__struct_fields__ if getattr(written, n) is not None}
    wrong = next((n for n in given if n not in RANGE), None)
    if wrong is not None:
        raise SceneError(f"{key}.{wrong} = {shown(given[wrong])}: it belongs to {_one_of(wrong)}")
    for end in ("start", "stop"):
        if end not in given:
            raise SceneError(f"{key}.{end} is missing: a range has start, stop, and num or step")
    return values_of(key, name, Range(**given), units)


def load_of(key: str, written: Varying, folder: Path | None, units: UnitSystem) -> Load:
    """The load that a table of a scene stands for.

    folder   of the scene file: a load's file is looked for there first, then in the current directory
    """
    over = next(over for over in OWN if getattr(written, over) is not None)
    given = {name: getattr(written, name) for name in written.__struct_fields__}
    given = {name: value for name, value in given.items() if value is not None}
    source: Any = given.pop(over)
    wrong = next((name for name in given if name not in OWN[over]), None)
    if wrong is not None:
        raise SceneError(f"{key}.{wrong} = {shown(given[wrong])}: it has no place beside {over}")
    if over == "over_stroke" and "dead_centre" not in given:
        raise SceneError(f'{key}.dead_centre is missing: "outer" or "inner", from which over_stroke measures')
    try:
        if isinstance(source, str):
            return _from_file(over, source, given, folder, units)
        return _from_points(over, source, given, units)
    except MissingExtraError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"{key}: {error}") from None
    except OSError as error:
        raise SceneError(f"{key}.{over} = {shown(source)}: {error.strerror or error}") from None


def require_units_of_file(key: str, name: str, written: Varying, load: Any, units: UnitSystem) -> None:
    """SceneError for plain numbers in a load's file, which are in SI units, in a scene in other ones."""
    over = next((over for over in OWN if isinstance(getattr(written, over), str)), None)
    needed = plain_units(name, load, units) if over and written.period is None else {}
    if over is None or not needed:
        return
    force = needed.pop("value", "") or needed.pop("pressure", "")
    place = next(iter(needed.values()), "")
    both = getattr(load, "inward", None) is not None
    heads = (name,) if over == "over_theta" else WAYS if both else WAYS[:1]
    heading = [(UNITS[over], place), *((head, force) for head in heads)]
    told = ", ".join(f"{head} [{unit}]" if unit else head for head, unit in heading)
    beside = ", ".join(f'{n} = "{unit}"' for n, unit in ((UNITS[over], place), ("value", force)) if unit)
    raise SceneError(
        f"{key}.{over} = {shown(getattr(written, over))}: its plain numbers would be in SI units, but those "
        f"of the scene are not: name the units of its columns by the heading `{told}`, or by {beside} beside "
        "the file"
    )


def file_of(name: str, folder: Path | None) -> Path:
    """The file of a table: beside the scene, else in the current directory."""
    beside = None if folder is None else folder / name
    return beside if beside is not None and beside.exists() else Path(name)


def _from_file(over: str, name: str, given: dict[str, Any], folder: Path | None, units: UnitSystem) -> Load:
    columns = [column for column in COLUMNS[over] if column in given]
    if columns:
        raise ValueError(f"{columns[0]} beside a file: the file has the values")
    for row in PISTON:  # plain numbers of the scene, where those of the file are in SI units
        if isinstance(given.get(row.name), (int, float)):
            given[row.name] = in_si(row, given[row.name], units)
    made: Load = MAKE[over].read(file_of(name, folder), **given)
    return made


def _from_points(over: str, points: Sequence[Any], given: dict[str, Any], units: UnitSystem) -> Load:
    beside = [given.pop(name, None) for name in (UNITS[over], "value")]
    first, *others = COLUMNS[over]
    if first not in given:
        rows = [row if isinstance(row, tuple) else (row,) for row in points]
        _require_points(over, [len(row) for row in rows])
        points, *columns = (list(column) for column in zip(*rows, strict=True))
        given |= dict(zip((first, *others), columns, strict=False))
    if any(isinstance(point, tuple) for point in points):
        raise ValueError(f"points with their values and {first} = [...] beside them: give one of them")
    given |= {name: _with_unit(given[name], beside[1]) for name in COLUMNS[over] if name in given}
    if "period" in given:
        (given["period"],) = _with_unit([given["period"]], beside[0])
    made: Load = type(MAKE[over])(units or None)(_with_unit(points, beside[0]), **given)
    return made


def _require_points(over: str, widths: list[int]) -> None:
    """ValueError for points of other than two numbers, or three with the way inward, all alike."""
    first, *others = COLUMNS[over]
    width = max(widths, key=widths.count, default=0)
    odd = [index for index, own in enumerate(widths) if own != width]
    if not odd and width in (2, 3 if others else 2):
        return
    wrong, rest = (odd[0], f", {'the others' if len(odd) == 1 else 'most'} {width}") if odd else (0, "")
    said = "no points"
    if widths:
        said = f"point {wrong + 1} has {widths[wrong]} number{'' if widths[wrong] == 1 else 's'}{rest}"
    example = f"{POINTS[over]}; or {first} = [...] beside a list of places"
    raise ValueError(f"{over}: {said}: expected points such as {example}")


def _one_of(key: str) -> str:
    """The loads that a key belongs to."""
    return " or ".join(over for over, keys in OWN.items() if key in keys or key == over)


def _with_unit(column: Sequence[Any], unit: str | None) -> list[Any]:
    """Numbers in a unit; texts carry their own."""
    return [f"{x!r} {unit}" if unit and not isinstance(x, str) else x for x in column]
