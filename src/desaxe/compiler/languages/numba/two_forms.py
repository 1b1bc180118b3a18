"""The innermost loop of a kernel in two forms: the plain one for all points, the stable one for the rest.

Where the test belongs to an outer loop, it picks the loop. Where it changes from point to point, a block of
points runs through the plain loop, which flags those that fail the test; they are gathered, run
through the stable loop, and put back. So both loops are free of branches, and vectorise, and a few points
next to singular ones cost little: flags are looked at eight at a time. Where most points of a block fail,
all are copied, which is cheaper than to gather them; after a block in which all failed, the next is tested
before the plain loop, which it may do without. None of that changes a value.
"""

from collections.abc import Mapping

from ...kernel import Kernel, StableBranch, level_program, stable_branch_programs
from ...program import names_in
from ...text import INDENT, write_lines

# Rooms on the stack: the compiler knows that nothing else points there, and nothing has to be allocated.
ROOMS = """@intrinsic
def room(typingctx):
    \"\"\"Room for the numbers of one block, on the stack.\"\"\"

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.float64)
        place = builder.alloca(kind, size=context.get_constant(types.int64, SIZE))
        place.align = 64
        return place

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


@intrinsic
def flags(typingctx):
    \"\"\"Room for a byte for each point of a block.\"\"\"

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.uint8)
        place = builder.alloca(kind, size=context.get_constant(types.int64, BLOCK))
        place.align = 8
        return place

    return types.CPointer(types.uint8)(), code


@intrinsic
def put_flag(typingctx, flags, place, flag):
    \"\"\"Flag a point of a block, or not.\"\"\"

    def code(context, builder, signature, args):
        flags, place, flag = args
        byte = context.cast(builder, flag, types.boolean, types.uint8)
        builder.store(byte, builder.gep(flags, [place]))
        return context.get_dummy_value()

    return types.none(flags, types.uint64, types.boolean), code


@intrinsic
def eight_flags(typingctx, flags, word):
    \"\"\"The flags of eight points in a row.\"\"\"

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.uint64).as_pointer()
        return builder.load(builder.gep(builder.bitcast(args[0], kind), [args[1]]))

    return types.uint64(flags, types.uint64), code


@intrinsic
def is_flagged(typingctx, flags, place):
    \"\"\"The flag of a point of a block.\"\"\"

    def code(context, builder, signature, args):
        byte = builder.load(builder.gep(args[0], [args[1]]))
        return context.cast(builder, byte, types.uint8, types.boolean)

    return types.boolean(flags, types.uint64), code


@intrinsic
def count_flags(typingctx, eight):
    \"\"\"How many of eight flags are set.\"\"\"

    def code(context, builder, signature, args):
        return builder.ctpop(args[0])

    return types.uint64(types.uint64), code


@intrinsic
def first_flag(typingctx, eight):
    \"\"\"Which of eight flags is the first that is set.\"\"\"

    def code(context, builder, signature, args):
        zeros = builder.cttz(args[0], context.get_constant(types.boolean, True))
        return builder.lshr(zeros, context.get_constant(types.uint64, 3))

    return types.uint64(types.uint64), code


@intrinsic
def clear_flags(typingctx, flags, word):
    \"\"\"Clear the flags of eight points in a row.\"\"\"

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.uint64)
        place = builder.gep(builder.bitcast(args[0], kind.as_pointer()), [args[1]])
        builder.store(kind(0), place)
        return context.get_dummy_value()

    return types.none(flags, types.uint64), code
"""
BIGGEST = 512  # points of a block: their inputs and outputs stay in the first-level cache
STACK = 32_768  # numbers that all rooms together may take
APART = 72  # numbers between rooms: at a multiple of 4096 bytes a store holds up loads from other rooms


def block_of(kernel: Kernel) -> int:
    """The number of points of a block, such that its buffers fit on the stack."""
    rooms = 1 + len(_kept(kernel)) + len(kernel.outputs)
    return max(16, min(BIGGEST, (STACK // rooms - APART) // 16 * 16))


def rooms(kernel: Kernel) -> str:
    """The source of the buffer functions that a kernel in two forms calls."""
    block = block_of(kernel)
    return ROOMS.replace("SIZE", str(block + APART)).replace("BLOCK", str(block))


def has_two_forms(kernel: Kernel) -> bool:
    """True if the test varies along the innermost axis."""
    return kernel.close is not None and bool(kernel.close.test_lines)


def scratch(kernel: Kernel) -> list[str]:
    """Allocate the buffers of points that fail the test: indices, inputs, outputs."""
    if not has_two_forms(kernel):
        return []
    names = [*_kept(kernel), *(f"out_{name}" for name in kernel.outputs)]
    return ["close = flags()", "place = room()", *(f"{name}_kept = room()" for name in names)]


def _kept(kernel: Kernel) -> list[str]:
    """The inputs and tables that change along the innermost axis."""
    last = kernel.axes - 1
    tables = (name for table in kernel.tables if table.along[-1] == last for name in table.kernel.outputs)
    return [*(name for name, axis in kernel.inputs.items() if axis == last), *tables]


def inner_loops(kernel: Kernel, length: str, loads: Mapping[str, str]) -> list[str]:
    """The text of the innermost loop over `length` points; `loads` has what each of them reads."""
    if kernel.close is None:
        raise ValueError("this kernel has one form")
    read = [f"{name} = {text}" for name, text in loads.items()]
    undecided = kernel.close.undecided
    plain = [
        *read,
        *write_lines(level_program(kernel, kernel.axes), "numba"),
        *_stores(kernel, kernel.outputs),
    ]
    if has_two_forms(kernel):
        return _mixed(kernel, kernel.close, length, loads, plain)
    lines = write_lines(stable_branch_programs(kernel)[1], "numba")
    tally = [f"tally += 1 if {undecided} else 0"] if undecided else []
    stable = [*read, *lines, *tally, *_stores(kernel, kernel.close.outputs)]
    loop = f"for i{kernel.axes - 1} in range({length}):"
    return [
        f"if {kernel.close.test}:",
        *_under(loop, plain, 1),
        "else:",
        *(INDENT + row for row in _tallied(_under(loop, stable, 0), tally)),
    ]


def _tallied(loop: list[str], tally: list[str]) -> list[str]:
    """A loop with a local counter of undecided points.

    Where it adds to one from outside, numba counts references to arrays, and calls its runtime for it.
    """
    return ["tally = 0", *loop, "undecided += tally"] if tally else loop


def _stores(kernel: Kernel, values: tuple[str, ...]) -> list[str]:
    index = ", ".join(f"i{axis}" for axis in range(kernel.axes))
    return [f"out_{name}[{index}] = {value}" for name, value in zip(kernel.outputs, values, strict=True)]


def _mixed(
    kernel: Kernel,
    close: StableBranch,
    length: str,
    loads: Mapping[str, str],
    plain: list[str],
) -> list[str]:
    """Blocks: all points in the plain form, then those that fail the test in the stable one."""
    here, block = f"i{kernel.axes - 1}", block_of(kernel)
    test, stable = (write_lines(program, "numba") for program in stable_branch_programs(kernel))
    tested = {name for line in close.test_lines for name in names_in(line.args)}
    ahead = [f"{name} = {text}" for name, text in loads.items() if name in tested]
    flag = f"put_flag(close, {here} - start, not {close.test})"
    points = f"for {here} in range(start, stop):"
    gathered, back = _gathered(kernel, loads), _put_back(kernel)
    return [
        f"length = {length}",
        "every = False",
        f"for start in range(uint64(0), length, uint64({block})):",
        f"{INDENT}stop = min(start + uint64({block}), length)",
        f"{INDENT}size = stop - start",
        f"{INDENT}words = (size + uint64(7)) >> uint64(3)",
        f"{INDENT}clear_flags(close, words - uint64(1))",
        f"{INDENT}count = uint64(0)",
        f"{INDENT}if every:",
        *_under(points, [*ahead, *test, flag], 2),
        *_under("for word in range(words):", [_COUNT], 2),
        f"{INDENT}if count < size:",
        *_under(points, [*plain, flag], 2),
        f"{INDENT * 2}count = uint64(0)",
        *_under("for word in range(words):", [_COUNT], 2),
        f"{INDENT}every = count == size",
        f"{INDENT}if count:",
        f"{INDENT * 2}most = size == uint64({block}) and count >= uint64({block - block // 4})",
        *_under("if most:", gathered[0], 2),
        *_under("else:", gathered[1], 2),
        *(INDENT * 2 + row for row in _stable_loop(kernel, close, stable)),
        *_under("if most:", back[0], 2),
        *_under("else:", back[1], 2),
    ]


def _gathered(kernel: Kernel, loads: Mapping[str, str]) -> tuple[list[str], list[str]]:
    """Keep all points of a block, or those that are flagged.

    The stable loop takes eight points at a time; what the last eight lack is filled with the last point,
    which may be counted more than once as undecided.
    """
    here = f"i{kernel.axes - 1}"
    kept = [f"{name} = {text}" for name, text in loads.items()]
    kept += [f"put({name}_kept, k, {name})" for name in _kept(kernel)]
    every = ["count = size", *_under("for k in range(size):", [f"{here} = start + k", *kept], 0)]
    index = f"{here} = uint64(get(place, min(k, count - uint64(1))))"
    some = _under("for k in range((count + uint64(7)) & ~uint64(7)):", [index, *kept], 0)
    return every, [*_PLACES, *some]


def _stable_loop(kernel: Kernel, close: StableBranch, stable: list[str]) -> list[str]:
    """The stable form of the points that are kept."""
    body = [f"{name} = get({name}_kept, k)" for name in _kept(kernel)] + stable
    pairs = zip(kernel.outputs, close.outputs, strict=True)
    body += [f"put(out_{name}_kept, k, {value})" for name, value in pairs]
    tally = [f"tally += 1 if {close.undecided} else 0"] if close.undecided else []
    eight = _under("for k in range(first, first + uint64(8)):", [*body, *tally], 0)
    return _tallied(_under("for first in range(uint64(0), count, uint64(8)):", eight, 0), tally)


def _put_back(kernel: Kernel) -> tuple[list[str], list[str]]:
    """Put the stable values back where all points of a block are kept, and where some are."""
    index = "".join(f"i{axis}, " for axis in range(kernel.axes - 1))
    chosen = ["flag = is_flagged(close, k)"]
    some = []
    for name in kernel.outputs:
        out, value = f"out_{name}[{index}{{}}]", f"get(out_{name}_kept, k)"
        place = out.format("start + k")
        chosen += [f"before, after = {place}, {value}", f"{place} = after if flag else before"]
        some.append(f"{out.format('uint64(get(place, k))')} = {value}")
    return _under("for k in range(size):", chosen, 0), _under("for k in range(count):", some, 0)


_COUNT = "count += count_flags(eight_flags(close, word))"
# Where the flagged points of a block are: places and their count. A flag is the lowest bit of its byte.
_PLACES = """count = uint64(0)
for word in range(words):
    eight = eight_flags(close, word)
    at = start + (word << uint64(3))
    while eight:
        put(place, count, at + first_flag(eight))
        count += uint64(1)
        eight &= eight - uint64(1)""".splitlines()


def _under(head: str, body: list[str], depth: int) -> list[str]:
    return [INDENT * depth + head, *(INDENT * (depth + 1) + row for row in body)]
