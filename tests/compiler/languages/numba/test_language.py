"""numba behind the Protocol of all languages: functions of one output each, loops of vectors, options."""

import ast
import platform
import re
from importlib import import_module

import numba
import numpy as np
import pytest

from desaxe.compiler.languages.numba.language import Numba
from desaxe.compiler.program import Line, Program
from tests.compiler.languages.modules import module, written
from tests.compiler.languages.tools import imported

PACKED_ROOT = r"\bv?sqrtpd\b" if platform.machine() in ("x86_64", "AMD64") else r"\bfsqrt.*\.2d\b"
CALLS = Program(
    ("x", "y"),
    (Line("u", "mul_add", ("x", "y", 2.0)), Line("far", "sqrt", ("u",)), Line("near", "add", ("u", "y"))),
    ("far", "near"),
    {},
)
ROUNDED = Program(("x", "y"), (Line("lost", "two_sum_error", ("x", "y")),), ("lost",), {})


def test_a_function_for_each_output(tmp_path):
    press = imported(written(Numba(), CALLS, tmp_path))
    assert press.far(3.0, 2) == 8.0**0.5
    assert press.near(3.0, 2) == 10.0
    assert press.far.__doc__ == "A result [1]."


def test_what_a_function_calls_is_plain_python_too(tmp_path):
    """Without a wrapper for Python, numba would end the process here."""
    press = imported(written(Numba(), ROUNDED, tmp_path))
    assert press.lost.py_func(1.0, 2.0**-60) == press.lost(1.0, 2.0**-60) == 2.0**-60


def test_a_loop_of_many_outputs_runs_several_points_at_once(tmp_path):
    """So many pairs of arrays might overlap that LLVM does not look: it must have been promised."""
    count = 24
    lines = [Line(f"s{k}", "add", ("x", k + 1.0)) for k in range(count)]
    lines += [Line(f"out{k}", "sqrt", (f"s{k}",)) for k in range(count)]
    program = Program(("x",), tuple(lines), tuple(f"out{k}" for k in range(count)), {})
    many = imported(written(Numba(), module(program)._replace(functions=False), tmp_path))
    x = np.linspace(0, 1, 37)
    for k, out in enumerate(many.evaluate(x).values()):
        assert np.array_equal(out, np.sqrt(x + (k + 1.0)))
    assert _roots_of_vectors(many.fill) >= count


@pytest.mark.parametrize("group", ["motion", pytest.param("sensitivities", marks=pytest.mark.thorough)])
def test_both_forms_run_several_points_at_once(group):
    """The stable lines too, in a loop of their own, of however many outputs."""
    group = import_module(f"desaxe.generated.{group}")
    group.evaluate([0.0, 1.0], 0.0, 0.1, 0.3, 1.0)
    again = numba.njit(error_model="numpy")(group.fill.py_func)  # what the cache has cannot be looked at
    again.compile(group.fill.signatures[0])
    assert _roots_of_vectors(again) >= 4


def _roots_of_vectors(function):
    """The number of square roots of vectors in the machine code of a function."""
    (text,) = function.inspect_asm().values()
    return len(re.findall(PACKED_ROOT, text))


def test_the_options_are_literals_and_no_flag_erases_nan():
    (text,) = Numba().files(module(CALLS)).values()
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    options = [node.keywords for node in calls if isinstance(node.func, ast.Name) and node.func.id == "njit"]
    assert options
    for each in options:
        given = {keyword.arg: keyword.value.value for keyword in each}  # of a constant
        assert given["error_model"] == "numpy"
        assert not {"fastmath", "parallel"} & set(given)
    assert {"cache", "error_model", "nogil"} in [{keyword.arg for keyword in each} for each in options]
