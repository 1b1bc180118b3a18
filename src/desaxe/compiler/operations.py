"""The operation table: one row for each operation of a Program.

A row says what an operation means (its exact reference), how each language spells it, what it
costs and where it is undefined. A new operation, or a new language, is a change to this table.

`exact` is the meaning over the real numbers, computed by a namespace of high-precision functions
(``mpmath.mp`` in the tests); the error terms of two-sum and two-product are exactly 0 there,
and so is `rounding`, a bound of such terms. `power_of_two` is a size that a Program divides lengths by,
exactly, so that no square overflows, and multiplies its results with: no value depends on it. `extended_only`
guards a form of the same value that is of use to `double_digits` alone, which makes it its argument;
everywhere else it is false.
`python`, `numba`, `javascript`, `c`, `jax`, `octave` and `llvm` are templates over the argument texts.
Plain Python raises where IEEE 754 arithmetic answers inf or NaN: its division and square root are guarded in
the template. Of tables, `llvm` takes the pointers NAME.x and NAME.c and the number of knots NAME.n.
A table is a constant that stands for two arrays of the module, or of the kernel's arguments: NAME_x, its
ascending knots, and NAME_c, four coefficients for each piece, in the distance from its left knot; before the
first knot and after the last one a piece holds that is measured from that knot. The pieces of the way back
follow those of the way there. A search is an operation of its own, which a value and its slope share.
`precedence` is that of the spelling in the readable text form; calls, and what stands in parentheses, bind
tightest.
"""

import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from ..support.template import file_text

CALL = 100


class Operation(NamedTuple):
    """One operation: its signature, cost, and spelling in each language."""

    name: str
    signature: (
        str  # argument types then result: f = f64, b = bool, i = i64, t = table, T = the same on both sides
    )
    text: str  # the readable text form, also valid plain Python
    precedence: int
    python: str  # plain Python with IEEE 754 answers
    numba: str
    javascript: str  # what it spells in its own way stands in parentheses: its precedences are its own
    c: str
    jax: str
    octave: str
    llvm: str  # instructions (see instructions.ll); one of single doubles goes over a vector's elements
    cost: float  # relative to one addition, throughput in a vectorised loop
    exact: Callable[..., Any]  # exact(mp, *args)
    undefined: str = ""  # where the real function has no value
    commutes: bool = False

    @property
    def arity(self) -> int:
        """The number of arguments."""
        return len(self.signature) - 1


_FIELDS = Operation._fields
COLUMNS = _FIELDS[_FIELDS.index("python") : _FIELDS.index("cost")]  # of languages


# Operations that take LLVM several instructions, and those that it has under another name.
INSTRUCTIONS: dict[str, str] = dict(
    re.findall(r"^; (\w+).*\n((?:[^;\n].*\n)+)", file_text(__package__, "instructions.ll"), re.MULTILINE)
)
INTRINSICS = {"abs": "fabs", "copysign": "copysign", "floor": "floor", "mul_add": "fmuladd", "sqrt": "sqrt"}
LLVM_TYPES = {"f": "double", "b": "i1", "i": "i64", "t": "ptr", "T": "{T}"}


def _infix(
    name: str, signature: str, text: str, precedence: int, cost: float, exact: Callable[..., Any], **more: Any
) -> tuple[str, Operation]:
    columns = dict.fromkeys(COLUMNS, text) | {"llvm": _llvm(name, signature)} | more
    return name, Operation(name, signature, text, precedence, cost=cost, exact=exact, **columns)


def _call(
    name: str, signature: str, cost: float, exact: Callable[..., Any], function: str = "", **more: Any
) -> tuple[str, Operation]:
    """A row that all languages spell as a call, of the function's name but where `more` has another."""
    arguments = ", ".join(f"{{{k}}}" for k in range(len(signature) - 1))
    columns = {k: f"{v}({arguments})" if k in COLUMNS and "{" not in v else v for k, v in more.items()}
    return _infix(name, signature, f"{function or name}({arguments})", CALL, cost, exact, **columns)


def _llvm(name: str, signature: str) -> str:
    """Instructions of LLVM: a call of a function, at one point, or of an intrinsic one."""
    if name in INSTRUCTIONS:
        return INSTRUCTIONS[name]
    numbered = [*enumerate(signature[:-1])]
    if name in INTRINSICS:
        arguments = ", ".join(f"{{f}} {{{k}}}" for k, _ in numbered)
        return f"call {{f}} @llvm.{INTRINSICS[name]}.{{s}}({arguments})"
    arguments = ", ".join(f"{LLVM_TYPES[letter]} {{{k}}}" for k, letter in numbered)
    return f"call {LLVM_TYPES[signature[-1]]} @{name}({arguments})"


def _table_row(
    name: str, arrays: str, cost: float, exact: Callable[..., Any], octave: str
) -> tuple[str, Operation]:
    """A row of a number, a table and a number, which takes these arrays of the table; C its size, too."""

    def spelled(function: str, ends: str) -> str:
        return f"{function}({', '.join(['{0}', *(f'{{1}}_{end}' for end in ends), '{2}'])})"

    llvm = f"call {{f}} @{name}.{{s}}({{f}} {{0}}, ptr {{1}}.x, ptr {{1}}.c, i64 {{1}}.n, {{f}} {{2}})"
    columns = dict.fromkeys(COLUMNS, spelled(name, arrays[1:])) | {"llvm": llvm}
    columns |= {"c": spelled(name, f"{arrays[1:]}n"), "octave": spelled(octave, arrays[1:])}
    return _call(name, "ftff", cost, exact, **columns)


def _power_of_two(mp: Any, a: Any) -> Any:
    fraction, power = mp.frexp(a)
    return mp.ldexp(mp.mpf(1), min(max(power - (fraction == 0.5), -960), 960)) if a > 0 else mp.ldexp(1, -960)


Content = tuple[Sequence[float], Sequence[float]]  # of a table: knots and coefficients


def _piece(mp: Any, x: Any, table: Content, way: Any) -> Any:
    return mp.mpf(bisect_right(table[0], x) + (len(table[0]) + 1 if way < 0 else 0))


def _row_at(x: Any, table: Content, piece: Any) -> tuple[Any, Sequence[float]]:
    knots, rows = table
    number = int(piece)
    return x - knots[max(number % (len(knots) + 1) - 1, 0)], rows[4 * number : 4 * number + 4]


def _lookup(mp: Any, x: Any, table: Content, piece: Any) -> Any:
    s, (a, b, c, d) = _row_at(x, table, piece)
    return a + s * (b + s * (c + s * d))


def _lookup_slope(mp: Any, x: Any, table: Content, piece: Any) -> Any:
    s, (_, b, c, d) = _row_at(x, table, piece)
    return b + s * (2 * c + s * (3 * d))


_INFIX = (
    _infix("add", "fff", "{0} + {1}", 12, 1, lambda mp, a, b: a + b, llvm="fadd {f} {0}, {1}", commutes=True),
    _infix("sub", "fff", "{0} - {1}", 12, 1, lambda mp, a, b: a - b, llvm="fsub {f} {0}, {1}"),
    _infix("mul", "fff", "{0} * {1}", 13, 1, lambda mp, a, b: a * b, octave="{0} .* {1}",
           llvm="fmul {f} {0}, {1}", commutes=True),
    _infix("div", "fff", "{0} / {1}", 13, 8, lambda mp, a, b: a / b, python="divide({0}, {1})",
           octave="{0} ./ {1}", llvm="fdiv {f} {0}, {1}", undefined="{1} == 0"),
    _infix("neg", "ff", "-{0}", 14, 0.5, lambda mp, a: -a, llvm="fneg {f} {0}"),
    _infix("lt", "ffb", "{0} < {1}", 6, 1, lambda mp, a, b: a < b, llvm="fcmp olt {f} {0}, {1}"),
    _infix("le", "ffb", "{0} <= {1}", 6, 1, lambda mp, a, b: a <= b, llvm="fcmp ole {f} {0}, {1}"),
    _infix("eq", "ffb", "{0} == {1}", 6, 1, lambda mp, a, b: a == b, llvm="fcmp oeq {f} {0}, {1}",
           commutes=True),
    _infix("and", "bbb", "{0} and {1}", 4, 0.5, lambda mp, a, b: a and b, numba="{0} & {1}",
           javascript="({0} && {1})", c="({0} && {1})", jax="logical_and({0}, {1})", octave="({0} & {1})",
           llvm="and {b} {0}, {1}"),
    _infix("or", "bbb", "{0} or {1}", 3, 0.5, lambda mp, a, b: a or b, numba="{0} | {1}",
           javascript="({0} || {1})", c="({0} || {1})", jax="logical_or({0}, {1})", octave="({0} | {1})",
           llvm="or {b} {0}, {1}"),
    _infix("not", "bb", "not {0}", 5, 0.5, lambda mp, a: not a, javascript="!({0})", c="!({0})",
           jax="logical_not({0})", octave="~({0})", llvm="xor {b} {0}, {true}"),
    _infix("select", "bTTT", "{1} if {0} else {2}", 1, 1, lambda mp, c, a, b: a if c else b,
           javascript="({0} ? {1} : {2})", c="({0} ? {1} : {2})", jax="where({0}, {1}, {2})",
           octave="select({0}, {1}, {2})", llvm="select {b} {0}, {T} {1}, {T} {2}"),
)  # fmt: skip
_CALLS = (
    _call("abs", "ff", 0.5, lambda mp, a: abs(a), "fabs", octave="abs"),
    _call("sqrt", "ff", 9, lambda mp, a: mp.sqrt(a), python="root", octave="root", undefined="{0} < 0"),
    _call("sin", "ff", 20, lambda mp, a: mp.sin(a), python="sine"),
    _call("cos", "ff", 20, lambda mp, a: mp.cos(a), python="cosine"),
    _call("atan2", "fff", 40, lambda mp, a, b: mp.atan2(a, b)),
    _call("hypot", "fff", 20, lambda mp, a, b: mp.sqrt(a * a + b * b), commutes=True),
    _call("exp", "ff", 20, lambda mp, a: mp.exp(a), python="exponential"),
    _call(
        "log", "ff", 20, lambda mp, a: mp.log(a), python="logarithm", octave="logarithm", undefined="{0} < 0"
    ),
    _call("pow", "fff", 60, lambda mp, a, b: mp.power(a, b), python="power", octave="power_of"),
    _call("floor", "ff", 1, lambda mp, a: mp.floor(a), python="whole"),
    _call("copysign", "fff", 1, lambda mp, a, b: abs(a) if b >= 0 else -abs(a)),
    _call("two_sum_error", "fff", 5, lambda mp, a, b: a * 0, commutes=True),
    _call("two_product_error", "fff", 1, lambda mp, a, b: a * 0, commutes=True),
    _call("mul_add", "ffff", 1, lambda mp, a, b, c: a * b + c),
    _call("rounding", "ff", 1.5, lambda mp, a: a * 0),
    _call("power_of_two", "ff", 6, _power_of_two),
    _call("rotated_sin", "ffff", 4, lambda mp, s, c, quarters: (s, c, -s, -c)[int(quarters) % 4]),
    _call("rotated_cos", "ffff", 2, lambda mp, s, c, quarters: (c, -s, -c, s)[int(quarters) % 4]),
    _call("extended_only", "bb", 0, lambda mp, a: False, llvm="{false}"),
    _table_row("lookup_piece", "_x", 40, _piece, octave="lookup_piece"),
    _table_row("lookup", "_xc", 12, _lookup, octave="looked_up"),
    _table_row("lookup_slope", "_xc", 12, _lookup_slope, octave="looked_up_slope"),
)
_COPY = _infix("copy", "TT", "{0}", CALL, 0, lambda mp, a: a, llvm="{0}")
OPERATIONS: dict[str, Operation] = dict([_COPY, *_INFIX, *_CALLS])

MATH_NAMES = (
    "atan2", "copysign", "cos", "exp", "fabs", "floor", "inf", "log", "nan", "pow", "sin", "sqrt",
)  # fmt: skip

TYPES = {"f": "f64", "b": "bool", "i": "i64", "t": "table"}


def result_type(operation: Operation, types: tuple[str, ...]) -> str:
    """The type of the result for these argument types; TypeError where they do not fit."""
    generic = ""
    for letter, given in zip(operation.signature, types, strict=False):
        requested = TYPES.get(letter) or generic or given
        if letter == "T":
            generic = given
        if requested != given:
            raise TypeError(f"{operation.name} wants {requested}, got {given}")
    return TYPES.get(operation.signature[-1]) or generic
