"""Operations and loops as LLVM's text.

A loop is a function `i64 name(i64 %n, inputs, values, outputs)` over n points, at least as many as a vector
has: pointers that overlap with no output, values of outer loops, pointers to the outputs. It runs a vector of
points at a time, the last ones maybe twice. It returns the number of points for which its condition `counted`
holds; those that run twice may count twice.
"""

import string
import struct
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from ...support.template import file_text, filled
from ..operations import OPERATIONS
from ..program import Argument, Line, TableName, names_in, type_of

FORMATTER = string.Formatter()
TYPES = {"f64": "double", "bool": "i1", "i64": "i64", "i8": "i8"}
STORED = {"f64": "double", "bool": "i8", "i64": "i8"}  # in arrays
BYTES = {"double": 8, "i8": 1, "i64": 8}
WIDE = '"prefer-vector-width"="512"'
LOOP = file_text(__package__, "loop.ll")


class Kinds(NamedTuple):
    """The types of values: single ones, or vectors of some."""

    lanes: int = 1

    def of(self, kind: str) -> str:
        """The type of doubles (f64), conditions (bool) or whole numbers (i64, i8)."""
        single = TYPES[kind]
        return single if self.lanes == 1 else f"<{self.lanes} x {single}>"

    def constant(self, kind: str, value: str) -> str:
        """A constant."""
        return value if self.lanes == 1 else f"splat ({TYPES[kind]} {value})"


class _Names(dict[str, str]):
    """The arguments of an instruction's text: types, names, constants."""

    def __init__(self, kinds: Kinds, generic: str) -> None:
        end = "f64" if kinds.lanes == 1 else f"v{kinds.lanes}f64"
        true, false = (kinds.constant("bool", word) for word in ("true", "false"))
        types = {"f": kinds.of("f64"), "b": kinds.of("bool"), "i": kinds.of("i64"), "T": kinds.of(generic)}
        super().__init__(types, s=end, true=true, false=false)
        self._kinds = kinds

    def __missing__(self, name: str) -> str:
        if name.startswith("whole"):
            return self._kinds.constant("i64", name.removeprefix("whole"))
        return self._kinds.constant("f64", name)


class Body:
    """The instructions of a function, and what the names of a Program are in it."""

    def __init__(self, types: Mapping[str, str], names: Mapping[str, str], lanes: int = 1) -> None:
        self.rows: list[str] = []
        self.types, self.names = {**types}, {**names}
        self.kinds = Kinds(lanes)
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

    def taken(self) -> list[str]:
        """The instructions since the last call, which are taken out, for a text of some other function."""
        rows, self.rows = self.rows, []
        return [row.removeprefix("  ") for row in rows]

    def lines(self, lines: Iterable[Line]) -> None:
        """The operations of lines."""
        for line in lines:
            arguments = [self.value(argument) for argument in line.args]
            template = OPERATIONS[line.op].llvm
            if self.kinds.lanes > 1 and "@" in template and "{f}" not in template:
                value = self._each(template, line, arguments)
            else:
                value = self._instructions(template, _Names(self.kinds, line.type), arguments)
            self.names[line.name], self.types[line.name] = value, line.type

    def _instructions(self, template: str, names: dict[str, str], arguments: Sequence[str]) -> str:
        """The value of an operation's instructions."""
        value = ""
        for row in template.strip().split("\n"):
            name, _, text = row.rpartition(" = ")
            text = FORMATTER.vformat(text, arguments, names)
            value = self.emit(text) if " " in text and not text.startswith("splat") else text
            names[name] = value
        return value

    def _each(self, template: str, line: Line, arguments: Sequence[str]) -> str:
        """An operation of single doubles, for each element of vectors."""
        kind, value = self.kinds.of(line.type), "poison"
        for lane in range(self.kinds.lanes):
            own = [
                text if isinstance(argument, TableName) else self._element_of(argument, text, lane)
                for argument, text in zip(line.args, arguments, strict=True)
            ]
            one = self.emit(FORMATTER.vformat(template, own, {}))
            value = self.emit(f"insertelement {kind} {value}, {TYPES[line.type]} {one}, i64 {lane}")
        return value

    def _element_of(self, argument: Argument, text: str, lane: int) -> str:
        return self.emit(f"extractelement {self.kinds.of(type_of(argument, self.types))} {text}, i64 {lane}")

    def value(self, argument: Argument) -> str:
        """The text of an argument."""
        if isinstance(argument, str):
            return self.names[argument]
        if isinstance(argument, bool):
            return self.kinds.constant("bool", "true" if argument else "false")
        if isinstance(argument, float):
            return self.kinds.constant("f64", bits_of(argument))
        if isinstance(argument, TableName):
            return f"%{argument.name}"
        return self.kinds.constant("i64", str(argument))

    def element(self, kind: str, pointer: str, index: str) -> str:
        """The address of an element of an array."""
        return self.emit(f"getelementptr inbounds {kind}, ptr {pointer}, i64 {index}")

    def load(self, kind: str, pointer: str, index: str) -> str:
        """An element of an array."""
        return self.emit(f"load {kind}, ptr {self.element(kind, pointer, index)}")

    def load_points(self, pointer: str, index: str) -> str:
        """Doubles of an array."""
        at = self.element("double", pointer, index)
        return self.emit(f"load {self.kinds.of('f64')}, ptr {at}, align 8")

    def store_points(self, argument: Argument, pointer: str, index: str) -> None:
        """Store values of a Program in an array."""
        type_, value = type_of(argument, self.types), self.value(argument)
        single = STORED[type_]
        kind = self.kinds.of("f64" if type_ == "f64" else "i8")
        if type_ != "f64":
            change = "zext" if type_ == "bool" else "trunc"
            value = self.emit(f"{change} {self.kinds.of(type_)} {value} to {kind}")
        at = self.element(single, pointer, index)
        self.do(f"store {kind} {value}, ptr {at}, align {BYTES[single]}")

    def spread(self, name: str, value: str) -> None:
        """A name whose value is the same in all elements of vectors."""
        type_ = self.types.get(name, "f64")
        kind, lanes = self.kinds.of(type_), self.kinds.lanes
        first = self.emit(f"insertelement {kind} poison, {TYPES[type_]} {value}, i64 0")
        whole = f"shufflevector {kind} {first}, {kind} poison, <{lanes} x i32> zeroinitializer"
        self.names[name] = self.emit(whole)


def bits_of(value: float) -> str:
    """A double in LLVM's text."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


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

    def padded(self, types: Mapping[str, str], kinds: Sequence[str], lanes: int) -> str:
        """The function `<name>_rows`: this loop over any number of points, where a few are copied.

        kinds   of the outputs' elements
        """
        body = Body(types, {name: f"%{name}.value" for name in self.values})
        room = {name: f"%{name}.room" for name in self.reads}
        rooms = [f"%room.{k}" for k in range(len(kinds))]
        body.rows += [f"  {buffer} = alloca [{lanes} x double], align 64" for buffer in room.values()]
        for buffer, kind in zip(rooms, kinds, strict=True):
            body.do(f"{buffer} = alloca [{lanes} x {kind}], align 64")
        outputs = [f"%to.{k}" for k in range(len(kinds))]
        body.do(f"%few = icmp ult i64 %n, {lanes}")
        body.do("br i1 %few, label %copies, label %direct")
        body.label("direct")
        count = self.call(body, "%n", {name: f"%{name}.from" for name in self.reads}, outputs)
        body.do(f"ret i64 {count}")
        body.label("copies")
        for name, buffer in room.items():
            body.do(f"call void @fill(ptr {buffer}, ptr %{name}.from, i64 %n, i64 {lanes})")
        count = self.call(body, str(lanes), room, rooms)
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

    def text(self, types: Mapping[str, str], lanes: int) -> str:
        """The function."""
        body = Body({**dict.fromkeys((*self.values, *self.reads), "f64"), **types}, {}, lanes)
        for name in self.values:
            body.spread(name, f"%{name}.value")
        spread = body.taken()
        for name in self.reads:
            body.names[name] = body.load_points(f"%{name}.from", "%i")
        body.lines(self.lines)
        for k, argument in enumerate(self.stores):
            body.store_points(argument, f"%to.{k}", "%i")
        total = "%count"
        if self.counted:
            mask = body.emit(f"bitcast {body.kinds.of('bool')} {body.value(self.counted)} to i{lanes}")
            own = body.emit(
                f"zext i{lanes} {body.emit(f'call i{lanes} @llvm.ctpop.i{lanes}(i{lanes} {mask})')} to i64"
            )
            total = body.emit(f"add i64 %count, {own}")
        parameters = ", ".join(["i64 %n", *self.parameters(types)])
        words = {"NAME": self.name, "WIDE": WIDE, "LANES": str(lanes), "TOTAL": total}
        return filled(LOOP, PARAMETERS=parameters, SPREAD=spread, POINTS=body.taken(), **words)


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
