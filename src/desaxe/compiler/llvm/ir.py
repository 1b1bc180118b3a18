"""Operations and loops as LLVM's text.

A loop is a function `i64 name(i64 %n, inputs, values, outputs)` over n points, at least LANES: pointers that
overlap with no output, values of outer loops, pointers to the outputs. It runs LANES points at a time, the
last ones maybe twice, so that all of it is one loop of vectors. It returns the number of points for which its
condition `counted` holds; those that run twice may count twice.
"""

import struct
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from ..operations import OPERATIONS
from ..program import Argument, Line, TableName, names_in, type_of

TYPES = {"f64": "double", "bool": "i1", "i64": "i64"}
STORED = {"f64": "double", "bool": "i8", "i64": "i8"}  # in arrays
BYTES = {"double": 8, "i8": 1, "i64": 8}
LANES = 8
WIDE = '"prefer-vector-width"="512"'


class Body:
    """The instructions of a function, and what the names of a Program are in it."""

    def __init__(self, types: Mapping[str, str], names: Mapping[str, str]) -> None:
        self.rows: list[str] = []
        self.types, self.names = {**types}, {**names}
        self._count = 0

    def emit(self, instruction: str) -> str:
        """The value of a new instruction."""
        self._count += 1
        self.rows.append(f"  %.{self._count} = {instruction}")
        return f"%.{self._count}"

    def do(self, instruction: str) -> None:
        """An instruction without a value."""
        self.rows.append(f"  {instruction}")

    def label(self, name: str) -> None:
        """The beginning of a block."""
        self.rows.append(f"{name}:")

    def lines(self, lines: Iterable[Line]) -> None:
        """The operations of lines."""
        for line in lines:
            template = OPERATIONS[line.op].llvm
            text = template.format(*map(self.value, line.args), T=TYPES[line.type])
            self.names[line.name] = self.emit(text) if " " in text else text
            self.types[line.name] = line.type

    def value(self, argument: Argument) -> str:
        """The text of an argument."""
        if isinstance(argument, str):
            return self.names[argument]
        if isinstance(argument, bool):
            return "true" if argument else "false"
        if isinstance(argument, float):
            return f"0x{struct.unpack('<Q', struct.pack('<d', argument))[0]:016X}"
        return f"%{argument.name}" if isinstance(argument, TableName) else str(argument)

    def element(self, kind: str, pointer: str, index: str) -> str:
        """The address of an element of an array."""
        return self.emit(f"getelementptr inbounds {kind}, ptr {pointer}, i64 {index}")

    def load(self, kind: str, pointer: str, index: str) -> str:
        """An element of an array."""
        return self.emit(f"load {kind}, ptr {self.element(kind, pointer, index)}")

    def store(self, argument: Argument, pointer: str, index: str) -> None:
        """Store a value of a Program in an array."""
        type_, value = type_of(argument, self.types), self.value(argument)
        kind = STORED[type_]
        if type_ != "f64":
            value = self.emit(f"{'zext i1' if type_ == 'bool' else 'trunc i64'} {value} to i8")
        self.do(f"store {kind} {value}, ptr {self.element(kind, pointer, index)}")


class Loop(NamedTuple):
    """A loop over points.

    name     of the function
    reads    the names that are arrays
    values   the names that come from outside
    tables   the tables that are looked up
    lines    what is computed
    stores   what is stored, in the order of the outputs
    counted  a condition whose points are counted
    """

    name: str
    reads: tuple[str, ...]
    values: tuple[str, ...]
    tables: tuple[str, ...]
    lines: tuple[Line, ...]
    stores: tuple[Argument, ...]
    counted: str | None = None

    def padded(self, types: Mapping[str, str], kinds: Sequence[str]) -> str:
        """The function `<name>_rows`: this loop over any number of points, where a few are copied.

        kinds   of the outputs' elements
        """
        body = Body(types, {name: f"%{name}.value" for name in self.values})
        room = {name: f"%{name}.room" for name in self.reads}
        rooms = [f"%room.{k}" for k in range(len(kinds))]
        body.rows += [f"  {buffer} = alloca [{LANES} x double], align 64" for buffer in room.values()]
        for buffer, kind in zip(rooms, kinds, strict=True):
            body.do(f"{buffer} = alloca [{LANES} x {kind}], align 64")
        outputs = [f"%to.{k}" for k in range(len(kinds))]
        body.do(f"%few = icmp ult i64 %n, {LANES}")
        body.do("br i1 %few, label %copies, label %direct")
        body.label("direct")
        count = self.call(body, "%n", {name: f"%{name}.from" for name in self.reads}, outputs)
        body.do(f"ret i64 {count}")
        body.label("copies")
        for name, buffer in room.items():
            body.do(f"call void @fill(ptr {buffer}, ptr %{name}.from, i64 %n)")
        count = self.call(body, str(LANES), room, rooms)
        for output, buffer, kind in zip(outputs, rooms, kinds, strict=True):
            body.do(f"call void @scatter_{kind}(ptr {output}, i64 {BYTES[kind]}, ptr {buffer}, i64 %n)")
        parameters = ", ".join(["i64 %n", *self.parameters(types)])
        head = f"define internal i64 @{self.name}_rows({parameters}) {WIDE} {{"
        return "\n".join([head, *body.rows, f"  ret i64 {count}", "}"])

    def parameters(self, types: Mapping[str, str]) -> list[str]:
        """The declarations of the parameters after the number of points."""
        return [
            *(f"ptr noalias readonly %{name}.from" for name in self.reads),
            *(f"{TYPES[types.get(name, 'f64')]} %{name}.value" for name in self.values),
            *table_parameters(self.tables),
            *(f"ptr noalias %to.{k}" for k in range(len(self.stores))),
        ]

    def call(self, body: Body, n: str, inputs: Mapping[str, str], outputs: Sequence[str]) -> str:
        """Call it in another function, where `inputs` are pointers; the number of counted points."""
        arguments = [
            f"i64 {n}",
            *(f"ptr {inputs[name]}" for name in self.reads),
            *(f"{TYPES[body.types.get(name, 'f64')]} {body.names[name]}" for name in self.values),
            *table_parameters(self.tables),
            *(f"ptr {pointer}" for pointer in outputs),
        ]
        return body.emit(f"call i64 @{self.name}({', '.join(arguments)})")

    def text(self, types: Mapping[str, str]) -> str:
        """The function."""
        scope = {name: f"%{name}.value" for name in self.values}
        body = Body({**dict.fromkeys(self.values, "f64"), **types}, scope)
        body.types |= dict.fromkeys(self.reads, "f64")
        for name in self.reads:
            body.names[name] = body.load("double", f"%{name}.from", "%i")
        body.lines(self.lines)
        for k, argument in enumerate(self.stores):
            body.store(argument, f"%to.{k}", "%i")
        count = f"zext i1 {body.value(self.counted)} to i64" if self.counted else "add i64 0, 0"
        total = body.emit(f"add i64 %count, {body.emit(count)}")
        parameters = ", ".join(["i64 %n", *self.parameters(types)])
        return "\n".join([
            f"define internal i64 @{self.name}({parameters}) noinline {WIDE} {{",
            f"  %last = sub i64 %n, {LANES}",
            "  br label %group",
            "group:",
            "  %at = phi i64 [ 0, %0 ], [ %after, %done ]",
            f"  %counted = phi i64 [ 0, %0 ], [ {total}, %done ]",
            "  %first = call i64 @llvm.smin.i64(i64 %at, i64 %last)",
            "  br label %loop",
            "loop:",
            "  %k = phi i64 [ 0, %group ], [ %next, %loop ]",
            f"  %count = phi i64 [ %counted, %group ], [ {total}, %loop ]",
            "  %i = add nuw nsw i64 %first, %k",
            *body.rows,
            "  %next = add nuw nsw i64 %k, 1",
            f"  %more = icmp ult i64 %next, {LANES}",
            "  br i1 %more, label %loop, label %done",
            "done:",
            f"  %after = add nuw nsw i64 %at, {LANES}",
            "  %again = icmp ult i64 %after, %n",
            "  br i1 %again, label %group, label %end",
            "end:",
            f"  ret i64 {total}",
            "}",
        ])  # fmt: skip


def loop_of(
    name: str,
    lines: Sequence[Line],
    stores: Sequence[Argument],
    arrays: Iterable[str],
    counted: str | None = None,
) -> Loop:
    """The loop of these lines; `arrays` are the names that may be read from arrays."""
    made = {line.name for line in lines}
    needed = [name for line in lines for name in names_in(line.args)]
    needed += names_in([*stores, *([counted] if counted else [])])
    outside = [name for name in dict.fromkeys(needed) if name not in made]
    tables = dict.fromkeys(a.name for line in lines for a in line.args if isinstance(a, TableName))
    known = set(arrays)
    return Loop(
        name,
        tuple(n for n in outside if n in known),
        tuple(n for n in outside if n not in known),
        tuple(tables),
        tuple(lines),
        tuple(stores),
        counted,
    )


def table_parameters(tables: Iterable[str]) -> list[str]:
    """The parameters, and the arguments, of tables."""
    return [text for name in tables for text in (f"ptr %{name}.x", f"ptr %{name}.c", f"i64 %{name}.n")]
