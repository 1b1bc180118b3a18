"""`desaxe.equation`: one quantity as a SymPy expression and as LaTeX.

The closed form is the textbook one, in the parameters alone, by differentiating the solved loop.
It is for reading and for symbolic work; numbers come from the stable form, whose lines `steps` has.
"""

from functools import cache
from typing import NamedTuple

import sympy as sp

from desaxe.mechanism.names import LOADS, PARAMETERS, WHOLE, parts
from desaxe.support.shown import shown

from . import bodies
from .dynamics import FORCES, LUMPS, mu
from .loop import AB, BC, branch, ec, slider, solved, theta, u
from .motion import LAW, alpha, omega, omega0
from .stable import cos_theta, sin_theta
from .stable_text import stable_form, stable_latex

S = sp.Symbol("S", real=True)
SPEED = sp.Piecewise((-1, omega0 < 0), (1, True)) * sp.sqrt(LAW)  # omega, turning the way omega0 points
LATEX_NAMES = {
    "phi": r"\varphi", "delta": r"\delta", "omega": r"\omega", "omega_BC": r"\omega_{BC}",
    "alpha_BC": r"\alpha_{BC}", "theta": r"\theta", "ec": "e_c", "omega0": r"\omega_0", "alpha": r"\alpha",
    "AB": r"\overline{AB}", "BC": r"\overline{BC}",
    "transmission_angle": r"\gamma", "mu": r"\mu", "pressure_angle": r"|\varphi|", "branch": r"\sigma",
    "theta_outer": r"\theta_o", "theta_inner": r"\theta_i", "Y_outer": "Y_o", "Y_inner": "Y_i", "stroke": "H",
    "time_ratio": "Q", "advance_angle": r"\theta_{adv}", "return_angle": r"\theta_{ret}",
    "max_pressure_angle": r"|\varphi|_{max}", "min_pressure_angle": r"|\varphi|_{min}",
    "min_transmission_angle": r"\gamma_{min}", "max_transmission_angle": r"\gamma_{max}",
}  # fmt: skip


FORMS = ("textbook", "stable")


class EquationText(NamedTuple):
    """`expression` in the parameters, its LaTeX `lhs = rhs`, unit, meaning, source, stable steps."""

    name: str
    expression: sp.Expr
    latex: str
    unit: str
    meaning: str
    source: str
    steps: tuple[str, ...]

    def __repr__(self) -> str:
        source = f" ({self.source})" if self.source else ""
        return f"{self.name} [{self.unit}], {self.meaning}{source}\n{self.name} = {self.expression}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex}$"


def equation(name: str, form: str = "textbook") -> EquationText:
    """The equation of a quantity or sensitivity: SymPy expression, LaTeX, and its stable steps.

    form  "textbook": the closed form, by differentiating the solved loop
          "stable": the form that is computed, in which nothing cancels; its LaTeX has one row for each step

    The expression is in `theta, ec, AB, BC, omega0, alpha, branch` (SI, radians), under paper A's law
    omega^2 = omega0^2 + 2 alpha theta; the LaTeX writes omega for it. `steps` are the lines that are
    computed. Raises ValueError for an unknown name.
    """
    from desaxe.mechanism.catalogue import quantity

    known = quantity(name)
    if not isinstance(form, str) or form not in FORMS:
        raise ValueError(f"form = {shown(form)}: it is one of {', '.join(FORMS)}")
    if form == "stable":
        result = stable_form(name)
        derivatives = {
            each: latex_name(each) for each in result.definitions if each == name or "_wrt_" in each
        }
        latex = stable_latex(result, {**_names_in_latex(), **derivatives})
        return EquationText(
            name, result.expression, latex, known.unit, known.meaning, known.source, _steps(name)
        )
    if name in ("status", "margin"):
        expression = BC - AB - sp.Abs(ec) if name == "margin" else _status()
    else:
        base, parameters = parts(name)
        expression = closed_form(base)
        for parameter in parameters:
            expression = _derivative(expression, parameter)
    latex = f"{latex_name(name)} = {sp.latex(expression, symbol_names=_latex_symbols())}"
    return EquationText(
        name, expression.subs(omega, SPEED), latex, known.unit, known.meaning, known.source, _steps(name)
    )


def _derivative(expression: sp.Expr, parameter: str) -> sp.Expr:
    """The total derivative: omega d(omega) = d(omega^2)/2."""
    p = _parameter(parameter)
    return expression.diff(p) + expression.diff(omega) * LAW.diff(p) / (2 * omega)


def _parameter(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


@cache
def closed_form(base: str) -> sp.Expr:
    """The textbook form of a quantity, by time derivatives of the solved loop."""
    if base in FORCES:
        return _force(base)
    if base in WHOLE:
        return _whole(base)
    across = solved()[u]
    height = sp.sqrt(BC**2 - across**2)
    position = solved()[slider].subs(S, height)
    angle = sp.asin(across / BC)
    crank = {"X": AB * sp.sin(theta), "Y": AB * sp.cos(theta)}
    if base == "phi":
        result = angle
    elif base in ("V_B", "a_B"):
        turns = 1 if base == "V_B" else 2
        result = sp.sqrt(sp.Add(*(_rate(p, turns) ** 2 for p in crank.values())))
    elif base.startswith(("V_B_", "a_B_")):
        result = _rate(crank[base[-1]], 1 if base[0] == "V" else 2)
    else:
        result = {
            "Y": position,
            "omega": omega,
            "delta": sp.acos(across / BC),
            "transmission_angle": sp.pi / 2 - sp.Abs(angle),
            "pressure_angle": sp.Abs(angle),
            "s": sp.sqrt((AB + BC) ** 2 - ec**2) - branch * position,
            "omega_BC": _rate(angle, 1),
            "alpha_BC": _rate(angle, 2),
            "V_C": _rate(position, 1),
            "a_C": _rate(position, 2),
            "j_C": _rate(position, 3),
        }.get(base)
    if result is None:
        raise LookupError(f"{base} has no closed form here yet")
    return sp.simplify(result) if base in ("V_B", "a_B") else result


def _whole(base: str) -> sp.Expr:
    """A quantity of a whole design, from the triangle A B C in line; the rod at its steepest and flattest."""
    outer, inner = sp.asin(ec / (AB + BC)), sp.asin(ec / (BC - AB))
    far, near = (sp.sqrt(reach**2 - ec**2) for reach in (AB + BC, BC - AB))
    beta = inner - outer
    steep, flat = (sp.asin(lean / BC) for lean in (AB + sp.Abs(ec), sp.Max(sp.Abs(ec) - AB, 0)))
    return {
        "Y_outer": branch * far,
        "Y_inner": branch * near * sp.Piecewise((-1, BC < AB), (1, True)),
        "theta_outer": sp.Piecewise((sp.pi, branch < 0), (0, True)) - branch * outer,
        "theta_inner": sp.Piecewise((0, branch < 0), (sp.pi, True)) - branch * inner,
        "stroke": far - near,
        "advance_angle": sp.pi + branch * beta,
        "return_angle": sp.pi - branch * beta,
        "time_ratio": (sp.pi + sp.Abs(beta)) / (sp.pi - sp.Abs(beta)),
        "max_pressure_angle": steep,
        "min_transmission_angle": sp.pi / 2 - steep,
        "min_pressure_angle": flat,
        "max_transmission_angle": sp.pi / 2 - flat,
    }[base]


def _force(base: str) -> sp.Expr:
    """A force or energy, from the solved free bodies; friction in proportion to the normal force."""
    if base in LUMPS:
        return _lump(base)
    if base == "power_in":
        return closed_form("T_in") * omega
    if base == "P_friction":
        return -closed_form("F_friction") * closed_form("V_C")
    if base in ("F_A", "F_B", "F_C"):
        return sp.sqrt(closed_form(f"{base}_X") ** 2 + closed_form(f"{base}_Y") ** 2)
    if base == "kinetic_energy":
        return closed_form("M_eff") * omega**2 / 2
    pushed = bodies.solution()["N_C"]
    smooth = pushed.subs(bodies.F_friction, 0)
    sliding = _sign(closed_form("V_C").diff(omega) * sp.Piecewise((alpha, sp.Eq(omega, 0)), (omega, True)))
    pressed = _sign(_in_parameters(smooth))
    wedge = -sp.diff(pushed, bodies.F_friction) * mu * sliding * pressed
    normal = smooth / (1 - wedge)
    friction = -mu * sliding * pressed * normal
    result = {"N_C": normal, "F_friction": friction}.get(base)
    if result is None:
        result = bodies.solution()[base].subs(bodies.F_friction, friction)
    return _in_parameters(result)


def _lump(base: str) -> sp.Expr:
    at_B, at_C = bodies.m_rod * (BC - bodies.r_rod) / BC, bodies.m_rod * bodies.r_rod / BC
    return {
        "m_rotating": at_B + bodies.m_crank * bodies.r_crank / AB,
        "m_reciprocating": bodies.m_slider + at_C,
        "I_lumping": bodies.m_rod * bodies.r_rod * (BC - bodies.r_rod) - bodies.I_rod,
    }[base]


def _sign(x: sp.Expr) -> sp.Expr:
    """The sign of x as a piecewise constant."""
    return sp.Piecewise((-1, x < 0), (0, sp.Eq(x, 0)), (1, True))


def _in_parameters(expression: sp.Expr) -> sp.Expr:
    """An expression of the free bodies in the parameters alone."""
    across = solved()[u]
    height = sp.sqrt(BC**2 - across**2)
    values = {u: across, bodies.S: height, bodies.omega2: omega**2}
    angles = {sin_theta: sp.sin(theta), cos_theta: sp.cos(theta)}
    return expression.subs({**values, **angles})


def _rate(expression: sp.Expr, turns: int) -> sp.Expr:
    """A time derivative: d(theta)/dt = omega, d(omega)/dt = alpha."""
    for _ in range(turns):
        expression = expression.diff(theta) * omega + expression.diff(omega) * alpha
    return expression


def _status() -> sp.Expr:
    across = solved()[u]
    return sp.Piecewise(
        (1, sp.Abs(across) > BC), (2, sp.Eq(sp.Abs(across), BC)), (3, LAW < 0), (0, True), evaluate=False
    )


def _steps(name: str) -> tuple[str, ...]:
    """The lines of the frozen program that compute it."""
    from desaxe.compiler.text import with_short_temporaries, write_lines
    from desaxe.mechanism.program import program_of

    return tuple(write_lines(with_short_temporaries(program_of((name,)))))


def latex_name(name: str) -> str:
    r"""`a_C_wrt_ec` as \frac{\partial a_C}{\partial e_c}."""
    base, by = parts(name)
    top = LATEX_NAMES.get(base) or _subscripted(base)
    parameters = [LATEX_NAMES.get(p) or _subscripted(p) for p in by]
    if not parameters:
        return top
    order = f"^{{{len(parameters)}}}" if len(parameters) > 1 else ""
    below = " ".join(rf"\partial {p}" for p in parameters)
    return rf"\frac{{\partial{order} {top}}}{{{below}}}"


def _subscripted(name: str) -> str:
    head, _, tail = name.partition("_")
    return f"{head}_{{{tail.replace('_', ',')}}}" if tail else head


def _latex_symbols() -> dict[sp.Symbol, str]:
    return {_parameter(name): text for name, text in _names_in_latex().items()}


def _names_in_latex() -> dict[str, str]:
    names = (*PARAMETERS, *LOADS, "omega", "branch")
    return {name: LATEX_NAMES.get(name) or _subscripted(name) for name in names}
