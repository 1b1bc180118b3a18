"""numba behind the Protocol of all languages: functions of one output each."""

from desaxe.compiler.languages import languages
from desaxe.compiler.languages.numba.language import Numba
from desaxe.compiler.program import Line, Program
from tests.compiler.languages.modules import written
from tests.compiler.languages.tools import imported

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


def test_it_alone_takes_loop_nests():
    assert [language.name for language in languages() if language.loops] == ["numba"]
