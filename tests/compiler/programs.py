"""Programs for the tests: random ones, the committed one, and what it means that two agree.

A random program is total: it divides by 1 + |something| and takes the root of |something|, so that the
exact interpretation always has a value.
"""

import math
import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mpmath
from hypothesis import strategies as st

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.operations import OPERATIONS, result_type
from desaxe.compiler.passes.slicing import drop_unused
from desaxe.compiler.program import (
    Argument,
    Line,
    Note,
    Program,
    TableName,
    names_in,
    tables_in,
    type_of,
    validate,
)
from desaxe.mechanism.program import program_of

INPUTS = ("x", "y", "z")
SIMPLE = (0.0, 1.0, -1.0, 2.0, -2.5, 0.5)
WITH_NAN = (*SIMPLE, math.nan, -0.0)
TYPES = {"f": "f64", "b": "bool"}
# Where a zero has a sign, or what is near has an answer that is not: no test of exactness draws these.
# Nor is drawn what wants no over- or underflow, or grows beyond any number when it is nested.
# Tables have no content here.
LOOKUPS = ("lookup_piece", "lookup", "lookup_slope")
ANY_OPS = tuple(op for op in OPERATIONS if op not in (*LOOKUPS, "two_product_error", "exp", "log", "pow"))
NO_JUMPS = tuple(op for op in ANY_OPS if op not in ("copysign", "atan2", "floor"))

POINT = {"theta": 1.1, "ec": 0.02, "AB": 0.125, "BC": 0.35, "omega0": 157.0, "alpha": -3.0, "branch": 1.0}
LINKS = {"m_crank": 1.5, "m_rod": 0.7, "m_slider": 0.9, "I_crank": 0.02, "I_rod": 0.01, "mu": 0.2}
LOADS = {"r_crank": 0.03, "r_rod": 0.2, "F_X": 30.0, "F_Y": -50.0, "g_X": 2.0, "g_Y": -9.0}


class _Builder:
    """Appends random lines."""

    def __init__(self, draw: Callable[[Any], Any], constants: Sequence[float]) -> None:
        self.draw, self.constants = draw, constants
        self.lines: list[Line] = []
        self.types = dict.fromkeys(INPUTS, "f64")

    def append(self, op: str, *args: Argument, kind: str = "f64", name: str = "p") -> str:
        name = f"{name}{len(self.lines)}"
        self.lines.append(Line(name, op, args, kind))
        self.types[name] = kind
        return name

    def argument(self, kind: str) -> Argument:
        """A name or a constant of this type."""
        constants = {"f64": self.constants, "bool": (True, False), "i64": (0, 3)}[kind]
        names = [name for name, own in self.types.items() if own == kind]
        return self.draw(st.sampled_from([*names, *names, *constants]))

    def line(self, op: str) -> None:
        """A line of this operation, named or a temporary."""
        signature = OPERATIONS[op].signature
        generic = self.draw(st.sampled_from(["f64", "f64", "bool", "i64"])) if "T" in signature else ""
        kinds = [TYPES.get(letter, generic) for letter in signature]
        args = [self.argument(kind) for kind in kinds[:-1]]
        if op == "div":
            args[1] = self.append("add", 1.0, self.append("abs", args[1]))
        if op == "sqrt":
            args[0] = self.append("abs", args[0])
        self.append(op, *args, kind=kinds[-1], name=self.draw(st.sampled_from(["q", "p", "p"])))


@st.composite
def programs(
    draw: Callable[[Any], Any], constants: Sequence[float] = SIMPLE, ops: Sequence[str] = ANY_OPS
) -> Program:
    """A random valid program of up to about a dozen lines over x, y, z."""
    builder = _Builder(draw, constants)
    for op in draw(st.lists(st.sampled_from(ops), min_size=1, max_size=10)):
        builder.line(op)
    names = [line.name for line in builder.lines]
    outputs = draw(st.lists(st.sampled_from(names), min_size=1, max_size=3, unique=True))
    notes = {name: Note("m", f"meaning of {name}", "A (1)") for name in names if name.startswith("q")}
    return validate(drop_unused(Program(INPUTS, tuple(builder.lines), tuple(outputs), notes)))


def points() -> st.SearchStrategy[dict[str, float]]:
    """Values of x, y, z in eighths: short sums and products of them are exact."""
    return st.fixed_dictionaries({name: st.integers(-40, 40).map(lambda n: n / 8) for name in INPUTS})


def committed(*names: str) -> Program:
    """The committed program of these names."""
    return program_of(names)


def run_exactly(program: Program, mp: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Every name of the program by the `exact` column, over the functions of `mp`."""
    scope: dict[str, Any] = {name: mp.mpf(values[name]) for name in program.inputs}
    scope |= {name: values[name] for name in tables_in(program)}

    def argument(value: Argument) -> Any:
        if isinstance(value, (str, TableName)):
            return scope[value if isinstance(value, str) else value.name]
        return mp.mpf(value) if isinstance(value, float) else value

    for line in program.lines:
        scope[line.name] = OPERATIONS[line.op].exact(mp, *map(argument, line.args))
    return scope


def exactly(program: Program, values: Mapping[str, Any]) -> dict[str, Any]:
    """The outputs at 50 digits."""
    with mpmath.workdps(50):
        scope = run_exactly(program, mpmath.mp, values)
    return {name: scope[name] for name in program.outputs}


def in_doubles(program: Program, values: Mapping[str, float]) -> dict[str, Any]:
    """The outputs in doubles."""
    scope = run_in_doubles(program, values)
    return {name: scope[name] for name in program.outputs}


def same(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    """True if all values are equal; NaN equals NaN."""
    return a.keys() == b.keys() and all(a[n] == b[n] or (a[n] != a[n] and b[n] != b[n]) for n in a)


def same_bits(a: Any, b: Any) -> bool:
    """True if two numbers are the same double, sign included; NaN equals NaN."""
    a, b = float(a), float(b)
    return struct.pack("d", a) == struct.pack("d", b) or (math.isnan(a) and math.isnan(b))


def tree(program: Program) -> dict[str, Any]:
    """Each output as nested operations: what a program says, whatever its temporaries are called.

    A negated constant is the negative constant: both are written alike.
    """
    known: dict[str, Any] = {name: name for name in program.inputs}
    for line in program.lines:
        args = tuple(known[a] if isinstance(a, str) else (type(a).__name__, repr(a)) for a in line.args)
        known[line.name] = args[0] if line.op == "copy" else (line.op, line.type, *args)
        if line.op == "neg" and isinstance(args[0], tuple) and args[0][0] == "float":
            known[line.name] = ("float", repr(-float(args[0][1])))
    return {name: known[name] for name in program.outputs}


def depends_on(program: Program) -> dict[str, set[str]]:
    """The inputs that each name needs."""
    needs = {name: {name} for name in program.inputs}
    for line in program.lines:
        needs[line.name] = set().union(*(needs[name] for name in names_in(line.args)))
    return needs


def lines_of(nested: Any) -> tuple[Line, ...]:
    """Nested tuples such as ("sub", "x", ("neg", "y")) as lines, the last of them named `out`."""
    lines: list[Line] = []

    def visit(node: Any) -> Argument:
        if not isinstance(node, tuple):
            return node
        op, args = node[0], tuple(visit(argument) for argument in node[1:])
        kinds = dict.fromkeys(INPUTS, "f64") | {line.name: line.type for line in lines}
        kind = result_type(OPERATIONS[op], tuple(type_of(a, kinds) for a in args))
        lines.append(Line(f"_{len(lines)}", op, args, kind))
        return lines[-1].name

    visit(nested)
    return (*lines[:-1], lines[-1]._replace(name="out"))


def program_of_nested(nested: Any) -> Program:
    """The program `out = nested` over x, y, z."""
    return Program(INPUTS, lines_of(nested), ("out",), {})
