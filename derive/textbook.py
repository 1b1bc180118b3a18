"""The closed forms of `equation` as plain functions: what a textbook user would compute with."""

from collections.abc import Callable, Sequence
from typing import Any

import sympy as sp

from .equation import SPEED, equation
from .loop import branch
from .motion import LAW, omega0

INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
TURNING = sp.Function("copysign")(1, omega0)  # as NumPy calls it
_PIECEWISE = SPEED / sp.sqrt(LAW)


def expressions(names: Sequence[str], side: int) -> list[sp.Expr]:
    """The closed forms in INPUTS on one branch; which way the crank turns is copysign(1, omega0)."""
    put_in = {branch: sp.Integer(side), _PIECEWISE: TURNING}
    return [equation(name).expression.subs(put_in) for name in names]


def function(names: Sequence[str], side: int, modules: Any = "numpy") -> Callable[..., tuple[Any, ...]]:
    """The closed forms as a function of INPUTS, common subexpressions shared (SymPy's `lambdify`)."""
    symbols = [sp.Symbol(name, real=True) for name in INPUTS]
    made: Callable[..., tuple[Any, ...]] = sp.lambdify(
        symbols, tuple(expressions(names, side)), modules, cse=True
    )
    return made
