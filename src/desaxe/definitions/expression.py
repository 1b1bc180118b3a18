"""The text of an expression as lines of a Program, with the dimension of each part; it is never evaluated.

A parser by precedence reads the text from left to right and appends the lines of each part. Terms that are
added or compared have one dimension. A literal 0 agrees with everything, so that `max(power_in, 0)` has a
meaning. A value that does not exist stays NaN: `min`, `max` and `where` look at both sides they compare.
"""

import operator
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from functools import reduce
from math import isfinite
from typing import Any, NamedTuple, NoReturn

from ..compiler.program import Argument
from ..units.dimensions import NONE, POWER, Unit, unit_text

LONGEST = 4_000  # characters
MOST = 400  # numbers, names and signs
DEEPEST = 40  # parentheses and calls within each other
LARGEST_POWER = 64
SIMPLEST = 1000  # the largest denominator of a power

_TOKEN = re.compile(
    r"[ \t\r\n]+"
    r"|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<sign>\*\*|<=|>=|==|!=|[-+*/()<>,])"
    r"|(?P<other>.)",
    re.ASCII | re.DOTALL,
)
_HINTS = {
    **{".": ": there are no attributes", "^": "; a power is **", "=": "; equality is =="},
    **{"%": "; there is no remainder", "[": "; there are no lists"},
    **dict.fromkeys("&|", "; use where(...) within where(...)"),
    **dict.fromkeys("'\"", "; there is no text"),
}
_WINDOW = 72  # characters of a long text that a message shows
Token = re.Match[str]

# How tightly an operator binds; a sign before a number binds less than a power.
_BINDING = {**dict.fromkeys(("<", "<=", ">", ">=", "==", "!="), 1), "+": 2, "-": 2, "*": 3, "/": 3, "**": 5}
_OF_SIGN = 4
_CONSTANT: Mapping[str, Callable[..., Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "**": operator.pow,
}  # fmt: skip
_COMPARED = {
    **{sign: f"{{0}} {sign} {{1}}" for sign in ("<", "<=", "==")},
    **{">": "{1} < {0}", ">=": "{1} <= {0}", "!=": "{0} < {1} or {1} < {0}"},
}
# Of a function the least and most arguments, the rule of its dimension and its line in a Program. Rules:
# "number" of plain numbers alone; "same" as that of its arguments, which agree; "none"; "root" of it.
FUNCTIONS = {
    "sqrt": (1, 1, "root", "sqrt({0})"),
    "abs": (1, 1, "same", "fabs({0})"),
    "sin": (1, 1, "number", "sin({0})"),
    "cos": (1, 1, "number", "cos({0})"),
    "tan": (1, 1, "number", "sin({0}) / cos({0})"),
    "exp": (1, 1, "number", "exp({0})"),
    "log": (1, 1, "number", "log({0})"),
    "atan2": (2, 2, "none", "atan2({0}, {1})"),
    "hypot": (2, 2, "same", "hypot({0}, {1})"),
    "min": (2, 8, "same", "{0} if {0} <= {1} else ({1} if {0} == {0} else nan)"),
    "max": (2, 8, "same", "{0} if {1} <= {0} else ({1} if {0} == {0} else nan)"),
    "where": (3, 3, "same", "{0} if {2} else ({1} if {3} == {3} and {4} == {4} else nan)"),
}


class Value(NamedTuple):
    """A part of an expression: a constant, or the name of a line or input.

    dimension    None of a 0
    first, last  its first token, and the one behind it
    sides        of a comparison, of which the argument is the text
    """

    argument: Argument
    dimension: Unit | None
    first: int = 0
    last: int = 0
    sides: tuple[Argument, ...] = ()


def dimension_of(unit: Unit) -> Unit:
    """The dimension of a unit; an angle has none."""
    return unit._replace(rad=0, name="")


def dimension_text(dimension: Unit | None) -> str:
    """A dimension as its SI unit, or in words."""
    if dimension in (None, NONE):
        return "a plain number"
    return "W" if dimension == dimension_of(POWER) else unit_text(dimension or NONE)


class Expression:
    """The expression of a definition, read once: `lines` of a Program, the `value` of all, `names` used.

    look_up  the value of a name, or what is wrong with it
    """

    def __init__(self, name: str, text: str, look_up: Callable[[str], Value | str]) -> None:
        self.name, self.text, self._look_up = name, text, look_up
        self.lines: list[str] = []
        self.names: dict[str, Value] = {}
        self._tokens = list(self._scanned())
        self._at = self._depth = 0
        self.value = self._number(self._value())
        if self._at < len(self._tokens):
            self._unexpected("a sign such as +")

    # ---- messages -----------------------------------------------------------------------------------

    def refuse(self, start: int, end: int, problem: str) -> NoReturn:
        """Raise ValueError with the problem, the text, and a mark below these characters."""
        first = max(0, min(start - _WINDOW // 3, len(self.text) - _WINDOW))
        window = "".join(c if c.isprintable() else " " for c in self.text[first : first + _WINDOW])
        stop = max(start + 1, min(end, first + len(window)))
        mark = " " * (start - first) + "^" * (stop - start)
        raise ValueError(f"{self.name}: {problem}\n    {window}\n    {mark}")

    def refuse_all(self, problem: str) -> NoReturn:
        """Raise ValueError that marks the whole text."""
        self.refuse(0, len(self.text), problem)

    def _refuse_part(self, first: int, last: int, problem: str) -> NoReturn:
        self.refuse(*self._span(first, last), problem)

    def _unexpected(self, expected: str) -> NoReturn:
        if self._at == len(self._tokens):
            end = len(self.text)
            self.refuse(end - 1, end, "the expression ends too early")
        token = self._tokens[self._at]
        self.refuse(*token.span(), f"unexpected {token[0]!r}: expected {expected}")

    def _span(self, first: int, last: int) -> tuple[int, int]:
        """The characters of some tokens, and of the parentheses around them that are not those of a call."""
        tokens, count = self._tokens, len(self._tokens)
        while first and last < count and tokens[first - 1][0] == "(" and tokens[last][0] == ")":
            if first > 1 and tokens[first - 2].lastgroup == "name":
                break
            first, last = first - 1, last + 1
        return tokens[first].start(), tokens[last - 1].end()

    def _described(self, part: Value) -> str:
        start, end = self._span(part.first, part.last)
        text = " ".join(self.text[start:end].split())
        text = text if len(text) <= 40 else f"{text[:37]}..."
        return f"{text!r} is {dimension_text(part.dimension)}"

    # ---- grammar ------------------------------------------------------------------------------------

    def _scanned(self) -> Iterator[Token]:
        if len(self.text) > LONGEST:
            problem = f"{len(self.text)} characters; an expression has at most {LONGEST}"
            self.refuse(LONGEST, LONGEST + 1, problem)
        count, before = 0, "sign"
        for token in _TOKEN.finditer(self.text):
            kind = token.lastgroup
            if kind is None:
                continue
            if kind == "other":
                self.refuse(*token.span(), f"{token[0]!r} has no meaning here{_HINTS.get(token[0], '')}")
            if count == MOST:
                self.refuse(*token.span(), f"more than {MOST} numbers, names and signs")
            if kind != "sign" and before != "sign":
                self.refuse(*token.span(), f"unexpected {token[0]!r}: expected a sign such as +")
            count, before = count + 1, kind
            yield token
        if not count:
            self.refuse(0, 1, "an empty expression")

    @property
    def _sign(self) -> str:
        """The token that is next; empty at the end."""
        return self._tokens[self._at][0] if self._at < len(self._tokens) else ""

    def _value(self, least: int = 0) -> Value:
        """The part that is next, up to an operator that binds no tighter than `least`."""
        left = self._operand()
        while _BINDING.get(sign := self._sign, 0) > least:
            self._at += 1
            right = self._value(_BINDING[sign] - (sign == "**"))
            left = self._joined(sign, left, right)._replace(first=left.first, last=self._at)
        return left

    def _operand(self) -> Value:
        """A number, a name, a call, or what stands in parentheses, with any count of signs before it."""
        first, minus = self._at, False
        while self._sign in ("+", "-"):
            minus ^= self._sign == "-"
            self._at += 1
        if self._at > first:
            value = self._number(self._value(_OF_SIGN))
            if minus:
                a = value.argument
                value = value._replace(argument=-a if isinstance(a, float) else self._line("-{0}", a))
        elif self._sign == "(":
            (value,) = self._in_parentheses(most=1)
        else:
            token = self._tokens[self._at] if self._sign else None
            if token is None or token.lastgroup == "sign":
                self._unexpected("a number, a name or (")
            self._at += 1
            value = self._atom(token)
        return value._replace(first=first, last=self._at)

    def _atom(self, token: Token) -> Value:
        text = token[0]
        if token.lastgroup == "number":
            if not isfinite(float(text)):
                self.refuse(*token.span(), "the number is too large")
            return Value(float(text), NONE if float(text) else None)
        if self._sign == "(":
            if text not in FUNCTIONS:
                problem = f"unknown function {text!r}; there are {', '.join(FUNCTIONS)}"
                self.refuse(*token.span(), problem)
            return self._call(text)
        if text not in self.names:
            value = self._look_up(text)
            if isinstance(value, str):
                self.refuse(*token.span(), value)
            self.names[text] = value
        return self.names[text]

    def _in_parentheses(self, most: int) -> list[Value]:
        """One part, or several with commas between them."""
        self._depth += 1
        if self._depth > DEEPEST:
            span = self._tokens[self._at].span()
            self.refuse(*span, f"more than {DEEPEST} parentheses within each other")
        parts: list[Value] = []
        while not parts or (self._sign == "," and most > 1):
            self._at += 1
            parts.append(self._value())
        if self._sign != ")":
            self._unexpected("a sign such as + or )")
        self._at += 1
        self._depth -= 1
        return parts

    # ---- meaning ------------------------------------------------------------------------------------

    def _line(self, template: str, *arguments: Argument) -> str:
        """The name of a new line."""
        name = f"_{len(self.lines)}"
        self.lines.append(f"{name} = {template.format(*arguments)}")
        return name

    def _number(self, part: Value) -> Value:
        """A part that is no comparison."""
        if part.sides:
            problem = "a comparison stands only as the first argument of where(...)"
            self._refuse_part(part.first, part.last, problem)
        return part

    def _joined(self, sign: str, left: Value, right: Value) -> Value:
        """The value of an operator with both sides."""
        if left.sides and sign in _COMPARED:
            self._refuse_part(left.first, self._at, "a comparison has two sides, no more")
        a, b = self._number(left).argument, self._number(right).argument
        if sign == "**":
            return self._power(left, right)
        if sign in ("*", "/"):
            powers = right.dimension or NONE, 1 if sign == "*" else -1
            return Value(self._arithmetic(sign, a, b), (left.dimension or NONE).times(*powers))
        dimension = self._common(left.first, sign, [left, right])
        if sign in _COMPARED:
            return Value(_COMPARED[sign].format(a, b), None, sides=(a, b))
        return Value(self._arithmetic(sign, a, b), dimension)

    def _arithmetic(self, sign: str, a: Argument, b: Argument) -> Argument:
        """The line of an operator, or the number that it is of constants."""
        if isinstance(a, float) and isinstance(b, float):
            # A division by 0 is left to the machine, which has infinities; a complex power is NaN there.
            with suppress(ArithmeticError, TypeError):
                return float(_CONSTANT[sign](a, b))
        return self._line("pow({0}, {1})" if sign == "**" else f"{{0}} {sign} {{1}}", a, b)

    def _common(self, first: int, sign: str, parts: list[Value]) -> Unit | None:
        """The common dimension of the parts; ValueError that shows two that differ."""
        known = [part for part in parts if part.dimension is not None]
        for part in known:
            if part.dimension != known[0].dimension:
                one, other = self._described(known[0]), self._described(part)
                problem = f"{sign!r} wants one dimension on both sides: {one}, {other}"
                self._refuse_part(first, self._at, problem)
        return known[0].dimension if known else None

    def _require_plain(self, part: Value, limit: str, first: int) -> None:
        """ValueError for a part that has a dimension; the mark begins at a token."""
        if part.dimension not in (None, NONE):
            self._refuse_part(first, self._at, f"{limit} {self._described(part)}")

    def _power(self, base: Value, exponent: Value) -> Value:
        power, at = exponent.argument, exponent.first
        self._require_plain(exponent, "a power is a plain number,", at)
        if not isinstance(power, float):
            self._require_plain(base, "the power of what has a dimension is a constant;", at)
            return Value(self._arithmetic("**", base.argument, power), NONE)
        if not abs(power) <= LARGEST_POWER:
            self._refuse_part(at, self._at, f"a power of {power:g}: at most {LARGEST_POWER} is possible")
        fraction = Fraction(power).limit_denominator(SIMPLEST)
        dimension = base.dimension and NONE.times(base.dimension, fraction)
        return Value(self._to_constant_power(base.argument, power), dimension)

    def _to_constant_power(self, base: Argument, power: float) -> Argument:
        """Whole and half powers by repeated squaring."""
        whole, half = divmod(abs(power), 1.0)
        if isinstance(base, float) or half not in (0.0, 0.5):
            return self._arithmetic("**", base, power)
        factors, square = [], str(base)
        for digit in reversed(f"{int(whole):b}"):
            factors += [square] if digit == "1" else []
            square = self._line("{0} * {0}", square)
        factors += [self._line("sqrt({0})", base)] if half else []
        result = self._line(" * ".join(factors) or "1.0")
        return self._line("1.0 / {0}", result) if power < 0 else result

    def _call(self, name: str) -> Value:
        first = self._at - 1
        least, most, rule, line = FUNCTIONS[name]
        parts = self._in_parentheses(most=MOST)
        if not least <= len(parts) <= most:
            counts = f"{least}" if least == most else f"{least} to {most}"
            problem = f"{name} takes {counts} argument{'s' * (most > 1)}, got {len(parts)}"
            self._refuse_part(first, self._at, problem)
        test = parts.pop(0) if name == "where" else None
        if test and not test.sides:
            problem = "the first argument of where is a comparison, such as V_C > 0"
            self._refuse_part(test.first, test.last, problem)
        arguments = [self._number(part).argument for part in parts]
        dimension = self._common(first, name, parts)
        if rule == "number":
            self._require_plain(parts[0], f"{name} wants a plain number,", first)
        if rule == "root":
            dimension = dimension and NONE.times(dimension, Fraction(1, 2))
        dimension = NONE if rule in ("number", "none") else dimension
        if len(arguments) > least:
            return Value(reduce(lambda a, b: self._line(line, a, b), arguments), dimension)
        arguments += [test.argument, *test.sides] if test else []
        return Value(self._line(line, *arguments), dimension)
