"""A page under a load over theta: its numbers, and the scene that it saves."""

import math
import tomllib

import numpy as np
import pytest

import desaxe as dx

PRESS = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "omega0": 200.0, "m_slider": 0.8}
ANGLES, FORCES = [0.3, 1.0, 2.5, 4.0], [0.0, -400.0, -50.0, 20.0]
VALUES = """(points) => points.map(([theta, added]) => ["T_in", "T_in_wrt_theta", "N_C"].map(
  (name) => window.desaxe.valueAt(name, { ...window.desaxe.state.designs[0], F_Y: added }, theta)))"""


@pytest.mark.parametrize("kind", ["cubic", "step"])
def test_the_page_has_the_numbers_of_evaluate_and_saves_the_load(kind, visit, folder):
    load = dx.over_theta(ANGLES, FORCES, kind=kind)
    page = visit(dx.explore(path=folder / f"{kind}.html", F_Y=load, **PRESS))
    points = [[0.3, 0.0], [1.7, 0.0], [-2.0, 30.0], [9.0, 0.0]]
    for (theta, added), found in zip(points, page.evaluate(VALUES, points), strict=True):
        names = ["T_in", "T_in_wrt_theta", "N_C"]
        under = dx.over_theta(ANGLES, np.array(FORCES) + added, kind=kind)
        right = dx.evaluate(names, theta=theta, F_Y=under, **PRESS)
        for value, name in zip(found, names, strict=True):
            assert math.isclose(value, right[name], rel_tol=1e-11, abs_tol=1e-9)
    saved = dx.scene(tomllib.loads(page.evaluate("window.desaxe.sceneText()")))
    assert saved.inputs["F_Y"] == load


def test_a_function_is_refused(folder):
    with pytest.raises(TypeError, match=r"explore: F_Y = .* a page holds numbers and tables over theta"):
        dx.explore(path=folder / "none.html", F_Y=np.sin, **PRESS)
