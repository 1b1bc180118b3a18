"""One vectorised function for GNU Octave and MATLAB: `[a_C, V_C] = name(theta, ec)`.

Arrays broadcast as they do there. What a select does not take must be computed too, so that nothing here may
become complex: the root of a negative number is NaN.
"""

from ...support.template import file_text
from ..program import Program
from ..text import with_short_temporaries
from .protocol import Language, Module
from .shared import (
    Spelling,
    arrays_of,
    described,
    functions_in,
    numbers,
    one_line,
    with_helpers,
)

SPELLING = Spelling(
    "octave",
    "{name} = {right};",
    "  % {}",
    {"nan": "NaN", "inf": "Inf", "True": "true", "False": "false"},
)
HELPERS = functions_in(file_text(__package__, "octave.m"))


class Octave(Language):
    """GNU Octave and MATLAB; see this file's docstring."""

    name = "octave"
    suffix = ".m"
    about = "name.m, for GNU Octave and MATLAB"

    def files(self, module: Module) -> dict[str, str]:
        """`name.m`."""
        return {f"{module.name}.m": _text(module)}


def _text(module: Module) -> str:
    inputs = [SPELLING.safe(symbol.name) for symbol in module.inputs]
    program = with_short_temporaries(module.forms.stable)
    program = program._replace(outputs=program.outputs[: len(module.outputs)])
    outputs = [symbol.name for symbol in module.outputs]
    head = f"function [{', '.join(f'out_{name}' for name in outputs)}] = {module.name}({', '.join(inputs)})"
    rows = [*_help(module), *_same_shape(inputs), *_content(module), *SPELLING.statements(program)]
    body = [f"  {row}" for row in [*rows, *_results(program, outputs)]]
    main = "\n".join([head, *body, "end", ""])
    return "\n".join([main, *with_helpers(main, HELPERS)])


def _help(module: Module) -> list[str]:
    """The text that `help name` prints."""
    names = ", ".join(symbol.name for symbol in module.outputs)
    given = ", ".join(symbol.name for symbol in module.inputs)
    rows = [f"{module.name.upper()}  [{names}] = {module.name}({given})", "", *map(one_line, module.head), ""]
    rows += [f"  {described(symbol)}" for symbol in (*module.inputs, *module.outputs)]
    rows += [
        "",
        "Numbers or arrays, which broadcast; what has no value is NaN.",
        "SPDX-License-Identifier: MIT",
    ]
    return [f"% {row}".rstrip() for row in rows]


def _content(module: Module) -> list[str]:
    """The tables that are looked into."""
    rows = []
    for name, column in arrays_of(module.tables).items():
        rows += [f"{name} = [ ...", *(f"  {row} ..." for row in numbers(column)), "];"]
    return rows


def _same_shape(inputs: list[str]) -> list[str]:
    """Convert all inputs to doubles of the common shape."""
    if not inputs:
        return ["shape = 1;"]
    shape = " .* ".join(f"ones(size({name}))" for name in inputs)
    return [f"shape = {shape};", *(f"{name} = numbers('{name}', {name}) .* shape;" for name in inputs)]


def _results(program: Program, outputs: list[str]) -> list[str]:
    return [
        f"out_{name} = double({SPELLING.safe(own)}) .* shape;"
        for name, own in zip(outputs, program.outputs, strict=True)
    ]
