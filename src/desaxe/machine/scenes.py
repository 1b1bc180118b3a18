"""A machine from a scene, and a scene from a machine: as data, and as a TOML file."""

import json
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import Any

from ..definitions.tables import tables_of
from ..loads.along_motion import OverSpeed, SumOfLoads
from ..loads.angles import cycle
from ..loads.elements import FREE, LINEAR, QUADRATIC, STIFFNESS, Damper, Spring
from ..loads.load import Load, OverY, TableOverTheta
from ..loads.motors import ROWS, Kloss, OverOmega
from ..loads.resolve import split
from ..loads.stroke import OverStroke
from ..mechanism.closed import TURN
from ..mechanism.inputs import INPUTS
from ..mechanism.own import Definition
from ..mechanism.quantity_units import UnitSystem
from ..scenes.content import Content
from ..scenes.scene import content_of_machine, scene
from ..scenes.schema import SECTIONS, SceneError
from ..support.version import version
from ..support.written import UNSEALED, require_path, sealed, write_whole
from ..units.parse import exact
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


def is_scene(source: Mapping[str, Any]) -> bool:
    """True for a scene as a mapping: it has sections."""
    return any(isinstance(source.get(section), Mapping) for section in SECTIONS)


def inputs_of_scene(
    source: str | PathLike[str] | Mapping[str, Any],
) -> tuple[dict[str, Any], UnitSystem, tuple[Definition, ...]]:
    """The inputs of a scene in SI units, without crank angles, its units and its own quantities."""
    return inputs_of_content(content_of_machine(source))


def inputs_of_content(content: Content) -> tuple[dict[str, Any], UnitSystem, tuple[Definition, ...]]:
    """The inputs of a scene that was read, without crank angles, its units and its own quantities."""
    inputs: dict[str, Any] = {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in content.inputs.items()
        if name != "theta"
    }
    if content.branch == -1:
        inputs["branch"] = -1
    return inputs, content.units, content.definitions


def scene_of(machine: Any, outputs: Any, more: Mapping[str, Any]) -> Any:
    """The scene of a machine; loads that vary with the motion are in it as they are."""
    machine, more = with_inputs(machine, more)
    return scene(_data(machine, outputs, more, split(machine)[1]))


def data_of(
    machine: Any, outputs: Any, more: Mapping[str, Any], path: Path | None = None
) -> tuple[dict[str, Any], dict[Path, str]]:
    """The scene of a machine as plain data, and the texts of files beside `path` with its long tables."""
    machine, more = with_inputs(machine, more)
    texts: dict[Path, str] = {}
    tables = {n: load_table(n, load, machine.units, path, texts) for n, load in split(machine)[1].items()}
    if "steady" in more:
        more = {**more, "steady": {name: _motor_table(value) for name, value in more["steady"].items()}}
    return _data(machine, outputs, more, tables), texts


def write_scene(
    machine: Any, path: str | PathLike[str], outputs: Any, overwrite: bool, more: Mapping[str, Any]
) -> Path:
    """Write the scene of a machine as TOML, once it is known to be right, and its long tables beside it."""
    place = Path(path)
    scene_of(machine, outputs, more)
    data, texts = data_of(machine, outputs, more, place)
    for file in (*texts, place):
        require_path(file, overwrite)
    for file, text in {**texts, place: _toml(data)}.items():
        with write_whole(file, overwrite) as staged:
            marked = sealed(f"# desaxe {version()}, {UNSEALED}\n{text}")
            staged.write_text(marked, encoding="utf-8", newline="\n")
    return place


def with_inputs(machine: Any, more: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The machine with the inputs among further keys of its scene, and the other keys."""
    own = {name: value for name, value in more.items() if name in INPUTS and name != "theta"}
    rest = {name: value for name, value in more.items() if name not in own}
    return (machine.replace(**own) if own else machine), rest


# ---- data ----------------------------------------------------------------------------------------


def _data(machine: Any, outputs: Any, more: Mapping[str, Any], loads: Mapping[str, Any]) -> dict[str, Any]:
    """The scene as data; inputs are texts with units that stand for the same doubles, `loads` as they are."""
    other = dict(more)
    steps = round(720.0 * cycle(split(machine)[1]) / TURN)  # every half degree of a cycle
    theta = other.pop("theta", {"start": 0, "stop": f"{steps / 2:g} deg", "num": steps + 1})
    data: dict[str, Any] = {"title": other.pop("title", "")} if "title" in other else {}
    data["outputs"] = [outputs] if isinstance(outputs, str) else list(outputs)
    if machine.units:
        data["units"] = {name.replace(" ", "_"): unit for name, unit in machine.units.units.items()}
    for section, table in SECTIONS.items():
        names = [name for name in table["properties"] if name in machine]
        values = {name: loads[name] if name in loads else _written(machine, name) for name in names}
        values = {"theta": theta, **values} if section == "motion" else values
        if values:
            data[section] = values
    own = {**tables_of(machine.definitions), **other.pop("quantities", {})}
    return {**data, **({"quantities": own} if own else {}), **other}


def _written(machine: Any, name: str) -> Any:
    """An input as it stands in a file: in the machine's units where that is the same double."""
    value = machine[name]
    if name == "branch":
        return value
    numbers = [_number(machine.units, name, float(part)) for part in getattr(value, "flat", [value])]
    return numbers if hasattr(value, "tolist") else numbers[0]


def _number(units: UnitSystem, name: str, value: float) -> float | str:
    conversion = units.of(name)
    if conversion.si == 1:
        return value
    text = f"{conversion.shown(value):.15g} {conversion.unit}"
    return text if float(exact(name, text, INPUTS[name].unit)) == value else f"{value!r} {INPUTS[name].unit}"


def load_table(name: str, load: Load, units: UnitSystem, path: Path | None, texts: dict[Path, str]) -> Any:
    """The table of a load for a scene at this path, of a sum those of its parts; TypeError for a function.

    Points are in the units of the scene where these stand for the same doubles, else in SI units with all
    their digits, so that the load that is read equals this one; many are the text of a file beside the path.
    """
    if isinstance(load, SumOfLoads) and all(factor == 1.0 for factor, _ in load.terms):
        parts: list[Any] = [load_table(name, part, units, path, texts) for part in load.members]
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


def _motor_table(motor: Any) -> Any:
    """The data of a motor in a scene, in SI units with all its digits; anything else as it is."""
    if isinstance(motor, OverOmega):
        rows = zip(motor.table.knots, motor.table.values, strict=True)
        return {"over_omega": [[f"{x!r} rad/s", f"{y!r} N m"] for x, y in rows], "kind": motor.kind}
    if isinstance(motor, Kloss):
        units = {row.name: "" if row.unit == "1" else f" {row.unit}" for row in ROWS}
        return {"kloss": {name: f"{value!r}{units[name]}" for name, value in motor.numbers.items()}}
    return motor


# ---- TOML ----------------------------------------------------------------------------------------


def _toml(data: Mapping[str, Any]) -> str:
    """Plain data as TOML: values first, then tables, then lists of tables."""
    lines = [f"{key} = {_value(value)}" for key, value in data.items() if not _tables(value)]
    for key, value in data.items():
        head = f"[{key}]" if isinstance(value, Mapping) else f"[[{key}]]"
        for table in _tables(value):
            lines += ["", head, *(f"{_key(name)} = {_value(part)}" for name, part in table.items())]
    return "\n".join(lines).lstrip("\n") + "\n"


def _tables(value: Any) -> Sequence[Mapping[str, Any]]:
    """The tables that a value is, or that are its items; none of any other value."""
    every = [value] if isinstance(value, Mapping) else value
    is_list = isinstance(every, (list, tuple)) and all(isinstance(part, Mapping) for part in every)
    return every if is_list else ()


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() else json.dumps(name)


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {_value(part)}" for name, part in value.items()) + " }"
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Iterable):
        return "[" + ", ".join(_value(part) for part in value) + "]"
    if isinstance(value, (int, float)):
        return repr(value)
    raise SceneError(f"{value!r} cannot stand in a scene file")
