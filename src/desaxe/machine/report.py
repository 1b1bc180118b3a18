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
from ..scenes.document.page import Page, checked, require_document, write_page
from ..scenes.run import compute
from ..support.files import as_path
from ..support.progress import Steps
from .load_tables import load_call, motor_table
from .scenes import with_inputs

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
    page = Page(as_path("path", path), "", tolerances, fluctuation, overwrite)
    require_document(page.path, overwrite)
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        warn_of_slips(machine.in_units(), machine.units)
        scene = machine.scene(_usual(machine) if outputs is None else outputs, **more)
        content = scene.content
        page = checked(page, content, scene.shown_in)
        with using(content.definitions):
            run = compute(content, Steps(0, None), overwrite)
    messages = tuple(str(one.message) for one in heard if one.category.__module__.startswith("desaxe."))
    with using(content.definitions):
        defined = [_definition(one) for one in used_by(content.outputs)]
        calls = _calls(machine, page.path, outputs, tolerances, fluctuation, more)
        page = page._replace(command="\n".join([*defined, calls]), warnings=messages)
        return write_page(page, content, run, scene.shown_in)


def _usual(machine: Mapping[str, Any]) -> tuple[str, ...]:
    """The default outputs: the motion, and forces under masses or loads."""
    if not ("omega0" in machine or "omega" in machine):
        return STANDING
    return (*MOTION, *(FORCES if any(name in machine for name in LOADS) else ()))


def _calls(
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
    options += [f"fluctuation={fluctuation!r}"] if fluctuation != Page._field_defaults["fluctuation"] else []
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
