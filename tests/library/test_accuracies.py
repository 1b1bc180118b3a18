"""The other accuracies: twice the digits rounded once, and float32."""

import math

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe._accuracy import ACCURACIES, BOUNDS, accuracy_of
from desaxe.audit.truth import LAW, all_names, conditions, relative_error, truth_all, ulp_error
from tests.library.points import draw

NAMES = [
    name
    for name in all_names()
    if name.partition("_wrt_")[0] in ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")
    and name.partition("_wrt_")[2] in ("", *LAW)
]
KINDS = ("generic", "branch -1", "long crank", "very long crank", "concentric", "slowing down", "from rest")
# Powers of AB + BC or AB, and of the speed, in the scale of a quantity.
DEGREES = {"Y": (1, 0), "V_C": (1, 1), "a_C": (1, 2), "omega_BC": (0, 1), "alpha_BC": (0, 2)}


def scale(name, point):
    """What the floor of the extended accuracy is 2^-96 of."""
    quantity, _, parameter = name.partition("_wrt_")
    length, turns = DEGREES[quantity]
    speed = math.sqrt(point["omega0"] ** 2 + 2 * point["alpha"] * point["theta"])
    size = (point["AB"] + (point["BC"] if quantity == "Y" else 0.0)) ** length * speed**turns
    return size / abs(point[parameter]) if parameter and point[parameter] else size


def is_exact(name, value, exact, point):
    """Within 2 ulp, or 2^-96 of the scale."""
    if math.isinf(exact):
        return math.isnan(value) or value == exact
    floor = mpmath.ldexp(mpmath.mpf(scale(name, point)), -96)
    return ulp_error(value, exact) <= 2 or abs(mpmath.mpf(value) - exact) <= floor


def change_points(count):
    """On the change point, and next to it: margins of both signs, angles down to 1e-9 from it."""
    rng = np.random.default_rng(5)
    for number in range(count):
        ec = float(rng.choice([-0.375, 0.375]))
        margin = 0.0 if number % 3 == 0 else float(rng.choice([-1, 1])) * 2.0 ** -int(rng.integers(20, 51))
        away = float(rng.choice([-1, 1])) * 10.0 ** rng.uniform(-9, -1)
        point = {"theta": math.copysign(math.pi / 2, ec) + away, "ec": ec, "AB": 0.25, "BC": 0.625 + margin}
        yield point | {"omega0": 50.0, "alpha": float(rng.choice([0.0, 3.0]))}


@pytest.mark.parametrize("kind", KINDS)
def test_extended_is_exact_to_the_last_digit(kind):
    for point in draw(kind, 25):
        values = dx.evaluate(NAMES, accuracy="extended", **point)
        exact = truth_all(NAMES, **point)
        assert all(is_exact(name, values[name], exact[name], point) for name in NAMES), point


def test_extended_is_exact_next_to_the_change_point():
    for point in change_points(60):
        values = dx.evaluate(NAMES, accuracy="extended", **point)
        exact = truth_all(NAMES, **point)
        assert all(is_exact(name, values[name], exact[name], point) for name in NAMES), point


@pytest.mark.parametrize("draw_points", [lambda: list(draw("generic", 40)), lambda: list(change_points(40))])
def test_a_kernel_is_as_exact(draw_points):
    rows = draw_points()
    columns = {name: np.tile([row[name] for row in rows], 60) for name in LAW}
    answers = dx.evaluate(["Y", "V_C", "a_C", "a_C_wrt_ec"], accuracy="extended", **columns)
    for index, row in enumerate(rows):
        exact = truth_all(answers, **row)
        for name, column in answers.items():
            assert is_exact(name, float(column[index]), exact[name], row), (name, row)


def test_fast_keeps_eight_ulp_of_float32_at_generic_points():
    rows = [point for point in draw("generic", 60) if abs(point["theta"]) < 100]
    columns = {name: np.tile([row[name] for row in rows], 60) for name in LAW}
    answers = dx.evaluate(NAMES, accuracy="fast", **columns)
    worst = {}
    for index, row in enumerate(rows):
        exact = truth_all(NAMES, **row)
        for name, column in answers.items():
            share = relative_error(float(column[index]), exact[name]) / (1 + conditions(name, **row))
            worst[name] = max(worst.get(name, 0.0), share)
    assert max(worst.values()) <= 8 * 2.0**-24
    assert max(worst.values()) > BOUNDS["standard"]  # it is another kernel


@pytest.mark.parametrize(
    ("asked", "kept"),
    [(1e-3, "standard"), (1e-9, "standard"), (1e-15, "extended"), (1, "standard")]
    + [(name, name) for name in ACCURACIES],
)
def test_the_cheapest_that_keeps_an_error(asked, kept):
    assert accuracy_of(asked) == kept


@pytest.mark.parametrize("asked", ["best", 1e-17, 0.0, -1.0, math.nan, None, True])
def test_an_accuracy_that_there_is_not(asked):
    with pytest.raises(ValueError, match=r"accuracy = "):
        dx.evaluate("a_C", theta=1.0, ec=0.0, AB=0.1, BC=0.3, omega0=1.0, accuracy=asked)


def test_status_and_nan_are_those_of_standard():
    columns = {"theta": np.linspace(0, 7, 3000), "ec": 0.3, "AB": 0.125, "BC": 0.35, "omega0": 10.0}
    standard = dx.evaluate(["a_C", "status"], **columns)
    for accuracy in ("fast", "extended"):
        other = dx.evaluate(["a_C", "status"], accuracy=accuracy, **columns)
        assert np.array_equal(other["status"], standard["status"])
        assert np.array_equal(np.isnan(other["a_C"]), np.isnan(standard["a_C"]))


def test_an_angle_that_extended_cannot_reduce_is_told():
    point = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 10.0, "accuracy": "extended"}
    far = 2e8
    with pytest.raises(ValueError, match=r"theta = 200000000.0: accuracy='extended' reaches"):
        dx.evaluate("a_C", theta=far, **point)
    found = dx.evaluate(["a_C", "status"], theta=np.array([1.0, far]), **point)
    assert (found["status"].tolist(), np.isnan(found["a_C"]).tolist()) == ([0, 4], [False, True])
