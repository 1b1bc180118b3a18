"""FMUs with loads of every kind: their motion beside `simulate`, kinks as events, partial derivatives."""

import ctypes

import mpmath
import numpy as np
import pytest
from scipy.integrate import DOP853
from scipy.optimize import brentq

import desaxe as dx
from desaxe.oracle.force_truth import truth as force_truth
from desaxe.oracle.truth import truth
from tests.effort import cases
from tests.scenes.export import test_fmu
from tests.scenes.export.test_fmu import LENGTHS, MASSES, Instance, content, simulated, started, validate

pytest.importorskip("fmpy")

OUTPUTS = ["V_C", "a_C", "T_in", "N_C", "kinetic_energy"]
TURN = [[0.4, -5], [1.0, -40], [2.0, 10], [4.0, 0]]
STROKE = [[0.08, 0, 9], [0.1, -60, 20], [0.13, -5, 0]]
NEAR = [[0.0, -30, 5], [0.02, -60, 20], [0.03, 0, 0]]
ONE_WAY = [row[:2] for row in STROKE]
LOADS = {
    "step": {"over_theta": TURN, "kind": "step"},
    "linear": {"over_theta": TURN, "kind": "linear"},
    "cubic": {"over_theta": TURN, "kind": "cubic"},
    "over Y": {"over_Y": ONE_WAY, "kind": "linear"},
    "both ways": {"over_Y": STROKE, "kind": "linear"},
    "steps over Y": {"over_Y": ONE_WAY, "kind": "step"},
    "outer": {"over_stroke": NEAR, "kind": "linear", "dead_centre": "outer"},
    "inner": {"over_stroke": [row[:2] for row in NEAR], "kind": "linear", "dead_centre": "inner"},
    "spring": dx.spring(800.0, free=0.1),
    "damper": dx.damper(9.0, 4.0),
    "over V": dx.over_V([-1.0, -0.3, 0.0, 0.2, 0.5], [30.0, 20.0, 0.0, -10.0, -40.0]),
    "sum": 2.0 * dx.spring(800.0, free=0.1) + dx.damper(20.0, 1.0) + dx.over_theta(*zip(*TURN, strict=True),
                                                                                  kind="linear") + 3.0,
    "less": dx.over_stroke([0.0, 0.03], [-60.0, 0.0], dead_centre="outer") - dx.damper(2.0),
}  # fmt: skip


def load_of(name):
    """A load of `LOADS` as a call takes it."""
    if isinstance(LOADS[name], dx.loads.Load):
        return LOADS[name]
    given = dict(LOADS[name])
    options = {key: given.pop(key) for key in ("kind", "dead_centre") if key in given}
    ((over, rows),) = given.items()
    x, y, *inward = np.array(rows).T.tolist()
    if over == "over_theta":
        return dx.over_theta(x, y, **options)
    return getattr(dx, over)(x, y, **options, **({"inward": inward[0]} if inward else {}))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Name of a load -> an FMU with it."""
    folder = tmp_path_factory.mktemp("loads")

    def one(name, **options):
        place = folder / f"{name} {options}" / "press.fmu"
        if not place.exists():
            place.parent.mkdir()
            scene = content(outputs=[*OUTPUTS, "status"], loads={"g_Y": -9.81, "F_Y": LOADS[name]})
            dx.compile(scene, place, to="fmu", **options)
        return str(place)

    return one


def moved(name, torque, omega, t_end, **more):
    return dx.simulate(
        torque=torque, t_end=t_end, theta0=0.3, omega_start=omega, **LENGTHS, **MASSES, g_Y=-9.81,
        F_Y=load_of(name), rtol=1e-12, **more,
    )  # fmt: skip


FIRST = ("cubic", "both ways", "inner", "sum")  # gcc compiles a model of each


@pytest.mark.parametrize(
    ("name", "torque", "omega"),
    [
        pytest.param(name, *start, marks=() if name in FIRST and start[0] > 0.0 else pytest.mark.thorough)
        for name in LOADS
        for start in ((1.5, 5.0), (-3.0, 6.0))
    ],
)
def test_co_simulation_is_exact_across_kinks(name, torque, omega, made):
    """Over many turns, forwards, and backwards from a start that turns forwards."""
    start = {"torque": torque, "omega_start": omega}
    result = simulated(made(name), "CoSimulation", 0.4, 0.02, ["theta", "omega"], **start)
    expected = moved(name, torque, omega, 0.4, times=result["time"])
    assert abs(expected["theta"][-1]) > (10 if load_of(name).follows_speed else 30)
    for each in ("theta", "omega"):
        scale = np.abs(expected[each]).max()
        np.testing.assert_allclose(result[each], expected[each], rtol=0, atol=1e-8 * scale, err_msg=each)


def follow(place, start, t_end):
    """Model exchange by a method of order 8, events located to the last digit; states, number of events."""
    one = Instance(place, start=start).start()
    count = one.about.numberOfEventIndicators
    buffer, zeros, slopes = ((ctypes.c_double * n)() for n in (2, count, 2))
    fmu, events, y, t = one.fmu, 0, np.array(one.get("theta", "omega")), 0.0

    def put(t, y):
        buffer[:] = y
        fmu.setTime(t)
        fmu.setContinuousStates(buffer, 2)

    def rates(t, y):
        put(t, y)
        fmu.getDerivatives(slopes, 2)
        return np.array(slopes)

    def indicators(t, y):
        put(t, y)
        fmu.getEventIndicators(zeros, count)
        return np.array(zeros)

    while t < t_end:
        solver = DOP853(rates, t, y, t_end, rtol=1e-11, atol=1e-13)
        crossed = []
        while solver.status == "running" and not crossed:
            solver.step()
            crossed = [k for k, z in enumerate(indicators(solver.t, solver.y)) if z < 0.0]
        t, y = solver.t, solver.y
        if crossed:
            path = solver.dense_output()
            begin = max(solver.t_old, 1e-15)
            ends = [
                brentq(lambda t, k=k, path=path: indicators(t, path(t))[k], begin, t, xtol=1e-15)
                if indicators(begin, path(begin))[k] > 0.0 else begin
                for k in crossed
            ]  # fmt: skip
            t = min(ends) + 1e-14
            again = DOP853(rates, solver.t_old, path(solver.t_old), t, rtol=1e-12, atol=1e-14)
            while again.status == "running":
                again.step()
            put(t, again.y)
            events += 1
            fmu.enterEventMode()
            fmu.newDiscreteStates()
            fmu.enterContinuousTimeMode()
            y = np.array(one.get("theta", "omega"))
    put(t, y)
    result = one.get("theta", "omega", *OUTPUTS)
    one.close()
    return dict(zip(("theta", "omega", *OUTPUTS), result, strict=True)), events


@pytest.mark.parametrize("name", ["sum", "both ways"])
def test_kinks_are_events_of_model_exchange(name, made):
    """To 1e-8 beside `simulate`, over as many kinks as the crank passes."""
    result, events = follow(made(name), {"torque": 1.5, "omega_start": 5.0}, 0.1)
    expected = moved(name, 1.5, 5.0, 0.1, times=[0.1], names=OUTPUTS)
    for each in ("theta", "omega", *OUTPUTS):
        assert result[each] == pytest.approx(expected[each][-1], rel=1e-8), each
    turns = (result["theta"] - 0.3) / (2 * np.pi)
    kinks = 4 if name == "sum" else 6 + 2  # on the way out and in; dead centres
    assert kinks * (turns - 1) < events <= kinks * (turns + 1)


def test_model_exchange_without_tables_over_a_long_run(tmp_path):
    """The model is exact: what an importer's method errs by is its own."""
    place = dx.compile(content(outputs=OUTPUTS), tmp_path / "press.fmu", to="fmu")
    result, events = follow(str(place), {"torque": 0.0, "omega_start": 30.0}, 2.0)
    expected = dx.simulate(
        torque=0.0, t_end=2.0, theta0=0.3, omega_start=30.0, times=[2.0], names=OUTPUTS, rtol=1e-12,
        **LENGTHS, **MASSES, **test_fmu.LOADS,
    )  # fmt: skip
    assert events == 0
    assert result["theta"] > 70
    for each in ("theta", "omega", *OUTPUTS):
        assert result[each] == pytest.approx(expected[each][-1], rel=1e-8), each


@pytest.mark.thorough
def test_loads_along_both_axes_with_friction(tmp_path):
    """Co-simulation and model exchange to 1e-8 beside `simulate`."""
    loads = {
        "F_X": dx.spring(300.0, free=0.1) - LOADS["over V"],
        "F_Y": LOADS["damper"] + dx.over_Y([0.08, 0.1, 0.13], [-6.0, -3.0, -1.0], [0.0, 9.0, 2.0]),
    }
    scene = content(outputs=OUTPUTS, loads={"g_Y": -9.81, "mu": 0.1, **loads})
    place = str(dx.compile(scene, tmp_path / "press.fmu", to="fmu"))
    start = {"torque": 1.5, "omega_start": 5.0}
    result = simulated(place, "CoSimulation", 0.1, 0.02, ["theta", "omega", *OUTPUTS], **start)
    expected = dx.simulate(
        torque=1.5, t_end=0.1, theta0=0.3, omega_start=5.0, times=result["time"], names=OUTPUTS, rtol=1e-12,
        **LENGTHS, **MASSES, g_Y=-9.81, mu=0.1, **loads,
    )  # fmt: skip
    last, _ = follow(place, start, 0.1)
    for each in ("theta", "omega", *OUTPUTS):
        scale = np.abs(expected[each]).max()
        np.testing.assert_allclose(result[each], expected[each], rtol=0, atol=1e-8 * scale, err_msg=each)
        assert last[each] == pytest.approx(expected[each][-1], abs=1e-8 * scale), each


@pytest.mark.parametrize("name", ["sum", pytest.param("over Y", marks=pytest.mark.thorough)])
def test_a_given_speed_has_the_load_of_the_angle(name, made):
    place, names = made(name, input="omega"), ["theta", "T_in", "N_C"]
    result = simulated(place, "CoSimulation", 2.0, 0.05, names, omega=7.0, theta0=0.1)
    given = {**LENGTHS, **MASSES, "g_Y": -9.81, "F_Y": load_of(name)}
    expected = dx.evaluate(["T_in", "N_C"], theta=result["theta"], omega=7.0, alpha=0.0, **given)
    for each in ("T_in", "N_C"):
        np.testing.assert_allclose(result[each], expected[each], rtol=1e-10, atol=1e-10)


# ---- partial derivatives --------------------------------------------------------------------------


def on_table(table, x):
    """A table at a number of many digits."""
    x = mpmath.mpf(x) + (table.period if table.period and x < table.knots[0] else 0)
    piece = table.piece(float(x))
    s, (a, b, c, d) = x - mpmath.mpf(table.origin(piece)), map(mpmath.mpf, table.rows[piece])
    return a + s * (b + s * (c + s * d))


def force_at(name, theta, omega, **lengths):
    """The force of a load at an angle, from the slider's true position and speed."""
    Y, V = (truth(column, theta=theta, omega=omega, alpha=0.0, **lengths) for column in ("Y", "V_C"))
    if name == "sum":
        return (
            -1600 * (Y - mpmath.mpf(0.1)) - (20 + abs(V)) * V + on_table(load_of("linear").table, theta) + 3
        )
    if name == "cubic":
        return on_table(load_of(name).table, theta)
    if name == "inner":
        ec, AB, BC = (mpmath.mpf(lengths[n]) for n in ("ec", "AB", "BC"))
        Y -= mpmath.sqrt((BC - AB) ** 2 - ec**2)
    return on_table(load_of(name).outward, Y)


def exact(name, load, torque, theta, omega, F_Y, **given):
    """An output by the free bodies, affine in the force and in the acceleration."""
    force = mpmath.mpf(F_Y) + force_at(load, theta, omega, **{n: given[n] for n in LENGTHS})
    there = {"theta": theta, "omega": omega, **given}

    def parts(name):
        still, pushed = (force_truth(name, alpha=0.0, F_Y=F, **there) for F in (0.0, 1.0))
        turned = force_truth(name, alpha=1.0, F_Y=0.0, **there)
        return still + force * (pushed - still), turned - still

    static, inertia = parts("T_in")
    alpha = (mpmath.mpf(torque) - static) / inertia
    still, by_alpha = parts(name) if name != "der(omega)" else (0, 1)
    return still + alpha * by_alpha


@pytest.mark.parametrize(
    "name", [*(pytest.param(one, marks=pytest.mark.thorough) for one in ("cubic", "over Y")), "sum", "inner"]
)
def test_partial_derivatives_go_through_the_load(name, made, monkeypatch):
    """By angle, speed and force while time runs, by lengths in initialisation mode."""
    monkeypatch.setattr(test_fmu, "exact", lambda row, **at: exact(row, name, **at))
    monkeypatch.setattr(test_fmu, "ROWS", ("der(omega)", "T_in", "N_C", "a_C")[: cases(2, 4)])
    one = Instance(made(name), start={"torque": 1.5, "F_Y": 3.0})
    at = {"torque": 1.5, "theta": 0.3, "omega": 5.0, **test_fmu.AT, "F_Y": 3.0}
    test_fmu.check(one.slopes(test_fmu.ROWS, ["AB", "theta0"]), ["AB", "theta0"], at, {"theta0": "theta"})
    one.start()
    knowns = ["theta", "omega", "F_Y"]
    test_fmu.check(one.slopes(test_fmu.ROWS, knowns), knowns, at)
    one.close()


@pytest.mark.sampled
def test_fmpy_finds_no_problem(made):
    validate(made("both ways"))


@pytest.mark.thorough
def test_sanitizers_find_nothing_in_a_thousand_random_presses(made, tmp_path):
    assert 100 < started(made("both ways"), tmp_path) < 1000


def test_a_crank_that_neither_way_of_the_slider_lets_go_stays_at_rest(tmp_path):
    """A load against either way of the slider is friction: more than the torque can move."""
    against = {"over_Y": [[0.08, -30, 30], [0.13, -30, 30]]}
    place = dx.compile(content(outputs=["V_C"], loads={"F_Y": against}), tmp_path / "press.fmu", to="fmu")
    for kind in ("CoSimulation", "ModelExchange"):
        start = {"omega_start": 0.5, "theta0": 1.0, "torque": 0.0}
        result = simulated(str(place), kind, 0.2, 0.01, ["theta", "omega"], **start)
        assert result["omega"][-1] == 0.0
        assert 1.0 < result["theta"][-1] < 1.1


def test_what_an_fmu_does_not_have_is_refused_by_name(tmp_path):
    loads = {"F_Y": LOADS["linear"]}
    with pytest.raises(ValueError, match="'T_in_wrt_theta' is a derivative through"):
        dx.compile(content(outputs=["T_in_wrt_theta"], loads=loads), tmp_path / "press.fmu", to="fmu")
    with pytest.raises(ValueError, match=r"holds tables over theta, Y, V_C; .* connect the FMU's input F_Y"):
        dx.compile(content(loads={"F_Y": dx.over_theta(np.sin)}), tmp_path / "press.fmu", to="fmu")


def test_a_dead_centre_that_the_lengths_do_not_have_is_told(made):
    """The instance says so before anything moves: AB + |ec| > BC has no inner one."""
    one = Instance(made("inner"), start={"ec": 0.07})
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        one.start()
    assert any("from the inner dead centre, and there is none" in line for line in one.log), one.log
    one.close()
