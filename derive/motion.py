"""The crank's law of motion, and time derivatives along it.

Paper A's law: omega(theta)^2 = omega0^2 + 2 alpha theta, turning the way omega0 points (forwards
where it is 0). Or a given state: omega and alpha at this instant. Either way d(theta)/dt = omega,
d(omega)/dt = alpha and alpha is constant, so a time derivative is the same expression; only how
omega depends on the parameters differs. The state therefore replaces these equations and no others.

Only omega^2, omega^3 and omega alpha enter most quantities: they are differentiated themselves, so
that the quantities have their limits at rest. At rest under the law (omega0 = alpha = 0) omega is
omega0, and has that limit's derivatives; only those of omega itself by alpha are infinite there.
"""

from itertools import combinations_with_replacement

import sympy as sp

from desaxe.mechanism.names import per, sensitivity
from desaxe.units.dimensions import ANGULAR_SPEED, NONE, Unit

from .loop import theta
from .sheet import Sheet, symbol
from .stable import eq, le, lt, select, two_product_error

omega, omega2, omega0, alpha, turn, nan = map(symbol, ("omega", "omega2", "omega0", "alpha", "turn", "nan"))
MOVING = ("theta", "omega0", "alpha")
SQUARE_RATES = (("theta",), ("omega0",), ("alpha",), ("theta", "alpha"), ("omega0", "omega0"))
UNITS = {
    "omega": ANGULAR_SPEED,
    "omega2": Unit(0, -2, 2),
    "omega3": Unit(0, -3, 3),
    "omega_alpha": Unit(0, -3, 2),
}
LAW = omega0**2 + 2 * alpha * theta  # = omega^2, paper A, listing


def time_derivative(expression: sp.Expr, by_theta: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
    """d/dt of an expression in omega, alpha and symbols that turn with the crank (`by_theta`)."""
    turning = (expression.diff(s) * rate * omega for s, rate in by_theta.items())
    return sp.expand(expression.diff(omega) * alpha + sp.Add(*turning))


def define_law(sheet: Sheet) -> None:
    """omega, omega^2 and their derivatives under paper A's law."""
    constant_speed = eq(alpha * theta, 0)  # NaN where theta is: it must not be lost here
    _define_square(sheet)
    sheet.define("stalled", lt(symbol("omega2_law"), 0), NONE, "the crank stopped before this angle")
    square = select(symbol("stalled"), nan, symbol("omega2_law"))
    sheet.define("omega2", select(constant_speed, omega0**2, square), UNITS["omega2"],
                 "square of the crank's speed, NaN where it has stalled", differentiate=LAW)  # fmt: skip
    sheet.define("turn", select(le(0, omega0), 1, -1), NONE, "way of turning", rigid=True)
    _define_turning(sheet, omega0)
    sheet.define("omega", select(constant_speed, omega0, turn * sp.sqrt(omega2)), ANGULAR_SPEED,
                 "angular speed of the crank", "A listing")  # fmt: skip
    sheet.define("inv_omega", select(eq(theta, 0), 0, 1 / omega), Unit(0, 1, -1), "1 / omega, 0 at the start")
    for parameters, value in {**_omega_rates(), **_omega_second_rates()}.items():
        _define_rate(sheet, "omega", parameters, value)
    for parameters in SQUARE_RATES:
        _define_rate(sheet, "omega2", parameters, LAW.diff(*map(symbol, parameters)))
    _define_powers(sheet)


def _define_square(sheet: Sheet) -> None:
    """omega^2 by the law, with its sign and its digits where the crank nearly stops.

    Where the two terms nearly cancel their sum is exact (Sterbenz), so only the products' roundings count.
    """
    start, gained = sheet.define("omega2_start", omega0**2), sheet.define("omega2_gained", 2 * alpha * theta)
    rounded = two_product_error(omega0, omega0) + two_product_error(2 * alpha, theta)
    total, lost = sheet.define("omega2_total", start + gained), sheet.define("omega2_lost", rounded)
    sheet.define(
        "omega2_law", total + lost, UNITS["omega2"], "omega^2 by the law", "A listing", differentiate=LAW
    )


def _define_powers(sheet: Sheet) -> None:
    """omega^3 and omega alpha, with derivatives that keep their limits where omega is 0."""
    sheet.define("omega3", omega * omega2, Unit(0, -3, 3), "omega^3")
    for parameter in MOVING:
        by_square = sp.Rational(3, 2) * omega * symbol(sensitivity("omega2", parameter))
        _define_rate(sheet, "omega3", (parameter,), by_square)
    sheet.define("omega_alpha", omega * alpha, Unit(0, -3, 2), "omega alpha")
    moving = omega + alpha * symbol("omega_wrt_alpha")
    _define_rate(sheet, "omega_alpha", ("alpha",), select(eq(alpha, 0), omega, moving))


def define_speed_by_alpha(sheet: Sheet, name: str, by_theta: sp.Symbol) -> None:
    """The derivative of by_theta omega by alpha: by_theta theta/omega, of which the two ends come last.

    theta/omega by itself may be too small for a double where their product with a large by_theta is not.
    """
    plain, unit = sheet.chain_rule(name, "alpha"), sheet.equations[name].unit
    assert unit is not None
    per_turn = sheet.define(f"{name}_per_theta", by_theta * symbol("inv_omega"))
    meaning = f"derivative of {name} with respect to alpha"
    sheet.define(f"{name}_wrt_alpha", per_turn * theta, per(unit, "alpha"), meaning, differentiate=plain)


def _define_rate(sheet: Sheet, name: str, parameters: tuple[str, ...], value: sp.Expr | int) -> None:
    meaning = f"derivative of {name} with respect to {', '.join(parameters)}"
    sheet.define(sensitivity(name, *parameters), value, per(UNITS[name], *parameters), meaning)


def _omega_rates() -> dict[tuple[str, ...], sp.Expr]:
    """From 2 omega d(omega) = d(omega^2), with the limits at rest."""
    limits = {"theta": (eq(alpha, 0), 0), "omega0": (eq(omega, omega0), 1), "alpha": (eq(theta, 0), 0)}
    return {(p,): select(*limit, LAW.diff(symbol(p)) / (2 * omega)) for p, limit in limits.items()}


def _omega_second_rates() -> dict[tuple[str, ...], sp.Expr]:
    """From omega d2(omega) = d2(omega^2)/2 - d(omega) d(omega), over omega^3."""
    result: dict[tuple[str, ...], sp.Expr] = {}
    for p, q in combinations_with_replacement(MOVING, 2):
        first, second = symbol(p), symbol(q)
        numerator = LAW.diff(first, second) / 2 * LAW - LAW.diff(first) * LAW.diff(second) / 4
        value = sp.factor(numerator) / (omega2 * omega)
        # By theta and by omega0 these are 0 for every alpha = 0, at rest too.
        result[p, q] = value if "alpha" in (p, q) else select(eq(alpha, 0), 0, value)
    return result


def _define_turning(sheet: Sheet, speed: sp.Symbol) -> None:
    """The way of turning that the strokes of a whole design depend on: the sign of the speed given."""
    backwards = select(lt(speed, 0), -1, nan)
    sheet.define("turning", select(le(0, speed), 1, backwards), NONE, "way of turning", rigid=True)


def state_sheet() -> Sheet:
    """The equations of a given state (omega, alpha), which replace those of the law.

    omega stands in the place of omega0: a derivative with respect to it carries omega0's name.
    """
    sheet = Sheet(())
    sheet.define("omega2", omega**2, UNITS["omega2"], "square of the crank's speed")
    sheet.define("stalled", lt(omega2, 0), NONE, "never: a given speed is real")
    sheet.define("turn", select(le(0, omega), 1, -1), NONE, "way of turning")
    _define_turning(sheet, omega)
    sheet.define("not_stalled", 0)
    sheet.define("inv_omega", 0)  # where alpha does not change omega
    sheet.define("near_start", lt(1, 0))  # never: a state does not depend on how it came about
    for parameters in (*_omega_rates(), *_omega_second_rates()):
        _define_rate(sheet, "omega", parameters, int(parameters == ("omega0",)))
    for parameters in SQUARE_RATES:
        by_omega = set(parameters) == {"omega0"}
        value = (omega**2).diff(*(omega for _ in parameters)) if by_omega else 0
        _define_rate(sheet, "omega2", parameters, value)
    return sheet
