"""Tables in Programs: every spelling of a lookup is the polynomial of the piece that holds, exactly."""

import itertools
import math

import mpmath
import numpy as np
import pytest

from desaxe.compiler.builder import module_text, with_sources
from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.kernel import hoist
from desaxe.compiler.languages import language_of
from desaxe.compiler.languages.arrays import compile_arrays
from desaxe.compiler.languages.python import compile_python
from desaxe.compiler.passes.differentiate import with_derivatives
from desaxe.compiler.passes.double_double import double_double
from desaxe.compiler.passes.fold import fold_constants
from desaxe.compiler.passes.value_numbering import value_numbering
from desaxe.compiler.program import Line, Program, ProgramError, TableName, tables_in, validate
from desaxe.mechanism.constants import double_constants
from desaxe.runtime.executor import CompiledKernel
from tests.compiler.languages.modules import module, written
from tests.compiler.languages.runners import RUNNERS, caller
from tests.compiler.programs import run_exactly

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
EVEN = tuple(k / 4 for k in range(40)), tuple(float(k % 7) for k in range(4 * 2 * 41))
POINTS = [*itertools.product(map(float, EVERY), (1.0, -1.0, 0.0))]
ODD = (math.nan, math.inf, -math.inf, 1e300, -1e300)


def truth(x, way):
    """The piece, its value and its slope, from the definition."""
    piece = sum(knot <= x for knot in KNOTS)
    s = mpmath.mpf(x) - KNOTS[max(piece - 1, 0)]
    number = piece + (len(KNOTS) + 1) * (way < 0)
    a, b, c, d = (mpmath.mpf(v) for v in ROWS[4 * number : 4 * number + 4])
    return number, a + s * b + s**2 * c + s**3 * d, b + 2 * s * c + 3 * s**2 * d


def agrees(point, result):
    piece, *numbers = truth(*point)
    scale = 1e-15 * 60 * (1 + abs(point[0])) ** 3
    close = (abs(own - right) <= scale for own, right in zip(result[1:], numbers, strict=True))
    return result[0] == piece and all(close)


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


def test_llvm():
    x, way = np.array(POINTS).T
    for knots, rows in ((KNOTS, ROWS), EVEN):
        outs = [np.empty(len(POINTS)) for _ in PROGRAM.outputs]
        values = {"x": x, "way": way, "F_x": np.array(knots), "F_c": np.array(rows)}
        kernel = hoist(PROGRAM, {"x": 0, "way": 0}, 1)._replace(given=("F",))
        CompiledKernel(kernel).run(values, outs)
        scopes = (run_in_doubles(PROGRAM, {"x": a, "way": b, "F": (knots, rows)}) for a, b in POINTS)
        assert np.array(outs).T.tolist() == [[scope[name] for name in PROGRAM.outputs] for scope in scopes]


def test_numpy():
    x, way = np.array(POINTS).T
    result = compile_arrays(PROGRAM, np)(x, way, np.array(KNOTS), np.array(ROWS))
    assert np.array(result).T.tolist() == [in_doubles(PROGRAM, point) for point in POINTS]
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


@pytest.mark.parametrize("language", [name for name in RUNNERS if name != "numba"])
def test_every_other_language_looks_up_as_the_interpreter(language, tmp_path):
    """C to the last bit."""
    made = module(PROGRAM)._replace(tables={"F": (KNOTS, ROWS)})
    place = written(language_of(language), made, tmp_path)
    nothing = () if language == "jax" else ((math.nan, 1.0), (math.nan, -1.0))  # XLA finds a piece
    points = [*POINTS, *nothing]
    columns = [column.copy() for column in np.array(points).T]
    result = caller(language, place, PROGRAM.inputs, PROGRAM.outputs)(columns)
    rows = np.array([result[name] for name in PROGRAM.outputs]).T
    rtol, atol = (0, 0) if language == "c" else (1e-14, 1e-13)
    np.testing.assert_allclose(rows, [in_doubles(PROGRAM, p) for p in points], rtol=rtol, atol=atol)


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
