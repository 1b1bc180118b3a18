"""The stable form of a quantity, for a reader: the frozen program's lines as SymPy and as LaTeX.

Over the real numbers the error terms that the program carries are 0 and so are the bounds on rounding, which
leaves the algebra: the variables in which nothing cancels, and the tests that choose between equal forms.
"""

from collections import Counter
from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair

from desaxe.compiler.passes.fold import fold_constants
from desaxe.compiler.passes.slicing import drop_unused
from desaxe.compiler.program import Argument, Line, Program, names_in

ZERO = ("two_sum_error", "two_product_error", "rounding")  # over the real numbers
SHORT = 3  # operations of a temporary that is written where it is used, however often


def _tested(relation: Any, a: sp.Expr, b: sp.Expr) -> sp.Basic:
    """An unevaluated condition, which SymPy would rewrite; |x| < 0 is false."""
    if relation is sp.Lt and isinstance(a, sp.Abs) and b == 0:
        return sp.false
    return relation(a, b, evaluate=False)


def _either(condition: sp.Basic, a: sp.Expr, b: sp.Expr) -> sp.Expr:
    """A two-way Piecewise whose condition SymPy does not rewrite."""
    if condition in (sp.true, sp.false):
        return a if condition == sp.true else b
    # Past the constructors, which would take every condition apart.
    pairs = (sp.Tuple.__new__(ExprCondPair, *pair) for pair in ((a, condition), (b, sp.true)))
    return sp.Basic.__new__(sp.Piecewise, *pairs)


LATEX_NAMES = {
    "sin_theta": r"s_{\theta}", "cos_theta": r"c_{\theta}", "abs_sin": r"|s_{\theta}|", "eps": r"\varepsilon",
    "pin_side": r"\nu", "side": r"\varsigma", "ec_out": r"e_{\nu}", "AB_out": r"a_{\nu}",
    "tan_phi": r"\tan\varphi", "turn": r"\tau",
}  # fmt: skip
_OPERATIONS: Mapping[str, Any] = {
    "copy": lambda a: a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "abs": sp.Abs,
    "sqrt": sp.sqrt,
    "sin": sp.sin,
    "cos": sp.cos,
    "atan2": sp.atan2,
    "floor": sp.floor,
    "copysign": lambda a, b: sp.Abs(a) * _either(sp.Ge(b, 0, evaluate=False), sp.S.One, sp.S.NegativeOne),
    "mul_add": lambda a, b, c: a * b + c,
    "lt": lambda a, b: _tested(sp.Lt, a, b),
    "le": lambda a, b: _tested(sp.Le, a, b),
    "eq": lambda a, b: _tested(sp.Eq, a, b),
    "and": lambda a, b: sp.And(a, b, evaluate=False),
    "or": lambda a, b: sp.Or(a, b, evaluate=False),
    "not": lambda a: sp.Not(a, evaluate=False),
    "extended_only": lambda a: sp.false,
    "select": _either,
}


class StableForm(NamedTuple):
    """The quantity in the parameters alone; and in steps, of which the last is the quantity.

    `definitions`: name -> expression in the parameters and in names before it.
    """

    expression: sp.Expr
    definitions: dict[str, sp.Expr]


def symbol(name: str) -> sp.Symbol:
    """A real number by this name."""
    return sp.Symbol(name, real=True)


@cache
def stable_form(name: str) -> StableForm:
    """The lines of the frozen program that compute a quantity, over the real numbers."""
    from desaxe.mechanism.program import program_of

    program = _exact(program_of((name,)))
    uses = Counter(n for line in program.lines for n in names_in(line.args))
    known: dict[str, sp.Basic] = {}
    whole: dict[str, sp.Basic] = {}  # the same in the parameters alone
    definitions: dict[str, sp.Expr] = {}
    count = 0
    for line in program.lines:
        value = _OPERATIONS[line.op](*(_value(a, known) for a in line.args))
        whole[line.name] = _OPERATIONS[line.op](*(_value(a, whole) for a in line.args))
        if line.name != name and not _keeps_its_line(value, line.name in program.notes, uses[line.name]):
            known[line.name] = value
            continue
        own = line.name
        if own not in program.notes and own != name:
            own, count = f"t{count}", count + 1
        definitions[own] = value
        known[line.name] = symbol(own)
    return StableForm(whole[name], _reached(definitions, name))


def _exact(program: Program) -> Program:
    """The program over the real numbers."""
    fixed = {**dict.fromkeys(ZERO, 0.0), "power_of_two": 1.0}  # on the last no value depends
    lines = [Line(x.name, "copy", (fixed[x.op],)) if x.op in fixed else x for x in program.lines]
    return drop_unused(fold_constants(drop_unused(program._replace(lines=tuple(lines)))))


def _value(argument: Argument, known: Mapping[str, sp.Basic]) -> sp.Basic:
    if isinstance(argument, str):
        return known[argument] if argument in known else symbol(argument)
    if isinstance(argument, bool):
        return sp.true if argument else sp.false
    return sp.nan if argument != argument else sp.oo if argument == float("inf") else sp.Rational(argument)


def _keeps_its_line(value: sp.Basic, is_named: bool, uses: int) -> bool:
    """True for a named expression, and for a long one that is used more than once."""
    if isinstance(value, sp.logic.boolalg.Boolean) or value.is_Atom:
        return False
    return is_named or (uses > 1 and value.count_ops() >= SHORT)


def _reached(definitions: dict[str, sp.Expr], name: str) -> dict[str, sp.Expr]:
    requested = {name}
    for each, expression in reversed(definitions.items()):
        if each in requested:
            requested |= {str(part) for part in expression.free_symbols}
    return {each: definitions[each] for each in definitions if each in requested}


def stable_latex(form: StableForm, latex: Mapping[str, str]) -> str:
    """The steps, one a row, the quantity last: `latex` has the symbols that are known, by name."""
    named = {**LATEX_NAMES, **latex}
    known = {symbol(each): named.get(each) or _upright(each) for each in [*named, *form.definitions]}
    rows = [
        f"{known[symbol(each)]} &= {sp.latex(expression, symbol_names=known)}"
        for each, expression in form.definitions.items()
    ]
    return "\\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned}"


def _upright(name: str) -> str:
    """A name in letters that do not read as a product."""
    head, _, tail = name.partition("_")
    if name[0] == "t" and name[1:].isdecimal():
        head, tail = "t", name[1:]
    top = head if len(head) == 1 else rf"\mathrm{{{head}}}"
    below = tail.replace("_", ",")
    return rf"{top}_{{\mathrm{{{below}}}}}" if tail else top
