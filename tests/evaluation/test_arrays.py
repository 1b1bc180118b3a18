"""Arrays in and out of `desaxe.evaluate`: shapes, layouts, names, out=."""

import math

import numpy as np
import pytest

import desaxe as dx
from tests.ways import POINT, SIZES, close, columns, one_by_one

SEVERAL = ["status", "Y", "V_C"]

# ---- shapes and layouts --------------------------------------------------------------------------

SHAPES = [
    ((3,), (3,)), ((3, 1), (4,)), ((1,), (5,)), ((2, 3, 4), (4,)), ((2, 1, 3), (4, 1)), ((5,), ()),
    ((1, 1), (1,)),
]  # fmt: skip
EMPTY_SHAPES = [((0,), ()), ((0,), (1,)), ((0, 3), (3,)), ((3, 0), (1, 1)), ((0,), (0,))]


@pytest.mark.parametrize(("left", "right"), SHAPES)
def test_arrays_broadcast(left, right):
    theta, ec = columns(*left)[0], columns(*right)[1]
    found = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert found.shape == np.broadcast_shapes(left, right)
    assert close(found, one_by_one("V_C", theta, ec))


@pytest.mark.parametrize(("left", "right"), EMPTY_SHAPES)
def test_nothing_in_nothing_out(left, right):
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
def test_any_layout_gives_the_same(layout):
    theta, ec = columns(4, 3)
    wanted = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    found = dx.evaluate("V_C", theta=LAYOUTS[layout](theta), ec=LAYOUTS[layout](ec), **SIZES)
    assert np.array_equal(found, wanted)


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int16, np.uint8, np.longdouble])
def test_other_numbers_are_computed_as_doubles(kind):
    theta, ec = np.arange(3).astype(kind), np.zeros(3, kind)
    found = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert found.dtype == np.float64
    wanted = dx.evaluate("V_C", theta=theta.astype(float), ec=ec.astype(float), **SIZES)
    assert np.array_equal(found, wanted)


def test_inputs_are_left_alone():
    theta, ec = columns(5)
    before = theta.copy(), ec.copy()
    dx.evaluate(SEVERAL, theta=theta, ec=ec, **SIZES)
    assert np.array_equal(theta, before[0])
    assert np.array_equal(ec, before[1])


# ---- names ---------------------------------------------------------------------------------------


def test_a_list_gives_a_dict_in_order():
    assert list(dx.evaluate(["a_C", "Y", "V_C"], **POINT)) == ["a_C", "Y", "V_C"]


def test_a_list_of_arrays_gives_a_dict_in_order():
    theta, ec = columns(3)
    found = dx.evaluate(tuple(SEVERAL), theta=theta, ec=ec, **SIZES)
    assert list(found) == SEVERAL
    assert close(found["Y"], one_by_one("Y", theta, ec))


@pytest.mark.parametrize("theta", [1.1, np.array([1.1, 1.2])], ids=["a number", "an array"])
def test_a_name_may_come_twice(theta):
    found = dx.evaluate(["Y", "V_C", "Y"], **POINT | {"theta": theta})
    assert list(found) == ["Y", "V_C"]
    assert np.array_equal(found["Y"], dx.evaluate("Y", **POINT | {"theta": theta}))


def test_a_name_may_come_twice_from_a_kernel():
    theta, ec = columns(3)
    assert list(dx.evaluate([*SEVERAL, "Y"], theta=theta, ec=ec, **SIZES)) == SEVERAL


def test_one_name_in_a_list_is_still_a_dict():
    assert dx.evaluate(["Y"], **POINT) == {"Y": dx.evaluate("Y", **POINT)}


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
    wanted = dx.evaluate(["V_C", "a_C"], theta=theta, **design)
    memory = np.empty(theta.size + 1)
    dx.evaluate(["V_C", "a_C"], theta=theta, **design, out={"V_C": memory[:-1], "a_C": memory[1:]})
    assert memory[0] == wanted["V_C"][0]
    assert np.array_equal(memory[1:], wanted["a_C"])


def test_out_is_filled_and_returned():
    theta, ec = columns(5)
    out = np.full(5, -1.0)
    assert dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=out) is out
    assert close(out, one_by_one("V_C", theta, ec))


def test_out_of_a_list_is_a_dict():
    theta, ec = columns(5)
    out = {"V_C": np.empty(5), "Y": np.empty(5), "status": np.empty(5, np.int8)}
    found = dx.evaluate(SEVERAL, theta=theta, ec=ec, **SIZES, out=out)
    assert all(found[name] is out[name] for name in out)
    assert list(found) == SEVERAL
    assert close(out["Y"], one_by_one("Y", theta, ec))


OUTS = {
    "every other": lambda: np.zeros((8, 3))[::2],
    "backwards": lambda: np.zeros((4, 3))[::-1],
    "transposed": lambda: np.zeros((3, 4)).T,
    "swapped bytes": lambda: swapped(np.zeros((4, 3))),
    "unaligned": lambda: unaligned(np.zeros((4, 3))),
}


@pytest.mark.parametrize("layout", OUTS)
def test_out_may_have_any_layout(layout):
    theta, ec = columns(4, 3)
    out = OUTS[layout]()
    assert dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=out) is out
    assert np.array_equal(out, dx.evaluate("V_C", theta=theta, ec=ec, **SIZES))


def test_a_view_fills_only_its_elements():
    theta, ec = columns(3)
    whole = np.full(6, -1.0)
    dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=whole[::2])
    assert whole[1::2].tolist() == [-1.0] * 3


def test_out_may_be_single_precision():
    theta, ec = columns(5)
    out = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=np.empty(5, np.float32))
    assert out.dtype == np.float32
    assert np.array_equal(out, dx.evaluate("V_C", theta=theta, ec=ec, **SIZES).astype(np.float32))


def test_out_may_have_no_axes():
    out = np.array(0.0)
    assert dx.evaluate("V_C", **POINT | {"theta": np.array(1.1)}, out=out) is out
    assert out == dx.evaluate("V_C", **POINT)


def test_a_status_may_go_into_wider_numbers():
    theta, ec = columns(3)
    out = {"status": np.full(3, 9), "Y": np.empty(3), "V_C": np.empty(3)}
    dx.evaluate(SEVERAL, theta=theta, ec=ec, **SIZES, out=out)
    assert out["status"].tolist() == [0, 0, 0]


def test_out_may_be_an_input():
    theta, ec = columns(5)
    wanted = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    assert np.array_equal(dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, out=theta), wanted)


def test_out_may_overlap_an_input():
    """As for a ufunc: as if it did not."""
    theta, ec = np.linspace(-4, 7, 9), np.zeros(8)
    wanted = dx.evaluate("V_C", theta=theta[:-1].copy(), ec=ec, **SIZES)
    assert np.array_equal(dx.evaluate("V_C", theta=theta[:-1], ec=ec, **SIZES, out=theta[1:]), wanted)


def frozen(shape):
    return read_only(np.empty(shape))


BAD_OUTS = [
    ("V_C", np.empty(4), ValueError, r"out= for V_C: expected an array of shape \(3,\), got \(4,\)"),
    ("V_C", np.empty((1, 3)), ValueError, r"shape \(3,\), got \(1, 3\)"),
    ("V_C", [0.0] * 3, ValueError, "an array of shape"),
    ("V_C", np.empty(3, int), TypeError, "out= for V_C: int64 cannot hold float64"),
    ("status", np.empty(3, bool), TypeError, "out= for status: bool cannot hold int8"),
    ("V_C", frozen(3), ValueError, "out= for V_C: the array is read-only"),
    ("V_C", {"Y": np.empty(3)}, ValueError, "out= is an array for V_C, got Y"),
    (["V_C", "Y"], {"Y": np.empty(3)}, ValueError, "out= is a dict with the keys V_C, Y, got Y"),
    (["V_C", "Y"], np.empty(3), ValueError, "out= is a dict with the keys V_C, Y"),
]


def test_an_out_for_no_name_is_refused():
    theta, _ = columns(3)
    for out in (3, np.empty(3), []):
        with pytest.raises(ValueError, match="no name is given, so there is nothing to fill"):
            dx.grid([], theta=theta, ec=0.0, AB=1.0, BC=3.0, out=out)
        with pytest.raises(ValueError, match="name at least one quantity"):
            dx.evaluate([], theta=theta, ec=0.0, AB=1.0, BC=3.0, out=out)
    assert dx.grid([], theta=theta, ec=0.0, AB=1.0, BC=3.0, out={}) == {}


@pytest.mark.parametrize(("names", "out", "error", "complaint"), BAD_OUTS)
def test_an_out_that_does_not_fit_is_refused(names, out, error, complaint):
    theta, ec = columns(3)
    with pytest.raises(error, match=complaint):
        dx.evaluate(names, theta=theta, ec=ec, **SIZES, out=out)


def test_a_number_goes_into_no_array():
    with pytest.raises(TypeError, match="out= is for arrays"):
        dx.evaluate("V_C", **POINT, out=np.empty(()))


MANY = np.linspace(-7.0, 7.0, 300_001)
READ_ONLY = np.linspace(-7.0, 7.0, 900)
READ_ONLY.flags.writeable = False
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
