"""One load in every call: each gives the torque of one plain computation by hand."""

import importlib.util

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import desaxe as dx
from desaxe.loads.angles import kinks_between

TURN = 2 * np.pi
EC, AB, BC, MASS, SPEED = 0.01, 0.04, 0.064, 0.8, 50.0
MACHINE = {"AB": AB, "BC": BC, "m_slider": MASS, "omega0": SPEED}
ANGLES, FORCES = [0.0, 1.0, 2.0, 4.0], [0.0, -400.0, -50.0, 20.0]
POSITIONS, OUTWARD, INWARD = (
    [0.02, 0.05, 0.08, 0.1],
    [-900.0, -200.0, -50.0, -30.0],
    [-90.0, -40.0, -9.0, -3.0],
)
SPLINE = CubicSpline([*ANGLES, TURN], [*FORCES, FORCES[0]], bc_type="periodic")


def stepped(theta):
    return np.array(FORCES)[np.searchsorted(ANGLES, np.mod(theta, TURN), side="right") - 1]


def bent(theta):
    return np.interp(theta, ANGLES, FORCES, period=TURN)


# Of each kind the load, and what it is at an angle, a position and a velocity of the slider.
LOADS = {
    "cubic": (dx.over_theta(ANGLES, FORCES), lambda t, Y, V: SPLINE(np.mod(t, TURN))),
    "linear": (dx.over_theta(ANGLES, FORCES, kind="linear"), lambda t, Y, V: bent(t)),
    "step": (dx.over_theta(ANGLES, FORCES, kind="step"), lambda t, Y, V: stepped(t)),
    "function": (dx.over_theta(bent, nodes=ANGLES), lambda t, Y, V: bent(t)),
    "stroke": (
        dx.over_Y(POSITIONS, OUTWARD, INWARD),
        lambda t, Y, V: np.where(V < 0, np.interp(Y, POSITIONS, INWARD), np.interp(Y, POSITIONS, OUTWARD)),
    ),
}


def torque(kind, theta, ec=EC):
    """Newton's second law of the slider and virtual work: T omega = (m a_C - F) V_C."""
    side, rise = ec + AB * np.sin(theta), AB * np.cos(theta)
    height = np.sqrt(BC**2 - side**2)
    Y = AB * np.cos(theta) + height
    slope = -AB * np.sin(theta) - side * rise / height
    bend = -rise - (rise**2 - side * AB * np.sin(theta)) / height - (side * rise) ** 2 / height**3
    return (MASS * bend * SPEED**2 - LOADS[kind][1](theta, Y, slope)) * slope


def integral(function, kind, ec=EC):
    """Over a turn, by Gauss's rule piece by piece."""
    load = LOADS[kind][0]
    kinks = kinks_between([load], 0.0, TURN, (ec, AB, BC), 1, smooth=True)
    edges = np.unique([*np.linspace(0.0, TURN, 17), *kinks])
    nodes, weights = np.polynomial.legendre.leggauss(24)
    half = 0.5 * np.diff(edges)[:, None]
    return np.sum(half * weights * function(edges[:-1, None] + half * (nodes + 1.0)))


def some(kinds):
    """Kinds of loads, of which the default run takes the one that jumps."""
    return [k if k == "step" else pytest.param(k, marks=pytest.mark.thorough) for k in kinds]


THETA, OFFSETS = np.linspace(0.05, 6.2, 41), np.array([0.0, EC])
FULL = np.linspace(0.0, TURN, 40_001)


@pytest.mark.parametrize("kind", LOADS)
def test_values_at_points_on_grids_in_chunks_and_in_stores(kind, tmp_path):
    load = LOADS[kind][0]
    right = torque(kind, THETA[:, None], OFFSETS)
    inputs = {"theta": THETA, "ec": OFFSETS, "F_Y": load, **MACHINE}
    each = [dx.evaluate("T_in", theta=float(t), ec=EC, F_Y=load, **MACHINE) for t in THETA]
    found = {
        "evaluate": dx.evaluate("T_in", **{**inputs, "theta": THETA[:, None]}),
        "points": np.stack([right[:, 0], each], axis=1),
        "grid": dx.grid("T_in", **inputs).T_in,
        "chunks": dx.grid("T_in", chunks={"theta": 9}, **inputs).T_in,
        "sweep": dx.sweep("T_in", store=tmp_path / "loads.zarr", **inputs).T_in,
        "machine": dx.Machine(ec=EC, F_Y=load, **MACHINE).evaluate(
            "T_in", theta=THETA[:, None] + 0 * OFFSETS
        ),
    }
    right_machine = np.broadcast_to(torque(kind, THETA)[:, None], right.shape)
    for call, values in found.items():
        wanted = right_machine if call == "machine" else right
        np.testing.assert_allclose(values, wanted, rtol=1e-11, atol=1e-11, err_msg=call)
    reduced = dx.grid("T_in", reduce={("theta", "ec"): "rms"}, **inputs).T_in_rms
    assert float(reduced) == pytest.approx(np.sqrt(np.mean(right**2)), rel=1e-12)


@pytest.mark.parametrize("kind", some(LOADS))
def test_peaks_averages_and_the_calls_over_a_turn(kind):
    load = LOADS[kind][0]
    one = {"ec": EC, "F_Y": load, **MACHINE}
    top = np.abs(torque(kind, FULL)).max()
    peak = dx.peak("T_in", **one)["value"]
    assert top * (1 - 1e-12) <= peak <= top * (1 + 1e-3)  # at a jump the limit is between two samples
    mean = integral(lambda t: torque(kind, t), kind) / TURN
    rms = np.sqrt(integral(lambda t: torque(kind, t) ** 2, kind) / TURN)
    rel = 1e-5 if kind == "function" else 1e-9  # whose kinks are known to searches, not to sums
    series = dx.harmonics("T_in", orders=1, **one)
    motor = dx.drive(fluctuation=0.1, **one)
    means = {"harmonics": series["mean"], "drive": motor["torque_mean"]}
    for call, value in means.items():
        assert value == pytest.approx(mean, rel=rel, abs=1e-9), call
    assert motor["torque_rms"] == pytest.approx(rms, rel=rel)
    assert np.hypot(series["mean"], series["remainder"]) < rms
    fixed = {n: value for n, value in one.items() if n != "ec"}
    best = dx.optimize(minimize=("rms", "T_in"), over={"ec": (0.0, 0.015)}, starts=1, **fixed)
    there = np.sqrt(integral(lambda t: torque(kind, t, best["ec"]) ** 2, kind, best["ec"]) / TURN)
    assert best["value"] == pytest.approx(there, rel=rel)
    assert best["value"] <= rms * (1 + rel)


@pytest.mark.parametrize("kind", some(LOADS))
def test_a_motion_under_the_torque_of_constant_speed_keeps_that_speed(kind):
    load = LOADS[kind][0]
    jumps = kinks_between([load], 0.0, TURN, (EC, AB, BC), 1)
    drive = dx.over_theta(lambda t: float(torque(kind, t)), nodes=jumps)
    bodies = {"ec": EC, "AB": AB, "BC": BC, "m_slider": MASS, "I_crank": 0.01, "F_Y": load}
    run = dx.simulate(torque=drive, t_end=0.3, omega_start=SPEED, **bodies)
    np.testing.assert_allclose(run["omega"], SPEED, rtol=1e-7)
    several = dx.simulate(torque=drive, t_end=0.3, omega_start=np.array([SPEED, SPEED]), **bodies)
    np.testing.assert_allclose(np.asarray(several["omega"])[..., -1], SPEED, rtol=1e-7)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", some(kind for kind in LOADS if kind != "function"))
def test_tolerances_scenes_and_modules(kind, tmp_path):
    load = LOADS[kind][0]
    found = dx.tolerance(
        "T_in", samples=16, sobol=0, theta=2.5, ec=dx.plus_minus(EC, 1e-6), F_Y=load, **MACHINE
    )
    slope = (torque(kind, 2.5, EC + 1e-7) - torque(kind, 2.5, EC - 1e-7)) / 2e-7
    assert found["gradient"]["ec"] == pytest.approx(slope, rel=1e-6)
    scene = dx.scene({
        "outputs": ["T_in", "T_in_wrt_theta"],
        "mechanism": {"AB": AB, "BC": BC, "ec": OFFSETS.tolist()},
        "motion": {"omega0": SPEED, "theta": THETA.tolist()},
        "masses": {"m_slider": MASS},
        "loads": {"F_Y": load},
    })  # fmt: skip
    right = torque(kind, THETA[:, None], OFFSETS)
    run = scene.run().dataset.transpose("theta", "ec")
    np.testing.assert_allclose(run.T_in, right, rtol=1e-11, atol=1e-11)
    path = dx.compile(scene, tmp_path / f"press_{kind}.py")
    spec = importlib.util.spec_from_file_location(f"press_{kind}", tmp_path / f"press_{kind}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert path is None or path
    points = module.evaluate(theta=THETA[:, None], ec=OFFSETS)
    np.testing.assert_allclose(points["T_in"], right, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(points["T_in_wrt_theta"], run.T_in_wrt_theta, rtol=1e-11, atol=1e-11)
    one = dict(zip(module.OUTPUTS, module.point(2.5, EC), strict=True))
    assert one["T_in"] == pytest.approx(float(torque(kind, 2.5)), rel=1e-12)
    whole = module.run()
    names = list(module.AXES)
    np.testing.assert_allclose(
        np.moveaxis(whole["T_in"], names.index("theta"), 0), right, rtol=1e-11, atol=1e-11
    )
