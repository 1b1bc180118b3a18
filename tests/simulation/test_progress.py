"""Motions of thousands of designs tell how far they are."""

from contextlib import contextmanager

import numpy as np
import pytest

import desaxe as dx

DESIGN = {"ec": 0.01, "AB": 0.05, "BC": 0.12, "m_slider": np.linspace(1.0, 2.0, 24), "I_crank": 0.01}


@pytest.mark.parametrize("kind", ["many", "each"])
def test_long_simulations_tell_what_is_done(kind, monkeypatch):
    seen = []

    @contextmanager
    def recorded(**options):
        assert options == {"unit": "designs"}
        yield lambda *message: seen.append(message)

    monkeypatch.setattr("desaxe.simulation.rows.progress_bar", recorded)
    monkeypatch.setattr("desaxe.simulation.rows.LARGE", 20)
    monkeypatch.setattr("desaxe.simulation.rows.PART", 8)
    torque, more = 1.0, {} if kind == "many" else {"wrt": "AB"}
    dx.simulate(torque=torque, t_end=0.01, **more, **DESIGN)
    done = [message[0] for message in seen]
    assert seen[0] == (0, 24, "motions")
    assert len(done) > 2
    assert done == sorted(done)
    assert done[-1] == 24


def test_one_design_has_the_time_at_which_it_ends():
    one = dx.simulate(torque=1.0, t_end=1.0, until=1.0, **{**DESIGN, "m_slider": 1.0})
    assert one["t_last"] == one["t"][-1] == one["events"][-1].t
