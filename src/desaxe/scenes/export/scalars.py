"""A function for each output of a written module, for use in @njit functions of one's own."""

from collections.abc import Sequence

from ...compiler.languages.numba.module import helper_sources
from ...compiler.operations import MATH_NAMES
from ...compiler.program import Program
from ...compiler.text import with_short_temporaries, write_lines
from ...mechanism.catalogue import quantity
from .entry_points import calls_of, indented

SCALAR = '''def scalar(function):
    """A function of floats for @njit functions, and for Python; compiled at the first call."""
    try:
        return njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba found no folder that it can write to
        return njit(error_model="numpy")(function)
'''


def scalars_source(scalars: Sequence[tuple[str, Program, Sequence[str]]], state: bool) -> str:
    """The source of the functions, each a guarded Program of one output, and of what they call."""
    ops = {line.op for _, program, _ in scalars for line in program.lines}
    helpers = helper_sources(ops)
    functions = [_function(name, program, inputs, state) for name, program, inputs in scalars]
    text = "\n".join([*helpers, *functions])
    called = [name for name in MATH_NAMES if calls_of(text, name)]
    from_numpy = sorted({"floor", "inf", "nan"} & set(called))
    from_math = [name for name in called if name not in from_numpy]
    imports = [f"from math import {', '.join(from_math)}"] if from_math else []
    imports += [f"from numpy import {', '.join(from_numpy)}"] if from_numpy else []
    imports += ["from numba import njit, types"]
    imports += ["from numba.extending import intrinsic"] if "@intrinsic" in text else []
    return "\n\n\n".join(['"""Scalars."""\n', "\n".join(imports), *helpers, SCALAR, *functions])


def _function(name: str, program: Program, inputs: Sequence[str], state: bool) -> str:
    row = quantity(name, state)
    meaning = row.meaning or name  # a quantity of one's own may come without
    used = [given for given in inputs if given in program.inputs]
    lines = [
        f'"""{meaning[0].upper()}{meaning[1:]} [{row.unit}]."""',
        *(f"{given} = float({given})" for given in used),
        *write_lines(with_short_temporaries(program), "numba"),
        f"return {program.outputs[0]}",
    ]
    return "\n".join(["@scalar", f"def {name}({', '.join(inputs)}):", *indented(lines), ""])
