"""From what is written in a scene file to inputs in SI units and names that exist."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, cast

from ...definitions.tables import read_definitions, redefine
from ...evaluation.chunks import chunk_lengths
from ...evaluation.reductions.argument import (
    NO_STATUS,
    Reductions,
    at_with_units,
    names_reduced,
    reductions_of,
)
from ...loads.load import Load
from ...loads.resolve import settled
from ...mechanism.inputs import INPUTS
from ...mechanism.own import Definition, using
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.slips import warn_of_slips
from ...runtime.request import accuracy_of
from ...scenes import schema
from ...support.memory import bytes_of
from ...support.toml import read_toml
from ..content import Content
from ..parts.checks import checks_of
from ..parts.motor import on_motor
from ..parts.pictures import picture_of
from ..schema import SECTIONS, SceneError, shown
from .loads import require_units_of_file, varying, without_objects
from .needs import require_for_grid, require_known
from .peaks import peak_of
from .values import Value, values_of
from .written import written_inputs

PICTURES = (".png", ".svg", ".pdf")
DATA = (".nc", ".zarr", ".csv", ".xlsx", ".npz")


def plain_data(source: str | PathLike[str] | Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene file, or of the same thing in Python (NumPy numbers and arrays are fine)."""
    if isinstance(source, Mapping):
        return {str(name): _plain(value) for name, value in source.items()}
    if not isinstance(source, (str, PathLike)):
        raise TypeError(f"a scene is the path of a TOML file or a mapping, got {type(source).__name__}")
    try:
        return read_toml(Path(source))
    except ValueError as error:
        raise SceneError(str(error)) from None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if hasattr(value, "tolist"):
        return value.tolist()
    return str(value) if isinstance(value, PathLike) else value


def read(data: Mapping[str, Any], folder: Path | None = None) -> Content:
    """The content of a scene; SceneError names the first key that is wrong.

    folder   where the scene file is, and perhaps the files of its loads
    """
    units = _units(data)
    file = schema.decoded(without_objects(data))
    own = _defined(data.get("quantities", {}))
    with using(own):
        return _content(data, file, folder, units, own)


def _content(
    data: Mapping[str, Any],
    file: schema.SceneFile,
    folder: Path | None,
    units: UnitSystem,
    own: tuple[Definition, ...],
) -> Content:
    inputs = _inputs(data, file, folder, units)
    warn_of_slips(written_inputs(data), units, 5, inputs)
    branch = file.mechanism.branch
    if "omega" in inputs and "omega0" in inputs:
        raise SceneError(
            f"motion.omega = {inputs['omega']}: give omega0 (the law) or omega (a state), not both"
        )
    outputs = tuple(dict.fromkeys(file.outputs))
    for index, name in enumerate(outputs, 1):
        require_known(f"outputs #{index}", name, "omega" in inputs)
    if outputs:
        require_for_grid("outputs", outputs, inputs)
    if not (outputs or file.peak or file.check or file.picture or file.steady):
        raise SceneError(
            "the scene requests nothing: give outputs = [...], [[peak]], [[check]], [[picture]] or [steady]"
        )
    _require_names(file)
    checks = [
        c
        for index, table in enumerate(file.check, 1)
        for c in checks_of(f"check #{index}", table, inputs, units)
    ]
    peaks = [peak_of(f"peak #{index}", table, inputs, units) for index, table in enumerate(file.peak, 1)]
    pictures = [
        picture_of(f"picture #{index}", table, inputs, units) for index, table in enumerate(file.picture, 1)
    ]
    motor = (
        None
        if file.steady is None
        else on_motor(file.steady, data["steady"]["torque"], inputs, units, folder)
    )
    store, chunks, memory = _storage(file, outputs, inputs)
    return Content(
        title=file.title, outputs=outputs, accuracy=_accuracy(file.accuracy), branch=branch, inputs=inputs,
        reduction=_reduction(file, outputs, inputs, units), threads=file.threads, units=units,
        checks=tuple(checks), peaks=tuple(peaks), pictures=tuple(pictures), steady=motor,
        data=file.results.data, store=store, chunks=chunks, memory=memory, definitions=own,
    )  # fmt: skip


def _storage(
    file: schema.SceneFile, outputs: tuple[str, ...], inputs: Mapping[str, Value]
) -> tuple[str | None, Any, int | None]:
    """The store of a sweep, its chunks, and the memory that they may take."""
    results = file.results
    if results.store is not None and results.data is not None:
        raise SceneError(
            f"results.store = {shown(results.store)}: give a store or a file (results.data), not both"
        )
    if results.store is not None and not (outputs or file.peak):
        told = "give outputs or [[peak]], or results.data for a steady state alone"
        raise SceneError(f"results.store = {shown(results.store)}: there is nothing to store; {told}")
    try:
        memory = bytes_of(results.memory)
    except ValueError as error:
        raise SceneError(f"results.{error}") from None
    if results.chunks is not None and outputs:
        axes = {name: len(value) for name, value in inputs.items() if isinstance(value, tuple)}
        reduced = {axis.strip() for key in file.reduce for axis in key.split(",")}
        try:
            chunk_lengths(results.chunks, {n: s for n, s in axes.items() if n not in reduced}, 1)
        except (ValueError, TypeError) as error:
            raise SceneError(f"results.{error}") from None
    return results.store, results.chunks, memory


def _units(data: Mapping[str, Any]) -> UnitSystem:
    """The units of the scene."""
    try:
        return UnitSystem.read(data.get("units"))
    except (ValueError, TypeError) as error:
        raise SceneError(str(error)) from None


def _defined(tables: Mapping[str, Any]) -> tuple[Definition, ...]:
    """Register the scene's own quantities."""
    try:
        own = read_definitions(tables)
        redefine(own)
    except (ValueError, TypeError) as error:
        raise SceneError(f"quantities: {error}") from None
    return own


def _accuracy(written: str | float) -> str:
    """The accuracy of a scene, by name or by a bound on the error."""
    try:
        return accuracy_of(written)
    except ValueError as error:
        raise SceneError(f"accuracy = {shown(written)}: {str(error).partition(': ')[2]}") from None


def _reduction(
    file: schema.SceneFile, outputs: tuple[str, ...], inputs: Mapping[str, Value], units: UnitSystem
) -> Reductions | None:
    """The reduction that a scene asks for instead of the grid."""
    if not file.reduce:
        return None
    if not outputs:
        raise SceneError("reduce: there is nothing to reduce, give outputs = [...]")
    if "status" in outputs:
        raise SceneError(f'outputs #{outputs.index("status") + 1} = "status": with [reduce] {NO_STATUS}')
    axes = [name for name, value in inputs.items() if isinstance(value, tuple)]
    try:
        found = reductions_of(at_with_units(file.reduce, units), axes, outputs)
        absent = [name for name in names_reduced(file.reduce) if name not in outputs]
    except (ValueError, TypeError) as error:
        raise SceneError(str(error)) from None
    if absent:
        raise SceneError(f"reduce: {absent[0]} is not among the outputs")
    return found


def _require_names(file: schema.SceneFile) -> None:
    """SceneError for a file name whose suffix is no known format."""
    data = file.results.data
    if data is not None and not data.endswith(DATA):
        ends = ", ".join(DATA)
        raise SceneError(f"results.data = {shown(data)}: its name must end in one of {ends}")
    if data is not None and not (file.outputs or file.peak or file.steady):
        raise SceneError(f"results.data = {shown(data)}: there is nothing to write, give outputs = [...]")
    for index, picture in enumerate(file.picture, 1):
        if not picture.file.lower().endswith(PICTURES):
            allowed = ", ".join(PICTURES)
            raise SceneError(f"picture #{index}.file = {shown(picture.file)}: must end in one of {allowed}")


def _inputs(
    data: Mapping[str, Any], file: schema.SceneFile, folder: Path | None, units: UnitSystem
) -> dict[str, Value]:
    """The inputs of the sections in the order in which they stand in the file."""
    order = [(section, name) for section in data if section in SECTIONS for name in data[section]]
    found: dict[str, Value] = {}
    for section, name in order:
        key, written = f"{section}.{name}", getattr(getattr(file, section), name)
        if name not in INPUTS:
            continue
        if isinstance(data[section][name], Load):
            found[name] = _settled(key, name, data[section][name], units)
        elif isinstance(written, schema.Varying):
            load = varying(key, name, written, folder, units)
            require_units_of_file(key, name, written, load, units)
            found[name] = _settled(key, name, load, units)
        else:
            found[name] = values_of(key, name, written, units)
    return found


def _settled(key: str, name: str, load: Value, units: UnitSystem) -> Value:
    """A load whose numbers mean what they do in the scene; SceneError where they could be others."""
    try:
        return cast(Value, settled(name, load, units))
    except ValueError as error:
        raise SceneError(f"{key}: {str(error).removeprefix(f'{name}: ')}") from None
