"""The other accuracies: twice the digits rounded once, and an error that a user states."""

import math
import sys

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle import force_truth
from desaxe.oracle.families import FAMILIES, Rng, points
from desaxe.oracle.truth import LAW, all_names, truth_all, ulp_error
from desaxe.runtime.request import ACCURACIES, accuracy_of
from tests.effort import cases, first
from tests.evaluation.test_stress import bodies

NAMES = [
    name
    for name in all_names()
    if name.partition("_wrt_")[0] in ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")
    and name.partition("_wrt_")[2] in ("", *LAW)
]
# Powers of AB + BC or AB, and of the speed, in the scale of a quantity.
DEGREES = {"Y": (1, 0), "V_C": (1, 1), "a_C": (1, 2), "omega_BC": (0, 1), "alpha_BC": (0, 2)}


def speed_squared(point):
    """omega^2 by the law; it may overflow as a double."""
    omega0, alpha, theta = (mpmath.mpf(point.get(name, 0.0)) for name in ("omega0", "alpha", "theta"))
    return (mpmath.mpf(point["omega"]) ** 2) if "omega" in point else omega0**2 + 2 * alpha * theta


def is_stalled(point):
    """True if the crank stops before this angle, or is at rest there."""
    with mpmath.workdps(60):
        return speed_squared(point) <= 0


def scale(name, point):
    """The scale of a quantity, of which 2^-96 is the floor of the extended accuracy."""
    quantity, _, parameter = name.partition("_wrt_")
    length, turns = DEGREES[quantity]
    speed = mpmath.sqrt(speed_squared(point))
    size = (mpmath.mpf(point["AB"]) + (point["BC"] if quantity == "Y" else 0.0)) ** length * speed**turns
    return size / abs(point[parameter]) if parameter and point[parameter] else size


def is_exact(name, value, exact, point):
    """Within 2 ulp, or 2^-96 of the scale."""
    if mpmath.isinf(exact) or abs(exact) > sys.float_info.max / 2 or 0 < abs(exact) < sys.float_info.min:
        return True if mpmath.isfinite(exact) else math.isnan(value) or value == exact
    floor = mpmath.ldexp(mpmath.mpf(scale(name, point)), -96)
    return ulp_error(value, exact) <= 2 or abs(mpmath.mpf(value) - exact) <= floor


def broken(names, point):
    """The names of which the extended accuracy does not keep its promise at a point."""
    values, exact = dx.evaluate(names, accuracy="extended", **point), truth_all(names, **point)
    return [name for name in names if not is_exact(name, values[name], exact[name], point)]


@pytest.mark.sampled
@pytest.mark.parametrize("family", FAMILIES)
def test_extended_keeps_its_promise_in_every_family(family):
    for point in points(family, cases(12, 120), seed=6):
        assert is_stalled(point) or not broken(NAMES, point), point


def gap(point):
    """(BC - |u|)/BC."""
    with mpmath.workdps(60):
        at = {name: mpmath.mpf(point[name]) for name in ("theta", "ec", "AB", "BC")}
        return 1 - abs(at["ec"] + at["AB"] * mpmath.sin(at["theta"])) / at["BC"]


LAST = [point for point in points("last_angle", 900, seed=7) if gap(point) < 2.0**-53]


@pytest.mark.sampled
def test_extended_at_the_last_double_inside_a_limit_angle():
    """Of BC and |u| more than 53 bits are the same, and of a_C_wrt_BC a power of what is left of them."""
    assert len(LAST) > 50
    for point in LAST[:: cases(12, 1)]:
        assert not broken(NAMES, point), point


@pytest.mark.sampled
def test_extended_knows_the_last_double_inside_a_limit_angle():
    for point in points("last_angle", cases(40, 150), seed=8):
        for away in (math.inf, -math.inf):
            theta = point["theta"]
            for _ in range(3):
                theta = math.nextafter(theta, away)
                at = point | {"theta": theta}
                result = dx.evaluate(["status", "V_C"], accuracy="extended", **at)
                reached = gap(at) > 0
                assert (result["status"] == 0) == reached == math.isfinite(result["V_C"]), at


def just_started(count):
    """|ec| = BC, and an angle so small that phi' and 2 theta phi'' are the same but for their last digits."""
    rng = np.random.default_rng(9)
    for _ in range(count):
        BC, side = float(rng.uniform(0.2, 1.0)), float(rng.choice([-1, 1]))
        point = {"theta": -side * 10.0 ** rng.uniform(-20, -4), "ec": side * BC, "BC": BC}
        point |= {"AB": BC * 10.0 ** rng.uniform(-2, 1), "branch": int(rng.choice([1, -1]))}
        yield point | {"omega0": 30.0, "alpha": float(rng.choice([0.0, 9.0]))}


@pytest.mark.sampled
def test_extended_where_alpha_has_not_done_much_yet():
    names = ["a_C_wrt_alpha", "alpha_BC_wrt_alpha"]
    for point in just_started(cases(12, 150)):
        values = dx.evaluate(names, accuracy="extended", **point)
        exact = truth_all(names, **point)
        assert all(ulp_error(values[name], exact[name]) <= 1 for name in names), point
        state = {name: value for name, value in point.items() if name != "omega0"} | {"omega": 30.0}
        values = dx.evaluate(names, accuracy="extended", **state)
        exact = truth_all(names, **state)
        assert all(ulp_error(values[name], exact[name]) <= 1 for name in names), state


def test_an_angle_of_a_billion_radians():
    rng = np.random.default_rng(10)
    for point in points("generic", 40, seed=11):
        at = point | {"theta": float(rng.uniform(1e8, 1.6e9)), "AB": point["BC"] / 4, "ec": point["BC"] / 5}
        at["alpha"] = abs(at["alpha"]) * 1e-9
        assert not broken(NAMES, at), at


HARD = ["a_C", "a_C_wrt_BC", "a_C_wrt_alpha", "alpha_BC_wrt_alpha"]
KERNELS = {
    **{family: (["Y", "V_C", "a_C", "a_C_wrt_ec"], list(points(family, 40)), 60)
       for family in ("change_point", "generic", "near_change_point")},
    "the last double inside a limit angle, and a crank that has just started":
        (HARD, [*LAST, *just_started(60)], 30),
}  # fmt: skip


@pytest.mark.parametrize("where", first(3, KERNELS))
def test_a_kernel_is_as_exact(where):
    names, rows, times = KERNELS[where]
    rows = [row for row in rows if row["branch"] == 1]
    columns = {name: np.tile([row[name] for row in rows], times) for name in LAW}
    answers = dx.evaluate(names, accuracy="extended", **columns)
    for index, row in enumerate(rows):
        exact = truth_all(names, **row)
        for name in names:
            assert is_exact(name, float(answers[name][index]), exact[name], row), (name, row)


TORQUE = ["T_in", *(f"T_in_wrt_{parameter}" for parameter in LAW)]


@pytest.mark.sampled
@pytest.mark.parametrize("family", first(4, [family for family in FAMILIES if family != "units"]))
def test_the_torque_in_extended(family):
    """Its scale: the weight of all masses at the crank pin, and of the force there."""
    rng = Rng(f"extended torque: {family}")
    for at in points(family, cases(6, 25), seed=12):
        if is_stalled(at):
            continue
        loaded = at | bodies(rng, at) | {"mu": 0.0}
        masses = sum(loaded[name] for name in ("m_crank", "m_rod", "m_slider"))
        pull = masses * at["AB"] * speed_squared(at) + abs(loaded["F_X"]) + abs(loaded["F_Y"])
        values = dx.evaluate(TORQUE, accuracy="extended", **loaded)
        for name in TORQUE:
            exact = force_truth.truth(name, **loaded)
            floor = mpmath.ldexp(pull * at["AB"], -96) / (abs(at.get(name.partition("_wrt_")[2], 1.0)) or 1)
            near = abs(mpmath.mpf(values[name]) - exact) <= floor
            assert near or ulp_error(values[name], exact) <= 2, (name, loaded)


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
    other = dx.evaluate(["a_C", "status"], accuracy="extended", **columns)
    assert np.array_equal(other["status"], standard["status"])
    assert np.array_equal(np.isnan(other["a_C"]), np.isnan(standard["a_C"]))


def test_an_angle_that_extended_cannot_reduce_is_told():
    point = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 10.0, "accuracy": "extended"}
    far = 2e9
    with pytest.raises(ValueError, match=r"theta = 2000000000.0: accuracy='extended' reaches"):
        dx.evaluate("a_C", theta=far, **point)
    result = dx.evaluate(["a_C", "status"], theta=np.array([1.0, far]), **point)
    assert (result["status"].tolist(), np.isnan(result["a_C"]).tolist()) == ([0, 4], [False, True])
