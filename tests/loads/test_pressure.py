"""Pressures on a piston are forces, -(p - ambient) area: by every maker, of texts, files, functions."""

import math

import numpy as np
import pytest

import desaxe as dx

ENGINE = {"ec": 0.002, "AB": 0.04, "BC": 0.13, "omega0": 200.0, "m_slider": 0.5}
BORE, AMBIENT = 0.083, 1e5
AREA = math.pi * BORE**2 / 4.0
ANGLES = np.arange(0.0, 720.0, 10.0)


def pressure(theta):
    """The pressure in a four-stroke engine that fires at 370 degrees."""
    return AMBIENT + 4e6 * np.exp(-(((np.rad2deg(theta) - 370.0) / 30.0) ** 2))


def torque(theta, force):
    return dx.evaluate("T_in", theta=theta, F_Y=force, **ENGINE)


PRESSURES = pressure(np.deg2rad(ANGLES))
CYCLE = {"period": "720 deg"}


def from_a_file(tmp_path):
    rows = [f"{angle},{float(value) / 1e5!r}" for angle, value in zip(ANGLES, PRESSURES, strict=True)]
    path = tmp_path / "trace.csv"
    path.write_text("\n".join(["theta [deg],p [bar]", *rows]), encoding="utf-8")
    return dx.over_theta.read(path, bore="83 mm", ambient="1 bar", **CYCLE)


def from_a_plain_file(tmp_path):
    path = tmp_path / "plain.csv"
    rows = [f"{angle},{float(value) / 1e5!r}" for angle, value in zip(ANGLES, PRESSURES, strict=True)]
    path.write_text("\n".join(["a,b", *rows]), encoding="utf-8")
    return dx.over_theta.read(path, theta="deg", value="bar", area=AREA, ambient=AMBIENT, **CYCLE)


UNITS = "mm, deg, rpm, bar"
LOADS = {
    "numbers": lambda _: dx.over_theta(np.deg2rad(ANGLES), PRESSURES, bore=BORE, ambient=AMBIENT, **CYCLE),
    "texts": lambda _: dx.over_theta(
        [f"{angle} deg" for angle in ANGLES],
        [f"{float(value) / 1e5!r} bar" for value in PRESSURES],
        area=f"{AREA * 1e4!r} cm2",
        ambient="0.1 MPa",
        **CYCLE,
    ),
    "a file": from_a_file,
    "a plain file": from_a_plain_file,
    "the units of a machine": lambda _: dx.Machine(dx.Machine(ENGINE), units=UNITS).over_theta(
        ANGLES, PRESSURES / 1e5, bore=83, ambient=1, period=720
    ),
}


@pytest.mark.parametrize("kind", LOADS)
def test_a_trace_over_the_crank_angle(kind, tmp_path):
    load = LOADS[kind](tmp_path)
    theta = np.deg2rad(np.linspace(5.0, 715.0, 143))
    by_hand = dx.over_theta(np.deg2rad(ANGLES), -(PRESSURES - AMBIENT) * AREA, **CYCLE)
    np.testing.assert_allclose(torque(theta, load), torque(theta, by_hand), rtol=1e-11, atol=1e-9)
    node = np.deg2rad(370.0)
    assert torque(node, load) == pytest.approx(torque(node, -4e6 * AREA), rel=1e-12)
    mean = dx.drive(F_Y=load, **ENGINE)["torque_mean"]
    turn = (np.arange(7200) + 0.5) * 4.0 * np.pi / 7200
    assert mean == pytest.approx(np.mean(torque(turn, by_hand)), rel=1e-6)
    assert mean < 0.0  # it drives the crank


@pytest.mark.parametrize("in_units", [False, True])
def test_a_function_and_its_derivative(in_units):
    theta = np.deg2rad(np.linspace(300.0, 450.0, 31))

    def slope(angle):
        return -(pressure(angle) - AMBIENT) * 2.0 * (np.rad2deg(angle) - 370.0) / 30.0**2 * 180.0 / np.pi

    if in_units:
        machine = dx.Machine(dx.Machine(ENGINE), units=UNITS)
        load = machine.over_theta(
            lambda angle: pressure(np.deg2rad(angle)) / 1e5,
            derivative=lambda angle: slope(np.deg2rad(angle)) / 1e5 * np.pi / 180.0,
            period=720, bore=83, ambient=1,
        )  # fmt: skip
    else:
        load = dx.over_theta(pressure, derivative=slope, bore=BORE, ambient=AMBIENT, **CYCLE)
    force = -(pressure(theta) - AMBIENT) * AREA
    np.testing.assert_allclose(torque(theta, load), torque(theta, force), rtol=1e-12)
    found = dx.evaluate("T_in_wrt_theta", theta=theta, F_Y=load, **ENGINE)
    h = 1e-6
    ends = [torque(theta + s * h, -(pressure(theta + s * h) - AMBIENT) * AREA) for s in (1, -1)]
    np.testing.assert_allclose(found, (ends[0] - ends[1]) / (2 * h), rtol=1e-6, atol=1e-4)


def test_over_the_slider_s_place(tmp_path):
    theta = np.linspace(0.1, 6.2, 40)
    out, back = [AMBIENT, 9e5], [AMBIENT, 2e5]
    by_hand = [[-(p - AMBIENT) * AREA for p in way] for way in (out, back)]
    pairs = [
        (dx.over_Y([0.09, 0.17], out, back, bore=BORE, ambient=AMBIENT), dx.over_Y([0.09, 0.17], *by_hand)),
        (
            dx.over_stroke([0, 0.08], out, back, dead_centre="outer", area=AREA, ambient="1 bar"),
            dx.over_stroke([0, 0.08], *by_hand, dead_centre="outer"),
        ),
    ]
    path = tmp_path / "indicator.csv"
    path.write_text("Y [mm],out [bar],back [bar]\n90,1,1\n170,9,2\n", encoding="utf-8")
    pairs.append((dx.over_Y.read(path, bore="83 mm", ambient="1 bar"), pairs[0][1]))
    for load, force in pairs:
        np.testing.assert_allclose(torque(theta, load), torque(theta, force), rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: dx.over_theta([0, 1], ["1 bar", "2 bar"]),
            'a pressure needs .*area="54 cm2" or bore="83 mm"',
        ),
        (lambda: dx.over_Y([0, 1], ["1 bar", "2 bar"]), "over_Y: outward: a pressure needs"),
        (lambda: dx.over_Y([0, 1], [1, 2], bore=0.1, area=1), "area and bore both"),
        (lambda: dx.over_Y([0, 1], [1, 2], ambient=1e5), "ambient is a pressure, which needs area= or bore="),
        (lambda: dx.over_Y([0, 1], ["1 N", "2 N"], bore=0.1), "'1 N': it must be a quantity in Pa"),
        (lambda: dx.over_stroke([0, 1], [1, 2], bore=-1, dead_centre="outer"), "bore = -1: .*a length > 0"),
        (lambda: dx.over_Y([0, 1], [1, 2], area="5 mm"), "area = '5 mm'.*m.?2"),
    ],
)
def test_what_is_refused(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()


def test_a_file_of_pressures_needs_a_piston(tmp_path):
    path = tmp_path / "trace.csv"
    path.write_text("theta [deg],p [bar]\n0,1\n360,2\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"trace.csv: value: a pressure needs"):
        dx.over_theta.read(path, period="720 deg")
