"""A Kernel as a module of LLVM's text, whose entry is the inner loop of a NumPy ufunc.

`i64 kernel(char **args, i64 *lengths, i64 *steps, i64 *data)`

args      the arrays of the inputs that vary, of the outputs, of the axis tables, then knots and coefficients
          of the tables that are looked up
lengths   of the axes, then the numbers of knots
steps     in bytes, of inputs and outputs: any over one axis; over more the arrays are contiguous
data      the words of HEAD, then the scalars

It returns the number of points left to the caller: undecided ones, and angles beyond a limit.
"""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ..kernel import Kernel
from ..program import Line
from .ir import BYTES, STORED, WIDE, Body, Loop, loop_of
from .tables import tables_text
from .two_forms import APART, block_loop, either_loop

NAME = "kernel"
CALLED = re.compile(r"@([\w.]+)")
FUNCTIONS = Path(__file__).with_name("functions.ll").read_text()
ANGLE = "angle"
HEAD = 2  # words: the address that repairs points, and that of `feclearexcept`; or 0
BLOCK = 512  # points that are copied at a time


class Entry(NamedTuple):
    """A kernel, its inputs that are arrays in the order of `args`, and the angle that has a limit."""

    kernel: Kernel
    arguments: tuple[str, ...]
    angle: str | None = None
    limit: float = 0.0

    @property
    def scalars(self) -> tuple[str, ...]:
        """The inputs that are numbers, in the order of `data`."""
        return tuple(name for name, axis in self.kernel.inputs.items() if axis is None)


def module_text(entry: Entry, lanes: int) -> str:
    """The text of a kernel."""
    kernel = entry.kernel
    points, texts = _innermost(kernel, lanes)
    tables = [_table_loop(k, table.kernel) for k, table in enumerate(kernel.tables)]
    texts += [loop.text(table.kernel.types, lanes) for loop, table in zip(tables, kernel.tables, strict=True)]
    kernels = [kernel, *(table.kernel for table in kernel.tables)]
    for loop, own in zip([points, *tables], kernels, strict=True):
        texts.append(
            loop.padded(own.types, [STORED[own.types.get(name, "f64")] for name in own.outputs], lanes)
        )
    if entry.angle is not None:
        texts += [_beyond(entry).text({}, lanes), _beyond(entry).padded({}, (), lanes)]
    points, *tables = (loop._replace(name=f"{loop.name}_rows") for loop in (points, *tables))
    body = Body(kernel.types, {})
    frame = _Frame(body, entry)
    if kernel.axes == 1:
        _one_axis(frame, points)
    else:
        _nests(frame, points, tables)
    functions = FUNCTIONS + tables_text(lanes) if kernel.given else FUNCTIONS
    return "\n\n".join([*_called(functions, [*texts, frame.text()]), *texts, frame.text()])


def _called(known: str, texts: Sequence[str]) -> list[str]:
    """The declarations, and the functions that texts call: LLVM would emit the others, too."""
    head, *functions = re.split(r"^(?=define )", known, flags=re.MULTILINE)
    by_name = {re.findall(CALLED, function)[0]: function for function in functions}
    called: set[str] = set()
    new = set(re.findall(CALLED, "".join(texts))) & by_name.keys()
    while new:
        called |= new
        new = {name for each in new for name in re.findall(CALLED, by_name[each])} & by_name.keys() - called
    return [head, *(function for name, function in by_name.items() if name in called)]


def _innermost(kernel: Kernel, lanes: int) -> tuple[Loop, list[str]]:
    """The loop over the last axis, and the texts of all that it needs."""
    last, close = kernel.axes - 1, kernel.close
    arrays = [name for name, axis in kernel.inputs.items() if axis == last]
    arrays += [name for table in kernel.tables if table.along[-1] == last for name in table.kernel.outputs]
    lines = kernel.levels[-1]
    if close is None:
        loop = loop_of("points", lines, kernel.outputs, arrays)
        return loop, [loop.text(kernel.types, lanes)]
    stable = loop_of("stable", close.lines, close.outputs, arrays, close.undecided)
    if not close.test_lines:
        return either_loop(kernel, loop_of("plain", lines, kernel.outputs, arrays), stable, lanes)
    return block_loop(kernel, arrays, stable, lanes)


def _beyond(entry: Entry) -> Loop:
    """The loop that counts finite angles beyond the limit."""
    lines = [
        Line("size", "abs", (ANGLE,)),
        Line("large", "lt", (entry.limit, "size"), "bool"),
        Line("finite", "lt", ("size", math.inf), "bool"),
        Line("beyond", "and", ("large", "finite"), "bool"),
    ]
    return loop_of("beyond", lines, (), (ANGLE,), "beyond")


def _table_loop(number: int, kernel: Kernel) -> Loop:
    arrays = [name for name, axis in kernel.inputs.items() if axis == kernel.axes - 1]
    return loop_of(f"axis_table_{number}", kernel.levels[-1], kernel.outputs, arrays)


class _Frame:
    """The entry: its arguments as values, and what is left over."""

    def __init__(self, body: Body, entry: Entry) -> None:
        self.body, self.entry, kernel = body, entry, entry.kernel
        self.allocas = ["%left = alloca i64", "store i64 0, ptr %left"]
        self.lengths = [body.load("i64", "%lengths", str(axis)) for axis in range(kernel.axes)]
        made = [name for table in kernel.tables for name in table.kernel.outputs]
        kinds = [STORED[kernel.types.get(name, "f64")] for name in kernel.outputs]
        self.kinds = ["double"] * len(entry.arguments) + kinds
        count = len(self.kinds)
        self.pointers = [body.load("ptr", "%args", str(k)) for k in range(count + len(made))]
        self.arrays = dict(zip(entry.arguments, self.pointers, strict=False))
        self.made = dict(zip(made, self.pointers[count:], strict=True))
        self.outputs = self.pointers[len(entry.arguments) : count]
        for k, name in enumerate(entry.scalars):
            body.names[name] = body.load("double", "%data", str(HEAD + k))
        for k, table in enumerate(kernel.given):
            first = count + len(made) + 2 * k
            body.do(f"%{table}.x = load ptr, ptr {body.element('ptr', '%args', str(first))}")
            body.do(f"%{table}.c = load ptr, ptr {body.element('ptr', '%args', str(first + 1))}")
            body.do(f"%{table}.n = load i64, ptr {body.element('i64', '%lengths', str(kernel.axes + k))}")

    def variable(self, name: str) -> str:
        """A number in memory."""
        self.allocas.append(f"{name} = alloca i64")
        return name

    def leave(self, count: str) -> None:
        """Count points that are left over."""
        before = self.body.emit("load i64, ptr %left")
        self.body.do(f"store i64 {self.body.emit(f'add i64 {before}, {count}')}, ptr %left")

    def leave_large_angles(self, angles: str, n: str) -> None:
        """Count angles beyond the limit."""
        loop = _beyond(self.entry)._replace(name="beyond_rows")
        self.leave(loop.call(self.body, n, {ANGLE: angles}, ()))

    def text(self) -> str:
        """The function: at its end a repair is called, and the processor's flags are cleared."""
        body = self.body
        left = body.emit("load i64, ptr %left")
        repair, clear = (body.load("ptr", "%data", str(k)) for k in range(HEAD))
        given = "ptr %args, ptr %lengths, ptr %steps"
        body.do(f"call void @finish(i64 {left}, ptr {repair}, ptr {clear}, {given})")
        body.do(f"ret i64 {left}")
        head = f"define i64 @{NAME}(ptr %args, ptr %lengths, ptr %steps, ptr %data) {WIDE} {{"
        return "\n".join([head, *(f"  {row}" for row in self.allocas), *body.rows, "}"])


def _one_axis(frame: _Frame, points: Loop) -> None:
    """Blocks of one axis: whole where all arrays are contiguous, else copied."""
    body, entry = frame.body, frame.entry
    body.lines(entry.kernel.levels[0])
    (n,) = frame.lengths
    steps = [body.load("i64", "%steps", str(k)) for k in range(len(frame.kinds))]
    buffers = [f"%buffer{k}" for k in range(len(frame.kinds))]
    frame.allocas += [
        f"{buffer} = alloca [{BLOCK + APART} x {kind}], align 64"
        for buffer, kind in zip(buffers, frame.kinds, strict=True)
    ]
    straight = "true"
    for step, kind in zip(steps, frame.kinds, strict=True):
        straight = body.emit(f"and i1 {straight}, {body.emit(f'icmp eq i64 {step}, {BYTES[kind]}')}")
    longest = body.emit(f"select i1 {straight}, i64 {n}, i64 {BLOCK}")
    here = frame.variable("%start")
    body.do(f"store i64 0, ptr {here}")
    body.do("br label %blocks")
    body.label("blocks")
    start = body.emit(f"load i64, ptr {here}")
    body.do(f"br i1 {body.emit(f'icmp slt i64 {start}, {n}')}, label %block, label %end")
    body.label("block")
    rest = body.emit(f"sub i64 {n}, {start}")
    size = body.emit(f"call i64 @llvm.smin.i64(i64 {rest}, i64 {longest})")
    there = []
    for pointer, step in zip(frame.pointers, steps, strict=False):
        there.append(body.element("i8", pointer, body.emit(f"mul i64 {start}, {step}")))
    inputs, outputs = {}, []
    for k, (pointer, step, buffer, kind) in enumerate(zip(there, steps, buffers, frame.kinds, strict=True)):
        if k < len(entry.arguments):
            copy = f"call ptr @gathered(ptr {buffer}, ptr {pointer}, i64 {step}, i64 {size})"
            inputs[entry.arguments[k]] = body.emit(copy)
        else:
            direct = body.emit(f"icmp eq i64 {step}, {BYTES[kind]}")
            outputs.append(body.emit(f"select i1 {direct}, ptr {pointer}, ptr {buffer}"))
    if entry.angle is not None:
        frame.leave_large_angles(inputs[entry.angle], size)
    frame.leave(points.call(body, size, inputs, outputs))
    first = len(entry.arguments)
    targets = zip(there[first:], steps[first:], outputs, frame.kinds[first:], strict=True)
    for target, step, buffer, kind in targets:
        body.do(f"call void @scatter_{kind}(ptr {target}, i64 {step}, ptr {buffer}, i64 {size})")
    body.do(f"store i64 {body.emit(f'add i64 {start}, {size}')}, ptr {here}")
    body.do("br label %blocks")
    body.label("end")


class _Nest(NamedTuple):
    """Loops over some axes: `loop` is the innermost; `arrays` are those it reads, with the axes they have."""

    kernel: Kernel
    along: tuple[int, ...]
    loop: Loop
    outputs: Sequence[str]
    kinds: Sequence[str]
    arrays: Mapping[str, tuple[str, tuple[int, ...]]]


def _nests(frame: _Frame, points: Loop, loops: Sequence[Loop]) -> None:
    """The loops of the axis tables, then those of the kernel."""
    kernel, entry = frame.entry.kernel, frame.entry
    if entry.angle is not None:
        axis = kernel.inputs[entry.angle]
        assert axis is not None
        frame.leave_large_angles(frame.arrays[entry.angle], frame.lengths[axis])
    reads: dict[str, tuple[str, tuple[int, ...]]] = {}
    for table, loop in zip(kernel.tables, loops, strict=True):
        own = {
            name: (frame.arrays[name], (table.along[axis],))
            for name, axis in table.kernel.inputs.items()
            if axis is not None
        }
        outputs = [frame.made[name] for name in table.kernel.outputs]
        _nest(frame, _Nest(table.kernel, table.along, loop, outputs, ["double"] * len(outputs), own))
        reads |= {name: (frame.made[name], table.along) for name in table.kernel.outputs}
    own = {name: (frame.arrays[name], (axis,)) for name, axis in kernel.inputs.items() if axis is not None}
    kinds = frame.kinds[len(entry.arguments) :]
    _nest(frame, _Nest(kernel, tuple(range(kernel.axes)), points, frame.outputs, kinds, own | reads))


def _nest(frame: _Frame, nest: _Nest) -> None:
    body, last = frame.body, nest.along[-1]
    name, index = nest.loop.name, dict[int, str]()

    def row(axes: Sequence[int]) -> str:
        """The index of the first element of a row, or of the element, of an array over these axes."""
        flat = "0"
        for axis in axes:
            flat = body.emit(f"mul i64 {flat}, {frame.lengths[axis]}")
            flat = body.emit(f"add i64 {flat}, {index.get(axis, '0')}")
        return flat

    body.lines(nest.kernel.levels[0])
    for depth, axis in enumerate(nest.along[:-1]):
        here = frame.variable(f"%{name}.{axis}")
        body.do(f"store i64 0, ptr {here}")
        body.do(f"br label %{name}.loop{axis}")
        body.label(f"{name}.loop{axis}")
        index[axis] = body.emit(f"load i64, ptr {here}")
        more = body.emit(f"icmp ult i64 {index[axis]}, {frame.lengths[axis]}")
        body.do(f"br i1 {more}, label %{name}.body{axis}, label %{name}.end{axis}")
        body.label(f"{name}.body{axis}")
        for array, (pointer, axes) in nest.arrays.items():
            if axes[-1] == axis:
                body.names[array] = body.load("double", pointer, row(axes))
        body.lines(nest.kernel.levels[depth + 1])
    inputs = {
        array: body.element("double", pointer, row(axes))
        for array, (pointer, axes) in nest.arrays.items()
        if axes[-1] == last
    }
    start = row(nest.along)
    outputs = [body.element(kind, p, start) for kind, p in zip(nest.kinds, nest.outputs, strict=True)]
    frame.leave(nest.loop.call(body, frame.lengths[last], inputs, outputs))
    for axis in reversed(nest.along[:-1]):
        following = body.emit(f"add i64 {index[axis]}, 1")
        body.do(f"store i64 {following}, ptr %{name}.{axis}")
        body.do(f"br label %{name}.loop{axis}")
        body.label(f"{name}.end{axis}")
