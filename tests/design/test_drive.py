"""Drives: against free bodies integrated at 30 digits, simulated motions, differences and limits."""

import math
from itertools import pairwise

import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.force_truth import truth
from tests.effort import first

PRESS = {
    "ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 40.0, "m_slider": 2.0, "m_rod": 1.0, "I_rod": 0.003,
    "m_crank": 0.5, "r_crank": 0.01, "F_Y": -500.0, "g_Y": -9.81,
}  # fmt: skip
RUBBING = {**PRESS, "mu": 0.15}


def torque_of_the_bodies(theta, **inputs):
    return float(truth("T_in", theta=theta, **inputs))


def test_means_of_the_free_bodies():
    """Equal steps: without friction the torque is periodic and analytic, and 48 are enough."""
    result = dx.drive(**PRESS)
    torque = [torque_of_the_bodies(2 * math.pi * k / 48, **PRESS) for k in range(48)]
    assert result["torque_mean"] == pytest.approx(math.fsum(torque) / 48, abs=1e-13)
    assert result["torque_rms"] == pytest.approx(math.sqrt(math.fsum(t * t for t in torque) / 48), rel=1e-14)


def test_means_with_friction_and_work_of_the_free_bodies():
    """A side force keeps the slider on one side of its guide: kinks at the dead centres alone."""
    design = {**RUBBING, "F_X": 4000.0}
    e, a, b = design["ec"], design["AB"], design["BC"]
    ends = [-math.asin(e / (a + b)), math.pi - math.asin(e / (b - a)), 2 * math.pi - math.asin(e / (a + b))]
    node, weight = np.polynomial.legendre.leggauss(32)
    total = square = 0.0
    for low, high in pairwise(ends):
        theta = 0.5 * (low + high) + 0.5 * (high - low) * node
        torque = np.array([torque_of_the_bodies(x, **design) for x in theta.tolist()])
        total += 0.5 * (high - low) * weight @ torque
        square += 0.5 * (high - low) * weight @ torque**2
    result = dx.drive(**design)
    assert result["torque_mean"] == pytest.approx(total / (2 * math.pi), rel=1e-12)
    assert result["torque_rms"] == pytest.approx(math.sqrt(square / (2 * math.pi)), rel=1e-12)
    assert result["work_in"] - result["work_out"] == pytest.approx(total, rel=1e-12)
    assert result["power_mean"] == pytest.approx(total * 40.0 / (2 * math.pi), rel=1e-12)


@pytest.mark.parametrize(("omega0", "alpha"), [(-40.0, 0.0), (30.0, 50.0)])
def test_sums_over_time(omega0, alpha):
    """The midpoint rule in time, at instants of the law of motion; peaks by `peak`."""
    law = {"omega0": omega0, "alpha": alpha}
    design = {**RUBBING, **law}
    result = dx.drive(**design)
    way = math.copysign(1.0, omega0)
    a, b, c = alpha / 2, omega0, -way * 2 * math.pi
    period = 2 * c / (-b - way * math.sqrt(b * b - 4 * a * c))
    assert result["period"] == pytest.approx(period, rel=1e-14)
    steps = 100_000
    t = (np.arange(steps) + 0.5) * period / steps
    power, torque = (dx.evaluate(name, theta=b * t + a * t * t, **design) for name in ("power_in", "T_in"))
    assert result["torque_mean"] == pytest.approx(torque.mean(), abs=1e-7)
    assert result["torque_rms"] == pytest.approx(np.sqrt((torque**2).mean()), rel=1e-8)
    assert result["power_mean"] == pytest.approx(power.mean(), abs=1e-6)
    assert result["work_in"] == pytest.approx(np.maximum(power, 0).mean() * period, rel=1e-8)
    assert result["work_out"] == pytest.approx(np.maximum(-power, 0).mean() * period, rel=1e-8)
    turn = tuple(sorted((0.0, way * 2 * math.pi)))
    for figure, name in (("torque_peak", "T_in"), ("power_peak", "power_in")):
        top = dx.peak(name, theta=turn, **design)
        assert result[figure] == pytest.approx(top["value"], rel=1e-13)
        for parameter, slope in result["gradient"][figure].items():
            assert slope == pytest.approx(top["gradient"][parameter], rel=1e-9, abs=1e-12)
        if name == "T_in":
            around = 0.0 if alpha else 2 * math.pi * (top["theta"] < 0.0)
            assert result["theta_peak"] == pytest.approx(top["theta"] + around, abs=1e-10)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "design", [PRESS, RUBBING, {**PRESS, "F_Y": dx.damper(100.0, 50.0)}], ids=["smooth", "friction", "damped"]
)
def test_gradients_by_differences(design):
    result = dx.drive(fluctuation=0.05, **design)
    sizes = dict.fromkeys(("torque_mean", "flywheel_torque"), result["torque_rms"])
    sizes["power_mean"] = result["power_peak"]
    every = ("ec", "BC", "omega0", "m_rod", "I_rod", "F_Y", "fluctuation", "mu")
    for name in (n for n in every if isinstance(design.get(n, 0.0 if n == "fluctuation" else None), float)):
        base = {"fluctuation": 0.05, **design}
        step = 2e-4 * abs(base[name])
        near, far = (
            [dx.drive(**{**base, name: base[name] + side * k * step}) for side in (1, -1)] for k in (1, 2)
        )
        for figure, gradient in result["gradient"].items():
            if name not in gradient:
                assert name == "fluctuation"
                continue
            narrow, wide = (
                (one[figure] - two[figure]) / (2 * k * step) for k, (one, two) in ((1, near), (2, far))
            )
            assert gradient[name] == pytest.approx(
                (4 * narrow - wide) / 3,
                rel=1e-7,
                abs=1e-8 * sizes.get(figure, result[figure]) / abs(base[name]),
            ), (figure, name)


@pytest.mark.parametrize("mu", [0.0, 0.15])
def test_a_flywheel_is_less_by_what_the_crank_has(mu):
    """The crank turns about A: a flywheel may replace I_crank + m_crank r_crank^2, with the same torque."""
    crank = {"m_crank": 3.0, "r_crank": 0.02, "I_crank": 0.01}
    for omitted in ((), ("I_crank",)):
        design = {n: v for n, v in {**PRESS, **crank, "mu": mu, "g_Y": 0.0}.items() if n not in omitted}
        slopes = dx.drive(fluctuation=0.05, **design)["gradient"]
        expected = {"m_crank": -(0.02**2), "r_crank": -2.0 * 3.0 * 0.02, "I_crank": -1.0}
        for name in crank.keys() - {*omitted}:
            assert slopes["flywheel_inertia"][name] == pytest.approx(expected[name], rel=1e-9)
            assert slopes["flywheel_torque"][name] == pytest.approx(0.0, abs=1e-9)


JUMPING = {
    "over_stroke": dx.over_stroke([0.0, 0.008, 0.008], [-8e4, -8e4, 0.0], [0.0] * 3, dead_centre="outer"),
    "over_Y": dx.over_Y([0.28, 0.32, 0.34], [-9e2, -4e4, -2e3], [0.0] * 3, "step"),
}


@pytest.mark.parametrize(
    ("load", "omega0", "mu"),
    first(
        2,
        [
            ("over_stroke", 6.28, 0.0), ("over_Y", -6.28, 0.08), ("over_stroke", -6.28, 0.08),
            ("over_Y", 6.28, 0.0), ("over_stroke", 6.28, 0.08), ("over_stroke", -6.28, 0.0),
            ("over_Y", 6.28, 0.08), ("over_Y", -6.28, 0.0),
        ],
    ),
)  # fmt: skip
def test_gradients_where_a_jump_of_a_load_moves(load, omega0, mu):
    """The jump moves with the lengths; the work of a constant force over the last 8 mm does not."""
    design = {"AB": 0.06, "BC": 0.3, "ec": 0.015, "m_slider": 120.0, "omega0": omega0, "mu": mu}
    call = {**design, "F_Y": JUMPING[load], "fluctuation": 0.1}
    result = dx.drive(**call)
    if not mu:
        assert result["flywheel_torque"] == pytest.approx(result["torque_mean"], rel=1e-12)
        if load == "over_stroke":
            assert result["work_in"] - result["work_out"] == pytest.approx(8e4 * 0.008, rel=1e-12)
            assert abs(result["gradient"]["power_mean"]["AB"]) < 1e-8
    way, step = {"AB": 1.0, "ec": -0.7, "BC": 1.6}, 2e-6  # one direction, in which every length counts
    ends = [
        dx.drive(**{**call, **{name: design[name] + k * step * by for name, by in way.items()}})
        for k in (-2, -1, 1, 2)
    ]
    for figure in ("torque_mean", "torque_rms", "work_in", "work_out", "power_mean", "flywheel_inertia",
                   "flywheel_torque"):  # fmt: skip
        far, near, after, last = (end[figure] for end in ends)
        slope = (8.0 * (after - near) - (last - far)) / (12.0 * step)
        small = 1e-6 * abs(result[figure]) / design["ec"]
        along = sum(by * result["gradient"][figure][name] for name, by in way.items())
        assert along == pytest.approx(slope, rel=1e-6, abs=small), figure


OVER_SPEED = [
    {"F_Y": dx.damper(linear=200.0)},
    {"F_Y": dx.damper(quadratic=200.0), "m_slider": 0.0, "m_rod": 0.0, "I_rod": 0.0},
    {"F_Y": dx.over_V([-2.0, -0.5, 0.5, 2.0], [900.0, 400.0, -400.0, -900.0]), "mu": 0.15},
    {"F_Y": lambda omega, V_C: -10.0 * omega - 100.0 * V_C},
]


@pytest.mark.parametrize("changes", [{"mu": 0.0}, {"mu": 0.15}, *OVER_SPEED])
@pytest.mark.parametrize("fluctuation", [0.03, 0.3])
def test_a_simulated_turn_with_the_flywheel(changes, fluctuation):
    """Under the constant torque the motion repeats itself, and its speed fluctuates as wanted."""
    design = {**PRESS, **changes}
    result = dx.drive(fluctuation=fluctuation, **design)
    start = float(result.course["speed"][0])
    theta0 = float(result.course["theta_of_speed"][0])
    bodies = {n: v for n, v in design.items() if n != "omega0"} | {"I_crank": result["flywheel_inertia"]}
    motion = dx.simulate(
        torque=result["flywheel_torque"], t_end=1.0, theta0=theta0, omega_start=start,
        until=theta0 + 2 * math.pi, rtol=1e-12, times=np.linspace(0, 2 * result["period"], 4001), **bodies,
    )  # fmt: skip
    end = next(event for event in motion["events"] if event.kind == "angle")
    assert end.omega == pytest.approx(start, rel=1e-8)
    slow, fast = motion["omega"].min(), motion["omega"].max()
    assert (fast - slow) / 40.0 == pytest.approx(fluctuation, rel=2e-5)
    assert (fast + slow) / 2 == pytest.approx(40.0, rel=1e-6)


def test_loads_over_the_speed_by_quadrature_and_by_a_crankshaft():
    """A small fluctuation: the work of the damper at the mean speed, between its extremes."""
    damped = {"ec": 0.01, "AB": 0.04, "BC": 0.13, "omega0": 30.0, "F_Y": dx.damper(linear=200.0)}
    wheel = dx.drive(fluctuation=1e-6, **damped)
    theta = np.linspace(0.0, 2.0 * np.pi, 20_001)
    torque = 200.0 * 30.0 * dx.evaluate("Y_wrt_theta", theta=theta, ec=0.01, AB=0.04, BC=0.13) ** 2
    step = theta[1]
    mean = torque[:-1].mean()
    excess = np.cumsum(mean - 0.5 * (torque[1:] + torque[:-1])) * step
    assert wheel["flywheel_torque"] == pytest.approx(mean, rel=1e-5)
    assert wheel["flywheel_inertia"] == pytest.approx(np.ptp(excess) / (1e-6 * 30.0**2), rel=1e-5)
    shaft = dx.Crankshaft([dx.Machine(**{n: v for n, v in damped.items() if n != "omega0"})], phase=[0.0])
    assert shaft.drive(omega0=30.0, fluctuation=1e-6)["flywheel_inertia"] == pytest.approx(
        wheel["flywheel_inertia"], rel=1e-9
    )


def test_a_fluctuation_in_percent_and_a_crank_that_needs_no_flywheel():
    result = dx.drive(fluctuation=0.02, **PRESS)
    assert dx.drive(fluctuation="2 %", **PRESS) == result
    heavy = dx.drive(fluctuation=0.02, **PRESS, I_crank=100.0)
    assert heavy["flywheel_inertia"] == 0.0
    assert set(heavy["gradient"]["flywheel_inertia"].values()) == {0.0}


@pytest.mark.thorough
def test_starting_from_the_worst_standstill():
    """Loads, gravity and friction at a creep, in the way of turning; either way in reverse."""
    theta = np.linspace(0.0, 2.0 * np.pi, 200_001)
    ahead, back = (
        way * dx.evaluate("T_in", theta=theta, **{**RUBBING, "omega0": 1e-9 * way}) for way in (1, -1)
    )
    result = dx.drive(**RUBBING)
    assert result["starting_torque"] == pytest.approx(ahead.max(), rel=1e-8)
    assert result["theta_start"] == pytest.approx(theta[ahead.argmax()], abs=4e-5)
    assert dx.drive(**{**RUBBING, "omega0": -40.0})["starting_torque"] == pytest.approx(back.max(), rel=1e-8)
    both = dx.drive(reverse=True, **RUBBING)["starting_torque"]
    assert both == pytest.approx(max(ahead.max(), back.max()), rel=1e-8)
    assert dx.drive(ec=0, AB=0.1, BC=0.3, omega0=10.0, m_slider=1.0)["starting_torque"] == 0.0


def test_a_load_over_the_angle():
    """A step at 60 deg on the way in and out; its work by its mean over the stroke."""

    def force(theta):
        return np.where(np.cos(theta) > 0.5, -4000.0, -10.0)

    design = {"ec": 0.0, "AB": 0.1, "BC": 0.4, "omega0": 20.0}
    result = dx.drive(F_Y=force, **design)
    Y = dx.evaluate("Y", theta=np.array([0.0, math.pi / 3, math.pi]), ec=0.0, AB=0.1, BC=0.4)
    stroke = 4000.0 * (Y[0] - Y[1]) + 10.0 * (Y[1] - Y[2])
    assert result["work_in"] == pytest.approx(stroke, rel=1e-10)
    assert result["work_out"] == pytest.approx(stroke, rel=1e-10)


def test_status():
    lengths = {"omega0": 3.0, "m_slider": 1.0}
    stuck = dx.drive(ec=0.1, AB=0.2, BC=0.25, **lengths)
    assert stuck["status"] == 1
    assert math.isnan(stuck["torque_rms"])
    assert "cannot turn fully" in stuck.report()
    change = dx.drive(ec=0.125, AB=0.125, BC=0.25, **lengths)
    assert change["status"] == 2
    assert change["torque_rms"] > 0.0
    assert math.isnan(change["gradient"]["torque_rms"]["BC"])
    assert change["gradient"]["torque_rms"]["m_slider"] == pytest.approx(change["torque_rms"], rel=1e-12)
    assert dx.drive(ec=0, AB=0.1, BC=0.3, alpha=-10, **lengths)["status"] == 3
    jammed = dx.drive(ec=0, AB=0.1, BC=0.12, omega0=1.0, m_slider=1.0, F_Y=-300.0, F_X=100.0, mu=2.0)
    assert jammed["status"] == 5
    idle = dx.drive(ec=0, AB=0.1, BC=0.3, omega0=10.0)
    assert (idle["torque_peak"], idle["flywheel_inertia"], idle["status"]) == (0.0, 0.0, 0)


def test_report_and_plot():
    result = dx.drive(**RUBBING)
    report = result.report()
    for words in ("381.972 rpm", f"{result['torque_rms']:.6g} N m", "starting torque", "3 %"):
        assert words in report
    assert str(result) == report
    lines = result.plot()
    assert set(lines) == {"T_in", "mean", "peak", "speed"}
    assert lines["T_in"].get_ydata().max() <= result["torque_peak"]
    figure = lines["T_in"].figure
    assert figure.axes[-1].get_xlim() == (0.0, 360.0)
    alone = dx.plot.drive(result, ax=figure.axes[0])
    assert "speed" not in alone
    with pytest.raises(ValueError, match="status 1"):
        dx.drive(ec=0.1, AB=0.2, BC=0.25, omega0=3.0).plot()
