"""Random machines under loads of all kinds: one at a time, many at once, and true motions."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases

TURN = 2.0 * np.pi
MACHINE = {"AB": 0.12, "BC": 0.35, "ec": 0.03, "m_rod": 1.1, "m_slider": 2.0, "I_crank": 0.01, "I_rod": 0.008}
DESIGN = {
    "AB": 0.05, "BC": 0.2, "ec": 0.01, "m_crank": 1.0, "m_rod": 0.5, "m_slider": 2.0, "I_crank": 0.01,
    "I_rod": 0.003,
}  # fmt: skip
PLACES, ANGLES = [-0.05, 0.1, 0.2, 0.31], [0.3, 1.2, 2.5, 4.0, 5.1]
STEPS = [0.0, 0.01, 0.05, 0.1]
LOADS = {
    "number": lambda v: {"F_Y": v[0]},
    "linear over theta": lambda v: {"F_Y": dx.over_theta(ANGLES, v[:5], "linear")},
    "steps over theta": lambda v: {"F_Y": dx.over_theta(ANGLES, v[:5], "step")},
    "cubic over two turns": lambda v: {
        "F_Y": dx.over_theta([2.0 * a for a in ANGLES], v[:5], period=4.0 * np.pi)
    },
    "over Y": lambda v: {"F_Y": dx.over_Y(PLACES, v[:4])},
    "over Y, another inward": lambda v: {"F_Y": dx.over_Y(PLACES, v[:4], v[4:])},
    "over the stroke": lambda v: {"F_Y": dx.over_stroke(STEPS, v[:4], v[4:], dead_centre="outer")},
    "motor": lambda v: {"torque": dx.over_omega([-5.0, 0.0, 4.0, 9.0], [4.0, 3.0, 2.5, -1.0])},
    "induction motor": lambda v: {"torque": dx.kloss(5.0, 0.2, 12.0), "F_Y": v[0]},
    "friction": lambda v: {"mu": 0.1, "F_Y": dx.over_Y(PLACES, v[:4]), "F_X": v[5]},
    "friction and a motor": lambda v: {"mu": 0.2, "torque": dx.over_omega([0.0, 9.0], [3.0, -1.0])},
}


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


@pytest.mark.parametrize("kind", LOADS)
def test_designs_move_together_as_each_does_alone(kind):
    """Pieces, cuts and friction of compiled loops, with panels of the angle and without."""
    count = cases(4, 20, 200)
    rng = np.random.default_rng(5)
    designs = {**drawn(count, 5), "g_X": 0.0, "BC": drawn(count, 5)["BC"] + 0.08 * (kind != "number")}
    designs["torque"] = dx.over_theta(ANGLES, rng.uniform(-2.0, 3.0, 5), "linear")
    designs |= LOADS[kind](rng.uniform(-30.0, 30.0, 8))
    call = {"t_end": 0.8, "times": np.linspace(0.0, 0.8, 9), "names": ["V_C"]}
    many = dx.simulate(**call, **designs)
    for row in range(count):
        one = {n: float(v[row]) if isinstance(v, np.ndarray) else v for n, v in designs.items()}
        if many["status"][row] == 6:
            continue
        alone = dx.simulate(rtol=1e-12, **call, **one)
        assert many["status"][row] == alone["status"], (row, one)
        size = len(alone["t"])
        for name, least in (("theta", 1e-9), ("omega", 1e-8), ("alpha", 1e-6), ("V_C", 1e-8)):
            assert np.isnan(many[name][row, size:]).all()
            largest = np.abs(alone[name]).max() + 1e-3
            np.testing.assert_allclose(many[name][row, :size], alone[name], rtol=0, atol=least * largest)
        for name in ("t_last", "work"):
            assert many[name][row] == pytest.approx(alone[name], rel=1e-6, abs=1e-6)


@pytest.mark.sampled
def test_work_of_a_load_over_the_slider_up_to_limit_angles():
    """The integral of the load from Y at the start to AB cos theta of one of the limit angles."""
    places, force = np.linspace(-0.4, 0.4, 9), np.random.default_rng(2).uniform(-30.0, 30.0, 9)
    designs = {**drawn(cases(40, 200, 2_000), 5), "torque": 0.0, "F_Y": dx.over_Y(places, force)}
    result = dx.simulate(t_end=2.0, times=[2.0], **designs)
    limit = result["status"] == 2
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
    assert np.abs(ways - result["work"][limit]).min(axis=0).max() < 1e-9


def test_no_digit_hangs_on_the_other_designs():
    designs = drawn(23, 3)
    call = {"t_end": 1.2, "times": np.linspace(0.0, 1.2, 25)}
    together = dx.simulate(**call, **designs)
    for rows in ([4], [22, 1], list(range(5, 17))):
        some = dx.simulate(**call, **{n: v[rows] for n, v in designs.items()})
        for name in ("theta", "omega", "alpha", "status", "t_last", "work"):
            np.testing.assert_array_equal(some[name], together[name][rows])


def test_the_end_at_an_angle_among_many():
    """Each design ends at an instant of its own; work and its derivatives are those up to there."""
    design = {**MACHINE, "m_slider": np.array([1.0, 2.0, 3.0])}
    call = {"torque": 0.5, "t_end": 2.0, "until": 3.0}
    many = dx.simulate(**call, wrt=["torque", "theta0", "m_slider"], **design)
    assert (np.diff(many["t_last"]) > 0.0).all()
    np.testing.assert_allclose(many["work"], 1.5, rtol=1e-12)
    for p, expected in (("torque", 3.0), ("theta0", -0.5), ("m_slider", 0.0)):
        np.testing.assert_allclose(many[f"work_wrt_{p}"], expected, rtol=0.0, atol=1e-11)


def test_a_swing_stops_where_its_energy_is_spent():
    """Up and down under gravity: where potential energy is that of the start, once every half period."""
    start = {"torque": 0.0, "theta0": 2.0, "omega_start": 0.7, "g_Y": -9.81}
    result = dx.simulate(t_end=20.0, rtol=1e-12, **start, **MACHINE)
    stops = [event for event in result["events"] if event.kind == "standstill"]
    assert len(stops) > 20
    at = {"alpha": 0.0, "g_Y": -9.81, **MACHINE}
    names = ["kinetic_energy", "potential_energy"]
    begin = sum(dx.evaluate(names, theta=2.0, omega=0.7, **at).values())
    ends = dx.evaluate(names, theta=np.array([event.theta for event in stops]), omega=0.0, **at)
    np.testing.assert_allclose(ends["potential_energy"], begin, rtol=0.0, atol=1e-13)
    periods = np.diff([event.t for event in stops][::2])
    np.testing.assert_allclose(periods, periods[0], rtol=1e-12)


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
    result = dx.simulate(**{**MACHINE, "torque": 1.0, **call})
    assert "energy_residual" not in result["message"]


def test_speeds_beyond_every_double_end_with_a_status():
    assert dx.simulate(torque=1.0, t_end=1e-3, omega_start=1e200, **MACHINE)["status"] == 4


@pytest.mark.parametrize("theta0", [0.1, 4.0, 1e5])
@pytest.mark.parametrize("ec", [0.02, 0.25])
def test_histories_begin_as_the_motion_does(theta0, ec):
    start = {"theta0": -theta0 if ec > 0.1 and theta0 < 1e5 else theta0, "omega_start": 0.3}
    for torque in (1.0, -0.7):
        result = dx.simulate(**{**MACHINE, "ec": ec, "torque": torque, "t_end": 1e-3, **start})
        assert (result["theta"][0], result["omega"][0]) == tuple(start.values())
        assert result["solution"](0.0) == {"theta": start["theta0"], "omega": 0.3}


def test_many_pieces_and_too_many():
    swing = {"torque": 0.0, "theta0": 2.0, "omega_start": 0.5, "g_Y": -9.81, **MACHINE}
    whole = dx.simulate(t_end=100.0, **swing)
    assert whole["status"] == 0
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
    call = {"torque": torque, "omega_start": omega, "t_end": t, "times": [t], "max_steps": 10**6}
    result = dx.simulate(**call, rtol=1e-12, **designs)
    assert result["status"].tolist() == [0, 0]
    np.testing.assert_allclose(result["theta"][:, 0], TURN * count, rtol=1e-12)
    np.testing.assert_allclose(result["omega"][:, 0], end, rtol=1e-9)


def test_the_derivatives_after_many_turns_are_sums_over_each():
    t, _, slopes = turn_by_turn(1.5, 60.0, 60)
    call = {"torque": 1.5, "omega_start": 60.0, "t_end": t, "times": [t], "rtol": 1e-12}
    result = dx.simulate(**call, wrt=list(slopes), **DESIGN)
    for p, truth in slopes.items():
        np.testing.assert_allclose(result[f"theta_wrt_{p}"], truth, rtol=1e-11)
