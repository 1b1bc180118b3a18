"""The formulas of the ledgers, evaluated as they are written there and compared with the truth.

`misses` reads a string of a ledger, gives each of its names the value that the raw loop, the free bodies or a
definition of the paper give it, and tells which sides are not what they must be: all sides equal where the
form is right, and the wrong side's own hand-written value where a printed form is wrong. So a changed sign,
digit or function in any of these strings shows.
"""

import ast
import operator
import re

from mpmath import mp, mpc, mpf

from desaxe.errata.formula import parse
from tests.papers import newton_euler_c as ne
from tests.papers.letters import names_of

OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
MATHEMATICS = {name: getattr(mp, name) for name in ("sin", "cos", "tan", "asin", "acos", "sqrt")} | {
    "abs": abs
}
ARGUMENTS = ("...", "theta", "theta, AB", "theta, ec, AB, BC")
FORMULA = re.compile(r"[AB]-eq\w+|A-listing-(?!name|order)\w+|C-link\d-(x|y|moment)")
SAMPLES = 3
NO_VALUE = ValueError, KeyError, AssertionError, ZeroDivisionError, TypeError


def value(node, v):
    """A syntax tree's value; an unknown name or other arguments than the papers' are errors."""
    if isinstance(node, ast.Constant):
        return mpf(str(node.value))
    if isinstance(node, ast.Name):
        return v[node.id]
    if isinstance(node, ast.UnaryOp):
        return OPERATORS[type(node.op)](value(node.operand, v))
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](value(node.left, v), value(node.right, v))
    if isinstance(node, ast.Tuple):
        x, y = (value(part, v) for part in node.elts)
        return mpc(x, y)
    name = node.func.id
    if name in MATHEMATICS:
        (argument,) = node.args
        return MATHEMATICS[name](value(argument, v))
    if callable(v.get(name)):
        return v[name](*(value(argument, v) for argument in node.args))
    assert ", ".join(map(ast.unparse, node.args)) in ARGUMENTS, ast.unparse(node)
    return v[name]


def misses(key, text, printed, names=None, true=None):
    """The error of a formula of an entry as text; empty if all of its sides are equal, and equal to `true`.

    A `printed` form that is wrong has the values of its hand-written sides instead. `names` are the proof's.
    """
    with mp.workdps(2 * ne.DIGITS):
        angles = {"pi": +mp.pi, "deg": mp.pi / 180}
        for number in range(1 if names else SAMPLES):
            v, expected = names_of(key, number)
            try:
                got = [[value(side, v | angles | (names or {})) for side in sides] for sides in parse(text)]
            except (*NO_VALUE, AttributeError) as error:
                return f"{text}: {error!r}"
            wanted = [(sides[0] if true is None else true,) * len(sides) for sides in got]
            wanted = expected if printed and expected else wanted
            if list(map(len, got)) != list(map(len, wanted)) or (
                true is None and max(map(len, got)) < 2 and not expected
            ):
                return f"{text}: other sides"
            if any(isinstance(side, (list, tuple)) for sides in (*got, *wanted) for side in sides):
                return f"{text}: a side that is no number"
            for sides, right in zip(got, wanted, strict=True):
                size = max(map(abs, (*sides, *right)))
                if any(abs(a - b) > mpf(10) ** -25 * size for a, b in zip(sides, right, strict=True)):
                    return f"{text}: {[mp.nstr(side, 8) for side in sides]}"
    return ""
