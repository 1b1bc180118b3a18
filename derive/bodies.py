"""The three free bodies and their Newton-Euler equations, solved by SymPy.

Crank, rod and slider, each with its mass, its moment of inertia about its own centre of mass, gravity
and what its neighbours do to it. The slider only translates: whatever acts on it acts at C. The sense
of a moment is that of theta, so a force F at r has the moment r_Y F_X - r_X F_Y.

`dynamics` writes the same forces in variables in which they are short and do not cancel; `prove`
holds every one of its equations against this solution, or the derivation stops.

Source: paper C, links 2 to 4 and its 8x8 system; paper B, (31) to (48), has parts of it.
"""

from functools import cache

import sympy as sp

from .loop import AB, BC, branch, ec, u
from .sheet import symbol
from .stable import cos_theta, sin_theta

S, alpha, omega2 = symbol("S"), symbol("alpha"), symbol("omega2")
m_crank, m_rod, m_slider, I_crank, I_rod = map(symbol, ("m_crank", "m_rod", "m_slider", "I_crank", "I_rod"))
r_crank, r_rod, F_friction = map(symbol, ("r_crank", "r_rod", "F_friction"))
JOINTS = ("F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_C_X", "F_C_Y", "N_C", "T_in")

OUT = sp.Matrix([sin_theta, cos_theta])  # along the crank
TURNED = sp.Matrix([cos_theta, -sin_theta])  # d(OUT)/dtheta
GRAVITY = sp.Matrix([symbol("g_X"), symbol("g_Y")])
LOAD = sp.Matrix([symbol("F_X"), symbol("F_Y")])

# The rod by the crank angle: phi' = AB cos(theta)/S, and Y = AB cos(theta) + branch S.
_PHI_1 = AB * cos_theta / S
_PHI_2 = (AB * cos_theta) ** 2 * u / S**3 - AB * sin_theta / S
_Y_1 = -AB * sin_theta - branch * u * _PHI_1
_Y_2 = -AB * cos_theta - branch * (AB * cos_theta * _PHI_1 + u * _PHI_2)

POSITIONS = {
    "B": AB * OUT,
    "C": sp.Matrix([-ec, AB * cos_theta + branch * S]),
    "crank": r_crank * OUT,
}
_ACCELERATION_OUT = alpha * TURNED - omega2 * OUT
_ACCELERATIONS = {
    "B": AB * _ACCELERATION_OUT,
    "C": sp.Matrix([0, _Y_1 * alpha + _Y_2 * omega2]),
    "crank": r_crank * _ACCELERATION_OUT,
}
_BY_THETA = {"B": AB * TURNED, "C": sp.Matrix([0, _Y_1]), "crank": r_crank * TURNED}
for _state in (POSITIONS, _ACCELERATIONS, _BY_THETA):
    _state["rod"] = _state["B"] + r_rod / BC * (_state["C"] - _state["B"])

MASSES = {"crank": m_crank, "rod": m_rod, "C": m_slider}
KEPT = (sin_theta, cos_theta, S, u, alpha, omega2, F_friction)  # what the equations are compared in
ROD_TURNS = -branch * _PHI_1  # the rod's rotation by theta, in theta's sense
KINEMATICS = {
    symbol("phi_wrt_theta"): _PHI_1,
    symbol("Y_wrt_theta"): _Y_1,
    symbol("alpha_BC"): _PHI_1 * alpha + _PHI_2 * omega2,
    symbol("a_C"): _ACCELERATIONS["C"][1],
    symbol("Y"): POSITIONS["C"][1],
    symbol("tan_phi"): u / S,
    symbol("inv_S"): 1 / S,
    ec: u - AB * sin_theta,
}


def moment(r: sp.Matrix, force: sp.Matrix) -> sp.Expr:
    """The moment of a force at r about the origin, positive like theta."""
    return r[1] * force[0] - r[0] * force[1]


def newton_euler() -> list[sp.Expr]:
    """The eight equations, each = 0: force sums of three bodies, moment sums of two."""
    at_A, at_B, at_C = (sp.Matrix([symbol(f"F_{p}_X"), symbol(f"F_{p}_Y")]) for p in "ABC")
    guide = sp.Matrix([symbol("N_C"), F_friction])
    crank, rod, B, C = (POSITIONS[name] for name in ("crank", "rod", "B", "C"))
    weight = {name: mass * (GRAVITY - _ACCELERATIONS[name]) for name, mass in MASSES.items()}
    rod_spin = -branch * KINEMATICS[symbol("alpha_BC")]
    return [
        *(at_A - at_B + weight["crank"]),
        symbol("T_in") - moment(crank, at_A) - moment(B - crank, at_B) - I_crank * alpha,
        *(at_B - at_C + weight["rod"]),
        moment(B - rod, at_B) - moment(C - rod, at_C) - I_rod * rod_spin,
        *(at_C + guide + LOAD + weight["C"]),
    ]


@cache
def solution() -> dict[str, sp.Expr]:
    """The joint forces, the guide's normal force and the torque, with friction as a given force."""
    (values,) = sp.linsolve(newton_euler(), [symbol(name) for name in JOINTS])
    forces = dict(zip(JOINTS, values, strict=True))
    return {**forces, **_on_the_frame(forces), **_inertia(), **_energies()}


def _on_the_frame(forces: dict[str, sp.Expr]) -> dict[str, sp.Expr]:
    """Shaking force and shaking moment (about A) of the mechanism and its motor on the frame."""
    guide = sp.Matrix([forces["N_C"], F_friction])
    shaking = -sp.Matrix([forces["F_A_X"], forces["F_A_Y"]]) - guide
    about_A = -forces["T_in"] - moment(POSITIONS["C"], guide)
    return {"F_shaking_X": shaking[0], "F_shaking_Y": shaking[1], "M_shaking": about_A}


def _inertia() -> dict[str, sp.Expr]:
    """The rates of momentum and of angular momentum about A, reversed."""
    rates = {name: mass * _ACCELERATIONS[name] for name, mass in MASSES.items()}
    X, Y = sum(rates.values(), sp.zeros(2, 1))
    spins = I_crank * alpha - branch * I_rod * KINEMATICS[symbol("alpha_BC")]
    about_A = sp.Add(*(moment(POSITIONS[name], rate) for name, rate in rates.items()), spins)
    return {"F_inertia_X": -X, "F_inertia_Y": -Y, "M_inertia": -about_A}


def _energies() -> dict[str, sp.Expr]:
    """Effective inertia, from the kinetic energy of the bodies, and potential energy of gravity."""
    inertia = I_crank + I_rod * ROD_TURNS**2
    inertia += sp.Add(*(mass * _BY_THETA[name].dot(_BY_THETA[name]) for name, mass in MASSES.items()))
    potential = -sp.Add(*(mass * GRAVITY.dot(POSITIONS[name]) for name, mass in MASSES.items()))
    return {"M_eff": inertia, "potential_energy": potential}


def prove(name: str, expression: sp.Expr) -> None:
    """Prove an equation of `dynamics`, in symbols of this file, by the solution; ArithmeticError if wrong."""
    if not _vanishes(expression.subs(KINEMATICS) - solution()[name].subs(KINEMATICS)):
        raise ArithmeticError(f"{name} is not what the free bodies give")


def _vanishes(difference: sp.Expr) -> bool:
    """True if the difference is 0 on sin^2 + cos^2 = 1, S^2 + u^2 = BC^2, branch^2 = 1."""
    numerator = sp.expand(sp.fraction(sp.together(difference))[0])
    circles = ((cos_theta, 1 - sin_theta**2), (S, BC**2 - u**2), (branch, sp.Integer(1)))
    for variable, square in circles:
        numerator = sp.rem(numerator, variable**2 - square, variable)
    return bool(sp.expand(numerator) == 0)
