"""Forces, torque and energies, in lumped masses: short, and without cancellation.

The rod moves like two point masses at B and C with its mass and its centre of mass, less a moment of
inertia by which those exceed its own (`I_lumping`, paper B (31) to (33), which leave it out). Written
so, what turns with the crank falls out of the torque at constant speed by itself, the guide's force has
one term for each cause, and only rates of phi and Y enter that keep their digits next to a change
point. Each equation is proved equal to the solved free bodies (`bodies`) when it is derived.

Friction at the guide is -mu |N_C| against the slider's motion. N_C = N0 + k |N_C|, where N0 is the
normal force without friction and k = branch tan(phi) mu sigma, has one solution for -1 <= k sign(N0) < 1,
which has N0's sign; none above (the friction jams) and two below.
"""

import sympy as sp

from desaxe.mechanism.names import CENTRES, PARAMETERS, parts, per, sensitivity
from desaxe.units.dimensions import (
    ENERGY,
    FORCE,
    INERTIA,
    LENGTH,
    MASS,
    MASS_MOMENT,
    NONE,
    PER_TIME2,
    POWER,
    TORQUE,
    Unit,
)

from . import bodies
from .loop import AB, BC, branch, ec
from .sheet import Equation, Sheet, symbol
from .stable import assembled, cos_theta, eq, le, lt, sec_phi, select, sin_theta, tan_phi

FORCES = (
    "T_in", "F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_C_X", "F_C_Y", "N_C", "F_friction", "F_shaking_X",
    "F_shaking_Y", "M_shaking", "F_inertia_X", "F_inertia_Y", "M_inertia", "power_in", "F_A", "F_B", "F_C",
    "P_friction", "kinetic_energy", "potential_energy", "M_eff", "m_rotating", "m_reciprocating", "I_lumping",
)  # fmt: skip

LUMPS = FORCES[-3:]  # of the links alone, without a mechanism

alpha, omega, omega2, nan, Y, V_C, a_C, alpha_BC = map(
    symbol, ("alpha", "omega", "omega2", "nan", "Y", "V_C", "a_C", "alpha_BC")
)
m_crank, m_rod, m_slider, I_crank, I_rod = (
    bodies.m_crank, bodies.m_rod, bodies.m_slider, bodies.I_crank, bodies.I_rod,
)  # fmt: skip
r_crank, r_rod, mu = bodies.r_crank, bodies.r_rod, symbol("mu")
(F_X, F_Y), (g_X, g_Y) = bodies.LOAD, bodies.GRAVITY
phi_1, Y_1, inv_S = symbol("phi_wrt_theta"), symbol("Y_wrt_theta"), symbol("inv_S")


m_at_B, m_at_C, m_reciprocating, I_lumping, swing, I_turning, m_turning = map(
    symbol, ("m_at_B", "m_at_C", "m_reciprocating", "I_lumping", "swing", "I_turning", "m_turning")
)


def resolve_ratio(sheet: Sheet, name: str) -> Equation | None:
    """tan(phi) and 1/S by a parameter, from that of phi: no difference of large terms."""
    base, parameters = parts(name)
    if base not in ("tan_phi", "inv_S") or len(parameters) != 1 or parameters[0] not in PARAMETERS[:4]:
        return None
    by_phi = sheet.derivative("phi", parameters[0])
    expression = sec_phi**2 * by_phi
    if base == "inv_S":
        expression = -sec_phi * inv_S**2 if parameters == ("BC",) else inv_S * tan_phi * by_phi
    unit = Unit(m=-1) if base == "inv_S" else NONE
    meaning = f"derivative of {base} with respect to {parameters[0]}"
    return Equation(expression, per(unit, *parameters), meaning)


def centres_sheet() -> Sheet:
    """The equations of centres of mass that are halfway along their links, and move with them."""
    sheet = Sheet(())
    for centre, length in zip(CENTRES, (AB, BC), strict=True):
        sheet.define(centre, length / 2, LENGTH, f"half of {length}")
        by_length = sensitivity(centre, str(length))
        sheet.define(by_length, sp.Rational(1, 2), NONE, f"derivative of {centre} with respect to {length}")
    return sheet


def define_dynamics(sheet: Sheet) -> None:
    """All forces and energies, after the motion."""
    _define_lumps(sheet)
    _define_loads(sheet)
    _define_friction(sheet)
    _define_joints(sheet)
    _define_magnitudes(sheet)
    _define_frame(sheet)
    _define_energies(sheet)


def _define_lumps(sheet: Sheet) -> None:
    """Lumped masses; a centre of mass that is an input does not move with its link's length."""
    for centre, length in zip(CENTRES, ("AB", "BC"), strict=True):
        meaning = f"derivative of {centre} with respect to {length}"
        sheet.define(sensitivity(centre, length), 0, NONE, meaning)
    _define_share(sheet, "m_crank_at_B", m_crank, r_crank, AB, "the crank's mass as if at B", "B (35)")
    _define_share(sheet, "m_at_C", m_rod, r_rod, BC, "the rod's mass at C", "B (33)")
    sheet.define("m_at_B", m_rod * ((BC - r_rod) / BC), MASS, "the rod's mass at B", "B (32)")
    sheet.define(sensitivity("m_at_B", "BC"), -symbol(sensitivity("m_at_C", "BC")), per(MASS, "BC"),
                 "derivative of m_at_B by BC")  # fmt: skip
    rows = (
        ("m_rotating", m_at_B + symbol("m_crank_at_B"), MASS, "rotating mass, as if at the crank pin",
         "B (36)"),
        ("m_reciprocating", m_slider + m_at_C, MASS, "reciprocating mass", "B (34)"),
        ("I_lumping", m_rod * r_rod * (BC - r_rod) - I_rod, INERTIA,
         "moment of inertia by which two point masses at B and C exceed the rod's own", ""),
        ("swing", m_crank * r_crank + m_at_B * AB, MASS_MOMENT, "mass moment that turns with AB", ""),
        ("I_turning", I_crank + m_crank * r_crank**2 + m_at_B * AB**2, INERTIA,
         "moment of inertia about A that turns with AB", ""),
        ("m_turning", m_crank + m_at_B, MASS, "mass that turns with AB", ""),
    )  # fmt: skip
    for name, expression, unit, meaning, source in rows:
        sheet.define(name, expression, unit, meaning, source)


def _define_share(
    sheet: Sheet, name: str, mass: sp.Symbol, centre: sp.Symbol, length: sp.Symbol, meaning: str, source: str
) -> None:
    """mass centre/length, whose derivative is exactly 0 where the centre moves with the length."""
    sheet.define(name, mass * (centre / length), MASS, meaning, source)
    moved = symbol(sensitivity(centre.name, length.name)) * length - centre
    by_length = sensitivity(name, length.name)
    sheet.define(
        by_length,
        mass * moved / length**2,
        per(MASS, length.name),
        f"derivative of {name} with respect to {length}",
    )


def _define_loads(sheet: Sheet) -> None:
    """Inertia forces and external loads, without friction."""
    sheet.define("crank_X", alpha * cos_theta - omega2 * sin_theta, PER_TIME2,
                 "acceleration along X of a point of the crank, per distance from A")  # fmt: skip
    sheet.define("crank_Y", -(alpha * sin_theta + omega2 * cos_theta), PER_TIME2,
                 "acceleration along Y of a point of the crank, per distance from A")  # fmt: skip
    sheet.define("thrust_smooth", m_reciprocating * (a_C - g_Y) - F_Y, FORCE,
                 "force along Y on the reciprocating mass, without friction")  # fmt: skip
    sheet.define(
        "rod_twist", I_lumping * alpha_BC * inv_S, FORCE, "side force for the rod's moment of inertia"
    )
    sheet.define("lean", branch * tan_phi, NONE, "side force per thrust")
    sheet.define("N_smooth", lean * thrust_smooth + rod_twist - m_reciprocating * g_X - F_X, FORCE,
                 "normal force at the guide, without friction")  # fmt: skip


hypot = sp.Function("hypot")
lean, thrust_smooth, rod_twist, N_smooth, crank_X, crank_Y = map(
    symbol, ("lean", "thrust_smooth", "rod_twist", "N_smooth", "crank_X", "crank_Y")
)
N_C, F_friction, thrust, side_push, T_in = map(symbol, ("N_C", "F_friction", "thrust", "side_push", "T_in"))


def _sign(x: sp.Expr) -> sp.Expr:
    """The sign of x: 1, 0 or -1; NaN for NaN."""
    return select(lt(0, x), 1, select(lt(x, 0), -1, x))


def _define_friction(sheet: Sheet) -> None:
    """The normal force that is consistent with the friction which it causes."""
    way = sheet.define("way", select(eq(omega, 0), alpha, omega), rigid=True)
    sliding = sheet.define("sliding", _sign(Y_1) * _sign(way), NONE,
                           "sigma: the slider's way of sliding, or of starting", rigid=True)  # fmt: skip
    pressed = sheet.define("pressed", _sign(N_smooth), NONE, "sign of N_C", rigid=True)
    wedge = sheet.define(
        "wedge", lean * mu * sliding * pressed, NONE, "share of N_C that friction itself causes"
    )
    normal = N_smooth / (1 - wedge)
    alone = sp.Function("and")(le(-1, wedge), lt(wedge, 1))
    sheet.define("N_C", select(alone, normal, nan), FORCE, "force of the guide on the slider along X",
                 "C (link 4)", differentiate=normal)  # fmt: skip
    sheet.define("F_friction", -mu * sliding * pressed * N_C, FORCE,
                 "friction of the guide on the slider along Y", "C (matrix, mu)")  # fmt: skip
    sheet.define("one_balance", select(alone, 0, nan), rigid=True)
    balance = select(lt(wedge, 1), select(lt(wedge, -1), 6, 0), 5)
    sheet.define("force_status", assembled(balance), NONE, "status of a request for forces")


def _define_joints(sheet: Sheet) -> None:
    """Forces at C, B and A, each on the link that comes later on the way from the frame to the slider."""
    sheet.define("thrust", thrust_smooth - F_friction, FORCE, "axial force on the lumped slider")
    sheet.define("side_push", lean * thrust + rod_twist, FORCE, "force to the side on the lumped slider")
    rows = (
        ("F_C_X", m_at_C * g_X - side_push, "force of the rod on the slider along X", "C (link 4)"),
        ("F_C_Y", m_slider * (a_C - g_Y) - F_Y - F_friction, "force of the rod on the slider along Y",
         "C (link 4)"),
        ("F_B_X", m_at_B * (AB * crank_X - g_X) - side_push, "force of the crank on the rod along X",
         "C (link 3)"),
        ("F_B_Y", m_at_B * (AB * crank_Y - g_Y) + thrust, "force of the crank on the rod along Y",
         "C (link 3)"),
        ("F_A_X", swing * crank_X - m_turning * g_X - side_push, "force of the frame on the crank along X",
         "C (link 2)"),
        ("F_A_Y", swing * crank_Y - m_turning * g_Y + thrust, "force of the frame on the crank along Y",
         "C (link 2)"),
    )  # fmt: skip
    for name, expression, meaning, source in rows:
        sheet.define(name, expression, FORCE, meaning, source)
    weight = swing * (g_X * cos_theta - g_Y * sin_theta)
    torque = I_turning * alpha + Y_1 * thrust - I_lumping * phi_1 * alpha_BC - weight
    sheet.define("T_in", torque, TORQUE, "torque that the drive applies to the crank", "C (link 2)")
    sheet.define("power_in", T_in * omega, POWER, "power that the drive puts in, T_in omega")


def _define_magnitudes(sheet: Sheet) -> None:
    """Magnitudes of the joint forces, and the power lost to friction; a magnitude of 0 has no derivative."""
    joints = (("A", "frame on the crank"), ("B", "crank on the rod"), ("C", "rod on the slider"))
    for joint, bodies_of_joint in joints:
        X, Y = symbol(f"F_{joint}_X"), symbol(f"F_{joint}_Y")
        sheet.define(f"F_{joint}", hypot(X, Y), FORCE, f"magnitude of the force of the {bodies_of_joint}",
                     differentiate=sp.sqrt(X**2 + Y**2))  # fmt: skip
    sheet.define("P_friction", -F_friction * V_C, POWER, "power lost in the guide by friction")
    # At rest the speed's derivative is infinite, but nothing rubs.
    by_alpha = (sheet.derivative(name, "alpha") for name in ("F_friction", "V_C"))
    forces, speeds = by_alpha
    rubbed = select(eq(F_friction, 0), 0, F_friction * speeds)
    sheet.define(sensitivity("P_friction", "alpha"), -(forces * V_C + rubbed), per(POWER, "alpha"),
                 "derivative of P_friction by alpha")  # fmt: skip


def _define_frame(sheet: Sheet) -> None:
    """Shaking force and moment on the frame, loads less inertia forces; and those of inertia alone."""
    m_total = sheet.define("m_total", m_turning + m_reciprocating, MASS, "mass of all links")
    sheet.define("F_shaking_X", m_total * g_X + F_X - swing * crank_X, FORCE,
                 "force of the mechanism on the frame along X")  # fmt: skip
    sheet.define("F_shaking_Y", m_total * g_Y + F_Y - swing * crank_Y - m_reciprocating * a_C, FORCE,
                 "force of the mechanism on the frame along Y", "B (46)")  # fmt: skip
    spun = I_turning * alpha + branch * I_lumping * alpha_BC
    sheet.define("F_inertia_X", -swing * crank_X, FORCE, "force of moving masses on the foundation along X")
    sheet.define("F_inertia_Y", -swing * crank_Y - m_reciprocating * a_C, FORCE,
                 "force of moving masses on the foundation along Y")  # fmt: skip
    sheet.define("M_inertia", -ec * m_reciprocating * a_C - spun, TORQUE,
                 "moment of moving masses on the foundation, about A")  # fmt: skip
    pulled = Y * (m_reciprocating * g_X + F_X) + ec * (m_reciprocating * (g_Y - a_C) + F_Y)
    weight = swing * (g_X * cos_theta - g_Y * sin_theta)
    sheet.define("M_shaking", weight + pulled - spun, TORQUE,
                 "moment of the mechanism and its drive on the frame, about A")  # fmt: skip


def _define_energies(sheet: Sheet) -> None:
    M_eff = sheet.define("M_eff", I_turning + m_reciprocating * Y_1**2 - I_lumping * phi_1**2, INERTIA,
                         "effective moment of inertia at the crank")  # fmt: skip
    sheet.define("kinetic_energy", M_eff * omega2 / 2, ENERGY, "kinetic energy of all links")
    height = swing * (g_X * sin_theta + g_Y * cos_theta) + m_reciprocating * (g_Y * Y - ec * g_X)
    sheet.define("potential_energy", -height, ENERGY, "potential energy of gravity, 0 at A")


# What is held against the solved free bodies; N_C with friction as a given force.
PROVED = {name: symbol(name) for name in FORCES[:15] if name not in ("N_C", "F_friction")}
PROVED |= {"N_C": side_push - m_reciprocating * g_X - F_X}
PROVED |= {name: symbol(name) for name in ("M_eff", "potential_energy")}


def prove(sheet: Sheet) -> None:
    """Prove every force, torque and energy against the free bodies; ArithmeticError if one differs."""
    for name, expression in PROVED.items():
        bodies.prove(name, _written_out(sheet, expression))


def _written_out(sheet: Sheet, expression: sp.Expr) -> sp.Expr:
    """The expression in the symbols of the free bodies: names of this file replaced by their equations."""
    kept = {*bodies.KINEMATICS, *bodies.KEPT}
    while names := [s for s in expression.free_symbols - kept if s.name in sheet.equations]:
        expression = expression.subs({s: sheet.equations[s.name].expression for s in names})
    return expression
