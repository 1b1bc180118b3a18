"""A machine from a scene, and a scene from a machine: as data, and as a TOML file."""

from collections.abc import Mapping
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
from ..scenes.scene import content_of_machine, scene
from ..scenes.schema import SECTIONS
from ..scenes.written import load_table, motor_table, number_text, toml
from ..support.version import version
from ..support.written import UNSEALED, require_path, sealed, write_whole


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
        more = {**more, "steady": {name: motor_table(value) for name, value in more["steady"].items()}}
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
    for file, text in {**texts, place: toml(data)}.items():
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
    numbers = [number_text(machine.units, name, float(part)) for part in getattr(value, "flat", [value])]
    return numbers if hasattr(value, "tolist") else numbers[0]
