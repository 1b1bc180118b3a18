"""Tolerances, optima and pictures of crankshafts."""

import json

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from tests.crankshaft.test_sums import CYLINDER, PUMP

ONE = dx.Machine(**CYLINDER | {"ec": 0.0}, omega0=200.0, units="deg")
THREE = dx.Crankshaft(ONE, phase=[0, 110, 250])


def test_a_tolerance_of_one_slider_and_of_a_phase():
    inexact = {
        "AB[1]": dx.plus_minus(0.045, 3e-4),
        "phase[2]": dx.plus_minus(250, 0.6),
        "m_slider": "0.4 +- 0.03",
    }
    slopes = {p: THREE.evaluate(f"T_in_wrt_{p}", theta=40) for p in inexact}
    expected = np.sqrt(sum((slopes[p] * s) ** 2 for p, s in zip(inexact, (1e-4, 0.2, 0.01), strict=True)))
    result = THREE.tolerance("T_in", theta=40, **inexact)
    assert result["first_order"]["std"] == pytest.approx(expected, rel=1e-12)
    assert abs(result["agreement"]["std"]) < 5.0
    peak = THREE.tolerance(("max", "T_in"), samples=200, **inexact)
    assert peak["gradient"]["AB[1]"] == pytest.approx(
        THREE.peak("T_in", kind="max", **{"AB[1]": 0.045})["gradient"]["AB[1]"]
    )
    assert abs(peak["agreement"]["std"]) < 6.0


def test_the_best_phase_for_a_torque_at_an_angle():
    over = {"phase[1]": (60, 170)}
    best = THREE.optimize(maximize=("at", "90 deg", "T_in"), over=over, starts=1)
    phases = np.linspace(60.0, 170.0, 11_001)
    torque = THREE.evaluate("T_in", theta=90, **{"phase[1]": phases})
    assert best["value"] == pytest.approx(torque.max(), rel=1e-8)
    assert best["phase[1]"] == pytest.approx(phases[torque.argmax()], abs=0.02)


def test_the_best_angles_and_the_longest_crank_of_sliders_that_differ():
    """At the largest inertia that the range has, slider 1 only just turns: AB[1] = BC - |ec|."""
    loco = dx.Crankshaft([ONE, dx.Machine(**PUMP, omega0=200.0, units="deg")], phase=[0, 90])
    best = loco.optimize(
        maximize=("at", "90 deg", "T_in"), over={"phase[1]": (60, 170), "bank[1]": (-20, 30)}, starts=1
    )
    phase, bank = np.meshgrid(np.linspace(60.0, 170.0, 301), np.linspace(-20.0, 30.0, 101))
    torque = loco.evaluate("T_in", theta=90, **{"phase[1]": phase, "bank[1]": bank})
    assert best["value"] == pytest.approx(torque.max(), rel=1e-5)
    assert best["value"] >= torque.max()
    longest = loco.optimize(maximize=("at", "90 deg", "M_eff"), over={"AB[1]": (0.03, 0.3)}, starts=1)
    assert longest["AB[1]"] == pytest.approx(0.15 - 0.01, rel=1e-9)
    inertia = loco.evaluate("M_eff", theta=90)
    result = loco.solve(over={"AB[1]": (0.01, 0.13)}, where={("at", "90 deg", "M_eff"): inertia})
    assert result["AB[1]"] == pytest.approx([0.03], rel=1e-9)


@pytest.mark.thorough
def test_the_best_phase_for_the_mean_square_of_a_torque():
    best = THREE.optimize(minimize=("rms", "T_in"), over={"phase[1]": (60, 170)}, starts=1)
    phases, theta = np.linspace(60.0, 170.0, 1101), np.arange(0.0, 360.0, 3.0)
    torque = THREE.evaluate("T_in", theta=theta, **{"phase[1]": phases[:, None]})
    rms = np.sqrt((torque**2).mean(axis=1))
    assert best["value"] == pytest.approx(rms.min(), rel=1e-6)
    other = 250.0 - best["phase[1]"]  # the mirror image has the same torque, the other way round
    assert min(abs(phases[rms.argmin()] - p) for p in (best["phase[1]"], other)) < 0.1
    assert best["value"] == pytest.approx(
        THREE.drive(**{"phase[1]": best["phase[1]"]})["torque_rms"], rel=1e-9
    )


def test_the_angles_at_which_a_torque_has_a_value():
    result = THREE.crossings("T_in", value=5.0)
    theta = np.linspace(0.0, 360.0, 7201)
    above = THREE.evaluate("T_in", theta=theta) > 5.0
    changes = np.flatnonzero(above[1:] != above[:-1])
    assert result["theta"] == pytest.approx(theta[changes] + 0.025, abs=0.026)
    assert (result["rising"] > 0.0).tolist() == above[changes + 1].tolist()
    assert THREE.evaluate("T_in", theta=result["theta"]) == pytest.approx(5.0, abs=1e-9)
    assert result["share"] == pytest.approx(above.mean(), abs=1e-2)
    for parameter, value in (("AB", 0.045), ("phase[1]", 110.0), ("m_slider[0]", 0.4)):
        ends = [
            THREE.crossings("T_in", value=5.0, **{parameter: value * (1 + side * 1e-6)})["theta"]
            for side in (1, -1)
        ]
        slope = (ends[0] - ends[1]) / (2e-6 * value)
        if "[" in parameter:
            result = THREE.crossings("T_in", value=5.0, **{parameter: value})
        assert result["gradient"][parameter] == pytest.approx(slope, rel=1e-5, abs=1e-6 * abs(slope).max())
    one, own = THREE.crossings("a_C[1]")["theta"], ONE.crossings("a_C")["theta"]
    assert np.sort(one) == pytest.approx(np.sort((own + 110.0) % 360.0))
    boxer = dx.Crankshaft(ONE, phase=[0, 180], bank=[0, 180])
    assert boxer.crossings("F_inertia_Y")["status"] == boxer.crossings("F_inertia_X")["status"] == 3


def test_the_phase_at_which_a_torque_has_a_value():
    rms = THREE.drive(**{"phase[1]": 120})["torque_rms"]
    result = THREE.solve(over={"phase[1]": (112, 135)}, where={("rms", "T_in"): rms})
    assert result["phase[1]"] == pytest.approx([120.0, 130.0], abs=1e-6)  # and its mirror image
    mass = THREE.solve(over={"m_slider": (0.2, 0.9)}, where={("max", "T_in"): 60.0})
    assert THREE.peak("T_in", kind="max", m_slider=mass["m_slider"][0])["value"] == pytest.approx(
        60.0, rel=1e-9
    )
    h, value = 1e-5, 0.045
    ends = [
        THREE.solve(over={"m_slider": (0.2, 0.9)}, where={("max", "T_in"): 60.0}, AB=value + side * h)[
            "m_slider"
        ]
        for side in (1, -1)
    ]
    assert mass["gradient"]["AB"][0] == pytest.approx((ends[0] - ends[1])[0] / (2.0 * h), rel=1e-4)
    with pytest.raises(TypeError, match="no input 'm_piston'"):
        THREE.solve(over={"m_slider": (0.2, 0.9)}, where={("max", "T_in"): 60.0}, m_piston=1.0)


def test_functions_without_derivatives_take_differences():
    def force(Y):
        return -2000.0 * (Y - 0.1) - 1e6 * (Y - 0.1) ** 3

    exact = dx.over_Y(force, derivative=lambda Y: -2000.0 - 3e6 * (Y - 0.1) ** 2)
    bare, known = (THREE.replace(F_Y=load) for load in (dx.over_Y(force), exact))
    for call in (
        lambda m: m.peak("T_in", AB=[0.044, 0.045]),
        lambda m: m.peak("T_in"),
        lambda m: m.crossings("T_in", value=5.0),
        lambda m: m.drive(),
    ):
        one, other = (call(machine)["gradient"] for machine in (bare, known))
        one, other = (result.get("torque_rms", result)["phase[1]"] for result in (one, other))
        np.testing.assert_allclose(one, other, rtol=1e-7)


def test_peaks_of_many_are_those_of_each():
    changes = {"AB": [0.044, 0.045], "phase[1]": [100.0, 120.0]}
    for kind in ("max", "min", "absmax"):
        many = THREE.peak("T_in", kind=kind, **changes)
        for k in range(2):
            one = THREE.peak("T_in", kind=kind, **{p: v[k] for p, v in changes.items()})
            assert many["value"][k] == pytest.approx(one["value"], rel=1e-12)
            for p, slope in one["gradient"].items():
                assert many["gradient"][p][k] == pytest.approx(slope, rel=1e-6, abs=1e-9), p


def test_pictures_of_each_slider_and_of_a_star():
    picture = THREE.plot.each("T_in", theta=np.arange(0.0, 361.0, 30.0))
    lines = [line.get_ydata() for line in picture.axes.get_lines()[-3:]]
    total = THREE.evaluate("T_in", theta=np.arange(0.0, 361.0, 30.0))
    np.testing.assert_allclose(np.sum(lines, axis=0), total, rtol=1e-12, atol=1e-12)
    star = THREE.replace(**{"phase[1]": 120, "phase[2]": 240}).plot.star("F_inertia_Y", order=1)
    assert len(star.artists) == 3
    assert star.axes.get_title(loc="left") == "F_inertia_Y, order 1; sum 0"
    spaced = dx.Crankshaft(ONE, phase=[0, 110, 250], bank=[0, 20, 0], spacing=0.1)
    couple = spaced.harmonics("C_inertia_Y")["amplitude"][1]
    assert f"sum {couple:.4g} N m" in spaced.plot.star("C_inertia_Y", order=1).axes.get_title(loc="left")
    with pytest.raises(ValueError, match=r"order = 0.5: there are \[0, 1\]"):
        THREE.plot.star("F_inertia_Y", order=0.5)


@pytest.mark.parametrize("name", ["F_inertia_X", "F_inertia_Y", "M_inertia", "T_in"])
@pytest.mark.parametrize("order", [1, 2])
def test_a_star_ends_at_the_harmonic_of_the_shaft(name, order):
    """Of a V at 90 degrees and of a boxer, whose axes differ, too."""
    for bank in ([-45, 45, 45], [0, 180, 90]):
        shaft = THREE.replace(**{f"bank[{k}]": b for k, b in enumerate(bank)})
        amplitude = shaft.harmonics(name, orders=2)["amplitude"]
        drawn = shaft.plot.star(name, order=order).axes.get_title(loc="left").rpartition("sum ")[2]
        size = max(shaft.only(k).harmonics(name, orders=2)["amplitude"][order] for k in range(3))
        assert float(drawn.split()[0]) == pytest.approx(amplitude[order], rel=1e-3, abs=1e-8 * size)
    lines = shaft.plot.each(name, theta=[0.0, 100.0, 200.0])[0].axes.lines
    np.testing.assert_allclose(lines[0].get_ydata(), sum(line.get_ydata() for line in lines[1:4]), atol=1e-9)


def test_the_report_has_the_figures_of_the_calls(tmp_path):
    page = THREE.report(tmp_path / "three.md", ["T_in"]).read_text(encoding="utf-8")
    drive, top, weight = THREE.drive(), THREE.peak("T_in"), THREE.counterweight()
    gradient = top["gradient"]["phase[1]"]
    for value in (drive["torque_rms"], drive["flywheel_inertia"], top["value"], gradient, weight["product"]):
        assert f"{value:.6g}" in page
    assert "| 1 | 110 |" in page
    with pytest.raises(TypeError, match="without tolerances"):
        THREE.report(tmp_path / "other.md", tolerances={"AB": 1e-4})


SCENE = """
[units]
length = "mm"
angle = "deg"

[mechanism]
AB = 45
BC = 150
ec = 4

[motion]
omega0 = "3000 rpm"

[masses]
m_slider = 0.4

[loads]
F_Y = -50

[crankshaft]
phase = [0, 120, 240]
bank = "30 deg"
spacing = 90
"""


def test_a_crankshaft_from_a_scene_file(tmp_path):
    file = tmp_path / "three.toml"
    file.write_text(SCENE, encoding="utf-8")
    one = dx.Machine(units="mm, deg", AB=45, BC=150, ec=4, omega0="3000 rpm", m_slider=0.4, F_Y=-50)
    assert dx.Crankshaft.read(file) == dx.Crankshaft(one, phase=[0, 120, 240], bank=30, spacing=90)
    assert dx.Crankshaft.read(file, units="m, rad")["sliders"].members[1].phase == pytest.approx(
        2 * np.pi / 3
    )
    for text, message in (
        (SCENE.partition("[crankshaft]")[0], r"no table \[crankshaft\]"),
        (SCENE.replace("phase =", "phases ="), "crankshaft.phases: unknown key; did you mean phase"),
        (SCENE.replace('"30 deg"', "[0, 90]"), r"bank: .* each of 3 sliders, got \(0, 90\) deg"),
        (SCENE.replace("phase = [0, 120, 240]", ""), "phase is missing"),
    ):
        file.write_text(text, encoding="utf-8")
        with pytest.raises((TypeError, ValueError), match=message):
            dx.Crankshaft.read(file)


STEADY = (
    "[steady]\ntorque = { kloss = { breakdown_torque = 40, breakdown_slip = 0.15, synchronous_speed = 150 } }"
)


def test_calls_of_a_crankshaft_on_the_command_line(tmp_path, capsys):
    file = tmp_path / "three.toml"
    file.write_text(SCENE + 'I_shaft = "0.1 kg m2"\n' + STEADY, encoding="utf-8")
    three = dx.Crankshaft.read(file)
    motor = three.kloss(40, 0.15, "150 rad/s")
    for words, key, answer in (
        ("drive", "torque_rms", three.drive()),
        ("peak T_in AB[1]=46", "value", three.peak("T_in", **{"AB[1]": 46})),
        ("harmonics F_shaking_Y orders=3", "amplitude", three.harmonics("F_shaking_Y", orders=3)),
        ("evaluate C_inertia_Y,a_C[2] theta=30", "C_inertia_Y", three.evaluate(["C_inertia_Y"], theta=30)),
        ("steady", "omega_mean", three.steady(torque=motor)),
    ):
        assert main([*words.split(), "--machine", str(file), "--json"]) == 0
        assert json.loads(capsys.readouterr().out)[key] == pytest.approx(np.array(answer[key]), rel=1e-12), (
            words
        )
    for words, message in (
        (["explore", str(file)], "crankshaft: this takes a slider by itself: leave [crankshaft] out"),
        (["events", "--machine", str(file)], "events is of one slider"),
    ):
        assert main(words) != 0
        assert message in capsys.readouterr().err
    assert main(["peak", "--help"]) == 0
    assert "sliders" not in capsys.readouterr().out


def closed(*texts):
    raise OSError("nobody reads the output")


def test_a_scene_file_of_a_crankshaft_runs(tmp_path, capsys, monkeypatch):
    """Its outputs over the angles of the file: the sum of what each slider gives by itself."""
    file, data = tmp_path / "three.toml", tmp_path / "three.csv"
    scene = SCENE.replace("[motion]", "[motion]\ntheta = [0, 45, 200]")
    file.write_text(f'{scene}[results]\ndata = "{data}"\n', encoding="utf-8")
    assert main(["run", str(file), "--report", str(tmp_path / "three.md")]) == 0
    out = capsys.readouterr().out
    assert "Crankshaft with 3 sliders" in out
    assert "I_shaft = 0 kg m^2" in out
    assert (tmp_path / "three.md").exists()
    rows = [line.split(",") for line in data.read_text().splitlines()[2:]]
    assert [float(row[0]) for row in rows] == [0.0, 45.0, 200.0]
    three = dx.Crankshaft.read(file)
    for theta, torque, *_ in rows:
        one = [
            m.evaluate("T_in", theta=f"{float(theta) - 120 * k - 30} deg")
            for k, m in enumerate(three.members)
        ]
        assert float(torque) == pytest.approx(sum(one), rel=1e-9, abs=1e-9)
    file.write_text(f'title = "Three in a row"\n{scene}', encoding="utf-8")
    monkeypatch.setattr("desaxe.cli.files.print", closed, raising=False)
    assert main(["run", str(file), "--report", str(tmp_path / "row.md")]) == 2
    assert (tmp_path / "row.md").read_text(encoding="utf-8").startswith("# Three in a row")
    file.write_text(f'{scene}[[peak]]\nquantity = "T_in"\n', encoding="utf-8")
    assert main(["run", str(file)]) == 2
    assert "peak: of one slider" in capsys.readouterr().err


def test_a_scene_file_of_a_crankshaft_on_a_motor(tmp_path, capsys):
    file, page = tmp_path / "three.toml", tmp_path / "three.md"
    text = f'title = "Three on a motor"\n{SCENE}I_shaft = "0.1 kg m2"\n{STEADY}'
    file.write_text(text, encoding="utf-8")
    three = dx.Crankshaft.read(file)
    steady = three.steady(torque=three.kloss(40, 0.15, "150 rad/s"))
    assert main(["scene", str(file)]) == 0
    assert "three.toml: OK (outputs: T_in" in capsys.readouterr().out
    assert main(["run", str(file), "--report", str(page)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("Three on a motor\n")
    assert "I_shaft = 0.1 kg m^2" in out
    rows = out.partition("Steady state\n")[2].split("\n\n")[0].splitlines()
    row = dict(zip(rows[-3].split(), rows[-1].split(), strict=True))
    for name in ("omega_mean", "fluctuation", "power_mean"):
        assert float(row[name]) == pytest.approx(steady[name], rel=1e-5)
    assert "## Steady state" in page.read_text(encoding="utf-8")
    file.write_text(f'outputs = ["M_piston"]\n{text}', encoding="utf-8")
    assert main(["scene", str(file)]) == 2
    assert "unknown quantity 'M_piston'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "phase = [0, 120, 240]",
            "phase = [0, 2.094, 4.189]",
            'phase = 4.189 deg, write phase = "4.189 rad"',
        ),
        ("spacing = 90", "spacing = 0.09", 'spacing = 0.09 mm, write spacing = "0.09 m"'),
        ("m_slider = 0.4", "m_slider = 400e3", 'm_slider = 400000 kg, write m_slider = "400000 g"'),
    ],
)
def test_slips_in_a_scene_file_of_a_crankshaft(old, new, words, tmp_path):
    file = tmp_path / "three.toml"
    file.write_text(SCENE.replace(old, new), encoding="utf-8")
    with pytest.warns(dx.UnitWarning, match=words):
        dx.Crankshaft.read(file)


def test_members_have_the_speed_of_a_shaft_that_keeps_it():
    turning = dx.Crankshaft(ONE.replace(omega0=120.0), phase=[0.0, 1.0])
    assert turning.members[1]["omega0"] == turning.replace(alpha=0.0).members[1]["omega0"] == 120.0
    assert "omega0" not in turning.replace(alpha=3.0).members[1]


def test_a_crankshaft_is_printed_with_its_speed():
    engine = dx.Crankshaft(ONE.replace(units="deg, rpm", omega0=3000), phase=[0, 180], I_shaft=0.2)
    text = "crankshaft of 2 sliders at 0, 180 deg, omega0 = 3000 rpm, I_shaft = 0.2 kg m^2; slider 0:"
    assert repr(engine).startswith(text)
    assert text in engine._repr_html_()
