"""Every quantity and sensitivity at generic points, against the truth.

Errors are at most 1e-13 of the value; where the value is so sensitive to its inputs that 8 ulp x (1 + sum of
condition numbers), the promise, is more than that, it is the bound.
"""

import math

import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.truth import LAW, STATE, all_names, conditions, relative_error, truth_all
from tests.effort import cases
from tests.points import draw

PROMISE = 8 * 2.0**-52


def names_for(point):
    """Every name that exists for this point."""
    return all_names(STATE if "omega" in point else LAW)


def is_right(name, value, exact, point, conditions):
    """True if a value is within its bound of the truth; an infinite limit at rest may be NaN."""
    if math.isinf(exact):
        return math.isnan(value) or value == exact
    error = relative_error(value, exact)
    return error <= 1e-13 or error <= PROMISE * (1 + conditions(name, **point))


def misses(values, point, truth_all=truth_all, conditions=conditions):
    """The names whose values are not right, with values and truth."""
    exact = truth_all(values, **point)
    wrong = (n for n, value in values.items() if not is_right(n, value, exact[n], point, conditions))
    return {name: (values[name], float(exact[name])) for name in wrong}


GEOMETRIES = ("generic", "branch -1", "long crank", "very long crank", "concentric")
MOTIONS = ("backwards", "steady", "speeding up", "slowing down", "from rest", "at rest")
STATES = ("state", "state at rest", "state that starts")


@pytest.mark.sampled
@pytest.mark.parametrize("kind", GEOMETRIES)
def test_a_hundred_points(kind):
    for point in draw(kind, cases(20, 100)):
        assert not misses(dx.evaluate(names_for(point), **point), point), point


@pytest.mark.sampled
@pytest.mark.parametrize("kind", [*MOTIONS, *STATES])
def test_motions(kind):
    for point in draw(kind, cases(10, 30)):
        assert not misses(dx.evaluate(names_for(point), **point), point), point


def test_generic_points_are_generic():
    """The promise does not excuse much: nearly all of these values are held to 1e-13."""
    point = next(draw("generic", 1))
    loose = [name for name in names_for(point) if conditions(name, **point) > 50]
    assert len(loose) < 12


@pytest.mark.thorough
@pytest.mark.parametrize(("kind", "part"), [("generic", 0), ("concentric", 1), ("state", 2)])
def test_a_kernel_is_as_right_as_a_point(kind, part):
    """The same through the compiled loop, with its own sine and cosine: a third of the names each."""
    points = list(draw(kind, cases(0, 25, 50)))
    columns = {name: np.array([point[name] for point in points]) for name in points[0] if name != "branch"}
    answers = dx.evaluate(names_for(points[0])[part::3], **columns, branch=points[0]["branch"])
    for index, point in enumerate(points):
        values = {name: float(column[index]) for name, column in answers.items()}
        assert not misses(values, point), point
