"""Names that are contract, one a line: `python -m tests.repository.contract` writes them to contract.txt.

docs/stability.md says what a version may change of them. A line that goes or changes is a broken promise to
users of a release: say so in the changelog; a new line needs nothing.
"""

import argparse
import enum
import inspect
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import desaxe as dx
from desaxe.cli.calls import call_commands
from desaxe.cli.doctor import DOCTOR
from desaxe.cli.files import FILES
from desaxe.cli.parser import parser_of

FILE = Path(__file__).with_name("contract.txt")
ROD = {"ec": 0.01, "AB": 0.125, "BC": 0.35}
TURNING = ROD | {"omega0": 150.0, "m_slider": 0.8, "I_crank": 0.01}
MOTOR = {"torque": dx.kloss(100.0, breakdown_slip=0.1, synchronous_speed=157.0)}
# A call of each function that returns a mapping of its own keys, or a dataset.
ANSWERS = {
    "evaluate": lambda: dx.evaluate("a_C", theta=1.0, quality=True, **TURNING),
    "counterweight": lambda: dx.counterweight(**TURNING),
    "crossings": lambda: dx.crossings("V_C", value=1.0, **TURNING),
    "design_map": lambda: dx.design_map(["stroke"], **ROD | {"ec": [0.0, 0.01]}),
    "drive": lambda: dx.drive(**TURNING),
    "enclose": lambda: dx.enclose("Y", theta=1.0, **ROD),
    "events": lambda: dx.events(**TURNING),
    "feasibility": lambda: dx.feasibility(**ROD),
    "grid": lambda: dx.grid("a_C", theta=[1.0, 2.0], **TURNING),
    "harmonics": lambda: dx.harmonics("a_C", orders=2, **TURNING),
    "inverse": lambda: dx.inverse(Y=0.4, **ROD),
    "optimize": lambda: dx.optimize(minimize=("absmax", "a_C"), over={"BC": (0.3, 0.4)}, **_but("BC")),
    "peak": lambda: dx.peak("a_C", **TURNING),
    "simulate": lambda: dx.simulate(torque=5.0, t_end=0.1, **_but("omega0")),
    "solve": lambda: dx.solve(over={"AB": (0.01, 0.06)}, stroke=0.05, ec=0.005, BC=0.15),
    "steady": lambda: dx.steady(**MOTOR, **_but("omega0")),
    "synthesize": lambda: dx.synthesize(stroke=0.1, time_ratio=1.1, BC=0.2),
    "tolerance": lambda: dx.tolerance("a_C", theta=1.0, **_but("ec"), ec=dx.plus_minus(0.01, 1e-4)),
}


def _but(name: str) -> dict[str, Any]:
    return {key: value for key, value in TURNING.items() if key != name}


def lines() -> Iterator[str]:
    """The contract, sorted within each part."""
    for name in sorted(dx.__all__):
        yield from _signatures(f"dx.{name}", getattr(dx, name))
    for name, call in ANSWERS.items():
        yield f"answer of {name}: {', '.join(sorted(map(str, _keys(call()))))}"
    for name, codes in vars(dx.status).items():
        if isinstance(codes, enum.EnumMeta) and codes.__module__ == dx.status.__name__ and len(codes):
            yield f"{name}: {', '.join(f'{int(code)} {code.name}' for code in codes)}"
    yield f"quantities: {', '.join(name for name in dx.quantities() if '_wrt_' not in name)}"
    yield from _commands(parser_of((*call_commands(), *FILES, DOCTOR)))


def _signatures(name: str, value: Any) -> Iterator[str]:
    if inspect.ismodule(value) or inspect.isclass(value):
        public = getattr(value, "__all__", [m for m in dir(value) if not m.startswith("_")])
        for member in sorted(public) if name in ("dx.Machine", "dx.Crankshaft", "dx.plot") else ():
            yield from _signatures(f"{name}.{member}", getattr(value, member))
        yield name
    elif callable(value):
        yield f"{name}({', '.join(map(_parameter, inspect.signature(value).parameters.values()))})"
    else:
        yield name


def _parameter(parameter: inspect.Parameter) -> str:
    """A parameter without annotation; of its default the value where that is plain."""
    default = parameter.default
    key = str(parameter.replace(default=inspect.Parameter.empty, annotation=inspect.Parameter.empty))
    if default is inspect.Parameter.empty:
        return key
    return f"{key}={default!r}" if isinstance(default, (int, float, str, tuple, type(None))) else f"{key}=..."


def _keys(answer: Any) -> Any:
    if isinstance(answer, Mapping) or hasattr(answer, "data_vars"):
        return answer
    return [name for name in dir(answer) if not name.startswith("_")]


def _commands(parser: argparse.ArgumentParser) -> Iterator[str]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, command in action.choices.items():
                options = [max(a.option_strings, key=len) for a in command._actions if a.option_strings]
                yield f"desaxe {name} {' '.join(sorted(options))}"


def text() -> str:
    """The contract as it is written."""
    return "".join(f"{line}\n" for line in lines())


if __name__ == "__main__":
    now = text()
    before = FILE.read_text(encoding="utf-8") if FILE.exists() else ""
    print("gone or changed:", *sorted({*before.splitlines()} - {*now.splitlines()}), sep="\n  ")
    FILE.write_text(now, encoding="utf-8")
