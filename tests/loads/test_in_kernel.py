"""Grids under loads by one kernel: tables are its arguments, sides of jumps are exact."""

from math import nextafter

import numpy as np
import pytest

import desaxe as dx
from desaxe.compiler.languages.numba.module import TO_COMPILE, emit_numba
from desaxe.evaluation.axes import outer_of
from desaxe.evaluation.points import points_of
from desaxe.evaluation.under_loads.kernel import open_points
from desaxe.loads.pieces import Place, piece_at
from desaxe.runtime.kernels import kernel_of

MACHINE = {"AB": 0.1, "BC": 0.35, "omega0": 30.0, "m_slider": 2.0, "m_rod": 1.0}
AXES = {"theta": np.linspace(0.0, 2.0 * np.pi, 61), "ec": np.linspace(-0.05, 0.05, 41)}
NAMES = ["T_in", "T_in_wrt_ec"]


def step_of(load, names=("T_in",), **inputs):
    outer = outer_of(list(names), {**MACHINE, **AXES, "F_Y": load, **inputs}, 1, None, always=False)
    return points_of(outer.names, outer, outer.dimensions, 1, "standard")


@pytest.fixture(autouse=True)
def kernels_whatever_the_size(monkeypatch):
    monkeypatch.setattr("desaxe.evaluation.under_loads.kernel.LEAST", 0)


def hit(row, column):
    """The position of the slider at a point of the grid."""
    place = {"theta": AXES["theta"][row], "ec": AXES["ec"][column]}
    return dx.evaluate("Y", AB=MACHINE["AB"], BC=MACHINE["BC"], **place)


def test_a_key_has_the_kind_of_a_load_and_not_its_content():
    one = dx.over_Y([0.3, 0.33, 0.4], [0.0, -100.0, -400.0], kind="step")
    other = dx.over_Y([0.27, 0.3, 0.33, 0.4], [0.0, -10.0, 3.0, -40.0], kind="linear")
    both_ways = dx.over_Y([0.3, 0.4], [0.0, -100.0], [0.0, 10.0])
    keys = [step_of(load).inside.key for load in (one, other, both_ways)]
    assert keys[0] == keys[1] != keys[2]


def test_the_search_stands_in_a_loop_of_its_own():
    text = emit_numba(
        kernel_of(step_of(dx.over_Y([0.3, 0.4], [0.0, -100.0], [0.0, 10.0])).inside.key), "", TO_COMPILE
    )
    loops = text[text.index("def loops(") :]
    assert "lookup" not in loops
    assert loops.count("find_pieces(") == loops.count("look_up(") == 1
    assert "F_Y_x, F_Y_c, out_T_in" in " ".join(loops[: loops.index("):")].split())


def test_what_a_kernel_of_numbers_alone_is_made_of_did_not_change():
    outer = outer_of(["T_in"], {**MACHINE, **AXES, "F_Y": -300.0}, 1, None, always=False)
    step = points_of(outer.names, outer, outer.dimensions, 1, "standard")
    assert step.inside is None
    assert "look_up" not in emit_numba(kernel_of(step.key), "", TO_COMPILE)


def test_designs_without_wide_margins_go_the_usual_way():
    load = dx.over_Y([0.3, 0.4], [0.0, -100.0])
    assert step_of(load, ec=np.linspace(0.0, 0.2499, 41)).inside is None
    assert step_of(load, ec=np.array([0.0, 1e61])).inside is None


AT = sorted([hit(7, 3), hit(20, 20), hit(41, 30)])
LOADS = {
    "step": dx.over_Y(AT, [0.0, -100.0, -400.0], [50.0, -10.0, 0.0], kind="step"),
    "stroke": dx.over_stroke([0.0, 0.008, 0.1], [-400.0, -100.0, 0.0], kind="linear", dead_centre="inner"),
}


@pytest.mark.parametrize("over", ["step", pytest.param("stroke", marks=pytest.mark.thorough)])
def test_a_grid_has_the_values_of_its_points(over, monkeypatch):
    """The jumps of the step are exactly at points of the grid, where one offset is 0."""
    found = dx.grid(NAMES, F_Y=LOADS[over], **AXES, **MACHINE)
    cut = dx.grid(NAMES, F_Y=LOADS[over], chunks={"ec": 7, "theta": 20}, **AXES, **MACHINE)
    for name in NAMES:
        np.testing.assert_array_equal(cut[name], found[name], err_msg=name)
    monkeypatch.setattr("desaxe.evaluation.under_loads.points.LEAST", 10**9)
    points = dx.evaluate(NAMES, theta=AXES["theta"][:, None], ec=AXES["ec"], F_Y=LOADS[over], **MACHINE)
    for name in NAMES:
        scale = np.abs(points[name]).max()
        np.testing.assert_allclose(found[name], points[name], rtol=1e-11, atol=1e-12 * scale, err_msg=name)


def test_a_load_that_a_name_does_not_hang_on_changes_nothing():
    """Without friction the torque has no part of a force across."""
    across = dx.over_theta([0.0, 1.0, 2.0, 4.0], [0.0, -300.0, 50.0, 20.0])
    axes = {"theta": np.linspace(0.0, 6.0, 5), "ec": [0.0, 0.01]}
    both, one = (
        dx.grid("T_in", F_Y=LOADS["stroke"], **more, **axes, **MACHINE) for more in ({"F_X": across}, {})
    )
    np.testing.assert_array_equal(both.T_in, one.T_in)


@pytest.mark.thorough
def test_a_reduced_grid_has_the_values_of_its_points(monkeypatch):
    found = dx.grid("T_in", F_Y=LOADS["step"], reduce={"theta": ["max", "mean"]}, **AXES, **MACHINE)
    one = {**AXES, "ec": AXES["ec"][20:21]}
    alone = dx.grid(
        "T_in", F_Y=LOADS["step"], reduce={"theta": ["max", "mean"]}, chunks={"ec": 1}, **one, **MACHINE
    )
    np.testing.assert_array_equal(alone.T_in_mean, found.T_in_mean[20:21])
    monkeypatch.setattr("desaxe.evaluation.under_loads.points.LEAST", 10**9)
    points = dx.evaluate("T_in", theta=AXES["theta"][:, None], ec=AXES["ec"], F_Y=LOADS["step"], **MACHINE)
    np.testing.assert_allclose(found.T_in_max, points.max(axis=0), rtol=1e-12)
    np.testing.assert_allclose(found.T_in_mean, points.mean(axis=0), rtol=1e-10, atol=1e-11)


def test_what_hangs_on_fewer_axes_is_looked_up_too(monkeypatch):
    """The slider's place is a table over theta, the way in which it goes hangs on the speed."""
    axes = {"theta": AXES["theta"], "omega0": np.linspace(-20.0, 30.0, 6), "ec": 0.01}
    machine = {name: value for name, value in MACHINE.items() if name not in axes}
    load = dx.over_stroke([0.01, 0.1], [-400.0, 0.0], [-1.0, 30.0], "linear", dead_centre="outer")
    found = dx.grid("T_in", F_Y=load, reduce={"theta": "mean"}, **axes, **machine)
    monkeypatch.setattr("desaxe.evaluation.under_loads.points.LEAST", 10**9)
    speeds, theta = np.meshgrid(axes["omega0"], axes["theta"], indexing="ij")
    points = dx.evaluate("T_in", theta=theta, omega0=speeds, ec=0.01, F_Y=load, **machine)
    np.testing.assert_allclose(found.T_in_mean, points.mean(axis=1), rtol=1e-10)


def test_every_point_that_rounding_may_decide_is_found():
    """At the angles of jumps and dead centres, and doubles beside them, of random designs."""
    rng = np.random.default_rng(31)
    missed = wrong = 0
    for _ in range(12):
        AB, BC = rng.uniform(0.05, 0.25), 0.35
        ec = np.array([0.0, *rng.uniform(-0.05, 0.05, 3)])
        reach = np.sort(rng.uniform(BC - AB + 0.05, BC + AB - 0.01, 2))
        reach[0] = dx.events(ec=ec[2], AB=AB, BC=BC)["Y_inner"] if rng.random() < 0.5 else reach[0]
        load = dx.over_Y(np.sort(reach), [3.0, -2.0], [1.0, 5.0], kind="step")
        lengths = [ec, np.full(4, AB), np.full(4, BC)]
        for row in range(4):
            for at in _angles(load, [length[row : row + 1] for length in lengths]):
                theta = np.array([at, *(_next(at, k) for k in (-40, -3, -1, 1, 3, 40))])
                motion = dx.evaluate(
                    ["Y", "Y_wrt_theta", "Y_wrt_theta_theta"], theta=theta, ec=ec[row], AB=AB, BC=BC
                )
                way = np.where(
                    motion["Y_wrt_theta"] == 0.0, motion["Y_wrt_theta_theta"], motion["Y_wrt_theta"]
                )
                rounded = load.piece(motion["Y"], way)
                place = Place(0.0, [float(length[row]) for length in lengths], 1.0, 1)
                exact = np.array([piece_at(load, place._replace(theta=float(t))) for t in theta])
                far = np.append(theta, [np.nan, np.inf, 1e8, -1e15])
                rows, places = open_points({"F_Y": load}, lengths, 1, far)
                open_here = np.isin(np.arange(theta.size), places[rows == row])
                wrong += int((rounded != exact).sum())
                missed += int(((rounded != exact) & ~open_here).sum())
    assert wrong > 20, "no draw in which rounding decides: the trial shows nothing"
    assert missed == 0


def _angles(load, lengths):
    from desaxe.loads.angles import crossings
    from desaxe.mechanism.closed.angles import dead_centres

    found = np.append(crossings(load, load.jumps, lengths, 1), dead_centres(lengths))
    return found[np.isfinite(found)].tolist()


def _next(angle, count):
    for _ in range(abs(count)):
        angle = nextafter(angle, np.inf if count > 0 else -np.inf)
    return angle
