"""The lines of the Program of an expression, with the dimension of each part.

Terms that are added or compared have one dimension. A literal 0 agrees with everything, so that
`max(power_in, 0)` has a meaning. A value that does not exist stays NaN: `min`, `max` and `where` look at both
sides of their comparison.
"""

import ast
import operator
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import isfinite, nan
from typing import Any, NamedTuple

from ..compiler.program import Argument, Line
from .dimension import NONE, Dimension
from .expression import FUNCTIONS, ExpressionText

LARGEST_POWER = 64
SIMPLEST = 1000  # the largest denominator of a power
ONLY_IN_WHERE = "a comparison stands only as the first argument of where(...)"
TWO_SIDES = "a comparison has two sides, no more"
_SIGNS = {ast.Add: ("add", "+"), ast.Sub: ("sub", "-"), ast.Mult: ("mul", "*"), ast.Div: ("div", "/")}
_COMPARISONS = {
    ast.Lt: ("lt", "<"), ast.LtE: ("le", "<="), ast.Gt: ("lt", ">"), ast.GtE: ("le", ">="),
    ast.Eq: ("eq", "=="), ast.NotEq: ("eq", "!="),
}  # fmt: skip
_OF_NUMBERS = ("sin", "cos", "tan", "exp", "log")
_FOLDED: Mapping[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv,
    "neg": operator.neg, "pow": operator.pow,
}  # fmt: skip


class Value(NamedTuple):
    """A part of an expression: a constant or the name of a line or input; None as the dimension of a 0."""

    argument: Argument
    dimension: Dimension | None


class Lowering:
    """Appends the lines of one part after the other; `names` has constants, quantities and inputs."""

    def __init__(self, source: ExpressionText, names: Mapping[str, Value]) -> None:
        self.source, self.names = source, names
        self.lines: list[Line] = []

    def value(self, node: ast.expr) -> Value:
        """The value of a part; ValueError that marks what has no meaning."""
        match node:
            case ast.Constant():
                return self._number(node)
            case ast.Name():
                return self.names[self.source.atom(node)]
            case ast.UnaryOp():
                return self._signed(node)
            case ast.BinOp(op=ast.Pow()):
                return self._power(node)
            case ast.BinOp():
                return self._arithmetic(node)
            case ast.Call(func, arguments):
                return self._call(node, self.source.atom(func), arguments)
            case ast.Compare(ops=[_]):
                self.source.refuse_node(node, ONLY_IN_WHERE)
            case ast.Compare():
                self.source.refuse_node(node, TWO_SIDES)
        raise AssertionError(ast.dump(node))

    def _line(self, op: str, *args: Argument, type: str = "f64") -> Argument:
        """The name of a line, or the number that arithmetic of constants is."""
        if op in _FOLDED and all(isinstance(argument, float) for argument in args):
            try:
                result = _FOLDED[op](*args)
            except ArithmeticError:  # a division by 0 is left to the machine, which has infinities
                result = None
            if isinstance(result, float):
                return result
        self.lines.append(Line(f"_{len(self.lines)}", op, args, type))
        return self.lines[-1].name

    def _number(self, node: ast.Constant) -> Value:
        number = float(self.source.atom(node))
        if not isfinite(number):
            self.source.refuse_node(node, "the number is too large")
        return Value(number, NONE if number else None)

    def _signed(self, node: ast.expr) -> Value:
        """A part with any count of signs before it."""
        minus = False
        while isinstance(node, ast.UnaryOp):
            minus ^= isinstance(node.op, ast.USub)
            node = node.operand
        argument, dimension = self.value(node)
        return Value(self._line("neg", argument) if minus else argument, dimension)

    def _arithmetic(self, node: ast.BinOp) -> Value:
        op, sign = _SIGNS[type(node.op)]
        parts = [node.left, node.right]
        (a, of_a), (b, of_b) = values = [self.value(part) for part in parts]
        if op in ("mul", "div"):
            product = (of_a or NONE).times(of_b or NONE, 1 if op == "mul" else -1)
            return Value(self._line(op, a, b), product)
        return Value(self._line(op, a, b), self._common(node, sign, parts, values))

    def _common(
        self, node: ast.expr, sign: str, parts: Sequence[ast.expr], values: Sequence[Value]
    ) -> Dimension | None:
        """The common dimension of the parts; ValueError that shows two that differ."""
        known = [
            (part, dimension)
            for part, (_, dimension) in zip(parts, values, strict=True)
            if dimension is not None
        ]
        for part, dimension in known:
            if dimension != known[0][1]:
                one, other = self._said(*known[0]), self._said(part, dimension)
                problem = f"{sign!r} wants one dimension on both sides: {one}, {other}"
                self.source.refuse_node(node, problem)
        return known[0][1] if known else None

    def _said(self, node: ast.expr, dimension: Dimension | None) -> str:
        return f"{self.source.quote(node)!r} is {dimension}"

    # ---- powers -------------------------------------------------------------------------------------

    def _power(self, node: ast.BinOp) -> Value:
        base, exponent = self.value(node.left), self.value(node.right)
        power = exponent.argument
        if exponent.dimension not in (None, NONE):
            said = self._said(node.right, exponent.dimension)
            self.source.refuse_node(node.right, f"a power is a plain number, {said}")
        if not isinstance(power, float):
            if base.dimension not in (None, NONE):
                said = self._said(node.left, base.dimension)
                problem = f"the power of what has a dimension is a constant; {said}"
                self.source.refuse_node(node.right, problem)
            return Value(self._line("pow", base.argument, power), NONE)
        if not abs(power) <= LARGEST_POWER:
            problem = f"a power of {power:g}: at most {LARGEST_POWER} is possible"
            self.source.refuse_node(node.right, problem)
        fraction = Fraction(power).limit_denominator(SIMPLEST)
        dimension = base.dimension and NONE.times(base.dimension, fraction)
        return Value(self._to_constant_power(base.argument, power), dimension)

    def _to_constant_power(self, base: Argument, power: float) -> Argument:
        whole, half = divmod(abs(power), 1.0)
        if isinstance(base, float) or half not in (0.0, 0.5):
            return self._line("pow", base, power)
        result = self._whole_power(base, int(whole))
        if half:
            root = self._line("sqrt", base)
            result = self._line("mul", result, root) if whole else root
        return self._line("div", 1.0, result) if power < 0 else result

    def _whole_power(self, base: Argument, count: int) -> Argument:
        """base to an integer power, by repeated squaring."""
        result: Argument = 1.0
        while count:
            if count & 1:
                result = base if result == 1.0 else self._line("mul", result, base)
            count >>= 1
            base = self._line("mul", base, base) if count else base
        return result

    # ---- calls --------------------------------------------------------------------------------------

    def _call(self, node: ast.expr, name: str, parts: Sequence[ast.expr]) -> Value:
        least, most = FUNCTIONS[name]
        if not least <= len(parts) <= most:
            counts = f"{least}" if least == most else f"{least} to {most}"
            problem = f"{name} takes {counts} argument{'s' * (most > 1)}, got {len(parts)}"
            self.source.refuse_node(node, problem)
        if name == "where":
            return self._where(node, *parts)
        values = [self.value(part) for part in parts]
        arguments = [value.argument for value in values]
        dimension = values[0].dimension
        if name in _OF_NUMBERS and dimension not in (None, NONE):
            problem = f"{name} wants a plain number, {self._said(parts[0], dimension)}"
            self.source.refuse_node(node, problem)
        if name == "sqrt":
            dimension = dimension and NONE.times(dimension, Fraction(1, 2))
        elif len(parts) > 1:
            dimension = self._common(node, name, parts, values)
        plain = name in _OF_NUMBERS or name == "atan2"
        return Value(self._function(name, arguments), NONE if plain else dimension)

    def _function(self, name: str, arguments: list[Argument]) -> Argument:
        if name == "tan":
            return self._line("div", self._line("sin", *arguments), self._line("cos", *arguments))
        if name not in ("min", "max"):
            return self._line(name, *arguments)
        result, *others = arguments
        for other in others:
            pair = (result, other) if name == "min" else (other, result)
            first = self._line("le", *pair, type="bool")
            rest = self._line("select", self._exists(result), other, nan)
            result = self._line("select", first, result, rest)
        return result

    def _where(self, node: ast.expr, test: ast.expr, yes: ast.expr, no: ast.expr) -> Value:
        if not isinstance(test, ast.Compare):
            problem = "the first argument of where is a comparison, such as V_C > 0"
            self.source.refuse_node(test, problem)
        if len(test.ops) > 1:
            self.source.refuse_node(test, TWO_SIDES)
        op, sign = _COMPARISONS[type(test.ops[0])]
        sides = [test.left, *test.comparators]
        compared, values = [self.value(side) for side in sides], [self.value(yes), self.value(no)]
        self._common(test, sign, sides, compared)
        dimension = self._common(node, "where", [yes, no], values)
        (a, _), (b, _) = reversed(compared) if sign in (">", ">=") else compared
        (first, _), (second, _) = reversed(values) if sign == "!=" else values
        holds = self._line(op, a, b, type="bool")
        both = self._line("and", self._exists(a), self._exists(b), type="bool")
        rest = self._line("select", both, second, nan)
        return Value(self._line("select", holds, first, rest), dimension)

    def _exists(self, a: Argument) -> Argument:
        return self._line("eq", a, a, type="bool")
