"""The oracle of forces against facts that it does not use.

Numerical differences of raw positions, angular momentum about the fixed centre, virtual work, Lagrange's
equation and the power balance.
"""

import itertools

import mpmath
import pytest

from desaxe.oracle.force_truth import (
    FORCES,
    PARAMETERS,
    truth,
    truth_all,
)
from tests.oracle.force_points import BODIES, CENTRES, LOADS, PLAIN, POINTS, agree, numbers


def places(at, theta):
    """B, C, the centres of mass of crank and rod, and the rod's direction, at an angle of the crank."""
    r_crank = at["AB"] / 2 if at["r_crank"] is None else at["r_crank"]
    r_rod = at["BC"] / 2 if at["r_rod"] is None else at["r_rod"]
    towards = mpmath.matrix([mpmath.sin(theta), mpmath.cos(theta)])
    B = at["AB"] * towards
    across = -at["ec"] - B[0]
    rod = mpmath.matrix([across, at["branch"] * mpmath.sqrt(at["BC"] ** 2 - across**2)])
    return {
        **{"B": B, "C": B + rod, "crank": r_crank * towards, "rod": B + rod * (r_rod / at["BC"])},
        "direction": mpmath.atan2(rod[0] * at["branch"], rod[1] * at["branch"]),
    }


def speed(at):
    """The crank's speed under the law."""
    return mpmath.sign(at["omega0"]) * mpmath.sqrt(at["omega0"] ** 2 + 2 * at["alpha"] * at["theta"])


def motion(at):
    """Places, velocities and accelerations by differences in time, with half of the digits."""
    h = mpmath.mpf(10) ** (-mpmath.mp.dps // 4)
    times = (step * h for step in range(-2, 3))
    angles = (at["theta"] + speed(at) * t + at["alpha"] * t * t / 2 for t in times)
    instants = [places(at, angle) for angle in angles]
    result = {}
    for name in instants[2]:
        a, b, c, d, e = (instant[name] for instant in instants)
        result[name] = c, (8 * (d - b) - (e - a)) / (12 * h), (16 * (b + d) - (a + e) - 30 * c) / (12 * h * h)
    return result


def moment(force, place):
    return place[1] * force[0] - place[0] * force[1]


def momentum(at, moving):
    """The sums of forces and of moments about A that crank, rod and slider need, less the weights."""
    g = mpmath.matrix([at["g_X"], at["g_Y"]])
    spins = at["I_crank"] * at["alpha"], at["I_rod"] * moving["direction"][2], 0
    for body, name, spin in zip(("crank", "rod", "slider"), ("crank", "rod", "C"), spins, strict=True):
        place, _, acceleration = moving[name]
        force = at[f"m_{body}"] * (acceleration - g)
        yield force, moment(force, place) + spin


def newton(at, side):
    """All forces by a matrix of moments about A, with friction for a normal force of the sign given."""
    moving = motion(at)
    (B_X, B_Y), (C_X, C_Y) = moving["B"][0], moving["C"][0]
    slides = mpmath.sign(moving["C"][1][1])
    friction = at["mu"] * side * slides
    (crank, about), (rod, rod_about), (slider, _) = momentum(at, moving)
    rows = [  # F_A_X, F_A_Y, F_B_X, F_B_Y, F_C_X, F_C_Y, N_C, T_in
        ([1, 0, -1, 0, 0, 0, 0, 0], crank[0]),
        ([0, 1, 0, -1, 0, 0, 0, 0], crank[1]),
        ([0, 0, -B_Y, B_X, 0, 0, 0, 1], about),
        ([0, 0, 1, 0, -1, 0, 0, 0], rod[0]),
        ([0, 0, 0, 1, 0, -1, 0, 0], rod[1]),
        ([0, 0, B_Y, -B_X, -C_Y, C_X, 0, 0], rod_about),
        ([0, 0, 0, 0, 1, 0, 1, 0], slider[0] - at["F_X"]),
        ([0, 0, 0, 0, 0, 1, -friction, 0], slider[1] - at["F_Y"]),
    ]
    matrix = mpmath.matrix([row for row, _ in rows])
    names = ("F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_C_X", "F_C_Y", "N_C", "T_in")
    result = dict(zip(names, mpmath.lu_solve(matrix, mpmath.matrix([x for _, x in rows])), strict=True))
    result["F_friction"] = -friction * result["N_C"]
    result["power_in"] = result["T_in"] * speed(at)
    whole = crank + rod + slider
    still = list(momentum(at | {"g_X": 0, "g_Y": 0}, moving))
    inertia = -sum((force for force, _ in still), mpmath.matrix([0, 0]))
    return result | {
        "F_shaking_X": at["F_X"] - whole[0],
        "F_shaking_Y": at["F_Y"] - whole[1],
        "M_shaking": -(result["T_in"] + C_Y * result["N_C"] - C_X * result["F_friction"]),
        "F_inertia_X": inertia[0],
        "F_inertia_Y": inertia[1],
        "M_inertia": -sum(turning for _, turning in still),
        "kinetic_energy": kinetic_energy(at, moving),
    }


def kinetic_energy(at, moving):
    turning = at["I_crank"] * speed(at) ** 2 + at["I_rod"] * moving["direction"][1] ** 2
    masses = zip(("m_crank", "m_rod", "m_slider"), ("crank", "rod", "C"), strict=True)
    return (turning + sum(at[mass] * mpmath.norm(moving[name][1]) ** 2 for mass, name in masses)) / 2


def work_of(at):
    """The work of gravity, and that of the load, as functions of the angle; their slopes are virtual work."""

    def work(theta):
        place = places(at, theta)
        masses = zip(("m_crank", "m_rod", "m_slider"), ("crank", "rod", "C"), strict=True)
        weight = sum(at[m] * (at["g_X"] * place[n][0] + at["g_Y"] * place[n][1]) for m, n in masses)
        return weight, at["F_X"] * place["C"][0] + at["F_Y"] * place["C"][1]

    return work


@pytest.mark.parametrize("point", POINTS)
def test_newton_by_differences(point):
    """A matrix of moments about the fixed centre, the accelerations differences: 20 digits of every force."""
    side = mpmath.sign(truth("N_C", **point))
    with mpmath.workdps(160):
        result = newton(numbers(point), side)
        assert mpmath.sign(result["N_C"]) == side
        for name, value in result.items():
            assert agree(truth(name, **point), value, digits=40), name


@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize("parameter", PARAMETERS)
def test_sensitivities_by_differences(parameter, point):
    side = mpmath.sign(truth("N_C", **point))
    with mpmath.workdps(200):
        at, h = numbers(point), mpmath.mpf(10) ** -30
        centre = at["AB" if parameter == "r_crank" else "BC"] / 2 if at[parameter] is None else at[parameter]
        after, before = (newton(at | {parameter: centre + step}, side) for step in (h, -h))
        for name in after:
            slope = (after[name] - before[name]) / (2 * h)
            assert agree(truth(f"{name}_wrt_{parameter}", **point), slope, digits=30), name


@pytest.mark.parametrize("point", POINTS[:2])
@pytest.mark.parametrize("pair", [("theta", "theta"), ("m_rod", "BC"), ("mu", "ec"), ("alpha", "theta")])
def test_second_sensitivities_by_differences(pair, point):
    side = mpmath.sign(truth("N_C", **point))
    with mpmath.workdps(240):
        at, h = numbers(point), mpmath.mpf(10) ** -25
        corners = {}
        for steps in itertools.product((1, -1), repeat=2):
            moved = dict(at)
            for parameter, step in zip(pair, steps, strict=True):
                moved[parameter] += step * h
            corners[steps] = newton(moved, side)
        for name in corners[1, 1]:
            twist = sum(a * b * corners[a, b][name] for a, b in corners) / (4 * h * h)
            assert agree(truth(f"{name}_wrt_{pair[0]}_{pair[1]}", **point), twist, digits=20), name


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("centres", [{}, CENTRES])
def test_virtual_work_in_statics(branch, centres):
    point = PLAIN | BODIES | LOADS | centres | {"branch": branch}
    work = work_of(numbers(point))
    slope = mpmath.diff(lambda theta: sum(work(theta)), point["theta"])
    assert agree(truth("T_in", **point), -slope, digits=40)
    assert agree(truth("T_in", **point | {"omega": 0.0}), -slope, digits=40)
    assert agree(truth("potential_energy", **point), -work(mpmath.mpf(point["theta"]))[0])


@pytest.mark.parametrize("point", POINTS)
def test_power_balance(point):
    """The drive's power, the load's, gravity's and friction's change the kinetic energy."""
    q = truth_all((*FORCES, "V_C", "omega"), **point)
    kinetic, potential = (
        truth(f"{energy}_energy_wrt_theta", **point) * q["omega"] for energy in ("kinetic", "potential")
    )
    outside = (point["F_Y"] + q["F_friction"]) * q["V_C"] - potential
    assert agree(q["power_in"], q["T_in"] * q["omega"])
    assert agree(q["power_in"] + outside, kinetic)
    assert agree(q["P_friction"], -q["F_friction"] * q["V_C"])
    assert q["P_friction"] >= 0
    for joint in "ABC":
        assert agree(q[f"F_{joint}"], mpmath.hypot(q[f"F_{joint}_X"], q[f"F_{joint}_Y"]))


@pytest.mark.parametrize("point", POINTS)
def test_lagrange(point):
    """T_in = M_eff alpha + M_eff' omega^2/2 + potential' - (F_Y + F_friction) dY/dtheta."""
    q = truth_all((*FORCES, "omega"), **point)
    M_slope, slope, travel = (truth(f"{p}_wrt_theta", **point) for p in ("M_eff", "potential_energy", "Y"))
    inertia = q["M_eff"] * mpmath.mpf(point["alpha"]) + M_slope * q["omega"] ** 2 / 2
    assert agree(q["T_in"], inertia + slope - (mpmath.mpf(point["F_Y"]) + q["F_friction"]) * travel)
    assert agree(q["kinetic_energy"], q["M_eff"] * q["omega"] ** 2 / 2)


@pytest.mark.parametrize("point", POINTS)
def test_two_masses_for_the_rod(point):
    """They keep its mass and its centre; their kinetic energy exceeds its own by that of I_lumping."""
    rod = point | {"m_crank": 0.0, "m_slider": 0.0, "I_crank": 0.0}
    q = truth_all((*FORCES, "V_B", "V_C", "omega_BC"), **rod)
    lumped = (q["m_rotating"] * q["V_B"] ** 2 + q["m_reciprocating"] * q["V_C"] ** 2) / 2
    assert agree(lumped - q["kinetic_energy"], q["I_lumping"] * q["omega_BC"] ** 2 / 2)
    assert agree(q["m_rotating"] + q["m_reciprocating"], mpmath.mpf(point["m_rod"]))
    r_rod, r_crank = (numbers(point)[p] for p in ("r_rod", "r_crank"))
    BC, AB = mpmath.mpf(point["BC"]), mpmath.mpf(point["AB"])
    assert agree(q["m_reciprocating"] * BC, point["m_rod"] * (BC / 2 if r_rod is None else r_rod))
    crank = truth("m_rotating", **point | {"m_rod": 0.0})
    assert agree(crank * AB, point["m_crank"] * (AB / 2 if r_crank is None else r_crank))
    assert agree(truth("m_reciprocating", **point) - q["m_reciprocating"], point["m_slider"])
