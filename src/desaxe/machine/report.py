"""`Machine.report`: everything about a machine as one page to hand on."""

import warnings
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ..loads.load import Load
from ..mechanism.names import LOADS
from ..mechanism.own import Definition, used_by, using
from ..mechanism.slips import warn_of_slips
from ..scenes.document.content import DocumentContext, document_of, require_drawing
from ..scenes.document.spread import read_tolerances
from ..scenes.document.write import require_document, write_document
from ..scenes.run import compute
from ..support.files import as_path
from ..support.progress import Steps
from .load_tables import load_call, motor_table
from .scenes import with_inputs

FLUCTUATION = 0.03  # of the speed, for the flywheel
MOTION, FORCES, STANDING = ("Y", "V_C", "a_C"), ("T_in", "N_C"), ("Y", "phi")


def write_report(
    machine: Any,
    path: str | PathLike[str],
    outputs: Any,
    tolerances: Mapping[str, Any],
    fluctuation: float,
    overwrite: bool,
    more: Mapping[str, Any],
) -> Path:
    """Compute the scene of a machine and write its document; the path."""
    if "results" in more:
        raise TypeError("report: no results are written but the page: leave results out")
    place = as_path("path", path)
    require_drawing()
    require_document(place, overwrite)
    names = _usual(machine) if outputs is None else outputs
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        warn_of_slips(machine.in_units(), machine.units)
        scene = machine.scene(names, **more)
        content = scene.content
        halves = read_tolerances(content, scene.shown_in, tolerances)
        with using(content.definitions):
            found = compute(content, Steps(0, None), overwrite)
    told = tuple(str(one.message) for one in heard if one.category.__module__.startswith("desaxe."))
    with using(content.definitions):
        defined = [_definition(one) for one in used_by(content.outputs)]
        command = _command(machine, place, outputs, tolerances, fluctuation, more)
        asked = DocumentContext("\n".join([*defined, command]), told, halves, fluctuation)
        return write_document(document_of(content, found, scene.shown_in, asked), place, overwrite)


def _usual(machine: Mapping[str, Any]) -> tuple[str, ...]:
    """The default outputs: the motion, and forces under masses or loads."""
    if not ("omega0" in machine or "omega" in machine):
        return STANDING
    return (*MOTION, *(FORCES if any(name in machine for name in LOADS) else ()))


def _command(
    machine: Any,
    path: Path,
    outputs: Any,
    tolerances: Mapping[str, Any],
    fluctuation: float,
    more: Mapping[str, Any],
) -> str:
    """The calls that make the report again; loads that are functions stand as their repr."""
    machine, rest = with_inputs(machine, more)
    if "steady" in rest:
        rest["steady"] = {name: motor_table(value) for name, value in rest["steady"].items()}
    inputs = [f"{name}={_written(machine, name, value)}" for name, value in machine.in_units().items()]
    units = [f"units={machine.units!r}"] if machine.units else []
    options = [] if outputs is None else [f"outputs={outputs!r}"]
    options += [f"tolerances={dict(tolerances)!r}"] if tolerances else []
    options += [f"fluctuation={fluctuation!r}"] if fluctuation != FLUCTUATION else []
    options += [f"{name}={value!r}" for name, value in rest.items()]
    made = f"machine = desaxe.Machine({', '.join([*inputs, *units])})"
    return f"{made}\nmachine.report({', '.join([repr(str(path)), *options])})"


def _definition(one: Definition) -> str:
    options = {"unit": one.unit, "meaning": one.meaning, **dict(one.constants)}
    return f"desaxe.define({one.name!r}, {one.expression!r}, **{options!r})"


def _written(machine: Any, name: str, value: Any) -> str:
    if isinstance(value, Load):
        return load_call(name, value, machine.units)
    return repr(value.tolist()) if hasattr(value, "tolist") else repr(value)
