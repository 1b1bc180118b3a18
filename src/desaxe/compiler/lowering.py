"""From a Program to machine code: the stages in their order.

    stage            where                             what holds afterwards
    1 slice          passes.slicing.keep_outputs       every line is reached from an output
    2 specialise     passes.pipeline.optimise          fixed inputs are folded in, one name for one value
    3 guard          passes.guard.guard_inputs         a bad element of an array gives NaN and its status
    4 sine, cosine   passes.trigonometry, value_numbering   no calls are left, so that a loop vectorises
      or pairs       passes.double_double              the same with twice the digits, in pairs of doubles
    5 fuse           passes.fuse.fuse_products         a product and its sum are one instruction
    6 two forms      forms.in_two_forms                the plain form where a test holds, else the stable
    7 hoist          kernel.tabulate                   each line in the outermost loop that has what it needs
    8 language       languages, llvm                   text
    9 machine code   llvm.machine                      compiled once a process

Stages 1 and 2 belong to a request, 8 and 9 to a language. What lies between is this file: each function takes
a Program and gives one, or a Kernel, and changes neither its inputs nor its outputs.
"""

from collections.abc import Iterable, Mapping
from math import inf
from sys import float_info
from typing import TYPE_CHECKING, NamedTuple

from .forms import in_two_forms, parted
from .kernel import Kernel, tabulate
from .passes.double_double import double_double
from .passes.fuse import fuse_products
from .passes.guard import guard_inputs
from .passes.trigonometry import Trigonometry, expand_trigonometry
from .passes.value_numbering import value_numbering
from .program import Program

if TYPE_CHECKING:
    from .passes.double_angles import DoubleTrigonometry


class Limits(NamedTuple):
    """The smallest valid value of inputs, and the largest magnitude of angles that are written out."""

    least: Mapping[str, float]
    largest: Mapping[str, float] = {}


def for_loops(program: Program, trigonometry: Trigonometry | None, plain: bool = False) -> Program:
    """Stages 4 and 5: expand sine and cosine, fuse products. Without `trigonometry` they stay calls.

    `plain` takes the shorter reduction of angles, which suits plain forms.
    """
    if trigonometry is not None:
        program = value_numbering(expand_trigonometry(program, trigonometry, plain))
    return fuse_products(program)


def guarded_for_loops(
    program: Program,
    varying: Iterable[str],
    limits: Limits,
    trigonometry: Trigonometry | None,
    plain: bool = False,
) -> Program:
    """Stages 3 to 5, in doubles."""
    return for_loops(_bounded(guard_inputs(program, tuple(varying), *limits)), trigonometry, plain)


def _bounded(program: Program) -> Program:
    """The program with x <= the largest double for x < inf.

    LLVM makes of x < inf and 0 <= x one test of the number's bits: ten instructions of a vector, not two.
    """
    lines = (
        line._replace(op="le", args=(line.args[0], float_info.max))
        if line.op == "lt" and line.args[1] == inf
        else line
        for line in program.lines
    )
    return program._replace(lines=tuple(lines))


def guarded_pairs(
    program: Program, varying: Iterable[str], limits: Limits, trigonometry: "DoubleTrigonometry"
) -> Program:
    """Stages 3 and 4, in double-double arithmetic."""
    return double_double(guard_inputs(program, tuple(varying), *limits), trigonometry)


def nest(program: Program, axis_of: Mapping[str, int], axes: int) -> Kernel:
    """Stage 7: the loop nest of one form; an input without an axis is a scalar."""
    return tabulate(program, {name: axis_of.get(name) for name in program.inputs}, axes)


def nest_of_two_forms(
    plain: Program, stable: Program, test: Program, outputs: int, axis_of: Mapping[str, int], axes: int
) -> Kernel:
    """Stages 6 and 7: the loop nest that takes the plain form where the test holds."""
    return parted(nest(in_two_forms(plain, stable, test), axis_of, axes), outputs)
