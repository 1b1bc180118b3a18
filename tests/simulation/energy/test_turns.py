"""Thousands of turns at once, against the sum over each of them."""

import numpy as np
import pytest

import desaxe as dx

DESIGN = {
    "AB": 0.05, "BC": 0.2, "ec": 0.01, "m_crank": 1.0, "m_rod": 0.5, "m_slider": 2.0, "I_crank": 0.01,
    "I_rod": 0.003,
}  # fmt: skip
TURN = 2.0 * np.pi


def turn_by_turn(torque, omega, count):
    """Sum up turns from angle 0 on: their time, the speed at their end, and d theta by each parameter.

    A turn is Gauss's rule on panels; E and its slopes go on from turn to turn.
    """
    nodes, weights = np.polynomial.legendre.leggauss(20)
    starts = TURN / 24.0 * np.arange(24)[:, None]
    x, w = (starts + TURN / 48.0 * (1.0 + nodes)).ravel(), np.tile(TURN / 48.0 * weights, 24)
    at = {**DESIGN, "omega": 1.0, "alpha": 0.0}
    inertia, by_AB = dx.evaluate(["M_eff", "M_eff_wrt_AB"], theta=np.append(x, 0.0), **at).values()
    M, M_p, first, first_p = inertia[:-1], by_AB[:-1], inertia[-1], by_AB[-1]
    t, by = 0.0, np.zeros(3)
    for n in range(count):
        gone = TURN * n + x
        E = 0.5 * first * omega**2 + torque * gone
        slow = w * np.sqrt(0.5 * M / E)
        t += slow.sum()
        by += [
            -0.5 * (slow / E * first * omega).sum(),
            -0.5 * (slow / E * gone).sum(),
            0.5 * (slow * (M_p / M - 0.5 * first_p * omega**2 / E)).sum(),
        ]
    end = np.sqrt(2.0 * (0.5 * first * omega**2 + torque * TURN * count) / first)
    return t, end, dict(zip(("omega_start", "torque", "AB"), -end * by, strict=True))


@pytest.mark.parametrize(
    ("torque", "omega", "count"),
    [(0.0, 3000.0, 3000), (1.5, 60.0, 4000), (-1.5, 1500.0, 1200), (-3e-3, 1e4, 3000)],
)
def test_thousands_of_turns_are_the_sum_of_each(torque, omega, count):
    """Steady, from 60 to 2,000 rad/s, from 1,500 to 530, and all but steady: with few pieces of panels."""
    t, end, _ = turn_by_turn(torque, omega, count)
    designs = {n: np.full(2, v) for n, v in DESIGN.items()}
    call = {"torque": torque, "omega_start": omega, "t_end": t, "times": [t], "max_steps": 20_000}
    found = dx.simulate(**call, rtol=1e-12, **designs)
    assert found["status"].tolist() == [0, 0]
    np.testing.assert_allclose(found["theta"][:, 0], TURN * count, rtol=1e-12)
    np.testing.assert_allclose(found["omega"][:, 0], end, rtol=1e-9)


def test_the_derivatives_after_many_turns_are_sums_over_each():
    t, _, slopes = turn_by_turn(1.5, 60.0, 60)
    call = {"torque": 1.5, "omega_start": 60.0, "t_end": t, "times": [t], "rtol": 1e-12}
    found = dx.simulate(**call, wrt=list(slopes), **DESIGN)
    for p, truth in slopes.items():
        np.testing.assert_allclose(found[f"theta_wrt_{p}"], truth, rtol=1e-11)
