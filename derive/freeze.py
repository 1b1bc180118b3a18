"""Freeze a sheet into a Program: SymPy stops here.

Each equation becomes lines of one operation. Sums and products are taken in SymPy's canonical
order, so the result depends on nothing but the equations. Integer powers become products, and
`f(x)` of a function that is no SymPy function becomes the operation of that name.
"""

from collections.abc import Sequence

import sympy as sp

from desaxe.compiler.operations import OPERATIONS, result_type
from desaxe.compiler.program import Argument, Line, Program, number, type_of

from .sheet import Sheet

STATUSES = tuple(float(number) for number in range(7))  # small whole numbers that a status can be


def freeze(sheet: Sheet, inputs: Sequence[str], outputs: Sequence[str]) -> Program:
    """The program that computes these names of the sheet from these inputs."""
    order = sheet.ordered(tuple(outputs))
    freezer = _Freezer(inputs)
    for name in order:
        freezer.assign(name, sheet.equations[name].expression)
    notes = {name: note for name in order if (note := sheet.equations[name].note) is not None}
    return Program(tuple(inputs), tuple(freezer.lines), tuple(outputs), notes)


class _Freezer:
    """Turns expressions into lines, sharing what it has already computed."""

    def __init__(self, inputs: Sequence[str]) -> None:
        self.lines: list[Line] = []
        self.types: dict[str, str] = dict.fromkeys(inputs, "f64")
        self.known: dict[tuple[str, tuple[str, ...]], str] = {}

    def assign(self, name: str, expression: sp.Expr) -> None:
        """Add the lines of `name = expression`; the last of them has the name."""
        value = self.argument(expression)
        last = self.lines[-1] if self.lines else None
        if last is not None and last.name == value and value.startswith("_"):
            self.lines[-1] = last._replace(name=name)
            self.types[name] = self.types.pop(value)
            self.known = {key: (name if held == value else held) for key, held in self.known.items()}
        else:
            self._append("copy", (value,), name)

    def _append(self, op: str, args: tuple[Argument, ...], name: str = "") -> str:
        key = op, tuple(f"{type(a).__name__}:{a}" for a in args)
        if not name and key in self.known:
            return self.known[key]
        kind = result_type(OPERATIONS[op], tuple(type_of(a, self.types) for a in args))
        name = name or f"_{len(self.lines)}"
        self.lines.append(Line(name, op, args, kind))
        self.types[name] = kind
        self.known.setdefault(key, name)
        return name

    def argument(self, expression: sp.Expr) -> Argument:
        """A name or a constant that holds the expression."""
        if expression.is_Symbol:
            return float("nan") if expression.name == "nan" else str(expression.name)
        if expression.is_Integer or expression.is_Float or expression is sp.oo:
            return float(expression)
        if expression.is_Rational:
            return float(expression.p) / float(expression.q)
        if expression.is_Add:
            return self._sum(expression)
        if expression.is_Mul:
            return self._product(expression)
        if expression.is_Pow:
            return self._power(expression.base, expression.exp)
        return self._call(expression)

    def _sum(self, expression: sp.Expr) -> Argument:
        """Terms in canonical order, one with a plus sign first; a minus becomes a subtraction."""
        terms = [_signed(term) for term in expression.as_ordered_terms()]
        terms.sort(key=lambda term: term[0] < 0)
        sign, first = terms[0]
        total = self.argument(first) if sign > 0 else self.argument(-first)
        for sign, term in terms[1:]:
            total = self._append("add" if sign > 0 else "sub", (total, self.argument(term)))
        return total

    def _product(self, expression: sp.Expr) -> Argument:
        sign, positive = _signed(expression)
        if sign < 0:
            inner = self.argument(positive)
            return self._append("neg", (inner,)) if isinstance(inner, str) else -number(inner)
        above, below = sp.fraction(expression)
        if below != 1:
            return self._append("div", (self.argument(above), self.argument(below)))
        factors = expression.as_ordered_factors()
        total = self.argument(factors[0])
        for factor in factors[1:]:
            total = self._append("mul", (total, self.argument(factor)))
        return total

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> Argument:
        if exponent == sp.Rational(1, 2):
            return self._append("sqrt", (self.argument(base),))
        if exponent.is_Integer and exponent < 0:
            return self._append("div", (1.0, self._power(base, -exponent)))
        if not exponent.is_Integer:
            raise ValueError(f"cannot freeze the power {base}**{exponent}")
        if exponent == 1:
            return self.argument(base)
        half = self._power(base, exponent // 2)
        square = self._append("mul", (half, half))
        return self._append("mul", (square, self.argument(base))) if exponent % 2 else square

    def _call(self, expression: sp.Expr) -> Argument:
        op = expression.func.__name__.lower()
        args = [self.argument(argument) for argument in expression.args]
        if op == "select" and all(_is_status(a, self.types) for a in args[1:]):
            args[1:] = [a if isinstance(a, str) else int(number(a)) for a in args[1:]]
        return self._append(op, tuple(args))


def _is_status(argument: Argument, types: dict[str, str]) -> bool:
    """True for an integer status code."""
    if isinstance(argument, str):
        return types[argument] == "i64"
    return argument in STATUSES


def _signed(term: sp.Expr) -> tuple[int, sp.Expr]:
    """Sign and the rest, by the sign of the leading coefficient."""
    coefficient, _ = term.as_coeff_Mul()
    return (-1, -term) if coefficient.is_negative else (1, term)
