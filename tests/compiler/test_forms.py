"""Two forms in one kernel: a point gets the one that its own test says, wherever it stands."""

from functools import cache

import numpy as np
import pytest

from desaxe.compiler.forms import in_two_forms, parted
from desaxe.compiler.kernel import hoist, tabulate
from desaxe.compiler.program import Line, Program, validate
from desaxe.runtime.executor import CompiledKernel

# The forms differ on purpose, so that a result tells which one it is from.
PLAIN = Program(("x", "y"), (Line("s", "sin", ("x",)), Line("out", "add", ("s", "y"))), ("out", "x"), {})
STABLE = Program(("x", "y"), (Line("s", "sin", ("x",)), Line("out", "sub", ("s", "y"))), ("out", "x"), {})
TEST = Program(("y",), (Line("t", "abs", ("y",)), Line("fine", "lt", ("t", 1.0), "bool")), ("fine",), {})
BOTH = in_two_forms(PLAIN, STABLE, TEST)


@cache
def kernel_for(x_axis, y_axis, place=hoist):
    kernel = parted(place(BOTH, {"x": x_axis, "y": y_axis}, 1 + max(x_axis, y_axis)), 2)
    compiled = CompiledKernel(kernel)
    return kernel, lambda x, y, *outs: compiled.run({"x": x, "y": y}, outs)


def varies_inside(kernel):
    """True if the test changes from point to point of the innermost axis."""
    return bool(kernel.close.test_lines)


def wanted(x, y):
    return np.where(np.abs(y) < 1, np.sin(x) + y, np.sin(x) - y)


def test_equal_lines_are_computed_once():
    assert [line.op for line in validate(BOTH).lines].count("sin") == 1


@pytest.mark.parametrize("size", [1, 7, 511, 512, 513, 3_000])
@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 1.0])
def test_each_point_has_the_form_that_its_test_says(size, share):
    kernel, run = kernel_for(0, 0)
    assert varies_inside(kernel)
    rng = np.random.default_rng(size)
    x = rng.uniform(-3, 3, size)
    y = np.where(rng.random(size) < share, 2.0, 0.5)
    out, echo = np.full(size, np.nan), np.full(size, np.nan)
    run(x, y, out, echo)
    assert np.array_equal(out, wanted(x, y))
    assert np.array_equal(echo, x)


@pytest.mark.parametrize("place", [hoist, tabulate])
def test_a_test_of_an_outer_axis_picks_the_loop(place):
    kernel, run = kernel_for(1, 0, place)
    assert not varies_inside(kernel)
    x, y = np.linspace(-3, 3, 40), np.array([0.5, 2.0, -0.1, np.nan])
    out, echo = np.empty((4, 40)), np.empty((4, 40))
    run(x, y, out, echo)
    assert np.array_equal(out, wanted(x, y[:, None]), equal_nan=True)


@pytest.mark.parametrize("place", [hoist, tabulate])
def test_tables_and_blocks_go_together(place):
    kernel, run = kernel_for(1, 0, place)
    other, again = kernel_for(0, 1, place)
    assert varies_inside(other)
    assert not varies_inside(kernel)
    x, y = np.linspace(-3, 3, 9), np.linspace(-2, 2, 700)
    (out, echo), (rotated_sin, echoed) = ([np.empty(s), np.empty(s)] for s in ((700, 9), (9, 700)))
    run(x, y, out, echo)
    again(x, y, rotated_sin, echoed)
    assert np.array_equal(out.T, rotated_sin)


def test_an_output_may_come_from_a_table_whole():
    """It lacks an axis between its own: the stable loop has nothing to compute, and passes it on."""
    product = Line("p", "mul", ("x", "y"))
    sine, cosine = (Program(("x", "y"), (product, Line("out", op, ("p",))), ("out",), {}) for op in FORMS)
    kernel = parted(tabulate(in_two_forms(sine, cosine, TEST), {"x": 0, "y": 2}, 3), 1)
    assert varies_inside(kernel)
    assert kernel.tables[0].kernel.outputs == ("out", "out_close")
    x, y, out = np.linspace(-3, 3, 4), np.linspace(-2, 2, 700), np.empty((4, 5, 700))
    CompiledKernel(kernel).run({"x": x, "y": y}, [out])
    p = x[:, None, None] * y
    np.testing.assert_allclose(out, np.where(np.abs(y) < 1, np.sin(p), np.cos(p)) + 0 * out, rtol=1e-14)


FORMS = ("sin", "cos")


def test_a_test_that_is_not_known_is_not_passed():
    _, run = kernel_for(0, 0)
    out, echo = np.zeros(3), np.zeros(3)
    run(np.zeros(3), np.array([0.5, np.nan, 0.25]), out, echo)
    assert np.array_equal(out, [0.5, np.nan, 0.25], equal_nan=True)


@pytest.mark.parametrize("axes", [{"x": 0, "y": 0}, {"y": 0, "x": 1}])
def test_a_kernel_tells_how_many_of_its_points_are_undecided(axes):
    """Of those in the stable form alone, in loops that a block or an outer axis picks."""
    low = Line("low", "lt", ("x", 0.0), "bool")
    unsure = STABLE._replace(lines=(*STABLE.lines, low), outputs=(*STABLE.outputs, "low"))
    kernel = parted(hoist(in_two_forms(PLAIN, unsure, TEST), axes, len(set(axes.values()))), 2)
    x, y = np.linspace(-3, 3, 60), np.where(np.arange(60) % 3, 0.5, 2.0)
    shape = (60,) if axes["x"] == axes["y"] else (60, 60)
    close = np.broadcast_to(y if len(shape) == 1 else y[:, None], shape) >= 1
    outs = np.empty(shape), np.empty(shape)
    assert CompiledKernel(kernel).run({"x": x, "y": y}, outs) == (close & (x < 0)).sum()
