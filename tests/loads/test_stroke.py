"""Loads over the distance from a dead centre: against free bodies at many digits, and constant forces."""

import math
import pickle
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.effort import cases
from tests.peaks import test_jumps as jumps
from tests.peaks.pieces import FromCentre

PRESS = {"ec": 0.01, "AB": 0.04, "BC": 0.064}
LENGTHS = ("ec", "AB", "BC")
DISTANCES, OUTWARD, INWARD = (0.0, 0.02, 0.035, 0.06), (-900.0, -300.0, -80.0, 20.0), (10.0, -70.0, 30.0, 0.0)


# ---- at any design: the forces of a number -------------------------------------------------------------


def design_of(draw):
    """A design that turns fully, one with a long crank, or one that does not turn."""
    AB = draw.uniform(0.02, 0.1)
    BC = AB * draw.choice([draw.uniform(1.2, 5.0), draw.uniform(0.3, 0.9), draw.uniform(0.9, 1.2)])
    ec = draw.choice([0.0, draw.uniform(-1.0, 1.0) * abs(BC - AB), draw.uniform(-0.8, 0.8) * BC])
    return {"ec": ec, "AB": AB, "BC": BC}


def exact_distance(theta, design, branch, which):
    """|Y - Y_dc| of the raw triangle; NaN where crank and rod cannot be in line this way."""
    ec, AB, BC = (mpf(design[n]) for n in LENGTHS)
    across = ec + AB * mp.sin(mpf(theta))
    along = AB + BC if which == "outer" else BC - AB
    if abs(across) > BC or abs(along) < abs(ec):
        return math.nan
    height = mp.sqrt(along**2 - ec**2)
    centre = branch * (height if along >= 0 else -height)
    return float(abs(centre - (AB * mp.cos(mpf(theta)) + branch * mp.sqrt(BC**2 - across**2))))


@pytest.mark.sampled
def test_any_design_has_the_forces_of_its_own_distance():
    draw = jumps.random.Random(31)
    seen = {0: 0, 1: 0}
    for _ in range(cases(300, 3000, 20_000)):
        design, branch, theta = design_of(draw), draw.choice([1, -1]), draw.uniform(-7.0, 7.0)
        which = draw.choice(["outer", "inner"])
        table = sorted(draw.uniform(0.0, 2.0 * design["AB"]) for _ in range(3))
        load = dx.over_stroke(table, [draw.uniform(-900.0, 900.0) for _ in table], dead_centre=which)
        given = {**design, "theta": theta, "branch": branch, "omega0": 3.0, "m_slider": 1.0}
        result = dx.evaluate(["T_in", "status", "Y"], F_Y=load, **given)
        with mp.workdps(40):
            distance = exact_distance(theta, design, branch, which)
        bare = dx.evaluate(
            ["T_in", "status", "Y"], F_Y=0.0 if math.isnan(distance) else load(distance), **given
        )
        assert result["Y"] == bare["Y"] or math.isnan(result["Y"])
        if bare["status"]:
            assert result["status"] == bare["status"]
            continue
        seen[result["status"]] += 1
        if math.isnan(distance):
            assert (result["status"], math.isnan(result["T_in"])) == (1, True)
        else:
            scale = abs(dx.evaluate("T_in_wrt_F_Y", **given)) * 900.0
            room = 1e-13 + 2e-15 / min(b - a for a, b in pairwise(table))
            assert result["status"] == 0
            assert result["T_in"] == pytest.approx(bare["T_in"], rel=1e-12, abs=room * scale)
    assert min(seen.values()) >= 10


def test_arrays_numbers_and_grids_agree_and_say_the_same_of_the_status():
    load = dx.over_stroke(DISTANCES, OUTWARD, INWARD, dead_centre="inner")
    ec, theta = np.array([0.0, 0.01, 0.024, 0.03]), np.linspace(0.0, 0.5, 5)  # 0.024: a change point
    names = ["T_in", "T_in_wrt_ec", "T_in_wrt_theta", "V_C", "status"]
    given = {"AB": 0.04, "BC": 0.064, "omega0": 3.0, "F_Y": load}
    grid = dx.grid(names, theta=theta, ec=ec, **given)
    lazy = dx.grid(names, theta=theta, ec=ec, chunks={"ec": 2}, **given).compute()
    for i, j in np.ndindex(theta.size, ec.size):
        one = dx.evaluate(names, theta=theta[i], ec=ec[j], **given)
        for name in names:
            np.testing.assert_allclose(float(grid[name][i, j]), one[name], rtol=1e-13, atol=1e-13)
            np.testing.assert_array_equal(lazy[name][i, j], grid[name][i, j])
    assert grid.status.values.tolist() == [[0, 0, 2, 1]] * 5
    assert np.isnan(grid.T_in_wrt_ec.values[:, 2:]).all()
    assert np.isfinite(grid.T_in.values[:, 2]).all()
    assert np.isnan(grid.T_in.values[:, 3]).all()
    assert np.isfinite(grid.V_C.values).all()
    assert dx.evaluate("status", theta=0.1, ec=0.03, **given) == 1
    assert dx.evaluate(["T_in", "status"], theta=0.1, ec=0.024, **given)["status"] == 0


@pytest.mark.parametrize("more", [{}, {"mu": 0.1}])
def test_the_status_of_a_design_needs_no_angle(more):
    load = dx.over_stroke(DISTANCES, OUTWARD, INWARD, dead_centre="inner")
    ec, given = np.array([0.0, 0.024, 0.03]), {"AB": 0.04, "BC": 0.064, "omega0": 3.0, "F_Y": load, **more}
    bare = {name: value for name, value in given.items() if name not in ("F_Y", "mu")}
    expected = dx.evaluate("status", ec=ec, **bare)
    np.testing.assert_array_equal(dx.evaluate("status", ec=ec, **given), expected)
    assert [dx.evaluate("status", ec=own, **given) for own in ec.tolist()] == expected.tolist()
    result = dx.grid("status", ec=ec, out=np.empty(3, np.int8), **given)["status"]
    np.testing.assert_array_equal(result, expected)


# ---- jumps: constant forces, arc by arc ----------------------------------------------------------------


class Draw(jumps.Draw):
    """A random design under steps over the distance from a dead centre."""

    def stroke(self):
        draw, which = self.random, self.random.choice(["outer", "inner"])
        zero = (max if which == "outer" else min)(self.places, key=abs)
        stroke = float(max(self.places) - min(self.places))
        result = {draw.choice([0.0, draw.uniform(0.0, stroke), 10 ** draw.uniform(-9, -2)]) for _ in range(4)}
        result |= {draw.uniform(0.0, stroke), draw.uniform(0.0, stroke)}
        values = [tuple(self.force() for _ in result) for _ in range(2)]
        return FromCentre(tuple(sorted(result)), values[0], draw.choice([None, values[1]]), which, zero)


@pytest.fixture
def digits():
    with mpmath.workdps(jumps.DIGITS):
        yield


@pytest.mark.thorough
@pytest.mark.sampled
def test_a_peak_is_that_of_constant_forces_on_each_side_of_the_jumps(digits):
    for seed in range(cases(2, 12, 600)):
        draw = Draw(50_000 + seed)
        jumps.check(draw, dx.peak(draw.name, kind=draw.kind, theta=draw.theta, **draw.given))


@pytest.mark.thorough
def test_the_gradient_of_a_peak_at_a_jump_moves_with_the_dead_centre(digits):
    checked = 0
    for seed in range(cases(2, 12, 600)):
        draw = Draw(60_000 + seed)
        draw.name, draw.kind, draw.theta = ("T_in", "F_C_Y")[seed % 2], "max", (0.0, 2 * math.pi)
        draw.loads = {"F_Y": draw.stroke()}
        result = dx.peak(draw.name, kind="max", theta=draw.theta, **draw.given)
        top = draw.top[0]
        marks = [mark for end, mark in zip(top.ends, top.arc.marks, strict=True) if end == top.theta]
        away = min(abs(float(t) - result["theta"]) for t in draw.turning)
        if (
            not result["side"]
            or marks != ["position"]
            or abs(result["theta"] - top.theta) > 1e-13
            or away < 1e-3
        ):
            continue
        checked += 1
        scale = sum(abs(result["gradient"][p]) for p in LENGTHS)
        for parameter in LENGTHS:
            right = jumps.moved(draw, top, parameter, distance)
            assert result["gradient"][parameter] == pytest.approx(right, rel=1e-8, abs=1e-9 * scale)
    assert checked


def distance(draw, design, theta):
    """From a dead centre."""
    sign = 1 if draw.loads["F_Y"].dead_centre == "outer" else -1
    ec, AB, BC = (mpmath.mpf(design[n]) for n in LENGTHS)
    centre = draw.branch * mpmath.sqrt((BC + sign * AB) ** 2 - ec**2)
    return centre - jumps.position(draw, design, theta)


# ---- every call ----------------------------------------------------------------------------------------

STILL = {**PRESS, "omega0": 5.0, "m_slider": 2.0}
DIE = dx.over_stroke([0.0, 0.008, 0.008], [-8e3, -8e3, 0.0], [0.0, 0.0, 0.0], dead_centre="outer")


def test_a_distance_given_twice_is_a_jump_and_the_value_there_is_that_of_the_side_ahead():
    load = dx.over_stroke([0.0, 0.008, 0.008, 0.02], [-80.0, -60.0, -10.0, 0.0], dead_centre="outer")
    inside, outside = np.nextafter(0.008, 0.0), np.nextafter(0.008, 1.0)
    assert load(inside, 1.0) == pytest.approx(-60.0)
    assert load(outside, 1.0) == pytest.approx(-10.0)
    assert load(0.008, 1.0) == pytest.approx(-60.0)  # outward is towards the outer dead centre
    assert load(0.008, -1.0) == -10.0
    np.testing.assert_allclose(load(np.array([0.008, 0.008]), np.array([1.0, -1.0])), [-60.0, -10.0])
    assert load.jumps == [0.008]
    over_Y = dx.over_Y([0.0, 0.1, 0.1, 0.2], [1.0, 2.0, 5.0, 6.0])
    assert (over_Y(0.1, 1.0), over_Y(0.1, -1.0)) == (5.0, pytest.approx(2.0))
    over_theta = dx.over_theta([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 5.0, 0.0], kind="linear")
    assert over_theta(np.nextafter(1.0, 0.0)) == pytest.approx(1.0)
    assert over_theta(1.0) == 5.0


def test_an_angle_given_twice_is_one_jump_in_every_call():
    twice = dx.over_theta([0.0, 1.0, 1.0, 4.0], [-40.0, -40.0, -90.0, -90.0], kind="linear")
    bare = {n: STILL[n] for n in ("ec", "AB", "BC", "m_slider")}
    run = dx.simulate(torque=9.0, t_end=0.4, omega_start=5.0, I_crank=1.0, F_Y=twice, **bare)
    assert run["energy_residual"] < 1e-11
    result = dx.peak("F_C_Y", kind="max", theta=(0.5, 1.5), F_Y=twice, ec=0.01, AB=0.04, BC=0.064)
    assert result["value"] == pytest.approx(90.0)
    assert twice.nodes(0.5, 1.5, smooth=True) == twice.nodes(0.5, 1.5, smooth=False) == [1.0]


def test_simulate_refuses_a_design_without_the_dead_centre():
    load = dx.over_stroke([0.0, 0.01], [-1.0, 0.0], dead_centre="inner")
    with pytest.raises(ValueError, match="no inner dead centre"):
        dx.simulate(torque=1.0, t_end=0.01, F_Y=load, m_slider=1.0, ec=0.03, AB=0.04, BC=0.064)


def test_machines_scenes_and_files_read_it(tmp_path):
    lengths = {"ec": 10, "AB": 40, "BC": 64}
    machine = dx.Machine(**{**STILL, **lengths}, units="mm, deg, kN")
    load = machine.over_stroke([0, 8, 8], [-8, -8, 0], [0, 0, 0], dead_centre="outer")
    assert (load.outward, load.inward, load.dead_centre) == (DIE.outward, DIE.inward, "outer")
    assert pickle.loads(pickle.dumps(load)) == load
    assert (
        load.identity
        != dx.over_stroke([0, 0.008, 0.008], [-8e3, -8e3, 0], [0, 0, 0], dead_centre="inner").identity
    )
    pressed = dx.Machine(machine, F_Y=load, units=machine.units)
    path = pressed.to_scene(tmp_path / "press.toml", outputs=["T_in"], theta=5.9)
    assert dx.Machine.read(path)["F_Y"] == load
    (tmp_path / "die.csv").write_text("distance [mm], F_Y [kN], in\n0, -8, 0\n8, -8, 0\n8, 0, 0\n")
    assert dx.over_stroke.read(tmp_path / "die.csv", dead_centre="outer") == load
    text = """
    outputs = ["T_in", "status"]
    units = "mm, kN"
    [mechanism]
    ec = [10, 30]
    AB = 40
    BC = 64
    [motion]
    theta = 5.9
    omega0 = 5.0
    [loads]
    F_Y = { over_stroke = %s, dead_centre = "%s" }
    """
    points = "[[0, -8, 0], [8, -8, 0], [8, 0, 0]]"
    (tmp_path / "a.toml").write_text(text % (points, "outer"))
    run = dx.scene(tmp_path / "a.toml").run().dataset
    right = dx.evaluate("T_in", theta=5.9, ec=np.array([0.01, 0.03]), AB=0.04, BC=0.064, omega0=5.0, F_Y=DIE)
    np.testing.assert_allclose(run.T_in, right, rtol=1e-13)
    (tmp_path / "b.toml").write_text(text % ('"die.csv"', "inner"))
    assert dx.scene(tmp_path / "b.toml").run().dataset.status.values.tolist() == [0, 1]
    (tmp_path / "c.toml").write_text((text % (points, "outer")).replace(', dead_centre = "outer"', ""))
    with pytest.raises(ValueError, match="dead_centre is missing"):
        dx.scene(tmp_path / "c.toml")


@pytest.mark.parametrize(
    "options", [{"mu": 0.05}, pytest.param({"wrt": "m_slider"}, marks=pytest.mark.thorough)]
)
def test_of_many_designs_those_without_the_dead_centre_do_not_start(options):
    load = dx.over_stroke([0.0, 0.01], [-9.0, 0.0], dead_centre="inner")
    start = {"torque": 1.0, "t_end": 0.01, "omega_start": 5.0, "I_crank": 0.1, "m_slider": 1.0, "F_Y": load}
    many = dx.simulate(ec=[0.01, 0.03], AB=0.04, BC=0.064, **start, **options)
    one = dx.simulate(ec=0.01, AB=0.04, BC=0.064, **start, **options)
    assert many["status"].tolist() == [0, 6]
    assert many["work"][0] == pytest.approx(one["work"], rel=1e-9)
    assert np.isnan(many["theta"][1]).all()
