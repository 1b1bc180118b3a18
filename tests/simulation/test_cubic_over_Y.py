"""A smooth table over Y: every piece of it moves the crank, by the work that it does."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases

LENGTHS = {"AB": 0.04, "BC": 0.1}
MASSES = {"m_slider": 0.4, "m_rod": 0.2, "I_crank": 2e-3}


def work(load, start, end):
    """The integral of a table from one place to another, piece by piece."""

    def from_first(Y):
        total, edges = 0.0, [*load.outward.knots, np.inf]
        if edges[0] > Y:
            return load.outward.rows[0][0] * (Y - edges[0])
        for left, right, row in zip(edges, edges[1:], load.outward.rows[1:], strict=False):
            s = min(right, Y) - left
            total += sum(c * s ** (k + 1) / (k + 1) for k, c in enumerate(row))
            if right >= Y:
                return total
        raise AssertionError(Y)

    return from_first(end) - from_first(start)


@pytest.mark.sampled
@pytest.mark.parametrize("kind", ["cubic", "linear", "step"])
def test_kinetic_energy_is_the_work_of_torque_and_load(kind):
    rng = np.random.default_rng(36)
    for _ in range(cases(3, 20)):
        count = rng.integers(3, 8)
        places = np.sort(rng.uniform(0.07, 0.13, count))
        load = dx.over_Y(places.tolist(), rng.uniform(-60, 60, count).tolist(), kind=kind)
        given = {**LENGTHS, **MASSES, "ec": rng.uniform(-0.02, 0.02)}
        torque, theta0, speed = rng.uniform(-2, 2), rng.uniform(0, 6), rng.choice((-30.0, 30.0))
        result = dx.simulate(
            torque=torque, t_end=0.3, theta0=theta0, omega_start=speed, F_Y=load, rtol=1e-10, **given
        )
        theta, omega = result["theta"][[0, -1]], result["omega"][[0, -1]]
        there = dx.evaluate(["kinetic_energy", "Y"], theta=theta, omega=omega, alpha=0.0, **given)
        before, after = there["kinetic_energy"]
        done = torque * (theta[1] - theta[0]) + work(load, *there["Y"])
        scale = max(before, after) + abs(torque * (theta[1] - theta[0]))
        assert after - before == pytest.approx(done, abs=1e-7 * scale)
