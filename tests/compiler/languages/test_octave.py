"""Octave: signs of zeros, real numbers alone, and arrays that broadcast."""

import numpy as np
import pytest

from desaxe.compiler.languages.octave import Octave
from desaxe.compiler.program import Line, Program
from tests.compiler.languages.modules import written
from tests.compiler.languages.tools import octave, run, tool


def test_zeros_have_a_sign_and_nothing_is_complex(tmp_path):
    lines = (Line("signed", "copysign", (2.0, "x")), Line("rooted", "sqrt", ("x",)))
    program = Program(("x", "y"), lines, ("signed", "rooted"), {})
    columns = [np.array([0.0, -0.0, -1.0, np.nan, 4.0]), np.array([1.0])]
    signed, rooted = octave(written(Octave(), program, tmp_path), columns, 2)
    np.testing.assert_array_equal(signed[[0, 1, 2, 4]], [2.0, -2.0, -2.0, 2.0])
    np.testing.assert_array_equal(rooted, [0.0, 0.0, np.nan, np.nan, 2.0])


@pytest.mark.parametrize("given", ["'a'", '"1"', "{1}", "1i", "struct()"])
def test_what_is_no_number_is_refused_by_name(given, tmp_path):
    file = written(Octave(), Program(("x",), (Line("twice", "add", ("x", "x")),), ("twice",), {}), tmp_path)
    code = f'try; made({given}); catch error; printf("%s", error.message); end; made(int8(4)); made(true);'
    said = run(tool("octave-cli"), "--norc", "--quiet", "--eval", code, cwd=file.parent)
    assert said.startswith("x: expected real numbers in SI units")
