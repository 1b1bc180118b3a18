"""numba behind the Protocol of all languages: functions of one output each."""

import pytest

from desaxe.compiler.languages import languages
from desaxe.compiler.languages.numba.language import Numba
from desaxe.compiler.program import Line, Program
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import module, wrong_names
from tests.compiler.languages.tools import imported

CALLS = Program(
    ("x", "y"),
    (Line("u", "mul_add", ("x", "y", 2.0)), Line("far", "sqrt", ("u",)), Line("near", "add", ("u", "y"))),
    ("far", "near"),
    {},
)
ROUNDED = Program(("x", "y"), (Line("lost", "two_sum_error", ("x", "y")),), ("lost",), {})


def made(program, folder):
    (text,) = Numba().files(module(program)).values()
    (folder / "made.py").write_text(text, encoding="utf-8")
    return imported(folder / "made.py")


def test_a_function_for_each_output(tmp_path):
    press = made(CALLS, tmp_path)
    assert press.far(3.0, 2) == 8.0**0.5
    assert press.near(3.0, 2) == 10.0
    assert press.far.__doc__ == "A result [1]."


def test_what_a_function_calls_is_plain_python_too(tmp_path):
    """Without a wrapper for Python, numba would end the process here."""
    press = made(ROUNDED, tmp_path)
    assert press.lost.py_func(1.0, 2.0**-60) == press.lost(1.0, 2.0**-60) == 2.0**-60


@pytest.mark.thorough
def test_the_coverage_set_against_exact(tmp_path):
    press = made(coverage(), tmp_path)
    for point in POINTS:
        values = [point[name] for name in coverage().inputs]
        assert not wrong_names({name: float(getattr(press, name)(*values)) for name in NAMES}, point), point


def test_it_alone_takes_loop_nests():
    assert [language.name for language in languages() if language.loops] == ["numba"]
