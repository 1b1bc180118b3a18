"""Loads of a scene that vary with the motion: from a file or from points, over theta or over Y."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..loads.load import Load
from ..loads.tabulated import over_theta, over_Y
from ..support.extras import MissingExtraError
from .schema import Range, SceneError, Varying, shown
from .values import Value, values_of

RANGE = ("start", "stop", "num", "step")
BOTH = ("kind", "value")  # keys of a table over either
OWN = {"over_theta": ("values", "period", "theta", *BOTH), "over_Y": ("outward", "inward", "Y", *BOTH)}
COLUMNS = {"over_theta": ("values",), "over_Y": ("outward", "inward")}


def without_objects(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data of a scene with each Load object replaced by a number, for the schema."""
    return {
        section: {name: 0.0 if isinstance(value, Load) else value for name, value in table.items()}
        if section == "loads" and isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }


def varying(key: str, name: str, written: Varying, folder: Path | None) -> Value:
    """The values of a range, or a load that varies with the motion."""
    if written.over_theta is not None or written.over_Y is not None:
        return load_of(key, written, folder)
    given = {n: getattr(written, n) for n in written.__struct_fields__ if getattr(written, n) is not None}
    wrong = next((n for n in given if n not in RANGE), None)
    if wrong is not None:
        raise SceneError(f"{key}.{wrong} = {shown(given[wrong])}: it belongs to over_theta or over_Y")
    for end in ("start", "stop"):
        if end not in given:
            raise SceneError(f"{key}.{end} is missing: a range has start, stop, and num or step")
    return values_of(key, name, Range(**given))


def load_of(key: str, written: Varying, folder: Path | None) -> Load:
    """The load that a table of a scene stands for.

    folder   of the scene file: a load's file is looked for there first, then in the current directory
    """
    over = "over_theta" if written.over_theta is not None else "over_Y"
    given = {name: getattr(written, name) for name in written.__struct_fields__}
    given = {name: value for name, value in given.items() if value is not None}
    source: Any = given.pop(over)
    wrong = next((name for name in given if name not in OWN[over]), None)
    if wrong is not None:
        raise SceneError(f"{key}.{wrong} = {shown(given[wrong])}: it has no place beside {over}")
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


def _from_file(over: str, name: str, given: dict[str, Any], folder: Path | None) -> Load:
    beside = None if folder is None else folder / name
    path = beside if beside is not None and beside.exists() else Path(name)
    columns = [column for column in COLUMNS[over] if column in given]
    if columns:
        raise ValueError(f"{columns[0]} beside a file: the file has the values")
    return over_theta.read(path, **given) if over == "over_theta" else over_Y.read(path, **given)


def _from_points(over: str, points: Sequence[Any], given: dict[str, Any]) -> Load:
    units = [given.pop(name, None) for name in ("theta" if over == "over_theta" else "Y", "value")]
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
    make = over_theta if over == "over_theta" else over_Y
    made: Load = make(_with_unit(points, units[0]), **given)
    return made


def _with_unit(column: Sequence[Any], unit: str | None) -> list[Any]:
    """Numbers in a unit; texts carry their own."""
    return [f"{x!r} {unit}" if unit and not isinstance(x, str) else x for x in column]
