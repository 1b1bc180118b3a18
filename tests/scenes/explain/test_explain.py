"""Plans: operations after each pass, loops, skipped lines, memory, against the facts."""

import json

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.program import whole_program
from desaxe.runtime import executor
from desaxe.runtime.kernels import kernel_of
from desaxe.scenes.parts.grid import plan_of_grid
from tests.example_scenes import COMPACTOR, SMALL

pytestmark = pytest.mark.usefixtures("cold")
LINES = len(whole_program().lines)
TURN = {"start": 0, "stop": "360 deg", "num": 721}
CONCENTRIC = {
    "outputs": ["V_C"],
    "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35},
    "motion": {"theta": TURN, "omega0": 157.08},
}
DESIGNS = {
    "outputs": ["a_C"],
    "mechanism": {
        "ec": {"start": 0, "stop": 0.1, "num": 32},
        "AB": {"start": 0.1, "stop": 0.125, "num": 16},
        "BC": [0.34, 0.35],
    },
    "motion": {"theta": TURN, "omega0": 157.08},
}
PRESS = {
    "outputs": ["T_in"],
    "mechanism": {"ec": 0.02, "AB": 0.04, "BC": 0.064},
    "motion": {"theta": TURN, "omega0": 250},
    "masses": {"m_slider": 0.8, "m_rod": 0},
}


def steps(plan):
    return {step["name"]: step["operations"] for step in plan["steps"]}


def free(scene, section, name, value):
    """The scene with another value of one input."""
    return {**scene, section: {**scene[section], name: value}}


# ---- operations ----------------------------------------------------------------------------------


def test_concentric_at_constant_speed():
    plan = dx.explain(CONCENTRIC)
    assert plan["run"]["way"] == "compiled"
    assert steps(plan) == {"derivation": LINES, "slice": 89, "fold": 62, "plain": 23, "write out": 50}
    work = plan["operations"]
    assert work["straight"] == 50
    assert 40 < work["per_point"] == work["total"] / 721 < 50  # a few run once a row
    saved = {one["what"]: one["saved"] for one in plan["skipped"]}
    assert saved == {"branch = +1": 1, "alpha = 0": 14, "ec = 0": 1}


def test_concentric_with_a_rod_hardly_longer_than_the_crank():
    """Then nothing may cancel: the stable form."""
    plan = dx.explain(free(CONCENTRIC, "mechanism", "BC", 0.1251))
    assert steps(plan) == {"derivation": LINES, "slice": 89, "fold": 62, "write out": 56}
    saved = {one["what"]: one["saved"] for one in plan["skipped"]}
    assert saved == {"branch = +1": 2, "alpha = 0": 14, "ec = 0": 11}


def test_what_a_fixed_input_saves_is_what_it_costs_when_free():
    base = dx.explain(CONCENTRIC)
    for what, other in (
        ("ec = 0", free(CONCENTRIC, "mechanism", "ec", 0.01)),
        ("alpha = 0", free(CONCENTRIC, "motion", "alpha", 1.0)),
    ):
        saved = next(one["saved"] for one in base["skipped"] if one["what"] == what)
        assert dx.explain(other)["operations"]["straight"] - base["operations"]["straight"] == saved


def test_masses_of_nothing():
    plan = dx.explain(PRESS)
    what = {one["what"]: one for one in plan["skipped"]}
    assert "a massless rod" in what["m_rod = 0"]["why"]
    assert what["m_rod = 0"]["saved"] > 0
    assert next(one for name, one in what.items() if "F_Y" in name)["why"].startswith("not given")
    heavy = dx.explain(free(PRESS, "masses", "m_rod", 0.5))
    assert heavy["operations"]["straight"] > plan["operations"]["straight"]
    default_centres = [one["what"] for one in heavy["skipped"] if "half of" in one["why"]]
    assert "r_rod" in default_centres


def test_an_input_that_nothing_needs():
    plan = dx.explain({**CONCENTRIC, "outputs": ["phi"], "reduce": {"theta": "max"}})
    (message,) = [one for one in plan["skipped"] if one["what"] == "omega0"]
    assert message["why"] == "given, but no requested name depends on it"


@pytest.mark.parametrize("rods", [[0.34, 0.35], [0.19, 0.35]])
def test_counts_are_those_of_the_kernel(rods):
    """Where all designs have wide margins there is one form; else a loop says what it does instead."""
    scene = free(DESIGNS, "mechanism", "BC", rods)
    plan = dx.explain(scene)
    (step, *_) = plan_of_grid(dx.scene(scene).content).steps
    kernel = kernel_of(step.key)
    nests = [*(table.kernel for table in kernel.tables), kernel]
    lines = [line for nest in nests for level in nest.levels for line in level if line.op != "copy"]
    loops = [loop for loop in plan["loops"] if not loop["close"]]
    close = [loop["operations"] for loop in plan["loops"] if loop["close"]]
    assert close == ([] if rods[0] > 0.3 else [len(kernel.close.lines)])
    assert plan["operations"]["straight"] == len(lines)
    assert sum(loop["operations"] for loop in loops) == len(lines)
    total = sum(loop["operations"] * loop["runs"] for loop in loops)
    assert plan["operations"]["total"] == total
    assert plan["operations"]["per_point"] == total / (721 * 32 * 16 * 2)
    # Sine and cosine are not in the innermost loop.
    assert plan["operations"]["per_point"] < 0.5 * len(lines)
    assert all(
        loop["runs"] == int(np.prod([_size(axis) for axis in loop["along"]])) for loop in plan["loops"]
    )


def _size(axis):
    return {"ec": 32, "AB": 16, "BC": 2, "theta": 721}[axis]


# ---- how it runs ---------------------------------------------------------------------------------


def test_arrays_are_compiled_and_points_are_not(monkeypatch):
    monkeypatch.setattr(executor, "CompiledKernel", None)  # whoever compiles fails
    alone = free(CONCENTRIC, "motion", "theta", 1.0)
    assert dx.explain(alone)["run"]["way"] == "plain Python"
    dx.scene(alone).run()
    many = free(CONCENTRIC, "motion", "theta", {"start": 0.25, "stop": 1, "num": 3})
    assert dx.explain(many)["run"]["way"] == "compiled"
    with pytest.raises(TypeError):
        dx.scene(many).run()


@pytest.mark.parametrize("reduce", [{}, {"theta": "absmax"}])
def test_what_is_cached(reduce):
    scene = {**DESIGNS, "outputs": ["Y_wrt_BC"], "reduce": reduce}
    plan = dx.explain(scene)
    assert plan["run"]["cached"] == "no"
    dx.scene(scene).run()
    after = dx.explain(scene)
    assert after["run"]["cached"] == "memory"


def test_memory_is_that_of_the_result():
    for scene in (CONCENTRIC, {**CONCENTRIC, "reduce": {"theta": ["absmax", "mean"]}}):
        dataset = dx.scene(scene).run().dataset
        result = sum(a.nbytes for n, a in dataset.data_vars.items() if n != "margin")
        assert dx.explain(scene)["memory"]["result"] == result
    assert dx.explain({**CONCENTRIC, "reduce": {"theta": "max"}})["memory"]["grid"] == 721 * 8


# ---- the text ------------------------------------------------------------------------------------

ALL = [COMPACTOR, CONCENTRIC, {**DESIGNS, "reduce": {"theta": ["absmax", "rms"]}}, PRESS, SMALL]


@pytest.mark.parametrize("scene", ALL)
def test_text_fits_a_terminal_and_json_says_the_same(scene):
    plan = dx.explain(scene)
    assert json.loads(plan.to_json()) == plan.as_dict()
    text = str(plan)
    assert max(map(len, text.splitlines())) <= 100
    for title in ("Asked for", "Skipped", "Operations at each point", "Loops, from", "Execution"):
        assert f"\n{title}" in text


def test_text_of_a_reduction():
    text = str(dx.explain({**DESIGNS, "reduce": {"theta": ["absmax", "rms"]}}))
    assert "of each over theta: absmax, rms; the grid is not stored" in text
    assert "the grid would take" in text
    assert "other values of omega0 (but 0) compile nothing new" in text


def test_a_scene_of_peaks_alone():
    plan = dx.explain({**SMALL, "outputs": [], "peak": [{"quantity": "a_C"}]})
    assert plan["loops"] is None
    assert "absmax of a_C   2 designs   refined over theta by its derivative" in str(plan)


def test_the_text_of_a_small_scene_as_a_whole():
    text = str(dx.explain({**CONCENTRIC, "title": "Concentric", "motion": {"theta": 1, "omega0": 157.08}}))
    assert (
        text
        == f"""\
Concentric

Asked for
  V_C   m/s   velocity of the slider
  and at every point its status; the margin once per design
  accuracy standard: at most 8 ulp x (1 + the sum of the condition numbers), wherever it can be
    assembled
  motion   constant speed omega0
  fixed    ec = 0 m, AB = 0.125 m, BC = 0.35 m, theta = 1 rad, omega0 = 157.08 rad/s

Skipped
  branch = +1: one way to assemble it: no sign at run time (1 operation a point)
  alpha = 0: constant speed: the law of the crank and the test whether it stalls vanish (14
    operations a point)
  ec = 0: concentric: the slider's axis meets the crank's centre (1 operation a point)

Operations at each point after each pass
  pass         operations   saved
  derivation         {LINES}           every line of the derivation
  slice                89    {LINES - 89}   only the lines that the requested names need
  fold                 62      27   fixed inputs folded in; terms with a factor 0 vanish
  plain                23      39   every design has wide margins: shorter forms

Loops, from outside in
           runs   operations   per point
  once        1           23          23   1 cos, 1 div, 1 sin, 1 sqrt; sin_theta, cos_theta, ...
  in all                  23          23

Execution
  kernel   none: a point is plain Python over math, nothing is compiled
  memory   9 bytes of results, 8 bytes of inputs
  results  returned, not written to a file"""
    )


@pytest.mark.parametrize("data", ["values.csv", "values.xlsx", "values.nc"])
def test_work_besides_the_grid_and_the_store(data, tmp_path, monkeypatch, cold):
    monkeypatch.chdir(tmp_path)
    scene = {
        "outputs": ["V_C", "a_C"],
        "mechanism": {"AB": 0.125, "BC": 0.35, "ec": {"start": 0.0, "stop": 0.2, "num": 2001}},
        "motion": {"theta": {"start": 0.0, "stop": 6.0, "num": 7001}, "omega0": 157.08},
        "peak": [{"quantity": "a_C"}],
        "picture": [{"file": "a.png", "quantity": "a_C", "at": {"ec": 0.1}}],
        "results": {"data": data},
    }
    plan = dx.explain(scene)
    assert [(work["what"], work["count"]) for work in plan["also"]] == [
        ("absmax of a_C", 2001), ("picture of a_C", 7001),
    ]  # fmt: skip
    assert f"results  {data}" in str(plan)
    stored = dx.explain({**scene, "results": {"store": "v.zarr", "chunks": {"ec": 100}, "memory": "200 MB"}})
    assert stored["sweep"]["chunks"] == 21
    assert stored["sweep"]["chunk"] == {"ec": 100, "theta": 7001}
    assert stored["sweep"]["memory"] <= 200e6
    assert 14e6 * 17 <= stored["sweep"]["disk"] <= 14.1e6 * 17
    assert "21 of 100 ec x 7001 theta, written to v.zarr" in str(stored)
    assert not list(tmp_path.iterdir())


def test_a_plan_in_the_units_of_its_scene():
    """Those that it names: a text's own unit says nothing of the rest."""
    named = {
        "units": "mm, deg, rpm",
        "outputs": ["a_C", "V_C_wrt_ec"],
        "mechanism": {"AB": 125, "BC": 350, "ec": [0, 12.5, 20]},
        "motion": {"theta": {"start": 0, "stop": 360, "num": 5}, "omega0": 1500},
    }
    plan = dx.explain(named)
    assert [(one["name"], one["unit"]) for one in plan["outputs"]] == [
        ("a_C", "mm/s^2"), ("V_C_wrt_ec", "1/s"),
    ]  # fmt: skip
    rows = {one["name"]: one for one in plan["inputs"]}
    assert rows["ec"] == {"name": "ec", "unit": "mm", "values": 3, "from": 0.0, "to": 20.0}
    assert rows["omega0"] == {"name": "omega0", "unit": "rpm", "value": 1500.0}
    text = str(plan)
    assert "ec (3: 0 to 20 mm), theta (5: 0 to 360 deg)" in text
    assert "AB = 125 mm, BC = 350 mm, omega0 = 1500 rpm" in text
    bare = {key: value for key, value in named.items() if key != "units"}
    bare["mechanism"] = {"AB": "125 mm", "BC": "350 mm", "ec": 0}
    bare["motion"] = {"theta": "60 deg", "omega0": "1500 rpm"}
    assert {one["unit"] for one in dx.explain(bare)["inputs"]} == {"m", "rad", "rad/s"}


UNDER = {
    "over theta": {"over_theta": [["0 deg", 0], ["90 deg", -2000], ["180 deg", -50]]},
    "over Y": {"over_Y": [["225 mm", 0, 0], ["475 mm", -2000, -50]]},
}


@pytest.mark.parametrize("load", UNDER)
def test_under_a_load_the_kernel_is_the_one_that_runs(load):
    """It is kept once the scene has run, and so it is told."""
    scene = {
        "outputs": ["T_in"],
        "mechanism": {"AB": 0.125, "BC": 0.35, "ec": [0.0, 0.05]},
        "motion": {"omega0": 157.0, "theta": {"start": 0, "stop": 6, "num": 130_000}},
        "masses": {"m_slider": 1.0},
        "loads": {"F_Y": UNDER[load]},
    }
    dx.scene(scene).run()
    run = dx.explain(scene)["run"]
    assert run["cached"] == "memory"
    assert run["way"] == "compiled"


@pytest.mark.parametrize("load", UNDER)
def test_the_cost_of_a_load_is_told(load):
    """Over theta once for each angle, over Y at each point."""
    scene = {
        "outputs": ["T_in"],
        "mechanism": {"AB": 0.125, "BC": 0.35, "ec": [0.0, 0.05]},
        "motion": {"omega0": 157.0, "theta": {"start": 0, "stop": 6, "num": 13_000}},
        "masses": {"m_slider": 1.0},
    }
    plan, bare = dx.explain({**scene, "loads": {"F_Y": UNDER[load]}}), dx.explain(scene)
    (cost,) = plan["loads"]
    assert (cost["name"], cost["lookups"]) == ("F_Y", {"over theta": 13_000, "over Y": 26_000}[load])
    assert f"F_Y is looked up {cost['lookups']:,} times" in str(plan)
    assert "no requested name depends on it" not in str(plan)
    assert bare["loads"] == []
