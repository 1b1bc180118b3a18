"""Two forms of one program: plain lines for most points, stable lines for points that fail a test.

A design with wide margins needs none of the care that one next to its change point does. `in_two_forms`
puts both forms and the test into one program, so that they share what they have in common; `parted`
takes the innermost loop of its kernel apart again. The value at a point depends on that point alone.
"""

from collections.abc import Iterable

from .kernel import Kernel, StableBranch
from .passes.value_numbering import value_numbering
from .program import Line, Program, reaching, renamed

_SUFFIX = "_close"


def in_two_forms(plain: Program, stable: Program, test: Program) -> Program:
    """Join the programs: outputs of `plain`, of `test`, and of `stable` under other names.

    Precondition: `stable` has the outputs of `plain`, which hold the same values, where the test
    holds up to rounding, and maybe one more: whether they hang on rounding; `test` has one output, a
    condition. Equal lines are computed once.
    """
    outputs = (*plain.outputs, *test.outputs, *(f"{name}{_SUFFIX}" for name in stable.outputs))
    named = {line.name: f"{line.name}_test" for line in test.lines if line.name not in test.outputs}
    parts = [renamed(test, named), plain, renamed(stable, {n: f"{n}{_SUFFIX}" for n in _names(stable)})]
    aliases = [Line(f"{n}{_SUFFIX}", "copy", (n,)) for n in stable.outputs if n in stable.inputs]
    lines = tuple(line for part in parts for line in part.lines)
    inputs = dict.fromkeys(name for part in (stable, plain, test) for name in part.inputs)
    notes = {**plain.notes, **test.notes}
    notes |= {f"{name}{_SUFFIX}": note for name, note in stable.notes.items() if name not in notes}
    return value_numbering(Program(tuple(inputs), (*lines, *aliases), outputs, notes))


def _names(program: Program) -> Iterable[str]:
    return (line.name for line in program.lines)


def parted(kernel: Kernel, count: int) -> Kernel:
    """The kernel of such a program with the stable lines of its innermost loop set apart.

    Precondition: `count` is the number of outputs of one form. Postcondition: the outputs are those of
    the plain form; `close` has the rest.
    """
    outputs, (test, *results) = kernel.outputs[:count], kernel.outputs[count:]
    stable, undecided = tuple(results[:count]), (*results[count:], None)[0]
    *outer, inner = kernel.levels
    plain_lines = reaching(inner, (*outputs, test))
    close = StableBranch(test, reaching(inner, results), stable, reaching(inner, (test,)), undecided)
    return kernel._replace(levels=(*outer, plain_lines), outputs=outputs, close=close)
