"""Tables in Programs: every spelling of a lookup is the polynomial of the piece that holds, exactly."""

import itertools
import math
import subprocess

import mpmath
import numpy as np
import pytest

from desaxe.compiler.builder import module_text, with_sources
from desaxe.compiler.interpret import run_exactly, run_in_doubles
from desaxe.compiler.languages.arrays import compile_arrays
from desaxe.compiler.languages.c import C
from desaxe.compiler.languages.jax import Jax
from desaxe.compiler.languages.octave import Octave
from desaxe.compiler.languages.protocol import Forms, Module, Symbol
from desaxe.compiler.languages.python import compile_python
from desaxe.compiler.passes.differentiate import with_derivatives
from desaxe.compiler.passes.double_double import double_double
from desaxe.compiler.passes.fold import fold_constants
from desaxe.compiler.passes.value_numbering import value_numbering
from desaxe.compiler.program import Line, Program, ProgramError, TableName, tables_in, validate
from desaxe.mechanism.constants import constants, double_constants
from tests.compiler.languages.tools import jax_in_doubles, tool

KNOTS = (0.25, 0.5, 1.75, 1.75, 3.0)  # a place given twice is a jump
ROWS = tuple(np.random.default_rng(3).integers(-8, 9, 4 * 2 * (len(KNOTS) + 1)).astype(float).tolist())
TABLE = TableName("F")
LINES = (
    Line("p", "lookup_piece", ("x", TABLE, "way")),
    Line("v", "lookup", ("x", TABLE, "p")),
    Line("d", "lookup_slope", ("x", TABLE, "p")),
)
PROGRAM = validate(Program(("x", "way"), LINES, ("p", "v", "d"), {}))
EVERY = (*KNOTS, *np.nextafter(KNOTS, -9.0), *np.nextafter(KNOTS, 9.0), -7.0, 0.0, -0.0, 2.0, 9.0)
POINTS = [*itertools.product(map(float, EVERY), (1.0, -1.0, 0.0))]
ODD = (math.nan, math.inf, -math.inf, 1e300, -1e300)


def truth(x, way):
    """The piece, its value and its slope, from the definition."""
    piece = sum(knot <= x for knot in KNOTS)
    s = mpmath.mpf(x) - KNOTS[max(piece - 1, 0)]
    number = piece + (len(KNOTS) + 1) * (way < 0)
    a, b, c, d = (mpmath.mpf(v) for v in ROWS[4 * number : 4 * number + 4])
    return number, a + s * b + s**2 * c + s**3 * d, b + 2 * s * c + 3 * s**2 * d


def agrees(point, found):
    piece, *numbers = truth(*point)
    scale = 1e-15 * 60 * (1 + abs(point[0])) ** 3
    close = (abs(own - right) <= scale for own, right in zip(found[1:], numbers, strict=True))
    return found[0] == piece and all(close)


def in_doubles(program, point):
    scope = run_in_doubles(program, {"x": point[0], "way": point[1], "F": (KNOTS, ROWS)})
    return [scope[name] for name in program.outputs]


def test_the_interpreter_and_python_are_the_polynomial_of_the_piece_that_holds():
    compiled = compile_python(PROGRAM)
    for point in POINTS:
        with mpmath.workdps(40):
            exact = run_exactly(PROGRAM, mpmath.mp, {"x": point[0], "way": point[1], "F": (KNOTS, ROWS)})
            assert (int(exact["p"]), exact["v"], exact["d"]) == truth(*point)
            assert agrees(point, in_doubles(PROGRAM, point))
        assert list(compiled(*point, KNOTS, ROWS)) == in_doubles(PROGRAM, point)


def test_what_is_no_place_is_looked_up_all_the_same():
    for x in ODD:
        piece, value, slope = compile_python(PROGRAM)(x, 1.0, KNOTS, ROWS)
        assert piece in (0.0, len(KNOTS))
        assert math.isfinite(x) or math.isnan(value) or math.isinf(value)
        del slope


def test_numpy():
    x, way = np.array(POINTS).T
    found = compile_arrays(PROGRAM, np)(x, way, np.array(KNOTS), np.array(ROWS))
    assert np.array(found).T.tolist() == [in_doubles(PROGRAM, point) for point in POINTS]
    with np.errstate(all="ignore"):
        pieces = compile_arrays(PROGRAM, np)(np.array(ODD), 1.0, np.array(KNOTS), np.array(ROWS))[0]
    assert set(pieces.tolist()) <= {0.0, 5.0}


LOOK = """@njit
def look(x, way, F_x, F_c):
    p = lookup_piece(x, F_x, way)
    return p, lookup(x, F_x, F_c, p), lookup_slope(x, F_x, F_c, p)
"""


def test_numba():
    scope = {}
    exec(module_text("Lookups.", with_sources([LOOK], jit="@njit\n", imports={"njit": "numba"})), scope)
    for point in POINTS:
        assert list(scope["look"](*point, np.array(KNOTS), np.array(ROWS))) == in_doubles(PROGRAM, point)
    assert scope["look"](math.nan, 1.0, np.array(KNOTS), np.array(ROWS))[0] == 0.0


def module(name):
    """A module of the program, whose values are its outputs; the status is 0."""
    lines = (*LINES, Line("status", "copy", (0,), "i64"))
    program = Program(("x", "way"), lines, ("p", "v", "d", "status"), {})
    symbols = [Symbol(n, "1", n) for n in ("x", "way", "p", "v", "d")]
    values = {n: Program(("x", "way"), LINES, (n,), {}) for n in ("p", "v", "d")}
    values = {n: validate(value_numbering(program)) for n, program in values.items()}
    return Module(
        name, ("Lookups.",), tuple(symbols[:2]), tuple(symbols[2:]), Forms(3, program), constants(),
        {n: {} for n in values}, values, tables={"F": (KNOTS, ROWS)},
    )  # fmt: skip


def test_c(tmp_path):
    for freestanding in (False, True):
        for name, text in C().files(module("looks"), freestanding).items():
            (tmp_path / name).write_text(text)
        rows = ", ".join(f"{{{x.hex()}, {way}}}" for x, way in POINTS)
        (tmp_path / "main.c").write_text(
            '#include "looks.h"\n#include <stdio.h>\nstatic const double in[][2] = {' + rows + "};\n"
            "int main(void) { double out[3]; "
            f"for (int k = 0; k < {len(POINTS)}; k++) {{ looks_point(in[k], out);"
            ' printf("%a %a %a\\n", out[0], out[1], out[2]); } return 0; }\n'
        )
        flags = [
            "-std=c99",
            "-O2",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-Wno-unused-function",
            "-ffp-contract=off",
            "-fsanitize=undefined",
        ]
        files = ["looks.c", "main.c", "-o", "run", *([] if freestanding else ["-lm"])]
        subprocess.run([tool("gcc"), *flags, *files], cwd=tmp_path, check=True)
        told = subprocess.run(["./run"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
        found = [[float.fromhex(word) for word in line.split()] for line in told.splitlines()]
        assert found == [in_doubles(PROGRAM, point) for point in POINTS]


def test_octave(tmp_path):
    (tmp_path / "looks.m").write_text(Octave().files(module("looks"))["looks.m"])
    x, way = (" ".join(map(repr, column)) for column in zip(*POINTS, strict=True))
    code = f"[p, v, d] = looks([{x}], [{way}]); printf('%.17g %.17g %.17g\\n', [p; v; d]);"
    code += "[p, v, d] = looks(0.3, 1); disp(size(v)); p = looks(NaN, -1); disp(p);"
    run = [tool("octave-cli"), "--eval", code]
    told = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    *lines, size, odd = told.strip().splitlines()
    found = [list(map(float, line.split())) for line in lines]
    np.testing.assert_allclose(found, [in_doubles(PROGRAM, p) for p in POINTS], rtol=1e-14, atol=1e-13)
    assert (size.split(), odd.split()) == (["1", "1"], [str(len(KNOTS) + 1)])


def test_jax():
    scope = {}
    x, way = np.array(POINTS).T
    with jax_in_doubles():
        exec(Jax().files(module("looks"))["looks.py"], scope)
        found = scope["evaluate"](x=x, way=way)
        rows = np.array([found[n] for n in ("p", "v", "d")]).T
    np.testing.assert_allclose(rows, [in_doubles(PROGRAM, p) for p in POINTS], rtol=1e-14, atol=1e-13)


def test_passes_keep_lookups_or_refuse_them_by_name():
    fixed = Program((), (Line("v", "lookup", (1.0, TABLE, 2.0)),), ("v",), {})
    assert fold_constants(fixed).lines == fixed.lines
    twice = (*LINES, Line("again", "lookup", ("x", TABLE, "p")), Line("sum", "add", ("v", "again")))
    merged = value_numbering(Program(("x", "way"), twice, ("sum",), {}))
    assert [line.op for line in merged.lines] == ["lookup_piece", "lookup", "add"]
    assert tables_in(merged) == ["F"]
    wide = double_double(PROGRAM, double_constants())
    assert all(in_doubles(wide, point) == in_doubles(PROGRAM, point) for point in POINTS)
    slopes = with_derivatives(Program(("x", "way"), LINES[:2], ("v",), {}), ("x",))
    for point in POINTS:
        assert in_doubles(slopes, point)[1] == in_doubles(PROGRAM, point)[2]
    with pytest.raises(ProgramError, match="slope of the table F"):
        with_derivatives(PROGRAM, ("x",))
