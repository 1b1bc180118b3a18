"""A machine from a scene, and a scene from a machine."""

import json
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ..definitions.tables import tables_of
from ..loads.angles import cycle
from ..loads.resolve import split
from ..mechanism.closed import TURN
from ..mechanism.inputs import INPUTS
from ..mechanism.own import Definition
from ..mechanism.quantity_units import UnitSystem
from ..scenes.content import Content
from ..scenes.scene import scene
from ..scenes.schema import SECTIONS, SceneError
from ..support.version import version
from ..support.written import UNSEALED, require_path, sealed, write_whole
from ..units.parse import exact
from .load_tables import load_table, motor_table


def is_scene(source: Mapping[str, Any]) -> bool:
    """True for a scene as a mapping: it has sections."""
    return any(isinstance(source.get(section), Mapping) for section in SECTIONS)


def inputs_of_scene(
    source: str | PathLike[str] | Mapping[str, Any],
) -> tuple[dict[str, Any], UnitSystem, tuple[Definition, ...]]:
    """The inputs of a scene in SI units, without crank angles, its units and its own quantities."""
    return inputs_of_content(scene(source).content)


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


def write_scene(
    machine: Any, path: str | PathLike[str], outputs: Any, overwrite: bool, more: Mapping[str, Any]
) -> Path:
    """Write the scene of a machine as TOML, once it is known to be right, and its long tables beside it."""
    place = Path(path)
    machine, more = with_inputs(machine, more)
    loads = split(machine)[1]
    scene(_data(machine, outputs, more, loads))
    tables = {name: load_table(name, load, place, machine.units) for name, load in loads.items()}
    texts = {table.file: table.text for table in tables.values() if table.file is not None}
    if "steady" in more:
        more = {**more, "steady": {name: motor_table(value) for name, value in more["steady"].items()}}
    data = _data(machine, outputs, more, {name: table.data for name, table in tables.items()})
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


def _data(machine: Any, outputs: Any, more: Mapping[str, Any], loads: Mapping[str, Any]) -> dict[str, Any]:
    """The scene as data; inputs are texts with units that stand for the same doubles, `loads` as they are."""
    other = dict(more)
    theta = other.pop("theta") if "theta" in other else _angles(machine)
    data: dict[str, Any] = {"title": other.pop("title", "")} if "title" in other else {}
    data["outputs"] = [outputs] if isinstance(outputs, str) else list(outputs)
    if machine.units:
        data["units"] = {name.replace(" ", "_"): unit for name, unit in machine.units.units.items()}
    for section, table in SECTIONS.items():
        values = {
            name: loads[name] if name in loads else _written(machine, name)
            for name in table["properties"]
            if name in machine
        }
        if section == "motion":
            values = {"theta": theta, **values}
        if values:
            data[section] = values
    own = {**tables_of(machine.definitions), **other.pop("quantities", {})}
    return {**data, **({"quantities": own} if own else {}), **other}


def _angles(machine: Any) -> dict[str, Any]:
    """Every half degree of a cycle."""
    steps = round(720.0 * cycle(split(machine)[1]) / TURN)
    return {"start": 0, "stop": f"{steps / 2:g} deg", "num": steps + 1}


def _written(machine: Any, name: str) -> Any:
    value = machine[name]
    if name == "branch":
        return value
    if hasattr(value, "tolist"):
        return [_number(machine.units, name, part) for part in value.tolist()]
    return _number(machine.units, name, value)


def _number(units: UnitSystem, name: str, value: float) -> float | str:
    """A number in SI units as it stands in a file: in the machine's units where that is the same double."""
    conversion = units.of(name)
    value = float(value)
    if conversion.si == 1:
        return value
    text = f"{conversion.shown(value):.15g} {conversion.unit}"
    return text if float(exact(name, text, INPUTS[name].unit)) == value else f"{value!r} {INPUTS[name].unit}"


def _toml(data: Mapping[str, Any]) -> str:
    """Plain data as TOML: values first, then tables, then lists of tables."""
    lines = [f"{key} = {_value(value)}" for key, value in data.items() if not _is_table(value)]
    for key, value in data.items():
        if isinstance(value, Mapping):
            lines += ["", f"[{key}]", *(f"{_key(name)} = {_value(part)}" for name, part in value.items())]
        elif _is_table(value):
            for table in value:
                lines += [
                    "",
                    f"[[{key}]]",
                    *(f"{_key(name)} = {_value(part)}" for name, part in table.items()),
                ]
    return "\n".join(lines).lstrip("\n") + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, (list, tuple))
        and len(value) > 0
        and all(isinstance(part, Mapping) for part in value)
    )


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
