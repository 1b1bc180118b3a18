"""Fused multiply-add: a product that is only added to something is added in the same instruction."""

from collections import Counter

from ..program import Argument, Line, Program, names_in
from .slicing import drop_unused


def fuse_products(program: Program) -> Program:
    """The program with `mul_add` for each sum or difference that has a product of its own.

    Precondition: error terms are lines still (after this pass the sum and the product that they belong to
    must stand as they are). Effect: one rounding less, and one operation, for each; last bits change. A
    product stays where a `two_product_error` says what rounding took from it, where it has a name of its
    own, and where something else uses it, the error of a sum for instance.
    """
    fuser = _Fuser(program)
    lines = tuple(line for each in program.lines for line in fuser.of(each))
    return drop_unused(program._replace(lines=lines))


class _Fuser:
    """Knows which products are free to go into a sum."""

    def __init__(self, program: Program) -> None:
        uses = Counter(name for line in program.lines for name in names_in(line.args))
        kept = {*program.outputs, *program.notes}
        exact = {frozenset(line.args) for line in program.lines if line.op == "two_product_error"}
        self.free = {
            line.name: line.args
            for line in program.lines
            if line.op == "mul"
            and uses[line.name] == 1
            and line.name not in kept
            and frozenset(line.args) not in exact
        }

    def of(self, line: Line) -> list[Line]:
        """The lines that stand in the place of one."""
        if line.op not in ("add", "sub"):
            return [line]
        first, second = line.args
        minus = line.op == "sub"
        if first in self.free:
            negative, second = _negative(line.name, second) if minus else ([], second)
            return [*negative, line._replace(op="mul_add", args=(*self.free[str(first)], second))]
        if second in self.free:
            a, b = self.free[str(second)]
            negative, a = _negative(line.name, a) if minus else ([], a)
            return [*negative, line._replace(op="mul_add", args=(a, b, first))]
        return [line]


def _negative(name: str, value: Argument) -> tuple[list[Line], Argument]:
    """The value with the other sign, and the line that takes: the instruction has the sign in it."""
    if not isinstance(value, str):
        return [], -value
    return [Line(f"{name}_minus", "neg", (value,))], f"{name}_minus"
