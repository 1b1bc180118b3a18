"""[steady] of a scene: the values of `desaxe.steady`, in the scene's units; what is wrong is named."""

import re
from math import pi

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from desaxe.scenes.scene import SceneError
from desaxe.scenes.written import toml

KLOSS = {"breakdown_torque": 40, "breakdown_slip": 0.15, "synchronous_speed": 1500, "gear": 12}
LOAD = {"over_Y": [[150, -4000, 3000], [200, -2000, 0], [250, 0, 0]]}
SCENE = {
    "units": "mm, rpm",
    "mechanism": {"AB": 50, "BC": [180, 200], "ec": 10},
    "masses": {"m_slider": 20, "I_crank": 2},
    "loads": {"F_Y": LOAD},
    "steady": {"torque": {"kloss": KLOSS}, "flywheel_inertia": [3, "5 kg m2"]},
}


def plain(**more):
    """The steady states of the machines of SCENE, by `desaxe.steady`."""
    motor = dx.kloss(40.0, 0.15, "1500 rpm", 12)
    load = dx.over_Y([0.15, 0.2, 0.25], [-4000, -2000, 0], [3000, 0, 0])
    lengths = {"AB": 0.05, "BC": np.array([[0.18], [0.2]]), "ec": 0.01}
    return dx.steady(torque=motor, m_slider=20, I_crank=2, F_Y=load, **lengths, **more)


def test_the_steady_states_of_a_scene_are_those_of_the_call():
    result = dx.scene(SCENE).run()
    found, known = result.steady.dataset, plain(flywheel_inertia=[3.0, 5.0])
    assert found["omega_mean"].dims == ("BC", "flywheel_inertia")
    assert found["omega_mean"].units == "rpm"
    assert found["BC"].values.tolist() == [180, 200]
    np.testing.assert_allclose(found["omega_mean"], known["omega_mean"] * 30 / pi, rtol=1e-13)
    for name in ("fluctuation", "power_mean", "work", "multiplier", "period"):
        np.testing.assert_allclose(found[name], known[name], rtol=1e-12)
    text = result.report()
    assert "Steady state\n  On <induction motor" in text
    assert f"{float(found['omega_mean'][1, 1]):.6g}" in text
    assert max(map(len, text.splitlines())) <= 100


def test_the_flywheel_for_a_fluctuation():
    expected = {"torque": {"kloss": KLOSS}, "fluctuation": [0.02]}
    scene = {
        **SCENE,
        "mechanism": {"AB": 50, "BC": 200, "ec": 10},
        "loads": {"F_Y": -900},
        "steady": expected,
    }
    result = dx.scene(scene).run().steady.dataset
    assert result["flywheel_inertia"].dims == ("fluctuation",)
    motor = dx.kloss(40.0, 0.15, "1500 rpm", 12)
    known = dx.steady(torque=motor, fluctuation=0.02, **dx.Machine(scene))
    assert float(result["flywheel_inertia"][0]) == pytest.approx(known["flywheel_inertia"], rel=1e-12)


def test_a_motor_of_points_and_a_number():
    points = {"over_omega": [[0, 300], ["90 rpm", 450], [110, -200]], "kind": "smooth"}
    one = {**SCENE, "mechanism": {"AB": 50, "BC": 200, "ec": 10}, "steady": {"torque": points}}
    result = dx.scene(one).run().steady
    motor = dx.over_omega([0, "90 rpm", "110 rpm"], [300, 450, -200], kind="smooth")
    known = dx.steady(torque=motor, **dx.Machine(one))
    assert result.found["omega_mean"] == pytest.approx(known["omega_mean"], rel=1e-12)
    weak = dx.scene({**one, "steady": {"torque": 3}}).run()
    assert weak.steady.dataset["status"] == 1
    assert "too weak" in weak.report()
    assert "On 3 N m." in weak.report()


def test_a_refusal_is_in_the_units_of_the_scene_whoever_runs_it(tmp_path, capsys):
    push = {"over_theta": [[0, 0], [100, -5], [400, 3]], "kind": "linear", "period": 500}
    scene = {**SCENE, "units": "mm, deg, rpm", "loads": {"F_Y": push}}
    with pytest.raises(ValueError, match="its period is 500 deg"):
        dx.scene(scene).run()
    (tmp_path / "press.toml").write_text(toml(scene))
    assert main(["run", str(tmp_path / "press.toml")]) == 2
    assert "its period is 500 deg" in capsys.readouterr().err
    with pytest.raises(ValueError, match="its period is 500 deg"):
        dx.Machine(scene).report(tmp_path / "a.md", "Y", theta=[0, 60], steady=scene["steady"])


def test_why_there_is_no_steady_state_is_in_the_units_of_the_scene():
    """A motor without torque above 900 rpm, as the load is in the mean."""
    motor = {"over_omega": [["0 rpm", 300], ["900 rpm", 0]]}
    result = dx.scene({**SCENE, "loads": {}, "steady": {"torque": motor}}).run()
    texts = " ".join(result.report().split()), " ".join(map(str, result.steady.found["message"]))
    in_rpm, in_si = (float(re.search(r"at (\S+) \S+, as at others", text)[1]) for text in texts)
    assert in_rpm == pytest.approx(in_si * 30 / pi, rel=1e-5)


def test_a_machine_writes_the_motor_into_its_scene(tmp_path):
    press = dx.Machine(units="mm, rpm", ec=10, AB=50, BC=200, m_slider=20.0, I_crank=2.0)
    for motor in (press.kloss(40, 0.15, 1500, 12), press.over_omega([0, 100, 130], [30, 45, -20], "smooth")):
        path = tmp_path / "press.toml"
        press.to_scene(path, outputs="Y", steady={"torque": motor, "flywheel_inertia": 3})
        again = dx.scene(path)
        assert (
            again.content.of("steady")[0].torque
            == motor
            == press.scene("Y", steady={"torque": motor}).content.of("steady")[0].torque
        )
        result = again.run().steady.found
        own = press.steady(torque=motor, flywheel_inertia=3)["omega_mean"]
        assert result["omega_mean"] * 30 / pi == pytest.approx(own, rel=1e-12)


def test_a_motor_is_read_from_a_file_as_loads_are_and_swept_into_a_store(tmp_path, monkeypatch):
    import xarray

    rows = "0, 300\n90, 450\n110, -200\n"
    (tmp_path / "bare.csv").write_text(rows)
    (tmp_path / "heading.csv").write_text("speed [rpm]; torque [N m]\n" + rows.replace(",", ";"))
    known = dx.over_omega([0, "90 rpm", "110 rpm"], [300, 450, -200], "smooth")
    assert dx.over_omega.read(tmp_path / "bare.csv", "rpm", "N m", "smooth") == known
    assert dx.over_omega.read(tmp_path / "heading.csv", kind="smooth") == known
    assert dx.Machine(units="mm, rpm").over_omega.read(tmp_path / "bare.csv", kind="smooth") == known
    scene = tmp_path / "press.toml"
    text = (
        'units = "mm, rpm"\n[mechanism]\nAB = 50\nBC = [180, 200]\nec = 10\n'
        "[masses]\nm_slider = 20\nI_crank = 2\n"
        '[loads]\nF_Y = -900\n[results]\ndata = "press.zarr"\n[steady]\nflywheel_inertia = [3, 5]\ntorque = '
    )
    monkeypatch.chdir(tmp_path)
    for form in ('over_omega = "heading.csv"', 'over_omega = "bare.csv", omega = "rpm", torque = "N m"'):
        scene.write_text(text + "{" + form + ', kind = "smooth"}\n')
        result = dx.scene(scene).run().steady
        assert result.asked.torque == known
        back = xarray.open_zarr("press.zarr", group="steady")
        assert back["omega_mean"].dims == ("steady_BC", "steady_flywheel_inertia")
        np.testing.assert_array_equal(back["omega_mean"], result.dataset["omega_mean"])


@pytest.mark.parametrize(
    ("steady", "said"),
    [
        ({}, "steady.torque is missing"),
        ({"torque": "30 kg"}, "steady.torque"),
        ({"torque": {}}, "over_omega"),
        ({"torque": {"kloss": {**KLOSS, "gear": 0}}}, r"kloss: gear = 0"),
        ({"torque": {"kloss": {"gear": 2}}}, "breakdown_torque is missing"),
        ({"torque": {"kloss": KLOSS, "kind": "linear"}}, "kind"),
        ({"torque": {"over_omega": [[1, 2], [0, 3]]}}, "must ascend"),
        ({"torque": {"over_omega": "no.csv"}}, "no.csv.*No such file"),
        ({"torque": {"over_omega": [[1, 2], [3, 3]], "omega": "rpm"}}, "omega = .rpm.: .* beside points"),
        ({"torque": {"kloss": KLOSS, "torque": "N m"}}, "torque = .N m.: .* beside kloss"),
        ({"torque": 3, "flywheel_inertia": -1}, "flywheel_inertia = .*-1"),
        ({"torque": 3, "fluctuation": [0.1, 2.5]}, "fluctuation #2 = 2.5"),
        ({"torque": 3, "speed": 3}, "speed = 3: unknown key"),
    ],
)
def test_what_is_wrong_is_named(steady, said):
    with pytest.raises(SceneError, match=said):
        dx.scene({**SCENE, "steady": steady})


def test_speeds_of_the_motion_say_the_way_of_turning_alone():
    back = {**SCENE, "motion": {"omega0": [-50, -80]}, "steady": {"torque": -3}}
    assert dx.scene(back).content.of("steady")[0].fixed["omega0"] == -1.0
    with pytest.raises(SceneError, match="both ways"):
        dx.scene({**back, "motion": {"omega0": [-50, 80]}})
    with pytest.raises(SceneError, match="alpha"):
        dx.scene({**back, "motion": {"omega0": 50, "alpha": 3}})


@pytest.mark.parametrize("end", ["nc", "csv"])
def test_the_steady_states_are_written_beside_the_values(tmp_path, end):
    import xarray

    one = {**SCENE, "loads": {"F_Y": -900}, "results": {"data": str(tmp_path / f"press.{end}")}}
    result = dx.scene(one).run()
    assert "group steady" in result.report()
    (file,) = result.files
    if end == "nc":
        back = xarray.open_dataset(file, group="steady")
        np.testing.assert_array_equal(back["omega_mean"], result.steady.dataset["omega_mean"])
        assert back["omega_mean"].units == "rpm"
    else:
        assert "omega_mean [rpm]" in file.read_text()


def test_a_sweep_has_the_steady_states_in_its_store(tmp_path):
    import xarray

    place = str(tmp_path / "press.zarr")
    motion = {"theta": [0.0, 1.0, 2.0], "omega0": 100}
    scene = {**SCENE, "outputs": ["Y"], "motion": motion, "loads": {"F_Y": -900}, "results": {"store": place}}
    for _ in range(2):  # the second run finds its store
        result = dx.scene(scene).run()
        assert result.failures == ()
        back = xarray.open_zarr(place, group="steady")
        np.testing.assert_array_equal(back["omega_mean"], result.steady.dataset["omega_mean"])
        assert xarray.open_zarr(place)["Y"].shape == result.dataset["Y"].shape
    assert "group steady" in result.report()


def test_a_torque_over_the_angle_drives_the_machine_of_a_scene():
    """A damper takes the work of a turn: the mean of a linear table, which repeats, times 2 pi."""
    torque = dx.over_theta(["0 deg", "90 deg", "180 deg", "270 deg"], [3, 6, 3, 1], "linear")
    pump = dx.Machine(ec=0.0, AB=0.05, BC=0.2, m_slider=2, I_crank=0.5, F_Y=dx.damper(linear=30.0))
    result = pump.scene((), steady={"torque": torque}).run().steady.found
    assert result["status"] == 0
    assert result["work"] == pytest.approx(2 * np.pi * (3 + 6 + 3 + 1) / 4, rel=1e-9)


@pytest.mark.parametrize("place", ["loads.mu", "loads.F_Y"])
def test_a_motor_or_a_load_where_a_number_stands_is_refused(place):
    wrong = (
        dx.over_theta([0, 3], [3, 6], "linear") if place == "loads.mu" else dx.over_omega([0, 50], [20, 0])
    )
    scene = {"outputs": ["Y"], "mechanism": {"AB": 1, "BC": 3, "ec": 0}, "motion": {"theta": 1}}
    with pytest.raises(SceneError, match=f"{place} = .*: it must be "):
        dx.scene({**scene, "loads": {place.partition(".")[2]: wrong}})
