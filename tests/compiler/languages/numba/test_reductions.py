"""Kernels with a reduced axis, against NumPy on the values themselves."""

import numpy as np
import pytest

from desaxe.compiler.kernel import tabulate
from desaxe.compiler.languages.numba.reductions import KINDS, LONGEST, SCRATCH, emit_reduced, outputs_of
from desaxe.compiler.program import Line, Note, Program
from desaxe.runtime.native.modules import native_here

# f = a x + b: over a, b (designs) and x (reduced).
PROGRAM = Program(
    ("x", "a", "b"),
    (Line("ax", "mul", ("a", "x")), Line("f", "add", ("ax", "b"))),
    ("f",),
    {"f": Note("1", "a x + b")},
)


@pytest.fixture(scope="module")
def reduced():
    """The kernel of all kinds, as a function of x, a and b that gives the outputs by name."""
    kernel = tabulate(PROGRAM, {"x": 2, "a": 0, "b": 1}, 3)
    function = native_here(emit_reduced(kernel, tuple(KINDS), "a x + b"), {})

    def run(x, a, b):
        outs = {name: np.empty((a.size, b.size), kind) for name, kind in outputs_of(("f",), tuple(KINDS))}
        function(x, a, b, x.size, *outs.values())
        return outs

    return run


@pytest.mark.parametrize("length", [1, 15, 16, 17, 100, LONGEST, LONGEST + 1, 2 * LONGEST + 17])
def test_rows_of_any_length(reduced, length):
    rng = np.random.default_rng(length)
    x, a, b = rng.normal(size=length), rng.normal(size=37), rng.normal(size=3)
    x[rng.random(length) < 0.2] = np.nan
    x[0] = 1.0
    f = a[:, None, None] * x + b[:, None]
    found = reduced(x, a, b)
    good = ~np.isnan(f)
    np.testing.assert_array_equal(found["f_max"], np.nanmax(f, -1))
    np.testing.assert_array_equal(found["f_min"], np.nanmin(f, -1))
    np.testing.assert_array_equal(found["f_absmax"], np.nanmax(abs(f), -1))
    np.testing.assert_array_equal(found["f_max_place"], np.nanargmax(f, -1))
    np.testing.assert_array_equal(found["f_min_place"], np.nanargmin(f, -1))
    np.testing.assert_array_equal(found["f_absmax_place"], np.nanargmax(abs(f), -1))
    np.testing.assert_array_equal(found["f_count"], good.sum(-1))
    np.testing.assert_allclose(found["f_mean"], np.nanmean(f, -1), rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(found["f_rms"], np.sqrt(np.nanmean(f * f, -1)), rtol=1e-14)


@pytest.mark.thorough
def test_more_designs_than_a_block(reduced):
    x, a, b = np.linspace(-1, 1, 5), np.linspace(0, 1, SCRATCH // 4), np.arange(3.0)
    found = reduced(x, a, b)
    np.testing.assert_array_equal(found["f_max"], a[:, None] + b)
    np.testing.assert_array_equal(found["f_min"], b - a[:, None])


def test_the_first_of_equals(reduced):
    x = np.tile([0.0, 2.0, -2.0], 20)
    found = reduced(x, np.ones(1), np.zeros(1))
    assert found["f_max_place"].item() == 1
    assert found["f_min_place"].item() == 2
    assert found["f_absmax_place"].item() == 1


def test_nothing_and_infinities(reduced):
    nothing = reduced(np.full(20, np.nan), np.ones(1), np.zeros(1))
    assert nothing["f_count"].item() == 0
    assert nothing["f_max_place"].item() == -1
    assert all(np.isnan(nothing[f"f_{kind}"]).all() for kind in KINDS)
    endless = reduced(np.array([np.nan, -np.inf, -np.inf]), np.ones(1), np.zeros(1))
    assert (endless["f_max"].item(), endless["f_max_place"].item()) == (-np.inf, 1)
    assert endless["f_mean"].item() == -np.inf
    zeros = reduced(np.zeros(40), np.ones(1), np.zeros(1))
    assert zeros["f_rms"].item() == 0.0


def test_sums_keep_what_rounding_takes(reduced):
    x = np.tile([1e16, 1.0, -1e16], 1000)
    found = reduced(x, np.ones(1), np.zeros(1))
    assert found["f_mean"].item() == 1000.0 / 3000.0


@pytest.mark.parametrize("scale", [1e-300, 1e-160, 1e150, 1e300])
def test_squares_of_any_scale(reduced, scale):
    x = np.concatenate([np.full(LONGEST, scale), np.full(LONGEST, 3e-3), np.full(LONGEST, 2.0)])
    found = reduced(x, np.ones(1), np.zeros(1))
    largest = x.max()
    wanted = np.sqrt(np.mean((x / largest) ** 2)) * largest
    assert found["f_rms"].item() == pytest.approx(wanted, rel=1e-14)
