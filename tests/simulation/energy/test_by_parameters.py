"""Derivatives of motions in their energy form: against 60 digits, the integrator's, and differences."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases
from tests.motions import true_slopes
from tests.simulation.by_time import by_time
from tests.simulation.energy.test_energy import ANGLES, MACHINE, TABLES, drawn, machines

WRT = ["AB", "m_slider", "theta0", "omega_start", "ec", "torque"]
T_END = 0.8
TIMES = np.linspace(0.0, T_END, 9)
KEYS = ("theta", "omega", "t_last", "work")


def one_by_one(designs, wrt, own, least):
    """Compare with the collocation along the integrator's motion, design after design.

    That goes on to a limit angle by polynomials, which cost some digits of the end.
    """
    for row in np.flatnonzero(own["method"] == "energy"):
        one = {name: v if callable(v) else v[row].item() for name, v in designs.items()}
        theirs = by_time(t_end=T_END, times=TIMES, wrt=wrt, rtol=1e-12, **one)
        assert theirs["status"] == own["status"][row]
        for name in (f"{key}_wrt_{p}" for p in wrt for key in KEYS):
            wanted, found = np.atleast_1d(theirs[name]), np.atleast_1d(own[name][row])
            size = np.abs(wanted).max(initial=0.1)
            if theirs["status"] == 2 and name.startswith(("t_last", "work")):
                size *= 1e2
            close = {"rtol": 0.0, "atol": least * size, "err_msg": f"{name} of design {row}"}
            np.testing.assert_allclose(found[: wanted.size], wanted, **close)
            assert np.isnan(found[wanted.size :]).all()


def slope_of(designs, p, key):
    """The central difference of order four of the ends of motions."""
    step = 2e-5 * np.maximum(np.abs(designs[p]), 0.05)
    runs = [
        dx.simulate(t_end=T_END, times=TIMES, rtol=3e-14, **{**designs, p: designs[p] + k * step})[key]
        for k in (-2, -1, 1, 2)
    ]
    return (8.0 * (runs[2] - runs[1]) - (runs[3] - runs[0])) / (12.0 * step)


@pytest.mark.sampled
def test_random_machines_beside_the_integrator():
    """Turning and rocking, at rest and on their way, to limit angles and back from standstills."""
    designs = drawn(cases(6, 40, 1_000), 8)
    designs["torque"] = designs["torque"] + 0.01
    own = dx.simulate(t_end=T_END, times=TIMES, wrt=WRT, **designs)
    assert (own["method"] == "energy").mean() > 0.8
    assert "sensitivities" not in own["message"]
    one_by_one(designs, WRT, own, 1e-6)


@pytest.mark.sampled
def test_ends_at_limit_angles():
    designs = drawn(cases(60, 200, 1_000), 8)
    own = dx.simulate(t_end=T_END, times=TIMES, wrt=WRT, **designs)
    limit = (own["status"] == 2) & (own["method"] == "energy")
    assert limit.sum() >= 5
    for p in WRT:
        for key in ("t_last", "work"):
            wanted, found = slope_of(designs, p, key)[limit], own[f"{key}_wrt_{p}"][limit]
            np.testing.assert_allclose(found, wanted, rtol=1e-5, atol=1e-5)


def test_they_are_those_of_60_digits():
    start = {"torque": -0.5, "theta0": 1.0, "omega_start": 12.0}
    found = dx.simulate(
        t_end=0.05,
        times=[0.05],
        rtol=1e-12,
        wrt=WRT,
        **machines(g_Y=-9.81, F_Y=4.0, **start),
    )
    for p in WRT[: cases(3, len(WRT))]:
        theta, omega = true_slopes(p, {**MACHINE, "g_Y": -9.81, "F_Y": 4.0}, -0.5, 1.0, 12.0, 0.05, 13)
        assert found[f"theta_wrt_{p}"][1, 0] == pytest.approx(theta, rel=1e-10)
        assert found[f"omega_wrt_{p}"][1, 0] == pytest.approx(omega, rel=1e-10)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", TABLES)
def test_tables_of_all_kinds_with_a_torque_that_jumps(kind):
    """Jumps over the slider move with the lengths; on rocking designs those over the angle do, too."""
    rng = np.random.default_rng(5)
    designs = {**drawn(cases(6, 12, 200), 5), "F_Y": TABLES[kind](rng.uniform(-30.0, 30.0, 8))}
    designs["torque"] = dx.over_theta(ANGLES, rng.uniform(-2.0, 3.0, 5), "step")
    wrt = WRT[:-1]
    own = dx.simulate(t_end=T_END, times=TIMES, wrt=wrt, **designs)
    assert (own["method"] == "energy").mean() > 0.5
    one_by_one(designs, wrt, own, 1e-5)


@pytest.mark.parametrize("start", [0.0, 1e-7, -1e-7])
def test_next_to_rest(start):
    """At rest and barely moving: the derivatives are one smooth function of the start."""
    call = {"t_end": 0.5, "times": [0.1, 0.5], "wrt": WRT}
    near = dx.simulate(**call, **machines(torque=1.0, omega_start=start, theta0=0.4))
    far = dx.simulate(**call, **machines(torque=1.0, omega_start=1e-4, theta0=0.4))
    assert set(near["method"]) == {"energy"}
    for p in WRT:
        np.testing.assert_allclose(near[f"theta_wrt_{p}"], far[f"theta_wrt_{p}"], rtol=1e-3, atol=1e-3)


def test_more_swings_than_a_brief_motion_has_pieces():
    """Whole swings are left out, with their derivatives, too: a hundred pieces are enough."""
    swing = machines(torque=0.0, g_Y=-9.81, omega_start=0.5, theta0=2.5)
    call = {"t_end": 15.0, "times": [15.0]}
    found = dx.simulate(**call, wrt=WRT, **swing)
    assert set(found["method"]) == {"energy"}
    for p in ("AB", "omega_start"):
        ends = [dx.simulate(**call, rtol=3e-14, **{**swing, p: swing[p] + k * 1e-6}) for k in (-2, -1, 1, 2)]
        far, near, after, last = (end["theta"] for end in ends)
        slope = (8.0 * (after - near) - (last - far)) / 12e-6
        np.testing.assert_allclose(found[f"theta_wrt_{p}"], slope, rtol=1e-5)
    enough = dx.simulate(**call, wrt=WRT, max_steps=100, **swing)
    assert enough["status"].tolist() == [0, 0]
    np.testing.assert_array_equal(enough["theta_wrt_AB"], found["theta_wrt_AB"])
    few = dx.simulate(**call, wrt=WRT, max_steps=3, **swing)
    assert few["status"].tolist() == [4, 4]
    assert (few["t_last"] <= 15.0).all()
    assert np.isnan(few["theta_wrt_AB"]).all()
    assert "sensitivities: NaN" in few["message"]


def test_what_the_energy_form_does_not_differentiate():
    designs = machines(torque=1.0)
    assert set(dx.simulate(t_end=0.01, times=[0.01], wrt="mu", **designs)["method"]) == {"panels"}


def test_no_digit_hangs_on_the_other_designs():
    designs = {**drawn(9, 3)}
    together = dx.simulate(t_end=T_END, times=TIMES, wrt=WRT, **designs)
    for rows in ([4], [8, 1]):
        some = dx.simulate(t_end=T_END, times=TIMES, wrt=WRT, **{n: v[rows] for n, v in designs.items()})
        for name in (f"{key}_wrt_{p}" for key in KEYS for p in WRT):
            np.testing.assert_array_equal(some[name], together[name][rows])
