"""A Program as a static C function, and the sines and cosines that are computed ahead of it.

A Program takes the sine and cosine of an argument as arguments of their own: one point computes them by
`sin_cos`, an array strip by strip, in a loop that vectorises.
"""

from collections.abc import Iterable
from typing import NamedTuple

from ...program import Program, renamed
from ...text import with_short_temporaries
from ..shared import one_line, safe_name, statements, types_of, with_safe_names
from ..words import words_of

# NAN and INFINITY are floats: a cast says that they are meant as doubles.
WORDS = {"nan": "(double)NAN", "inf": "(double)INFINITY", "True": "1", "False": "0"}
RESERVED = words_of("c").lines


class Lifted(NamedTuple):
    """A Program without sines and cosines of its arguments; argument -> names of its sine and cosine."""

    program: Program
    turns: dict[str, tuple[str, str]]


def lifted(program: Program) -> Lifted:
    """The program with the sine and cosine of an argument, guarded or not, as arguments.

    A guarded argument is the argument or NaN; the sine of what is not finite is NaN anyway.
    """
    origin = {name: name for name in program.inputs}
    for line in program.lines:
        if line.op == "select" and line.args[1] in origin and repr(line.args[2]) == "nan":
            origin[line.name] = origin[str(line.args[1])]
    turns: dict[str, tuple[str, str]] = {}
    names: dict[str, str] = {}
    lines = []
    for line in program.lines:
        angle = origin.get(str(line.args[0])) if line.op in ("sin", "cos") else None
        if angle is None:
            lines.append(line)
            continue
        pair = turns.setdefault(angle, (f"sine_of_{angle}", f"cosine_of_{angle}"))
        names[line.name] = pair[line.op == "cos"]
    extra = tuple(name for pair in turns.values() for name in pair)
    bare = program._replace(inputs=program.inputs + extra, lines=tuple(lines))
    return Lifted(_pointing(bare, names), turns)


def _pointing(program: Program, names: dict[str, str]) -> Program:
    """The program where some names are read under others."""
    outputs = tuple(names.get(name, name) for name in program.outputs)
    return renamed(program, names)._replace(outputs=outputs)


def static_function(
    name: str,
    program: Program,
    arguments: Iterable[str],
    results: int,
    status: int | None,
    comment: str = "",
) -> str:
    """`int name(arguments, double out[])`, which fills the first outputs and returns that of index `status`.

    Without a status nothing is returned.
    """
    program = with_safe_names(program, RESERVED)
    arguments = [safe_name(argument, RESERVED) for argument in arguments]
    filled = program.outputs[:results]
    out = ["double out[]"] if filled else []
    parameters = ", ".join([*(f"double {a}" for a in arguments), *out])
    used = {a for line in program.lines for a in line.args if isinstance(a, str)} | set(program.outputs)
    lines = [f"(void){a};" for a in arguments if a not in used]
    lines += _body(program)
    types = types_of(program)
    cast = {name: "(double)" * (types[name] != "f64") for name in filled}  # a status
    lines += [f"out[{index}] = {cast[output]}{output};" for index, output in enumerate(filled)]
    if status is not None:  # twice the digits have it as a number
        whole = "(int)" * (types[program.outputs[status]] == "f64")
        lines.append(f"return {whole}{program.outputs[status]};")
    head = f"static inline {'void' if status is None else 'int'} {name}({parameters or 'void'}) {{"
    opening = [f"/* {comment} */"] if comment else []
    return "\n".join([*opening, head, *(f"  {line}" for line in lines), "}"]) + "\n"


def _body(program: Program) -> list[str]:
    program = with_short_temporaries(program)
    types = types_of(program)
    rows = []
    for name, right, note in statements(program, "c", WORDS):
        kind = "double" if types.get(name, "f64") == "f64" else "int"
        rows.append(f"const {kind} {name} = {right};" + (f" /* {one_line(note)} */" if note else ""))
    return rows
