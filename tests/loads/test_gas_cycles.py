"""A compressor and a four-stroke engine by pressures in closed form, against free bodies at 50 digits."""

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx

MASSES = {"m_slider": 0.9, "m_rod": 0.6, "I_rod": 1e-3, "r_rod": 0.05}
LOW, HIGH, EXPONENT, AREA, CLEARANCE = 1e5, 6e5, 1.3, 2.8e-3, 0.004
TURN = 2.0 * np.pi


class Place:
    """Slider and rod of a design at a crank angle, from the loop closure."""

    def __init__(self, AB, BC, ec):
        self.AB, self.BC, self.ec = mpf(AB), mpf(BC), mpf(ec)

    def phi(self, theta):
        return mp.asin((self.ec + self.AB * mp.sin(theta)) / self.BC)

    def Y(self, theta):
        return self.AB * mp.cos(theta) + self.BC * mp.cos(self.phi(theta))

    def bodies(self, r_rod):
        """The coordinates of the masses."""
        share = mpf(r_rod) / self.BC
        rod_X = lambda t: (1 - share) * self.AB * mp.sin(t) - share * self.ec  # noqa: E731
        rod_Y = lambda t: (1 - share) * self.AB * mp.cos(t) + share * self.Y(t)  # noqa: E731
        return [("m_rod", rod_X), ("m_rod", rod_Y), ("I_rod", self.phi), ("m_slider", self.Y)]

    def torque(self, theta, omega, force):
        """Newton's law of all bodies, by virtual work."""
        theta = mpf(theta)
        rows = ((MASSES[m], mp.diff(x, theta), mp.diff(x, theta, 2)) for m, x in self.bodies(MASSES["r_rod"]))
        return mpf(omega) ** 2 * sum(m * v * a for m, v, a in rows) - force * mp.diff(self.Y, theta)


# ---- a compressor with clearance -----------------------------------------------------------------------

COMPRESSOR = {"ec": 0.004, "AB": 0.03, "BC": 0.12}
OUTER, INNER = (np.sqrt((0.12 + side * 0.03) ** 2 - 0.004**2) for side in (1, -1))
HEAD = OUTER + CLEARANCE


def gas(Y, V_C):
    """Compression outward, until the valve opens; what is left in the clearance expands inward."""
    squeezed = np.minimum(HIGH, LOW * ((HEAD - INNER) / (HEAD - Y)) ** EXPONENT)
    spread = np.maximum(LOW, HIGH * (CLEARANCE / (HEAD - Y)) ** EXPONENT)
    return -(np.where(V_C >= 0.0, squeezed, spread) - LOW) * AREA


def true_gas(Y, outward):
    high, low, n, head = (mpf(float(x)) for x in (HIGH, LOW, EXPONENT, HEAD))
    squeezed = min(high, low * ((head - mpf(float(INNER))) / (head - Y)) ** n)
    spread = max(low, high * (mpf(CLEARANCE) / (head - Y)) ** n)
    return -((squeezed if outward else spread) - low) * mpf(AREA)


@pytest.mark.parametrize("omega", [100.0, -100.0])
def test_the_torque_of_a_compressor(omega):
    place = Place(**COMPRESSOR)
    inputs = {**COMPRESSOR, **MASSES, "omega0": omega, "F_Y": gas}
    with mp.workdps(50):
        for theta in (0.4, 1.9, 2.9, 3.6, 4.4, 5.9):
            force = true_gas(place.Y(theta), mp.diff(place.Y, theta) * omega > 0)
            right = place.torque(theta, omega, force)
            assert dx.evaluate("T_in", theta=theta, **inputs) == pytest.approx(float(right), rel=1e-11)


def test_the_work_of_a_compressor_is_that_of_polytropes():
    drive = dx.drive(**COMPRESSOR, **MASSES, omega0=100.0, F_Y=gas)
    whole, ratio = AREA * (HEAD - INNER), HIGH / LOW
    drawn = whole - AREA * CLEARANCE * ratio ** (1.0 / EXPONENT)
    share = (EXPONENT - 1.0) / EXPONENT
    work = LOW * drawn * (ratio**share - 1.0) / share
    assert drive["work_in"] - drive["work_out"] == pytest.approx(work, rel=1e-8)
    assert drive["power_mean"] == pytest.approx(work * 100.0 / TURN, rel=1e-8)


# ---- a four-stroke engine ------------------------------------------------------------------------------

ENGINE = {"ec": 0.0, "AB": 0.04, "BC": 0.13}
FIRED = 3.5  # times the pressure at the end of the compression


def pressure(theta, lib=np, number=float):
    """Expansion from the fire at 0 to pi, both strokes at ambient pressure, compression from 3 pi to 4 pi."""
    angle = theta % (4 * lib.pi)
    AB, BC, top = (number(x) for x in (0.04, 0.13, CLEARANCE))
    rod = lib.sqrt(BC**2 - (AB * lib.sin(angle)) ** 2)
    gap = AB + BC + top - AB * lib.cos(angle) - rod
    n, low = number(EXPONENT), number(LOW)
    pressed = low * ((2 * AB + top) / gap) ** n
    return pressed * number(FIRED) if angle < lib.pi else pressed if angle >= 3 * lib.pi else low


FOUR_STROKE = dx.over_theta(pressure, nodes=[0.0, np.pi, 3 * np.pi], period="720 deg", area=AREA, ambient=LOW)


def true_torque(theta, omega, piece):
    """The torque at an angle of a quarter of the cycle."""
    inside = min(max(theta, mpf(piece) * mp.pi + mpf(10) ** -40), (mpf(piece) + 1) * mp.pi - mpf(10) ** -40)
    force = -(pressure(inside, mp, mpf) - mpf(LOW)) * mpf(AREA)
    return Place(**ENGINE).torque(theta, omega, force)


def test_the_torque_of_a_four_stroke_engine():
    with mp.workdps(50):
        for theta in (0.3, 2.2, 4.0, 7.5, 10.1, 12.3, -0.2, 13.0):
            right = true_torque(mpf(theta) % (4 * mp.pi), 200.0, int(theta % (4 * np.pi) / np.pi))
            result = dx.evaluate("T_in", theta=theta, omega0=200.0, F_Y=FOUR_STROKE, **ENGINE, **MASSES)
            assert result == pytest.approx(float(right), rel=1e-11)


def test_work_and_half_orders_of_a_four_stroke_engine():
    inputs = {**ENGINE, "omega0": 200.0, "F_Y": FOUR_STROKE}
    small, large = AREA * CLEARANCE, AREA * (0.08 + CLEARANCE)
    drop = small * (large / small) ** EXPONENT - large
    work = (FIRED - 1.0) * LOW * drop / (EXPONENT - 1.0)
    drive = dx.drive(**inputs, **MASSES)
    assert drive["work_out"] - drive["work_in"] == pytest.approx(work, rel=1e-10)
    assert drive["power_mean"] == pytest.approx(-work * 200.0 / (2.0 * TURN), rel=1e-10)
    series = dx.harmonics("T_in", orders=2, **inputs)
    assert series["order"].tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert series["mean"] == pytest.approx(-work / (2.0 * TURN), rel=1e-10)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    theta = (np.pi * (np.arange(4)[:, None] + 0.5 * (1.0 + nodes))).ravel()
    sin, cos = np.sin(theta), np.cos(theta)
    travel = -0.04 * sin - 0.04**2 * sin * cos / np.sqrt(0.13**2 - (0.04 * sin) ** 2)
    torque = AREA * (np.array(list(map(pressure, theta))) - LOW) * travel  # of the gas alone
    waves = np.exp(1j * np.outer(series["order"][1:], theta)) * np.tile(0.5 * np.pi * weights, 4)
    np.testing.assert_allclose(series["cos"][1:] + 1j * series["sin"][1:], waves @ torque / TURN, rtol=1e-8)
