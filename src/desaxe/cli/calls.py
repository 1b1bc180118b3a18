"""`desaxe CALL`: every call that answers a question, with names and inputs as words.

A call of `calls.txt` is a method of `Machine` of the same name. To add one, add its line there.
"""

import argparse
import re
from collections.abc import Iterator, Mapping
from functools import partial
from importlib import import_module
from inspect import Parameter, signature
from pathlib import Path
from typing import Any

from ..mechanism.inputs import INPUTS
from ..mechanism.names import LOADS
from ..support.shown import with_unit
from ..support.template import file_text
from .answers import require_target, written
from .parser import FLAG, JSON, OVERWRITE, SIGNS, Command, Facts, Option
from .words import UsageError, arguments_of, name_of

# Call -> what it answers, in a line of `desaxe --help`, and the words of an example.
CALLS = {
    name: (about, example)
    for name, about, example in (row.split(" | ") for row in file_text(__package__, "calls.txt").splitlines())
}
SAME = {"point": "evaluate"}
MISSING = re.compile(r"(\w+)\(\) missing \d+ required (?:keyword-only|positional) arguments?: (.*)")
OF_MEASURES = {"solve": "where.{}=VALUE", "optimize": "keep.{0}=LOW:HIGH, or minimize={0}, maximize={0}"}
OVER = {"fit": "over=AB,BC"}  # where the bounds of an input may be left out
PLUS_MINUS = "dx.plus_minus(value, tolerance)"
MOTOR = "torque.over_omega=motor.csv, or torque.kloss.breakdown_torque=40 and so on, or [steady] of a scene"
ON_MOTOR = ("steady", "simulate")  # calls that take a motor


OPTIONS = (
    Option("words", "quantities and inputs", {"nargs": "*", "metavar": "QUANTITY | NAME=VALUE"}),
    Option("--machine", "path of a TOML file with all other inputs", {"metavar": "SCENE"}),
    Option("--units", 'units of plain numbers and of the answer: "mm, deg, rpm"'), JSON,
    Option("--csv", "print a table as CSV", FLAG),
    Option("-o", ".json, .csv, .nc, .zarr, .xlsx, .npz, or a picture: .png, .svg, .pdf",
           {"metavar": "FILE", "dest": "file"}), OVERWRITE,
)  # fmt: skip
LIST = Option("--list", "print all quantities, units, meanings", FLAG)


def call_commands() -> Iterator[Command]:
    """A command for each call of the table."""
    for name, (about, example) in CALLS.items():
        options = [*OPTIONS, LIST] if name in ("evaluate", "point") else OPTIONS
        yield Command(name, about, _call, options, partial(_facts, name, example), "call")


def _facts(name: str, example: str) -> Facts:
    """The options of a call, which are those of its function, in its longer help."""
    every = signature(_function(name)).parameters.values()
    options = [
        p.name for p in every if p.kind is Parameter.KEYWORD_ONLY and p.name not in (*INPUTS, "sliders")
    ]
    loads = [f"{load:8} {INPUTS[load].meaning}" for load in LOADS]
    listed = ", ".join(options) or "none"
    return {"OPTIONS": listed, "LOADS": loads, "SIGNS": SIGNS, "EXAMPLE": f"desaxe {name} {example}"}


def _function(name: str) -> Any:
    """The public function of a call."""
    return getattr(import_module("desaxe"), SAME.get(name, name))


def _call(options: argparse.Namespace) -> int:
    if vars(options).get("list"):
        return _list()
    call = SAME.get(options.command, options.command)
    if options.file is not None:
        require_target(Path(options.file), options.overwrite)
    names, arguments = arguments_of(options.words)
    pair = next((name for name in arguments if ":" in name), None)
    if pair is not None and call in OF_MEASURES:
        raise UsageError(f"{pair}: a measure is given as {OF_MEASURES[call].format(pair)}")
    quantities = _quantities(call, names)
    machine, arguments = _machine(call, options, arguments)
    try:
        answer = _answer(call, machine, quantities, arguments)
    except (TypeError, ValueError) as error:
        raise UsageError(_as_words(str(error))) from error
    is_table = options.csv or str(options.file).endswith((".csv", ".xlsx"))
    written(answer, options, _columns(machine, arguments, answer) if is_table else {})
    return 0


def _answer(call: str, machine: Any, quantities: list[Any], arguments: dict[str, Any]) -> Any:
    """The answer; of `evaluate` with the status, where the inputs are enough to know it."""
    if call != "evaluate" or "quality" in arguments:
        return getattr(machine, call)(*quantities, **arguments)
    from ..loads.absent import warn_that_nothing_acts

    (names,) = quantities
    inputs = {**arguments, **(machine if hasattr(machine, "in_units") else {})}
    try:
        answer = machine.evaluate(list(dict.fromkeys([*names, "status"])), **arguments)
    except TypeError:
        answer = machine.evaluate(names, **arguments)
    if "sliders" not in inputs:
        warn_that_nothing_acts(names, inputs)
    return answer


def _columns(machine: Any, arguments: Mapping[str, Any], answer: Any) -> dict[str, Any]:
    """The arrays among the inputs, by name, with their units."""
    from ..mechanism.quantity_units import SI
    from ..mechanism.read import read_array

    is_machine = hasattr(machine, "in_units")
    system = machine.units if is_machine else SI
    arrays = {n: read_array(INPUTS[n], value, system) for n, value in arguments.items()
              if n in INPUTS and isinstance(value, list)}  # fmt: skip
    if is_machine:
        arrays |= {n: value for n, value in machine.items() if hasattr(value, "tolist") and n not in arrays}
    units = {n: system.of(n) for n in arrays if n not in answer}
    return {n: (unit.shown(arrays[n]), unit.unit) for n, unit in units.items()}


def _list() -> int:
    """Print all quantities with their units and meanings."""
    from ..mechanism.catalogue import quantities
    from ..support.shown import printed
    from ..support.text_table import table

    rows = [
        (row.name, printed(row.unit) or "1", f"{row.meaning} ({row.source})" if row.source else row.meaning)
        for row in quantities().values()
    ]
    print("\n".join(table(rows)))
    return 0


def _as_words(message: str) -> str:
    """A message of the call in terms of the command line."""
    missing = MISSING.match(message)
    if missing:
        names = missing[2].replace("'", "")
        word = OVER.get(missing[1], "over.AB=LOW:HIGH") if names == "over" else "NAME=VALUE"
        motor = f"; a motor as {MOTOR}" if "torque" in names else ""
        return f"desaxe {missing[1]}: missing {names}; each is given as {word}{motor}"
    message = message.replace(PLUS_MINUS, '"NAME=VALUE +- TOLERANCE"')
    head, call, _ = message.partition("; call it for each of them")
    return f"{head}: give one, as NAME=VALUE" if call else message


def _machine(call: str, options: argparse.Namespace, arguments: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The machine with the single inputs among the arguments, of which a call takes those that it needs.

    Values at a point in SI units need none, and no NumPy: they come from the function itself.
    """
    if call == "evaluate" and options.machine is None and options.units is None:
        return import_module("desaxe"), arguments
    from ..machine.crankshaft import Crankshaft
    from ..machine.machine import Machine
    from ..machine.methods import NOT_FILLED, OF_RANGES
    from ..mechanism.ranges import between
    from ..scenes.reading.read import plain_data

    if options.machine is None:
        machine = Machine(units=options.units)
        arguments = _with_motor(call, arguments, machine.units)
    else:
        kind = Crankshaft if "crankshaft" in plain_data(options.machine) else Machine
        machine = kind.read(options.machine, units=options.units)
        arguments = _with_motor(call, arguments, machine.units)
        arguments = {**_motor(call, options.machine, arguments, "sliders" in machine), **arguments}
    if call in OF_RANGES:
        pairs = [name for name, value in arguments.items() if name in INPUTS and type(value) is tuple]
        arguments |= {name: between(*arguments[name]) for name in pairs}
    if call in NOT_FILLED:
        return machine, arguments
    of_machine = {*INPUTS, "branch"} - {"theta"}
    single = {k: v for k, v in arguments.items() if k in of_machine and not isinstance(v, (list, tuple))}
    return machine.replace(**single), {k: v for k, v in arguments.items() if k not in single}


def _quantities(call: str, names: list[str]) -> list[Any]:
    """The positional arguments of a call: its names, its one name, its file, or none."""
    parameters = signature(_function(call)).parameters
    first = next(iter(parameters.values()))
    if first.kind is not Parameter.POSITIONAL_OR_KEYWORD:
        if names:
            such = f", such as names={','.join(names)}" if "names" in parameters else ""
            raise UsageError(f"{names[0]}: desaxe {call} takes no quantity, only NAME=VALUE{such}")
        return []
    what = "quantity" if first.name.startswith("name") else first.name
    if not names and first.default is Parameter.empty:
        raise UsageError(
            f"which {what}? desaxe {call} --help has an example, desaxe evaluate --list all quantities"
        )
    if first.name != "names" and len(names) != 1:
        raise UsageError(f"desaxe {call} takes one {what}, got {len(names)}")
    measures = [name_of(name) for name in names] if what == "quantity" else names
    return [measures if first.name == "names" else measures[0]] if names else []


def _with_motor(call: str, arguments: dict[str, Any], units: Any) -> dict[str, Any]:
    """The arguments with the motor that `torque.kloss.NAME=VALUE`, `torque.over_omega=FILE` stand for."""
    from ..scenes.loads import motor_of

    torque = arguments.get("torque") if call in ON_MOTOR else None
    first = torque
    while isinstance(first, (list, tuple)):  # kloss:40,0.15
        first = first[0]
    if isinstance(first, str) and first[:1].isalpha():
        raise UsageError(f"torque = {first}: a motor is given as {MOTOR}")
    if not isinstance(torque, dict):
        return arguments
    table: dict[str, Any] = {}
    for key, value in torque.items():
        kind, dot, name = key.partition(".")
        entries = table.setdefault(kind, {}) if dot else table
        if not isinstance(entries, dict):
            raise UsageError(f"torque.{key}: torque.{kind} has a value already")
        entries[name or kind] = value
    return {**arguments, "torque": motor_of("torque", table, None, units)}


def _motor(call: str, path: str, arguments: Mapping[str, Any], several: bool) -> dict[str, Any]:
    """The [steady] of the scene, for the calls that ask for a torque; a flywheel is of `steady` alone.

    A flywheel or a fluctuation among the arguments stands for both of the scene's: each asks for the other.
    """
    from ..machine.crankshaft import content_of_shaft
    from ..scenes.parts.motor import ROWS
    from ..scenes.scene import content_of_machine

    if call not in ON_MOTOR:
        return {}
    content = content_of_shaft(path)[0] if several else content_of_machine(path)
    steady = next(iter(content.of("steady")), None)
    if steady is None:
        return {}
    if call == "simulate" or any(name in arguments for name in ROWS):
        return {"torque": steady.torque}
    open_axes = [name for name in steady.axes if name not in arguments]
    wheel = next((name for name in open_axes if name in ROWS), None)
    if wheel is not None and len(open_axes) > 1:
        lists = " and ".join(open_axes)
        raise UsageError(
            f"desaxe steady: the scene has lists of {lists}: give {wheel} as NAME=VALUE; "
            "desaxe run computes all of their combinations"
        )
    wheels = {name: value for name, value in {**steady.fixed, **steady.axes}.items() if name in ROWS}
    texts = {name: _in_si(ROWS[name].unit, value) for name, value in wheels.items()}
    return {"torque": steady.torque, **texts}


def _in_si(unit: str, value: Any) -> Any:
    """SI numbers as texts, which mean the same in a machine of any units."""
    return [_in_si(unit, one) for one in value] if isinstance(value, tuple) else with_unit(repr(value), unit)
