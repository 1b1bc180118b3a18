"""Peaks under loads that jump, against constant forces arc by arc (`pieces`), and what is made of them."""

import random
from math import nextafter, pi

import mpmath
import numpy as np
import pytest
from mpmath import mp

import desaxe as dx
from tests.effort import cases
from tests.peaks.pieces import DIGITS, SIGN, Stroke, Turn, closure_of, dead_centres, edges, sides, tops

NAMES = ("T_in", "N_C", "F_B_Y", "F_B_X", "F_A_X", "F_C_Y", "power_in", "F_B", "F_shaking_Y")
KINDS = ("absmax", "max", "min")
BODIES = {"m_crank": 3.0, "m_rod": 2.0, "m_slider": 10.0, "I_rod": 0.01}
LENGTHS = ("ec", "AB", "BC")
PRESS = {"ec": 0.015, "AB": 0.075, "omega0": 2 * pi, "m_slider": 120, "mu": 0.08}
POSITIONS = (0.2, dx.events(ec=0.015, AB=0.075, BC=0.3)["Y_outer"] - 0.008, 0.38)
FORCE = {"F_Y": Stroke(POSITIONS, (0.0, -80e3, -80e3), (0.0, 0.0, 0.0))}
LOAD = {"F_Y": FORCE["F_Y"].load}


@pytest.fixture(autouse=True)
def digits():
    """The precision is that of this file's tests alone: it is the process's."""
    with mpmath.workdps(DIGITS):
        yield


def press_peak(BC=0.299999, name="T_in", kind="absmax"):
    return tops(name, kind, PRESS | {"BC": BC}, 1, FORCE, (0.0, 2 * pi))[0].value


class Draw:
    """A random design, its loads, and a range of angles."""

    def __init__(self, seed, mu=0.0):
        self.random = draw = random.Random(seed)
        AB = draw.uniform(0.02, 0.1) * draw.choice([1.0, 1.0, 10 ** draw.uniform(-2, 1)])
        BC = AB * draw.uniform(1.3, 6)
        ec = draw.choice([0.0, *[draw.uniform(-0.8, 0.8) * (BC - AB) * draw.choice([1, 0.1])] * 5])
        speed = draw.choice([1, -1]) * 10 ** draw.uniform(-1, 2)
        self.design = {"ec": ec, "AB": AB, "BC": BC, "omega0": speed}
        self.design |= {n: draw.uniform(0, most) for n, most in BODIES.items() if draw.random() < 0.6}
        self.design |= {"mu": mu} if mu else {}
        self.branch = draw.choice([1, -1])
        self.turning = dead_centres(self.design, -4, 8)
        closure = closure_of(self.design, self.branch)
        self.places = [closure(t)[0] for t in self.turning]
        self.loads = {"F_Y": draw.choice([self.stroke, self.stroke, self.turn])()}
        if draw.random() < 0.2:
            self.loads["F_X"] = draw.choice([self.stroke, self.turn])()
        self.theta = self.range()
        self.name, self.kind = draw.choice(NAMES), draw.choice(KINDS)
        if (self.name, self.kind) == ("F_B", "min"):  # a magnitude of nearly 0, which rounding makes
            self.kind = "max"

    def force(self):
        return self.random.choice([0.0, self.random.uniform(-1, 1) * 10 ** self.random.uniform(1, 5)])

    def stroke(self):
        """Steps anywhere, and 1e-17 to 1e-2 m from a dead centre, or at it."""
        draw, low, high = self.random, float(min(self.places)), float(max(self.places))
        result = set()
        while len(result) < draw.choice([2, 2, 3, 4]):
            near = draw.choice([*self.places, None, None])
            away = draw.choice([0, 1, -1, 1, -1]) * 10 ** draw.uniform(-17, -2)
            result.add(draw.uniform(low, high) if near is None else float(near + away))
        values = [tuple(self.force() for _ in result) for _ in range(2)]
        return Stroke(tuple(sorted(result)), values[0], draw.choice([None, values[1]]))

    def turn(self):
        draw, period = self.random, self.random.choice([2 * pi, 4 * pi])
        places = [draw.choice([draw.uniform(0, 6), float(draw.choice(self.turning)) % 6]) for _ in range(3)]
        angles = tuple(sorted({0.0, *places}))
        return Turn(angles, tuple(self.force() for _ in angles), period)

    def range(self):
        """The period, or a range that may begin or end at a jump."""
        draw = self.random
        if draw.random() < 0.6:
            return 0.0, max([2 * pi, *(one.period for one in self.loads.values() if isinstance(one, Turn))])
        jumps = edges(self.design, self.branch, self.loads, mpmath.mpf(-3), mpmath.mpf(9))
        at = draw.choice([draw.uniform(-3, 3), *(float(t) for t, _ in jumps)])
        return draw.choice([(at, at + draw.uniform(0.1, 7)), (at - draw.uniform(0.1, 7), at)])

    @property
    def given(self):
        return {**self.design, **{n: one.load for n, one in self.loads.items()}, "branch": self.branch}

    @property
    def top(self):
        return tops(self.name, self.kind, self.design, self.branch, self.loads, self.theta)


def rounding(draw, every):
    """The change from a few ulp of the angle, and of the values."""
    try:
        names = f"{draw.name}_wrt_theta"
        with np.errstate(invalid="ignore"):
            slopes = [
                dx.evaluate(names, theta=t.theta, branch=draw.branch, **draw.design, **t.arc.forces)
                for t in every
            ]
    except ValueError:
        slopes = [0.0]
    friction = 1e-9 if "mu" in draw.design else 0.0  # where it makes a kink, its place is that of a scan
    largest = max(abs(top.value) for top in every)
    return (
        np.nanmax([0.0, *np.abs(slopes)]) * 4e-15 + (1e-12 + friction) * abs(every[0].value) + 1e-13 * largest
    )


def check(draw, result):
    """A peak against the truth: its value, that of its angle, its side."""
    every = draw.top
    best, room = every[0], rounding(draw, every)
    assert result["value"] == pytest.approx(best.value, rel=0, abs=room)
    away = min(abs(float(t) - result["theta"]) for t in draw.turning)
    if not (result["side"] and 1e-13 < away < 0.1):  # where an ulp of the position is many of the angle
        there = dx.evaluate(draw.name, theta=result["theta"], **draw.given)
        assert SIGN[draw.kind](there) == pytest.approx(SIGN[draw.kind](result["value"]), rel=0, abs=room)
    near = [top for top in every if abs(top.value - best.value) <= room]
    allowed = [sides(draw.name, draw.design, draw.branch, top, 100 * room) for top in near]
    alike = [s for top, s in zip(near, allowed, strict=True) if abs(top.theta - result["theta"]) <= 1e-6]
    assert not alike or any(result["side"] in some for some in alike)


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(4))
def test_a_peak_is_that_of_constant_forces_on_each_side_of_the_jumps(part):
    for seed in range(part, cases(8, 200, 2000), 4):
        draw = Draw(seed)
        check(draw, dx.peak(draw.name, kind=draw.kind, theta=draw.theta, **draw.given))


@pytest.mark.thorough
@pytest.mark.parametrize("part", range(4))
def test_with_friction(part):
    for seed in range(part, cases(0, 24, 1000), 4):
        draw = Draw(10_000 + seed, mu=0.08)
        check(draw, dx.peak(draw.name, kind=draw.kind, theta=draw.theta, **draw.given))


def in_arrays(seed):
    draw = Draw(20_000 + seed)
    draw.design |= BODIES  # one kernel for each name
    draw.name = ("T_in", "F_B_Y")[seed % 2]
    lengths = draw.design["BC"] * (1.0 + np.array([0.0, 1e-3, -1e-7]))
    result = dx.peak(draw.name, kind=draw.kind, theta=draw.theta, **draw.given | {"BC": lengths})
    assert result["side"].dtype == np.int8
    for k, BC in enumerate(lengths.tolist()):
        draw.design["BC"] = BC
        check(draw, {name: result[name][k] for name in ("value", "theta", "side")})


def test_in_arrays():
    for seed in range(cases(1, 6, 30)):
        in_arrays(seed)


def position(draw, design, theta):
    return closure_of(design, draw.branch)(theta)[0]


def moved(draw, top, parameter, place=position):
    """The derivative of a limit at a place that moves, in mpmath: partial, and slope times dtheta/dp."""
    theta = top.arc.low if top.theta == top.ends[0] else top.arc.high

    def there(p, t):
        return place(draw, draw.design | {parameter: p}, t)

    by, own = (mpmath.diff(there, (draw.design[parameter], theta), n) for n in ((1, 0), (0, 1)))
    names = [f"{draw.name}_wrt_{p}" for p in (parameter, "theta")]
    here = {**draw.design, **top.arc.forces, "branch": draw.branch, "theta": top.theta}
    partial, slope = dx.evaluate(names, **here).values()
    return partial - slope * float(by / own)


@pytest.mark.thorough
@pytest.mark.sampled
def test_the_gradient_moves_with_the_jump():
    checked = 0
    for seed in range(cases(4, 200, 1000)):
        draw = Draw(30_000 + seed)
        draw.name, draw.kind, draw.theta = ("T_in", "F_C_Y", "N_C")[seed % 3], "max", (0.0, 2 * pi)
        result = dx.peak(draw.name, kind="max", theta=draw.theta, **draw.given)
        top = draw.top[0]
        marks = [mark for end, mark in zip(top.ends, top.arc.marks, strict=True) if end == top.theta]
        away = min(abs(float(t) - result["theta"]) for t in draw.turning)
        off = abs(result["theta"] - top.theta)
        if not result["side"] or marks != ["position"] or off > 1e-13 or away < 1e-4:
            continue
        checked += 1
        for parameter in LENGTHS:
            scale = sum(abs(result["gradient"][p]) for p in LENGTHS)
            assert result["gradient"][parameter] == pytest.approx(
                moved(draw, top, parameter), rel=1e-8, abs=1e-9 * scale
            )
    assert checked >= cases(1, 20, 100)


@pytest.mark.sampled
def test_the_press_of_the_report():
    for BC in (0.299999, 0.3)[: cases(1, 2)]:
        result = dx.peak("T_in", **PRESS, **LOAD, BC=BC)
        assert result["value"] == pytest.approx(press_peak(BC), rel=1e-12)
        assert result["side"] == 1
        for name in (*LENGTHS, "omega0", "m_slider", "mu"):
            at = {**PRESS, "BC": BC}
            near = [at | {name: at[name] * (1 + step)} for step in (1e-6, -1e-6)]
            ahead, behind = (dx.peak("T_in", **LOAD, **one)["value"] for one in near)
            slope = (ahead - behind) / (2e-6 * at[name])
            assert result["gradient"][name] == pytest.approx(slope, rel=1e-6)


def test_nothing_jumps_without_a_jump():
    smooth = {"F_Y": dx.over_Y(POSITIONS, (0.0, -80e3, -80e3))}
    for more in ({}, smooth, {"F_Y": dx.over_theta([0, 2, 4], [1.0, 2.0, 3.0])}):
        result = dx.peak("T_in", **PRESS, **more, BC=np.array([0.3, 0.31]))
        assert result["side"].tolist() == [0, 0]
    assert dx.peak("a_C", **LOAD, **PRESS, BC=0.3)["side"] == 0  # which no force changes
    assert type(dx.peak("T_in", **LOAD, **PRESS, BC=0.3)["side"]) is int


@pytest.mark.thorough
def test_between_two_jumps_a_few_angles_apart():
    """The extremum is on an arc of three doubles: its angle is next to them."""
    draw = Draw(7313969)
    result = dx.peak(draw.name, kind=draw.kind, theta=draw.theta, **draw.given)
    check(draw, result)
    assert draw.top[0].ends[0] - 1e-14 <= result["theta"] <= draw.top[0].ends[1] + 1e-14


def test_at_a_dead_centre_that_is_reached_in_one_double_alone():
    design = {"ec": 0.0, "AB": 0.25, "BC": 0.75, "omega0": 1.0, "m_slider": 1.0}
    for x, force in ((1.0, -500.0), (nextafter(1.0, 2.0), 0.0)):  # at 0 the slider is at 1.0 exactly
        load = dx.over_Y([0.5, x], [0.0, -500.0], kind="step")
        result = dx.peak("F_C_Y", F_Y=load, kind="max", **design)
        alone = dx.peak("F_C_Y", F_Y=0.0, kind="max", **design)["value"]
        at_0 = dx.evaluate("F_C_Y", theta=0.0, F_Y=force, **design)
        assert result["value"] == pytest.approx(max(alone, at_0), rel=1e-14)
        there = dx.evaluate("F_C_Y", theta=result["theta"], F_Y=load, **design)
        assert there == pytest.approx(result["value"], rel=1e-15)


@pytest.mark.parametrize("closed", [False, True])
def test_a_function_of_theta_jumps_on_either_side_of_its_node(closed):
    def force(theta):
        early = theta <= 1.0 if closed else theta < 1.0
        return np.where(early, 100.0 * np.cos(3 * theta), 500.0 * np.cos(theta + 0.1))

    load = dx.over_theta(force, nodes=[0.0, 1.0])
    result = dx.peak("F_C_Y", kind="min", theta=(0.5, 1.5), F_Y=load, ec=0.01, AB=0.04, BC=0.064)
    assert result["value"] == pytest.approx(-500.0 * np.cos(1.1), rel=1e-14)
    assert (result["side"], result["theta"]) == (1, nextafter(1.0, 2.0) if closed else 1.0)
    smooth = dx.peak("F_C_Y", kind="max", theta=(1.0, 4.0), F_Y=load, ec=0.01, AB=0.04, BC=0.064)
    assert smooth["value"] == pytest.approx(500.0, rel=1e-14)
    assert smooth["side"] == 0


@pytest.mark.sampled
def test_beside_a_jump_values_are_those_of_its_side():
    """Where an ulp of the position does not decide, the side is the true one, else it is one of both."""
    draw = random.Random(5)
    for _ in range(cases(50, 500, 5000)):
        AB = draw.uniform(0.01, 0.1)
        design = {
            "ec": draw.choice([0.0, draw.uniform(-0.01, 0.01)]),
            "AB": AB,
            "BC": draw.uniform(0.12, 0.4),
        }
        branch, way = draw.choice([1, -1]), draw.choice([1.0, -1.0])
        closure = closure_of(design, branch)
        at = draw.choice([draw.uniform(1, 14), float(draw.choice(dead_centres(design, 1, 14)))])
        x = float(closure(mpmath.mpf(at))[0])
        values = (1.0, 2.0), (3.0, 4.0)
        load = dx.over_Y([x - 1.0, x], *values, kind="step")
        given = {"F_Y": load, "branch": branch, "omega0": way, **design}
        for away in (0.0, 1e-15, -1e-15, 1e-13, -1e-13, 1e-7, -1e-7):
            Y, slope = closure(mpmath.mpf(at + away))
            right = -values[slope * way < 0][x <= Y]
            sure = abs(Y - x) > 4e-16 * (design["AB"] + design["BC"]) and abs(slope) > 1e-15 * AB
            result = [dx.evaluate("F_C_Y", theta=at + away, **given)]
            result += dx.evaluate("F_C_Y", theta=np.full(3, at + away), **given).tolist()
            allowed = {right} if sure else {-value for both in values for value in both}
            assert set(result) <= allowed


def test_where_no_forces_balance_on_the_other_side():
    design = {"ec": 0.02, "AB": 0.05, "BC": 0.09, "omega0": 1e-3, "mu": 2.0}
    loads = {"F_Y": Stroke((0.05, 0.1, 0.14), (100.0, -100.0, -100.0), None)}
    result = dx.peak("T_in", F_Y=loads["F_Y"].load, **design)
    assert result["value"] == pytest.approx(tops("T_in", "absmax", design, 1, loads, (0.0, 2 * pi))[0].value)
    assert (result["status"], result["side"]) == (5, 1)


# ---- what is made of peaks -------------------------------------------------------------------------


def test_a_reduction_tells_on_which_side_its_sample_is():
    at = dx.peak("T_in", **PRESS, **LOAD, BC=0.3)["theta"]
    theta = np.sort(np.append(np.linspace(0, 2 * pi, 361), [at, nextafter(at, 0)]))
    grid = {"theta": theta, "BC": [0.3, 0.31], **PRESS, **LOAD}
    result = dx.grid(["T_in", "a_C"], **grid, reduce={"theta": ["absmax", "mean"]})
    assert result.T_in_absmax_side.values.tolist() == [1, 0]
    assert result.T_in_absmax_side.dtype == np.int8
    assert result.a_C_absmax_side.values.tolist() == [0, 0]
    assert "T_in_mean_side" not in result
    before = dx.grid("F_C_Y", **grid, reduce={("theta", "BC"): "min"})
    assert before.F_C_Y_min_side == (before.F_C_Y_min_theta == nextafter(at, 0)) * -1
    plain = dx.grid("T_in", **PRESS, BC=[0.3, 0.31], theta=theta, reduce={"theta": "absmax"})
    assert "T_in_absmax_side" not in plain  # numbers do not jump


def test_tolerance_samples_the_truth():
    sizes = {**PRESS, **LOAD, "BC": dx.plus_minus(0.3, 3e-6)}
    result = dx.tolerance(("absmax", "T_in"), **sizes, samples=40)
    slope = dx.peak("T_in", **PRESS, **LOAD, BC=0.3)["gradient"]["BC"]
    assert result["first_order"]["std"] == pytest.approx(slope * 1e-6, rel=1e-9)
    assert result["monte_carlo"]["std"] == pytest.approx(slope * 1e-6, rel=0.5)
    assert result["monte_carlo"]["largest"] - result["monte_carlo"]["least"] < 8e-6 * slope


@pytest.mark.thorough
def test_optimize_finds_the_least_of_the_truth():
    best = dx.optimize(minimize=("absmax", "T_in"), over={"BC": (0.2999, 0.3001)}, starts=1, **PRESS, **LOAD)
    assert best["value"] == pytest.approx(press_peak(best["BC"]), rel=1e-9)
    assert best["value"] <= min(press_peak(BC) for BC in (0.2999, 0.3, 0.3001)) * (1 + 1e-9)


@pytest.mark.thorough
def test_run_tells_the_side(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = ", ".join(f"[{x!r}, {out}, 0]" for x, out in zip(POSITIONS, (0, -80e3, -80e3), strict=True))
    (tmp_path / "press.toml").write_text(
        f"""
        [mechanism]
        ec = 0.015
        AB = 0.075
        BC = [0.3, 0.299999]
        [motion]
        omega0 = {2 * pi!r}
        [masses]
        m_slider = 120
        [loads]
        mu = 0.08
        F_Y = {{ over_Y = [{rows}], kind = "step" }}
        [[peak]]
        quantity = "T_in"
        over = {{ BC = [0.3, 0.299999] }}
        """
    )
    run = dx.scene("press.toml").run()
    result = run.peaks[0].dataset
    np.testing.assert_allclose(result["value"], [press_peak(0.3), press_peak()], rtol=1e-12)
    assert result["side"].values.tolist() == [1, 1]
    assert "side" in run.report()


@pytest.mark.thorough
@pytest.mark.parametrize("way", [1, -1])
def test_drive_has_the_gradient_at_a_jump(way):
    machine = {**PRESS, **LOAD, "BC": 0.299999, "omega0": way * 2 * pi}
    result = dx.drive(**machine)
    peak = dx.peak("T_in", **machine, theta=(0.0, 2 * pi) if way > 0 else (-2 * pi, 0.0))
    assert result["torque_peak"] == pytest.approx(peak["value"], rel=1e-12)
    for name in ("AB", "mu", "omega0"):
        near = [machine | {name: machine[name] * (1 + step)} for step in (1e-6, -1e-6)]
        ahead, behind = (dx.drive(**one) for one in near)
        for figure in ("torque_peak", "power_peak", "starting_torque"):
            slope = (ahead[figure] - behind[figure]) / (2e-6 * machine[name])
            assert result["gradient"][figure][name] == pytest.approx(slope, rel=1e-6, abs=1e-6)


@pytest.mark.thorough
def test_curves_reach_the_peak():
    pytest.importorskip("matplotlib")
    theta = np.linspace(0, 2 * pi, 361)
    dataset = dx.grid(["T_in", "N_C"], theta=theta, BC=[0.3, 0.299999], **PRESS, **LOAD)
    assert np.abs(dataset.T_in).max() < 2_960
    lines = dx.plot.curves(dataset, "T_in")
    tops_of = [np.abs(line.get_ydata()).max() for line in lines]
    np.testing.assert_allclose(tops_of, [press_peak(0.3), press_peak()], rtol=1e-10)
    assert len(lines[0].get_xdata()) > 361
    values = dx.evaluate(["T_in"], theta=theta, BC=0.3, **PRESS, **LOAD)
    assert np.abs(dx.plot.curves(values, "T_in")[0].get_ydata()).max() == pytest.approx(press_peak(0.3))
    smooth = dx.grid("T_in", theta=theta, BC=0.3, **PRESS)
    assert len(dx.plot.curves(smooth, "T_in")[0].get_xdata()) == 361
    own = {"ec": "15 mm", "AB": "75 mm", "BC": "300 mm", "omega0": "60 rpm", "m_slider": "120 kg", "mu": 0.08}
    positions = [1e3 * Y for Y in POSITIONS]
    force = dx.Machine(**own, units="mm, N*mm, deg, rpm").over_Y(
        positions, kind="step", outward=[0.0, -80e3, -80e3], inward=[0.0] * 3
    )
    machine = dx.Machine(**own, F_Y=force, units="mm, N*mm, deg, rpm")
    assert np.abs(machine.plot("T_in")[0].get_ydata()).max() == pytest.approx(1e3 * press_peak(0.3))
    course = dx.drive(**PRESS, **LOAD, BC=0.3).course
    assert np.abs(course["T_in"]).max() == pytest.approx(press_peak(0.3))


# Expression, kind of its extreme value, what is 0 there and the limit, in the names of `_motion`.
OF_CONDITIONS = {
    "jump of a torque": ("where(T_in > t0, power_in, -power_in)", "min", "T - 30", "-T * w"),
    "jump of a speed": ("where(a_C > a0, V_C, 0 * V_C)", "max", "A - 500", "V"),
    "jump within a jump": ("where(a_C > a0, where(T_in < t0, V_C / 2, V_C), 0 * V_C)", "max", "A - 500", "V"),
    "kink of magnitudes": ("max(abs(V_C), abs(2 * V_B_Y))", "min", "V*V - 4*B*B", "sqrt(V * V)"),
}


def _motion(theta, ec, AB, BC, omega0, m_slider):
    """T_in, V_C, a_C and V_B_Y of a slider alone, by its free body, with 40 digits."""
    u, bend = ec + AB * mp.sin(theta), -AB * mp.sin(theta)
    slope, S = AB * mp.cos(theta), mp.sqrt(BC**2 - u**2)
    Y1 = bend - u * slope / S
    Y2 = -slope - (slope**2 + u * bend) / S - (u * slope) ** 2 / S**3
    V, A = omega0 * Y1, omega0**2 * Y2
    return {"T": m_slider * A * Y1, "V": V, "A": A, "B": omega0 * bend, "w": omega0, "sqrt": mp.sqrt}


@pytest.mark.parametrize("name", OF_CONDITIONS)
def test_extremes_where_a_condition_of_a_user_defined_quantity_changes(name):
    expression, kind, condition, limit = OF_CONDITIONS[name]
    constants = {"t0": "30 N m", "a0": "500 m/s^2"}
    constants = {n: v for n, v in constants.items() if n in expression}
    design = {"ec": 0.02, "AB": 0.125, "BC": 0.35, "omega0": 150.0, "m_slider": 0.8}
    dx.define("rig", expression, **constants)
    try:
        result = dx.peak("rig", kind=kind, **design)
        both = dx.peak("rig", kind=kind, **{**design, "ec": [0.03, 0.02]})
        theta = np.linspace(0.0, 2 * np.pi, 200_001)
        sampled = dx.evaluate("rig", theta=theta, **design)
        sides = dx.evaluate("rig", theta=result["theta"] + np.array([-1e-7, 1e-7]), **design)
    finally:
        dx.undefine("rig")
    with mp.workdps(40):

        def at(**inputs):
            inputs = {n: mp.mpf(v) for n, v in {**design, **inputs}.items()}
            root = mp.findroot(lambda t: eval(condition, _motion(t, **inputs)), mp.mpf(result["theta"]))
            return root, eval(limit, _motion(root, **inputs))

        angle, value = at()
        step = mp.mpf(10) ** -15
        slopes = {
            p: (at(**{p: design[p] + step})[1] - at(**{p: design[p] - step})[1]) / (2 * step) for p in design
        }
        assert abs(result["theta"] - angle) < 1e-14
        assert result["value"] == pytest.approx(float(value), rel=1e-13)
        for p, slope in slopes.items():
            scale = float(abs(value)) / design[p]
            assert result["gradient"].get(p, 0.0) == pytest.approx(
                float(slope), rel=1e-10, abs=1e-11 * scale
            ), p
    assert result["status"] == 0
    assert result["value"] <= sampled.min() if kind == "min" else result["value"] >= sampled.max()
    if name.startswith("jump"):
        assert sides[(result["side"] + 1) // 2] == pytest.approx(result["value"], rel=1e-4)
        assert sides[(1 - result["side"]) // 2] != pytest.approx(result["value"], rel=0.1)
    else:
        assert result["side"] == 0
    assert both["value"][1] == result["value"]
