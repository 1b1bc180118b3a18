"""The textbook's closed form of a work: what everyone but desaxe computes.

It is that of `desaxe.equation` at constant speed, turning forwards, on branch +1; inputs that are numbers are
put in.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

from .work import Inputs

spent = [0.0]  # seconds of deriving them: a user of a peer has the formulas at hand


def symbol(name: str) -> sp.Symbol:
    """The symbol of an input."""
    return sp.Symbol(name, real=True)


def forms(names: Sequence[str], inputs: Inputs) -> list[sp.Expr]:
    """The closed forms in the inputs that have columns."""
    started = time.perf_counter()
    from desaxe.derive.textbook import expressions

    forwards = sp.Symbol("omega0", positive=True)
    numbers = {symbol(name): sp.Float(value) for name, value in inputs.scalars.items() if name != "omega0"}
    numbers = {name: sp.Integer(0) if value == 0 else value for name, value in numbers.items()}
    fixed = {symbol("alpha"): sp.Integer(0), symbol("omega0"): forwards, **numbers}
    result = [_without_turning(form.subs(fixed), forwards, inputs) for form in expressions(names, 1)]
    spent[0] += time.perf_counter() - started
    return result


def _without_turning(form: sp.Expr, forwards: sp.Symbol, inputs: Inputs) -> sp.Expr:
    result = form.replace(lambda part: part.func.__name__ == "copysign", lambda _: sp.Integer(1))
    return result.subs(forwards, sp.Float(inputs.scalars["omega0"]))


def lambdified(names: Sequence[str], inputs: Inputs, modules: Any) -> Callable[..., Any]:
    """The closed forms as a function of the columns, by `lambdify` with common subexpressions shared."""
    symbols = [symbol(name) for name in inputs.columns]
    made: Callable[..., Any] = sp.lambdify(symbols, tuple(forms(names, inputs)), modules, cse=True)
    return made
