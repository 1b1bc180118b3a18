"""The rod's functions: partial derivatives of its angle phi and height S, followed along the crank.

The rod is a bar of length BC whose ends are u = ec + AB sin(theta) apart across the slider axis and
S along it; phi(u, BC) and S(u, BC) are all that the mechanism needs of it. `S_u_BC_2` is the second
derivative with respect to theta of d2S/(du dBC). Lengths come first, where every derivative is one term in
u/S and BC/S; theta comes last, by the chain rule on du/dtheta = S dphi/dtheta, so that only the
recollected derivatives of phi by theta enter and nothing cancels.
"""

from typing import NamedTuple

import sympy as sp

from desaxe.mechanism.names import per
from desaxe.units.dimensions import ANGLE, LENGTH, Unit

from .loop import BC, r, rod_partials, u
from .sheet import Equation, Sheet, symbol
from .stable import in_theta, inverse_rate, phi_by_theta, sec_phi, tan_phi

UNITS = {"phi": ANGLE, "S": LENGTH}
BY = {"u": u, "BC": BC}


class RodFunction(NamedTuple):
    """phi or S, differentiated by u and BC, then `turns` times by theta."""

    function: str
    by: tuple[str, ...] = ()
    turns: int = 0

    @property
    def symbol(self) -> sp.Symbol:
        """Symbol of the function, such as `S_u_BC_2`."""
        return symbol("_".join([self.function, *self.by, *([str(self.turns)] if self.turns else [])]))

    def with_respect_to(self, parameter: str) -> "RodFunction":
        """The derivative with respect to u or BC."""
        return self._replace(by=tuple(sorted((*self.by, parameter), reverse=True)))

    @property
    def unit(self) -> Unit:
        """Unit of the function; u and BC are lengths."""
        return per(UNITS[self.function], *["BC"] * len(self.by), *["theta"] * self.turns)

    @property
    def meaning(self) -> str:
        """A description of the function for the comments of the program."""
        order = len(self.by)
        what = f"d{order if order > 1 else ''}{self.function}/({' '.join('d' + p for p in self.by)})"
        what = what if self.by else "rod height S"
        return f"{what}, differentiated {self.turns}x by theta" if self.turns else what


def read_rod_function(name: str) -> RodFunction | None:
    """The rod function of a name such as `S_u_BC_2`, None for any other name."""
    function, *parts = name.split("_")
    turns = int(parts.pop()) if parts and parts[-1].isdigit() else 0
    if function not in UNITS or any(part not in BY for part in parts):
        return None
    return RodFunction(function, tuple(parts), turns)


def resolve_rod(sheet: Sheet, name: str) -> Equation | None:
    """The equation of a rod function."""
    rod = read_rod_function(name)
    if rod is None or not (rod.by or rod.turns):
        return None
    expression = in_ratios(_followed(rod)) if rod.by else _height(rod.turns)
    return Equation(_shortest(expression), rod.unit, rod.meaning)


def _shortest(expression: sp.Expr) -> sp.Expr:
    """Factored, each factor by Horner in tan(phi), unless that takes a division."""
    factored = sp.factor(expression)
    if factored.has(1 / BC) and not expression.has(1 / BC):
        return sp.factor_terms(expression)
    return sp.Mul(*(_nested(factor) for factor in sp.Mul.make_args(factored)))


def _nested(factor: sp.Expr) -> sp.Expr:
    return sp.horner(factor, tan_phi) if factor.is_Add and factor.is_polynomial(tan_phi) else factor


def _followed(rod: RodFunction) -> sp.Expr:
    """The function in u, BC, 1/S and the derivatives of phi by theta."""
    if rod.turns == 0:
        return _partial(rod.function, rod.by)
    before = _followed(rod._replace(turns=rod.turns - 1))
    along = (before.diff(u) + before.diff(r) * inverse_rate(u)) * phi_by_theta(1) / r
    turning = (before.diff(phi_by_theta(n)) * phi_by_theta(n + 1) for n in (1, 2, 3))
    return sp.expand(sp.Add(along, *turning))


def _height(turns: int) -> sp.Expr:
    """A derivative of S by theta: dS/dtheta = -u dphi/dtheta (the rod's velocity is across itself)."""
    expression = -u * phi_by_theta(1)
    for _ in range(turns - 1):
        expression = in_theta(expression)
    return sp.expand(expression)


def _partial(function: str, by: tuple[str, ...]) -> sp.Expr:
    """A partial derivative with respect to u and BC, in u, BC and 1/S."""
    expression = rod_partials()[function, BY[by[0]]]
    for name in by[1:]:
        parameter = BY[name]
        expression = _on_rod(expression.diff(parameter) + expression.diff(r) * inverse_rate(parameter))
    return expression


def _on_rod(expression: sp.Expr) -> sp.Expr:
    """The shortest form that BC^2 = u^2 + S^2 allows: one term, where the rod is long too."""
    forms = [sp.factor(expression)]
    if not expression.has(1 / BC):
        forms += [
            sp.factor(sp.expand(expression).subs(BC**2, u**2 + r**-2)),
            sp.factor(sp.expand(expression).subs(u**2, BC**2 - r**-2)),
        ]
    return min(forms, key=lambda form: (sp.count_ops(form), sp.default_sort_key(form)))


def in_ratios(expression: sp.Expr) -> sp.Expr:
    """The expression with u/S and BC/S as tan_phi and sec_phi."""
    terms = sp.Add.make_args(sp.expand(expression.subs(u, tan_phi / r)))
    return sp.Add(*(_with_sec(term) for term in terms))


def _with_sec(term: sp.Expr) -> sp.Expr:
    power = sp.degree(term, BC) if term.is_polynomial(BC) else 0
    return sp.powsimp(term * (sec_phi / (BC * r)) ** power)
