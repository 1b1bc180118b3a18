"""The innermost loop of a kernel in two forms: the plain one for all points, the stable one for the rest.

Where the test belongs to an outer loop, it picks the loop. Where it changes from point to point, a block of
points runs through the plain loop, which counts those that fail the test; they are gathered, run
through the stable loop, and put back. So both loops are free of branches, and vectorise, and a few points
next to singular ones cost little.
"""

from collections.abc import Mapping

from .kernel import Close, Kernel, close_programs, level_program
from .text import INDENT, write_lines

# Rooms on the stack: the compiler knows that nothing else points there, and nothing has to be allocated.
ROOMS = """@intrinsic
def room(typingctx):
    \"\"\"Room for the numbers of one block, on the stack.\"\"\"

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.float64)
        return builder.alloca(kind, size=context.get_constant(types.int64, SIZE))

    return types.CPointer(types.float64)(), code


@intrinsic
def put(typingctx, room, place, value):
    \"\"\"Keep a value at a place of a room.\"\"\"

    def code(context, builder, signature, args):
        room, place, value = args
        builder.store(value, builder.gep(room, [place]))
        return context.get_dummy_value()

    return types.none(room, types.uint64, types.float64), code


@intrinsic
def get(typingctx, room, place):
    \"\"\"The value at a place of a room.\"\"\"

    def code(context, builder, signature, args):
        return builder.load(builder.gep(args[0], [args[1]]))

    return types.float64(room, types.uint64), code
"""
BIGGEST = 512  # points of a block: their inputs and outputs stay in the first-level cache
STACK = 32_768  # numbers that all rooms together may take
APART = 72  # numbers between rooms: at a multiple of 4096 bytes a store holds up loads from other rooms


def block_of(kernel: Kernel) -> int:
    """Points of a block, so many that the rooms fit on the stack."""
    rooms = 1 + len(_kept(kernel)) + len(kernel.outputs)
    return max(16, min(BIGGEST, (STACK // rooms - APART) // 16 * 16))


def rooms(kernel: Kernel) -> str:
    """The source of what a mixed kernel calls besides operations."""
    return ROOMS.replace("SIZE", str(block_of(kernel) + APART))


def is_mixed(kernel: Kernel) -> bool:
    """Whether the test changes along the innermost axis."""
    return kernel.close is not None and bool(kernel.close.test_lines)


def scratch(kernel: Kernel) -> list[str]:
    """Where the points of a block that fail the test are kept: places, inputs, outputs."""
    if not is_mixed(kernel):
        return []
    names = [*_kept(kernel), *(f"out_{name}" for name in kernel.outputs)]
    return ["place = room()", *(f"{name}_kept = room()" for name in names)]


def _kept(kernel: Kernel) -> list[str]:
    """The inputs and tables that change along the innermost axis."""
    last = kernel.axes - 1
    tables = (name for table in kernel.tables if table.along[-1] == last for name in table.kernel.outputs)
    return [*(name for name, axis in kernel.inputs.items() if axis == last), *tables]


def inner_loops(kernel: Kernel, length: str, loads: Mapping[str, str], cast: str) -> list[str]:
    """The text of the innermost loop over `length` points; `loads` has what each of them reads.

    `cast` is applied to what is read back from the points kept; "" for none.
    """
    if kernel.close is None:
        raise ValueError("this kernel has one form")
    read = [f"{name} = {text}" for name, text in loads.items()]
    tally = [f"tally += 1 if {kernel.close.undecided} else 0"] if kernel.close.undecided else []
    plain = [
        *read,
        *write_lines(level_program(kernel, kernel.axes), "numba"),
        *_stores(kernel, kernel.outputs),
    ]
    if is_mixed(kernel):
        return _mixed(kernel, kernel.close, length, loads, plain, tally, cast)
    lines = write_lines(close_programs(kernel)[1], "numba")
    stable = [*read, *lines, *tally, *_stores(kernel, kernel.close.outputs)]
    loop = f"for i{kernel.axes - 1} in range({length}):"
    return [
        f"if {kernel.close.test}:",
        *_under(loop, plain, 1),
        "else:",
        *(INDENT + row for row in _tallied(_under(loop, stable, 0), tally)),
    ]


def _tallied(loop: list[str], tally: list[str]) -> list[str]:
    """A loop that counts undecided points, in a number of its own.

    Where it adds to one from outside, numba counts references to arrays, and calls its runtime for it.
    """
    return ["tally = 0", *loop, "undecided += tally"] if tally else loop


def _stores(kernel: Kernel, values: tuple[str, ...]) -> list[str]:
    index = ", ".join(f"i{axis}" for axis in range(kernel.axes))
    return [f"out_{name}[{index}] = {value}" for name, value in zip(kernel.outputs, values, strict=True)]


def _mixed(
    kernel: Kernel,
    close: Close,
    length: str,
    loads: Mapping[str, str],
    plain: list[str],
    tally: list[str],
    cast: str,
) -> list[str]:
    """Blocks: all points in the plain form, then those that fail the test in the stable one."""
    last, names = kernel.axes - 1, _kept(kernel)
    test, stable = (write_lines(program, "numba") for program in close_programs(kernel))
    found = [f"put({name}_kept, count, {name})" for name in names]
    found += [f"put(place, count, i{last})", "count += uint64(1)"]
    index = ", ".join([*(f"i{axis}" for axis in range(last)), "uint64(get(place, k))"])
    block = f"for i{last} in range(start, stop):"
    kept = f"{cast}(get({{}}_kept, k))" if cast else "get({}_kept, k)"
    again = [f"{name} = {kept.format(name)}" for name in names] + stable + tally
    pairs = list(zip(kernel.outputs, close.outputs, strict=True))
    again += [f"put(out_{name}_kept, k, {value})" for name, value in pairs]
    back = [f"out_{name}[{index}] = get(out_{name}_kept, k)" for name, _ in pairs]
    return [
        f"length = {length}",
        f"for start in range(uint64(0), length, uint64({block_of(kernel)})):",
        f"{INDENT}stop = min(start + uint64({block_of(kernel)}), length)",
        f"{INDENT}close = 0",
        *_under(block, [*plain, f"close += 0 if {close.test} else 1"], 1),
        f"{INDENT}if close:",
        f"{INDENT * 2}count = uint64(0)",
        *_under(block, [*(f"{name} = {text}" for name, text in loads.items()), *test], 2),
        *(INDENT * 3 + row for row in _under(f"if not {close.test}:", found, 0)),
        *(INDENT * 2 + row for row in _tallied(_under("for k in range(count):", again, 0), tally)),
        *_under("for k in range(count):", back, 2),
    ]


def _under(head: str, body: list[str], depth: int) -> list[str]:
    return [INDENT * depth + head, *(INDENT * (depth + 1) + row for row in body)]
