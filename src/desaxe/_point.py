"""Single points in plain Python: a function of floats, cut to what is asked for, nothing compiled."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

from ._program import program_of
from .compiler.emit_python import compile_python
from .compiler.passes.pipeline import optimise
from .compiler.passes.slicing import keep_outputs
from .compiler.program import Line, Program, reached

NO_EFFECT = "Y_wrt_omega0"  # 0 where the mechanism can be assembled, else NaN


class Point(NamedTuple):
    """A request ready for single points: its function and the inputs that it takes, in order."""

    function: Callable[..., tuple[Any, ...]]
    inputs: tuple[str, ...]

    def run(self, values: Mapping[str, float]) -> tuple[Any, ...]:
        """The outputs at one point."""
        return self.function(*(values[name] for name in self.inputs))


@cache
def cut(names: tuple[str, ...], state: bool, fixed: tuple[tuple[str, float], ...]) -> Program:
    """The program of these names with some inputs fixed, after all passes.

    A sensitivity that vanishes altogether then (V_C by alpha for a given state) is 0 only where the
    mechanism can be assembled, like one that is 0 from the start.
    """
    program = program_of(names, state)
    result = optimise(program, dict(fixed))[0]
    constant = [line.name for line in result.lines if line.name in names and line.args == (0.0,)]
    vanished = [name for name in constant if "D" in reached(program._replace(outputs=(name,)))]
    if not vanished:
        return result
    wide = program_of((*names, NO_EFFECT), state)
    lines = [line for line in wide.lines if line.name not in vanished]
    lines += [Line(name, "copy", (NO_EFFECT,)) for name in vanished]
    return optimise(keep_outputs(wide._replace(lines=tuple(lines)), names), dict(fixed))[0]


@cache
def point_of(names: tuple[str, ...], state: bool, fixed: tuple[tuple[str, float], ...]) -> Point:
    """The function that computes them."""
    program = cut(names, state, fixed)
    return Point(compile_python(program), program.inputs)
