"""The labelled grid: the outer product of its arguments, with units, status and margin."""

import inspect

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.inputs import INPUTS, Inputs

THETA = np.linspace(0.0, 6.0, 7)
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}


def test_status_and_margin_come_always():
    grid = dx.grid("a_C", theta=[1.6, 4.0], ec=[0.1, 0.24, np.nan], **MACHINE)
    assert grid["status"].dtype == np.int8
    assert grid["status"].values.tolist() == [[0, 1, 4], [0, 0, 4]]
    assert grid["margin"].dims == ("ec",)
    assert grid["margin"].values[0] == pytest.approx(0.125)
    assert np.isnan(grid["a_C"].values[0, 1])


def test_status_of_friction_and_its_flags():
    design = {"ec": 0.02, "AB": 0.04, "BC": 0.064, "omega0": [-1.0, 1.0], "m_slider": 1.0}
    grid = dx.grid("T_in", theta=[0.0, np.pi / 2], mu=[0.0, 1.5], **design)
    assert grid["T_in"].dims == ("theta", "mu", "omega0")
    flags = np.array(grid["status"].attrs["flag_meanings"].split())[grid["status"].values]
    assert (flags[0] == "ok").all()
    assert (flags[1, 0] == "ok").all()
    assert flags[1, 1].tolist() == ["no_force_balance", "two_force_balances"]
    assert np.isnan(grid["T_in"].values[1, 1]).all()


def test_out_needs_no_labels():
    place = np.empty((7, 2))
    answer = dx.grid("a_C", theta=THETA, ec=[0.0, 0.1], out=place, **MACHINE)
    assert answer["a_C"] is place
    labelled = dx.grid("a_C", theta=THETA, ec=[0.0, 0.1], **MACHINE)["a_C"]
    np.testing.assert_allclose(place, labelled, rtol=1e-13)  # one may be plain Python, the other a kernel
    with pytest.raises(ValueError, match=r"expected an array of shape \(7, 2\)"):
        dx.grid("a_C", theta=THETA, ec=[0.0, 0.1], out=np.empty((2, 7)), **MACHINE)


def test_numbers_alone_and_an_empty_axis():
    assert dx.grid("a_C", theta=1.0, ec=0.1, **MACHINE)["a_C"].shape == ()
    assert dx.grid("a_C", theta=[], ec=0.1, **MACHINE)["a_C"].shape == (0,)


@pytest.mark.parametrize("ec", [[0.01], [0.0, 0.1]])
def test_an_axis_of_length_one(ec):
    theta, crank = np.linspace(0, 6, 300), np.array([0.1, 0.11, 0.12])
    grid = dx.grid("a_C", theta=theta, ec=ec, AB=crank, BC=[0.4], omega0=157.0)
    assert dict(grid.sizes) == {"theta": 300, "ec": len(ec), "AB": 3, "BC": 1}
    expected = dx.evaluate(
        "a_C", theta=theta[:, None, None], ec=np.array(ec)[:, None], AB=crank, BC=0.4, omega0=157.0
    )
    np.testing.assert_allclose(grid["a_C"].values[..., 0], expected, rtol=1e-13)


def test_the_signature_names_every_input():
    parameters = inspect.signature(dx.grid).parameters
    named = [name for name in parameters if name in INPUTS]
    assert named == list(INPUTS) == list(Inputs.__annotations__)
    assert not any(p.kind is inspect.Parameter.VAR_KEYWORD for p in parameters.values())
    others = {"names", "branch", "accuracy", "threads", "out", "reduce", "chunks", "sliders"}
    assert others == set(parameters) - set(named)


def test_a_position_needs_no_motion():
    grid = dx.grid("Y", theta=THETA, ec=0.1, AB=0.125, BC=0.35)
    assert "omega0" not in grid
    assert (grid["status"] == 0).all()


def test_statics_need_no_motion():
    """Where nothing has a mass and nothing rubs; by virtual work T_in = -F_Y dY/dtheta."""
    design = {"ec": 0.06, "AB": 0.14, "BC": 0.31}
    grid = dx.grid("T_in", theta=THETA, F_Y=[-50.0, 0.0], **design)
    assert "omega0" not in grid
    assert (grid["status"] == 0).all()
    speed = dx.evaluate("V_C", theta=THETA, omega0=1.0, **design)
    np.testing.assert_allclose(grid["T_in"].sel(F_Y=-50.0), 50.0 * speed, rtol=1e-12)
    for needs_a_speed in ({"m_rod": 1.0}, {"mu": 0.1}):
        with pytest.raises(TypeError, match="omega0 is missing"):
            dx.grid("T_in", theta=THETA, F_Y=-50.0, **design, **needs_a_speed)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"speed": 3.0}, TypeError, "no input 'speed'"),
        (
            {"ec": [[0.0]]},
            ValueError,
            r"ec: a grid takes numbers and 1-d arrays, got the shape \(1, 1\); evaluate takes any",
        ),
        ({"omega0": None}, TypeError, "omega0 is missing"),
        ({"BC": [-1.0, -2.0]}, ValueError, "BC: every value is bad"),
    ],
)
def test_bad_arguments(arguments, error, words):
    with pytest.raises(error, match=words):
        dx.grid("a_C", **{"theta": THETA, "ec": 0.1, **MACHINE, **arguments})


@pytest.mark.thorough
def test_the_order_of_axes_changes_no_digit():
    """Nor does broadcasting or reducing: which loop an operation is moved to must not change its rounding."""
    axes = {
        "theta": np.linspace(0.0, 6.2, 50),
        "ec": np.linspace(-0.3, 0.3, 13),
        "BC": np.linspace(0.2, 0.5, 7),
    }
    numbers, names = {"AB": 0.125, "omega0": 157.08}, ["V_C", "a_C_wrt_ec"]
    first = dx.grid(names, **axes, **numbers)
    last = dx.grid(names, ec=axes["ec"], theta=axes["theta"], BC=axes["BC"], **numbers)
    reduced = dx.grid(names, reduce={"theta": ["max", "absmax"]}, **axes, **numbers)
    points = dx.evaluate(
        names, **dict(zip(axes, np.meshgrid(*axes.values(), indexing="ij"), strict=True)), **numbers
    )
    for name in names:
        np.testing.assert_array_equal(first[name], last[name].transpose(*axes))
        np.testing.assert_array_equal(first[name], points[name])
        np.testing.assert_array_equal(first[name].max("theta"), reduced[f"{name}_max"])
        np.testing.assert_array_equal(abs(first[name]).max("theta"), reduced[f"{name}_absmax"])
