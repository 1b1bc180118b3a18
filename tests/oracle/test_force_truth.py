"""The oracle of forces against facts that it does not use.

Numerical differences of raw positions, angular momentum about the fixed centre, virtual work, Lagrange's
equation, the power balance, symmetries, units, and friction found by trial.
"""

import itertools
import math

import mpmath
import pytest

from desaxe.oracle.force_truth import (
    FORCES,
    MAGNITUDES,
    MASSES,
    OTHERS,
    PARAMETERS,
    SHAKING,
    STATE_PARAMETERS,
    TOUCHED,
    conditions,
    force_balances,
    force_names,
    truth,
    truth_all,
)
from desaxe.oracle.truth import LAW, QUANTITIES
from desaxe.oracle.truth import truth as kinematic_truth

BODIES = {"m_crank": 1.5, "m_rod": 0.75, "m_slider": 2.25, "I_crank": 0.03125, "I_rod": 0.0625}
LOADS = {"F_X": 30.0, "F_Y": -45.0, "g_X": 1.25, "g_Y": -9.75}
CENTRES = {"r_crank": -0.03, "r_rod": 0.2}
POINTS = [
    {"theta": 1.047, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 15.5, "alpha": 0.0, "mu": 0.1}
    | {**BODIES, **LOADS},
    {"theta": -2.5, "ec": -0.2, "AB": 0.125, "BC": 0.35, "omega0": -3.0, "alpha": -1.25, "mu": 0.2}
    | {**BODIES, **LOADS, **CENTRES, "branch": -1},
    {"theta": 0.3, "ec": 0.3, "AB": 0.5, "BC": 0.75, "omega0": 2.0, "alpha": -0.75, "mu": 0.0}
    | {**BODIES, **LOADS, **CENTRES},
    {"theta": 3.0, "ec": -0.125, "AB": 2.0, "BC": 1.0, "omega0": 0.5, "alpha": 4.0, "mu": 0.3}
    | {**BODIES, **LOADS, "r_crank": 0.7, "branch": -1},
]
PLAIN = {"theta": 2.0, "ec": 0.1, "AB": 0.125, "BC": 0.35}
AT_REST = PLAIN | BODIES | LOADS | CENTRES
# Degrees in mass, length and 1/time of a quantity, and of an input.
FORCE, TORQUE = (1, 1, 2), (1, 2, 2)
DEGREES = {
    **dict.fromkeys(FORCES, FORCE),
    **dict.fromkeys(("T_in", "M_shaking", "kinetic_energy", "potential_energy"), TORQUE),
    **dict.fromkeys(("m_rotating", "m_reciprocating"), (1, 0, 0)),
    **{"power_in": (1, 2, 3), "P_friction": (1, 2, 3), "M_eff": (1, 2, 0), "I_lumping": (1, 2, 0)},
}
OF_INPUTS = {
    **{"theta": (0, 0, 0), "mu": (0, 0, 0), "omega0": (0, 0, 1), "alpha": (0, 0, 2)},
    **dict.fromkeys(("ec", "AB", "BC", "r_crank", "r_rod"), (0, 1, 0)),
    **dict.fromkeys(("m_crank", "m_rod", "m_slider"), (1, 0, 0)),
    **dict.fromkeys(("I_crank", "I_rod"), (1, 2, 0)),
    **{"F_X": FORCE, "F_Y": FORCE, "g_X": (0, 1, 2), "g_Y": (0, 1, 2)},
}
# What changes its sign in the mirror X -> -X, and in the mirror Y -> -Y, which exchanges the branches.
ODD_IN_X = {"theta", "ec", "omega0", "alpha", "F_X", "g_X", "T_in", "M_shaking", "N_C"}
ODD_IN_X |= {"F_A_X", "F_B_X", "F_C_X", "F_shaking_X"}
ODD_IN_Y = {"T_in", "M_shaking", "F_friction", "F_A_Y", "F_B_Y", "F_C_Y", "F_shaking_Y"}


@pytest.fixture(autouse=True)
def sixty_digits():
    with mpmath.workdps(60):
        yield


def agree(left, right, digits=45):
    return abs(left - right) <= mpmath.mpf(10) ** -digits * (1 + abs(left))


def numbers(point):
    """All inputs of a point as numbers of mpmath, those that are not given too."""
    given = dict.fromkeys(PARAMETERS, 0) | {"branch": 1, "r_crank": None, "r_rod": None} | point
    return {p: None if value is None else mpmath.mpf(value) for p, value in given.items()}


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
    found = dict(zip(names, mpmath.lu_solve(matrix, mpmath.matrix([x for _, x in rows])), strict=True))
    found["F_friction"] = -friction * found["N_C"]
    found["power_in"] = found["T_in"] * speed(at)
    whole = crank + rod + slider
    return found | {
        "F_shaking_X": at["F_X"] - whole[0],
        "F_shaking_Y": at["F_Y"] - whole[1],
        "M_shaking": -(found["T_in"] + C_Y * found["N_C"] - C_X * found["F_friction"]),
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
        found = newton(numbers(point), side)
        assert mpmath.sign(found["N_C"]) == side
        for name, value in found.items():
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


@pytest.mark.parametrize("point", POINTS)
def test_each_body_alone(point):
    """The forces on crank, rod and slider, and their moments about A, from the oracle's numbers alone."""
    q = truth_all(FORCES, **point)
    with mpmath.workdps(160):
        at = numbers(point)
        moving = motion(at)
        A, B, C = (mpmath.matrix([q[f"F_{joint}_X"], q[f"F_{joint}_Y"]]) for joint in "ABC")
        guide = mpmath.matrix([q["N_C"] + at["F_X"], q["F_friction"] + at["F_Y"]])
        at_B, at_C = moving["B"][0], moving["C"][0]
        (crank, about), (rod, rod_about), (slider, _) = momentum(at, moving)
        for left, right in ((A - B, crank), (B - C, rod), (C + guide, slider)):
            assert agree(left[0], right[0], digits=40)
            assert agree(left[1], right[1], digits=40)
        assert agree(q["T_in"] - moment(B, at_B), about, digits=40)
        assert agree(moment(B, at_B) - moment(C, at_C), rod_about, digits=40)


@pytest.mark.parametrize("point", POINTS)
def test_frame_feels_what_changes_the_momentum(point):
    """Shaking force = -(sum m a) + weight + load, and its moment about A likewise; from no bearing force."""
    with mpmath.workdps(160):
        at = numbers(point)
        moving = motion(at)
        forces, moments = zip(*momentum(at, moving), strict=True)
        load = mpmath.matrix([at["F_X"], at["F_Y"]])
        shaking = load - (forces[0] + forces[1] + forces[2])
        assert agree(truth("F_shaking_X", **point), shaking[0], digits=40)
        assert agree(truth("F_shaking_Y", **point), shaking[1], digits=40)
        expected = moment(load, moving["C"][0]) - sum(moments)
        assert agree(truth("M_shaking", **point), expected, digits=40)


@pytest.mark.parametrize("point", POINTS)
def test_frame_feels_its_bearings(point):
    q = truth_all((*FORCES, "Y"), **point)
    assert agree(q["F_shaking_X"] + q["F_A_X"] + q["N_C"], 0)
    assert agree(q["F_shaking_Y"] + q["F_A_Y"] + q["F_friction"], 0)
    ec = mpmath.mpf(point["ec"])
    assert agree(q["M_shaking"] + q["T_in"] + q["Y"] * q["N_C"] + ec * q["F_friction"], 0)


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


def parity(name, odd):
    quantity, _, parameter = name.partition("_wrt_")
    return math.prod(-1 for part in (quantity, parameter) if part in odd)


@pytest.mark.parametrize("point", POINTS)
def test_mirror(point):
    mirrored = point | {p: -point[p] for p in ODD_IN_X & point.keys()}
    for name in force_names():
        assert agree(truth(name, **mirrored), parity(name, ODD_IN_X) * truth(name, **point)), name


@pytest.mark.parametrize("name", FORCES)
def test_branches_are_mirror_images(name):
    """Y -> -Y turns theta into pi - theta, backwards; pi is not a double, the rest is a Taylor polynomial."""
    point = AT_REST | {"omega": 5.0, "alpha": 4.0, "mu": 0.1, "branch": -1}
    mirrored = {p: -point[p] for p in ("omega", "alpha", "F_Y", "g_Y")}
    other = point | mirrored | {"theta": math.pi - 2.0, "branch": 1}
    h = mpmath.pi - 2 - mpmath.mpf(other["theta"])
    value, slope, curvature = (truth(name + tail, **other) for tail in ("", "_wrt_theta", "_wrt_theta_theta"))
    expected = value + h * slope + h * h * curvature / 2
    assert agree(parity(name, ODD_IN_Y) * truth(name, **point), expected, digits=40)


@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize("name", FORCES)
def test_euler_homogeneity(name, point):
    """Other units of mass, length and time multiply a quantity by known powers."""
    assert name in DEGREES, f"{name} has no degree: add it to DEGREES in {__file__}: mass, length and 1/time"
    at, value = numbers(point), truth(name, **point)
    steps = {p: truth(f"{name}_wrt_{p}", **point) * at[p] for p in PARAMETERS if at[p]}
    for unit in range(3):
        total = sum(OF_INPUTS[p][unit] * step for p, step in steps.items())
        assert agree(total, DEGREES[name][unit] * value)


@pytest.mark.parametrize("name", FORCES)
def test_centres_in_the_middle(name):
    """A centre that is not given moves with its link: the chain rule leads from one call to the other."""
    free = {p: value for p, value in POINTS[1].items() if p not in CENTRES}
    held = free | {"r_crank": free["AB"] / 2, "r_rod": free["BC"] / 2}
    assert truth(name, **free) == truth(name, **held)
    for link, centre in (("AB", "r_crank"), ("BC", "r_rod")):
        moved = truth(f"{name}_wrt_{link}", **held) + truth(f"{name}_wrt_{centre}", **held) / 2
        assert agree(truth(f"{name}_wrt_{link}", **free), moved)
    for parameter in set(PARAMETERS) - {"AB", "BC"}:
        assert agree(truth(f"{name}_wrt_{parameter}", **free), truth(f"{name}_wrt_{parameter}", **held))


@pytest.mark.parametrize("name", FORCES)
def test_law_follows_from_state(name):
    """omega0 = 3 and alpha = 4 give omega = 5 at theta = 2."""
    both = AT_REST | {"alpha": 4.0, "mu": 0.25}
    law = {p: truth(f"{name}_wrt_{p}", omega0=3.0, **both) for p in PARAMETERS}
    state = {p: truth(f"{name}_wrt_{p}", omega=5.0, **both) for p in STATE_PARAMETERS}
    assert agree(truth(name, omega0=3.0, **both), truth(name, omega=5.0, **both))
    assert agree(law["theta"], state["theta"] + state["omega"] * 4 / 5)
    assert agree(law["omega0"], state["omega"] * 3 / 5)
    assert agree(law["alpha"], state["alpha"] + state["omega"] * 2 / 5)
    assert all(agree(law[p], state[p]) for p in ("ec", "AB", "BC", *OTHERS))


@pytest.mark.parametrize("theta", [2.0, -2.0])
def test_law_that_starts_from_rest(theta):
    """After 2 rad at 4 rad/s^2 the speed is 4, whichever way the crank was driven."""
    law = AT_REST | {"theta": theta, "omega0": 0.0, "alpha": math.copysign(4.0, theta), "mu": 0.25}
    state = law | {"omega": 4.0}
    for name in FORCES:
        assert agree(truth(name, **law), truth(name, **state)), name
        assert truth(f"{name}_wrt_omega0", **law) == 0
        assert agree(truth(f"{name}_wrt_BC", **law), truth(f"{name}_wrt_BC", **state))


def balances_by_trial(point):
    """The normal forces N at which a slider without friction, loaded with the friction of N, is pushed by N.

    What is left over is linear in N on either side of zero: its signs there and far away tell every root.
    """
    slides = mpmath.sign(truth("V_C", **point))

    def left_over(N):
        with mpmath.workdps(60):
            load = point["F_Y"] - mpmath.mpf(point["mu"]) * abs(N) * slides
            plain = truth_all(("N_C", "N_C_wrt_F_Y"), **point | {"mu": 0.0})
            return plain["N_C"] + plain["N_C_wrt_F_Y"] * (load - mpmath.mpf(point["F_Y"])) - N

    far, roots = mpmath.mpf(10) ** 9, []
    for end in (far, -far):
        low, high = left_over(mpmath.mpf(0)), left_over(end)
        if low * high < 0:
            roots.append(end * low / (low - high))
    return roots


STEEP = {"theta": 0.5, "ec": 3.5, "AB": 1.0, "BC": 5.0, "m_slider": 1.0, "m_rod": 0.5, "I_rod": 0.25}
SLIDING = [
    (1.0, 0.5, 20.0, 0.0, "one"),
    (1.0, 0.5, -20.0, 0.0, "one"),
    (-1.0, 0.5, 0.0, 20.0, "one"),
    (-1.0, 0.5, 0.0, -20.0, "one"),
    (1.0, 3.0, 20.0, 0.0, "none or two"),
    (1.0, 3.0, -20.0, 0.0, "none or two"),
    (-1.0, 3.0, 20.0, 0.0, "none or two"),
    (-1.0, 3.0, -20.0, 0.0, "none or two"),
]


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(("omega", "mu", "F_X", "F_Y", "kind"), SLIDING)
def test_friction(omega, mu, F_X, F_Y, kind, branch):
    point = STEEP | {"omega": omega, "mu": mu, "F_X": F_X, "F_Y": F_Y, "branch": branch}
    roots = balances_by_trial(point)
    assert force_balances(**point) == len(roots)
    assert (len(roots) == 1) == (kind == "one")
    if len(roots) == 1:
        assert agree(truth("N_C", **point), roots[0], digits=40)
        friction = -mpmath.mpf(mu) * abs(roots[0]) * mpmath.sign(truth("V_C", **point))
        assert agree(truth("F_friction", **point), friction, digits=40)
    else:
        names = [*TOUCHED, *(f"{name}_wrt_mu" for name in TOUCHED)]
        assert all(map(mpmath.isnan, truth_all(names, **point).values()))


def test_every_kind_of_friction_is_among_these():
    points = [
        STEEP | {"omega": omega, "mu": mu, "F_X": F_X, "F_Y": F_Y, "branch": branch}
        for (omega, mu, F_X, F_Y, _), branch in itertools.product(SLIDING, (1, -1))
    ]
    counts = [force_balances(**point) for point in points]
    assert set(counts) == {0, 1, 2}
    pushes = {mpmath.sign(truth("N_C", **p)) for p, count in zip(points, counts, strict=True) if count == 1}
    assert pushes == {1, -1}


@pytest.mark.parametrize("mu", [0.5, 3.0])
@pytest.mark.parametrize("omega", [1.0, -1.0])
@pytest.mark.parametrize("F_X", [20.0, -20.0])
def test_what_friction_does_not_touch(mu, omega, F_X):
    """The frame feels no friction as a whole, whether there is a balance or not; energies know no forces."""
    point = STEEP | {"omega": omega, "F_X": F_X}
    for name in {*FORCES} - {*TOUCHED, *MAGNITUDES}:
        assert truth(name, mu=mu, **point) == truth(name, mu=0.0, **point)
        assert truth(f"{name}_wrt_mu", mu=mu, **point) == 0
        assert mpmath.isfinite(truth(f"{name}_wrt_BC", mu=mu, **point))


@pytest.mark.parametrize("omega", [1.0, -1.0])
@pytest.mark.parametrize("F_X", [1.0, -1.0])
@pytest.mark.parametrize("branch", [1, -1])
def test_at_the_border_of_jamming(F_X, omega, branch):
    """tan phi = 4/3 and mu = 3/4: the rod is parallel to what the guide can bear."""
    point = {"theta": 0.0, "ec": 4.0, "AB": 1.0, "BC": 5.0, "F_X": F_X, "omega": omega, "branch": branch}
    border, below, above = (force_balances(mu=mu, **point) for mu in (0.75, 0.75 - 2**-53, 0.75 + 2**-53))
    assert below == 1
    assert (border, above) in ((0, 0), (1, 2))
    assert border == len(balances_by_trial(point | {"mu": 0.75, "F_Y": 0.0}))
    assert {force_balances(mu=0.75, **point | {"F_X": x}) for x in (1.0, -1.0)} == {0, 1}


def test_which_way_it_slides():
    """As the motion; at rest as the motion that alpha starts; not if nothing moves, nor at a dead centre."""
    loads = {"F_X": 10.0, "mu": 0.25}

    def friction(**point):
        return truth("F_friction", **loads, **point)

    for omega, alpha in itertools.product((2.0, -2.0), (0.0, 100.0, -100.0)):
        value = friction(omega=omega, alpha=alpha, **PLAIN)
        assert mpmath.sign(value) == -mpmath.sign(truth("V_C", omega=omega, alpha=alpha, **PLAIN))
    for start in ({"omega": 0.0}, {"omega0": 0.0, **PLAIN, "theta": 0.0}):
        point = PLAIN | start
        for alpha in (100.0, -100.0):
            slope = truth("Y_wrt_theta", **point)
            assert mpmath.sign(friction(alpha=alpha, **point)) == -mpmath.sign(slope * alpha)
        assert friction(**point) == truth("F_friction_wrt_mu", **loads, **point) == 0
    dead_centre = {"theta": 0.0, "ec": 0.0, "AB": 0.125, "BC": 0.35, "omega": 2.0}
    assert friction(**dead_centre) == truth("T_in_wrt_mu", **loads, **dead_centre) == 0
    assert force_balances(**dead_centre, F_X=10.0, mu=100.0) == 1
    assert friction(**dead_centre | {"theta": 1e-300, "ec": 1e-300}) != 0


def test_the_sign_of_friction_where_nothing_pushes():
    """|N_C| at 0 from the right: a side load moves the friction as if the guide pushed along +X."""
    point = PLAIN | {"omega": 2.0, "mu": 0.25}
    assert truth("N_C", **point) == truth("F_friction", **point) == 0
    assert force_balances(**point) == 1
    right = truth("F_friction_wrt_F_X", **point)
    assert right != 0
    assert agree(right, truth("F_friction", F_X=-1.0, **point) / -1)


def test_at_rest():
    rest, slow = truth_all(force_names(), **AT_REST), truth_all(FORCES, **AT_REST, omega0=2.0**-120)
    for name in FORCES:
        assert agree(rest[name], slow[name], digits=30)
    assert rest["power_in"] == rest["kinetic_energy"] == rest["F_friction"] == 0
    assert agree(rest["power_in_wrt_omega0"], rest["T_in"])
    assert rest["power_in_wrt_alpha"] == mpmath.sign(rest["T_in"]) * mpmath.inf
    assert rest["T_in_wrt_omega0"] == rest["kinetic_energy_wrt_theta"] == 0
    theta = mpmath.mpf(AT_REST["theta"])
    assert agree(rest["T_in_wrt_alpha"], rest["M_eff"] + theta * rest["M_eff_wrt_theta"])
    state = AT_REST | {"omega": 0.0}
    assert agree(truth("T_in_wrt_alpha", **state), rest["M_eff"])
    assert agree(truth("T_in_wrt_omega_omega", **state), rest["M_eff_wrt_theta"])


def test_nothing_given_is_nothing_felt():
    moving = truth_all(force_names(), omega0=3.0, **PLAIN)
    assert all(moving[name] == 0 for name in FORCES)
    assert moving["F_C_X_wrt_F_X"] == 0
    assert moving["N_C_wrt_F_X"] == -1
    assert agree(moving["T_in_wrt_F_Y"], -truth("Y_wrt_theta", **PLAIN))
    assert agree(moving["F_A_X_wrt_m_slider"], moving["F_C_X_wrt_m_slider"])


def test_no_number_where_there_is_none():
    stalled = AT_REST | {"omega0": 1.0, "alpha": -0.75}
    apart, folded = AT_REST | {"ec": 0.25, "theta": 1.0}, AT_REST | {"theta": 0.0, "ec": 0.35}
    of_shape = {"M_eff", "potential_energy", *MASSES}
    for name in FORCES:
        for tail in ("", "_wrt_theta", "_wrt_m_crank"):
            assert mpmath.isnan(truth(name + tail, **stalled)) == (name not in of_shape), name
            for point in (apart, folded):
                assert mpmath.isnan(truth(name + tail, omega0=1.0, **point)) == (name not in MASSES), name
    assert force_balances(**stalled) is force_balances(**apart, omega0=1.0) is None
    assert agree(truth("M_eff", **stalled), truth("M_eff", **AT_REST))


def test_digits_asked_for():
    quick, slow = (truth("T_in_wrt_ec_m_rod", digits=digits, **POINTS[1]) for digits in (50, 500))
    with mpmath.workdps(600):
        assert 0 < abs(quick - slow) < abs(slow) * mpmath.mpf(10) ** -50


def test_names():
    names = force_names()
    assert len(names) == len(set(names)) == len(FORCES) * 19
    assert not {*FORCES} & {*QUANTITIES}
    assert {*TOUCHED, *SHAKING} < {*FORCES}
    assert {*FORCES} == DEGREES.keys(), f"in one alone: {sorted({*FORCES} ^ DEGREES.keys())}: see {__file__}"
    point = POINTS[1]
    assert truth("T_in_wrt_g_Y_m_rod", **point) == truth("T_in_wrt_m_rod_g_Y", **point) != 0
    assert truth("F_A_X_wrt_F_X_r_rod", **point) == truth("F_A_X_wrt_r_rod_F_X", **point) == 0
    state = point | {"omega": 2.0}
    assert truth("T_in_wrt_omega_alpha", **state) == 0 != truth("T_in_wrt_omega", **state)
    with pytest.raises(TypeError, match="m_piston"):
        truth("T_in", m_piston=1.0, **point)


@pytest.mark.parametrize("name", ["Y", "a_C_wrt_ec", "omega_BC_wrt_omega0_theta"])
def test_kinematic_names_too(name):
    point = POINTS[1]
    motion = {p: point[p] for p in (*LAW, "branch")}
    assert truth(name, **point) == kinematic_truth(name, **motion)


def test_conditions():
    """A load on a mechanism without mass: T_in = -F_Y dY/dtheta."""
    point = PLAIN | {"omega0": 2.0, "F_Y": 3.0}
    assert conditions("T_in", **point) + 1 == pytest.approx(conditions("V_C", **point))
    assert conditions("T_in", others=OTHERS, **point) == pytest.approx(conditions("V_C", **point))
    assert conditions("V_C", others=OTHERS, **point) == conditions("V_C", **point)
    assert conditions("power_in", **point, r_rod=None) == pytest.approx(conditions("V_C", **point))
    assert conditions("T_in_wrt_F_Y", others=OTHERS, **point) == pytest.approx(conditions("T_in", **point))
    assert conditions("m_rotating", others=OTHERS, **AT_REST) > conditions("m_rotating", **AT_REST) > 0
    crank = PLAIN | {"m_crank": 2.0, "r_crank": 0.5, "omega": 3.0}
    assert conditions("kinetic_energy", others=("m_crank",), **crank) == 3
