"""The committed program, cut to what is asked for.

Reads the text of generated/program.py: only the lines that the wanted names reach are parsed, so
the first answer of a process comes quickly.
"""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from .compiler.passes.bind import overlay
from .compiler.passes.slicing import keep_outputs
from .compiler.program import Program
from .compiler.text import ProgramText


@cache
def _text(name: str) -> ProgramText:
    spec = find_spec("desaxe.generated")
    if spec is None or spec.origin is None:
        raise ImportError("desaxe.generated is missing: the installation is incomplete")
    return ProgramText((Path(spec.origin).parent / f"{name}.py").read_text(encoding="utf-8"))


@cache
def program_of(names: tuple[str, ...], state: bool = False) -> Program:
    """The program of these names (those of the law), under the law or for a given state."""
    program = _text("program").read(names)
    if not state:
        return program
    return keep_outputs(overlay(program, _text("state").read()), names)


@cache
def digest() -> str:
    """What identifies the derivation and the compiler that wrote generated/."""
    from importlib import import_module

    value: str = import_module("desaxe.generated").DIGEST
    return value
