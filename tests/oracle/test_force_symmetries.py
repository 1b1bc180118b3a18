"""The oracle of forces: mirrors, units, what laws and states have in common; names."""

import math

import mpmath
import pytest

from desaxe.oracle.force_truth import (
    FORCES,
    OTHERS,
    PARAMETERS,
    SHAKING,
    STATE_PARAMETERS,
    TOUCHED,
    force_names,
    truth,
)
from desaxe.oracle.truth import QUANTITIES
from tests.oracle.force_points import AT_REST, CENTRES, POINTS, agree, numbers

# Degrees in mass, length and 1/time of a quantity, and of an input.
FORCE, TORQUE = (1, 1, 2), (1, 2, 2)
DEGREES = {
    **dict.fromkeys(FORCES, FORCE),
    **dict.fromkeys(("T_in", "M_shaking", "M_inertia", "kinetic_energy", "potential_energy"), TORQUE),
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
ODD_IN_X |= {"F_A_X", "F_B_X", "F_C_X", "F_shaking_X", "F_inertia_X", "M_inertia"}
ODD_IN_Y = {"T_in", "M_shaking", "F_friction", "F_A_Y", "F_B_Y", "F_C_Y", "F_shaking_Y"}
ODD_IN_Y |= {"F_inertia_Y", "M_inertia"}


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
