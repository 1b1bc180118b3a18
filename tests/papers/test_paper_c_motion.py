"""Paper C's driven motions: end states to more than 20 digits, and what proves them.

By energy and a quadrature of time where the torque is constant, for the sinusoid by `motion_c.drive` in 600
steps, which gives the others to 23 digits, too.
"""

import math

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import motion_c as motion
from tests.papers.newton_euler_c import State
from tests.papers.paper_c import printed_sinusoid
from tests.papers.proofs import proves

DIGITS = 40
END_STATES = {  # theta in rad and omega in rad/s at t_end, from rest at theta = 0; torques in N mm
    ("listed", "250"): ("16.25207478536987175390701624", "17.67162285424095678715265256"),
    ("listed", "500"): ("32.02273553512032978149988532", "22.26084254801895974447372602"),
    ("listed", "sinusoid"): ("18.00544745927572635317085209", "15.16825515367741590441145599"),
    ("thin", "250"): ("14.46575323228637666634562134", "12.68574930596173662060065634"),
    ("thin", "500"): ("29.63993471224841312795403437", "21.19167149419049162713268120"),
    ("thin", "sinusoid"): ("16.45321826589247317996342477", "17.91980975023314671752558665"),
    ("bars", "250"): ("14.20807320229523459063545661", "10.23569204768671933304246190"),
    ("bars", "500"): ("29.09474976932627961392285181", "26.86907494159027327206568430"),
    ("bars", "sinusoid"): ("16.08627058006324953273720262", "21.70057600135986985274410919"),
}
INPUTS = ("ec", "AB", "BC", "m_crank", "m_rod", "m_slider", "I_crank", "I_rod", "r_crank", "r_rod")
CONSTANT = [key for key in END_STATES if key[1] != "sinusoid"]


@pytest.fixture(autouse=True)
def many_digits():
    with mp.workdps(DIGITS):
        yield


def moments_of_inertia(kind):
    """I_crank and I_rod about z, kg m2: as listed, of thin rods, of the steel bars with the listed masses."""
    if kind == "thin":
        return mpf("0.7637") * mpf("0.14") ** 2 / 12, mpf("1.559464") * mpf("0.31") ** 2 / 12
    listed, bars = ("80.6e-6", "166.8085e-6"), ("1758.8819486842615e-6", "14559.334820459452e-6")
    return tuple(map(mpf, {"listed": listed, "bars": bars}[kind]))


def mechanism(kind):
    """The report's links at theta = 0, at rest and free of forces: decimals as printed."""
    lengths = {"ec": mpf("0.06"), "AB": mpf("0.14"), "BC": mpf("0.31")}
    masses = {"m_crank": mpf("0.7637"), "m_rod": mpf("1.559464"), "m_slider": mpf("1.95025")}
    turning = dict(zip(("I_crank", "I_rod"), moments_of_inertia(kind), strict=True))
    centres = {"r_crank": mpf("0.07"), "r_rod": mpf("0.155")}
    return State(theta=mpf(0), omega=mpf(0), alpha=mpf(0), **lengths, **masses, **turning, **centres)


def t_end(torque):
    """The report's simulation time, s."""
    return mpf(2) if torque == "sinusoid" else mpf("2.25")


def sinusoid(t):
    """The printed torque in N m, 30t in radians."""
    return printed_sinusoid(t, mp.cos) / 1000


def pair(key):
    """A stored end state."""
    return tuple(map(mpf, END_STATES[key]))


@pytest.mark.parametrize("key", CONSTANT, ids="-".join)
def test_end_state_balances_energy(key):
    """Work of the torque = kinetic energy, to the last digit stored."""
    (theta, omega), torque = pair(key), mpf(key[1]) / 1000
    stored = motion.inertia(mechanism(key[0]), theta)[0] * omega**2 / 2
    assert abs(stored - torque * theta) < mpf(10) ** -24 * stored


@pytest.mark.parametrize("key", [("listed", "250"), ("bars", "sinusoid")], ids="-".join)
def test_stretch_leads_to_the_end_state(key):
    """Backwards from the end by collocation and forwards again by other steps: the state returns."""
    state, end, span = mechanism(key[0]), t_end(key[1]), mpf("0.02")
    torque = sinusoid if key[1] == "sinusoid" else lambda t: mpf(key[1]) / 1000
    before = motion.step(state, torque, end, -span / 4, pair(key), 30, 16)
    start = end - span / 4
    again = motion.step(state, torque, start, span / 8, before, 30, 16)
    again = motion.step(state, torque, start + span / 8, span / 8, again, 30, 16)
    assert max(abs(a - b) for a, b in zip(again, pair(key), strict=True)) < mpf(10) ** -22


def ends(kind, *torques):
    """Angle and speed at the end for some torques, rad and rad/s."""
    return [value for torque in torques for value in pair((kind, torque))]


@proves("C-motion-time", "given", says="250 500 2.25")
def test_inertias_decide_the_end_states():
    """Which moments of inertia the simulation had changes the first or second digit of the end states."""
    result = {kind: ends(kind, "250", "500") for kind in ("listed", "bars", "thin")}
    assert all(abs(a - b) > 0.08 * a for a, b in zip(result["listed"], result["bars"], strict=True))
    return result | {"time": t_end("250"), "torques": [mpf(250), mpf(500)]}


@proves("C-sinusoid-time", "given", says="2.0")
def test_sinusoid_ends_within_a_period():
    assert 9 < t_end("sinusoid") * 30 / (2 * mp.pi) < 10
    return {kind: ends(kind, "sinusoid") for kind in ("listed", "bars", "thin")} | {"time": t_end("sinusoid")}


@pytest.mark.parametrize("key", END_STATES, ids="-".join)
def test_simulated_end_state(key):
    """The package's motion from rest, in doubles, reaches the stored end state."""
    kind, torque = key
    links = {name: float(value) for name, value in mechanism(kind)._asdict().items() if name in INPUTS}
    drive = (
        (lambda t, theta, omega: 0.35 * (1 - math.cos(30 * t)))
        if torque == "sinusoid"
        else float(torque) / 1000
    )
    run = dx.simulate(
        torque=drive, t_end=float(t_end(torque)), theta0=0.0, omega_start=0.0, **links, rtol=1e-11
    )
    theta, omega = map(float, pair(key))
    assert run["theta"][-1] == pytest.approx(theta, abs=1e-7)
    assert run["omega"][-1] == pytest.approx(omega, abs=1e-7)
    assert abs(run["energy_residual"]) < 1e-9
