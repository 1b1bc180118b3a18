"""The numbers of the page are those of `dx.evaluate`, to 1e-13 x (1 + condition number)."""

import math
import random

import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.families import points
from desaxe.oracle.force_truth import OTHERS, conditions
from tests.effort import first
from tests.points import draw
from tests.scenes.test_one_number import SCENES, values_of

BOUND = 1e-13
MOTION = {"omega0": 157.0, "alpha": -3.0}
BODIES = {
    "m_crank": 0.2, "m_rod": 0.5, "m_slider": 0.8, "I_crank": 3e-5, "I_rod": 2e-4, "r_rod": 0.1,
    "F_X": 20.0, "F_Y": -50.0, "g_Y": -9.81,
}  # fmt: skip

# All values of a page at some points, as text: JSON knows no NaN.
VALUES = """(points) => {
  const { content, valueAt } = window.desaxe, names = Object.keys(content.quantities);
  return points.map((at) => names.map((name) => String(valueAt(name, at, at.theta))));
}"""


def generic(kind, count):
    for point in draw(kind, count):
        yield {"alpha": 0.0, **point}


def change_points(branch):
    """At the change point and next to it, the rod a little longer or shorter."""
    rows = [*points("change_point", 40), *points("near_change_point", 80)]
    return [row for row in rows if row["branch"] == branch]


def with_bodies(count):
    rng = random.Random("explorer: bodies")
    for point in draw("speeding up", count):
        weights = {name: value * rng.uniform(0.5, 2.0) for name, value in BODIES.items()}
        yield {**point, **weights, "branch": 1}


CASES = {
    "generic": lambda: [p for p in generic("generic", 150) if p["branch"] == 1],
    "a crank that cannot turn": lambda: [p for p in generic("long crank", 120) if p["branch"] == 1],
    "the other branch": lambda: list(generic("branch -1", 60)),
    "a state": lambda: list(generic("state", 60)),
    "from rest": lambda: list(generic("from rest", 40)),
    "at a steady speed": lambda: list(generic("steady", 40)),
    "backwards": lambda: list(generic("backwards", 40)),
    "slowing down": lambda: list(generic("slowing down", 40)),
    "next to a change point": lambda: change_points(1),
    "next to it on the other branch": lambda: change_points(-1),
    "forces": lambda: list(with_bodies(30)),
}


USUAL = ("generic", "the other branch", "next to a change point", "forces")


@pytest.mark.parametrize(
    "case", [c if c in USUAL else pytest.param(c, marks=pytest.mark.thorough) for c in CASES]
)
def test_values_and_sensitivities(case, numbers_of, tmp_path):
    rows = CASES[case]()
    inputs = {name: value for name, value in rows[0].items() if name not in ("theta", "branch")}
    page = numbers_of(dx.explore(path=tmp_path / "page.html", branch=rows[0]["branch"], **inputs))
    names = page.evaluate("Object.keys(desaxe.content.quantities)")
    result = page.evaluate(VALUES, rows)
    wrong = []
    for point, row in zip(rows, result, strict=True):
        expected = dx.evaluate(names, **point)
        for name, text in zip(names, row, strict=True):
            if not agrees(name, float(text.replace("Infinity", "inf")), expected[name], point):
                wrong.append((name, text, expected[name], point))
    assert not wrong
    assert len(rows) > 25
    assert len(names) > 100


def agrees(name, result, expected, point):
    """Near enough; the condition number is looked up only where it is needed."""
    if not math.isfinite(expected):
        return str(result) == str(float(expected))
    error = abs(result - expected)
    if error <= BOUND * abs(expected):
        return True
    return error <= BOUND * abs(expected) * (1 + conditions(name, "margin", OTHERS, **point))


def test_the_check_sees_an_error():
    point = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.35, **MOTION, "branch": 1}
    value = dx.evaluate("a_C", **point)
    assert agrees("a_C", value, value, point)
    assert not agrees("a_C", value * (1 + 1e-9), value, point)
    assert not agrees("a_C", math.nan, value, point)
    assert not agrees("a_C", 1.0, math.nan, point)


@pytest.mark.parametrize(
    "lengths",
    [
        {"ec": 0.0, "AB": 0.125, "BC": 0.35},
        {"ec": 0.23, "AB": 0.125, "BC": 0.35},
        {"ec": -0.23, "AB": 0.125, "BC": 0.35},
        {"ec": 0.0, "AB": 0.5, "BC": 0.35},
        {"ec": 0.1, "AB": 0.5, "BC": 0.35},
        {"ec": 0.34999, "AB": 50.0, "BC": 0.35},
        {"ec": 0.4749999, "AB": 0.125, "BC": 0.35},
        {"ec": 0.5, "AB": 0.125, "BC": 0.35},
        {"ec": 0.25, "AB": 0.125, "BC": 0.375},
        {"ec": -0.2250000001, "AB": 0.125, "BC": 0.35},
    ],
)
def test_gaps_and_kind_are_those_of_feasibility(lengths, standing):
    """A gap between two samples is found, too."""
    design = {**lengths, "omega0": 1.0, "alpha": 0.0}
    gaps, kind = standing.evaluate("(d) => [desaxe.gaps(d), desaxe.kindOf(d)]", design)
    expected = dx.feasibility(**lengths)
    assert kind == expected["kind"]
    turn, arcs = 2 * math.pi, expected["theta_intervals"]
    if expected["can_turn"]:
        assert gaps == []
    elif not arcs:
        assert gaps == [[0.0, turn]]
    else:
        ends = sorted((a % turn, b % turn) for (_, a), (b, _) in zip(arcs, [*arcs[1:], arcs[0]], strict=True))
        assert sorted((a % turn, b % turn) for a, b in gaps) == [
            pytest.approx(end, abs=1e-14) for end in ends
        ]


OF_DESIGNS = """([names, angles]) => desaxe.state.designs.map((at) =>
  names.map((name) => angles.map((theta) => desaxe.valueAt(name, at, theta))));"""


@pytest.mark.parametrize("name", first(2, dict.fromkeys(["two turns", "designs", *SCENES])))
def test_the_page_of_a_scene_has_the_values_of_its_machine(name, numbers_of, tmp_path):
    """The last front end of `test_one_number.py`."""
    path = tmp_path / "press.toml"
    path.write_text(SCENES[name])
    outputs, machine = dx.scene(path).outputs, dx.Machine.read(path)
    theta = np.radians(np.linspace(0, 720 if name == "two turns" else 360, 73))
    page = numbers_of(dx.explore(path, tmp_path / "page.html"))
    designs = page.evaluate(OF_DESIGNS, [outputs, theta.tolist()])
    known = {n: v.reshape(73, -1) for n, v in values_of(name, outputs, machine).items()}
    assert len(designs) == known["a_C"].shape[1]
    for k, values in enumerate(designs):
        for n, value in zip(outputs, values, strict=True):
            expected, scale = known[n][:, k], 1e-12 * np.abs(known[n]).max()
            np.testing.assert_allclose(machine.units.of(n).shown(np.array(value)), expected, 1e-12, scale)
