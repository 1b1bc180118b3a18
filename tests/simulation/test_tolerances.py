"""The errors of random motions are what rtol says: `python -m benchmarks.tolerances` draws the many."""

import numpy as np
import pytest

import desaxe as dx
from benchmarks.tolerances import HIGHEST, KINDS, cranks, errors, of_all
from tests.effort import cases

POWERS = (6, 8, 10, 12)
TABLE = dx.over_theta(np.linspace(0.0, 2.0 * np.pi, 7)[:-1], [0.6, 2.1, 0.9, 1.8, 2.4, 1.1], "cubic")


@pytest.mark.parametrize("power", POWERS)
def test_the_worst_error_is_near_rtol(power):
    rtol = 10.0**-power
    assert errors("number", cases(100, 500, 1_000), rtol, seed=5).max() <= HIGHEST * rtol
    assert errors("friction", cases(2, 4, 40), rtol, seed=6).max() <= HIGHEST * rtol


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["of t, theta, omega", "of theta", "of t, fast", "table of theta"])
def test_whatever_drives_the_motion(kind):
    count = cases(100, 100, 1_000) if KINDS[kind][1] else cases(2, 2, 40)
    for power in POWERS:
        rtol = 10.0**-power
        assert errors(kind, count, rtol, seed=6).max() <= HIGHEST * rtol


@pytest.mark.thorough
def test_a_panel_is_shortened_at_the_end_of_a_motion_though_its_part_is_less_smooth():
    drawn = cranks(1_000, np.random.default_rng(5))
    row = {name: np.broadcast_to(values, 1_000)[837:838] for name, values in drawn.items()}
    call = {"torque": of_all, "t_end": 1.0, "times": [1.0], **row}
    truth, result = (dx.simulate(rtol=rtol, **call) for rtol in (3e-14, 1e-6))
    assert result["method"] == ["panels"]
    for name in ("theta", "omega"):
        np.testing.assert_allclose(result[name], truth[name], rtol=HIGHEST * 1e-6)


def test_a_step_ends_at_each_knot_of_a_table():
    """Across one the third derivative jumps, and the estimate of a step was wrong by a thousand times."""
    drawn = {name: float(np.broadcast_to(v, 1)[0]) for name, v in cranks(1, np.random.default_rng(3)).items()}
    call = {"torque": TABLE, "t_end": 0.5, "times": [0.5], **drawn}
    truth, result = (dx.simulate(rtol=rtol, **call) for rtol in (3e-14, 1e-10))
    for name in ("theta", "omega"):
        assert abs(result[name][0] / truth[name][0] - 1.0) < HIGHEST * 1e-10
