"""The conditions of user-defined quantities: what is 0 where one of them may jump or have a kink."""

from collections.abc import Iterator
from functools import lru_cache

from ..compiler.passes.pipeline import optimise
from ..compiler.passes.slicing import keep_outputs
from ..compiler.program import Line, Note, Program
from ..compiler.text import ProgramText, write_function
from ..mechanism.own import Definition
from .define import OUTPUT


@lru_cache(maxsize=256)
def conditions_of(own: tuple[Definition, ...]) -> tuple[Definition, ...]:
    """Definitions of the differences that `where`, `min` and `max` compare, and of what `abs` takes."""
    return tuple(dict.fromkeys(condition for definition in own for condition in _conditions(definition)))


def _conditions(definition: Definition) -> Iterator[Definition]:
    program = ProgramText(definition.text).read()
    for number, line in enumerate(program.lines):
        if line.op not in ("lt", "le", "abs"):
            continue
        a, b = (*line.args, 0.0)[:2]
        lines = (*program.lines[:number], Line(OUTPUT, "sub", (a, b)))
        difference = Program(program.inputs, lines, (OUTPUT,), {OUTPUT: Note("1", "", "")})
        difference = keep_outputs(optimise(difference), (OUTPUT,))
        if difference.inputs:
            text = write_function(difference, "own", f"A condition of {definition.name}.")
            name = f"{definition.name}_condition_{number}"
            yield Definition(name, definition.expression, "1", "", (), text)
