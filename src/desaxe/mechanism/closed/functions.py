"""Closed forms as functions: of numbers in plain Python, of arrays in NumPy."""

from collections.abc import Callable
from functools import cache
from typing import Any

from ...compiler.languages.arrays import compile_arrays
from ...compiler.languages.python import compile_python
from ...compiler.passes.pipeline import optimise
from ...compiler.passes.slicing import keep_outputs
from ...compiler.text import read_function
from ...support.computed import computed_once
from ...support.lazy import np


class ClosedForm:
    """A Program that is a closed form, with some inputs fixed; functions are made when they are called."""

    def __init__(self, text: str, outputs: tuple[str, ...], **fixed: float) -> None:
        program = read_function(text)
        self.program = optimise(keep_outputs(program, outputs or program.outputs), fixed)

    @computed_once
    def point(self) -> Callable[..., tuple[Any, ...]]:
        """The outputs from numbers: a square root below 0 is NaN, a number over 0 infinite."""
        return compile_python(self.program)

    @computed_once
    def arrays(self) -> Callable[..., tuple[Any, ...]]:
        """The outputs from arrays that broadcast, by NumPy."""
        return np.errstate(all="ignore")(compile_arrays(self.program, np))


@cache
def closed_form(text: str, outputs: tuple[str, ...] = (), **fixed: float) -> ClosedForm:
    """The closed form of a Program's text; all outputs or some."""
    return ClosedForm(text, outputs, **fixed)
