"""Partial derivatives of the rod angle phi and the slider position Y, of any order that is needed.

Y = AB cos(theta) + branch S is the solved loop. Lengths are differentiated first, theta last (see
`rod`); derivatives of Y by theta alone go through Y itself (see `folded`).
"""

import sympy as sp

from desaxe.mechanism.names import parts, per
from desaxe.units.dimensions import LENGTH

from .folded import slider_rate
from .loop import AB, BC, ec, slider, solved
from .rod import UNITS, RodFunction, read_rod_function
from .sheet import Equation, Sheet
from .stable import OFFSET, TRIGONOMETRY, in_theta, phi_rate

POSITION = solved()[slider].subs(TRIGONOMETRY)
LENGTHS = {"ec": ec, "AB": AB, "BC": BC}
BASES = {"phi": (RodFunction("phi").symbol, UNITS["phi"]), "Y": (POSITION, LENGTH)}


def resolve_geometry(sheet: Sheet, name: str) -> Equation | None:
    """The equation of a derivative of phi or Y by theta and lengths."""
    base, parameters = parts(name)
    if base not in BASES or not parameters or any(p not in (*LENGTHS, "theta") for p in parameters):
        return None
    expression, unit = BASES[base]
    lengths, turns = [p for p in parameters if p != "theta"], parameters.count("theta")
    if base == "phi" and not lengths:
        expression = phi_rate(turns)
    else:
        for length in lengths:
            expression = _by_length(expression, length)
        for _ in range(turns):
            expression = _by_theta(expression)
        expression = sp.factor_terms(expression)
        if base == "Y" and not lengths:
            expression = slider_rate(turns, expression)
    meaning = f"derivative of {base} with respect to {', '.join(parameters)}"
    return Equation(expression, per(unit, *parameters), meaning)


def _rod_functions(expression: sp.Expr) -> list[tuple[sp.Symbol, RodFunction]]:
    """The rod functions in an expression, in the order of their names."""
    symbols = sorted(expression.free_symbols, key=lambda s: s.name)
    return [(s, rod) for s in symbols if (rod := read_rod_function(s.name)) is not None]


def _by_length(expression: sp.Expr, name: str) -> sp.Expr:
    """The derivative with respect to a length, through u and BC where the rod's functions depend on it."""
    length = LENGTHS[name]
    result = expression.diff(length)
    for s, rod in _rod_functions(expression):
        rate = rod.with_respect_to("u").symbol * OFFSET.diff(length)
        rate += rod.with_respect_to("BC").symbol * BC.diff(length)
        result += expression.diff(s) * rate
    return sp.expand(result)


def _by_theta(expression: sp.Expr) -> sp.Expr:
    """The derivative with respect to theta at fixed lengths."""
    result = in_theta(expression)
    for s, rod in _rod_functions(expression):
        result += expression.diff(s) * rod._replace(turns=rod.turns + 1).symbol
    return sp.expand(result)
