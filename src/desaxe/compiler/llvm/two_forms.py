"""The innermost loop of a kernel in two forms: the plain one for most points, the stable one for the rest.

A test of an outer loop picks the form of a row. A test that changes from point to point is answered with the
plain form for a block of points; those that fail it are gathered, answered by the stable form and put back.
Where all points of a block fail, the next block is tested first. The value of a point depends on it alone.
"""

from collections.abc import Sequence

from ...support.template import file_text, filled
from ..kernel import Kernel
from ..program import Line
from .ir import STORED, WIDE, Body, Loop, loop_of

BIGGEST = 512  # points of a block: their inputs and outputs stay in the first-level cache
STACK = 32_768  # doubles that all buffers of a block may take
APART = 72  # doubles between buffers: at a multiple of 4096 bytes a store holds up loads from other buffers
FLAG = "fails_test"
BLOCKS = file_text(__package__, "blocks.ll")


def either_loop(kernel: Kernel, plain: Loop, stable: Loop, lanes: int) -> tuple[Loop, list[str]]:
    """The loop that runs one of two, and the texts of all three."""
    assert kernel.close is not None
    points = _joined("points", (plain, stable), len(kernel.outputs), [kernel.close.test])
    body = _scope(points, kernel)
    body.do(f"br i1 %{kernel.close.test}.value, label %wide, label %close")
    outputs = [f"%to.{k}" for k in range(len(kernel.outputs))]
    for label, loop in (("wide", plain), ("close", stable)):
        body.label(label)
        body.do(f"ret i64 {loop.call(body, '%n', _inputs(points), outputs)}")
    texts = [loop.text(kernel.types, lanes) for loop in (plain, stable)]
    return points, [*texts, _function(points, kernel, body.rows)]


def block_loop(kernel: Kernel, arrays: Sequence[str], stable: Loop, lanes: int) -> tuple[Loop, list[str]]:
    """The loop over blocks of points, and the texts of all that it calls."""
    close = kernel.close
    assert close is not None
    flag = Line(FLAG, "not", (close.test,), "bool")
    plain = loop_of("plain", (*kernel.levels[-1], flag), (*kernel.outputs, FLAG), arrays, FLAG)
    tests = loop_of("tests", (*close.test_lines, flag), (FLAG,), arrays, FLAG)
    loops = plain, tests, stable
    points = _joined("points", loops, len(kernel.outputs))
    kinds = [STORED[kernel.types.get(name, "f64")] for name in kernel.outputs]
    rows = _blocks(points, kernel, plain, tests, stable, kinds, lanes)
    return points, [*(loop.text(kernel.types, lanes) for loop in loops), _function(points, kernel, rows)]


def _joined(name: str, loops: Sequence[Loop], outputs: int, more: Sequence[str] = ()) -> Loop:
    """A loop that takes all that these take."""
    reads, values, tables = (
        tuple(dict.fromkeys(one for loop in loops for one in getattr(loop, field)))
        for field in ("reads", "values", "tables")
    )
    return Loop(name, reads, tuple(dict.fromkeys((*values, *more))), tables, (), ("",) * outputs)


def _inputs(points: Loop) -> dict[str, str]:
    return {name: f"%{name}.from" for name in points.reads}


def _scope(points: Loop, kernel: Kernel) -> Body:
    return Body(kernel.types, {name: f"%{name}.value" for name in points.values})


def _function(points: Loop, kernel: Kernel, rows: Sequence[str]) -> str:
    parameters = ", ".join(["i64 %n", *points.parameters(kernel.types)])
    head = f"define internal i64 @{points.name}({parameters}) noinline {WIDE} {{"
    return "\n".join([head, *rows, "}"])


def _blocks(
    points: Loop, kernel: Kernel, plain: Loop, tests: Loop, stable: Loop, kinds: Sequence[str], lanes: int
) -> list[str]:
    """The instructions of the loop over blocks."""
    body = _scope(points, kernel)
    rooms = {name: f"%{name}.room" for name in stable.reads}
    answers = [f"%room.{k}" for k in range(len(kinds))]
    block = max(16, min(BIGGEST, (STACK // (len(rooms) + len(answers) + 2) - APART) // 16 * 16))
    buffers = {"%flags": "i8", "%indices": "i64", **dict.fromkeys(rooms.values(), "double")}
    buffers |= dict(zip(answers, kinds, strict=True))
    rows = [f"{buffer} = alloca [{block + APART} x {kind}], align 64" for buffer, kind in buffers.items()]
    there = {name: body.element("double", f"%{name}.from", "%start") for name in points.reads}
    outputs = [body.element(kind, f"%to.{k}", "%start") for k, kind in enumerate(kinds)]
    parts = {"BUFFERS": rows, "ADDRESSES": body.taken()}
    words = {"LANES": str(lanes), "ODD": str(lanes - 1), "BLOCK": str(block)}
    words["FAILED"], parts["TESTS"] = tests.call(body, "%size", there, ["%flags"]), body.taken()
    words["COUNT"], parts["PLAIN"] = plain.call(body, "%size", there, [*outputs, "%flags"]), body.taken()
    words["IN_CLOSE"], parts["STABLE"] = stable.call(body, "%size", there, outputs), body.taken()
    for name, room in rooms.items():
        body.do(f"call void @compress(ptr {room}, ptr {there[name]}, ptr %indices, i64 %filled)")
    words["IN_MIXED"] = stable.call(body, "%filled", rooms, answers)
    for output, answer, kind in zip(outputs, answers, kinds, strict=True):
        body.do(f"call void @expand_{kind}(ptr {output}, ptr {answer}, ptr %indices, i64 %filled)")
    return filled(BLOCKS, GATHERED=body.taken(), **parts, **words).splitlines()
