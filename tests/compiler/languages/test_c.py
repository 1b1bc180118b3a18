"""The C column: each operation, each way to nest two, each helper, with libm and without."""

import math

import pytest

from desaxe.compiler.languages.c import C
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.program import Line, Program
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import module, wrong_names
from tests.compiler.languages.tools import library, point_values


def compiled(program, folder, freestanding=False):
    for file, text in C().files(module(program), freestanding).items():
        (folder / file).write_text(text, encoding="utf-8")
    return library(folder / "made.c", libm=not freestanding)


@pytest.mark.parametrize("freestanding", [False, True])
def test_the_coverage_set_against_exact(freestanding, tmp_path):
    names = [name for name in NAMES if name != "grown" or not freestanding]
    program = keep_outputs(coverage(), names)
    loaded = compiled(program, tmp_path, freestanding)
    for point in POINTS:
        _, values = point_values(loaded, "made", [point[n] for n in program.inputs], len(names))
        answers = dict(zip(names, values, strict=True))
        assert not wrong_names(answers, point), point


def test_what_bare_metal_lacks_is_refused_by_name(tmp_path):
    with pytest.raises(ValueError, match="without libm has no exp, log, pow"):
        compiled(keep_outputs(coverage(), ["grown"]), tmp_path, freestanding=True)


SPECIAL = (0.0, -0.0, 5e-324, -1e-310, 1e-160, 0.3, -0.7, 1.0, -3.5, 1e15, 4.6e15, 1e200, 1.7e308,
           math.inf, -math.inf, math.nan)  # fmt: skip


def test_functions_of_its_own_are_those_of_libm(tmp_path):
    """To the last bit where IEEE 754 says so, an angle to 4 ulp."""
    ops = (("sqrt", "x"), ("floor", "x"), ("abs", "x"), ("copysign", "x", "y"), ("atan2", "x", "y"))
    lines = tuple(Line(f"r{op}", op, args) for op, *args in ops)
    program = Program(("x", "y"), lines, tuple(line.name for line in lines), {})
    own = compiled(program, tmp_path, freestanding=True)
    for x in SPECIAL:
        for y in SPECIAL:
            _, (root, floor, size, signed, angle) = point_values(own, "made", [x, y], 5)
            assert root == math.sqrt(x) if x >= 0 else math.isnan(root)
            assert math.copysign(1, floor) == math.copysign(1, x)
            assert floor == (math.floor(x) if math.isfinite(x) else x) or math.isnan(x)
            assert size == abs(x) or math.isnan(x)
            assert math.isnan(x) or signed == math.copysign(x, y)
            wanted = math.atan2(x, y)
            assert abs(angle - wanted) <= 4 * math.ulp(wanted) or math.isnan(wanted), (x, y)
            assert math.isnan(wanted) == math.isnan(angle)
