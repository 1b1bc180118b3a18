"""The lines of the Program of an expression, with the dimension of each part.

Terms that are added or compared have one dimension. A literal 0 agrees with everything, so that
`max(power_in, 0)` has a meaning. A value that does not exist stays NaN: `min`, `max` and `where` look at both
sides of their comparison.
"""

import ast
import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from math import isfinite, nan
from typing import Any, NamedTuple

from ..compiler.program import Argument, Line
from ..units.dimensions import NONE, POWER, Unit, unit_text
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
    dimension: Unit | None


def dimension_of(unit: Unit) -> Unit:
    """The dimension of a unit; an angle has none."""
    return unit._replace(rad=0, name="")


def dimension_text(dimension: Unit | None) -> str:
    """A dimension as its SI unit, or in words."""
    if dimension in (None, NONE):
        return "a plain number"
    return "W" if dimension == dimension_of(POWER) else unit_text(dimension or NONE)


class Lowering:
    """Appends the lines of one part after the other; `names` has constants, quantities and inputs."""

    def __init__(self, source: ExpressionText, names: Mapping[str, Value]) -> None:
        self.source, self.names = source, names
        self.lines: list[Line] = []

    def value(self, node: ast.expr) -> Value:
        """The value of a part; ValueError that marks what has no meaning."""
        match node:
            case ast.Constant():
                number = float(self.source.atom(node))
                if not isfinite(number):
                    self.source.refuse_node(node, "the number is too large")
                return Value(number, NONE if number else None)
            case ast.Name():
                return self.names[self.source.atom(node)]
            case ast.UnaryOp():
                return self._signed(node)
            case ast.BinOp(op=ast.Pow()):
                return self._power(node)
            case ast.BinOp():
                return self._arithmetic(node)
            case ast.Call(func, parts):
                return self._call(node, self.source.atom(func), parts)
            case ast.Compare():
                self.source.refuse_node(node, TWO_SIDES if len(node.ops) > 1 else ONLY_IN_WHERE)
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
        parts = {node.left: self.value(node.left), node.right: self.value(node.right)}
        (a, of_a), (b, of_b) = parts.values()
        if op in ("mul", "div"):
            dimension: Unit | None = (of_a or NONE).times(of_b or NONE, 1 if op == "mul" else -1)
        else:
            dimension = self._common(node, sign, parts)
        return Value(self._line(op, a, b), dimension)

    def _common(self, node: ast.expr, sign: str, parts: Mapping[ast.expr, Value]) -> Unit | None:
        """The common dimension of the parts; ValueError that shows two that differ."""
        known = [part for part, value in parts.items() if value.dimension is not None]
        for part in known:
            if parts[part].dimension != parts[known[0]].dimension:
                one, other = (self._described(each, parts[each]) for each in (known[0], part))
                self.source.refuse_node(node, f"{sign!r} wants one dimension on both sides: {one}, {other}")
        return parts[known[0]].dimension if known else None

    def _described(self, node: ast.expr, value: Value) -> str:
        return f"{self.source.quote(node)!r} is {dimension_text(value.dimension)}"

    def _require_plain(self, marked: ast.expr, node: ast.expr, value: Value, limit: str) -> None:
        """ValueError for a part that has a dimension."""
        if value.dimension not in (None, NONE):
            self.source.refuse_node(marked, f"{limit} {self._described(node, value)}")

    # ---- powers -------------------------------------------------------------------------------------

    def _power(self, node: ast.BinOp) -> Value:
        base, exponent = self.value(node.left), self.value(node.right)
        power = exponent.argument
        self._require_plain(node.right, node.right, exponent, "a power is a plain number,")
        if not isinstance(power, float):
            limit = "the power of what has a dimension is a constant;"
            self._require_plain(node.right, node.left, base, limit)
            return Value(self._line("pow", base.argument, power), NONE)
        if not abs(power) <= LARGEST_POWER:
            problem = f"a power of {power:g}: at most {LARGEST_POWER} is possible"
            self.source.refuse_node(node.right, problem)
        fraction = Fraction(power).limit_denominator(SIMPLEST)
        dimension = base.dimension and NONE.times(base.dimension, fraction)
        return Value(self._to_constant_power(base.argument, power), dimension)

    def _to_constant_power(self, base: Argument, power: float) -> Argument:
        """Whole and half powers by repeated squaring."""
        whole, half = divmod(abs(power), 1.0)
        if isinstance(base, float) or half not in (0.0, 0.5):
            return self._line("pow", base, power)
        square: Argument = base
        result: Argument = 1.0
        count = int(whole)
        while count:
            if count & 1:
                result = square if result == 1.0 else self._line("mul", result, square)
            count >>= 1
            square = self._line("mul", square, square) if count else square
        if half:
            root = self._line("sqrt", base)
            result = self._line("mul", result, root) if whole else root
        return self._line("div", 1.0, result) if power < 0 else result

    # ---- calls --------------------------------------------------------------------------------------

    def _call(self, node: ast.expr, name: str, parts: list[ast.expr]) -> Value:
        least, most = FUNCTIONS[name]
        if not least <= len(parts) <= most:
            counts = f"{least}" if least == most else f"{least} to {most}"
            problem = f"{name} takes {counts} argument{'s' * (most > 1)}, got {len(parts)}"
            self.source.refuse_node(node, problem)
        if name == "where":
            return self._where(node, *parts)
        values = {part: self.value(part) for part in parts}
        first = values[parts[0]]
        dimension = first.dimension
        if name in _OF_NUMBERS:
            self._require_plain(node, parts[0], first, f"{name} wants a plain number,")
        elif name == "sqrt":
            dimension = dimension and NONE.times(dimension, Fraction(1, 2))
        elif len(parts) > 1:
            dimension = self._common(node, name, values)
        plain = name in _OF_NUMBERS or name == "atan2"
        arguments = [value.argument for value in values.values()]
        return Value(self._function(name, arguments), NONE if plain else dimension)

    def _function(self, name: str, arguments: list[Argument]) -> Argument:
        if name == "tan":
            return self._line("div", self._line("sin", *arguments), self._line("cos", *arguments))
        if name not in ("min", "max"):
            return self._line(name, *arguments)
        result, *others = arguments
        for other in others:
            first = self._line("le", *((result, other) if name == "min" else (other, result)), type="bool")
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
        compared = {side: self.value(side) for side in (test.left, *test.comparators)}
        values = {side: self.value(side) for side in (yes, no)}
        self._common(test, sign, compared)
        dimension = self._common(node, "where", values)
        a, b = (value.argument for value in compared.values())
        first, second = (value.argument for value in values.values())
        a, b = (b, a) if sign in (">", ">=") else (a, b)
        first, second = (second, first) if sign == "!=" else (first, second)
        holds = self._line(op, a, b, type="bool")
        both = self._line("and", self._exists(a), self._exists(b), type="bool")
        rest = self._line("select", both, second, nan)
        return Value(self._line("select", holds, first, rest), dimension)

    def _exists(self, a: Argument) -> Argument:
        return self._line("eq", a, a, type="bool")
