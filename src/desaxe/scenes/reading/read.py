"""From what is written in a scene file to inputs in SI units and names that exist."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

from ...definitions.tables import read_definitions, redefine
from ...evaluation.chunks import chunk_lengths
from ...evaluation.reductions.argument import (
    NO_STATUS,
    Reductions,
    at_with_units,
    names_reduced,
    reductions_of,
)
from ...mechanism.inputs import INPUTS
from ...mechanism.own import Definition, using
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.slips import warn_of_slips
from ...runtime.request import accuracy_of
from ...support.memory import bytes_of
from ...support.toml import read_toml
from ..content import Content
from ..loads import force_of, without_objects
from ..parts.checks import Checks, checks_of
from ..parts.grid import Grid
from ..parts.motor import on_motor
from ..parts.peaks import peak_of
from ..parts.pictures import picture_of
from ..parts.turning import feasibility_of
from ..schema import SECTIONS, SceneError, check, shown
from .values import Value, require_for_grid, require_known, values_of, written_inputs

REQUESTS = ("outputs", "reduce", "peak", "check", "picture", "results")  # keys that are none of a machine


def plain_data(source: str | PathLike[str] | Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene file, or of the same thing in Python (NumPy numbers and arrays are fine)."""
    if isinstance(source, Mapping):
        return {str(name): _plain(value) for name, value in source.items()}
    if not isinstance(source, (str, PathLike)):
        raise TypeError(f"a scene is the path of a TOML file or a mapping, got {type(source).__name__}")
    with _refusing():
        return read_toml(Path(source))


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if hasattr(value, "tolist"):
        return value.tolist()
    return str(value) if isinstance(value, PathLike) else value


@contextmanager
def _refusing(prefix: str = "", shortened: Callable[[str], str] = str) -> Iterator[None]:
    """Turn a ValueError or TypeError of the block into a SceneError with this prefix."""
    try:
        yield
    except SceneError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(prefix + shortened(str(error))) from None


def read(data: Mapping[str, Any], folder: Path | None = None, *, alone: bool = False) -> Content:
    """The content of a scene; SceneError names the first key that is wrong.

    folder   where the scene file is, and perhaps the files of its loads
    alone    the machine and its motor, without the other results that the file requests
    """
    with _refusing():
        units = UnitSystem.read(data.get("units"))
    check(without_objects(data))
    with _refusing("quantities: "):
        own = read_definitions(data.get("quantities", {}))
        redefine(own)
    if alone:
        data = {key: value for key, value in data.items() if key not in REQUESTS}
    elif not any(data.get(key) for key in ("outputs", "peak", "check", "picture", "steady")):
        raise SceneError(
            "the scene requests nothing: give outputs = [...], [[peak]], [[check]], [[picture]] or [steady]"
        )
    with using(own):
        return _content(data, folder, units, own)


def _content(
    data: Mapping[str, Any], folder: Path | None, units: UnitSystem, own: tuple[Definition, ...]
) -> Content:
    inputs = _inputs(data, folder, units)
    warn_of_slips(written_inputs(data), units, 6, inputs)
    if "omega" in inputs and "omega0" in inputs:
        written = f"motion.omega = {shown(data['motion']['omega'])}"
        raise SceneError(f"{written}: give omega0 (the law) or omega (a state), not both")
    outputs = tuple(dict.fromkeys(data.get("outputs", ())))
    for index, name in enumerate(outputs, 1):
        require_known(f"outputs #{index}", name, "omega" in inputs)
    if outputs:
        require_for_grid("outputs", outputs, inputs)

    def each(key: str, one_of: Any) -> list[Any]:
        """The requests of the tables of a list."""
        numbered = enumerate(data.get(key, ()), 1)
        return [one_of(f"{key} #{number}", table, inputs, units) for number, table in numbered]

    checks = tuple(one for some in each("check", checks_of) for one in some)
    steady = [] if "steady" not in data else [on_motor(data["steady"], inputs, units, folder)]
    every = [*[Checks(checks)] * bool(checks), *feasibility_of(inputs), *each("peak", peak_of), *steady]
    every += [*[Grid()] * bool(outputs or data.get("results", {}).get("store")), *each("picture", picture_of)]
    accuracy = data.get("accuracy", "standard")
    with _refusing(f"accuracy = {shown(accuracy)}: ", lambda text: text.partition(": ")[2]):
        accuracy = accuracy_of(accuracy)
    return Content(
        title=data.get("title", ""), outputs=outputs, accuracy=accuracy, inputs=inputs, units=units,
        branch=data.get("mechanism", {}).get("branch", 1), threads=data.get("threads"), definitions=own,
        reduction=_reduction(data.get("reduce", {}), outputs, inputs, units), requests=tuple(every),
        **_storage(data, outputs, inputs),
    )  # fmt: skip


def _storage(
    data: Mapping[str, Any], outputs: tuple[str, ...], inputs: Mapping[str, Value]
) -> dict[str, Any]:
    """The file of results, or the store of a sweep, its chunks, and the memory that they may take."""
    results = data.get("results", {})
    file, store, chunks = (results.get(key) for key in ("data", "store", "chunks"))
    if store is not None and file is not None:
        raise SceneError(f"results.store = {shown(store)}: give a store or a file (results.data), not both")
    if file is not None and not any(data.get(key) for key in ("outputs", "peak", "steady")):
        raise SceneError(f"results.data = {shown(file)}: there is nothing to write, give outputs = [...]")
    if store is not None and not (outputs or data.get("peak")):
        message = "give outputs or [[peak]], or results.data for a steady state alone"
        raise SceneError(f"results.store = {shown(store)}: there is nothing to store; {message}")
    with _refusing("results."):
        memory = bytes_of(results.get("memory"))
        if chunks is not None and outputs:
            reduced = {axis.strip() for key in data.get("reduce", ()) for axis in key.split(",")}
            lengths = {name: len(value) for name, value in inputs.items() if isinstance(value, tuple)}
            chunk_lengths(chunks, {n: size for n, size in lengths.items() if n not in reduced}, 1)
    return {"data": file, "store": store, "chunks": chunks, "memory": memory}


def _reduction(
    written: Mapping[str, Any], outputs: tuple[str, ...], inputs: Mapping[str, Value], units: UnitSystem
) -> Reductions | None:
    """The reduction that a scene asks for instead of the grid."""
    if not written:
        return None
    if not outputs:
        raise SceneError("reduce: there is nothing to reduce, give outputs = [...]")
    if "status" in outputs:
        raise SceneError(f'outputs #{outputs.index("status") + 1} = "status": with [reduce] {NO_STATUS}')
    axes = [name for name, value in inputs.items() if isinstance(value, tuple)]
    table = {axis: _as_tuple(taken) for axis, taken in written.items()}
    with _refusing():
        reduction = reductions_of(at_with_units(table, units), axes, outputs)
        absent = [name for name in names_reduced(table) if name not in outputs]
    if absent:
        raise SceneError(f"reduce: {absent[0]} is not among the outputs")
    return reduction


def _as_tuple(part: Any) -> Any:
    return tuple(map(_as_tuple, part)) if isinstance(part, list) else part


def _inputs(data: Mapping[str, Any], folder: Path | None, units: UnitSystem) -> dict[str, Value]:
    """The inputs of the sections in the order in which they stand in the file."""
    inputs: dict[str, Value] = {}
    for section in data:
        for name, written in data[section].items() if section in SECTIONS else ():
            key = f"{section}.{name}"
            if name in INPUTS and INPUTS[name].unit == "N":
                inputs[name] = force_of(key, name, written, folder, units)
            elif name in INPUTS:
                inputs[name] = values_of(key, name, written, units)
    return inputs
