"""`evaluate(..., quality=True)`: conditions and bounds of the rounding error, against the truth."""

import itertools
import json
import math
import re

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.cli import main
from desaxe.oracle.force_truth import FORCES, OTHERS
from desaxe.oracle.force_truth import conditions as force_conditions
from desaxe.oracle.force_truth import truth as force_truth
from desaxe.oracle.truth import LAW, QUANTITIES, SECOND_ORDER, STATE, conditions, truth
from tests.effort import cases, first
from tests.evaluation.test_force_values import points
from tests.points import draw

POINT = {"theta": 1.1, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 157.0}
PROMISE = 8 * 2.0**-52
KINDS = (
    "generic", "branch -1", "long crank", "slowing down", "state that starts", "very long crank",
    "concentric", "backwards", "steady", "from rest", "state", "at rest",
)  # fmt: skip


def names_for(point):
    """The names whose derivatives are derived."""
    parameters = STATE if "omega" in point else LAW
    return [*QUANTITIES, *(f"{q}_wrt_{p}" for q in SECOND_ORDER for p in parameters)]


def too_small(result, point, oracle=truth):
    """The names whose error is above its bound."""
    wrong = {}
    for name, its in result.items():
        exact = oracle(name, **point)
        if mpmath.isfinite(exact) and math.isfinite(its.value):
            with mpmath.workdps(50):
                error = abs(mpmath.mpf(its.value) - exact)
            if not error <= its.error_bound:
                wrong[name] = float(error), its.error_bound
    return wrong


def near_the_change_point():
    """Points, and how far the bound may be above the promise: there slopes lose digits themselves."""
    motion = {"omega0": 157.0, "alpha": -3.0}
    for power, distance, side in itertools.product((20, 35, 50), (0.0, 1e-2, -1e-5, 1e-9), (1, -1)):
        lengths = {"ec": side * 0.225, "AB": 0.125, "BC": 0.35 * (1 + 2.0**-power)}
        yield {"theta": side * math.pi / 2 + distance, **lengths, **motion}, 2.0 ** (power - 48)


@pytest.mark.sampled
@pytest.mark.parametrize("kind", first(5, KINDS))
def test_the_bound_holds(kind):
    for point in draw(kind, cases(3, 8)):
        assert not too_small(dx.evaluate(names_for(point), **point, quality=True), point), point


def test_the_bound_holds_next_to_the_change_point():
    for point, _ in near_the_change_point():
        assert not too_small(dx.evaluate(names_for(point), **point, quality=True), point), point


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["smooth", "friction", "default_centres", "loads alone"])
def test_the_bound_holds_for_forces(kind):
    for point in points("slowing down", kind, cases(3, 8)):
        result = dx.evaluate(FORCES, **point, quality=True)
        assert not too_small(result, point, force_truth), point


@pytest.mark.parametrize("name", ["Y", "V_C", "a_C", "j_C", "alpha_BC", "a_C_wrt_ec", "V_C_wrt_theta"])
def test_the_bound_is_the_promise(name):
    """8 ulp x (1 + sum of conditions, with the margin in place of ec), and little more."""
    for point, more in [*zip(draw("slowing down", 5), itertools.repeat(1e-9)), *near_the_change_point()]:
        exact = truth(name, **point)
        if mpmath.isfinite(exact):
            its = dx.evaluate(name, **point, quality=True)
            promised = PROMISE * (1 + conditions(name, **point)) * float(abs(exact))
            assert promised * (1 - 1e-9) <= its.error_bound <= promised * (1 + more), point


def test_the_bound_of_forces_is_the_promise():
    for point in points("generic", "friction", 4):
        for name in ("T_in", "N_C", "M_shaking", "kinetic_energy"):
            promised = PROMISE * (1 + force_conditions(name, others=OTHERS, **point))
            promised *= float(abs(force_truth(name, **point)))
            its = dx.evaluate(name, **point, quality=True)
            assert its.error_bound == pytest.approx(promised, rel=1e-9)


def test_generic_numbers_have_many_digits():
    result = [dx.evaluate(names_for(p), **p, quality=True) for p in draw("generic", 20)]
    digits = np.array([its.digits for row in result for its in row.values()])
    assert np.median(digits) > 13.5
    assert np.mean(digits > 12) > 0.95
    assert digits.max() <= 17


@pytest.mark.parametrize("name", ["a_C", "V_C_wrt_BC", "s"])
def test_conditions_are_relative_changes(name):
    for point in draw("slowing down", 5):
        its = dx.evaluate(name, **point, quality=True)
        joint = "_" if "_wrt_" in name else "_wrt_"
        for parameter, condition in its.conditions.items():
            slope = truth(f"{name}{joint}{parameter}", **point)
            expected = abs(float(point[parameter] * slope / truth(name, **point)))
            assert condition == pytest.approx(expected, rel=1e-9)


def test_only_what_a_quantity_depends_on_has_a_condition():
    assert set(dx.evaluate("Y", **POINT, quality=True).conditions) == {"theta", "ec", "AB", "BC"}
    state = POINT | {"omega": 3.0, "omega0": None, "m_slider": 2.0}
    result = dx.evaluate("T_in", **state, quality=True).conditions
    assert set(result) == {"theta", "ec", "AB", "BC", "omega", "m_slider"}
    assert result["m_slider"] == pytest.approx(1.0)
    assert result["omega"] == pytest.approx(2.0)


def test_one_name_or_many_numbers_or_arrays():
    one = dx.evaluate("a_C", **POINT, quality=True)
    assert one.value == dx.evaluate("a_C", **POINT)
    assert all(type(x) is float for x in (one.error_bound, one.digits, *one.conditions.values()))
    theta, ec = np.linspace(0, 6, 7), np.array([[0.0], [0.01]])
    many = dx.evaluate(["a_C", "V_C"], **POINT | {"theta": theta, "ec": ec}, quality=True)
    assert list(many) == ["a_C", "V_C"]
    for field in ("error_bound", "digits"):
        assert getattr(many["a_C"], field).shape == (2, 7)
    for row, column in itertools.product(range(2), range(7)):
        point = POINT | {"theta": float(theta[column]), "ec": float(ec[row, 0])}
        single = dx.evaluate("V_C", **point, quality=True)
        its = many["V_C"]
        assert its.error_bound[row, column] == pytest.approx(single.error_bound, rel=1e-9)
        for parameter, condition in single.conditions.items():
            assert its.conditions[parameter][row, column] == pytest.approx(condition, rel=1e-9)


@pytest.mark.parametrize(
    "load", [0.0, dx.over_theta([0.0, 2.0, 4.0], [0.0, -500.0, 0.0]), dx.over_Y([0.2, 0.4], [0.0, -500.0])]
)
def test_units_are_understood(load):
    texts = {"theta": "60 deg", "ec": "10 mm", "AB": "125 mm", "BC": "0.35 m", "omega0": 157}
    text = dx.evaluate("T_in", **texts, m_slider="2 kg", F_Y=load, quality=True)
    number = dx.evaluate("T_in", **POINT | {"theta": math.radians(60)}, m_slider=2.0, F_Y=load, quality=True)
    assert text.conditions == pytest.approx(number.conditions)


def test_the_margin_is_rounded_once():
    its = dx.evaluate("margin", ec=-0.01, AB=0.125, BC=0.35, quality=True)
    assert its.conditions == pytest.approx({"ec": 0.01 / 0.215, "AB": 0.125 / 0.215, "BC": 0.35 / 0.215})
    assert its.error_bound == 2.0**-53 * its.value
    nothing = dx.evaluate("margin", ec=0.25, AB=0.125, BC=0.375, quality=True)
    assert (nothing.value, nothing.error_bound, nothing.digits) == (0.0, 0.0, 17.0)
    assert nothing.conditions == dict.fromkeys(("ec", "AB", "BC"), math.inf)


def test_where_there_is_no_number():
    its = dx.evaluate("a_C", **POINT | {"ec": 0.3, "theta": math.pi / 2}, quality=True)
    assert all(map(math.isnan, (its.value, its.error_bound, its.digits, *its.conditions.values())))
    still = dx.evaluate("V_B_Y", **POINT | {"theta": 0.0}, quality=True)
    assert (still.value, still.error_bound, still.digits) == (0.0, 0.0, 17.0)


def test_a_derivative_without_bound_gives_a_bound_without_bound():
    """Where the crank starts from rest its speed has an infinite derivative by alpha at theta = 0."""
    its = dx.evaluate("omega", theta=0.5, omega0=1.0, alpha=-1.0, quality=True)
    assert its.value == 0.0
    assert its.error_bound == math.inf
    assert its.digits == 0.0


@pytest.mark.parametrize(
    ("error", "words", "name", "more"),
    [
        (ValueError, "quality of j_C_wrt_ec: not available.* that of j_C is", "j_C_wrt_ec", {}),
        (ValueError, "quality of a_C_wrt_ec_AB", "a_C_wrt_ec_AB", {}),
        (ValueError, "not a real number", "status", {}),
        (ValueError, "did you mean", "a_c", {}),
        (TypeError, "out= is for plain values", "a_C", {"out": np.empty(())}),
        (ValueError, "'standard' alone", "a_C", {"accuracy": "extended"}),
        (ValueError, "not both", "a_C", {"omega": 1.0}),
        (TypeError, "BC is missing", "a_C", {"BC": None}),
    ],
)
def test_complaints(error, words, name, more):
    with pytest.raises(error, match=words):
        dx.evaluate(name, **POINT | more, quality=True)


WORDS = ["evaluate", "a_C", "theta=60deg", "ec=10mm", "AB=125mm", "BC=0.35", "omega0=157", "quality=true"]


def test_on_the_command_line(capsys):
    assert main(WORDS) == 0
    assert re.fullmatch(
        r"a_C  \{value: -.*omega0: 2}, error_bound: .*, digits: 13\..*}\n", capsys.readouterr().out
    )
    assert main([*WORDS, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["a_C"]["conditions"]["omega0"] == pytest.approx(2.0)
    assert 13 < result["a_C"]["digits"] < 15
