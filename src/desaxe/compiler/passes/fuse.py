"""Fused multiply-add: a product that is only added to something is added in the same instruction."""

from collections import Counter

from ..program import Argument, Line, Program, names_in, number
from .slicing import drop_unused


def fuse_products(program: Program) -> Program:
    """The program with `mul_add` for each sum or difference that has a product, or minus one, of its own.

    Precondition: error terms are lines still (after this pass the sum and the product that they belong to
    must stand as they are). Effect: one rounding less, and one operation, for each; last bits change. A
    product stays where a `two_product_error` says what rounding took from it, where it has a name of its
    own, and where something else uses it, the error of a sum for instance.
    """
    fuser = _Fuser(program)
    lines = tuple(line for each in program.lines for line in fuser.of(each))
    return drop_unused(program._replace(lines=lines))


class _Fuser:
    """Finds the products that may be fused into a sum."""

    def __init__(self, program: Program) -> None:
        uses = Counter(name for line in program.lines for name in names_in(line.args))
        kept = {*program.outputs, *program.notes}
        exact = {frozenset(line.args) for line in program.lines if line.op == "two_product_error"}
        own = [line for line in program.lines if uses[line.name] == 1 and line.name not in kept]
        self.free = {
            line.name: (line.args[0], line.args[1])
            for line in own
            if line.op == "mul" and frozenset(line.args) not in exact
        }
        minus = {line.name: str(line.args[0]) for line in own if line.op == "neg"}
        self.minus = {name: product for name, product in minus.items() if product in self.free}

    def of(self, line: Line) -> list[Line]:
        """The lines that replace a line."""
        if line.op not in ("add", "sub"):
            return [line]
        first, second = line.args
        minus = line.op == "sub"
        if (product := self._product(first)) is not None:
            return _fused(line, product, (second, minus))
        if (product := self._product(second)) is not None:
            a, b, negative = product
            return _fused(line, (a, b, negative != minus), (first, False))
        return [line]

    def _product(self, value: Argument) -> tuple[Argument, Argument, bool] | None:
        """The factors of a product that may be fused, and its sign; None for any other value."""
        name = str(value)
        factors = self.free.get(self.minus.get(name, name))
        return None if factors is None else (*factors, name in self.minus)


def _fused(line: Line, product: tuple[Argument, Argument, bool], rest: tuple[Argument, bool]) -> list[Line]:
    """The line as one instruction, after the lines of what has the other sign: it has the signs in it."""
    (a, b, negative), (value, minus) = product, rest
    signed = [(f"{line.name}_factor", a, negative), (f"{line.name}_term", value, minus)]
    lines = [Line(name, "neg", (v,)) for name, v, other in signed if other and isinstance(v, str)]
    a, value = (_signed(*each) for each in signed)
    return [*lines, line._replace(op="mul_add", args=(a, b, value))]


def _signed(name: str, value: Argument, negative: bool) -> Argument:
    """The value or its negative."""
    if not negative:
        return value
    return name if isinstance(value, str) else -number(value)
