"""The innermost loop of a kernel in two forms: the plain one for all points, the stable one for the rest.

Where the test belongs to an outer loop, it picks the loop. Where it changes from point to point, a block of
points runs through the plain loop, which flags those that fail the test; they are gathered, run
through the stable loops, and put back. So all loops are free of branches, and vectorise, and a few points
next to singular ones cost little: flags are looked at eight at a time. Where most points of a block fail,
the stable loops read all of them where they are, which is cheaper than to gather them; after a block in which
all failed, the next is tested before the plain loop, which it may do without. Where vectors are narrow, the
plain loop is two, as the stable one always is (see `stages`). None of that changes a value.
"""

from collections.abc import Mapping
from typing import NamedTuple

from ...builder import function_text
from ...kernel import Kernel, StableBranch, level_program, stable_branch_programs
from ...program import Program, names_in
from ...stages import Stages, staged
from ...text import INDENT, write_lines

BIGGEST = 512  # points of a block: their inputs and outputs stay in the first-level cache
STACK = 32_768  # numbers that all rooms together may take
LANES = 8  # points that the stable loops take at a time
APART = 72  # numbers between rooms: at a multiple of 4096 bytes a store holds up loads from other rooms


class _Stable(NamedTuple):
    """The stable form as a function of the module: what its loops read, compute and keep."""

    points: tuple[str, ...]  # what changes along the innermost axis
    outer: tuple[str, ...]  # what it has from outer loops
    first: Program | None  # of what the second stage reads from rooms; None if there is one stage
    second: Program

    @property
    def kept(self) -> tuple[str, ...]:
        """The rooms between the stages."""
        return self.first.outputs if self.first else ()


def _stable_of(kernel: Kernel) -> _Stable:
    outputs = [*_branch(kernel).outputs, *filter(None, [_branch(kernel).undecided])]
    program = stable_branch_programs(kernel)[1]._replace(outputs=tuple(dict.fromkeys(outputs)))
    stages = staged(program)
    points = tuple(_inner(kernel))
    own = {line.name for line in program.lines}.union(points)
    used = dict.fromkeys([name for line in program.lines for name in names_in(line.args)] + outputs)
    outer = tuple(name for name in used if name not in own)
    return _Stable(points, outer, stages and stages.first, stages.second if stages else program)


def _branch(kernel: Kernel) -> StableBranch:
    if kernel.close is None:
        raise ValueError("this kernel has one form")
    return kernel.close


def block_of(kernel: Kernel) -> int:
    """The number of points of a block, such that its buffers fit on the stack."""
    rooms = len(_rooms(kernel))
    return max(16, min(BIGGEST, (STACK // rooms - APART) // 16 * 16))


def has_two_forms(kernel: Kernel) -> bool:
    """True if the test varies along the innermost axis."""
    return kernel.close is not None and bool(kernel.close.test_lines)


def scratch(kernel: Kernel) -> list[str]:
    """Allocate the flags of a block, and its rooms."""
    if not has_two_forms(kernel):
        return []
    block = block_of(kernel)
    return [f"close = flags({block})", *(f"{name} = room({block + APART})" for name in _rooms(kernel))]


def _rooms(kernel: Kernel) -> list[str]:
    """The buffers of a block: places, inputs and outputs of points that fail the test; between stages."""
    kept = [f"{name}_kept" for name in (*_inner(kernel), *(f"out_{name}" for name in kernel.outputs))]
    plain = _plain_stages(kernel)
    between = dict.fromkeys((*_stable_of(kernel).kept, *(plain.first.outputs if plain else ())))
    return ["place", *kept, *(f"{name}_room" for name in between)]


def _inner(kernel: Kernel) -> list[str]:
    """The inputs and tables that change along the innermost axis."""
    last = kernel.axes - 1
    tables = (name for table in kernel.tables if table.along[-1] == last for name in table.kernel.outputs)
    return [*(name for name, axis in kernel.inputs.items() if axis == last), *tables]


def stable_function(kernel: Kernel) -> str:
    """The source of the stable form: a function of a number of points, a multiple of LANES.

    It reads and writes rooms, and answers how many points are undecided. As a function it can promise that
    none of them overlap, wherever they are.
    """
    close, stable = _branch(kernel), _stable_of(kernel)
    reads = [f"{name} = get({name}_from, k)" for name in stable.points]
    writes = [
        f"put(out_{name}_to, k, {value})" for name, value in zip(kernel.outputs, close.outputs, strict=True)
    ]
    rows = ["apart()"]
    if stable.first:
        keep = [f"put({name}_room, k, {name})" for name in stable.kept]
        rows += _by_eight([*_used(reads, stable.first), *write_lines(stable.first, "numba"), *keep])
        reads += [f"{name} = get({name}_room, k)" for name in stable.kept]
    tally = [f"tally += 1 if {close.undecided} else 0"] if close.undecided else []
    body = [*_used(reads, stable.second), *write_lines(stable.second, "numba"), *writes, *tally]
    rows += [*(["tally = 0"] if tally else []), *_by_eight(body)]
    rows += ["return tally"] if tally else []
    return function_text("stable", ("count", *_parameters(kernel)), rows)


def _used(reads: list[str], program: Program) -> list[str]:
    """The reads that a program needs."""
    used = {name for line in program.lines for name in names_in(line.args)}.union(program.outputs)
    return [read for read in reads if read.partition(" ")[0] in used]


def _parameters(kernel: Kernel) -> list[str]:
    """The parameters of the stable form after the number of points."""
    stable = _stable_of(kernel)
    rooms = [*(f"{name}_from" for name in stable.points), *(f"out_{name}_to" for name in kernel.outputs)]
    return [*rooms, *(f"{name}_room" for name in stable.kept), *stable.outer]


def _by_eight(body: list[str]) -> list[str]:
    eight = _under(f"for k in range(first, first + uint64({LANES})):", body, 0)
    return _under(f"for first in range(uint64(0), count, uint64({LANES})):", eight, 0)


def inner_loops(kernel: Kernel, length: str, loads: Mapping[str, str]) -> list[str]:
    """The text of the innermost loop over `length` points; `loads` has what each of them reads."""
    close = _branch(kernel)
    read = [f"{name} = {text}" for name, text in loads.items()]
    plain = [
        *read,
        *write_lines(level_program(kernel, kernel.axes), "numba"),
        *_stores(kernel, kernel.outputs),
    ]
    if has_two_forms(kernel):
        return _mixed(kernel, close, length, loads, plain)
    lines = write_lines(stable_branch_programs(kernel)[1], "numba")
    tally = [f"tally += 1 if {close.undecided} else 0"] if close.undecided else []
    stable = [*read, *lines, *tally, *_stores(kernel, close.outputs)]
    loop = f"for i{kernel.axes - 1} in range({length}):"
    return [
        f"if {close.test}:",
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
    test = write_lines(stable_branch_programs(kernel)[0], "numba")
    tested = {name for line in close.test_lines for name in names_in(line.args)}
    ahead = [f"{name} = {text}" for name, text in loads.items() if name in tested]
    flag = f"put_flag(close, {here} - start, not {close.test})"
    points = f"for {here} in range(start, stop):"
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
        f"{INDENT * 2}count = uint64(0)",
        *(INDENT * 2 + row for row in _plain_loops(kernel, points, loads, plain, test, flag)),
        f"{INDENT}every = count == size",
        f"{INDENT}if count:",
        # A part of eight points would be read, and written, past its end.
        f"{INDENT * 2}most = size % uint64({LANES}) == uint64(0) and count >= size - (size >> uint64(2))",
        f"{INDENT * 2}direct = most and every",
        *_under("if not most:", _gathered(kernel, loads), 2),
        *(INDENT * 2 + row for row in _call(kernel, loads)),
        *(INDENT * 2 + row for row in _put_back(kernel)),
    ]


def _plain_loops(
    kernel: Kernel, points: str, loads: Mapping[str, str], plain: list[str], test: list[str], flag: str
) -> list[str]:
    """The plain form, the flags of a block and their count: in stages where vectors are narrow.

    Where they are wide, half as many operations compute a point, and the processor sees enough of them;
    there a sum in the loop would have LLVM take two vectors at a time, which is slower.
    """
    one = [*_under(points, [*plain, flag], 0), *_under("for word in range(words):", [_COUNT], 0)]
    stages = _plain_stages(kernel)
    if stages is None:
        return one
    here = f"i{kernel.axes - 1} - start"
    read = [f"{name} = {text}" for name, text in loads.items()]
    keep = [f"put({name}_room, {here}, {name})" for name in stages.first.outputs]
    first = [*write_lines(stages.first, "numba"), *keep]
    kept = [f"{name} = get({name}_room, {here})" for name in stages.first.outputs]
    second = [*write_lines(stages.second, "numba"), *_stores(kernel, kernel.outputs)]
    tally = f"count += uint64(0) if {_branch(kernel).test} else uint64(1)"
    loops = _under(points, [*read, *test, *first, flag, tally], 0)
    loops += _under(points, [*_used(read, stages.second), *_used(kept, stages.second), *second], 0)
    return ["if WIDE:", *(INDENT + row for row in one), "else:", *(INDENT + row for row in loops)]


def _plain_stages(kernel: Kernel) -> Stages | None:
    return staged(level_program(kernel, kernel.axes)._replace(outputs=kernel.outputs))


def _gathered(kernel: Kernel, loads: Mapping[str, str]) -> list[str]:
    """Copy the flagged points; what the last eight lack is filled with the last point.

    That point may be counted more than once as undecided.
    """
    here = f"i{kernel.axes - 1}"
    copies = [f"{name} = {text}" for name, text in loads.items()]
    copies += [f"put({name}_kept, k, {name})" for name in _inner(kernel)]
    body = [f"{here} = place_at(place, k)", *copies]
    return [*_PLACES, *_under(f"for k in range({_FILLED}):", body, 0)]


def _call(kernel: Kernel, loads: Mapping[str, str]) -> list[str]:
    """Run the stable form, on arrays where they are or on copies."""
    stable, rows = _stable_of(kernel), []
    for name in stable.points:
        array, _, places = loads[name].removesuffix("]").partition("[")
        rows.append(f"{name}_from = {_element(array, places.split(', '))} if most else {name}_kept")
    outer = [f"i{axis}" for axis in range(kernel.axes - 1)]
    for name in kernel.outputs:
        room = f"out_{name}_kept"
        there = f"{_element(f'out_{name}', [*outer, 'start'])} if direct else {room}"
        rows.append(f"out_{name}_to = {there if _is_number(kernel, name) else room}")
    rows.append(f"taken = size if most else {_FILLED}")
    call = f"stable(taken, {', '.join(_parameters(kernel))})"
    return [*rows, f"undecided += {call}" if _branch(kernel).undecided else call]


def _element(array: str, places: list[str]) -> str:
    """The elements of a contiguous array from the start of the block on."""
    flat = "start" if len(places) == 1 else places[0]
    for axis in range(1, len(places)):
        place = "start" if axis == len(places) - 1 else places[axis]
        flat = f"({flat}) * uint64({array}.shape[{axis}]) + {place}"
    return f"from_element({array}, {flat})"


def _is_number(kernel: Kernel, name: str) -> bool:
    """True for an output of doubles; a status is not."""
    return kernel.types.get(name, "f64") == "f64"


def _put_back(kernel: Kernel) -> list[str]:
    """Put the stable values back that are not yet where they belong."""
    index = "".join(f"i{axis}, " for axis in range(kernel.axes - 1))
    numbers = [name for name in kernel.outputs if _is_number(kernel, name)]
    others = [name for name in kernel.outputs if not _is_number(kernel, name)]

    def chosen(names: list[str]) -> list[str]:
        rows = ["flag = is_flagged(close, k)"]
        for name in names:
            place, value = f"out_{name}[{index}start + k]", f"get(out_{name}_kept, k)"
            rows += [f"before, after = {place}, {value}", f"{place} = after if flag else before"]
        return _under("for k in range(size):", rows, 0)

    some = [f"out_{name}[{index}place_at(place, k)] = get(out_{name}_kept, k)" for name in kernel.outputs]
    rows = _under("if not most:", _under("for k in range(count):", some, 0), 0)
    rows += _under("elif not every:", chosen(numbers), 0) if numbers else []
    return rows + (_under("if most:", chosen(others), 0) if others else [])


_COUNT = "count += count_flags(eight_flags(close, word))"
_FILLED = f"(count + uint64({LANES - 1})) & ~uint64({LANES - 1})"  # a whole number of eights
# Where the flagged points of a block are: places and their count.
_PLACES = """count = uint64(0)
for word in range(words):
    eight = eight_flags(close, word)
    put_places(place, count, eight, start + (word << uint64(3)))
    count += count_flags(eight)
put_places(place, count, uint64(0), place_at(place, count - uint64(1)))""".splitlines()


def _under(head: str, body: list[str], depth: int) -> list[str]:
    return [INDENT * depth + head, *(INDENT * (depth + 1) + row for row in body)]
