"""Expressions of a Python function as LLVM's text (see `loops`)."""

import ast
import builtins
import math
from collections.abc import Callable, Sequence
from ctypes import CFUNCTYPE, c_int64
from numbers import Integral
from types import FunctionType, ModuleType
from typing import Any, NamedTuple, NoReturn

from ..helpers import mul_add
from .ir import bits_of


class Array(NamedTuple):
    """A contiguous array of items (f64, i64, i8), with this number of axes."""

    item: str
    axes: int


class Tuple(NamedTuple):
    """A tuple of kinds."""

    kinds: tuple[Any, ...]


Kind = Any  # "f64", "i64", "bool", "none", an Array or a Tuple
LLVM = {"f64": "double", "i64": "i64", "bool": "i1", "i8": "i8", "none": "void"}
ORDER = ("none", "bool", "i64", "f64")  # a variable of two of these is of the later one


def parts_of(kind: Kind) -> tuple[str, ...]:
    """The LLVM types of a value: an array has a pointer and its lengths."""
    if isinstance(kind, Array):
        return ("ptr", *["i64"] * kind.axes)
    if isinstance(kind, Tuple):
        return tuple(part for each in kind.kinds for part in parts_of(each))
    return (LLVM[kind],)


def joined(a: Kind, b: Kind) -> Kind:
    """The kind of a value that is of one of two kinds."""
    if a == b:
        return a
    if isinstance(a, Tuple) and isinstance(b, Tuple):
        return Tuple(tuple(map(joined, a.kinds, b.kinds)))
    return max(a, b, key=ORDER.index)


class LoopValue(NamedTuple):
    """A value: its kind, and the text of each part."""

    kind: Kind
    parts: tuple[str, ...]

    @staticmethod
    def llvm(kind: Kind) -> str:
        """The LLVM type of a result."""
        parts = parts_of(kind)
        return parts[0] if len(parts) == 1 else f"{{ {', '.join(parts)} }}"

    def items(self) -> list["LoopValue"]:
        """The items of a tuple."""
        result, at = [], 0
        for kind in self.kind.kinds:
            count = len(parts_of(kind))
            result.append(LoopValue(kind, self.parts[at : at + count]))
            at += count
        return result

    @property
    def constant(self) -> int | None:
        """The whole number that it is; None of any other."""
        text = self.parts[0]
        return int(text) if self.kind == "i64" and text.lstrip("-").isdigit() else None


def apart() -> None:
    """The promise that no two arrays among the arguments of the calling function share memory."""


def address(array: Any) -> int:
    """The address of an array."""
    result: int = array.__array_interface__["data"][0]
    return result


def call(function: Any, *arguments: Any) -> int:
    """Call machine code at an address with whole numbers and the addresses of arrays; its whole number."""
    words = [int(v) if isinstance(v, Integral) else address(v) for v in arguments]
    result: int = CFUNCTYPE(c_int64, *[c_int64] * len(words))(int(function))(*words)
    return result


OURS = (apart, address, call, mul_add)


LIBRARY = ("sin", "cos", "asin", "atan2", "exp", "log", "nextafter")
INTRINSICS = {"mul_add": "llvm.fmuladd.f64", **{name: name for name in LIBRARY}} | {
    name: f"llvm.{name}.f64" for name in ("sqrt", "floor", "fabs", "copysign")
}
COMPARED = {
    ast.Lt: ("olt", "slt"), ast.LtE: ("ole", "sle"), ast.Gt: ("ogt", "sgt"), ast.GtE: ("oge", "sge"),
    ast.Eq: ("oeq", "eq"), ast.NotEq: ("une", "ne"),
}  # fmt: skip
CONVERTED = {"float": "f64", "int64": "i64", "int": "i64", "bool": "bool"}
BINARY = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul"}


class Expressions:
    """The instructions of a function, and the values of its expressions."""

    def __init__(self, module: Any, function: FunctionType, variables: dict[str, Kind]) -> None:
        self.module, self.function, self.variables = module, function, variables
        self.rows: list[str] = []
        self.allocas: list[str] = []
        self._made: set[str] = set()
        self._ends: list[tuple[str, str, str, str, str]] = []
        self._count = 0
        self._calls: dict[str, Callable[[Sequence[ast.expr]], LoopValue]] = {
            "abs": self._abs, "len": self._length, "empty": self._empty, "zeros": self._zeros,
            "isfinite": self._finite, "min": lambda nodes: self._least(nodes, True),
            "max": lambda nodes: self._least(nodes, False), "apart": lambda _: LoopValue("none", ()),
            "address": self._address, "call": self._call,
        }  # fmt: skip

    # ---- instructions -------------------------------------------------------------------------

    def new(self, name: str) -> str:
        """A new name."""
        self._count += 1
        return f"{name}.{self._count}"

    def emit(self, instruction: str) -> str:
        """The value of a new instruction."""
        name = "%" + self.new("")
        self.rows.append(f"  {name} = {instruction}")
        return name

    def do(self, instruction: str) -> None:
        """An instruction without a value."""
        self.rows.append(f"  {instruction}")

    def label(self, name: str) -> None:
        """The beginning of a block."""
        self.rows.append(f"{name}:")

    def jump(self, label: str) -> None:
        """Go on elsewhere."""
        self.do(f"br label %{label}")

    def branch(self, test: ast.expr, then: str, other: str) -> None:
        """Go on at one of two blocks."""
        self.do(f"br i1 {self.truth(test)}, label %{then}, label %{other}")

    def alloca(self, kind: str) -> str:
        """Memory of the function."""
        name = "%" + self.new(".room")
        self.allocas.append(f"  {name} = alloca {kind}, align 64")
        return name

    def unknown(self, node: ast.AST) -> NoReturn:
        """Raise the error of a construct that is not known."""
        where = f"{self.function.__name__}, line {getattr(node, 'lineno', '?')}"
        raise TypeError(f"{where}: {ast.unparse(node)} cannot be compiled")

    # ---- variables and types ------------------------------------------------------------------

    def assign(self, name: str, value: LoopValue) -> None:
        """Assign to a variable, which may widen its type."""
        kind = joined(self.variables.get(name, value.kind), value.kind)
        self.variables[name] = kind
        self._declare(name, kind)
        for k, (part, text) in enumerate(zip(parts_of(kind), self.converted(value, kind).parts, strict=True)):
            self.do(f"store {part} {text}, ptr %v.{name}.{k}")

    def _declare(self, name: str, kind: Kind) -> None:
        if name not in self._made:
            self._made.add(name)
            self.allocas += [f"  %v.{name}.{k} = alloca {part}" for k, part in enumerate(parts_of(kind))]

    def converted(self, value: LoopValue, kind: Kind) -> LoopValue:
        """A value of another kind."""
        if value.kind == kind:
            return value
        if isinstance(kind, Tuple):
            items = map(self.converted, value.items(), kind.kinds)
            return LoopValue(kind, tuple(part for item in items for part in item.parts))
        text = value.parts[0]
        if kind == "f64":
            if value.constant is not None:
                return LoopValue(kind, (bits_of(float(value.constant)),))
            change = "sitofp i64" if value.kind == "i64" else "uitofp i1"
            return LoopValue(kind, (self.emit(f"{change} {text} to double"),))
        if kind == "i64":
            change = "fptosi double" if value.kind == "f64" else "zext i1"
            return LoopValue(kind, (self.emit(f"{change} {text} to i64"),))
        zero = "fcmp une double" if value.kind == "f64" else "icmp ne i64"
        return LoopValue(kind, (self.emit(f"{zero} {text}, {'0.0' if value.kind == 'f64' else '0'}"),))

    def truth(self, node: ast.expr) -> str:
        """A condition."""
        return self.converted(self.value(node), "bool").parts[0]

    def number(self, node: ast.expr, kind: str = "f64") -> str:
        """The text of a number of some kind."""
        return self.converted(self.value(node), kind).parts[0]

    # ---- expressions --------------------------------------------------------------------------

    def value(self, node: ast.expr) -> LoopValue:
        """The value of an expression."""
        result: LoopValue = getattr(self, f"_of_{type(node).__name__}", self.unknown)(node)
        return result

    def _of_Constant(self, node: ast.Constant) -> LoopValue:
        return self.literal(node.value, node)

    def literal(self, value: Any, node: ast.AST) -> LoopValue:
        """A number that is known."""
        if isinstance(value, bool):
            return LoopValue("bool", ("true" if value else "false",))
        if isinstance(value, Integral):
            return LoopValue("i64", (str(int(value)),))
        if isinstance(value, float):
            return LoopValue("f64", (bits_of(float(value)),))
        self.unknown(node)

    def _of_Name(self, node: ast.Name) -> LoopValue:
        if node.id in self.variables:
            kind = self.variables[node.id]
            self._declare(node.id, kind)
            loads = [f"load {part}, ptr %v.{node.id}.{k}" for k, part in enumerate(parts_of(kind))]
            return LoopValue(kind, tuple(map(self.emit, loads)))
        return self.literal(self.known(node.id), node)

    def known(self, name: str) -> Any:
        """The object behind a name of the module."""
        for scope in (self.module.names, self.function.__globals__, vars(builtins)):
            if name in scope:
                return scope[name]
        raise TypeError(f"{self.function.__name__}: {name} is not known")

    def _of_Tuple(self, node: ast.Tuple) -> LoopValue:
        items = [self.value(one) for one in node.elts]
        kinds, parts = tuple(i.kind for i in items), tuple(p for i in items for p in i.parts)
        return LoopValue(Tuple(kinds), parts)

    def _of_UnaryOp(self, node: ast.UnaryOp) -> LoopValue:
        if isinstance(node.op, ast.Not):
            return LoopValue("bool", (self.emit(f"xor i1 {self.truth(node.operand)}, true"),))
        value = self.value(node.operand)
        if value.constant is not None:
            return LoopValue("i64", (str(-value.constant),))
        if value.kind == "i64":
            return LoopValue("i64", (self.emit(f"sub i64 0, {value.parts[0]}"),))
        return LoopValue("f64", (self.emit(f"fneg double {value.parts[0]}"),))

    def _of_BinOp(self, node: ast.BinOp) -> LoopValue:
        return self.binary(node, self.value(node.left), self.value(node.right))

    def binary(self, node: ast.BinOp | ast.AugAssign, left: LoopValue, right: LoopValue) -> LoopValue:
        """Sum, difference, product, quotient or power."""
        kind = joined(joined(left.kind, right.kind), "i64")
        name = BINARY.get(type(node.op))
        if name and kind == "i64":
            a, b = left.constant, right.constant
            if a is not None and b is not None:
                return LoopValue("i64", (str({"add": a + b, "sub": a - b, "mul": a * b}[name]),))
            texts = [self.converted(one, "i64").parts[0] for one in (left, right)]
            return LoopValue("i64", (self.emit(f"{name} nsw i64 {texts[0]}, {texts[1]}"),))
        a_text, b_text = (self.converted(one, "f64").parts[0] for one in (left, right))
        if isinstance(node.op, ast.Pow):
            return LoopValue("f64", (self.emit(f"call double @pow(double {a_text}, double {b_text})"),))
        if not name and not isinstance(node.op, ast.Div):
            self.unknown(node)
        return LoopValue("f64", (self.emit(f"f{name or 'div'} double {a_text}, {b_text}"),))

    def _of_Compare(self, node: ast.Compare) -> LoopValue:
        left, result = self.value(node.left), ""
        for op, other in zip(node.ops, node.comparators, strict=True):
            right = self.value(other)
            kind = joined(joined(left.kind, right.kind), "i64")
            a, b = (self.converted(one, kind).parts[0] for one in (left, right))
            test = COMPARED[type(op)]
            one = self.emit(
                f"fcmp {test[0]} double {a}, {b}" if kind == "f64" else f"icmp {test[1]} i64 {a}, {b}"
            )
            result, left = self.emit(f"and i1 {result}, {one}") if result else one, right
        return LoopValue("bool", (result,))

    def _of_BoolOp(self, node: ast.BoolOp) -> LoopValue:
        room, end, both = self.alloca("i1"), self.new("end"), isinstance(node.op, ast.And)
        for one in node.values:
            go_on, test = self.new("next"), self.truth(one)
            self.do(f"store i1 {test}, ptr {room}")
            targets = (go_on, end) if both else (end, go_on)
            self.do(f"br i1 {test}, label %{targets[0]}, label %{targets[1]}")
            self.label(go_on)
        self.jump(end)
        self.label(end)
        return LoopValue("bool", (self.emit(f"load i1, ptr {room}"),))

    def _of_IfExp(self, node: ast.IfExp) -> LoopValue:
        then, other, end = (self.new(name) for name in ("then", "else", "end"))
        name = f"chosen.{node.lineno}.{node.col_offset}"
        self.branch(node.test, then, other)
        self.label(then)
        self.assign(name, self.value(node.body))
        self.jump(end)
        self.label(other)
        self.assign(name, self.value(node.orelse))
        self.jump(end)
        self.label(end)
        return self._of_Name(ast.Name(name))

    def _of_Attribute(self, node: ast.Attribute) -> LoopValue:
        module = self.function.__globals__.get(getattr(node.value, "id", ""))
        if isinstance(module, ModuleType):
            return self.literal(getattr(module, node.attr), node)
        array = self.value(node.value)
        if node.attr != "shape" or not isinstance(array.kind, Array):
            self.unknown(node)
        return LoopValue(Tuple(("i64",) * array.kind.axes), array.parts[1:])

    def _of_Subscript(self, node: ast.Subscript) -> LoopValue:
        place = self.element(node)
        if place.kind not in ("at f64", "at i64", "at i8"):
            return place
        item = place.kind[3:]
        read = self.emit(f"load {LLVM[item]}, ptr {place.parts[0]}")
        if item == "i8":
            return LoopValue("i64", (self.emit(f"sext i8 {read} to i64"),))
        return LoopValue(item, (read,))

    # ---- arrays -------------------------------------------------------------------------------

    def element(self, node: ast.Subscript) -> LoopValue:
        """The address of an element, a part of an array, or an item of a tuple."""
        whole, index = self.value(node.value), node.slice
        indices = index.elts if isinstance(index, ast.Tuple) else [index]
        if isinstance(whole.kind, Tuple):
            constant = self.value(indices[0]).constant
            if constant is None:
                self.unknown(node)
            return whole.items()[constant]
        pointer, lengths = whole.parts[0], list(whole.parts[1:])
        offset, left = "0", list(lengths)
        for k, one in enumerate(indices):
            if isinstance(one, ast.Slice):
                first = self.number(one.lower, "i64") if one.lower else "0"
                last = self.number(one.upper, "i64") if one.upper else lengths[k]
                left[0] = self._times(last, first, "sub")
            else:
                first = self._from_start(self.value(one), lengths[k])
                left.pop(0)
            offset = self._times(self._times(offset, lengths[k], "mul"), first, "add")
        for length in lengths[len(indices) :]:
            offset = self._times(offset, length, "mul")
        place = self.pointed(whole.kind.item, pointer, offset)
        return LoopValue(Array(whole.kind.item, len(left)), (*place.parts, *left)) if left else place

    def _times(self, a: str, b: str, op: str) -> str:
        """The sum, difference or product of two lengths."""
        if b == "0" and op != "mul":
            return a
        if a == "0" and op != "sub":
            return b if op == "add" else "0"
        return self.emit(f"{op} nsw i64 {a}, {b}")

    def _from_start(self, index: LoopValue, length: str) -> str:
        constant, text = index.constant, self.converted(index, "i64").parts[0]
        return self.emit(f"add i64 {length}, {text}") if constant is not None and constant < 0 else text

    def pointed(self, item: str, pointer: str, offset: str) -> LoopValue:
        """The address of an element."""
        at = self.emit(f"getelementptr inbounds {LLVM[item]}, ptr {pointer}, i64 {offset}")
        return LoopValue(f"at {item}", (at,))

    def store(self, place: LoopValue, value: LoopValue) -> None:
        """Put a number into an element."""
        item = place.kind[3:]
        text = self.converted(value, "i64" if item == "i8" else item).parts[0]
        text = self.emit(f"trunc i64 {text} to i8") if item == "i8" else text
        self.do(f"store {LLVM[item]} {text}, ptr {place.parts[0]}")

    # ---- calls --------------------------------------------------------------------------------

    def _of_Call(self, node: ast.Call) -> LoopValue:
        if not isinstance(node.func, ast.Name) or node.keywords:
            self.unknown(node)
        target = self.known(node.func.id)
        if isinstance(target, FunctionType) and target not in OURS:
            return self._called(target, [self.value(one) for one in node.args])
        name = getattr(target, "__name__", "")
        if name in CONVERTED:
            return self.converted(self.value(node.args[0]), CONVERTED[name])
        if name in self._calls:
            return self._calls[name](node.args)
        if name not in INTRINSICS:
            self.unknown(node)
        passed = ", ".join(f"double {self.number(one)}" for one in node.args)
        return LoopValue("f64", (self.emit(f"call double @{INTRINSICS[name]}({passed})"),))

    def _called(self, target: FunctionType, values: Sequence[LoopValue]) -> LoopValue:
        kinds = tuple(value.kind for value in values)
        symbol, result = self.module.function(target, kinds)
        passed = ", ".join(
            f"{part} {text}"
            for value in values
            for part, text in zip(parts_of(value.kind), value.parts, strict=True)
        )
        call = f"call {LoopValue.llvm(result)} @{symbol}({passed})"
        if result == "none":
            self.do(call)
            return LoopValue("none", ())
        whole = self.emit(call)
        if not isinstance(result, Tuple):
            return LoopValue(result, (whole,))
        taken = [f"extractvalue {LoopValue.llvm(result)} {whole}, {k}" for k in range(len(parts_of(result)))]
        return LoopValue(result, tuple(map(self.emit, taken)))

    def _least(self, nodes: Sequence[ast.expr], least: bool) -> LoopValue:
        """The least or the largest, by Python's comparisons."""
        values = [self.value(node) for node in nodes]
        kind = values[0].kind
        for value in values:
            kind = joined(kind, value.kind)
        best, *others = (self.converted(value, kind).parts[0] for value in values)
        word, type_ = ("fcmp o" if kind == "f64" else "icmp s") + ("lt" if least else "gt"), LLVM[kind]
        for other in others:
            test = self.emit(f"{word} {type_} {other}, {best}")
            best = self.emit(f"select i1 {test}, {type_} {other}, {type_} {best}")
        return LoopValue(kind, (best,))

    def _abs(self, nodes: Sequence[ast.expr]) -> LoopValue:
        value = self.value(nodes[0])
        if value.kind == "i64":
            return LoopValue("i64", (self.emit(f"call i64 @llvm.abs.i64(i64 {value.parts[0]}, i1 false)"),))
        return LoopValue("f64", (self.emit(f"call double @llvm.fabs.f64(double {value.parts[0]})"),))

    def _length(self, nodes: Sequence[ast.expr]) -> LoopValue:
        return LoopValue("i64", self.value(nodes[0]).parts[1:2])

    def _finite(self, nodes: Sequence[ast.expr]) -> LoopValue:
        size = self.emit(f"call double @llvm.fabs.f64(double {self.number(nodes[0])})")
        return LoopValue("bool", (self.emit(f"fcmp olt double {size}, {bits_of(math.inf)}"),))

    def _address(self, nodes: Sequence[ast.expr]) -> LoopValue:
        return LoopValue("i64", (self.emit(f"ptrtoint ptr {self.value(nodes[0]).parts[0]} to i64"),))

    def _call(self, nodes: Sequence[ast.expr]) -> LoopValue:
        function = self.emit(f"inttoptr i64 {self.number(nodes[0], 'i64')} to ptr")
        values = [self.value(node) for node in nodes[1:]]
        passed = ", ".join(f"{parts_of(value.kind)[0]} {value.parts[0]}" for value in values)
        return LoopValue("i64", (self.emit(f"call i64 {function}({passed})"),))

    def _empty(self, nodes: Sequence[ast.expr]) -> LoopValue:
        shape = nodes[0].elts if isinstance(nodes[0], ast.Tuple) else [nodes[0]]
        lengths = [self.value(one).constant for one in shape]
        if None in lengths:
            self.unknown(nodes[0])
        size = math.prod(length or 0 for length in lengths)
        item = "f64" if len(nodes) == 1 else "i64"  # the only other type
        return LoopValue(
            Array(item, len(lengths)), (self.alloca(f"[{size} x {LLVM[item]}]"), *map(str, lengths))
        )

    def _zeros(self, nodes: Sequence[ast.expr]) -> LoopValue:
        array = self._empty(nodes)
        size = math.prod(int(length) for length in array.parts[1:])
        self.do(f"store [{size} x {LLVM[array.kind.item]}] zeroinitializer, ptr {array.parts[0]}")
        return array
