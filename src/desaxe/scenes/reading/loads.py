"""Loads of a scene that vary with the motion: from a file or from points, over any place."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...loads.load import Load
from ...loads.motors import Motor
from ...loads.tabulated import over_stroke, over_theta, over_Y
from ...support.extras import MissingExtraError
from ..schema import Range, SceneError, Varying, shown
from .values import Value, values_of

RANGE = ("start", "stop", "num", "step")
BOTH = ("kind", "value")  # keys of a table over either
WAYS = ("outward", "inward")
OWN = {
    "over_theta": ("values", "period", "theta", *BOTH),
    "over_Y": (*WAYS, "Y", *BOTH),
    "over_stroke": (*WAYS, "dead_centre", "distance", *BOTH),
}
COLUMNS = {"over_theta": ("values",), "over_Y": WAYS, "over_stroke": WAYS}
UNITS = {"over_theta": "theta", "over_Y": "Y", "over_stroke": "distance"}
MAKE: dict[str, Any] = {"over_theta": over_theta, "over_Y": over_Y, "over_stroke": over_stroke}


def without_objects(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data of a scene with each Load or Motor object replaced by a number, for the schema."""
    return {
        section: {name: 0.0 if isinstance(value, (Load, Motor)) else value for name, value in table.items()}
        if section in ("loads", "steady") and isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }


def varying(key: str, name: str, written: Varying, folder: Path | None) -> Value:
    """The values of a range, or a load that varies with the motion."""
    if any(getattr(written, over) is not None for over in OWN):
        return load_of(key, written, folder)
    given = {n: getattr(written, n) for n in written.__struct_fields__ if getattr(written, n) is not None}
    wrong = next((n for n in given if n not in RANGE), None)
    if wrong is not None:
        raise SceneError(f"{key}.{wrong} = {shown(given[wrong])}: it belongs to {_one_of(wrong)}")
    for end in ("start", "stop"):
        if end not in given:
            raise SceneError(f"{key}.{end} is missing: a range has start, stop, and num or step")
    return values_of(key, name, Range(**given))


def load_of(key: str, written: Varying, folder: Path | None) -> Load:
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
            return _from_file(over, source, given, folder)
        return _from_points(over, source, given)
    except MissingExtraError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"{key}: {error}") from None
    except OSError as error:
        raise SceneError(f"{key}.{over} = {shown(source)}: {error.strerror or error}") from None


def file_of(name: str, folder: Path | None) -> Path:
    """The file of a table: beside the scene, else in the current directory."""
    beside = None if folder is None else folder / name
    return beside if beside is not None and beside.exists() else Path(name)


def _from_file(over: str, name: str, given: dict[str, Any], folder: Path | None) -> Load:
    columns = [column for column in COLUMNS[over] if column in given]
    if columns:
        raise ValueError(f"{columns[0]} beside a file: the file has the values")
    made: Load = MAKE[over].read(file_of(name, folder), **given)
    return made


def _from_points(over: str, points: Sequence[Any], given: dict[str, Any]) -> Load:
    units = [given.pop(name, None) for name in (UNITS[over], "value")]
    first, *others = COLUMNS[over]
    if first not in given:
        rows = [row if isinstance(row, tuple) else (row,) for row in points]
        widths = {len(row) for row in rows}
        if widths - {2, 3 if others else 2} or len(widths) != 1:
            raise ValueError(f"expected points such as [[0, 0], [1.57, -400]], or {first} = [...] beside it")
        points, *columns = (list(column) for column in zip(*rows, strict=True))
        given |= dict(zip((first, *others), columns, strict=False))
    if any(isinstance(point, tuple) for point in points):
        raise ValueError(f"points with their values and {first} = [...] beside them: give one of them")
    given |= {name: _with_unit(given[name], units[1]) for name in COLUMNS[over] if name in given}
    if "period" in given:
        (given["period"],) = _with_unit([given["period"]], units[0])
    made: Load = MAKE[over](_with_unit(points, units[0]), **given)
    return made


def _one_of(key: str) -> str:
    """The loads that a key belongs to."""
    return " or ".join(over for over, keys in OWN.items() if key in keys or key == over)


def _with_unit(column: Sequence[Any], unit: str | None) -> list[Any]:
    """Numbers in a unit; texts carry their own."""
    return [f"{x!r} {unit}" if unit and not isinstance(x, str) else x for x in column]
