"""The functions that a search calls, by NumPy: a block of designs at once, without a compiler."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..compiler.languages.arrays import compile_arrays
from ..compiler.program import Program
from .nodes import Array
from .programs import Programs

Function = Callable[..., None]


def functions_of(programs: Programs) -> tuple[Function, Function, Function]:
    """`sweep`, `points` and `finish` of `search`, for its designs and angles in arrays."""
    curve, told = (_over(program, programs.inputs) for program in (programs.curve, programs.finish))

    def sweep(count: int, nodes: Array, block: Array, work: Array, value: Array, slope: Array) -> None:
        """Value and slope at every node, for every design."""
        here = slice(0, nodes.size), slice(0, count)
        value[here], slope[here] = curve(nodes[:, None], block[:, None, :count])

    def points(rows: int, count: int, theta: Array, block: Array, value: Array, slope: Array) -> None:
        """Value and slope of every design at angles of its own."""
        here = slice(0, rows), slice(0, count)
        value[here], slope[here] = curve(theta[here], block[:, None, :count])

    def finish(count: int, theta: Array, block: Array, out: Array) -> None:
        """Value, slope and gradient of every design at an angle."""
        for row, values in zip(out, told(theta[:count], block[:, :count]), strict=True):
            row[:count] = values

    return sweep, points, finish


def _over(program: Program, inputs: tuple[str, ...]) -> Callable[[Array, Array], tuple[Any, ...]]:
    """A program as a function of angles and the rows of a block."""
    function = compile_arrays(program, np)
    places = [None if name == "theta" else inputs.index(name) for name in program.inputs]

    def values(theta: Array, block: Array) -> tuple[Any, ...]:
        with np.errstate(all="ignore"):
            return function(*(theta if place is None else block[place] for place in places))

    return values
