"""Pressures on a piston are forces, -(p - ambient) area: by every maker, of texts, files, functions."""

import math

import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.schema import SceneError
from desaxe.scenes.written import toml

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
    result = dx.evaluate("T_in_wrt_theta", theta=theta, F_Y=load, **ENGINE)
    h = 1e-6
    ends = [torque(theta + s * h, -(pressure(theta + s * h) - AMBIENT) * AREA) for s in (1, -1)]
    np.testing.assert_allclose(result, (ends[0] - ends[1]) / (2 * h), rtol=1e-6, atol=1e-4)


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
        (dx.over_V([-2, 1], out, bore=BORE, ambient=AMBIENT), dx.over_V([-2, 1], by_hand[0])),
    ]
    path = tmp_path / "indicator.csv"
    path.write_text("Y [mm],out [bar],back [bar]\n90,1,1\n170,9,2\n", encoding="utf-8")
    pairs.append((dx.over_Y.read(path, bore="83 mm", ambient="1 bar"), pairs[0][1]))
    for load, force in pairs:
        np.testing.assert_allclose(torque(theta, load), torque(theta, force), rtol=1e-11, atol=1e-9)


SCENE = {
    "units": "mm, deg, rpm, bar",
    "outputs": ["T_in"],
    "mechanism": {"ec": 2, "AB": 40, "BC": 130},
    "motion": {"theta": [20, 100, 250], "omega0": 900},
}


@pytest.mark.parametrize(
    ("table", "make"),
    [
        ({"over_Y": "indicator.csv"},
         lambda **piston: dx.over_Y([0.09, 0.17], [1e5, 9e5], [1e5, 2e5], **piston)),
        ({"over_Y": [[90, 1, 1], [170, 9, 2]]},
         lambda **piston: dx.over_Y([0.09, 0.17], [1e5, 9e5], [1e5, 2e5], **piston)),
        ({"over_stroke": [[0, 900], [80, 100]], "value": "kPa", "dead_centre": "outer"},
         lambda **piston: dx.over_stroke([0, 0.08], [9e5, 1e5], dead_centre="outer", **piston)),
        ({"over_theta": [[0, 1], [90, 9]], "kind": "linear"},
         lambda **piston: dx.over_theta([0, math.pi / 2], [1e5, 9e5], "linear", **piston)),
    ],
)  # fmt: skip
@pytest.mark.parametrize(
    ("piston", "size"),
    [
        ({"bore": "60 mm", "ambient": "1 bar"}, math.pi * 0.06**2 / 4.0),
        ({"bore": 60, "ambient": 1}, math.pi * 0.06**2 / 4.0),
        ({"area": "28 cm2", "ambient": "0.1 MPa"}, 28e-4),
    ],
)
def test_a_scene_reads_pressures(table, make, piston, size, tmp_path):
    (tmp_path / "indicator.csv").write_text("Y [mm],out [bar],back [bar]\n90,1,1\n170,9,2\n", "utf-8")
    path = tmp_path / "pump.toml"
    path.write_text(toml({**SCENE, "loads": {"F_Y": {**table, **piston}}}), "utf-8")
    result = dx.scene(path).run().dataset["T_in"]
    by_hand = make(area=size, ambient=1e5)
    design = {"ec": 0.002, "AB": 0.04, "BC": 0.13, "omega0": 30.0 * math.pi}
    expected = dx.evaluate("T_in", theta=np.radians([20.0, 100.0, 250.0]), F_Y=by_hand, **design)
    np.testing.assert_allclose(result, expected, rtol=1e-12)
    again = dx.scene(dx.Machine.read(path).to_scene(tmp_path / "forces.toml", outputs="T_in"))
    theta = np.array([1.0, 4.0])
    forces = [dx.evaluate("T_in", theta=theta, F_Y=load, **design) for load in (again.inputs["F_Y"], by_hand)]
    np.testing.assert_allclose(*forces, rtol=1e-12)


def pump(**piston):
    """A scene with a load of pressures."""
    return dx.scene({**SCENE, "loads": {"F_Y": {"over_Y": [[90, 1], [170, 9]], **piston}}})


def test_plain_pressures_of_a_file_are_not_taken_for_those_of_the_scene(tmp_path):
    path = tmp_path / "plain.csv"
    path.write_text("Y [mm],p\n90,1\n170,9\n", "utf-8")
    load = {"over_Y": str(path), "bore": 60}
    scene = {**SCENE, "loads": {"F_Y": load}}
    with pytest.raises(SceneError, match=r"its plain numbers would be in SI units.*value = .bar"):
        dx.scene(scene)
    assert dx.scene({**SCENE, "loads": {"F_Y": {**load, "value": "bar"}}}).inputs["F_Y"](0.17) < -2500.0
    plain = dx.over_Y(["90 mm", "170 mm"], [1e5, 9e5], bore="60 mm")
    with pytest.raises(ValueError, match=r'in bar: give machine.over_Y.*"... bar"'):
        dx.Machine(units="mm, bar", F_Y=plain)


@pytest.mark.parametrize(
    ("ambient", "units", "write"),
    [(1, "mm, deg", '"1 bar"'), (0.1, "mm", '"0.1 MPa"'), (101.3, "mm", '"101.3 kPa"'), (14.7, "mm", "psi"),
     (1, "mm, bar", None), ("1 Pa", "mm", None), (0, "mm", None), (1e5, "mm", None)],
)  # fmt: skip
def test_an_ambient_pressure_far_below_the_others_is_a_slip(ambient, units, write, tmp_path):
    path = tmp_path / "indicator.csv"
    path.write_text("Y [mm],out [bar]\n90,1\n170,9\n", "utf-8")
    machine = dx.Machine(units=units)
    if write is None:
        machine.over_Y.read(path, bore="60 mm", ambient=ambient)
        return
    with pytest.warns(dx.UnitWarning, match=f"ambient = .* Pa beside pressures up to 900000 Pa.*{write}"):
        machine.over_Y.read(path, bore="60 mm", ambient=ambient)
    with pytest.warns(dx.UnitWarning, match="ambient"):
        machine.over_Y([0.1, 0.2], ["1 bar", "9 bar"], bore="60 mm", ambient=ambient)


MM, SI_UNITS = dx.Machine(units="mm, deg, rpm"), dx.Machine(units="m")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: MM.over_Y([120, 200], [1, 7], [7, 1], bore=90, ambient="1 bar"), 'up to 7 Pa.*"7 bar"'),
        (lambda: MM.over_stroke([0, 9], [100, 100], bore=80, dead_centre="outer"), "up to 100 Pa, surely"),
        (
            lambda: MM.over_Y([120, 200], ["1 bar", "7 bar"], bore=0.09),
            'bore = 0.09 mm, write bore = "0.09 m"',
        ),
        (lambda: MM.over_Y([120, 200], [1e5, 7e5], bore=90000), "a slip: bore = 90000 mm$"),
        (lambda: dx.over_Y([0.12, 0.2], [1e5, 7e5], bore=90), 'bore = 90 m, write bore = "90 mm"'),
        (lambda: dx.over_Y([0.12, 0.2], [1e5, 7e5], area=5400), 'area = 5400 m.2, write area = "5400 mm.2"'),
        (lambda: MM.over_Y([120, 200], ["1 Pa", "7 Pa"], bore="0.09 mm", ambient="1 bar"), None),
        (lambda: MM.over_Y([120, 200], [1e5, 9e5], [0, 200], bore=90, ambient="1 bar"), None),
        (lambda: SI_UNITS.over_Y([0.12, 0.2], [1e5, 9e5], bore=1e-4), None),
    ],
)
def test_pressures_and_pistons_of_impossible_size_are_slips(make, message):
    if message is None:
        make()  # warnings are errors
        return
    with pytest.warns(dx.UnitWarning, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: dx.over_theta([0, 1], ["1 bar", "2 bar"]),
            'a pressure needs .*area="54 cm2" or bore="83 mm"',
        ),
        (lambda: dx.over_Y([0, 1], ["1 bar", "2 bar"]), "over_Y: outward: a pressure needs"),
        (lambda: dx.over_Y([0, 1], [1, 2], bore=0.1, area=1), "area and bore both"),
        (lambda: pump(ambient=1), "loads.F_Y: over_Y: ambient is a pressure, which needs area= or bore="),
        (lambda: pump(bore=-6), "loads.F_Y: bore = -0.006: .* a length > 0"),
        (lambda: pump(bore="6 bar"), r"loads.F_Y: bore = '6 bar'"),
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
    with pytest.raises(ValueError, match=r"trace.csv: over_theta: values: a pressure needs"):
        dx.over_theta.read(path, period="720 deg")
