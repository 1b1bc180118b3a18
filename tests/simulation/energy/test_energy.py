"""The energy form beside the integrator and the true motion, over random machines."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases
from tests.motions import true_end
from tests.simulation.by_time import by_time

T_END = 1.2
TIMES = np.linspace(0.0, T_END, 25)


def drawn(count, seed):
    """Designs that turn and that rock, on their way or at rest, with and without loads and gravity."""
    rng = np.random.default_rng(seed)
    AB, ec, room = (
        rng.uniform(0.05, 0.15, count),
        rng.uniform(-0.08, 0.08, count),
        rng.uniform(-0.4, 1.5, count),
    )

    def some(low, high, share):
        return rng.uniform(low, high, count) * (rng.random(count) < share)

    return {
        "AB": AB, "ec": ec, "BC": np.maximum((AB + np.abs(ec)) * (1.02 + room), 0.03),
        "m_rod": rng.uniform(0.0, 2.0, count), "m_slider": rng.uniform(0.1, 3.0, count),
        "I_crank": rng.uniform(1e-3, 0.1, count), "I_rod": rng.uniform(0.0, 0.02, count),
        "m_crank": rng.uniform(0.0, 1.0, count), "F_Y": some(-50.0, 50.0, 0.5),
        "g_X": some(-9.81, 9.81, 0.5), "g_Y": some(-9.81, 9.81, 0.5), "theta0": rng.uniform(-4.0, 4.0, count),
        "omega_start": some(-10.0, 10.0, 0.7), "torque": some(-3.0, 3.0, 0.8),
    }  # fmt: skip


def apart(ours, theirs):
    """The largest difference of each design, of its largest value; 0 where it has none."""
    largest = np.nan_to_num(np.fmax.reduce(np.abs(theirs), axis=1))
    return np.nan_to_num(np.fmax.reduce(np.abs(ours - theirs), axis=1)) / np.where(
        largest > 0.0, largest, 1.0
    )


@pytest.mark.sampled
@pytest.mark.parametrize("branch", [1, -1])
def test_random_machines_move_as_the_integrator_moves_them(branch):
    designs = drawn(cases(40, 500, 5_000), 7 + branch)
    ours = dx.simulate(t_end=T_END, times=TIMES, branch=branch, **designs)
    theirs = by_time(t_end=T_END, times=TIMES, branch=branch, rtol=1e-12, **designs)
    np.testing.assert_array_equal(ours["status"], theirs["status"])
    own = ours["method"] == "energy"
    assert own.mean() > 0.8
    assert (ours["method"][~own & (ours["status"] != 6)] == "panels").all()
    assert apart(ours["theta"], theirs["theta"]).max() < 1e-9
    assert apart(ours["omega"], theirs["omega"]).max() < 1e-8
    assert apart(ours["alpha"], theirs["alpha"]).max() < 1e-6
    np.testing.assert_array_equal(np.isnan(ours["theta"]), np.isnan(theirs["theta"]))
    there = ours["status"] != 6
    np.testing.assert_allclose(ours["t_last"][there], theirs["t_last"][there], rtol=1e-6)
    work = np.maximum(np.abs(theirs["work"]), 1e-2)[there]
    assert np.max(np.abs(ours["work"] - theirs["work"])[there] / work) < 1e-5  # at a limit angle
    assert ours["energy_residual"][own].max() < 1e-8


PLACES, ANGLES = [-0.05, 0.1, 0.2, 0.31], [0.3, 1.2, 2.5, 4.0, 5.1]
STEPS = [0.0, 0.01, 0.05, 0.1]
TABLES = {
    "linear over theta": lambda v: dx.over_theta(ANGLES, v[:5], "linear"),
    "steps over theta": lambda v: dx.over_theta(ANGLES, v[:5], "step"),
    "cubic over two turns": lambda v: dx.over_theta([2.0 * a for a in ANGLES], v[:5], period=4.0 * np.pi),
    "over Y": lambda v: dx.over_Y(PLACES, v[:4]),
    "over Y, another inward": lambda v: dx.over_Y(PLACES, v[:4], v[4:]),
    "over the stroke": lambda v: dx.over_stroke(STEPS, v[:4], v[4:], dead_centre="outer"),
}


@pytest.mark.sampled
@pytest.mark.parametrize("kind", TABLES)
def test_under_tables_of_all_kinds(kind):
    """One after the other the integrator takes a hundred times longer."""
    count = cases(3, 20, 200)
    rng = np.random.default_rng(5)
    designs = {**drawn(count, 5), "g_X": 0.0, "F_Y": TABLES[kind](rng.uniform(-30.0, 30.0, 8))}
    designs["BC"] = designs["BC"] + 0.08
    designs["torque"] = dx.over_theta(ANGLES, rng.uniform(-2.0, 3.0, 5), "linear")
    call = {"t_end": 0.8, "times": np.linspace(0.0, 0.8, 9), "names": ["T_in", "V_C"], **designs}
    ours, theirs = dx.simulate(**call), by_time(rtol=1e-12, **call)
    assert (ours["method"] == "energy").any()
    np.testing.assert_array_equal(ours["status"], theirs["status"])
    for name, least in (("theta", 1e-10), ("omega", 1e-9), ("V_C", 1e-9)):
        assert apart(ours[name], theirs[name]).max() < least
    moving = ours["omega"] != 0.0  # at rest the integrator takes a load that turns with the slider forwards
    assert apart(np.where(moving, ours["alpha"], 0.0), np.where(moving, theirs["alpha"], 0.0)).max() < 1e-8
    own = ours["method"] == "energy"
    torque = designs["torque"](ours["theta"][own])
    np.testing.assert_allclose(ours["T_in"][own], torque, rtol=1e-8, atol=1e-8)
    there = ours["status"] == 0
    for name in ("t_last", "work"):
        np.testing.assert_allclose(ours[name][there], theirs[name][there], rtol=1e-8, atol=1e-8)


MACHINE = {"AB": 0.12, "BC": 0.35, "ec": 0.03, "m_rod": 1.1, "m_slider": 2.0, "I_crank": 0.01, "I_rod": 0.008}


def machines(**given):
    """Two equal designs; all that may vary is an array, so that all tests share their kernels."""
    names = set(drawn(1, 0)) - {"theta0", "omega_start", "torque"}
    values = {**dict.fromkeys(names, 0.0), **MACHINE, "torque": 0.0, **given}
    return {name: np.broadcast_to(np.asarray(value), 2) for name, value in values.items()}


@pytest.mark.parametrize(
    "start",
    [
        {"torque": 1.5, "theta0": 0.0},
        {"torque": 1.5, "theta0": 2.0, "omega_start": -4.0},  # it turns round
        {"torque": 0.0, "theta0": 1.0, "omega_start": 2.0, "g_Y": -9.81},
    ],
)
def test_the_true_motion(start):
    t_end = 0.25
    found = dx.simulate(t_end=t_end, times=[t_end], rtol=1e-12, **machines(**start))
    design = {**MACHINE, "g_Y": start.get("g_Y", 0.0)}
    truth = true_end(design, start["torque"], start["theta0"], start.get("omega_start", 0.0), t_end, 80)
    np.testing.assert_allclose(found["theta"][0, 0], truth[0], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found["omega"][0, 0], truth[1], rtol=0.0, atol=1e-10)


def test_no_digit_hangs_on_the_other_designs():
    designs = drawn(23, 3)
    together = dx.simulate(t_end=T_END, times=TIMES, **designs)
    for rows in ([4], [22, 1], list(range(5, 17))):
        some = dx.simulate(t_end=T_END, times=TIMES, **{n: v[rows] for n, v in designs.items()})
        for name in ("theta", "omega", "alpha", "status", "t_last", "work", "method"):
            np.testing.assert_array_equal(some[name], together[name][rows])


@pytest.mark.parametrize("start", [{"torque": 0.8}, {"torque": -0.8}, {"omega_start": 30.0, "g_Y": -9.81}])
def test_an_instant_is_the_same_alone_and_among_many(start):
    """Whole turns that hold no instant are passed by at once."""
    rng = np.random.default_rng(5)
    designs = drawn(20, 3) | {"ec": 0.01, "BC": 0.5, "theta0": rng.uniform(-3.0, 3.0, 20), "F_Y": 0.0}
    designs |= {"torque": 0.0, "omega_start": 0.0, "g_X": 0.0, "g_Y": 0.0} | start
    designs = {name: np.broadcast_to(value, 20) for name, value in designs.items()}  # see `machines`
    alone = dx.simulate(t_end=5.0, times=[5.0], **designs)
    among = dx.simulate(t_end=5.0, times=np.linspace(0.0, 5.0, 400), **designs)
    assert np.abs(alone["theta"]).max() > 40.0
    for name in ("theta", "omega"):
        np.testing.assert_allclose(alone[name][:, -1], among[name][:, -1], rtol=1e-12)


def test_many_swings_are_one():
    """A crank swings 200 s: the instants of its standstills are those of its period."""
    swing = machines(g_Y=-9.81, theta0=3.0)
    first = dx.simulate(t_end=3.0, times=np.linspace(0.0, 3.0, 301), **swing)
    single = dx.simulate(t_end=3.0, **{**MACHINE, "g_Y": -9.81, "torque": 0.0, "theta0": 3.0})
    stops = [event.t for event in single["events"] if event.kind == "standstill"]
    period = stops[1] if stops[0] > 1e-9 else stops[2]
    assert abs(first["theta"][0]).max() < 20.0
    count = round(200.0 / period)
    late = dx.simulate(t_end=201.0, times=[count * period, (count + 0.25) * period, 201.0], **swing)
    assert late["theta"][0, 0] == pytest.approx(3.0, abs=1e-7)
    assert late["theta"][0, 1] == pytest.approx(single["solution"](0.25 * period)["theta"], abs=1e-6)


def test_long_motions_and_their_most_pieces():
    """Turns by the hundred: more pieces than a motion takes in the caller's own thread."""
    call = {**machines(torque=[0.4, 0.8], omega_start=5.0), "t_end": 60.0, "times": [30.0, 60.0]}
    whole = dx.simulate(**call)
    assert (whole["method"] == "energy").all()
    assert whole["theta"].max() > 1000.0 * np.pi
    brief = call | {"t_end": 5.0, "times": [2.0, 5.0]}
    ours, theirs = dx.simulate(**brief), by_time(rtol=1e-12, **brief)
    np.testing.assert_allclose(ours["theta"], theirs["theta"], rtol=1e-9)
    # Within a turn the speed swings: 1e-12 of thousands of radians is what it hangs on.
    np.testing.assert_allclose(ours["omega"], theirs["omega"], rtol=1e-6)
    for most in (10, 1000):
        few = dx.simulate(max_steps=most, **call)
        assert few["status"].tolist() == [4, 4]
        assert (few["t_last"] < 60.0).all()


def test_the_way_is_chosen_and_told():
    designs = drawn(5, 11)
    assert set(dx.simulate(t_end=0.1, **designs)["method"]) == {"energy"}
    assert set(by_time(t_end=0.1, **designs)["method"]) == {"panels"}
    bare = dict.fromkeys(("m_rod", "m_slider", "I_rod", "ec"), 0.0)
    massless = machines(AB=0.1, BC=0.06, I_crank=1.0, theta0=0.1, torque=1.0, **bare)
    assert set(dx.simulate(t_end=5.0, **massless)["method"]) == {"panels"}


@pytest.mark.sampled
def test_work_of_a_load_over_the_slider_up_to_limit_angles():
    """The integral of the load from Y at the start to AB cos theta of one of the limit angles."""
    places, force = np.linspace(-0.4, 0.4, 9), np.random.default_rng(2).uniform(-30.0, 30.0, 9)
    designs = {**drawn(cases(40, 200, 2_000), 5), "torque": 0.0, "F_Y": dx.over_Y(places, force)}
    found = dx.simulate(t_end=2.0, times=[2.0], **designs)
    limit = (found["status"] == 2) & (found["method"] == "energy")
    assert limit.sum() >= 3
    AB, ec, BC, theta0 = (designs[name][limit] for name in ("AB", "ec", "BC", "theta0"))
    sums = np.append(0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(places)))

    def integral(Y):
        k = np.clip(np.searchsorted(places, Y) - 1, 0, len(places) - 2)
        return sums[k] + (Y - places[k]) * 0.5 * (force[k] + np.interp(Y, places, force))

    sines = np.stack([ec - BC, ec + BC]) / AB
    ends = np.sqrt(np.where(np.abs(sines) <= 1.0, 1.0 - sines**2, np.nan)) * AB
    start = dx.evaluate("Y", theta=theta0, AB=AB, ec=ec, BC=BC)
    ways = integral(np.nan_to_num(np.concatenate([ends, -ends]), nan=9.0)) - integral(start)
    assert np.abs(ways - found["work"][limit]).min(axis=0).max() < 1e-9
