"""Every quantity: its equation, its unit, what it means and where the papers have it.

To add one, add its equation here (or a room of its own for a family of them) and its name to
`KINEMATICS`; its sensitivities, catalogue row and tests of freshness and accuracy follow.
"""

from itertools import pairwise

import sympy as sp

from desaxe.units.dimensions import (
    ACCELERATION,
    ANGLE,
    ANGULAR_ACCELERATION,
    ANGULAR_SPEED,
    JERK,
    LENGTH,
    NONE,
    SPEED,
    Unit,
)

from .dynamics import FORCES, define_dynamics, prove, resolve_ratio
from .folded import FOLDED_AREA, WIDE_MARGIN_FORMS, folded, folded_area, prove_folded
from .geometry import POSITION, resolve_geometry
from .loop import AB, BC, branch, ec, r, theta, u
from .motion import alpha, define_law, define_speed_by_alpha, omega, omega2, time_derivative, turn
from .rod import resolve_rod
from .sheet import Sheet, symbol
from .stable import (
    CRANK_PIN,
    HEIGHT_AREA,
    LESS,
    MARGIN_AREA,
    OFFSET,
    AB_out,
    D,
    abs_sin,
    absolute,
    assembled,
    atan2,
    copysign,
    cos_theta,
    crank_drop,
    eps,
    eq,
    le,
    less_by,
    less_from,
    lt,
    margin_area,
    pin_side,
    prove_height,
    rounding,
    sec_phi,
    select,
    side,
    sin_theta,
    tan_phi,
    two_sum_error,
    u_straight,
    where_close,
    wide_margin_test,
)
from .start import define_start

KINEMATICS = (
    "phi", "delta", "Y", "s", "V_B_X", "V_B_Y", "V_B", "a_B_X", "a_B_Y", "a_B", "omega", "omega_BC",
    "alpha_BC", "V_C", "a_C", "j_C", "transmission_angle", "pressure_angle",
)  # fmt: skip
QUANTITIES = (*KINEMATICS, *FORCES)
SECOND_ORDER = ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")
FACTS = ("status", "margin")
STATUS = (
    "0 ok, 1 cannot be assembled here, 2 change point, 3 stalled, 4 bad input, "
    "5 friction jams: no balance of forces, 6 friction: two balances of forces"
)

S, phi = symbol("S"), symbol("phi")


def build_sheet() -> Sheet:
    """The whole sheet under paper A's law of motion."""
    prove_height()
    prove_folded()
    sheet = Sheet((resolve_rod, resolve_geometry, resolve_ratio))
    _define_crank(sheet)
    _define_rod(sheet)
    define_law(sheet)
    _define_angles(sheet)
    _define_crank_motion(sheet)
    _define_slider_motion(sheet)
    define_start(sheet)
    _define_stroke(sheet)
    _define_facts(sheet)
    define_dynamics(sheet)
    prove(sheet)
    return sheet


def _exact_sum(sheet: Sheet, name: str, first: sp.Expr, second: sp.Expr, meaning: str) -> None:
    """name = BC + first + second for lengths first and second, rounded once: the errors are added last."""
    part = sheet.define(f"{name}_part", BC + first)
    total = sheet.define(f"{name}_total", part + second)
    error = sheet.define(f"{name}_error", two_sum_error(BC, first) + two_sum_error(part, second))
    sheet.define(name, total + error, LENGTH, meaning)


def _define_crank(sheet: Sheet) -> None:
    sheet.define("sin_theta", sp.sin(theta), NONE, "sine of the crank angle")
    sheet.define("cos_theta", sp.cos(theta), NONE, "cosine of the crank angle")
    sheet.define("side", copysign(1, sin_theta), NONE, "sigma: which side the crank is on", rigid=True)
    sheet.define("abs_sin", absolute(sin_theta), NONE, "|sin(theta)|")
    sheet.define("eps", cos_theta**2 / (1 + abs_sin), NONE, "1 - |sin(theta)| without cancellation")


def _define_rod(sheet: Sheet) -> None:
    """BC - |u| and the rod's height in the stable variables; the ratios that everything else is made of."""
    sheet.define("wide_margins", wide_margin_test(), NONE, "margins are wide: plain forms will do")
    sheet.define("u_straight", OFFSET)
    sheet.define("pin_side", copysign(1, u_straight), NONE, "nu: the sign of u")
    sheet.define("AB_out", copysign(AB, sin_theta * u_straight), LENGTH, "sigma nu AB")
    out = sheet.define("ec_out", pin_side * ec, LENGTH, "nu ec")
    _exact_sum(sheet, "margin_out", -AB_out, -out, "q: BC - nu (ec + sigma AB)")
    sheet.define("crank_drop", -AB_out * eps)
    near_quarter = sheet.define("near_quarter", le(sp.Float(0.5), abs_sin))
    sheet.define("BC_less_ec", BC - out)
    for name, near, far in zip(("less_from", "less_by"), *LESS, strict=True):
        sheet.define(name, select(near_quarter, near, far))
    # At the last angle that the rod reaches, the sine's last bit must not decide whether it does: what
    # is undecided here is seen to with twice the digits.
    reach = sheet.define("less_rounded", less_from - less_by, LENGTH, "BC - |u|, rounded")
    unsure = sheet.define("less_unsure", rounding(less_by), LENGTH, "what rounding may take from BC - |u|")
    undecided = sheet.define(
        "undecided", lt(absolute(reach), unsure), NONE, "whether the rod reaches is not known"
    )
    surely = select(undecided, unsure, reach)
    room = BC - absolute(symbol("u_straight"))
    sheet.define(
        "less", where_close(surely, room), LENGTH, "BC - |u|, at least what rounding may take from it"
    )
    around = (BC - symbol("u_straight")) * (BC + symbol("u_straight"))
    sheet.define("D", where_close(HEIGHT_AREA, around), Unit(m=2), "BC^2 - u^2", "B (7)")
    sheet.define("S", sp.sqrt(D), LENGTH, "BC cos(phi), the rod's height", "B (7)")
    sheet.define("inv_S", 1 / S, Unit(m=-1), "1 / S")
    beyond = sheet.define("pin_out", AB_out + out)  # exact where they nearly cancel
    # Its sign is right where |ec| is AB too, at the opposite quarter, where u is nothing but rounding else.
    exact = sheet.define("u_exact", select(near_quarter, pin_side * (beyond + crank_drop), u_straight))
    sheet.define(
        "u", where_close(exact, u_straight), LENGTH, "BC sin(phi), crank pin from the slider axis", "A (6)"
    )
    for name, form in WIDE_MARGIN_FORMS.items():
        sheet.define(name.name, form)
    sheet.define("margin_area", MARGIN_AREA, Unit(m=2), "m n = BC^2 - (AB + sigma ec)^2")
    sheet.define("crank_ratio", AB * r, NONE, "AB / S")
    sheet.define("offset_ratio", ec * r, NONE, "ec / S")
    sheet.define("ec_ratio", side * symbol("offset_ratio"), NONE, "sigma ec / S")
    sheet.define("margin_ratio", margin_area * r**2, NONE, "m n / S^2")
    sheet.define("tan_phi", u * r, NONE, "tan(phi) = u / S")
    sheet.define("sec_phi", BC * r, NONE, "1 / cos(phi) = BC / S")


def _define_angles(sheet: Sheet) -> None:
    sheet.define("phi", atan2(u, S), ANGLE, "angle of the rod to the slider axis", "A (6)")
    across = sheet.define("side_u", select(lt(symbol("u_exact"), 0), -1, 1), NONE, "sign of u", rigid=True)
    sheet.define(
        "delta", atan2(S, u), ANGLE, "angle of the rod across the slider axis", "A (5)", differentiate=-phi
    )
    sheet.define("transmission_angle", atan2(S, absolute(u)), ANGLE,
                 "angle between the rod and the normal of the slider axis, at most pi/2",
                 differentiate=-across * phi)  # fmt: skip
    sheet.define("pressure_angle", atan2(absolute(u), S), ANGLE,
                 "angle between the rod and the slider axis, |phi|", differentiate=across * phi)  # fmt: skip


def _define_crank_motion(sheet: Sheet) -> None:
    """Velocity and acceleration of the crank pin B, from its position by time derivatives."""
    by_theta = {sin_theta: cos_theta, cos_theta: -sin_theta}
    for axis, position in zip("XY", CRANK_PIN, strict=True):
        velocity = time_derivative(position, by_theta)
        acceleration = time_derivative(velocity, by_theta).subs(omega**2, omega2)
        sheet.define(f"V_B_{axis}", velocity, SPEED, f"velocity of the crank pin along {axis}", "A (2)")
        sheet.define(f"a_B_{axis}", sp.factor_terms(acceleration), ACCELERATION,
                     f"acceleration of the crank pin along {axis}", "A (4)")  # fmt: skip
    sheet.define("V_B", AB * absolute(omega), SPEED, "speed of the crank pin", "B (2b)",
                 differentiate=AB * turn * omega)  # fmt: skip
    # d|a_B| is AB times omega^2 and alpha in the shares they have in it; at rest it has those of alpha = 0.
    pull = sheet.define("crank_pull", sp.sqrt(omega2**2 + alpha**2))
    share = sheet.define("share_omega2", select(eq(pull, 0), 1, omega2 / pull), rigid=True)
    rest = sheet.define("share_alpha", select(eq(pull, 0), 0, alpha / pull), rigid=True)
    sheet.define("a_B", AB * pull, ACCELERATION, "magnitude of the crank pin's acceleration", "B (3)",
                 differentiate=AB * (share * omega2 + rest * alpha))  # fmt: skip


def _define_slider_motion(sheet: Sheet) -> None:
    """Rates of the slider and the rod: time derivatives of Y and phi along the motion."""
    height = sheet.define("side_height", branch * S)
    straight = sheet.define("Y_straight", AB * cos_theta + height)
    sheet.define("folded", lt(2 * absolute(straight), S))
    sheet.define("folded_area", FOLDED_AREA, Unit(m=2), "S^2 - (AB cos(theta))^2")
    sheet.define("Y",
                 where_close(select(folded, folded_area / (height - AB * cos_theta), straight), straight),
                 LENGTH, "slider position along the slider axis", "A (7)",
                 differentiate=POSITION)  # fmt: skip
    # What Y' is made of: where Y is small, itself and ec; where u is, the height and u.
    sheet.define("lever_X", where_close(select(folded, ec, u), u))
    sheet.define("lever_Y", where_close(select(folded, symbol("Y"), height), height))
    rows = (
        ("V_C", "Y", 1, SPEED, "velocity of the slider", "A (11)"),
        ("a_C", "Y", 2, ACCELERATION, "acceleration of the slider", "A (19)"),
        ("j_C", "Y", 3, JERK, "jerk of the slider", ""),
        ("omega_BC", "phi", 1, ANGULAR_SPEED, "rate of phi, the rod's angular speed", "A (10)"),
        ("alpha_BC", "phi", 2, ANGULAR_ACCELERATION, "rate of omega_BC", "A (14)"),
    )
    for name, base, order, unit, meaning, source in rows:
        sheet.define(name, _rate(base, order), unit, meaning, source)
    for name, base in (("V_C", "Y"), ("omega_BC", "phi")):
        define_speed_by_alpha(sheet, name, symbol(f"{base}_wrt_theta"))


def _define_stroke(sheet: Sheet) -> None:
    """The slider's distance from its outer dead centre, without the cancellation of outer_Y - branch Y.

    Crank and rod enclose the angle beta, 0 at that dead centre. With across = BC sin(beta) and
    along = BC cos(beta), outer_Y^2 - Y^2 = 2 AB BC (1 - cos(beta)), and BC (1 - cos(beta)) is
    across^2/(BC + along) where cos(beta) > 0. By BC and ec the derivative is a difference of
    sec(phi) and of tan(phi) from their values at the dead centre; by AB it is that by BC and
    (1 - cos(beta)) sec(phi).
    """
    outer = sheet.define(
        "outer_Y", sp.sqrt((AB + BC - ec) * (AB + BC + ec)), LENGTH, "|Y| at the outer dead centre"
    )
    along = sheet.define("rod_along_crank", branch * cos_theta * S - u * sin_theta)
    across = sheet.define("rod_across_crank", u * cos_theta + branch * sin_theta * S)
    bend = sheet.define(
        "bend", select(lt(0, along), across**2 / (BC + along), BC - along), LENGTH, "BC (1 - cos(beta))"
    )
    outer_tan, outer_sec = sheet.define("outer_tan", ec / outer), sheet.define("outer_sec", (AB + BC) / outer)
    sheet.define("s", 2 * AB * bend / (outer + branch * symbol("Y")), LENGTH,
                 "slider's distance from its outer dead centre", "B (9)",
                 differentiate=outer - branch * symbol("Y"))  # fmt: skip
    steeper = (outer_tan - tan_phi) * (outer_tan + tan_phi) / (outer_sec + sec_phi)
    by_length = {"ec": tan_phi - outer_tan, "AB": symbol("s_wrt_BC") + bend * r, "BC": steeper}
    for parameter, value in by_length.items():
        sheet.define(f"s_wrt_{parameter}", value, NONE, f"derivative of s by {parameter}")


def _rate(base: str, order: int) -> sp.Expr:
    """The `order`-th time derivative of phi or Y."""
    by_theta = [symbol(base)] + [symbol(f"{base}_wrt" + "_theta" * n) for n in range(1, order + 1)]
    expression: sp.Expr = by_theta[0]
    for _ in range(order):
        expression = time_derivative(expression, dict(pairwise(by_theta)))
    powers = expression.subs(omega**3, symbol("omega3")).subs(omega**2, omega2)
    return powers.subs(omega * alpha, symbol("omega_alpha"))


def _define_facts(sheet: Sheet) -> None:
    """Margin and status; NaN compares false, so what cannot be computed is not assembled."""
    _exact_sum(sheet, "margin", -AB, -sheet.define("abs_ec", absolute(ec)), "BC - AB - |ec|, rounded once")
    sheet.define("status", assembled(0), NONE, STATUS)
    # A derivative that is 0 wherever there is anything to differentiate.
    sheet.define("no_effect_on_rod", select(le(0, D), 0, sp.Symbol("nan", real=True)), rigid=True)
    not_stalled = select(le(0, symbol("omega2_law")), 0, sp.Symbol("nan", real=True))
    sheet.define("not_stalled", select(eq(alpha * theta, 0), 0, not_stalled), rigid=True)
