"""The formulas of the ledgers, evaluated as they are written there and compared with the truth.

`misses` reads a string of a ledger, gives each of its names the value that the raw loop, the free bodies or a
definition of the paper give it, and tells which sides are not what they must be: all sides equal where the
form is right, and the wrong side's own hand-written value where a printed form is wrong. So a changed sign,
digit or function in any of these strings shows. `everywhere` proves an equation's verdict in all designs, by
the loop to 30 digits and by the package to rounding.
"""

import ast
import itertools
import operator
import re
from difflib import SequenceMatcher

from mpmath import mp, mpc, mpf

from tests.papers import newton_euler_c as ne
from tests.papers.errata.equations import FINE
from tests.papers.errata.formula import parse
from tests.papers.letters import DESIGNS_OF, ORACLE, PACKAGE, names_of, twin_of

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
            v, twin = names_of(key, number), twin_of(key, number)
            expected = [twin.sides] if twin else None
            try:
                result = [
                    [value(side, v | angles | (names or {})) for side in sides] for sides in parse(text)
                ]
            except (*NO_VALUE, AttributeError) as error:
                return f"{text}: {error!r}"
            wanted = [(sides[0] if true is None else true,) * len(sides) for sides in result]
            wanted = expected if printed and expected else wanted
            if list(map(len, result)) != list(map(len, wanted)) or (
                true is None and max(map(len, result)) < 2 and not expected
            ):
                return f"{text}: other sides"
            if any(isinstance(side, (list, tuple)) for sides in (*result, *wanted) for side in sides):
                return f"{text}: a side that is no number"
            for sides, right in zip(result, wanted, strict=True):
                size = max(map(abs, (*sides, *right)))
                if any(abs(a - b) > mpf(10) ** -25 * size for a, b in zip(sides, right, strict=True)):
                    return f"{text}: {[mp.nstr(side, 8) for side in sides]}"
    return ""


# --- in every design, by the loop and by the package ----------------------------------------------

AGREEMENT = {ORACLE: mpf(10) ** -30, PACKAGE: mpf(10) ** -12}  # of the size of the terms
OFF = mpf(10) ** -6  # what a wrong form is off by, at least
NO_FORMULA = {"B-eq50"}  # corrected by a sentence


def terms(node):
    """The summands of a side."""
    is_sum = isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub))
    return [*terms(node.left), *terms(node.right)] if is_sum else [node]


def apart(text, v, expected=None):
    """Distance of the sides of a formula from the first one, or from given values, by the terms' size."""
    result = []
    for number, sides in enumerate(parse(text)):
        size = max(abs(value(term, v)) for side in sides for term in terms(side)) or 1
        got = [value(side, v) for side in sides]
        right = expected[number] if expected else [got[0]] * len(got)
        result += [abs(a - b) / size for a, b in zip(got, right, strict=True)]
    return max(result)


def half_mended(printed, corrected):
    """The printed form with only the signs put right, and with only the rest put right."""
    old, new = (re.findall(r"\w+|\s+|.", text) for text in (printed, corrected))
    changes = SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
    for signs in (True, False):
        mended = [bool({"+", "-"} & {*old[a:b], *new[c:d]}) == signs for _, a, b, c, d in changes]
        parts = [new[c:d] if one else old[a:b] for one, (_, a, b, c, d) in zip(mended, changes, strict=True)]
        yield "".join(itertools.chain(*parts))


def opposite(text):
    """A formula with its right-hand sides reversed."""
    left, *others = text.split(" = ")
    return " = ".join([left, *(f"-({side})" for side in others)])


def everywhere(row, verdict):
    """(form, design, source) of an entry's formulas that are not as right or as wrong as the verdict says.

    A wrong form is what its hand-written twin makes of it, and off in every design; so is its opposite,
    unless the sign alone is wrong, and so is the form with one of two mistakes put right.
    """
    key, printed, corrected = row["id"], row["printed"], row["corrected"]
    if not FORMULA.fullmatch(key):
        return
    fine = verdict in FINE
    right = [printed] if fine else [corrected] * (key not in NO_FORMULA)
    wrong = [] if fine else [printed]
    if verdict not in ("sign", "typo", *FINE):
        wrong += [opposite(printed)]
    if " and " in verdict:
        wrong += half_mended(printed, corrected)
    for number, source in itertools.product(range(DESIGNS_OF[key[0]]), AGREEMENT):
        with mp.workdps(2 * ne.DIGITS):
            v, twin = names_of(key, number, source), twin_of(key, number)
            expected = [twin.sides] if twin and fine else None
            yield from (
                (text, number, source) for text in right if apart(text, v, expected) > AGREEMENT[source]
            )
            yield from ((text, number, source) for text in wrong if apart(text, v) < OFF)
            if source == ORACLE and twin and not agrees(twin, printed, v, fine):
                yield "hand-written", number, source


def agrees(twin, printed, v, fine):
    """True if a hand-written form is what is printed, and right if that is right, or corrected."""
    truth, *others = twin.sides
    right = (others if fine else []) + ([] if twin.corrected is None else [twin.corrected])
    error = max(
        [apart(printed, v, [twin.sides]), *(abs(other - truth) / (abs(truth) or 1) for other in right)]
    )
    return error <= AGREEMENT[ORACLE]
