"""`desaxe CALL`: every call that answers a question, with names and inputs as words.

A call of this table is a method of `Machine` of the same name. To add one, add its line.
"""

import argparse
import re
from functools import partial
from pathlib import Path
from typing import Any

from .answers import require_target, written
from .parser import add_command
from .words import UsageError, arguments_of

# Call -> what it answers, in a line of `desaxe --help`, and the words of an example.
CALLS = {
    "evaluate": ("values at points", "a_C,V_C theta=0deg:90deg:4 ec=10mm AB=125mm BC=350mm omega0=1500rpm"),
    "grid": ("values over a grid", "a_C theta=0deg:360deg:73 ec=0mm,10mm AB=125mm BC=350mm omega0=157"),
    "peak": ("extreme value over a turn", "a_C ec=10mm AB=125mm BC=350mm omega0=1500rpm"),
    "events": ("stroke, dead centres, time ratio, pressure angles", "ec=10mm AB=125mm BC=350mm"),
    "feasibility": ("margin, limit angles, kind of motion", "ec=10mm AB=125mm BC=350mm"),
    "crossings": (
        "angles at which a quantity passes through a value",
        "V_C value=0.05 ec=10mm AB=125mm BC=350mm omega0=157",
    ),
    "solve": ("an input for a value of the design", "over.AB=10mm:60mm stroke=50mm ec=5mm BC=150mm"),
    "inverse": ("crank angle for a position of the slider", "Y=400mm ec=10mm AB=125mm BC=350mm"),
    "drive": ("torque, power, flywheel over a cycle", "ec=0 AB=125mm BC=350mm omega0=1500rpm m_slider=1kg"),
    "harmonics": ("Fourier series over a cycle", "a_C orders=4 ec=0 AB=125mm BC=350mm omega0=157"),
    "counterweight": ("balance of the shaking force", "ec=0 AB=125mm BC=350mm omega0=157 m_slider=1kg"),
    "tolerance": (
        "scatter of a quantity by its inputs' tolerances",
        'a_C theta=60deg "ec=10 mm +- 0.1 mm" AB=125mm BC=350mm omega0=157',
    ),
    "enclose": (
        "guaranteed range of a quantity",
        "V_C theta=60deg ec=9.9mm:10.1mm AB=125mm BC=350mm omega0=157",
    ),
    "optimize": (
        "best design within ranges",
        "minimize=absmax:a_C over.BC=300mm:400mm keep.stroke=250mm:260mm ec=10mm AB=125mm omega0=157",
    ),
    "synthesize": ("designs of a stroke and a time ratio", "stroke=100mm time_ratio=1.1 BC=200mm"),
    "design_map": ("quantities over designs", "stroke ec=0mm:20mm:3 AB=100mm,120mm BC=350mm"),
    "simulate": ("motion under a torque", "torque=20 t_end=1s ec=0 AB=125mm BC=350mm I_crank=0.1"),
    "steady": (
        "steady motion on a motor: the [steady] torque of a scene, or a number",
        "--machine examples/motor.toml flywheel_inertia=3",
    ),
}
MISSING = re.compile(r"(\w+)\(\) missing \d+ required keyword-only arguments?: (.*)")
PLUS_MINUS = "dx.plus_minus(value, tolerance)"
SCENE = ", the torque also by [steady] of a scene"
HELP = """\
NAME=VALUE: an input, as `desaxe point --help` lists them, or an option of the call. VALUE is a
number (SI units and radians, or those of --units or of the scene), a number with its unit,
FIRST:LAST:COUNT, a list with commas, or LOW:HIGH; NAME.KEY=VALUE is an entry of a table.

options: {options}

example:
  desaxe {name} {example}
"""


def add_calls(commands: Any) -> None:
    """Add a command for each call of the table."""
    for name, (meaning, example) in CALLS.items():
        text = partial(_help, name, example)
        parser = add_command(commands, name, meaning, _call, text=text)
        parser.set_defaults(call=name)
        parser.add_argument("words", nargs="*", metavar="QUANTITY | NAME=VALUE", help="quantities and inputs")
        parser.add_argument("--machine", metavar="SCENE", help="path of a TOML file with all other inputs")
        parser.add_argument("--units", help='units of plain numbers and of the answer: "mm, deg, rpm"')
        parser.add_argument("--json", action="store_true", help="print JSON")
        parser.add_argument("--csv", action="store_true", help="print a table as CSV")
        parser.add_argument("-o", metavar="FILE", dest="file", help=".json, .csv, .nc, .zarr, .xlsx or .npz")
        parser.add_argument(
            "--overwrite", action="store_true", help="replace a file that desaxe did not write"
        )


def _help(name: str, example: str) -> str:
    """The longer help of a call, with the names of its options."""
    from inspect import Parameter, signature

    from ..machine.methods import import_function
    from ..mechanism.inputs import INPUTS

    every = signature(import_function(name)).parameters.values()
    options = [p.name for p in every if p.kind is Parameter.KEYWORD_ONLY and p.name not in INPUTS]
    return HELP.format(name=name, example=example, options=", ".join(options) or "none")


def _call(options: argparse.Namespace) -> int:
    if options.file is not None:
        require_target(Path(options.file), options.overwrite)
    names, arguments = arguments_of(options.words)
    machine, arguments = _machine(options, arguments)
    quantities = _quantities(options.call, names)
    try:
        answer = getattr(machine, options.call)(*quantities, **arguments)
    except (TypeError, ValueError) as error:
        raise UsageError(_as_words(str(error))) from error
    written(answer, options)
    return 0


def _as_words(message: str) -> str:
    """A message of the call in terms of the command line."""
    missing = MISSING.match(message)
    if missing:
        names = missing[2].replace("'", "")
        scene = SCENE if "torque" in names else ""
        return f"desaxe {missing[1]}: missing {names}; each is given as NAME=VALUE{scene}"
    message = message.replace(PLUS_MINUS, '"NAME=VALUE +- TOLERANCE"')
    head, call, _ = message.partition("; call it for each of them")
    return f"{head}: give one, as NAME=VALUE" if call else message


def _machine(options: argparse.Namespace, arguments: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The machine with the single inputs among the arguments, of which a call takes those that it needs."""
    from ..machine.machine import Machine
    from ..machine.methods import NOT_FILLED, OF_RANGES
    from ..mechanism.inputs import INPUTS
    from ..mechanism.ranges import between

    if options.machine is None:
        machine = Machine(units=options.units)
    else:
        machine = Machine.read(options.machine, units=options.units)
        arguments = {**_motor(options), **arguments}
    if options.call in OF_RANGES:
        pairs = [name for name, value in arguments.items() if name in INPUTS and type(value) is tuple]
        arguments |= {name: between(*arguments[name]) for name in pairs}
    if options.call in NOT_FILLED:
        return machine, arguments
    of_machine = {*INPUTS, "branch"} - {"theta"}
    single = {k: v for k, v in arguments.items() if k in of_machine and not isinstance(v, (list, tuple))}
    return machine.replace(**single), {k: v for k, v in arguments.items() if k not in single}


def _quantities(call: str, names: list[str]) -> list[Any]:
    """The positional arguments of a call: its names, its one name, or none."""
    expected = _positional(call)
    if names and not expected:
        raise UsageError(f"{names[0]}: desaxe {call} takes no quantity, only NAME=VALUE")
    if expected == "name" and len(names) != 1:
        raise UsageError(f"desaxe {call} takes one quantity, got {len(names)}")
    return [names[0] if expected == "name" else names] if names else []


def _positional(call: str) -> str:
    """`names` or `name`: what a call takes without a keyword; empty for nothing."""
    from inspect import Parameter, signature

    from ..machine.methods import import_function

    first = next(iter(signature(import_function(call)).parameters.values()))
    return first.name if first.kind is Parameter.POSITIONAL_OR_KEYWORD else ""


def _motor(options: argparse.Namespace) -> dict[str, Any]:
    """The torque of the scene's [steady], for the calls that ask for one."""
    from ..scenes.scene import scene

    steady = scene(options.machine).content.steady if options.call in ("steady", "simulate") else None
    return {} if steady is None else {"torque": steady.torque}
