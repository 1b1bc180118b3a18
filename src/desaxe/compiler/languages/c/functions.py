"""A Program as a static C function.

It takes the sine and cosine of an argument as arguments of their own (`lifted`): one point computes them by
`sin_cos`, an array strip by strip, in a loop that vectorises.
"""

import re
from collections.abc import Iterable, Mapping

from ...program import Program
from ..lifted import lifted
from ..shared import Spelling, types_of, with_safe_names

# NAN and INFINITY are floats: a cast says that they are meant as doubles.
SPELLING = Spelling(
    "c",
    "const {kind} {name} = {right};",
    " /* {} */",
    {"nan": "(double)NAN", "inf": "(double)INFINITY", "True": "1", "False": "0"},
    ("double", "int"),
)


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
    program = with_safe_names(program, SPELLING.reserved)
    arguments = [SPELLING.safe(argument) for argument in arguments]
    filled = program.outputs[:results]
    out = ["double out[]"] if filled else []
    parameters = ", ".join([*(f"double {a}" for a in arguments), *out])
    used = {a for line in program.lines for a in line.args if isinstance(a, str)} | set(program.outputs)
    lines = [f"(void){a};" for a in arguments if a not in used]
    lines += SPELLING.statements(program)
    types = types_of(program)
    cast = {name: "(double)" * (types[name] != "f64") for name in filled}  # a status
    lines += [f"out[{index}] = {cast[output]}{output};" for index, output in enumerate(filled)]
    if status is not None:  # twice the digits have it as a number
        whole = "(int)" * (types[program.outputs[status]] == "f64")
        lines.append(f"return {whole}{program.outputs[status]};")
    head = f"static inline {'void' if status is None else 'int'} {name}({parameters or 'void'}) {{"
    opening = [f"/* {comment} */"] if comment else []
    return "\n".join([*opening, head, *(f"  {line}" for line in lines), "}"]) + "\n"


def called_through(
    name: str, program: Program, head: str, cells: Mapping[str, str], results: int, status: int | None
) -> list[str]:
    """The function of a program, and one with this head that passes it cells of arrays, and `out`.

    Without a status the second returns 0.
    """
    form = lifted(program)
    turns = {part: f"turn[{k}]" for pair in form.turns.values() for k, part in enumerate(pair)}
    arguments = [turns.get(n) or cells[n] for n in form.program.inputs] + ["out"] * bool(results)
    body = [row for a in form.turns for row in ("double turn[2];", f"sin_cos({cells[a]}, turn);")]
    call = f"{name}({', '.join(arguments)});"
    body += [f"return {call}"] if status is not None else [call, "return 0;"]
    parameters = re.findall(r"(\w+)(?:\[\])?[,)]", head.partition("(")[2])
    unused = [one for one in parameters if not re.search(rf"\b{one}\b", "".join(body))]
    rows = [*(f"(void){one};" for one in unused), *body]
    through = "\n".join([f"{head} {{", *(f"  {row}" for row in rows), "}"]) + "\n"
    return [static_function(name, form.program, form.program.inputs, results, status), through]
