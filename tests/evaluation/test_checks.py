"""Checks of `desaxe.evaluate`: refused arguments, invalid elements, units."""

import math
import re

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation.values import values
from tests.ways import POINT, SIZES, columns

# ---- status and bad elements ---------------------------------------------------------------------

CASES = [  # theta, ec, AB, BC, alpha, status
    (1.0, 0.01, 0.125, 0.35, 0.0, 0),
    (1.5, 0.0, 0.5, 0.35, 0.0, 1),
    (0.0, 0.35, 0.125, 0.35, 0.0, 2),
    (math.pi / 2, 0.225, 0.125, 0.35, 0.0, 1),  # 0.35 - 0.125 - 0.225 is -2.8e-17 in doubles
    (2.0, 0.01, 0.125, 0.35, -1e5, 3),
    (math.nan, 0.01, 0.125, 0.35, 0.0, 4),
    (1.0, math.inf, 0.125, 0.35, 0.0, 4),
    (1.0, 0.01, -0.125, 0.35, 0.0, 4),
    (1.0, 0.01, 0.125, 0.0, 0.0, 4),
    (1.0, 0.01, 0.125, 0.35, -math.inf, 4),
]
CASE_INPUTS = ("theta", "ec", "AB", "BC", "alpha")
CODES = [case[-1] for case in CASES]


def cases():
    """The cases as columns."""
    table = np.array(CASES)
    given = {name: table[:, i].copy() for i, name in enumerate(CASE_INPUTS)}
    return given | {"omega0": np.full(len(CASES), 157.0)}


ASKED = ["Y", "V_C", "a_C", "omega", "phi", "margin", "status"]  # at once, by one kernel


def test_every_status_and_what_it_leaves():
    result = dx.evaluate(ASKED, **cases())
    assert result["status"].tolist() == CODES
    assert result["status"].dtype == np.int8
    # at a change point a rate has no bound
    assert np.isfinite(result["V_C"]).tolist() == [code == 0 for code in CODES]
    assert np.isnan(result["V_C"]).tolist() == [code not in (0, 2) for code in CODES]
    # the last case is a bad acceleration, which no position needs
    assert np.isnan(result["Y"][:-1]).tolist() == [code in (1, 4) for code in CODES[:-1]]
    assert np.isfinite([result["Y"][4], result["phi"][4]]).all()  # it has stalled


@pytest.mark.parametrize("case", [case for case in CASES if case[-1] < 4], ids=str)
def test_the_status_of_one_point(case):
    *values, code = case
    point = dict(zip(CASE_INPUTS, values, strict=True))
    result = dx.evaluate("status", **point, omega0=157.0)
    assert (type(result), result) == (int, code)


@pytest.mark.parametrize("state", [{}, {"omega": -20.0, "alpha": -1e9}])
def test_a_status_without_a_motion_or_in_a_given_state(state):
    assert dx.evaluate("status", theta=100.0, ec=0.0, AB=0.125, BC=0.35, **state) == 0


INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
BAD = {"theta": math.inf, "ec": math.nan, "AB": -1e-9, "BC": 0.0, "omega0": math.nan, "alpha": math.inf}


def all_columns(**changed):
    theta, ec = columns(4)
    given = {"theta": theta, "ec": ec, "alpha": 0.0, **SIZES} | changed
    return {name: np.broadcast_to(given[name], 4).astype(float) for name in INPUTS}


@pytest.mark.parametrize(
    ("name", "value"), [*BAD.items(), *dict.fromkeys(INPUTS[1:], 1e61).items(), ("BC", 1e-61)]
)
def test_a_bad_element_disturbs_no_other(name, value):
    good = all_columns()
    bad = good[name].copy()
    bad[2] = value
    before, after = dx.evaluate(ASKED, **good), dx.evaluate(ASKED, **good | {name: bad})
    assert all(np.array_equal(np.delete(before[q], 2), np.delete(after[q], 2)) for q in ASKED)
    assert np.isnan(after["V_C"][2])
    assert after["status"][2] == 4
    prepared = dx.function(ASKED, INPUTS)(*(good | {name: bad}).values())
    assert all(np.array_equal(new, after[q], equal_nan=True) for q, new in zip(ASKED, prepared, strict=True))


def test_a_bad_speed_is_nan_itself():
    result = dx.evaluate("omega", omega=np.array([2.0, math.inf, math.nan]))
    assert np.isnan(result).tolist() == [False, True, True]


# ---- what is refused -----------------------------------------------------------------------------

REFUSED = [
    ("V_c", {}, ValueError, "unknown quantity 'V_c'; did you mean V_C, "),
    ("velocity", {}, ValueError, r"unknown quantity 'velocity'.*desaxe\.quantities\(\)"),
    ("V_C, a_C", {}, ValueError, re.escape("'V_C, a_C': several names are a list, such as ['V_C', 'a_C']")),
    ("V_C", {"theta": True}, TypeError, "theta: expected real numbers, got a bool: True"),
    ("V_C", {"theta": "60,5 deg"}, ValueError, 'a number with a unit such as "60 deg"'),
    ("V_C", {"omega0": "900 1/min"}, ValueError, "'900 1/min': a rate .per time. does not say of what"),
    ("V_C_wrt_omega", {}, ValueError, "'V_C_wrt_omega' needs a state: give omega= instead of omega0="),
    (
        "V_C",
        {"theta": None},
        TypeError,
        r"V_C: theta is missing \(needed: theta, ec, AB, BC, omega0(, alpha)?\)",
    ),
    ("V_C", {"omega0": None}, TypeError, "omega0 is missing"),
    ("V_C", {"AB": -0.1}, ValueError, re.escape("AB = -0.1: it must be a finite length >= 0")),
    ("V_C", {"BC": 0}, ValueError, "BC = 0: it must be a finite length > 0"),
    ("V_C", {"BC": -0.35}, ValueError, "BC = -0.35: it must be a finite length > 0"),
    ("V_C", {"theta": math.nan}, ValueError, "theta = nan: it must be a finite number"),
    ("V_C", {"omega0": -math.inf}, ValueError, "omega0 = -inf: it must be a finite number"),
    ("V_C", {"ec": np.float32(np.inf)}, ValueError, "ec = .*inf.*: it must be a finite number"),
    ("V_C", {"theta": 10**400}, ValueError, "theta = .*: it must be a finite number"),
    ("V_C", {"theta": 1j}, TypeError, "theta: expected real numbers"),
    ("V_C", {"theta": np.array([True])}, TypeError, "theta: .*, got an array of bool"),
    ("V_C", {"theta": np.array([1j])}, TypeError, "theta: .*, got an array of complex128"),
    ("V_C", {"theta": [None]}, TypeError, "theta: expected real numbers"),
    ("V_C", {"AB": np.array([-1.0, -2.0])}, ValueError, "AB: every value is bad, the first is -1.0; "),
    ("V_C", {"ec": np.full(3, np.nan)}, ValueError, "ec: every value is bad, the first is nan"),
    ("V_C", {"BC": np.array(0.0)}, ValueError, "BC: every value is bad, .* it must be a finite length > 0"),
    ("V_C", {"branch": 0}, ValueError, r"branch = 0: it is \+1 or -1"),
    ("V_C", {"branch": 2}, ValueError, r"branch = 2: it is \+1 or -1"),
    ("V_C", {"branch": "1"}, ValueError, r"branch = '1': it is \+1 or -1"),
    ("V_C", {"branch": [1, -1]}, (TypeError, ValueError), r"branch = \[1, -1\]: it is \+1 or -1"),
    ("V_C", {"branch": np.array([1, -1])}, (TypeError, ValueError), "branch = .*: it is"),
    (
        "V_C",
        {"accuracy": "perfect"},
        ValueError,
        "accuracy = 'perfect': it is one of standard, extended",
    ),
    ("V_C", {"omega": 3.0}, ValueError, r"give omega0= \(the law\) or omega= \(a state\), not both"),
    ("V_C", {"threads": 0}, ValueError, "threads = 0: a whole number, at least 1"),
    (["V_C", 7], {}, TypeError, "the name of a quantity is a str, got 7"),
    ("V_C", {"length": 3.0}, TypeError, "length"),
    (
        "V_C",
        {"theta": np.ma.masked_invalid([0.1, math.nan])},
        TypeError,
        "theta: a masked array; fill it",
    ),
    ("V_C_wrt_omega0", {"omega0": None, "omega": 3.0}, ValueError, "no meaning for a given state omega="),
]


@pytest.mark.parametrize(("names", "change", "error", "complaint"), REFUSED)
def test_a_number_that_is_wrong_is_refused(names, change, error, complaint):
    with pytest.raises(error, match=complaint):
        dx.evaluate(names, **POINT | change)


@pytest.mark.parametrize(("names", "change", "error", "complaint"), REFUSED)
def test_a_wrong_number_beside_arrays_is_refused(names, change, error, complaint):
    arrays = POINT | {"alpha": np.array([0.0, 1.0])}
    with pytest.raises(error, match=complaint):
        dx.evaluate(names, **arrays | change)


def test_shapes_that_do_not_broadcast_are_all_named():
    with pytest.raises(ValueError, match=r"do not broadcast together: theta \(3,\), ec \(4,\)"):
        dx.evaluate("V_C", theta=np.zeros(3), ec=np.zeros(4), **SIZES)


def test_a_law_and_a_state_at_once_are_refused_after_a_good_state_too():
    state = POINT | {"omega0": None, "omega": 3.0}
    dx.evaluate("V_C", **state)
    with pytest.raises(ValueError, match="not both"):
        dx.evaluate("V_C", **state | {"omega0": 157.0})


def test_positions_are_named():
    with pytest.raises(TypeError):
        dx.evaluate("V_C", 1.1, 0.01, 0.125, 0.35, 157.0)


@pytest.mark.parametrize(
    "name", ["V_C_wrt_alpha", "omega_BC_wrt_alpha", "V_C_wrt_theta_alpha", "a_C_wrt_alpha_alpha"]
)
def test_a_derivative_that_a_state_makes_zero_is_nan_without_a_mechanism(name):
    """Zero would pretend to be a derivative."""
    state = {"theta": 1.57, "AB": 0.125, "BC": 0.35, "omega": 10.0}
    assert dx.evaluate(name, ec=0.0, **state) == 0.0
    assert math.isnan(dx.evaluate(name, ec=0.3, **state))
    assert np.isnan(dx.evaluate(name, ec=[0.0, 0.3], **state)).tolist() == [False, True]


def test_a_derivative_that_constant_speed_makes_zero_is_nan_without_a_mechanism():
    design = {"theta": [1.57, 1.57], "AB": 0.125, "BC": 0.35, "omega0": 10.0, "ec": [0.0, 0.3]}
    assert np.isnan(dx.evaluate("V_C_wrt_omega0_omega0", **design)).tolist() == [False, True]


def test_a_derivative_of_the_crank_alone_needs_no_mechanism():
    assert dx.evaluate("V_B_X_wrt_alpha", theta=1.57, AB=0.125, omega=10.0) == 0.0


@pytest.mark.parametrize("theta", [1.0, np.array([1.0, 1.1])])
def test_an_input_that_is_none_is_another_request_than_one_that_is_there(theta):
    """Virtual work: a force on the slider costs the torque -F_Y dY/dtheta."""
    machine = {"theta": theta, "ec": 0.01, "AB": 0.1, "BC": 0.3, "omega0": 10.0, "alpha": 0.0, "omega": None}
    without = values("T_in", machine | {"m_slider": 1.0, "F_Y": None})
    force = dx.evaluate("T_in", **machine, m_slider=1.0, F_Y=100.0) - without
    u = 0.01 + 0.1 * np.sin(theta)
    slope = -0.1 * np.sin(theta) - u * 0.1 * np.cos(theta) / np.sqrt(0.3**2 - u**2)
    assert force == pytest.approx(-100.0 * slope, rel=1e-12)
