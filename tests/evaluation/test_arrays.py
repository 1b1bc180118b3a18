"""Arrays in and out of `desaxe.evaluate`: shapes, layouts, names, out=."""

import math

import numpy as np
import pytest

import desaxe as dx
from tests.ways import POINT, SIZES, close, columns, one_by_one

SEVERAL = ["status", "Y", "V_C"]

# ---- shapes, types and layouts -------------------------------------------------------------------

SHAPES = [
    ((3,), (3,)), ((3, 1), (4,)), ((1,), (5,)), ((2, 3, 4), (4,)), ((2, 1, 3), (4, 1)), ((5,), ()),
    ((1, 1), (1,)), ((0,), ()), ((0,), (1,)), ((0, 3), (3,)), ((3, 0), (1, 1)), ((0,), (0,)),
]  # fmt: skip


@pytest.mark.parametrize(("left", "right"), SHAPES)
def test_arrays_broadcast(left, right):
    theta, ec = np.resize(columns(9)[0], left), np.resize(columns(9)[1], right)
    before = theta.copy(), ec.copy()
    result = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert (result.shape, result.dtype) == (np.broadcast_shapes(left, right), np.float64)
    assert not result.size or close(result, one_by_one("V_C", theta, ec))
    assert np.array_equal(theta, before[0])
    assert np.array_equal(ec, before[1])


@pytest.mark.parametrize("kind", [float, np.array, np.float32, np.float16, np.int8, np.uint64, np.int64])
def test_numbers_give_a_number(kind):
    result = dx.evaluate("V_C", **POINT | {"theta": kind(1.0)})
    assert type(result) is (np.float64 if kind is np.array else float)
    assert result == dx.evaluate("V_C", **POINT | {"theta": 1.0})


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int16, np.uint8, np.longdouble])
def test_other_numbers_are_computed_as_doubles(kind):
    theta, ec = np.arange(3).astype(kind), np.zeros(3, kind)
    result = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert result.dtype == np.float64
    expected = dx.evaluate("V_C", theta=theta.astype(float), ec=ec.astype(float), **SIZES)
    assert np.array_equal(result, expected)


def swapped(array):
    return array.astype(array.dtype.newbyteorder())


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def unaligned(array):
    view = np.zeros(array.nbytes + 1, np.uint8)[1:].view(np.float64).reshape(array.shape)
    view[...] = array
    return view


IN_OUT = {
    "every other": lambda a: np.repeat(a, 2, axis=0)[::2],
    "backwards": lambda a: a[::-1].copy()[::-1],
    "transposed": lambda a: a.T.copy().T,
    "Fortran order": np.asfortranarray,
    "swapped bytes": swapped,
    "unaligned": unaligned,
}
LAYOUTS = IN_OUT | {"read-only": read_only, "nested lists": lambda a: a.tolist()}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same(layout):
    theta, ec = columns(4, 3)
    expected = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    result = dx.evaluate("V_C", theta=LAYOUTS[layout](theta), ec=LAYOUTS[layout](ec), **SIZES)
    assert np.array_equal(result, expected)
    if layout in IN_OUT:
        out = IN_OUT[layout](np.zeros((4, 3)))
        assert dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=out) is out
        assert np.array_equal(out, expected)


# ---- names ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("theta", [1.1, np.array([1.1, 1.2])], ids=["a number", "an array"])
@pytest.mark.parametrize("names", [["a_C", "Y", "V_C"], (*SEVERAL, "Y"), ["Y"], ["Y", "V_C", "Y"]])
def test_a_list_gives_a_dict_in_order_without_duplicates(names, theta):
    result = dx.evaluate(names, **POINT | {"theta": theta})
    assert list(result) == [*dict.fromkeys(names)]
    for name in names:
        assert np.array_equal(result[name], dx.evaluate(name, **POINT | {"theta": theta}))


def test_what_is_not_needed_may_be_left_out():
    assert dx.evaluate("margin", ec=0.0, AB=0.125, BC=0.375) == 0.25
    assert dx.evaluate("Y", theta=0.0, ec=0.0, AB=1.0, BC=2.0) == 3.0


@pytest.mark.parametrize("name", [*dx.quantities()][::7])
def test_every_name_can_be_asked_for(name):
    loaded = {"m_slider": 1.0} if name.startswith(("F_A_", "F_B_", "F_C_")) else {}  # no slope at no force
    assert math.isfinite(dx.evaluate(name, **POINT, alpha=-3.0, **loaded))


# ---- out= ----------------------------------------------------------------------------------------


def test_outputs_that_share_memory_are_written_one_after_the_other():
    """A kernel is promised that they do not: it writes into memory of its own then."""
    theta = np.linspace(0.0, 6.0, 40)
    design = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 157.08}
    expected = dx.evaluate(["V_C", "a_C"], theta=theta, **design)
    memory = np.empty(theta.size + 1)
    dx.evaluate(["V_C", "a_C"], theta=theta, **design, out={"V_C": memory[:-1], "a_C": memory[1:]})
    assert memory[0] == expected["V_C"][0]
    assert np.array_equal(memory[1:], expected["a_C"])


@pytest.mark.parametrize("kinds", [(np.int8, float, float), (int, float, np.float32)])
def test_out_of_a_list_is_a_dict(kinds):
    theta, ec = columns(5)
    expected = dx.evaluate(SEVERAL, theta=theta, ec=ec, **SIZES)
    out = {name: np.full(5, 9, kind) for name, kind in zip(SEVERAL, kinds, strict=True)}
    result = dx.evaluate(SEVERAL, theta=theta, ec=ec, **SIZES, out=dict(reversed(out.items())))
    assert list(result) == SEVERAL
    for name, array in out.items():
        assert result[name] is array
        assert np.array_equal(array, expected[name].astype(array.dtype))


def test_a_view_or_an_array_without_axes_is_filled():
    theta, ec = columns(3)
    whole, alone = np.full(6, -1.0), np.array(0.0)
    dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=whole[::2])
    assert whole[1::2].tolist() == [-1.0] * 3
    assert dx.evaluate("V_C", **POINT | {"theta": np.array(1.1)}, out=alone) is alone
    assert alone == dx.evaluate("V_C", **POINT | {"theta": 1.1})


@pytest.mark.parametrize("place", [slice(None, -1), slice(1, None)])
def test_out_may_be_an_input_or_overlap_it(place):
    """As for a ufunc: as if it did not."""
    theta, ec = np.linspace(-4, 7, 9), np.zeros(8)
    expected = dx.evaluate("V_C", theta=theta[:-1].copy(), ec=ec, **SIZES)
    assert np.array_equal(dx.evaluate("V_C", theta=theta[:-1], ec=ec, **SIZES, out=theta[place]), expected)


@pytest.mark.parametrize(
    ("names", "out", "error", "complaint"),
    [
        ("V_C", np.empty(4), ValueError, r"out= for V_C: expected an array of shape \(3,\), got \(4,\)"),
        ("V_C", np.empty((1, 3)), ValueError, r"shape \(3,\), got \(1, 3\)"),
        ("V_C", [0.0] * 3, ValueError, "an array of shape"),
        ("V_C", np.empty(3, int), TypeError, "out= for V_C: int64 cannot hold float64"),
        ("status", np.empty(3, bool), TypeError, "out= for status: bool cannot hold int8"),
        ("V_C", read_only(np.empty(3)), ValueError, "out= for V_C: the array is read-only"),
        ("V_C", {"Y": np.empty(3)}, ValueError, "out= is an array for V_C, got Y"),
        (["V_C", "Y"], {"Y": np.empty(3)}, ValueError, "out= is a dict with the keys V_C, Y, got Y"),
        (["V_C", "Y"], np.empty(3), ValueError, "out= is a dict with the keys V_C, Y"),
        ([], np.empty(3), ValueError, "name at least one quantity"),
    ],
)
def test_an_out_that_does_not_fit_is_refused(names, out, error, complaint):
    theta, ec = columns(3)
    with pytest.raises(error, match=complaint):
        dx.evaluate(names, theta=theta, ec=ec, **SIZES, out=out)


def test_an_out_for_no_name_or_for_numbers_is_refused():
    for out in (3, np.empty(3), []):
        with pytest.raises(ValueError, match="no name is given, so there is nothing to fill"):
            dx.grid([], theta=[0.0, 1.0], ec=0.0, AB=1.0, BC=3.0, out=out)
    assert dx.grid([], theta=[0.0, 1.0], ec=0.0, AB=1.0, BC=3.0, out={}) == {}
    with pytest.raises(TypeError, match="out= is for arrays"):
        dx.evaluate("V_C", **POINT, out=np.empty(()))


# ---- threads and far angles -----------------------------------------------------------------------


@pytest.mark.parametrize("size", [39_999, 40_001, 100_003])
def test_threads_change_no_bit(size):
    theta, ec = columns(size)
    one, two, free = (dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, threads=n) for n in (1, 2, None))
    assert np.array_equal(one, two)
    assert np.array_equal(one, free)


@pytest.mark.parametrize("largest", [1.6e6, 1e7, 1e15])
def test_an_angle_may_be_far(largest):
    """Its sine is that of the C library; the others of its column keep theirs."""
    theta = np.array([largest, -largest / 3, 1.0])
    result = dx.evaluate("V_C", theta=theta, ec=np.zeros(3), **SIZES)
    assert close(result, [dx.evaluate("V_C", theta=t, ec=0.0, **SIZES) for t in theta.tolist()])
    near = dx.evaluate("V_C", theta=np.array([2.0, 1.0]), ec=np.zeros(2), **SIZES)
    assert result[2] == near[1]


# ---- requests that are remembered ----------------------------------------------------------------

MANY = np.linspace(-7.0, 7.0, 300_001)
READ_ONLY = read_only(np.linspace(-7.0, 7.0, 900))
LAST = math.asin((SIZES["BC"] - SIZES["AB"] - 0.2) / SIZES["AB"])


@pytest.mark.parametrize(
    "inputs",
    [
        {"theta": READ_ONLY, "ec": 0.01},
        {"theta": READ_ONLY.reshape(30, 30).T, "ec": 0.0},
        {"theta": READ_ONLY[:, None], "ec": np.linspace(-0.3, 0.3, 7)},
        {"theta": np.where(READ_ONLY > 6.0, 1e9, READ_ONLY), "ec": np.float64(0.02)},
        {"theta": LAST + 2.0**-52 * np.arange(-40.0, 40.0), "ec": 0.2},
        {"theta": READ_ONLY, "ec": "10 mm", "omega0": np.where(READ_ONLY > 6.0, 1e70, 3.0)},
        *({"theta": MANY, "ec": 0.1 * np.cos(MANY), "threads": threads} for threads in (1, 2, 3)),
    ],
)
def test_a_remembered_request_gives_what_a_new_one_gives(inputs, monkeypatch):
    names = ["V_C", "a_C", "status"]
    inputs = {**SIZES, **inputs}
    again = [dx.evaluate(names, **inputs) for _ in range(3)]
    monkeypatch.setattr("desaxe.evaluation.values._KNOWN", {})
    new = dx.evaluate(names, **inputs)
    for name in names:
        assert all(one[name].tobytes() == new[name].tobytes() for one in again)
    if np.ndim(inputs["omega0"]):
        assert (new["status"][inputs["omega0"] > 1e60] == 4).all()
        assert np.isnan(new["a_C"][inputs["omega0"] > 1e60]).all()
