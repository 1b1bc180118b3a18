"""Engines and pumps: which orders balance, a torque from a pressure table, figures over the cycle."""

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.crankshaft.truth import TrueSlider, shaft
from tests.effort import first

CYLINDER = {
    "ec": 0.0, "AB": 0.045, "BC": 0.15, "m_crank": 1.1, "m_rod": 0.5, "m_slider": 0.4, "I_crank": 1e-3,
    "I_rod": 2e-3, "r_crank": 0.0, "r_rod": 0.05,
}  # fmt: skip
ONE = dx.Machine(**CYLINDER, omega0=200.0)
IN_LINE_SIX = [0, 120, 240, 240, 120, 0]
FORCES, COUPLES = ("F_inertia_X", "F_inertia_Y"), ("C_inertia_X", "C_inertia_Y")
# phase and bank [deg]; orders of forces, and of couples, that vanish
ENGINES = {
    "in-line four": ([0, 180, 180, 0], 0, (1, 3), (1, 2, 3, 4)),
    "straight six": (IN_LINE_SIX, 0, (1, 2, 3, 4, 5), (1, 2, 3, 4, 5, 6)),
    "boxer": ([0, 180], [0, 180], (1, 2, 3, 4), (0,)),
    "in-line three": ([0, 120, 240], 0, (1, 2, 3, 4, 5), (0, 3, 6)),
}


def engine(phase, bank=0, machine=ONE, **more):
    return dx.Crankshaft(machine.replace(units="deg"), phase=phase, bank=bank, **more)


@pytest.mark.parametrize("name", ENGINES)
def test_orders_that_vanish_are_0(name):
    phase, bank, forces, couples = ENGINES[name]
    shaft_ = engine(phase, bank, spacing=0.1)
    for names, orders in ((FORCES, forces), (COUPLES, couples)):
        for quantity in names:
            series = shaft_.harmonics(quantity, orders=6)
            assert not series["amplitude"][[*orders]].any(), quantity
            theta = np.linspace(0.0, 350.0, 36)
            own = shaft_.evaluate(quantity, theta=theta)
            waves = np.exp(1j * np.outer(np.arange(7), np.radians(theta)))
            back = (series["cos"] - 1j * series["sin"]) @ waves
            assert np.abs(back.real - own).max() <= 2.0 * series["remainder"] + 1e-9


def test_an_in_line_four_shakes_four_times_as_one_in_the_second_order():
    four, one = (m.harmonics("F_inertia_Y")["amplitude"] for m in (engine([0, 180, 180, 0]), ONE))
    assert four[2] == pytest.approx(4.0 * one[2], rel=1e-12)
    boxer = engine([0, 180], [0, 180], spacing=0.1)
    couple = boxer.harmonics("C_inertia_Y")["amplitude"][1]
    assert couple == pytest.approx(0.1 * one[1], rel=1e-12)


def test_the_first_order_of_a_V_twin_is_balanced_by_its_counterweight():
    """At 90 degrees the forces of reciprocating masses are one that turns with the crank."""
    result = engine([0, 0], [0, 90]).counterweight(radius=0.05)
    m_C = 0.4 + 0.5 * 0.05 / 0.15
    turning = 2 * (0.5 - 0.5 * 0.05 / 0.15) * 0.045  # the rods' share at the pin; the crank's centre is at A
    assert result["product"] == pytest.approx(m_C * 0.045 + turning, rel=1e-12)
    assert result["angle"] == pytest.approx(180.0, rel=1e-12)
    assert result["mass"] == pytest.approx(result["product"] / 0.05, rel=1e-15)
    assert result["after"]["largest"] <= 1e-12 * result["before"]["largest"]
    assert result["counter_rotating"]["product"] == 0.0
    for throw in result["throws"]:
        assert throw["product"] == pytest.approx(0.5 * m_C * 0.045 + turning / 2, rel=1e-12)


def test_shafts_at_twice_the_speed_balance_the_second_order_of_an_in_line_four():
    result = engine([0, 180, 180, 0]).counterweight()
    second = ONE.harmonics("F_inertia_Y")["amplitude"][2]
    for way in ("turning", "counter_rotating"):
        weight = result["second_order"][way]
        assert weight["product"] * 400.0**2 == pytest.approx(2.0 * second, rel=1e-12)
        assert weight["angle"] == pytest.approx(180.0, rel=1e-12)
    assert result["product"] == result["counter_rotating"]["product"] == 0.0


def test_the_flow_of_a_triple_pump_varies_by_1_minus_cos_30_degrees():
    dx.define("flow", "area*max(V_C, 0)", area="3e-3 m^2")
    try:
        pump = engine([0, 120, 240], machine=dx.Machine(ec=0.0, AB=0.03, BC=3e10, omega0=20.0))
        most, least = (pump.peak("flow", kind=kind) for kind in ("max", "min"))
        assert (most["value"] - least["value"]) / most["value"] == pytest.approx(
            1.0 - np.cos(np.pi / 6), rel=1e-11
        )
        assert most["value"] == pytest.approx(3e-3 * 0.03 * 20.0, rel=1e-12)
        each = pump.evaluate([f"flow[{k}]" for k in range(3)] + ["flow"], theta=70.0)
        assert each["flow"] == pytest.approx(sum(each[f"flow[{k}]"] for k in range(3)), rel=1e-15)
    finally:
        dx.undefine("flow")


ANGLES = [0, 15, 30, 60, 120, 180, 360, 540, 630, 690]  # degrees of a cycle, firing at 0
GAS = [-14e3, -21e3, -9e3, -3.2e3, -1.3e3, -400, 0, 120, -900, -6e3]
FIRING = [0, 480, 240, 600, 120, 360]
WEAK = 0.9  # of the gas of slider 1: half orders


def six():
    one = ONE.replace(units="deg")
    shares = (1.0, WEAK, 1.0, 1.0, 1.0, 1.0)
    gases = [one.over_theta(ANGLES, share * np.array(GAS), "linear", period=720) for share in shares]
    members = [one.replace(F_Y=gas) for gas in gases]
    return dx.Crankshaft(members, phase=IN_LINE_SIX, firing=FIRING, I_shaft=0.3)


def table(share, angle):
    """The gas force by a straight line between its points."""
    turn = float(mp.degrees(angle)) % 720.0
    return mpf(share) * mpf(float(np.interp(turn, [*ANGLES, 720], [*GAS, GAS[0]])))


def free_bodies(nodes):
    """The torque of each cylinder over its cycle, at nodes between the points of its table."""
    torque = {}
    for share in (1.0, WEAK):
        one = [TrueSlider(CYLINDER, 0, 0, 0, lambda t, share=share: table(share, t))]
        torque[share] = [float(shaft(one, theta, 200.0, 0.0)["T_in"]) for theta in nodes]
    return torque


@pytest.mark.thorough
def test_half_orders_of_a_six_from_its_pressure_table():
    edges = np.radians([*ANGLES, *range(240, 720, 60), 720])
    edges.sort()
    points, weights = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(edges)[:, None]
    nodes = (edges[:-1, None] + half * (points + 1.0)).ravel()
    weight = (half * weights).ravel() / (4.0 * np.pi)
    with mp.workdps(30):
        torque = free_bodies(nodes)
    order = np.arange(0, 13) / 2
    own = {
        share: (weight * values) @ np.exp(-1j * np.outer(nodes, order)) for share, values in torque.items()
    }
    late = [np.exp(-1j * order * np.radians(angle)) for angle in FIRING]
    total = sum(own[WEAK if k == 1 else 1.0] * shift for k, shift in enumerate(late))
    scale = np.where(order == 0, 1.0, 2.0)
    series = six().harmonics("T_in", orders=6)
    np.testing.assert_array_equal(series["order"], order)
    size = np.abs(own[1.0]).max()
    np.testing.assert_allclose(series["cos"], scale * total.real, atol=1e-11 * size)
    np.testing.assert_allclose(series["sin"], -scale * total.imag, atol=1e-11 * size)
    assert series["amplitude"][1] > 1e-3 * size  # a half order
    drive = six().drive()
    assert drive["torque_mean"] == pytest.approx(total[0].real, rel=1e-11)
    assert drive["period"] == pytest.approx(4.0 * np.pi / 200.0, rel=1e-14)


@pytest.mark.parametrize(
    ("parameter", "value"), [("AB", 0.045), ("phase[1]", 120.0), ("omega0", 200.0), ("m_slider", 0.4)]
)
def test_derivatives_of_figures_and_peaks(parameter, value):
    """Against differences of the figures; the firing moves with a phase."""
    engine_ = six()
    h = 1e-5 * value
    high, low = (engine_.replace(**{parameter: value + side * h}) for side in (1, -1))
    here, after, before = (one.drive() for one in (engine_, high, low))
    for name in ("torque_mean", "torque_rms", "work_in", "torque_peak", "flywheel_inertia"):
        slope = (after[name] - before[name]) / (2.0 * h)
        size = abs(here[name]) / value
        assert here["gradient"][name][parameter] == pytest.approx(slope, rel=2e-6, abs=2e-6 * size), name
    tops = [one.peak("T_in")["value"] for one in (high, low)]
    assert engine_.peak("T_in")["gradient"][parameter] == pytest.approx(
        (tops[0] - tops[1]) / (2.0 * h), rel=1e-6
    )


def test_peaks_are_those_of_samples():
    theta = np.linspace(0.0, 720.0, 200_001)
    for kind, pick in (("max", np.max), ("min", np.min)):
        sampled = pick(six().evaluate("T_in", theta=theta))
        assert six().peak("T_in", kind=kind)["value"] == pytest.approx(sampled, rel=1e-7)
    both = six().peak("M_eff", AB=[0.045, 0.05])
    assert both["value"].shape == (2,)
    assert both["value"][1] == pytest.approx(six().peak("M_eff", AB=0.05)["value"], rel=1e-14)


def test_a_slope_of_what_cancels_is_0():
    """The first order of three cranks cancels, and so all of r_crank; the sixth of their rods does not."""
    three = engine([0, 120, 240], machine=ONE.replace(r_crank=0.01))
    gradient = three.peak("F_inertia_Y")["gradient"]
    assert gradient["m_crank"] == gradient["r_crank"] == 0.0
    assert gradient["m_slider"] > 0.0


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["absmax", "max", "min"])
def test_a_peak_of_what_cancels_is_0(kind):
    four = engine([0, 180, 180, 0])
    many = four.peak("F_shaking_X", kind=kind, AB=[0.04, 0.045])
    for answer in (four.peak("F_shaking_X", kind=kind), {n: many[n] for n in ("value", "gradient")}):
        assert not np.any(answer["value"])
        assert not np.any([answer["gradient"][p] for p in ("AB", "BC", "m_rod", "omega0")])
    near, one = (m.peak("F_shaking_X") for m in (four.replace(**{"phase[1]": 180 + 1e-7}), ONE))
    assert near["value"] == pytest.approx(np.radians(1e-7) * one["value"], rel=0.2)  # which does not


LENGTHS, POSITIONS = {"ec": 4.0, "AB": 45.0, "BC": 150.0}, [100, 150, 200]  # mm
WAYS = {  # force on the way out and in, at the same positions
    "pushed in": ([0, 0, 0], [-300, -300, -300]),
    "both ways": ([-100, -200, -300], [-50, -20, -10]),
}


def standing(theta, out, back):
    """The torque that holds a slider without mass against its force and the friction of the way, T > 0."""
    ec, AB, BC = LENGTHS.values()
    psi = np.arcsin((ec + AB * np.sin(theta)) / BC)
    Y = AB * np.cos(theta) + BC * np.cos(psi)
    way = np.sign(-np.sin(theta + psi))  # outward 1
    F = np.where(way > 0.0, np.interp(Y, POSITIONS, out), np.interp(Y, POSITIONS, back))
    rod = -F / (np.cos(psi) + np.sign(F) * 0.1 * np.abs(np.sin(psi)) * way)
    return -1e-3 * AB * rod * np.sin(theta + psi)


@pytest.mark.thorough
@pytest.mark.parametrize("loads", first(1, WAYS))
def test_a_drive_under_loads_that_differ_by_the_way(loads, tmp_path):
    """Starting torque by free bodies at rest, the torque by single machines that are shifted."""
    out, back = WAYS[loads]
    one = dx.Machine(**LENGTHS, mu=0.1, omega0=3000, m_slider=0.4, units="mm, deg, rpm, N, kg")
    one = one.replace(F_Y=one.over_Y(POSITIONS, outward=out, inward=back, kind="linear"))
    phases = [0, 120, 240]
    three = dx.Crankshaft(one, phase=phases)
    theta = np.arange(2.0, 360.0, 7.0)
    singles = sum(one.evaluate("T_in", theta=theta - phase) for phase in phases)
    np.testing.assert_allclose(three.evaluate("T_in", theta=theta), singles, rtol=1e-11)
    drive = three.drive()

    def total(angle):
        return sum(standing(angle - np.radians(phase), out, back) for phase in phases)

    start = np.radians(drive["theta_start"])
    assert total(start + np.array([-1e-11, 1e-11])).max() == pytest.approx(drive["starting_torque"], abs=1e-8)
    assert total(np.linspace(0.0, 2.0 * np.pi, 100_001)).max() <= drive["starting_torque"] + 1e-8
    if loads == "pushed in":
        high, low = (three.replace(AB=45 + h).drive()["starting_torque"] for h in (1e-4, -1e-4))
        slope = (high - low) / 2e-4
        assert drive["gradient"]["starting_torque"]["AB"] == pytest.approx(slope, rel=1e-5)
        assert f"{drive['starting_torque']:.6g}" in three.report(tmp_path / "three.md").read_text("utf-8")
