"""numba modules: self-contained, with literal options, right on one, two and three axes."""

import ast
import inspect
import math
import platform
import re
from functools import cache

import numpy as np
import pytest
from numba import njit

from desaxe.compiler.kernel import hoist
from desaxe.compiler.languages.numba.module import TO_COMPILE, emit_numba
from desaxe.compiler.passes.guard import guard_inputs
from desaxe.compiler.passes.trigonometry import expand_trigonometry
from desaxe.compiler.program import Line, Program
from desaxe.mechanism.constants import constants
from desaxe.mechanism.inputs import INPUTS, LEAST
from desaxe.mechanism.program import Variant
from desaxe.runtime.kernels import KernelKey, kernel_of
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import wrong_names
from tests.compiler.programs import committed, in_doubles, program_of_nested

STATUS = "state"
CALLS = program_of_nested(("atan2", ("sin", ("mul", "x", "y")), ("sqrt", ("add", "z", ("mul", "x", "x")))))


def function(source):
    scope = {}
    exec(source, scope)
    return scope["kernel"]


@cache
def coverage_kernel():
    return function(emit_numba(hoist(coverage(), {"x": 0, "y": 0, "z": 0}, 1), "The coverage set."))


def covered(**columns):
    """The outputs of the coverage kernel for these columns."""
    size = len(columns["x"])
    outs = {name: np.full(size, -1, np.int8 if name == STATUS else float) for name in NAMES}
    coverage_kernel()(*(np.ascontiguousarray(columns[name], float) for name in "xyz"), *outs.values())
    return outs


def test_the_coverage_set_against_exact():
    found = covered(**{name: [point[name] for point in POINTS] for name in "xyz"})
    for index, point in enumerate(POINTS):
        assert not wrong_names({name: float(found[name][index]) for name in NAMES}, point), point


@cache
def grid_source(axes):
    """x, y and z along the axes, in turn."""
    return emit_numba(hoist(CALLS, {"x": 0, "y": min(1, axes - 1), "z": axes - 1}, axes), "A grid.")


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_a_kernel_of_some_axes(axes):
    shape = (3, 4, 5)[:axes]
    sizes = {name: shape[axis] for name, axis in zip("xyz", (0, min(1, axes - 1), axes - 1), strict=True)}
    columns = {name: np.linspace(0.1, 2.0, size) for name, size in sizes.items()}
    out = np.empty(shape)
    function(grid_source(axes))(*columns.values(), out)
    for index in np.ndindex(shape):
        at = {"x": index[0], "y": index[min(1, axes - 1)], "z": index[axes - 1]}
        wanted = in_doubles(CALLS, {name: float(columns[name][i]) for name, i in at.items()})["out"]
        assert math.isclose(out[index], wanted, rel_tol=1e-15)


def test_a_scalar_input_has_no_axis():
    out = np.empty(2)
    kernel = function(emit_numba(hoist(CALLS, {"x": 0, "y": None, "z": None}, 1), "A row."))
    kernel(np.array([0.5, 1.5]), 2.0, 3.0, out)
    assert math.isclose(out[1], in_doubles(CALLS, {"x": 1.5, "y": 2.0, "z": 3.0})["out"], rel_tol=1e-15)


def test_an_input_may_be_read_only():
    column = np.array([0.5, 1.0])
    column.flags.writeable = False
    out = np.empty(2)
    function(grid_source(1))(column, column, column, out)
    assert np.isfinite(out).all()


def test_the_outermost_axis_can_be_empty():
    out = np.empty((0, 4))
    function(grid_source(2))(np.empty(0), np.ones(4), np.ones(4), out)
    assert out.size == 0


@cache
def real_source():
    """The text of a real kernel: guarded, with its sine and cosine written out."""
    program = guard_inputs(committed("Y", "V_C", "a_C", "status"), INPUTS, LEAST, {})
    program = expand_trigonometry(program, constants())
    return emit_numba(hoist(program, dict.fromkeys(program.inputs, 0), 1), "A real kernel.")


SOURCES = [real_source, lambda: grid_source(3)]


@pytest.mark.parametrize("source", SOURCES)
def test_only_math_numpy_and_numba_are_imported(source):
    imports = [n for n in ast.walk(ast.parse(source())) if isinstance(n, (ast.Import, ast.ImportFrom))]
    assert {str(node.module).partition(".")[0] for node in imports} <= {"math", "numpy", "numba"}


@pytest.mark.parametrize("source", SOURCES)
def test_everything_it_uses_stands_in_it(source):
    tree = ast.parse(source())
    used = {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
    }
    assert used - bound(tree) <= {"float", "range", "RuntimeError", "max", "min", "set"}


def bound(tree):
    """Every name that is imported, assigned, defined or an argument."""
    nodes = list(ast.walk(tree))
    names = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    names |= {alias.name for node in nodes if isinstance(node, ast.ImportFrom) for alias in node.names}
    return (
        names
        | {n.arg for n in nodes if isinstance(n, ast.arg)}
        | {n.name for n in nodes if isinstance(n, ast.FunctionDef)}
    )


PACKED_ROOT = r"\bv?sqrtpd\b" if platform.machine() in ("x86_64", "AMD64") else r"\bfsqrt.*\.2d\b"


def options(source):
    """The options of every call of njit, those of the kernel last."""
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    found = [node for node in calls if isinstance(node.func, ast.Name) and node.func.id == "njit"]
    return [{keyword.arg: keyword.value for keyword in node.keywords} for node in found]


@pytest.mark.parametrize("source", SOURCES)
def test_the_options_are_literals(source):
    assert all(isinstance(value, ast.Constant) for each in options(source()) for value in each.values())


@pytest.mark.parametrize("source", SOURCES)
def test_divisions_by_zero_do_not_raise_and_no_flag_erases_nan(source):
    assert options(source())
    for each in options(source()):
        assert each["error_model"].value == "numpy"
        assert not {"fastmath", "parallel"} & set(each)


def test_threads_can_share_the_kernel_and_it_is_kept_on_disk():
    named = [{name: value.value for name, value in each.items()} for each in options(real_source())]
    assert {"cache": True, "error_model": "numpy", "nogil": True} in named


def test_where_nothing_can_be_kept_it_compiles_all_the_same():
    """A module without a file has no place for machine code."""
    assert function(grid_source(1)).stats.cache_path is None


def test_the_docstring_comes_first():
    assert ast.get_docstring(ast.parse(real_source())) == "A real kernel."


def test_each_line_keeps_its_note():
    assert "  # m/s | velocity of the slider | A (11)\n" in real_source()


def test_each_axis_is_one_loop():
    functions = [node for node in ast.parse(grid_source(3)).body if isinstance(node, ast.FunctionDef)]
    (loops,) = (node for node in functions if node.name == "loops")
    assert sum(isinstance(node, ast.For) for node in ast.walk(loops)) == 3


def test_a_loop_of_many_outputs_runs_several_points_at_once():
    """So many pairs of arrays might overlap that LLVM does not look: it must have been promised."""
    count = 24
    lines = [Line(f"s{k}", "add", ("x", k + 1.0)) for k in range(count)]
    lines += [Line(f"out{k}", "sqrt", (f"s{k}",)) for k in range(count)]
    program = Program(("x",), tuple(lines), tuple(f"out{k}" for k in range(count)), {})
    scope = {}
    exec(emit_numba(hoist(program, {"x": 0}, 1), "many outputs"), scope)
    (text,) = scope["kernel"].inspect_asm().values()
    assert len(re.findall(PACKED_ROOT, text)) >= count
    x, outs = np.linspace(0, 1, 37), [np.empty(37) for _ in range(count)]
    scope["kernel"](x, *outs)
    for k, out in enumerate(outs):
        assert np.array_equal(out, np.sqrt(x + (k + 1.0)))


def test_both_forms_of_a_kernel_run_several_points_at_once():
    """The stable loops read and write by pointers, of which LLVM must know that they do not overlap."""
    axes = tuple((name, 0) for name in ("AB", "BC", "ec", "theta"))
    key = KernelKey(("V_C", "a_C"), Variant(), (("alpha", 0.0), ("branch", 1.0)), axes, 1)
    counts = []
    for form in (Variant(wide_margins=True), Variant()):
        scope = {}
        exec(emit_numba(kernel_of(key._replace(form=form)), "", TO_COMPILE), scope)
        compiled = njit(scope["signature"], error_model="numpy")(scope["function"])
        (text,) = compiled.inspect_asm().values()
        counts.append(len(re.findall(PACKED_ROOT, text)))
    assert counts[1] > counts[0] > 0


WIDE = 'WIDE = "+avx512f" in codegen.get_host_cpu_features()'


@cache
def with_vectors(wide):
    """A kernel of columns for wide or narrow vectors, and the names of its arguments."""
    axes = tuple((name, 0) for name in ("AB", "BC", "ec", "theta"))
    text = emit_numba(
        kernel_of(KernelKey(("V_C", "a_C"), Variant(), (("alpha", 0.0), ("branch", 1.0)), axes, 1)),
        "",
        TO_COMPILE,
    )
    assert text.count(WIDE) == 1
    scope = {}
    exec(text.replace(WIDE, f"WIDE = {wide}"), scope)
    names = [name.removesuffix("_axis") for name in inspect.signature(scope["function"]).parameters]
    return njit(scope["signature"], error_model="numpy")(scope["function"]), names


@pytest.mark.thorough
@pytest.mark.parametrize("size", [7, 520, 1100])
def test_one_loop_or_two_have_the_same_digits(size):
    """The plain form runs in stages where vectors are narrow: both ways exist on every machine."""
    rng = np.random.default_rng(size)
    given = {"theta": rng.uniform(-9.0, 9.0, size), "ec": rng.uniform(-0.1, 0.1, size), "omega0": 157.0}
    given["AB"] = rng.uniform(0.1, 0.13, size)
    reach = given["AB"] + np.abs(given["ec"])
    given["BC"] = reach * (1.0 + 10.0 ** rng.uniform(-4.0, 0.5, size))  # half are close
    given["theta"][::5], given["BC"][3::50] = np.nan, np.inf
    found = []
    for wide in (True, False):
        kernel, names = with_vectors(wide)
        outs = np.zeros((2, size))
        found.append((kernel(*(given[name] for name in names[:-2]), *outs), outs))
    assert found[0][0] == found[1][0]
    np.testing.assert_array_equal(found[0][1], found[1][1])
    assert np.isnan(found[0][1]).any()
    assert np.isfinite(found[0][1]).any()
