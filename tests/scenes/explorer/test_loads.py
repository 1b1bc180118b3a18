"""A page under a load over theta: its numbers, and the scene that it saves."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import desaxe as dx
from tests.effort import first

PRESS = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "omega0": 200.0, "m_slider": 0.8}
ANGLES, FORCES = [0.3, 1.0, 2.5, 4.0], [0.0, -400.0, -50.0, 20.0]
VALUES = """(points) => points.map(([theta, added]) => ["T_in", "T_in_wrt_theta", "N_C"].map(
  (name) => window.desaxe.valueAt(name, { ...window.desaxe.state.designs[0], F_Y: added }, theta)))"""


@pytest.mark.parametrize("kind", first(1, ["cubic", "step"]))
def test_the_page_has_the_numbers_of_evaluate_and_saves_the_load(kind, visit, folder):
    load = dx.over_theta(ANGLES, FORCES, kind=kind)
    page = visit(dx.explore(path=folder / f"{kind}.html", F_Y=load, **PRESS))
    points = [[0.3, 0.0], [1.7, 0.0], [-2.0, 30.0], [9.0, 0.0]]
    for (theta, added), result in zip(points, page.evaluate(VALUES, points), strict=True):
        names = ["T_in", "T_in_wrt_theta", "N_C"]
        under = dx.over_theta(ANGLES, np.array(FORCES) + added, kind=kind)
        right = dx.evaluate(names, theta=theta, F_Y=under, **PRESS)
        for value, name in zip(result, names, strict=True):
            assert math.isclose(value, right[name], rel_tol=1e-11, abs_tol=1e-9)
    saved = dx.scene(tomllib.loads(page.evaluate("window.desaxe.sceneText()")))
    assert saved.inputs["F_Y"] == load


@pytest.mark.thorough
def test_the_working_stroke_of_a_press_is_in_the_picture(visit, folder):
    die = dx.over_stroke([0.0, 0.008, 0.008], [-4e5, -4e5, 0.0], [0.0] * 3, dead_centre="outer")
    press = {"AB": 0.06, "BC": 0.3, "ec": 0.015, "m_slider": 1.0, "omega0": 1.0, "F_Y": die}
    page = visit(dx.explore(names=["T_in", "V_C"], path=folder / "press.html", **press))
    curve = page.evaluate("desaxe.curve('T_in', desaxe.state.designs[0]).value")
    shown = page.evaluate("document.getElementById('plot-0').layout.yaxis")
    assert shown["autorange"] or shown["range"][1] > max(curve)
    assert page.inner_text("#note-0") == ""


NAMES = ["T_in", "T_in_wrt_theta", "T_in_wrt_ec", "T_in_wrt_BC", "N_C", "status"]
UNDER = """(points) => points.map(([theta, added, ec, omega0]) => NAMES.map((name) => window.desaxe.valueAt(
  name, { ...window.desaxe.state.designs[0], F_Y: added, ec, omega0 }, theta)))""".replace(
    "NAMES", str(NAMES)
)
PLACES, OUTWARD, INWARD = [0.0, 0.02, 0.035, 0.06], [-900.0, -300.0, -80.0, 20.0], [10.0, -70.0, 30.0, 0.0]
SLIDER = {
    "over Y": lambda out, back: dx.over_Y([0.04 + x for x in PLACES], out, back),
    "over Y, one way, cubic": lambda out, back: dx.over_Y([0.02 + x for x in PLACES], out, kind="cubic"),
    "a jump from the outer": lambda out, back: dx.over_stroke(
        [0.0, 0.02, 0.02, 0.06], out, back, dead_centre="outer"
    ),
    "from the inner": lambda out, back: dx.over_stroke(PLACES, out, back, "step", dead_centre="inner"),
}


@pytest.mark.parametrize("kind", first(2, dict.fromkeys(["from the inner", "over Y", *SLIDER])))
def test_a_load_that_follows_the_slider(kind, numbers_of, folder):
    """Values and total derivatives, either way; a design without the dead centre; the scene in mm."""
    load = SLIDER[kind](OUTWARD, INWARD)
    draw = np.random.default_rng(31)
    path = folder / f"slider_{list(SLIDER).index(kind)}.html"
    page = numbers_of(dx.explore(path=path, F_Y=load, units="mm, deg, rpm, kN", **PRESS))
    points = [
        [draw.uniform(-7, 7), 0.0, draw.uniform(-0.02, 0.02), draw.choice([-50.0, 50.0])] for _ in range(40)
    ]
    points += [[1.0, 30.0, 0.01, 200.0], [0.3, 0.0, 0.03, 50.0]]  # the last has no inner dead centre
    for (theta, added, ec, omega0), result in zip(points, page.evaluate(UNDER, points), strict=True):
        under = SLIDER[kind]([v + added for v in OUTWARD], [v + added for v in INWARD])
        right = dx.evaluate(NAMES, theta=theta, F_Y=under, **{**PRESS, "ec": ec, "omega0": omega0})
        for value, name in zip(result, NAMES, strict=True):
            shown = math.nan if value is None else value
            assert shown == pytest.approx(right[name], rel=1e-10, abs=1e-8, nan_ok=True), (theta, ec, name)
    lacks = page.evaluate("window.desaxe.statusWords({ ...window.desaxe.state.designs[0], ec: 0.03 }, 0.3)")
    assert ("lacks the dead centre" in lacks) == (kind == "from the inner")
    assert "over" in page.evaluate("document.getElementById('loads-words').textContent")
    saved = dx.scene(tomllib.loads(page.evaluate("window.desaxe.sceneText()")))
    assert replace(saved.inputs["F_Y"], unit=None) == load


SPRING, DAMPER = dx.spring(4e3, 0.05), dx.damper(30.0, 4.0)
ELEMENTS = {
    "spring": SPRING,
    "damper": DAMPER,
    "over_V": dx.over_V([-3.0, 0.0, 5.0], [40.0, 0.0, -90.0]),
    "sum": 2.5 * SPRING - DAMPER + dx.over_theta(ANGLES, FORCES) - 20.0,
}


@pytest.mark.parametrize("kind", first(1, ["sum", "spring", "damper", "over_V"]))
def test_springs_dampers_and_sums(kind, visit, folder):
    """Values and total derivatives; a constant that is added; the scene in mm."""
    page = visit(dx.explore(path=folder / f"{kind}.html", F_Y=ELEMENTS[kind], units="mm, deg, rpm", **PRESS))
    points = [[0.3, 0.0, 0.01, 200.0], [1.7, 30.0, -0.01, -90.0], [4.4, 0.0, 0.0, 150.0]]
    for (theta, added, ec, omega0), result in zip(points, page.evaluate(UNDER, points), strict=True):
        under = ELEMENTS[kind] + added
        right = dx.evaluate(NAMES, theta=theta, F_Y=under, **{**PRESS, "ec": ec, "omega0": omega0})
        assert result == pytest.approx([right[name] for name in NAMES], rel=1e-10, abs=1e-8)
    angles = {"theta": np.linspace(0.0, 6.0, 5), **PRESS}
    for added in (0.0, 25.0):
        page.evaluate("(added) => { window.desaxe.state.designs[0].F_Y = added; }", added)
        load = dx.scene(tomllib.loads(page.evaluate("window.desaxe.sceneText()"))).inputs["F_Y"]
        expected = dx.evaluate("T_in", F_Y=ELEMENTS[kind] + added, **angles)
        assert dx.evaluate("T_in", F_Y=load, **angles) == pytest.approx(expected, rel=1e-12)


JUMPS = {
    "over theta": dx.over_theta([0.3, 1.0, 1.0, 4.0], [0.0, -4e5, -50.0, 20.0], kind="linear"),
    "four-stroke": dx.over_theta([0.0, 7.1, 7.1, 9.0], [0.0, -4e5, 0.0, 0.0], kind="linear", period=12.566),
    "over Y": dx.over_Y([0.05, 0.0613, 0.0613, 0.09], [0.0, 0.0, -3e5, -3e5], [0.0, 0.0, 0.0, 0.0]),
    "over the stroke": dx.over_stroke(
        [0.0, 0.0083, 0.0083], [-4e5, -4e5, 0.0], [0.0] * 3, dead_centre="outer"
    ),
    "from the inner": dx.over_stroke([0.0, 0.011], [5e5, 0.0], kind="step", dead_centre="inner"),
    "either way": dx.over_Y([0.03, 0.1], [-3e5, -3e5], [1e5, 2e5]),
}


@pytest.mark.parametrize(
    "kind", first(3, dict.fromkeys(["four-stroke", "over the stroke", "either way", *JUMPS]))
)
def test_a_peak_at_a_jump_is_its_one_sided_limit(kind, numbers_of, folder):
    path = folder / f"jump_{list(JUMPS).index(kind)}.html"
    page = numbers_of(dx.explore(names=["T_in", "N_C"], path=path, F_Y=JUMPS[kind], overwrite=True, **PRESS))
    for name in ("T_in", "N_C"):
        top = f"((d) => desaxe.peakOf('{name}', d, desaxe.curve('{name}', d)))(desaxe.state.designs[0])"
        exact = dx.peak(name, F_Y=JUMPS[kind], **PRESS)
        assert abs(page.evaluate(top)["value"]) == pytest.approx(exact["value"], rel=1e-7)


def test_a_function_is_refused(folder):
    with pytest.raises(TypeError, match=r"explore: F_Y = .* a page holds numbers, tables, springs, dampers"):
        dx.explore(path=folder / "none.html", F_Y=lambda theta: 2.0 * np.sin(theta), **PRESS)
