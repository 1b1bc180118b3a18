"""The content of a page; no browser is needed."""

import json
import math
import re

import pytest

import desaxe as dx
from desaxe.cli.command import main
from tests.example_scenes import COMPACTOR, FEEDER
from tests.scenes.explorer.browser import browser_path

SIZES = {"ec": 0.0, "AB": 0.125, "BC": 0.35, "omega0": 157.0}


def content_of(path):
    """The data that is embedded in a page."""
    text = path.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="content">(.*?)</script>', text, re.S)[1])


def test_only_what_a_page_needs_is_emitted(tmp_path):
    motion = content_of(dx.explore(path=tmp_path / "a.html", **SIZES))
    assert {"Y", "V_C", "a_C", "phi", "omega_BC"} <= set(motion["groups"])
    assert not {"T_in", "N_C"} & set(motion["groups"])
    assert motion["arguments"]["Y"] == ["theta", "ec", "AB", "BC"]
    loaded = content_of(dx.explore(path=tmp_path / "b.html", m_slider=1.0, **SIZES))
    assert {"T_in", "N_C"} <= set(loaded["groups"])
    assert "T_in_wrt_m_slider" in loaded["quantities"]
    few = content_of(dx.explore(path=tmp_path / "c.html", names=["s"], **SIZES))
    assert list(few["groups"]) == ["status", "a_C", "s", "Y"]  # of which Y is drawn


def test_a_page_stays_small(tmp_path):
    """Beside the plotting library."""
    from plotly.offline import get_plotlyjs

    path = dx.explore(FEEDER, tmp_path / "page.html")
    assert path.stat().st_size - len(get_plotlyjs().encode()) < 300_000


def test_a_scene_brings_its_designs_and_its_names(tmp_path):
    page = content_of(dx.explore(COMPACTOR, tmp_path / "a.html"))
    assert [design["ec"] for design in page["designs"]] == [0.0, 0.08, 0.15, 0.23]
    assert page["shown"][:2] == ["V_C", "a_C"]
    assert page["title"].startswith("Paper A")


def test_it_opens_on_forces_where_loads_are_given(tmp_path):
    def shown(**more):
        return content_of(dx.explore(path=tmp_path / "a.html", **{**SIZES, **more}))["shown"][:2]

    assert shown() == ["a_C", "a_C_wrt_ec"]
    assert shown(F_Y=-100.0) == shown(m_slider=1.0) == ["T_in", "N_C"]
    scene = {"outputs": ["V_C", "F_A_X"], "mechanism": {"ec": 0, "AB": 0.1, "BC": 0.3}, "loads": {"F_Y": -1}}
    scene["motion"] = {"omega0": 1, "theta": {"start": 0, "stop": "355 deg", "step": "5 deg"}}
    page = content_of(dx.explore(scene, tmp_path / "a.html"))
    assert page["shown"][:2] == ["F_A_X", "V_C"]
    assert page["theta"] == [0.0, 2.0 * math.pi]  # a turn without its last angle is a turn
    scene["outputs"] = ["V_C", "a_C"]
    assert content_of(dx.explore(scene, tmp_path / "a.html"))["shown"][:2] == ["T_in", "N_C"]
    scene["motion"]["theta"]["stop"] = "300 deg"
    assert content_of(dx.explore(scene, tmp_path / "a.html"))["theta"][1] == pytest.approx(
        300 * math.pi / 180
    )


def test_up_to_five_values_are_all_compared(tmp_path):
    five = [0.0, 0.05, 0.1, 0.15, 0.2]
    page = content_of(dx.explore(path=tmp_path / "a.html", **{**SIZES, "ec": five}))
    assert [design["ec"] for design in page["designs"]] == five
    assert page["left_out"] == ""


@pytest.mark.parametrize(
    ("ec", "rods", "message"),
    [
        ([0.0, 0.01, 0.02, 0.03, 0.04, 0.05], 0.35, "ec = 0.01, 0.04 m"),
        ([0.0, 0.1], [0.35, 0.4, 0.45], "BC = 0.4, 0.45 m"),
        ([0.01 * k for k in range(20)], [0.35, 0.4], "16 of the values of ec; BC = 0.4 m"),
    ],
)
def test_values_that_are_left_out_are_told(ec, rods, message, tmp_path, capsys):
    path = dx.explore(path=tmp_path / "a.html", **{**SIZES, "ec": ec, "BC": rods})
    assert content_of(path)["left_out"] == message
    scene = tmp_path / "a.toml"
    lengths = f"ec = {ec}\nAB = 0.125\nBC = {rods}"
    motion = "omega0 = 1\ntheta = [0, 1]"
    scene.write_text(f'outputs = ["V_C"]\n[mechanism]\n{lengths}\n[motion]\n{motion}\n', encoding="utf-8")
    assert main(["explore", str(scene), "-o", str(path)]) == 0
    out, err = capsys.readouterr()
    assert out == f"{path}\n"
    assert err == f"desaxe: not shown on the page: {message}\n"


def test_a_path_in_the_place_of_a_scene():
    with pytest.raises(TypeError, match=r"not both \(path='x.html' is the page to write\)"):
        dx.explore("x.html", **SIZES)
    with pytest.raises(TypeError, match=r"not both \(ec, AB, BC, omega0 beside a scene\)"):
        dx.explore("x.toml", **SIZES)


def test_a_title_is_text(tmp_path):
    nasty = "</script><script>alert(1)</script> & co"
    text = dx.explore(path=tmp_path / "a.html", title=nasty, **SIZES).read_text(encoding="utf-8")
    assert "<script>alert(1)" not in text
    assert content_of(tmp_path / "a.html")["title"] == nasty


def test_the_same_page_every_time(tmp_path):
    first, second = (dx.explore(path=tmp_path / name, **SIZES).read_bytes() for name in ("a.html", "b.html"))
    assert first == second


@pytest.mark.parametrize(
    ("inputs", "kind", "message"),
    [
        ({"AB": 1.0, "BC": 3.0, "omega0": 1.0}, TypeError, "ec is missing"),
        ({**SIZES, "BC": -1.0}, ValueError, "BC = -1.0: it must be a finite length > 0"),
        ({**SIZES, "mass": 1.0}, TypeError, "no input 'mass'"),
        ({**SIZES, "names": ["a_D"]}, ValueError, "unknown quantity 'a_D'"),
        ({**SIZES, "ec": []}, TypeError, "a list of numbers"),
        ({**SIZES, "source": {"outputs": ["V_C"]}}, TypeError, "a scene or inputs"),
        ({**SIZES, "omega": 1.0}, ValueError, "not both"),
    ],
)
def test_errors_name_the_culprit(inputs, kind, message, tmp_path):
    with pytest.raises(kind, match=re.escape(message)):
        dx.explore(path=tmp_path / "a.html", **inputs)
    assert not list(tmp_path.iterdir())


def test_the_command(tmp_path, capsys):
    target = tmp_path / "deep" / "page.html"
    assert main(["explore", str(COMPACTOR), "-o", str(target), "--names", "s,phi"]) == 0
    assert capsys.readouterr().out == f"{target}\n"
    assert {"s", "phi", "a_C"} <= set(content_of(target)["groups"])


@pytest.mark.parametrize(("ci", "outcome"), [("true", pytest.fail), ("", pytest.skip)])
def test_without_a_browser_the_tests_say_what_to_install(ci, outcome, monkeypatch):
    monkeypatch.setenv("DESAXE_BROWSER", "/nowhere/chromium")
    monkeypatch.setenv("CI", ci)
    with pytest.raises(outcome.Exception, match="playwright install chromium"):
        browser_path("/nowhere/else")


def test_the_units_of_a_page(tmp_path):
    """Those asked for, else those of [units]; fields are in the units that the texts are written in."""
    plain = content_of(dx.explore(path=tmp_path / "a.html", **SIZES))
    assert (plain["units"], plain["fields"]) == ({}, {})
    asked = content_of(dx.explore(path=tmp_path / "b.html", units={"length": "in", "a_C": "cm/s^2"}, **SIZES))
    assert asked["units"] == {"m": "in", "a_C": "cm/s^2"}
    assert asked["sizes"] == {"in": ["127", "5000"], "cm/s^2": ["1", "100"]}
    motion = {"theta": {"start": 0, "stop": "360 deg", "num": 5}, "omega0": "25 turn/s"}
    data = {"outputs": ["a_C"], "mechanism": {"AB": "5 in", "BC": "0.35 m", "ec": 0}, "motion": motion}
    written = content_of(dx.explore(data, tmp_path / "c.html"))
    assert written["units"] == {}
    assert (written["fields"]["m"], written["fields"]["rad/s"]) == ("in", "turn/s")
    named = content_of(dx.explore({**data, "units": "mm, rpm"}, tmp_path / "d.html"))
    assert named["units"] == {"m": "mm", "rad/s": "rpm"}
    with pytest.raises(ValueError, match="units"):
        dx.explore(path=tmp_path / "e.html", units="mmm", **SIZES)
