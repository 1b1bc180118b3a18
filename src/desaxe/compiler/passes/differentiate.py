"""The derivative of a Program, line by line: for names whose own derivatives are not derived.

The chain rule on the lines as they stand. It loses digits where the derivation's own sensitivities
keep them, so it is for enclosures alone, where a loss is seen.
"""

from collections.abc import Callable, Mapping

from ..program import Argument, Line, Program, ProgramError
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


class Chain:
    """The lines of the derivative by one parameter; the rules are those for balls, or others."""

    def __init__(
        self, parameter: str, rules: "Mapping[str, Rule] | None" = None, prefix: str = _PREFIX
    ) -> None:
        self.parameter = parameter
        self.prefix = prefix  # begins the names of its lines
        self.rules = RULES if rules is None else rules
        self.lines: list[Line] = []
        self.slopes: dict[str, Argument] = {}

    def slope(self, argument: Argument) -> Argument:
        """The derivative of an argument."""
        if not isinstance(argument, str):
            return 0.0
        return 1.0 if argument == self.parameter else self.slopes.get(argument, 0.0)

    def through(self, line: Line) -> None:
        """The derivative of a line; nothing where it does not depend on the parameter."""
        if line.type != "f64" or not any(self.slope(a) for a in line.args):
            return
        name = f"{self.prefix}{line.name}{_JOINT}{self.parameter}"
        op, args = self.rules[line.op](self, line)
        self.lines.append(Line(name, op, args))
        self.slopes[line.name] = name

    def new(self, op: str, *args: Argument, type: str = "f64") -> str:
        """A temporary."""
        name = f"{self.prefix}{len(self.lines)}_{self.parameter}"
        self.lines.append(Line(name, op, args, type))
        return name


Step = tuple[str, tuple[Argument, ...]]
Rule = Callable[[Chain, Line], Step]


def _mul(chain: Chain, line: Line) -> Step:
    a, b = line.args
    return "add", (chain.new("mul", chain.slope(a), b), chain.new("mul", a, chain.slope(b)))


def _mul_add(chain: Chain, line: Line) -> Step:
    a, b, c = line.args
    first = chain.new("mul_add", chain.slope(a), b, chain.slope(c))
    return "mul_add", (a, chain.slope(b), first)


def _div(chain: Chain, line: Line) -> Step:
    a, b = line.args
    return "div", (chain.new("sub", chain.slope(a), chain.new("mul", line.name, chain.slope(b))), b)


def _abs(chain: Chain, line: Line) -> Step:
    (a,) = line.args
    slope = chain.slope(a)
    if line.name == "abs_sin":  # the side that the whole box was given
        return "copysign", (slope, a)  # the balls know the sign
    below = chain.new("lt", a, 0.0, type="bool")
    return "select", (below, chain.new("neg", slope), slope)


def _sqrt(chain: Chain, line: Line) -> Step:
    return "div", (chain.slope(line.args[0]), chain.new("mul", 2.0, line.name))


def _sin(chain: Chain, line: Line) -> Step:
    (a,) = line.args
    return "mul", (chain.new("cos", a), chain.slope(a))


def _cos(chain: Chain, line: Line) -> Step:
    (a,) = line.args
    return "neg", (chain.new("mul", chain.new("sin", a), chain.slope(a)),)


def _atan2(chain: Chain, line: Line) -> Step:
    y, x = line.args
    rotated_sin = chain.new("sub", chain.new("mul", x, chain.slope(y)), chain.new("mul", y, chain.slope(x)))
    return "div", (rotated_sin, chain.new("add", chain.new("mul", x, x), chain.new("mul", y, y)))


def _hypot(chain: Chain, line: Line) -> Step:
    a, b = line.args
    first = chain.new("mul", chain.new("div", a, line.name), chain.slope(a))
    return "mul_add", (chain.new("div", b, line.name), chain.slope(b), first)


def _log(chain: Chain, line: Line) -> Step:
    (a,) = line.args
    return "div", (chain.slope(a), a)


def _pow(chain: Chain, line: Line) -> Step:
    a, b = line.args
    less = chain.new("pow", a, chain.new("sub", b, 1.0))
    of_base = chain.new("mul", chain.new("mul", b, less), chain.slope(a))
    if chain.slope(b) == 0.0:
        return "copy", (of_base,)
    of_power = chain.new("mul", chain.new("mul", line.name, chain.new("log", a)), chain.slope(b))
    return ("copy", (of_power,)) if chain.slope(a) == 0.0 else ("add", (of_base, of_power))


def _same(chain: Chain, line: Line) -> Step:
    return line.op, tuple(map(chain.slope, line.args))


def _rotated(chain: Chain, line: Line) -> Step:
    return line.op, (*map(chain.slope, line.args[:2]), line.args[2])


def _lookup(chain: Chain, line: Line) -> Step:
    return "mul", (chain.new("lookup_slope", *line.args), chain.slope(line.args[0]))


def _no_second_slope(line: Line) -> Step:
    raise ProgramError(f"{line.name!r}: the slope of the table {line.args[1]!r} has no derivative here")


RULES: Mapping[str, Rule] = {
    **dict.fromkeys(("copy", "add", "sub", "neg"), _same),
    "mul": _mul,
    "mul_add": _mul_add,
    "div": _div,
    "abs": _abs,
    "sqrt": _sqrt,
    "sin": _sin,
    "cos": _cos,
    "atan2": _atan2,
    "hypot": _hypot,
    "exp": lambda chain, line: ("mul", (line.name, chain.slope(line.args[0]))),
    "log": _log,
    "pow": _pow,
    "select": lambda chain, line: ("select", (line.args[0], *map(chain.slope, line.args[1:]))),
    "two_sum_error": lambda chain, line: ("copy", (0.0,)),
    "two_product_error": lambda chain, line: ("copy", (0.0,)),
    "rounding": lambda chain, line: ("copy", (0.0,)),
    "power_of_two": lambda chain, line: ("copy", (0.0,)),  # no value depends on it
    "lookup_piece": lambda chain, line: ("copy", (0.0,)),
    "lookup": _lookup,
    "lookup_slope": lambda chain, line: _no_second_slope(line),
    "rotated_sin": _rotated,
    "rotated_cos": _rotated,
    # The sign of the second is constant but for jumps; the balls know which it is.
    "copysign": lambda chain, line: ("copysign", (chain.slope(line.args[0]), line.args[1])),
}
