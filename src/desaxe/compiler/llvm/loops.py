"""Plain Python functions of numbers and arrays as machine code, without a compiler's runtime.

A function may have `for` over `range`, `while`, `if`, tuples, calls of functions alike, of `math`, and
`empty` or `zeros` of constant shapes. Values are doubles (f64), whole numbers (i64), conditions (bool),
contiguous arrays and tuples of all these; a variable has one type. A function is compiled for each list of
types that it is called with. Indices are not checked, and only constants count from the end. A division by 0
is infinite or NaN; nothing is contracted or reordered, so that Python finds the same bits, only later.
"""

import ast
import struct
from collections.abc import Callable, Mapping, Sequence
from ctypes import CFUNCTYPE, c_char_p, c_int64
from inspect import getsource
from textwrap import dedent
from types import FunctionType
from typing import Any, NamedTuple

from .expressions import address, apart, call
from .ir import WIDE
from .machine import Code, compiled
from .nest import FUNCTIONS
from .statements import Array, Kind, LoopFunction, LoopValue, parts_of

ENTRY = "loops"
DECLARED = (
    FUNCTIONS.partition("define ")[0]
    + """
declare i64 @llvm.abs.i64(i64, i1)
declare double @asin(double)
declare double @nextafter(double, double)
"""
)
_CALL = CFUNCTYPE(c_int64, c_char_p)  # lets go of the GIL while it runs


class Compiled(NamedTuple):
    """A function for some types: its symbol, the kind of its result."""

    symbol: str
    result: Kind


class LoopModule:
    """The functions that an entry needs, each for the types that it is called with."""

    def __init__(self, names: Mapping[str, Any]) -> None:
        self.names, self.texts = names, list[str]()
        self._done: dict[tuple[FunctionType, tuple[Kind, ...]], Compiled] = {}

    def function(self, function: FunctionType, kinds: tuple[Kind, ...]) -> Compiled:
        """The compiled function for some types of its arguments."""
        key = function, kinds
        if key not in self._done:
            symbol = f"{function.__name__}.{len(self._done)}"
            self._done[key] = Compiled(symbol, "none")  # none may call itself
            tree = ast.parse(dedent(getsource(function))).body[0]
            assert isinstance(tree, ast.FunctionDef)
            variables: dict[str, Kind] = {}
            while True:  # until no variable has a wider type than before
                before = dict(variables)
                body = LoopFunction(self, function, tree, kinds, variables)
                text = body.text(symbol)
                if variables == before:
                    break
            self.texts.append(text)
            self._done[key] = Compiled(symbol, variables["return"])
        return self._done[key]


class CompiledLoops:
    """A function in machine code, called with the same arguments: arrays of contiguous memory, numbers."""

    def __init__(self, function: Any, kinds: Sequence[str], names: Mapping[str, Any] | None = None) -> None:
        """Compile it.

        kinds   of the arguments: `f64`, `i64`, or an array as `f64[2]`, by its axes
        names   values of names that differ from those of the functions' modules
        """
        types = tuple(map(_kind, kinds))
        module = LoopModule(names or {})
        entry = _entry(module.function(function, types), types)
        text = "\n".join([DECLARED, *module.texts, entry])
        self.code: Code = compiled(text, ENTRY, optimised=True)
        self._call: Callable[[bytes], int] = _CALL(self.code.address)
        self._types = types
        self._pack = struct.Struct("".join("q" * len(parts_of(t)) if t != "f64" else "d" for t in types)).pack

    def __call__(self, *arguments: Any) -> int:
        """Run it; its whole number, if it returns one."""
        words: list[Any] = []
        for argument, kind in zip(arguments, self._types, strict=True):
            if isinstance(kind, Array):
                if not argument.flags.c_contiguous:
                    raise ValueError("loops take arrays of contiguous memory")
                words += (argument.__array_interface__["data"][0], *argument.shape)
            else:
                words.append(argument)
        return self._call(self._pack(*words))


def _kind(text: str) -> Kind:
    item, _, axes = text.rstrip("]").partition("[")
    return Array(item, int(axes)) if axes else item


def _entry(function: Compiled, types: Sequence[Kind]) -> str:
    """The function of one pointer, to the words of the arguments."""
    rows, arguments = list[str](), list[str]()
    for kind in (part for each in types for part in parts_of(each)):
        k = len(arguments)
        rows += [f"  %a{k} = getelementptr i64, ptr %words, i64 {k}", f"  %w{k} = load {kind}, ptr %a{k}"]
        arguments.append(f"{kind} %w{k}")
    call = f"call {LoopValue.llvm(function.result)} @{function.symbol}({', '.join(arguments)})"
    whole = function.result == "i64"
    rows += [f"  %result = {call}", "  ret i64 %result"] if whole else [f"  {call}", "  ret i64 0"]
    return "\n".join([f"define i64 @{ENTRY}(ptr %words) {WIDE} {{", *rows, "}"])


__all__ = ["CompiledLoops", "address", "apart", "call"]
