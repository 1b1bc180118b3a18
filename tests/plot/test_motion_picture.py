"""The picture of a motion: its histories over time and its events, in the units of the machine."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.plot import Picture

DESIGN = {"ec": 0.01, "AB": 0.05, "BC": 0.12, "m_slider": 2.0, "I_crank": 0.01}


def swing(t, theta, omega):
    return 1.5 * np.cos(8.0 * t)


def test_the_histories_and_the_events_of_a_motion():
    result = dx.Machine(DESIGN, units="m, deg, rpm").simulate(torque=swing, t_end=0.6, names=["V_C"])
    picture = result.plot()
    assert isinstance(picture, Picture)
    assert list(picture) == ["theta", "omega", "alpha", "V_C"]
    for name, (line,) in picture.artists.items():
        np.testing.assert_array_equal(line.get_xdata(), result["t"])
        np.testing.assert_array_equal(line.get_ydata(), result[name])
    kinds = {event.kind for event in result["events"]}
    assert kinds == {"dead centre", "standstill"}
    for line in picture.axes[0].lines[1:]:
        own = [event for event in result["events"] if event.kind == line.get_label()]
        assert list(line.get_xdata()) == [event.t for event in own]
        assert list(line.get_ydata()) == [event.theta for event in own]
    assert "rpm" in picture.axes[1].get_ylabel()
    assert "deg" in picture.axes[0].get_ylabel()


def test_curves_of_a_motion_over_time_and_over_the_angle():
    result = dx.simulate(torque=swing, t_end=0.6, **DESIGN)
    (line,) = dx.plot.curves(result, "omega", over="t")
    np.testing.assert_array_equal(line.get_xdata(), result["t"])
    (line,) = dx.plot.curves(result, "omega")
    np.testing.assert_allclose(line.get_xdata(), np.degrees(result["theta"]))
    with pytest.raises(ValueError, match="over 't' or over 'theta'"):
        dx.plot.curves(result, "omega", over="ec")
    with pytest.raises(TypeError, match="draws a result of"):
        dx.plot.motion({"a_C": np.ones(3)})


def test_each_of_many_designs_has_its_curve():
    torque = dx.over_omega([0.0, 90.0], [1.0, 0.0])
    result = dx.simulate(torque=torque, t_end=0.2, **{**DESIGN, "m_slider": [1.0, 2.0, 3.0]})
    picture = result.plot()
    lines = picture["omega"]
    assert len(lines) == 3
    legend = picture.axes[0].get_legend()
    assert [text.get_text() for text in (legend.get_title(), *legend.get_texts())] == [
        "m_slider [kg]", "1", "2", "3"
    ]  # fmt: skip
    press = dx.Machine({**DESIGN, "AB": 50.0, "BC": 120.0, "ec": 10.0}, units="mm, deg, rpm")
    both = press.replace(AB=[45.0, 50.0]).simulate(torque=[1.0, 2.0], t_end=0.1).plot()
    texts = [text.get_text() for text in both.axes[0].get_legend().get_texts()]
    assert texts == ["AB = 45 mm, torque = 1 N m", "AB = 50 mm, torque = 2 N m"]
    np.testing.assert_array_equal(lines[2].get_ydata(), result["omega"][2])
    one = dx.simulate(torque=1.0, t_end=0.2, wrt="theta0", **DESIGN)
    assert list(one.plot())[3:] == ["theta_wrt_theta0", "omega_wrt_theta0"]
    with pytest.raises(ValueError, match="over='t'"):
        dx.plot.curves(result, "omega")


def test_an_axis_does_not_magnify_the_rounding_of_a_level_history():
    result = dx.simulate(torque=1.2, t_end=0.05, names=["T_in"], **DESIGN)
    low, high = result.plot().axes[3].get_ylim()
    assert (low, high) == pytest.approx((1.14, 1.26), rel=1e-9)


def test_a_long_motion_is_drawn_at_instants_of_its_own():
    """1,001 samples of 110 turns show waves that are none; a curve has 60 instants a turn."""
    machine = dx.Machine(DESIGN, units="m, deg, rpm")
    result = machine.simulate(torque=10.0, t_end=2.0, names=["V_C"])
    picture = result.plot()
    turns = result["theta"][-1] / 360.0
    for name in ("theta", "omega", "alpha"):
        t = picture[name][0].get_xdata()
        assert t.size > 60 * turns
    dense = dx.simulate(torque=10.0, t_end=2.0, times=t, **DESIGN)
    theta, omega, alpha = (picture[name][0].get_ydata() for name in ("theta", "omega", "alpha"))
    np.testing.assert_allclose(np.radians(theta), dense["theta"], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(omega * np.pi / 30.0, dense["omega"], rtol=1e-8, atol=1e-8)
    size = np.abs(dense["alpha"]).max()
    np.testing.assert_allclose(np.radians(alpha) if result.units["alpha"] == "deg/s^2" else alpha,
                               dense["alpha"], atol=1e-4 * size)  # fmt: skip
    (line,) = picture["V_C"]
    assert (line.get_linestyle(), line.get_marker()) == ("None", ".")
    (marks,) = picture.axes[0].lines[1:]
    assert marks.get_xdata().size == 0
    assert marks.get_label() == f"dead centre: {len(result['events'])}, not marked"
