"""Every public call under every kind of load: the truth of pieces of forces, or a refusal that says what can.

One table: each call x (number, over_theta, over_Y, over_stroke, function) x (smooth, kinked, jumping), and
each call x (spring, damper, over_V, functions of Y and V_C, sums), on random machines, forwards and
backwards, on both branches.
"""

import random

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

import desaxe as dx
from desaxe.loads.along_motion import OfMotion
from desaxe.loads.function import FunctionOverTheta
from tests.compiler.languages.tools import imported
from tests.effort import cases
from tests.loads.truth import DIGITS, FOLLOWING, LENGTHS, PLACES, SHAPES, TURN, Truth, drawn, given, slider

LOADS = [("number", "smooth"), *((place, shape) for place in PLACES for shape in SHAPES)]
LOADS += [(place, "moving") for place in FOLLOWING]
# Calls that compile or search: default and thorough runs take some of these loads, or the first one where
# that takes seconds, and DESAXE_THOROUGH=all the whole table.
SOME = [("over_stroke", "jumping"), ("over_theta", "smooth"), ("over_Y", "kinked"), ("function", "jumping")]
SOME += [("sum", "moving")]
FAST = {"rel": 1e-11, "abs": 1e-10}  # values at a point
SUMS = {"rel": 1e-9, "abs": 1e-9}


def without(inputs, *names):
    return {name: value for name, value in inputs.items() if name not in names}


def offsets_of(truth, count=3):
    """Other designs that turn: by offsets."""
    return np.linspace(0.0, 0.9, count) * truth.design["ec"]


def at(truth, ec):
    return truth._replace(design={**truth.design, "ec": float(ec)})


def angles_of(truth, draw, count=5):
    """Angles well inside of an arc of the force."""
    ends = [(a, b) for a, b, _ in truth.arcs() if b - a > 1e-3]
    return np.array(
        [a + draw.uniform(0.1, 0.9) * (b - a) for a, b in (draw.choice(ends) for _ in range(count))]
    )


def near(result, right, **room):
    assert np.shape(result) == np.shape(right)
    assert np.ravel(result).tolist() == pytest.approx(np.ravel(right).tolist(), **room)


# ---- values --------------------------------------------------------------------------------------------


def evaluate(truth, draw, folder):
    theta = draw.uniform(-9.0, 9.0)
    by = ("theta", *LENGTHS, "omega0", "m_slider")
    result = dx.evaluate(["T_in", *(f"T_in_wrt_{p}" for p in by)], theta=theta, **given(truth))
    scale = abs(truth.torque(theta)) + 1e-3
    assert result["T_in"] == pytest.approx(truth.torque(theta), rel=1e-11, abs=1e-12 * scale)
    for p in by:
        right = float(truth.by(p, theta))
        assert result[f"T_in_wrt_{p}"] == pytest.approx(right, rel=1e-10, abs=1e-10 * scale), p
    several = np.array([theta, theta + 1.0])
    near(dx.evaluate("T_in", theta=several, **given(truth)), [truth.torque(t) for t in several], **FAST)


def quality(truth, draw, folder):
    """The error is within its bound, next to ends of the pieces too; conditions are of total derivatives."""
    a, b, piece = draw.choice(truth.arcs())
    theta = draw.choice([a + 10 ** draw.uniform(-12, -3), b - 10 ** draw.uniform(-12, -3), 0.5 * (a + b)])
    inputs = {**given(truth), "theta": theta}
    if is_function(truth):
        with pytest.raises(
            TypeError, match=r"F_Y: quality=True takes numbers and tables.* F_Y = load\(theta\)"
        ):
            dx.evaluate("T_in", quality=True, **inputs)
        return
    result = dx.evaluate("T_in", quality=True, **inputs)
    with mp.workdps(DIGITS):
        exact = truth._replace(design={n: mpf(v) for n, v in truth.design.items()})
        right = exact.torque(mpf(theta), piece)
        assert abs(result.value - right) <= result.error_bound <= 1e-8 * abs(right) + 1e-11
    near(np.array([result.error_bound, result.value]).T, [result.error_bound, dx.evaluate("T_in", **inputs)])
    for p in ("theta", *LENGTHS, "m_slider"):
        slope = abs(float(truth.by(p, theta)) * inputs[p] / result.value)
        room = 1e-6 + result.error_bound / abs(result.value)  # next to a dead centre the torque is rounding
        assert result.conditions[p] == pytest.approx(slope, rel=room, abs=1e-6), p
    several = dx.evaluate("T_in", quality=True, **{**inputs, "theta": np.array([theta, theta + TURN])})
    assert several.error_bound[0] == pytest.approx(result.error_bound, rel=1e-6)


def grids(truth, draw, folder):
    theta, ecs = angles_of(truth, draw), offsets_of(truth)
    inputs = {"theta": theta, **given(truth), "ec": ecs}
    right = np.array([[at(truth, ec).torque(float(t)) for ec in ecs] for t in theta])
    near(dx.grid("T_in", **inputs).T_in, right, **FAST)
    near(dx.grid("T_in", chunks={"theta": 2}, **inputs).T_in, right, **FAST)
    reduced = dx.grid("T_in", reduce={"theta": ["rms", "absmax"]}, **inputs)
    near(reduced.T_in_rms, np.sqrt(np.mean(right**2, axis=0)), **FAST)
    near(reduced.T_in_absmax, np.abs(right).max(axis=0), **FAST)
    near(dx.sweep("T_in", store=folder / "points.zarr", **inputs).T_in, right, **FAST)
    shaken = [[at(truth, ec).shaking(float(t)) for ec in ecs] for t in theta]
    near(dx.grid("F_shaking_Y", **inputs).F_shaking_Y, shaken, **FAST)


def a_scene(truth, draw, folder):
    theta = np.sort(angles_of(truth, draw))
    run = scene_of(truth, theta).run().dataset
    right = [truth.torque(float(t)) for t in theta]
    near(run.T_in, right, **FAST)
    near(run.T_in_wrt_AB, [float(truth.by("AB", float(t))) for t in theta], rel=1e-9, abs=1e-7)
    assert "F_Y" in str(dx.explain(scene_of(truth, theta)))
    line = dx.plot.curves(run, "T_in")[0]
    drawn_at = np.searchsorted(line.get_xdata(), np.degrees(theta) - 1e-9)
    near(line.get_ydata()[drawn_at], run.T_in, **FAST)  # between them nodes of jumps


def scene_of(truth, theta):
    return dx.scene({
        "outputs": ["T_in", "T_in_wrt_AB"],
        "mechanism": {**{n: truth.design[n] for n in LENGTHS}, "branch": truth.branch},
        "motion": {"omega0": truth.design["omega0"], "theta": theta.tolist()},
        "masses": {"m_slider": truth.design["m_slider"]},
        "loads": {"F_Y": truth.force.load},
    })  # fmt: skip


# ---- over a turn -----------------------------------------------------------------------------------------


def rms_of(truth):
    return np.sqrt(truth.mean(power=2))


def peak(truth, draw, folder):
    one = dx.peak("T_in", **given(truth))
    assert one["value"] == pytest.approx(truth.largest(), rel=1e-9)
    several = dx.peak("T_in", **{**given(truth), "ec": offsets_of(truth)})
    near(several["value"], [at(truth, ec).largest() for ec in offsets_of(truth)], rel=1e-9)
    for p in LENGTHS:
        slopes = [truth.moved(Truth.largest, p, h) for h in (1e-6, 1e-7)]
        if slopes[0] == pytest.approx(slopes[1], rel=1e-4):  # else another peak is as large
            room = 1e-6 * one["value"] / truth.design["AB"]
            assert one["gradient"][p] == pytest.approx(slopes[0], rel=1e-4, abs=room), p


def turns(truth, draw, folder):
    inputs = given(truth)
    mean, rms = truth.mean(), rms_of(truth)
    room = {"rel": 1e-9, "abs": 1e-10 * rms}
    motor = dx.drive(fluctuation=0.1, **inputs)
    assert motor["torque_mean"] == pytest.approx(mean, **room)
    assert motor["torque_rms"] == pytest.approx(rms, rel=1e-9)
    assert motor["torque_peak"] == pytest.approx(truth.largest(), rel=1e-9)
    series = dx.harmonics("T_in", orders=3, **inputs)
    wave = truth.wave(3)
    near([series["mean"], series["cos"][3], series["sin"][3]], [mean, wave.real, -wave.imag], **room)
    balance = dx.counterweight(loads=True, **inputs)
    assert balance["before"]["largest"] == pytest.approx(abs(truth.wave(1, "shaking")), rel=1e-9)
    assert balance["before"]["peak"] == pytest.approx(truth.largest("shaking"), rel=1e-9)


def design_map(truth, draw, folder):
    ecs, angle = offsets_of(truth), float(angles_of(truth, draw, 1)[0])
    names = [("rms", "T_in"), ("mean", "F_shaking_Y"), ("absmax", "T_in"), ("at", angle, "T_in"), "stroke"]
    result = dx.design_map(names, derivatives=True, **{**given(truth), "ec": ecs})
    designs = [at(truth, ec) for ec in ecs]
    near(result.rms_T_in, [rms_of(t) for t in designs], **SUMS)
    near(result.mean_F_shaking_Y, [t.mean("shaking") for t in designs], **SUMS)
    near(result.absmax_T_in, [t.largest() for t in designs], **SUMS)
    near(result[f"at_{angle}_T_in"], [t.torque(angle) for t in designs], **FAST)
    slope = designs[1].moved(rms_of, "ec", 1e-5)
    near(result.rms_T_in_wrt_ec[1], slope, rel=1e-5, abs=1e-5 * rms_of(designs[1]) / truth.design["AB"])


def tolerance(truth, draw, folder):
    theta = float(angles_of(truth, draw, 1)[0])
    near_AB = dx.plus_minus(truth.design["AB"], 1e-9)
    inputs = {**given(truth), "AB": near_AB}
    result = dx.tolerance("T_in", samples=16, theta=theta, **inputs)
    assert result["gradient"]["AB"] == pytest.approx(float(truth.by("AB", theta)), rel=1e-8)
    assert result["first_order"]["mean"] == pytest.approx(truth.torque(theta), rel=1e-9, abs=1e-12)


def tolerance_of_a_peak(truth, draw, folder):
    inputs = {**given(truth), "AB": dx.plus_minus(truth.design["AB"], 1e-9)}
    result = dx.tolerance(("absmax", "T_in"), samples=16, **inputs)
    assert result["value"] == pytest.approx(truth.largest(), rel=1e-9)
    assert result["gradient"]["AB"] == pytest.approx(
        dx.peak("T_in", **given(truth))["gradient"]["AB"], rel=1e-9
    )


def optimize(truth, draw, folder):
    ends = sorted((0.0, 0.9 * truth.design["ec"]))
    fixed = without(given(truth), "ec")
    kind, figure = draw.choice([("rms", rms_of), ("absmax", Truth.largest)])
    best = dx.optimize(minimize=(kind, "T_in"), over={"ec": ends}, starts=1, **fixed)
    assert best["value"] == pytest.approx(figure(at(truth, best["ec"])), rel=1e-8)
    assert best["value"] <= min(figure(at(truth, ec)) for ec in np.linspace(*ends, 4)) * (1 + 1e-9)


def fit(truth, draw, folder):
    theta = np.sort(angles_of(truth, draw, 12))
    data = {"theta": theta, "T_in": [truth.torque(float(t)) for t in theta]}
    m = truth.design["m_slider"]
    result = dx.fit(data, over={"m_slider": (0.5 * m, 2.0 * m)}, **without(given(truth), "m_slider"))
    assert result["value"]["m_slider"] == pytest.approx(m, rel=1e-6)


# ---- motions ---------------------------------------------------------------------------------------------


def energy(truth, inertia, theta, omega):
    """The kinetic energy of crank and slider."""
    slope = slider(theta, truth.design, truth.branch)[1]
    return 0.5 * (inertia + truth.design["m_slider"] * slope**2) * omega**2


def simulate(truth, draw, folder):
    way = np.sign(truth.design["omega0"])
    inputs = without(given(truth), "omega0") | {"I_crank": 0.05, "theta0": 0.4}
    torque, speeds = 3.0 * way, 60.0 * way * np.array([1.0, 1.2])
    if truth.force.place in FOLLOWING:
        motion_by_scipy(truth, inputs, torque, speeds)
        return
    one = dx.simulate(torque=torque, t_end=0.3, omega_start=speeds[0], **inputs)
    several = dx.simulate(torque=torque, t_end=0.3, omega_start=speeds, **inputs)
    runs = [(one["theta"], one["omega"], speeds[0])]
    runs += [*zip(several["theta"], several["omega"], speeds, strict=True)]
    for angles, rates, start in runs:
        if np.min(way * rates) <= 0.0:
            continue  # it has stopped, or turns back under the load of the other way
        theta, omega = angles[-1], rates[-1]
        low, high = sorted((0.4, float(theta)))
        gained = torque * (theta - 0.4) + np.sign(theta - 0.4) * truth.work(low, high)
        right = energy(truth, 0.05, 0.4, start) + gained
        assert energy(truth, 0.05, theta, omega) == pytest.approx(right, rel=1e-7)


def motion_by_scipy(truth, inputs, torque, speeds):
    m = truth.design["m_slider"]

    def rate(t, state):
        theta, omega = state
        _, slope, bend = slider(theta, truth.design, truth.branch)
        push = torque + truth.load(theta, omega=omega) * slope - m * slope * bend * omega**2
        return omega, push / (0.05 + m * slope**2)

    several = dx.simulate(torque=torque, t_end=0.3, omega_start=speeds, **inputs)
    for row, start in enumerate(speeds):
        one = dx.simulate(torque=torque, t_end=0.3, omega_start=start, **inputs)
        right = solve_ivp(rate, (0.0, 0.3), (0.4, start), method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
        for result in (one["theta"], several["theta"][row]):
            assert result[-1] == pytest.approx(right[0], rel=1e-7)
        assert one["omega"][-1] == pytest.approx(right[1], rel=1e-6, abs=1e-5)


def steady(truth, draw, folder):
    """After a turn of its own equation of motion it is as fast as at its beginning."""
    truth = truth._replace(design={**truth.design, "omega0": abs(truth.design["omega0"])})
    motor = dx.over_omega([0.0, 300.0], [120.0, -330.0])
    inputs = without(given(truth), "omega0") | {"I_crank": 0.2}
    result = dx.steady(torque=motor, **inputs)
    start = speed = float(result["omega"][0])
    for a, b, piece in truth.arcs():

        def rate(theta, state, piece=piece):
            _, slope, bend = slider(theta, truth.design, truth.branch)
            m, omega = truth.design["m_slider"], state[0]
            drive = 120.0 - 1.5 * omega + truth.load(theta, piece, omega) * slope
            return [(drive - m * slope * bend * omega**2) / (0.2 + m * slope**2) / omega]

        solved = solve_ivp(rate, (a, b), [speed], method="DOP853", rtol=1e-11, atol=1e-11)
        speed = solved.y[0, -1]
    assert speed == pytest.approx(start, rel=1e-7)
    assert result["status"] == 0


# ---- machines, files, modules, and what takes no load ------------------------------------------------------


def is_function(truth):
    return isinstance(truth.force.load, (FunctionOverTheta, OfMotion))


def machine_and_its_files(truth, draw, folder):
    inputs = given(truth)
    machine = dx.Machine(**inputs)
    theta = angles_of(truth, draw, 3)
    right = [truth.torque(float(t)) for t in theta]
    near(machine.evaluate("T_in", theta=theta), right, **FAST)
    assert machine.peak("T_in")["value"] == pytest.approx(truth.largest(), rel=1e-9)
    machine.report(folder / "report.html")
    if is_function(truth) and truth.force.place not in ("spring", "damper", "over_V"):
        with pytest.raises(TypeError, match=r"F_Y: .* cannot stand in a scene file"):
            machine.to_scene(folder / "press.toml")
        return
    machine.to_scene(folder / "press.toml")
    again = dx.Machine.read(folder / "press.toml")
    near(again.evaluate("T_in", theta=theta), right, **FAST)
    if callable(truth.force.load):
        assert again["F_Y"] == truth.force.load


def compiled_module(truth, draw, folder):
    theta = angles_of(truth, draw, 3)
    scene = scene_of(truth, np.sort(theta))
    name = f"press_{draw.randrange(10**9)}"
    if is_function(truth) and truth.force.place not in ("spring", "damper", "over_V", "sum"):
        with pytest.raises(ValueError, match="a compiled module holds tables"):
            dx.compile(scene, folder / f"{name}.py")
        return
    dx.compile(scene, folder / f"{name}.py")
    module = imported(folder / f"{name}.py")
    right = [truth.torque(float(t)) for t in np.sort(theta)]
    near(module.evaluate(theta=np.sort(theta))["T_in"], right, **FAST)
    near(module.run()["T_in"], right, **FAST)


def calls_without_loads(truth, draw, folder):
    """Calls of the motion alone are as without the load; others refuse it by name, with what can."""
    inputs, load = given(truth), truth.force.load
    lengths = {n: truth.design[n] for n in LENGTHS} | {"branch": truth.branch}
    assert dict(dx.events(**inputs)) == dict(dx.events(**lengths, omega0=truth.design["omega0"]))
    machine = dx.Machine(**inputs)
    assert repr(machine.events()) == repr(dx.events(**machine)) == repr(dx.events(**inputs))
    only = without(lengths, "branch")
    assert machine.feasibility() == dx.feasibility(**only)
    assert dx.feasibility(F_Y=load, **only) == dx.feasibility(**only)
    Y = slider(1.0, truth.design, truth.branch)[0]
    near(dx.inverse(Y=Y, F_Y=load, **lengths)["theta"], dx.inverse(Y=Y, **lengths)["theta"], **FAST)
    expected = {"stroke": 0.1, "time_ratio": 1.1, "BC": 0.2}
    assert repr(dx.synthesize(**expected, F_Y=load)) == repr(dx.synthesize(**expected))
    if not callable(load):
        return
    with pytest.raises(TypeError, match=r"F_Y: function takes numbers, not a load .* load\(theta\)"):
        dx.function("T_in", **inputs)
    with pytest.raises(TypeError, match=r"F_Y: enclose takes numbers, not a load .*dx.between\(low, high\)"):
        dx.enclose("T_in", theta=(1.0, 1.1), **inputs)


CALLS = [evaluate, quality, peak, turns, tolerance, fit, calls_without_loads]
SHORT = [a_scene, simulate, steady, compiled_module]
LONG = [*SHORT, grids, design_map, tolerance_of_a_peak, optimize, machine_and_its_files]


def cells():
    """The table."""
    for call in (*CALLS, *LONG):
        for load in LOADS:
            thorough = load == SOME[0] or (call in SHORT and load in SOME)
            expected = call in CALLS or thorough or cases(0, 0, 1)
            default = call in CALLS or (call in SHORT and load == SOME[0])
            marks = [] if default else [pytest.mark.thorough]
            if expected:
                yield pytest.param(call, *load, marks=marks, id=f"{call.__name__}-{'-'.join(load)}")


@pytest.mark.parametrize(("call", "place", "shape"), [*cells()])
def test_every_call_has_the_truth_of_its_load_or_refuses_it(call, place, shape, tmp_path):
    draw = random.Random(f"{call.__name__} {place} {shape}")
    call(drawn(place, shape, draw), draw, tmp_path)
