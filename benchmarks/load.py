"""The load of a work on the machine: bytes moved and operations issued for each point."""

from collections import Counter
from typing import NamedTuple

from desaxe.compiler.operations import OPERATIONS
from desaxe.mechanism.program import Variant
from desaxe.runtime.kernels import KernelKey, kernel_of

from .work import Work

DOUBLE = 8  # bytes


class Load(NamedTuple):
    """Bytes read and written for a point, its additions and multiplications, divisions and roots."""

    bytes: int
    slots: float
    divisions: int
    roots: int


def load_of(work: Work) -> Load:
    """Count the innermost loop of desaxe's kernel, in the form for designs with wide margins.

    Columns of an outer loop are read once for many points, and are not counted.
    """
    inputs = work.inputs(work.quick)
    zeros = {"alpha": 0.0, **{name: x for name, x in inputs.scalars.items() if x == 0.0}}
    axes = len(inputs.shape)
    axis_of = tuple(sorted(inputs.axis.items()))
    key = KernelKey(work.names, Variant(wide_margins=True), tuple(sorted(zeros.items())), axis_of, axes)
    kinds = Counter(line.op for line in kernel_of(key).levels[-1])
    divisions, roots = kinds.pop("div", 0), kinds.pop("sqrt", 0)
    slots = sum(OPERATIONS[op].cost * count for op, count in kinds.items())
    columns = sum(axis == axes - 1 for axis in inputs.axis.values()) if axes == 1 else 0
    return Load(DOUBLE * (columns + len(work.names)), slots, divisions, roots)
