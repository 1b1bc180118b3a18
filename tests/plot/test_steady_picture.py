"""The picture of a steady state: what it draws is the result and the motor, in the units of the machine."""

import numpy as np
import pytest

import desaxe as dx

PRESS = dx.Machine(units="mm, deg, rpm", ec=10, AB=50, BC=200, m_slider=20, I_crank="2 kg*m^2", F_Y=-900)


def test_the_loop_lies_on_the_curve_of_the_motor():
    motor = PRESS.kloss(40, 0.15, 1500, gear=12)
    result = PRESS.steady(torque=motor)
    picture = result.plot()
    assert len(picture.axes) == 3
    assert list(picture) == ["omega", "T_motor", "motor", "loop"]
    np.testing.assert_array_equal(picture["omega"].get_ydata(), result["omega"])
    np.testing.assert_allclose(picture["omega"].get_xdata(), np.linspace(0, 360, 361), atol=1e-9)
    speed, torque = picture["loop"].get_xdata(), picture["loop"].get_ydata()
    np.testing.assert_allclose(torque, motor(speed), rtol=1e-9)
    speed, torque = picture["motor"].get_xdata(), picture["motor"].get_ydata()
    np.testing.assert_allclose(torque, motor(speed), rtol=1e-12)
    assert speed[0] == 0.0
    assert speed[-1] > result["omega"].max()
    assert "rpm" in picture.axes[2].get_xlabel()


def test_a_torque_over_the_angle_has_no_curve_and_no_state_no_picture():
    result = PRESS.steady(torque=lambda theta, omega: 100.0 - 5.0 * omega + np.sin(theta))
    assert "motor" not in result.plot()
    with pytest.raises(ValueError, match="no steady state to draw"):
        PRESS.steady(torque=30.0).plot()


def test_speeds_in_si_are_drawn_in_rpm_and_angles_have_ticks_that_divide_a_turn():
    machine = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "m_slider": 20.0, "I_crank": 2.0, "F_Y": -900.0}
    result = dx.steady(torque=dx.kloss(40.0, 0.15, 157.08, gear=12), **machine)
    picture = result.plot()
    np.testing.assert_allclose(picture["omega"].get_ydata(), result["omega"] * 30.0 / np.pi, rtol=1e-12)
    np.testing.assert_allclose(picture["loop"].get_xdata(), result["omega"] * 30.0 / np.pi, rtol=1e-12)
    speed, torque = picture["motor"].get_data()
    at = np.interp(result["omega"] * 30.0 / np.pi, speed, torque)
    np.testing.assert_allclose(at, result["T_motor"], rtol=0.02, atol=2.0)
    first, second, last = picture.axes
    assert first.get_ylabel() == "crank speed [rpm]" == last.get_xlabel()
    assert "rpm" in first.get_title(loc="left")
    for one in (first, second):
        assert one.get_xlim() == (0.0, 360.0)
        assert set(np.diff(one.get_xticks())) == {45.0}
