"""C without libm: its own functions, in doubles and in floats."""

import random
from math import inf, nan

import numpy as np
import pytest

from desaxe.compiler.languages.c import C
from desaxe.compiler.program import Line, Program
from desaxe.mechanism.constants import single_constants
from tests.compiler.languages.modules import module, written
from tests.compiler.languages.tools import library, point_values
from tests.compiler.programs import same_bits

SPECIAL = {
    np.float64: (0.0, -0.0, 5e-324, -1e-310, 1e-160, 0.3, -0.7, 1.0, -3.5, 1e15, 4.6e15, 1e200, 1.7e308),
    np.float32: (0.0, -0.0, 1e-45, -1e-40, 0.3, -0.7, 1.0, 8388607.5, 3.4e38),
}


@pytest.mark.parametrize("kind", SPECIAL)
def test_functions_of_its_own_are_those_of_libm(kind, tmp_path):
    """To the last bit where IEEE 754 says so, an angle and a length to 4 ulp."""
    ops = [("sqrt", "x"), ("floor", "x"), ("abs", "x"), ("copysign", "x", "y"), ("atan2", "x", "y")]
    lines = tuple(Line(f"r{op}", op, args) for op, *args in (*ops, ("hypot", "x", "y")))
    made = module(Program(("x", "y"), lines, tuple(line.name for line in lines), {}))
    if kind is np.float32:
        made = made._replace(single=True, constants=single_constants())
    loaded, rng = library(written(C(), made, tmp_path, True), libm=False), random.Random(3)
    special = (*SPECIAL[kind], inf, -inf, nan)
    drawn = [rng.choice((-1, 1)) * 10 ** rng.uniform(-37, 37) for _ in range(400)]
    pairs = [*((x, y) for x in special for y in special), *zip(drawn, drawn[::-1], strict=True)]
    for x, y in np.array(pairs, kind):
        with np.errstate(all="ignore"):
            exact = np.sqrt(x), np.floor(x), np.abs(x), np.copysign(x, y)
            near = np.array([np.arctan2(x, y), np.hypot(x, y)], kind)
        _, found = point_values(loaded, "made", [x, y], 6, kind)
        assert all(map(same_bits, found, exact)), (x, y)
        np.testing.assert_array_max_ulp(np.array(found[4:], kind), near, 4)
