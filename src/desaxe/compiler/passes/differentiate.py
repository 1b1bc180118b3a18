"""The derivative of a Program, line by line: for names whose own derivatives are not derived.

The chain rule on the lines as they stand. It loses digits where the derivation's own sensitivities
keep them, so it is for enclosures alone, where a loss is seen.
"""

from collections.abc import Mapping
from functools import cache

from ..program import Argument, Line, Program, ProgramError
from ..text import read_function
from .fold import fold_constants
from .pipeline import optimise

_PREFIX, _JOINT = "d_", "_by_"


def original(name: str) -> str:
    """The line that a line is the derivative of; any other line itself."""
    return name.removeprefix(_PREFIX).partition(_JOINT)[0]


def with_derivatives(program: Program, parameters: tuple[str, ...]) -> Program:
    """The program, followed by the derivatives of its outputs that are numbers, by each of the parameters."""
    lines = list(program.lines)
    outputs = list(program.outputs)
    numbers = [line.name for line in program.lines if line.name in outputs and line.type == "f64"]
    for parameter in parameters:
        chain = Chain(parameter)
        for line in program.lines:
            chain.through(line)
        lines += chain.lines
        for output in numbers:
            outputs.append(f"{output}{_JOINT}{parameter}")
            lines.append(Line(outputs[-1], "copy", (chain.slope(output),)))
    return optimise(program._replace(lines=tuple(lines), outputs=tuple(outputs)))


# The derivative of an operation, or of a line of that name: of arguments a, b, c with derivatives da, db, dc,
# and of the value r.
RULES: Mapping[str, str] = {
    "mul": "da * b + a * db",
    "mul_add": "mul_add(a, db, mul_add(da, b, dc))",
    "div": "(da - r * db) / b",
    "abs": "-da if a < 0.0 else da",
    "abs_sin": "copysign(da, a)",  # the side that the whole box was given: balls know the sign
    "sqrt": "da / (2.0 * r)",
    "sin": "cos(a) * da",
    "cos": "-(sin(a) * da)",
    "atan2": "(b * da - a * db) / (b * b + a * a)",
    "hypot": "mul_add(b / r, db, a / r * da)",
    "exp": "r * da",
    "log": "da / a",
    "pow": "b * pow(a, b - 1.0) * da + r * log(a) * db",
}
# A double knows its sign, and that there is none at a kink.
SIGNED = "da * (copysign(1.0, a) * copysign(1.0, b))"
# Operations that are linear in their arguments but for those at these indices; a jump has no slope.
LINEAR: Mapping[str, tuple[int, ...]] = {
    **dict.fromkeys(("copy", "add", "sub", "neg"), ()),
    "select": (0,),
    "copysign": (1,),
    **dict.fromkeys(("rotated_sin", "rotated_cos"), (2,)),
}
# Constant but for jumps, or of a size that no value depends on.
CONSTANT = ("two_sum_error", "two_product_error", "rounding", "power_of_two", "lookup_piece")


class Chain:
    """The lines of the derivative with respect to one parameter; the rules are those for balls, or others."""

    def __init__(self, parameter: str, rules: Mapping[str, str] = RULES, prefix: str = _PREFIX) -> None:
        self.parameter = parameter
        self.prefix = prefix  # begins the names of its lines
        self.rules = rules
        self.lines: list[Line] = []
        self.slopes: dict[str, Argument] = {}

    def slope(self, argument: Argument) -> Argument:
        """The derivative of an argument."""
        if not isinstance(argument, str):
            return 0.0
        return 1.0 if argument == self.parameter else self.slopes.get(argument, 0.0)

    def through(self, line: Line) -> None:
        """The derivative of a line; nothing where it does not depend on the parameter."""
        slopes = [self.slope(argument) for argument in line.args]
        if line.type != "f64" or not any(slopes):
            return
        name = f"{self.prefix}{line.name}{_JOINT}{self.parameter}"
        rule = self.rules.get(line.name) or self.rules.get(line.op)
        if rule:
            names = dict(zip("abc", line.args, strict=False)) | {"r": line.name}
            names |= {f"d{letter}": slope for letter, slope in zip("abc", slopes, strict=False)}
            self._by_rule(name, rule, names)
        elif line.op == "lookup":
            slope = self.new("lookup_slope", *line.args)
            self.lines.append(Line(name, "mul", (slope, slopes[0])))
        elif line.op in CONSTANT:
            self.lines.append(Line(name, "copy", (0.0,)))
        elif line.op in LINEAR:
            pairs = enumerate(zip(line.args, slopes, strict=True))
            args = [a if k in LINEAR[line.op] else slope for k, (a, slope) in pairs]
            self.lines.append(Line(name, line.op, tuple(args)))
        else:
            what = f"the slope of the table {line.args[1]!r}" if line.op == "lookup_slope" else line.op
            raise ProgramError(f"{line.name!r}: {what} has no derivative here")
        self.slopes[line.name] = name

    def _by_rule(self, name: str, rule: str, names: Mapping[str, Argument]) -> None:
        """Append the lines of a rule without the terms of slopes that are 0."""
        known = dict(names)
        lines = [line._replace(args=_args(line, known)) for line in _read(rule).lines]
        inputs = dict.fromkeys(a for a in known.values() if isinstance(a, str))
        for line in fold_constants(Program(tuple(inputs), tuple(lines), ("result",), {})).lines:
            args = _args(line, known)
            if line.name == "result":
                self.lines.append(Line(name, line.op, args))
            else:
                known[line.name] = self.new(line.op, *args, type=line.type)

    def new(self, op: str, *args: Argument, type: str = "f64") -> str:
        """A temporary."""
        name = f"{self.prefix}{len(self.lines)}_{self.parameter}"
        self.lines.append(Line(name, op, args, type))
        return name


def _args(line: Line, known: Mapping[str, Argument]) -> tuple[Argument, ...]:
    return tuple(known.get(a, a) if isinstance(a, str) else a for a in line.args)


@cache
def _read(rule: str) -> Program:
    inputs = "a, b, c, da, db, dc, r"
    return read_function(f"def rule({inputs}):\n    result = {rule}\n    return result\n")
