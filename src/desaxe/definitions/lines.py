"""The tree of an expression as lines of the Program, in the names of the catalogue.

A value that does not exist stays NaN: `min`, `max` and `where` look at both sides of their comparison.
"""

from collections.abc import Mapping
from math import nan, pi

from ..compiler.passes.pipeline import optimise
from ..compiler.program import Argument, Line, Note, Program
from ..compiler.text import write_function
from .dimensions import constant
from .grammar import Node

_DIRECT = {
    "+": "add", "-": "sub", "*": "mul", "/": "div", "neg": "neg", "sqrt": "sqrt", "abs": "abs", "sin": "sin",
    "cos": "cos", "atan2": "atan2", "hypot": "hypot", "exp": "exp", "log": "log",
}  # fmt: skip


OUTPUT = "_value"


def value_text(
    name: str, tree: Node, inputs: tuple[str, ...], numbers: Mapping[str, float], note: Note
) -> str:
    """The text of the Program of a tree: a function `own` of the names that it uses."""
    writer = _Writer(numbers)
    last = writer.value(tree)
    lines = (*writer.lines, Line(OUTPUT, "copy", (last,)))
    program = optimise(Program(inputs, lines, (OUTPUT,), {OUTPUT: note}))
    return write_function(program, "own", f"{name}, in SI units and radians.")


class _Writer:
    """Appends the lines of one part after the other."""

    def __init__(self, numbers: Mapping[str, float]) -> None:
        self.numbers = {**numbers, "pi": pi}
        self.lines: list[Line] = []

    def line(self, op: str, *args: Argument, kind: str = "f64") -> str:
        """A line, by its name."""
        self.lines.append(Line(f"_{len(self.lines)}", op, args, kind))
        return self.lines[-1].name

    def value(self, node: Node) -> Argument:
        """The line, input or constant that holds the value of a part."""
        if node.op == "number":
            return node.number
        if node.op == "name":
            return self.numbers.get(node.name, node.name)
        if node.op == "**":
            return self._power(node)
        if node.op == "where":
            test, yes, no = node.parts
            return self._where(test, self.value(yes), self.value(no))
        arguments = [self.value(part) for part in node.parts]
        if node.op in ("min", "max"):
            result, *others = arguments
            for other in others:
                result = self._extreme(node.op, result, other)
            return result
        if node.op == "tan":
            (angle,) = arguments
            return self.line("div", self.line("sin", angle), self.line("cos", angle))
        return self.line(_DIRECT[node.op], *arguments)

    def _extreme(self, op: str, a: Argument, b: Argument) -> str:
        first = self.line("le", *((a, b) if op == "min" else (b, a)), kind="bool")
        return self.line("select", first, a, self.line("select", self._exists(a), b, nan))

    def _where(self, test: Node, yes: Argument, no: Argument) -> str:
        a, b = (self.value(part) for part in test.parts)
        if test.op in (">", ">="):
            a, b = b, a
        if test.op == "!=":
            yes, no = no, yes
        kind = {"==": "eq", "!=": "eq", "<": "lt", ">": "lt"}.get(test.op, "le")
        holds = self.line(kind, a, b, kind="bool")
        both = self.line("and", self._exists(a), self._exists(b), kind="bool")
        return self.line("select", holds, yes, self.line("select", both, no, nan))

    def _exists(self, a: Argument) -> str:
        return self.line("eq", a, a, kind="bool")

    def _power(self, node: Node) -> Argument:
        base = self.value(node.parts[0])
        power = constant(node.parts[1], self.numbers)
        if power is None:
            return self.line("pow", base, self.value(node.parts[1]))
        doubled = 2.0 * power
        if doubled != int(doubled):
            return self.line("pow", base, power)
        whole = int(abs(doubled)) // 2
        result = self._whole_power(base, whole)
        if whole * 2 != abs(doubled):
            root = self.line("sqrt", base)
            result = root if whole == 0 else self.line("mul", result, root)
        return self.line("div", 1.0, result) if power < 0 else result

    def _whole_power(self, base: Argument, count: int) -> Argument:
        """base to an integer power, by repeated squaring."""
        result: Argument = 1.0
        while count:
            if count & 1:
                result = base if result == 1.0 else self.line("mul", result, base)
            count >>= 1
            base = self.line("mul", base, base) if count else base
        return result
