"""Constant folding: compute what is fixed, drop terms with a factor 0 and factors 1.

A scene that fixes `ec = 0` or `alpha = 0` loses whole terms here. `0 * x` becomes 0: this assumes
that x is finite wherever the result matters; an output that vanishes altogether would forget where
it is NaN, and whoever fixes the input has to see to that. Otherwise no result changes by a bit (but
the sign of a zero may).
"""

from ..interpret import ieee
from ..program import Argument, Line, Program, TableName
from .slicing import drop_unused


def fold_constants(program: Program) -> Program:
    """The program with constant lines computed and neutral operations gone.

    Precondition: canonical form. Effect: as the module says. An
    output that has become constant, or equal to another name, stays as a line of its own (a `copy`).
    """
    value: dict[str, Argument] = {}
    lines: list[Line] = []
    for line in program.lines:
        args = tuple(value.get(a, a) if isinstance(a, str) else a for a in line.args)
        result = _simplified(Line(line.name, line.op, args, line.type))
        if isinstance(result, Line):
            lines.append(result)
        elif line.name in program.outputs:
            lines.append(line._replace(op="copy", args=(result,)))
            value[line.name] = result
        else:
            value[line.name] = result
    return drop_unused(program._replace(lines=tuple(lines)))


def _simplified(line: Line) -> Line | Argument:
    """The line, a simpler line, or the argument that holds its value."""
    if line.op == "copy":
        return line.args[0]
    if line.op == "select" and isinstance(line.args[0], bool):
        return line.args[1] if line.args[0] else line.args[2]
    if line.op == "select" and line.args[1] == line.args[2] and isinstance(line.args[1], str):
        return line.args[1]
    if not any(isinstance(a, (str, TableName)) for a in line.args):
        constant: Argument = ieee(line.op, *line.args)
        return constant
    rule = _RULES.get(line.op)
    return rule(line) if rule else line


def _is(argument: Argument, number: float) -> bool:
    return isinstance(argument, float) and argument == number


def _add(line: Line) -> Line | Argument:
    a, b = line.args
    if _is(a, 0.0):
        return b
    return a if _is(b, 0.0) else line


def _sub(line: Line) -> Line | Argument:
    a, b = line.args
    if _is(b, 0.0):
        return a
    return line._replace(op="neg", args=(b,)) if _is(a, 0.0) else line


def _mul(line: Line) -> Line | Argument:
    for a, b in (line.args, line.args[::-1]):
        if _is(a, 0.0):
            return 0.0
        if _is(a, 1.0):
            return b
        if _is(a, -1.0):
            return line._replace(op="neg", args=(b,))
    return line


def _div(line: Line) -> Line | Argument:
    a, b = line.args
    if _is(a, 0.0):
        return 0.0
    return a if _is(b, 1.0) else line


def _two_sum_error(line: Line) -> Line | Argument:
    return 0.0 if _is(line.args[0], 0.0) or _is(line.args[1], 0.0) else line


def _two_product_error(line: Line) -> Line | Argument:
    exact = any(_is(a, number) for a in line.args for number in (0.0, 1.0, -1.0, 2.0, 0.5))
    return 0.0 if exact else line


def _mul_add(line: Line) -> Line | Argument:
    a, b, c = line.args
    if _is(a, 0.0) or _is(b, 0.0):
        return c
    return _mul(line._replace(op="mul", args=(a, b))) if _is(c, 0.0) else line


_RULES = {
    "add": _add, "sub": _sub, "mul": _mul, "div": _div, "mul_add": _mul_add,
    "extended_only": lambda line: False,
    "two_sum_error": _two_sum_error, "two_product_error": _two_product_error,
}  # fmt: skip
