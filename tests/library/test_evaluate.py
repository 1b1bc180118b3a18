"""The border of `desaxe.evaluate`: what comes in, what goes out, what is refused, and what is kept on disk.

Whether the values are right is another room (`test_values.py`). Arrays take one of two ways, plain Python
point by point or a compiled kernel; both must look the same from outside, so most tests take both.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter

import numpy as np
import pytest
import xarray

import desaxe as dx
from desaxe import _arrays, _cache, _kernels

SIZES = {"AB": 0.125, "BC": 0.35, "omega0": 157.0}
POINT = {"theta": 1.1, "ec": 0.01, **SIZES}
EPSILON = 2.0**-52


@pytest.fixture(params=["plain", "compiled"])
def way(request, monkeypatch):
    """Both ways that arrays can take, whatever their size."""
    take_way(monkeypatch, request.param)
    return request.param


def take_way(monkeypatch, name):
    monkeypatch.setattr(_arrays, "BREAK_EVEN", 0 if name == "compiled" else 10**9)
    monkeypatch.setattr(_arrays, "is_ready", lambda key: name == "compiled")


def columns(*shape):
    """Angles and eccentricities of a shape."""
    count = math.prod(shape)
    theta = np.linspace(-4, 7, count).reshape(shape)
    return theta, np.linspace(-0.05, 0.1, count).reshape(shape)


def one_by_one(name, theta, ec):
    """The same, a number at a time, in the broadcast shape."""
    theta, ec = np.broadcast_arrays(theta, ec)
    out = np.empty(theta.shape)
    for index in np.ndindex(theta.shape):
        out[index] = dx.evaluate(name, theta=float(theta[index]), ec=float(ec[index]), **SIZES)
    return out


def close(found, wanted):
    """To 4 ulp of the largest value: a kernel's sine may differ from the C library's by one."""
    scale = np.nanmax(np.abs(wanted), initial=0.0)
    return np.allclose(found, wanted, rtol=0, atol=4 * EPSILON * scale, equal_nan=True)


# ---- shapes and layouts --------------------------------------------------------------------------

SHAPES = [
    ((3,), (3,)), ((3, 1), (4,)), ((1,), (5,)), ((2, 3, 4), (4,)), ((2, 1, 3), (4, 1)), ((5,), ()),
    ((1, 1), (1,)),
]  # fmt: skip
EMPTY_SHAPES = [((0,), ()), ((0,), (1,)), ((0, 3), (3,)), ((3, 0), (1, 1)), ((0,), (0,))]


@pytest.mark.parametrize(("left", "right"), SHAPES)
def test_arrays_broadcast(way, left, right):
    theta, ec = columns(*left)[0], columns(*right)[1]
    found = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert found.shape == np.broadcast_shapes(left, right)
    assert close(found, one_by_one("V_C", theta, ec))


@pytest.mark.parametrize(("left", "right"), EMPTY_SHAPES)
def test_nothing_in_nothing_out(way, left, right):
    found = dx.evaluate("V_C", theta=np.empty(left), ec=np.zeros(right), **SIZES)
    assert found.shape == np.broadcast_shapes(left, right)
    assert found.dtype == np.float64


def test_numbers_in_a_float_out():
    assert type(dx.evaluate("V_C", **POINT)) is float


def test_an_array_without_axes_is_a_scalar_of_numpy():
    found = dx.evaluate("V_C", **POINT | {"theta": np.array(1.1)})
    assert type(found) is np.float64
    assert found == dx.evaluate("V_C", **POINT)


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.float16, np.int8, np.uint64, np.int64])
def test_a_scalar_of_numpy_is_a_number(kind):
    found = dx.evaluate("V_C", **POINT | {"theta": kind(1)})
    assert type(found) is float
    assert found == dx.evaluate("V_C", **POINT | {"theta": 1.0})


def swapped(array):
    return array.astype(array.dtype.newbyteorder())


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def unaligned(array):
    room = np.zeros(array.nbytes + 1, np.uint8)[1:]
    view = room.view(np.float64).reshape(array.shape)
    view[...] = array
    return view


LAYOUTS = {
    "every other": lambda a: np.repeat(a, 2, axis=0)[::2],
    "backwards": lambda a: a[::-1].copy()[::-1],
    "transposed": lambda a: a.T.copy().T,
    "Fortran order": np.asfortranarray,
    "read-only": read_only,
    "swapped bytes": swapped,
    "unaligned": unaligned,
    "nested lists": lambda a: a.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same(way, layout):
    theta, ec = columns(4, 3)
    wanted = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    found = dx.evaluate("V_C", theta=LAYOUTS[layout](theta), ec=LAYOUTS[layout](ec), **SIZES)
    assert np.array_equal(found, wanted)


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int16, np.uint8, np.longdouble])
def test_other_numbers_are_computed_as_doubles(way, kind):
    theta, ec = np.arange(3).astype(kind), np.zeros(3, kind)
    found = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert found.dtype == np.float64
    wanted = dx.evaluate("V_C", theta=theta.astype(float), ec=ec.astype(float), **SIZES)
    assert np.array_equal(found, wanted)


def test_inputs_are_left_alone(way):
    theta, ec = columns(5)
    before = theta.copy(), ec.copy()
    dx.evaluate(["Y", "V_C"], theta=theta, ec=ec, **SIZES)
    assert np.array_equal(theta, before[0])
    assert np.array_equal(ec, before[1])


# ---- names ---------------------------------------------------------------------------------------


def test_a_list_gives_a_dict_in_order():
    assert list(dx.evaluate(["a_C", "Y", "V_C"], **POINT)) == ["a_C", "Y", "V_C"]


def test_a_list_of_arrays_gives_a_dict_in_order(way):
    theta, ec = columns(3)
    found = dx.evaluate(("V_C", "Y"), theta=theta, ec=ec, **SIZES)
    assert list(found) == ["V_C", "Y"]
    assert close(found["Y"], one_by_one("Y", theta, ec))


@pytest.mark.parametrize("theta", [1.1, np.array([1.1, 1.2])], ids=["a number", "an array"])
def test_a_name_may_come_twice(theta):
    found = dx.evaluate(["Y", "V_C", "Y"], **POINT | {"theta": theta})
    assert list(found) == ["Y", "V_C"]
    assert np.array_equal(found["Y"], dx.evaluate("Y", **POINT | {"theta": theta}))


def test_a_name_may_come_twice_from_a_kernel(monkeypatch):
    take_way(monkeypatch, "compiled")
    theta, ec = columns(3)
    assert list(dx.evaluate(["Y", "Y"], theta=theta, ec=ec, **SIZES)) == ["Y"]


def test_one_name_in_a_list_is_still_a_dict():
    assert dx.evaluate(["Y"], **POINT) == {"Y": dx.evaluate("Y", **POINT)}


def test_no_name_no_answer():
    assert dx.evaluate([], **POINT) == {}


def test_what_is_not_needed_may_be_left_out():
    assert dx.evaluate("margin", ec=0.0, AB=0.125, BC=0.375) == 0.25
    assert dx.evaluate("Y", theta=0.0, ec=0.0, AB=1.0, BC=2.0) == 3.0


@pytest.mark.parametrize("name", [quantity.name for quantity in dx.quantities()][::7])
def test_every_name_can_be_asked_for(name):
    assert math.isfinite(dx.evaluate(name, **POINT, alpha=-3.0))


# ---- out= ----------------------------------------------------------------------------------------


def test_out_is_filled_and_returned(way):
    theta, ec = columns(5)
    out = np.full(5, -1.0)
    assert dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=out) is out
    assert close(out, one_by_one("V_C", theta, ec))


def test_out_of_a_list_is_a_dict(way):
    theta, ec = columns(5)
    out = {"V_C": np.empty(5), "Y": np.empty(5)}
    found = dx.evaluate(["Y", "V_C"], theta=theta, ec=ec, **SIZES, out=out)
    assert all(found[name] is out[name] for name in out)
    assert list(found) == ["Y", "V_C"]
    assert close(out["Y"], one_by_one("Y", theta, ec))


OUTS = {
    "every other": lambda: np.zeros((8, 3))[::2],
    "backwards": lambda: np.zeros((4, 3))[::-1],
    "transposed": lambda: np.zeros((3, 4)).T,
    "swapped bytes": lambda: swapped(np.zeros((4, 3))),
    "unaligned": lambda: unaligned(np.zeros((4, 3))),
}


@pytest.mark.parametrize("layout", OUTS)
def test_out_may_have_any_layout(way, layout):
    theta, ec = columns(4, 3)
    out = OUTS[layout]()
    assert dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=out) is out
    assert np.array_equal(out, dx.evaluate("V_C", theta=theta, ec=ec, **SIZES))


def test_a_view_fills_only_its_elements(way):
    theta, ec = columns(3)
    whole = np.full(6, -1.0)
    dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=whole[::2])
    assert whole[1::2].tolist() == [-1.0] * 3


def test_out_may_be_single_precision(way):
    theta, ec = columns(5)
    out = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=np.empty(5, np.float32))
    assert out.dtype == np.float32
    assert np.array_equal(out, dx.evaluate("V_C", theta=theta, ec=ec, **SIZES).astype(np.float32))


def test_out_may_have_no_axes():
    out = np.array(0.0)
    assert dx.evaluate("V_C", **POINT | {"theta": np.array(1.1)}, out=out) is out
    assert out == dx.evaluate("V_C", **POINT)


def test_a_status_may_go_into_wider_numbers(way):
    theta, ec = columns(3)
    out = {"status": np.full(3, 9), "Y": np.empty(3)}
    dx.evaluate(["status", "Y"], theta=theta, ec=ec, **SIZES, out=out)
    assert out["status"].tolist() == [0, 0, 0]


def test_out_may_be_an_input(way):
    theta, ec = columns(5)
    wanted = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert np.array_equal(dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=theta), wanted)


def test_out_may_overlap_an_input(way):
    """As for a ufunc: as if it did not."""
    theta, ec = np.linspace(-4, 7, 9), np.zeros(8)
    wanted = dx.evaluate("V_C", theta=theta[:-1].copy(), ec=ec, **SIZES)
    assert np.array_equal(dx.evaluate("V_C", theta=theta[:-1], ec=ec, **SIZES, out=theta[1:]), wanted)


def frozen(shape):
    return read_only(np.empty(shape))


BAD_OUTS = [
    ("V_C", np.empty(4), ValueError, r"out= for V_C: an array of shape \(3,\) is wanted, got \(4,\)"),
    ("V_C", np.empty((1, 3)), ValueError, r"shape \(3,\) is wanted, got \(1, 3\)"),
    ("V_C", [0.0] * 3, ValueError, "an array of shape"),
    ("V_C", np.empty(3, int), TypeError, "out= for V_C: int64 cannot hold float64"),
    ("status", np.empty(3, bool), TypeError, "out= for status: bool cannot hold int8"),
    ("V_C", frozen(3), ValueError, "out= for V_C: the array is read-only"),
    ("V_C", {"Y": np.empty(3)}, ValueError, "out= is an array for V_C, got Y"),
    (["V_C", "Y"], {"Y": np.empty(3)}, ValueError, "out= is a dict with the keys V_C, Y, got Y"),
    (["V_C", "Y"], np.empty(3), ValueError, "out= is a dict with the keys V_C, Y"),
]


@pytest.mark.parametrize(("names", "out", "error", "complaint"), BAD_OUTS)
def test_an_out_that_does_not_fit_is_refused(names, out, error, complaint):
    theta, ec = columns(3)
    with pytest.raises(error, match=complaint):
        dx.evaluate(names, theta=theta, ec=ec, **SIZES, out=out)


def test_a_number_goes_into_no_array():
    with pytest.raises(TypeError, match="out= is for arrays"):
        dx.evaluate("V_C", **POINT, out=np.empty(()))


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
    return {name: table[:, i].copy() for i, name in enumerate(CASE_INPUTS)} | {"omega0": 157.0}


def test_every_status(way):
    assert dx.evaluate("status", **cases()).tolist() == CODES


def test_a_status_is_a_small_integer(way):
    assert dx.evaluate("status", **cases()).dtype == np.int8


@pytest.mark.parametrize("case", [case for case in CASES if case[-1] < 4], ids=str)
def test_the_status_of_one_point(case):
    *values, code = case
    point = dict(zip(CASE_INPUTS, values, strict=True))
    found = dx.evaluate("status", **point, omega0=157.0)
    assert (type(found), found) == (int, code)


def test_a_status_without_a_motion():
    assert dx.evaluate("status", theta=1.0, ec=0.0, AB=0.125, BC=0.35) == 0


def test_a_point_that_is_not_ok_has_no_finite_speed(way):
    found = dx.evaluate(["V_C", "status"], **cases())
    assert np.isfinite(found["V_C"]).tolist() == [code == 0 for code in CODES]


def test_a_rate_that_cannot_be_computed_is_nan(way):
    """But at a change point, where it has no bound."""
    found = dx.evaluate("V_C", **cases())
    assert np.isnan(found).tolist() == [code not in (0, 2) for code in CODES]


def test_a_position_that_cannot_be_computed_is_nan(way):
    """The last case is a bad acceleration, which no position needs."""
    found = dx.evaluate(["Y", "status"], **cases())
    assert np.isnan(found["Y"][:-1]).tolist() == [code in (1, 4) for code in CODES[:-1]]


def test_where_it_has_stalled_the_position_stays_finite(way):
    found = dx.evaluate(["Y", "phi", "status"], **cases())
    assert np.isfinite(found["Y"][4])
    assert np.isfinite(found["phi"][4])


INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
BAD = {"theta": math.inf, "ec": math.nan, "AB": -1e-9, "BC": 0.0, "omega0": math.nan, "alpha": math.inf}
ASKED = ["Y", "V_C", "a_C", "omega", "margin", "status"]


def all_columns(**changed):
    theta, ec = columns(4)
    given = {"theta": theta, "ec": ec, "alpha": 0.0, **SIZES} | changed
    return {name: np.broadcast_to(value, 4).astype(float) for name, value in given.items()}


@pytest.mark.parametrize("name", INPUTS)
def test_a_bad_element_disturbs_no_other(way, name):
    good = all_columns()
    bad = good[name].copy()
    bad[2] = BAD[name]
    before, after = dx.evaluate(ASKED, **good), dx.evaluate(ASKED, **good | {name: bad})
    assert all(np.array_equal(np.delete(before[q], 2), np.delete(after[q], 2)) for q in ASKED)
    assert np.isnan(after["V_C"][2])
    assert after["status"][2] == 4


@pytest.mark.parametrize("name", INPUTS)
def test_both_ways_agree_on_a_bad_element(monkeypatch, name):
    inputs = all_columns()
    inputs[name][2] = BAD[name]
    found = []
    for way in ("plain", "compiled"):
        take_way(monkeypatch, way)
        found.append(dx.evaluate(ASKED, **inputs))
    assert all(close(found[0][q], found[1][q]) for q in ASKED)


def test_a_bad_speed_is_nan_itself(way):
    found = dx.evaluate("omega", omega=np.array([2.0, math.inf, math.nan]))
    assert np.isnan(found).tolist() == [False, True, True]


# ---- what is refused -----------------------------------------------------------------------------

REFUSED = [
    ("V_c", {}, ValueError, "unknown quantity 'V_c'; did you mean V_C, "),
    ("velocity", {}, ValueError, r"unknown quantity 'velocity'.*desaxe\.quantities\(\)"),
    ("V_C_wrt_omega", {}, ValueError, "'V_C_wrt_omega' needs a state: give omega= instead of omega0="),
    (
        "V_C",
        {"theta": None},
        TypeError,
        r"V_C: theta is missing \(needed: theta, ec, AB, BC, omega0, alpha\)",
    ),
    ("V_C", {"omega0": None}, TypeError, "omega0 is missing"),
    ("V_C", {"AB": -0.1}, ValueError, re.escape("AB = -0.1: it must be a finite length >= 0")),
    ("V_C", {"BC": 0}, ValueError, "BC = 0: it must be a finite length > 0"),
    ("V_C", {"BC": -0.35}, ValueError, "BC = -0.35: it must be a finite length > 0"),
    ("V_C", {"theta": math.nan}, ValueError, "theta = nan: it must be a finite number"),
    ("V_C", {"omega0": -math.inf}, ValueError, "omega0 = -inf: it must be a finite number"),
    ("V_C", {"ec": np.float32(np.inf)}, ValueError, "ec = .*inf.*: it must be a finite number"),
    ("V_C", {"theta": 10**400}, ValueError, "theta = .*: it must be a finite number"),
    ("V_C", {"theta": 1j}, TypeError, "theta: real numbers are wanted"),
    ("V_C", {"theta": True}, TypeError, "theta: real numbers are wanted, got an array of bool"),
    ("V_C", {"theta": np.array([True])}, TypeError, "theta: .*, got an array of bool"),
    ("V_C", {"theta": np.array([1j])}, TypeError, "theta: .*, got an array of complex128"),
    ("V_C", {"theta": [None]}, TypeError, "theta: real numbers are wanted"),
    ("V_C", {"AB": np.array([-1.0, -2.0])}, ValueError, "AB: every value is bad, the first is -1.0; "),
    ("V_C", {"ec": np.full(3, np.nan)}, ValueError, "ec: every value is bad, the first is nan"),
    ("V_C", {"BC": np.array(0.0)}, ValueError, "BC: every value is bad, .* it must be a finite length > 0"),
    ("V_C", {"branch": 0}, ValueError, r"branch = 0: it is \+1 or -1"),
    ("V_C", {"branch": 2}, ValueError, r"branch = 2: it is \+1 or -1"),
    ("V_C", {"branch": "1"}, ValueError, r"branch = '1': it is \+1 or -1"),
    ("V_C", {"branch": [1, -1]}, (TypeError, ValueError), r"branch = \[1, -1\]: it is \+1 or -1"),
    ("V_C", {"branch": np.array([1, -1])}, (TypeError, ValueError), "branch = .*: it is"),
    ("V_C", {"accuracy": "perfect"}, ValueError, "accuracy = 'perfect': it is one of standard"),
    ("V_C", {"omega": 3.0}, ValueError, r"give omega0= \(the law\) or omega= \(a state\), not both"),
    ("V_C", {"threads": 0}, ValueError, "threads = 0: a whole number, at least 1"),
    (["V_C", 7], {}, TypeError, "the name of a quantity is a str, got 7"),
    ("V_C", {"length": 3.0}, TypeError, "length"),
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


# ---- units ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "text", "number"),
    [
        ("ec", "10 mm", 0.01),
        ("ec", "10mm", 0.01),
        ("ec", "-0.5 inch", -0.0127),
        ("AB", "1.25e-1 m", 0.125),
        ("theta", "60deg", math.pi / 3),
        ("theta", "-90 degree", -math.pi / 2),
        ("theta", "1.5", 1.5),
        ("omega0", "1500rpm", 50 * math.pi),
        ("omega0", "3 rad/s", 3.0),
        ("alpha", "2 rad/s^2", 2.0),
    ],
)
def test_a_text_may_carry_its_unit(name, text, number):
    found = dx.evaluate("a_C", **POINT | {name: text})
    assert math.isclose(found, dx.evaluate("a_C", **POINT | {name: number}), rel_tol=1e-12)


def test_a_quantity_of_pint():
    length = dx.units.registry().Quantity(10, "mm")
    assert math.isclose(dx.evaluate("Y", **POINT | {"ec": length}), dx.evaluate("Y", **POINT), rel_tol=1e-15)


@pytest.mark.parametrize(
    ("text", "number"),
    [("350 mm", 0.35), ("35 cm", 0.35), ("0.03 m", 0.03), ("220 mm", 0.22), ("3e2 mm", 0.3)],
)
def test_text_is_the_double_of_the_si_number(text, number):
    assert dx.evaluate("margin", ec=0.0, AB=0.0, BC=text) == number


def test_a_list_of_text():
    found = dx.evaluate("Y", **POINT | {"theta": ["0 deg", "90 deg"]})
    assert np.allclose(found, dx.evaluate("Y", **POINT | {"theta": np.radians([0, 90])}), rtol=1e-14)


def test_an_array_of_pint():
    angles = dx.units.registry().Quantity([0, 90, 180], "deg")
    found = dx.evaluate("Y", **POINT | {"theta": angles})
    assert np.allclose(found, dx.evaluate("Y", **POINT | {"theta": np.radians([0, 90, 180])}), rtol=1e-14)


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("ec", "3 kg", "ec = '3 kg': it must be a quantity in m"),
        ("theta", "3 mm", "theta = '3 mm': it must be a quantity in rad"),
        ("AB", "-10 mm", r"AB = -0\.01: it must be a finite length >= 0"),
        ("ec", "ten", "ec = 'ten': it must be a number, or a number with a unit"),
        ("ec", "", "ec = ''"),
        ("omega0", "25 Hz", "omega0 = '25 Hz': it must be a quantity in rad/s, such as \"1500 rpm\""),
        ("omega0", "1500 min^-1", "it must be a quantity in rad/s"),
        ("theta", "60 %", "it must be a quantity in rad"),
        ("theta", "1,5 rad", "it must be a number, or a number with a unit"),
        ("theta", "nan", "theta = nan: it must be a finite number"),
    ],
)
def test_a_unit_that_does_not_fit_is_refused(name, text, complaint):
    with pytest.raises(ValueError, match=complaint):
        dx.evaluate("V_C", **POINT | {name: text})


# ---- both ways, threads, far angles, a state -----------------------------------------------------


@pytest.mark.parametrize("size", [_arrays.BREAK_EVEN - 1, _arrays.BREAK_EVEN])
def test_both_ways_give_the_same(monkeypatch, size):
    theta, ec = columns(size)
    found = []
    for way in ("plain", "compiled"):
        take_way(monkeypatch, way)
        found.append(dx.evaluate(["Y", "V_C", "status"], theta=theta, ec=ec, **SIZES))
    assert all(close(found[0][name], found[1][name]) for name in found[0])


def test_points_asked_for_again_and_again_are_compiled(monkeypatch):
    asked = []
    monkeypatch.setattr(_arrays, "_ASKED", Counter())
    monkeypatch.setattr(_arrays, "is_ready", lambda key: False)
    monkeypatch.setattr(_arrays, "run_in_blocks", lambda *arguments: asked.append(arguments))
    monkeypatch.setattr(_arrays, "kernel_for", lambda key: key)
    theta, ec = columns(_arrays.BREAK_EVEN // 3)
    for calls in (0, 0, 0, 1):
        dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
        assert len(asked) == calls


def test_labelled_arrays_of_other_dimensions_are_refused():
    theta, ec = xarray.DataArray([0.1, 0.2], dims="t"), xarray.DataArray([0.0, 0.01], dims="e")
    with pytest.raises(ValueError, match=r"theta \('t',\), ec \('e',\); use grid"):
        dx.evaluate("V_C", **POINT | {"theta": theta, "ec": ec})
    assert dx.evaluate("V_C", **POINT | {"theta": theta}).shape == (2,)


def test_a_masked_array_is_refused():
    with pytest.raises(TypeError, match="theta: a masked array; fill it first"):
        dx.evaluate("V_C", **POINT | {"theta": np.ma.masked_invalid([0.1, math.nan])})


def test_a_few_points_are_not_compiled(monkeypatch):
    monkeypatch.setattr(_arrays, "is_ready", lambda key: False)
    monkeypatch.setattr(_arrays, "kernel_for", None)
    monkeypatch.setattr(_arrays, "_ASKED", Counter())
    theta, ec = columns(_arrays.BREAK_EVEN - 1)
    assert np.isfinite(dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)).all()


@pytest.mark.parametrize("size", [39_999, 40_001, 100_003])
def test_threads_change_no_bit(size):
    theta, ec = columns(size)
    one, two, free = (dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, threads=n) for n in (1, 2, None))
    assert np.array_equal(one, two)
    assert np.array_equal(one, free)


@pytest.mark.parametrize("largest", [1.6e6, 1e7, 1e15])
def test_an_angle_may_be_far(monkeypatch, largest):
    theta = np.array([largest, -largest / 3, 1.0])
    found = []
    for way in ("plain", "compiled"):
        take_way(monkeypatch, way)
        found.append(dx.evaluate("V_C", theta=theta, ec=np.zeros(3), **SIZES))
    assert close(found[0], found[1])


def test_one_element_is_as_good_as_a_number(way):
    theta, ec = columns(3)
    wanted = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    one = SIZES | {"AB": np.array([0.125]), "BC": [[0.35]]}
    found = dx.evaluate("V_C", theta=theta, ec=ec, **one)
    assert found.shape == (1, 3)
    assert np.array_equal(found[0], wanted)


STATE = {"theta": 1.1, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega": -20.0, "alpha": 7.0}
STATED = ["V_C", "a_C_wrt_omega", "V_C_wrt_theta_omega", "omega_wrt_omega", "status"]


def test_a_state_has_derivatives_by_omega():
    found = dx.evaluate(STATED, **STATE)
    step = 2.0**-20
    up, down = (dx.evaluate("a_C", **STATE | {"omega": -20.0 + s}) for s in (step, -step))
    assert list(found) == STATED
    assert math.isclose(found["a_C_wrt_omega"], (up - down) / (2 * step), rel_tol=1e-8)
    assert found["omega_wrt_omega"] == 1.0


def test_a_state_of_arrays(way):
    omega = np.array([-20.0, 0.0, 3.0])
    found = dx.evaluate(STATED, **STATE | {"omega": omega})
    for index, speed in enumerate(omega.tolist()):
        one = dx.evaluate(STATED, **STATE | {"omega": speed})
        assert all(math.isclose(found[q][index], one[q], rel_tol=1e-14, abs_tol=1e-15) for q in STATED)


def test_a_state_fills_out_by_its_own_names(way):
    out = {"a_C_wrt_omega": np.empty(2)}
    dx.evaluate("a_C_wrt_omega", **STATE | {"omega": np.array([1.0, 2.0])}, out=out)
    assert np.isfinite(out["a_C_wrt_omega"]).all()


def test_a_state_has_none_by_omega0():
    with pytest.raises(ValueError, match="'V_C_wrt_omega0' has no meaning for a given state omega="):
        dx.evaluate("V_C_wrt_omega0", **STATE)


def test_a_state_never_stalls():
    assert dx.evaluate("status", **STATE | {"theta": 100.0, "alpha": -1e9}) == 0


# ---- kernels on disk -----------------------------------------------------------------------------

CODE = """
import numpy as np, desaxe as dx
from desaxe import _kernels
theta = np.linspace(-4.0, 7.0, 3000)
value = dx.evaluate("V_B_X", theta=theta, AB=0.125, omega0=157.0)
(kernel,) = _kernels._LOADED.values()
stats = kernel.function.stats
print(value.sum().hex(), sum(stats.cache_hits.values()), sum(stats.cache_misses.values()))
"""


def start(folder, *options, **environment):
    """A new process that runs one kernel from a cache folder."""
    return subprocess.Popen(
        [sys.executable, *options, "-c", CODE],
        env=os.environ | {"DESAXE_CACHE_DIR": str(folder)} | environment,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def answer(process):
    """Its sum, how many kernels it found on disk and how many it compiled; and its complaints."""
    out, complaints = process.communicate()
    assert process.returncode == 0, complaints
    total, hits, misses = out.split()
    return total, int(hits), int(misses), complaints


def test_a_new_process_does_not_compile(tmp_path):
    first = answer(start(tmp_path, "-W", "error"))
    second = answer(start(tmp_path, "-W", "error"))
    assert first[1:] == (0, 1, "")
    assert second[1:] == (1, 0, "")
    assert first[0] == second[0]


def test_processes_started_together_all_succeed(tmp_path):
    running = [start(tmp_path / "new" / "folder", "-W", "error") for _ in range(2)]
    answers = [answer(process) for process in running]
    assert answers[0][0] == answers[1][0]
    assert sum(misses for _, _, misses, _ in answers) == 1


def test_a_folder_that_cannot_be_written_is_a_warning(tmp_path):
    blocked, scratch = tmp_path / "a file", tmp_path / "scratch"
    blocked.write_text("in the way")
    scratch.mkdir()
    complaints = answer(start(blocked / "cache", TMPDIR=str(scratch)))[-1]
    assert "RuntimeWarning: no cache folder can be written" in complaints
    assert "DESAXE_CACHE_DIR" in complaints


def test_a_folder_without_permission_is_a_warning(tmp_path, monkeypatch):
    def refused(**_):
        raise PermissionError("read-only")

    monkeypatch.setenv("DESAXE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(tempfile, "TemporaryFile", refused)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.warns(RuntimeWarning, match="no cache folder can be written"):
        found = _cache.folder.__wrapped__()
    assert found.path.parent == tmp_path
    assert not found.lasting


def test_a_kernel_of_another_version_is_not_taken_for_this_one(tmp_path, monkeypatch):
    """A version with other limits: the same request, another kernel."""
    monkeypatch.setattr(_cache, "folder", lambda: _cache.Folder(tmp_path, True))
    key = _kernels.KernelKey(("V_B_X",), True, (("branch", 1.0),), (("AB", 0),), 1)
    values, out = {"theta": 0.0, "omega": 2.0, "AB": np.array([-0.5])}, np.empty(1)
    _kernels._load(key).run(values, [out])
    assert math.isnan(out[0])
    monkeypatch.setattr(_kernels, "LEAST", {})
    _kernels._load(key).run(values, [out])
    assert out[0] == -1.0


def test_a_makeshift_folder_is_not_left_behind(tmp_path):
    blocked, scratch = tmp_path / "a file", tmp_path / "scratch"
    blocked.write_text("in the way")
    scratch.mkdir()
    answer(start(blocked / "cache", TMPDIR=str(scratch)))
    assert list(scratch.iterdir()) == []
