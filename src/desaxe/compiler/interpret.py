"""Run a Program line by line: in doubles with IEEE 754 semantics, or exactly for the tests.

The exact interpretation follows the table's `exact` column over a namespace of high-precision
functions such as ``mpmath.mp``; it is how the tests tell what a pass did to the meaning.
"""

import math
from collections.abc import Mapping
from typing import Any

from ..support.forks import IMPORTS
from .helpers import lookup, lookup_piece, lookup_slope
from .operations import OPERATIONS
from .program import Argument, Program, TableName, tables_in


def run_exactly(program: Program, mp: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Every name of the program, from its inputs and tables, over the functions of `mp`."""
    scope: dict[str, Any] = {name: mp.mpf(values[name]) for name in program.inputs}
    scope |= {name: values[name] for name in tables_in(program)}
    for line in program.lines:
        args = [_exact_argument(a, scope, mp) for a in line.args]
        scope[line.name] = OPERATIONS[line.op].exact(mp, *args)
    return scope


def _exact_argument(argument: Argument, scope: Mapping[str, Any], mp: Any) -> Any:
    if isinstance(argument, (str, TableName)):
        return scope[argument if isinstance(argument, str) else argument.name]
    return mp.mpf(argument) if isinstance(argument, float) else argument


def run_in_doubles(program: Program, values: Mapping[str, Any]) -> dict[str, Any]:
    """Every name of the program in double precision; nothing raises, inf and NaN flow.

    values   numbers of the inputs; knots and coefficients of tables
    """
    scope: dict[str, Any] = dict(values)
    for line in program.lines:
        args = (a.name if isinstance(a, TableName) else a for a in line.args)
        scope[line.name] = ieee(line.op, *(scope[a] if isinstance(a, str) else a for a in args))
    return scope


def ieee(op: str, *args: Any) -> Any:
    """Apply one operation to Python numbers with IEEE 754 semantics."""
    return _IEEE[op](*args)


def _divide(a: float, b: float) -> float:
    if b:
        return a / b
    return math.nan if a == 0.0 or a != a else math.copysign(math.inf, a) * math.copysign(1.0, b)


def _finite_only(function: Any) -> Any:
    """Wrap a function to return NaN where Python would raise."""

    def guarded(a: float) -> float:
        return function(a) if a - a == 0.0 else math.nan

    return guarded


def _hypot(a: float, b: float) -> float:
    least, most = sorted((math.fabs(a), math.fabs(b)))
    if not (least > 0.0 and most < math.inf):
        return most + least
    return most * math.sqrt(1.0 + (least / most) * (least / most))


def _exponential(a: float) -> float:
    return math.exp(a) if not a > 709.782712893384 else a * math.inf


def _logarithm(a: float) -> float:
    return math.log(a) if a > 0.0 else (-math.inf if a == 0.0 else math.nan)


def _power(a: float, b: float) -> float:
    """a to the power b with IEEE 754 semantics: inf or NaN where Python raises."""
    odd = b % 2.0 == 1.0 if b - b == 0.0 else False
    try:
        return math.pow(a, b)
    except OverflowError:
        return -math.inf if a < 0.0 and odd else math.inf
    except ValueError:
        return math.nan if a else math.copysign(math.inf, a) if odd else math.inf


def _two_sum_error(a: float, b: float) -> float:
    total = a + b
    of_b = total - a
    return (a - (total - of_b)) + (b - of_b)


def _two_product_error(a: float, b: float) -> float:
    with IMPORTS:
        from fractions import Fraction  # with decimal and re: a large import for a rare constant

    product = a * b
    if product - product != 0.0:
        return math.nan
    return float(Fraction(a) * Fraction(b) - Fraction(product))


def _power_of_two(a: float) -> float:
    fraction, power = math.frexp(min(max(a, 2.0**-960), 2.0**960)) if a == a else (0.5, 961)
    return math.ldexp(1.0, power - (fraction == 0.5))


def _rotated(sine: float, cosine: float, quarters: float) -> float:
    value = cosine if quarters % 2.0 == 1.0 else sine
    return -value if quarters % 4.0 >= 2.0 else value


def _rotated_cos(sine: float, cosine: float, quarters: float) -> float:
    value = sine if quarters % 2.0 == 1.0 else cosine
    return -value if (quarters + 1.0) % 4.0 >= 2.0 else value


_IEEE: dict[str, Any] = {
    "copy": lambda a: a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": _divide,
    "neg": lambda a: -a,
    "abs": math.fabs,
    "sqrt": lambda a: math.sqrt(a) if a >= 0.0 else math.nan,
    "sin": _finite_only(math.sin),
    "cos": _finite_only(math.cos),
    "atan2": math.atan2,
    "hypot": _hypot,
    "exp": _exponential,
    "log": _logarithm,
    "pow": _power,
    "floor": lambda a: float(math.floor(a)) if a - a == 0.0 and a else a,
    "copysign": math.copysign,
    "two_sum_error": _two_sum_error,
    "two_product_error": _two_product_error,
    "mul_add": lambda a, b, c: a * b + c,
    "rounding": lambda a: 2.0**-51 * math.fabs(a),
    "power_of_two": _power_of_two,
    "rotated_sin": _rotated,
    "rotated_cos": _rotated_cos,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "eq": lambda a, b: a == b,
    "and": lambda a, b: a and b,
    "or": lambda a, b: a or b,
    "not": lambda a: not a,
    "extended_only": lambda a: False,
    "select": lambda c, a, b: a if c else b,
    "lookup_piece": lambda x, table, way: lookup_piece(x, table[0], way),
    "lookup": lambda x, table, piece: lookup(x, table[0], table[1], piece),
    "lookup_slope": lambda x, table, piece: lookup_slope(x, table[0], table[1], piece),
}
