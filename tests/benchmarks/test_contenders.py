"""Every contender that is installed computes every work: its values are the truth's, at a few points."""

import math
from functools import cache

import mpmath
import numpy as np
import pytest

from benchmarks.contenders import CONTENDERS, MACHINE
from benchmarks.work import BY_KEY, DEGREE, LIMITS, OMEGA0, PARAMETERS, WORKS
from desaxe.oracle.truth import truth

HERE = [one for one in CONTENDERS if one.is_here]
COUNTS = {"sweep": 9, "sweeps": 4 * 720, "grid": 40_000, "grid_out": 40_000, "peak": 3}
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def answers(contender, work, threads=1):
    """The inputs and the arrays."""
    inputs = work.inputs(COUNTS.get(work.key, 7))
    out = [np.zeros(inputs.shape) for _ in work.names] if work.given else None
    return inputs, contender.load()(work, inputs, out, threads)()


@cache
def exact(name, point):
    return truth(name, alpha=0.0, **dict(point))


def point_of(inputs, index):
    """The inputs at an index of the answers."""
    columns = {name: column[index[inputs.axis[name]]] for name, column in inputs.columns.items()}
    return tuple((n, float({**inputs.scalars, **columns}[n])) for n in (*PARAMETERS, "omega0"))


@pytest.mark.thorough
@pytest.mark.parametrize("work", [work for work in WORKS if work.kind != "peak"], ids=lambda work: work.key)
@pytest.mark.parametrize("contender", HERE, ids=lambda one: one.name)
def test_values_are_the_truths(contender, work):
    inputs, result = answers(contender, work)
    assert len(result) == len(work.names)
    assert all(array.shape == inputs.shape for array in result)
    corners = [tuple(0 for _ in inputs.shape), tuple(size - 1 for size in inputs.shape)]
    for index in [*corners, tuple(size // 3 for size in inputs.shape)]:
        point = point_of(inputs, index)
        for name, array in zip(work.names, result, strict=True):
            size = scale(name, dict(point))
            assert array[index] == pytest.approx(float(exact(name, point)), **tolerance(size))


def scale(name, point):
    """The typical size of a quantity, also near its zeros."""
    return OMEGA0 * (OMEGA0 if name.startswith("a_C") else 1.0) * point["AB"] / 0.1 ** name.count("wrt")


def tolerance(size):
    return {"rel": 1e-13, "abs": 1e-13 * size}


@pytest.mark.parametrize("contender", HERE, ids=lambda one: one.name)
def test_peaks_are_the_truths(contender):
    """A dense grid of 720 angles is as close as half a step allows; desaxe's are refined."""
    inputs, (values, angles) = answers(contender, BY_KEY["peak"])
    close = 1e-4 if contender.kind == "textbook" else 1e-12
    for row, (value, angle) in enumerate(zip(values, angles, strict=True)):
        design = {name: float(column[row]) for name, column in inputs.columns.items()}
        best, where = largest(tuple(design.items()))
        assert value == pytest.approx(best, rel=close)
        assert math.cos(angle - where) > 0.999


@cache
def largest(design):
    """The largest |a_C| of a full turn, from the truth alone: a coarse sweep, then where the slope is 0."""
    fixed = {"omega0": OMEGA0, "alpha": 0.0, **dict(design)}

    def slope(theta):
        return truth("a_C_wrt_theta", theta=float(theta), **fixed)

    def size(theta):
        return abs(truth("a_C", theta=float(theta), **fixed))

    coarse = [math.tau * k / 90 for k in range(90)]
    around = max(coarse, key=size)
    angle = float(
        mpmath.findroot(slope, (around - 0.05, around + 0.05), solver="anderson", tol=1e-12, verify=False)
    )
    return float(size(angle)), angle


@pytest.mark.thorough
@pytest.mark.parametrize("key", ["point", "grid_out"])
@pytest.mark.parametrize("contender", HERE, ids=lambda one: one.name)
def test_two_threads_give_the_same(contender, key):
    one, two = (answers(contender, BY_KEY[key], threads)[1] for threads in (1, 2))
    for alone, together in zip(one, two, strict=True):
        np.testing.assert_allclose(alone, together, rtol=1e-13, atol=1e-10)


@pytest.mark.parametrize("work", LIMITS, ids=lambda work: work.key)
def test_the_machines_limits_compute_what_they_say(work):
    inputs = work.inputs(1024)
    x = inputs.columns["theta"]
    first, *others = MACHINE.load()(work, inputs, None, 1)()
    if work.key == "sincos":
        np.testing.assert_allclose(others[0], np.cos(x), rtol=1e-15)
    horner = np.polynomial.polynomial.polyval(x, [0.5] * DEGREE)
    expected = {"sqrt": np.sqrt(x), "divide": 1 / x, "sincos": np.sin(x), "copy": x}
    expected["multiply_add"] = horner + x ** (DEGREE + 1)
    np.testing.assert_allclose(first, expected[work.key], rtol=4e-16 if work.key != "multiply_add" else 1e-14)


def test_a_missing_contender_is_told():
    nobody = CONTENDERS[0]._replace(needs="no_such_package")
    assert not nobody.is_here
