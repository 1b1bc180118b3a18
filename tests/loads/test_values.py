"""Values and total derivatives under loads that vary with the motion, against the free bodies."""

import pickle

import numpy as np
import pytest
import xarray
from mpmath import mp, mpf
from scipy.interpolate import CubicSpline

import desaxe as dx
from tests.papers import free_bodies, loop

DESIGN = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "omega0": 200.0, "alpha": 30.0}
BODIES = {"m_crank": 0.3, "m_rod": 0.5, "m_slider": 0.8, "I_rod": 2e-4, "g_Y": -9.81}
TURN = 2 * np.pi
ANGLES = np.array([0.0, 0.7, 1.9, 2.4, 3.9, 5.1])
FORCES = np.array([0.0, -900.0, -350.0, 120.0, 60.0, -40.0])
POSITIONS, OUTWARD, INWARD = [0.02, 0.05, 0.08, 0.1], [-900, -200, -50, -30], [-900, -400, -150, -30]
DISTANCES, AWAY, BACK = (0.0, 0.02, 0.035, 0.06), (-900.0, -300.0, -80.0, 20.0), (10.0, -70.0, 30.0, 0.0)


def spline():
    return CubicSpline(np.append(ANGLES, TURN), np.append(FORCES, 0.0), bc_type="periodic")


def polynomial(table, x):
    """A SciPy table at a high-precision number."""
    i = int(np.searchsorted(table.x, float(x), side="right")) - 1
    return sum(mpf(c) * (x - mpf(table.x[i])) ** (3 - k) for k, c in enumerate(table.c[:, i]))


def over_theta(motion):
    return polynomial(spline(), mpf(motion.theta))


def between(places, values, x):
    """A table at a high-precision place; beyond its end the last value holds."""
    i = min(int(np.searchsorted(places, float(x), side="right")), len(places) - 1) - 1
    share = min((x - mpf(places[i])) / (mpf(places[i + 1]) - mpf(places[i])), mpf(1))
    return values[i] + share * (mpf(values[i + 1]) - values[i])


def over_Y(motion):
    with mp.workdps(2 * loop.DIGITS):
        Y, V = loop.slider(motion)[1], loop.rate(lambda t: loop.slider(motion, t)[1], 1)
        return between(POSITIONS, OUTWARD if V > 0 else INWARD, Y)


def over_stroke(which):
    """From the slider's position with crank and rod in line, where its raw loop closure turns round."""

    def at(motion):
        with mp.workdps(2 * loop.DIGITS):
            Y, V = loop.slider(motion)[1], loop.rate(lambda t: loop.slider(motion, t)[1], 1)
            ec, AB, BC = (mpf(getattr(motion, n)) for n in LENGTHS)
            angle = mp.asin(-ec / (AB + BC)) if which == "outer" else mp.pi - mp.asin(ec / (BC - AB))
            distance = abs(loop.slider(motion._replace(theta=angle))[1] - Y)
            return between(DISTANCES, AWAY if V > 0 else BACK, distance)

    return lambda: dx.over_stroke(DISTANCES, AWAY, BACK, dead_centre=which), at


LENGTHS = ("ec", "AB", "BC")
LOADS = {
    "table": (lambda: dx.over_theta(ANGLES, FORCES), over_theta),
    "function": (lambda: dx.over_theta(spline(), lambda theta: spline()(theta, 1)), over_theta),
    "over Y": (lambda: dx.over_Y(POSITIONS, OUTWARD, INWARD), over_Y),
    "from the outer dead centre": over_stroke("outer"),
    "from the inner dead centre": over_stroke("inner"),
}


def solved(load, theta, **changed):
    """The forces of the free bodies under a load of that instant, and what the frame feels of them."""
    motion = loop.Motion(theta=theta, **DESIGN)._replace(**changed)
    result = free_bodies.solve(motion, free_bodies.Bodies(F_Y=load(motion), **BODIES))
    shaking = {
        "F_shaking_Y": -result["F_A_Y"],
        "M_shaking": -result["T_in"] - loop.slider(motion)[1] * result["N_C"],
    }
    return result | shaking


@pytest.mark.parametrize("kind", LOADS)
@pytest.mark.parametrize("theta", [0.6, 2.1, 4.4, 5.9])
def test_forces_and_total_derivatives_are_those_of_the_free_bodies(kind, theta):
    load, at = LOADS[kind][0](), LOADS[kind][1]
    felt = ("T_in", "N_C", "F_shaking_Y", "M_shaking")  # partial derivatives of F_shaking_Y have no load
    inputs = {"theta": theta, **{n: DESIGN[n] for n in LENGTHS}}
    names = [f"{name}{by}" for name in felt for by in ("", *(f"_wrt_{p}" for p in inputs))]
    result = dx.evaluate(names, theta=theta, F_Y=load, **DESIGN, **BODIES)
    with mp.workdps(2 * loop.DIGITS):
        right, h = solved(at, theta), mpf(10) ** -12
        for p, value in inputs.items():
            ahead, behind = (solved(at, **{"theta": theta, p: mpf(value) + s * h}) for s in (1, -1))
            for name in felt:
                slope = (ahead[name] - behind[name]) / (2 * h)
                assert abs(result[name] - right[name]) <= 1e-12 * abs(right[name])
                assert abs(result[f"{name}_wrt_{p}"] - slope) <= 1e-11 * abs(slope)


def test_a_labelled_array_is_a_load_over_theta():
    theta, ec = np.linspace(0, TURN, 73), [0.0, 0.01]
    fixed = {name: value for name, value in {**DESIGN, **BODIES}.items() if name != "ec"}
    values = spline()(theta)
    labelled = xarray.DataArray(values, dims="theta", coords={"theta": theta})
    grid = dx.grid(["T_in"], theta=theta, ec=ec, F_Y=labelled, **fixed)
    alone = dx.evaluate("T_in", theta=theta, ec=0.01, F_Y=values, **fixed)
    assert grid.T_in.dims == ("theta", "ec")
    np.testing.assert_allclose(grid.T_in.sel(ec=0.01), alone, rtol=1e-12)
    part = dx.grid("T_in", theta=theta[:20], ec=ec, F_Y=labelled[:20], **fixed)  # no whole turn
    np.testing.assert_allclose(part.T_in.sel(ec=0.01), alone[:20], rtol=1e-12)
    with pytest.raises(ValueError, match="not a whole turn"):
        dx.grid("T_in", theta=theta, ec=ec, F_Y=labelled[:20], **fixed)
    with pytest.raises(ValueError, match="F_Y has the dimensions theta, ec"):
        dx.grid("T_in", theta=theta, ec=ec, F_Y=labelled.expand_dims(ec=2, axis=1), **fixed)


def test_at_a_kink_the_branch_to_the_right_holds():
    held = dx.over_theta([1.0, 2.0], [5.0, 7.0], kind="step")
    bent = dx.over_theta([1.0, 2.0], [5.0, 7.0], kind="linear")
    rest = {"ec": 0.0, "AB": 0.1, "BC": 0.3}
    assert [dx.evaluate("F_C_Y", theta=2.0, F_Y=load, **rest) for load in (held, bent)] == [-7.0, -7.0]
    assert held(np.nextafter(2.0, 0.0)) == 5.0
    assert held(1.0 + TURN) == held(1.0 - TURN) == 5.0
    slope = dx.evaluate("F_C_Y_wrt_theta", theta=2.0, F_Y=bent, **rest)
    assert slope == pytest.approx(2.0 / (TURN - 1.0))  # falls back to 5 at 1 + 2 pi


def test_the_way_of_the_slider_decides_and_a_crank_that_turns_back_goes_the_other_way():
    load = dx.over_Y([0.0, 1.0], [1.0, 1.0], [2.0, 2.0])
    rest = {"ec": 0.0, "AB": 0.1, "BC": 0.3, "F_Y": load}
    at = {s: [-dx.evaluate("F_C_Y", theta=t, omega0=s, **rest) for t in (1.0, 4.0)] for s in (1.0, -1.0)}
    assert at == {1.0: [2.0, 1.0], -1.0: [1.0, 2.0]}
    dead = [-dx.evaluate("F_C_Y", theta=0.0, omega0=s, **rest) for s in (1.0, -1.0)]
    assert dead == [2.0, 1.0]  # what follows as theta grows


def test_functions_of_numbers_and_without_derivative():
    import math

    fixed = {**DESIGN, **BODIES}
    angles = np.array([1.0, 2.0])
    result = dx.evaluate("T_in", theta=angles, F_Y=lambda theta: 50.0 * math.sin(theta), **fixed)
    np.testing.assert_allclose(result, dx.evaluate("T_in", theta=angles, F_Y=50 * np.sin(angles), **fixed))
    assert dx.evaluate("V_C_wrt_theta", theta=1.0, F_Y=lambda theta: 2.0 * np.sin(theta), **fixed)
    with pytest.raises(ValueError, match="T_in_wrt_theta: it needs the slope of F_Y"):
        dx.evaluate("T_in_wrt_theta", theta=1.0, F_Y=lambda theta: 2.0 * np.sin(theta), **fixed)
    with pytest.raises(
        TypeError, match="F_Y: a function of t is not served by this call, which passes theta, omega, Y"
    ):
        dx.evaluate("T_in", theta=1.0, F_Y=lambda t, theta, omega: 0.0, **fixed)
    with pytest.raises(ValueError, match="F_Y: the function gave nan at theta = 1"):
        dx.evaluate("T_in", theta=1.0, F_Y=lambda theta: math.nan, **fixed)
    with pytest.raises(TypeError, match="m_slider: expected a number"):
        dx.evaluate("T_in", theta=1.0, **(fixed | {"m_slider": np.sin}))


def test_an_infeasible_angle_keeps_its_status():
    load = dx.over_Y([0.0, 1.0], [1.0, 2.0])
    short = {"ec": 0.0, "AB": 0.3, "BC": 0.1, "omega0": 1.0, "F_Y": load}
    result = dx.evaluate(["T_in", "status"], theta=np.array([0.1, 1.5]), **short)
    assert result["status"].tolist() == [0, 1]
    assert np.isnan(result["T_in"]).tolist() == [False, True]


def test_loads_compare_by_content_and_travel_by_pickle():
    for load in (dx.over_theta(ANGLES, FORCES), dx.over_Y(POSITIONS, OUTWARD, INWARD), dx.over_theta(np.sin)):
        assert pickle.loads(pickle.dumps(load)) == load
    assert dx.over_theta(ANGLES, FORCES) != dx.over_theta(ANGLES, FORCES, kind="linear")


@pytest.mark.parametrize("kind", ["linear", "cubic"])
def test_the_double_before_the_first_angle_of_a_table_ends_the_last_piece(kind):
    """Whole periods are rounded there: the table's end may be taken for its beginning."""
    rng = np.random.default_rng(11)
    for _ in range(40):
        period = TURN * rng.choice([1.0, 2.0])
        angles = period * (np.arange(16) + rng.uniform(0.2, 0.8, 16)) / 16.0
        forces = rng.uniform(1.0, 9.0, 16)
        load = dx.over_theta([*angles, angles[0] + period], [*forces, forces[0]], kind=kind, period=period)
        for turn in (-3, 0, 2):
            theta = angles[0] + turn * period + np.arange(-3.0, 4.0) * np.spacing(angles[0])
            np.testing.assert_allclose(load(theta), forces[0], rtol=1e-9)
            for angle in theta.tolist():
                assert load(angle) == pytest.approx(forces[0], rel=1e-9)


@pytest.mark.parametrize("kind", LOADS)
def test_what_a_whole_design_has_needs_no_angle_under_friction_and_loads(kind):
    machine = {"AB": 0.04, "BC": 0.064, "mu": 0.1, "F_Y": LOADS[kind][0]()}
    result = dx.grid("stroke", ec=[0.0, 0.01, 0.05], **machine)
    assert result.status.values.tolist() == [0, 0, 1]
    one = dx.evaluate(["stroke", "margin", "status"], ec=0.01, **machine)
    assert one["stroke"] == pytest.approx(np.sqrt(0.104**2 - 1e-4) - np.sqrt(0.024**2 - 1e-4), rel=1e-14)
    assert one["status"] == 0
    assert result.margin[1] == one["margin"]
    with pytest.raises(TypeError, match="theta, over which F_Y varies, is missing"):
        dx.evaluate(["stroke", "T_in"], ec=0.01, **machine)
