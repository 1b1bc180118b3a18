"""One design in the energy form: as the integrator moves it, event by event, and as it moves among many."""

import math

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases
from tests.simulation.by_time import by_time
from tests.simulation.energy.test_energy import ANGLES, MACHINE, TABLES, drawn

KINDS = {"number": lambda v: float(v[0]), **TABLES}
KEYS = ("theta", "omega", "t_last", "work")


def singles(kind, count, seed):
    """Random designs, one by one, under a load of a kind; every second with angles that end it."""
    rng = np.random.default_rng(seed)
    designs = {**drawn(count, seed), "F_Y": 0.0}
    for row in range(count):
        one = {name: float(np.broadcast_to(v, count)[row]) for name, v in designs.items()}
        one["F_Y"] = KINDS[kind](rng.uniform(-30.0, 30.0, 8))
        one["BC"] += 0.08 * (kind != "number")
        if row % 3 == 2:
            one["torque"] = dx.over_theta(ANGLES, rng.uniform(-2.0, 3.0, 5), "linear")
        yield one, {} if row % 2 else {"until": (one["theta0"] + rng.uniform(-6.0, 6.0, 2)).tolist()}


def near(ours, theirs, tolerance, least, what):
    """Compare numbers or histories, relative to the largest; NaN where the other has NaN."""
    size = np.nanmax(np.abs(theirs), initial=0.0) + least
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=tolerance * size, err_msg=what)


@pytest.mark.sampled
@pytest.mark.parametrize("kind", KINDS)
def test_all_events_are_those_of_the_integrator(kind):
    compared = 0
    for design, more in singles(kind, cases(2, 4, 40), 21):
        try:
            ours = dx.simulate(t_end=0.8, **design, **more)
        except ValueError:  # no mechanism there
            continue
        if ours["method"] != "energy":
            continue
        compared += 1
        theirs = by_time(t_end=0.8, rtol=1e-12, **design, **more)
        assert theirs["method"] == "panels"
        assert ours["status"] == theirs["status"]
        told, wanted = ([(e.kind, e.which) for e in found["events"]] for found in (ours, theirs))
        assert told == wanted
        for one, other in zip(ours["events"], theirs["events"], strict=True):
            near(one[1:4], other[1:4], 1e-7, 0.1, one.kind)
        assert not np.isnan(ours["alpha"]).any()
        for key in KEYS:
            near(ours[key], theirs[key], 1e-7, 1e-2, key)
    assert compared


@pytest.mark.parametrize(
    "kind", ["number", *(pytest.param(kind, marks=pytest.mark.thorough) for kind in TABLES)]
)
def test_one_design_is_as_it_is_among_many(kind):
    count = 2
    rng = np.random.default_rng(8)
    designs = {**drawn(count, 8), "F_Y": KINDS[kind](rng.uniform(-30.0, 30.0, 8))}
    designs["F_Y"] = designs["F_Y"] if callable(designs["F_Y"]) else np.full(count, designs["F_Y"])
    designs["BC"] = designs["BC"] + 0.08
    call = {"t_end": 0.8, "times": np.linspace(0.0, 0.8, 9)}
    many = dx.simulate(**call, **designs)
    for row in range(count):
        one = {name: v if callable(v) else float(v[row]) for name, v in designs.items()}
        found = dx.simulate(**call, **one)
        assert found["method"] == many["method"][row] == "energy"
        assert found["status"] == many["status"][row]
        size = len(found["t"])
        for key in ("theta", "omega", "alpha", "t_last", "work"):
            near(found[key], np.atleast_1d(many[key][row])[:size], 1e-12, 0.0, key)


def test_the_end_at_an_angle_among_many():
    """Each design ends at an instant of its own; work and its derivatives are those up to there."""
    design = {**MACHINE, "m_slider": np.array([1.0, 2.0, 3.0])}
    call = {"torque": 0.5, "t_end": 2.0, "until": 3.0}
    assert set(dx.simulate(**call, **design)["method"]) == {"energy"}
    many = dx.simulate(**call, wrt=["torque", "theta0", "m_slider"], **design)
    assert (np.diff(many["t_last"]) > 0.0).all()
    np.testing.assert_allclose(many["work"], 1.5, rtol=1e-12)
    for p, wanted in (("torque", 3.0), ("theta0", -0.5), ("m_slider", 0.0)):
        np.testing.assert_allclose(many[f"work_wrt_{p}"], wanted, rtol=0.0, atol=1e-11)


def test_a_swing_stops_where_its_energy_is_spent():
    """Up and down under gravity: where potential energy is that of the start, once every half period."""
    start = {"torque": 0.0, "theta0": 2.0, "omega_start": 0.7, "g_Y": -9.81}
    found = dx.simulate(t_end=20.0, rtol=1e-12, **start, **MACHINE)
    stops = [event for event in found["events"] if event.kind == "standstill"]
    assert len(stops) > 20
    at = {"alpha": 0.0, "g_Y": -9.81, **MACHINE}
    names = ["kinetic_energy", "potential_energy"]
    begin = sum(dx.evaluate(names, theta=2.0, omega=0.7, **at).values())
    ends = dx.evaluate(names, theta=np.array([event.theta for event in stops]), omega=0.0, **at)
    np.testing.assert_allclose(ends["potential_energy"], begin, rtol=0.0, atol=1e-13)
    periods = np.diff([event.t for event in stops][::2])
    np.testing.assert_allclose(periods, periods[0], rtol=1e-12)


def test_many_pieces_and_too_many():
    swing = {"torque": 0.0, "theta0": 2.0, "omega_start": 0.5, "g_Y": -9.81, **MACHINE}
    whole = dx.simulate(t_end=100.0, **swing)
    assert (whole["status"], whole["method"]) == (0, "energy")
    assert len(whole["events"]) > 300
    few = dx.simulate(t_end=100.0, max_steps=1200, **swing)
    assert few["status"] == 4
    assert "more than 1200 steps" in few["message"]
    assert 1.0 < few["t"][-1] == few["t_last"] < 100.0
    assert [event.t for event in few["events"]] == [e.t for e in whole["events"] if e.t <= few["t_last"]]
    late = dx.simulate(t_end=1e6, max_steps=10**8, timeout=0.3, **swing)
    assert late["status"] == 4
    assert "not done within timeout = 0.3 s, after" in late["message"]
    assert np.isfinite(late["theta"]).all()


def test_the_way_of_one_design_is_chosen_and_told():
    call = {"torque": 1.0, "t_end": 0.1, **MACHINE}
    assert dx.simulate(**call)["method"] == "energy"
    assert by_time(**call)["method"] == "panels"
    assert dx.simulate(mu=0.1, **call)["method"] == "panels"
    still = {**call, "torque": 0.0}  # an equilibrium everywhere
    assert dx.simulate(**still)["method"] == "panels"


def test_a_machine_speaks_its_units():
    si = {**MACHINE, "omega0": 3.0}
    machine = dx.Machine(si, units="m, kg").replace(units="mm, deg, rpm")
    call = {"torque": 1.0}
    ours = machine.simulate(t_end=2.0, until=math.degrees(2.0), **call)
    plain = dx.simulate(t_end=2.0, until=2.0, omega_start=3.0, **call, **MACHINE)
    assert ours["method"] == plain["method"] == "energy"
    assert ours["t_last"] == pytest.approx(plain["t_last"], rel=1e-12)
    assert ours["events"][-1].theta == pytest.approx(math.degrees(2.0), rel=1e-12)
    at = ours["solution"](0.5 * plain["t_last"])
    wanted = plain["solution"](0.5 * plain["t_last"])
    assert at["theta"] == pytest.approx(math.degrees(wanted["theta"]), rel=1e-12)


@pytest.mark.parametrize(
    "call",
    [
        {"t_end": 1e-9},
        {"t_end": 1e-3, "theta0": 4.0},
        {"t_end": 1e-3, "theta0": 1e5},
        {"t_end": 1.0, "ec": 0.25, "omega_start": 3.0, "rtol": 1e-12},
    ],
)
def test_rounding_is_not_told_as_an_energy_residual(call):
    """An angle that hardly moves, or next to a limit angle, has few digits: a smaller rtol is of no use."""
    found = dx.simulate(**{**MACHINE, "torque": 1.0, **call})
    assert found["method"] == "energy"
    assert "energy_residual" not in found["message"]


def test_a_late_motion_is_told_as_far_as_it_was_followed():
    """Its panels may be too wide, which is known at its end: what was found before counts."""
    wide = {**MACHINE, "BC": 0.3, "ec": 0.02, "m_slider": 0.4}
    late = dx.simulate(torque=10.0, t_end=1e4, timeout=0.3, max_steps=10**8, **wide)
    assert late["status"] == 4
    assert late["t_last"] > 0.1
    assert "after 0 steps" not in late["message"]


def test_speeds_beyond_every_double_end_with_a_status():
    assert dx.simulate(torque=1.0, t_end=1e-3, omega_start=1e200, **MACHINE)["status"] == 4


@pytest.mark.parametrize("theta0", [0.1, 4.0, 1e5])
@pytest.mark.parametrize("ec", [0.02, 0.25])
def test_histories_begin_as_the_motion_does(theta0, ec):
    start = {"theta0": -theta0 if ec > 0.1 and theta0 < 1e5 else theta0, "omega_start": 0.3}
    for torque in (1.0, -0.7):
        found = dx.simulate(**{**MACHINE, "ec": ec, "torque": torque, "t_end": 1e-3, **start})
        assert found["method"] == "energy"
        assert (found["theta"][0], found["omega"][0]) == tuple(start.values())
        assert found["solution"](0.0) == {"theta": start["theta0"], "omega": 0.3}
