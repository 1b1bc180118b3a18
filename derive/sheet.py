"""The equation sheet: named equations and the chain rule between them.

Every equation has a name, and refers to others by their names. A derivative is an equation too:
`V_C_wrt_ec` is the chain rule applied to the equation of `V_C`, in terms of the derivatives of the
names in it, which are made when they are asked for. So value and derivatives share their work, and
nothing is ever expanded into one large expression.
"""

from collections.abc import Callable
from typing import NamedTuple

import sympy as sp

from desaxe.compiler.program import Note
from desaxe.mechanism.names import per, sensitivity
from desaxe.units.dimensions import Unit, unit_text


class Equation(NamedTuple):
    """name = expression. `differentiate` replaces the expression when a derivative is taken.

    A quantity is `rigid` where it is constant but for jumps (a sign): its derivatives are 0.
    """

    expression: sp.Expr
    unit: Unit | None = None
    meaning: str = ""
    source: str = ""
    differentiate: sp.Expr | None = None
    rigid: bool = False

    @property
    def note(self) -> Note | None:
        """Unit, meaning and source for the frozen line; None without a unit."""
        return Note(unit_text(self.unit), self.meaning, self.source) if self.unit is not None else None


class Sheet:
    """Equations by name, in the order in which they can be computed."""

    def __init__(self, resolvers: tuple[Callable[["Sheet", str], Equation | None], ...]) -> None:
        """`resolvers` make the equations of names such as `Y_wrt_theta_ec` when they are needed."""
        self.equations: dict[str, Equation] = {}
        self._resolvers = resolvers
        self._derivatives: dict[tuple[str, str], sp.Expr] = {}

    def define(
        self,
        name: str,
        expression: sp.Expr | int,
        unit: Unit | None = None,
        meaning: str = "",
        source: str = "",
        *,
        differentiate: sp.Expr | None = None,
        rigid: bool = False,
    ) -> sp.Symbol:
        """Add an equation with the fields of `Equation`; return its symbol."""
        if name in self.equations:
            raise ValueError(f"{name} is defined twice")
        equation = Equation(sp.sympify(expression), unit, meaning, source, differentiate, rigid)
        self.equations[name] = equation
        return symbol(name)

    def equation(self, name: str) -> Equation | None:
        """The equation of a name, made if a resolver knows it; None for an input."""
        if name not in self.equations:
            made = next((e for e in (resolve(self, name) for resolve in self._resolvers) if e), None)
            if made is not None:
                self.equations[name] = made
        return self.equations.get(name)

    def derivative(self, name: str, parameter: str) -> sp.Expr:
        """The derivative of a name by a parameter: a number, or the symbol of an equation."""
        key = name, parameter
        if key not in self._derivatives:
            self._derivatives[key] = self._differentiated(name, parameter)
        return self._derivatives[key]

    def _differentiated(self, name: str, parameter: str) -> sp.Expr:
        if name == parameter:
            return sp.Integer(1)
        equation = self.equation(name)
        new = sensitivity(name, parameter)
        if equation is None and new not in self.equations:  # another input
            return sp.Integer(0)
        if equation is not None and equation.rigid:
            return sp.Integer(0)
        if equation is not None and self.equation(new) is None:
            expression = self.chain_rule(name, parameter)
            if expression.is_number:
                return expression
            unit = per(equation.unit, parameter) if equation.unit is not None else None
            meaning = f"derivative of {name} with respect to {parameter}"
            self.equations[new] = Equation(expression, unit, meaning)
        return symbol(new)

    def chain_rule(self, name: str, parameter: str) -> sp.Expr:
        """The derivative of the equation of a name, in the derivatives of what stands in it."""
        equation = self.equations[name]
        expression = equation.expression if equation.differentiate is None else equation.differentiate
        if expression.is_Pow and expression.exp == sp.Rational(1, 2):
            # (sqrt f)' = f'/(2 sqrt f): the root is shared
            return self._total(expression.base, parameter) / (2 * symbol(name))
        return self._total(expression, parameter)

    def _total(self, expression: sp.Expr, parameter: str) -> sp.Expr:
        names = sorted(expression.free_symbols, key=lambda s: s.name)
        terms = (expression.diff(s) * self.derivative(s.name, parameter) for s in names)
        return sp.factor_terms(sp.Add(*terms))

    def ordered(self, names: tuple[str, ...]) -> list[str]:
        """The names that these need, themselves included, each after what it uses."""
        order: dict[str, None] = {}
        for name in names:
            self._visit(name, order)
        return list(order)

    def _visit(self, name: str, order: dict[str, None]) -> None:
        equation = None if name in order else self.equation(name)
        if equation is None:
            return
        for used in sorted(s.name for s in equation.expression.free_symbols):
            self._visit(used, order)
        order[name] = None


def symbol(name: str) -> sp.Symbol:
    """The symbol of a name."""
    return sp.Symbol(name, real=True)
