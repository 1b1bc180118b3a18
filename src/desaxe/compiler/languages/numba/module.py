"""A Kernel as a self-contained numba module: `kernel(*inputs, *outputs)` fills the outputs.

A kernel in two forms answers how many points hang on rounding.

Rules that numba's issue tracker teaches: every option is a literal in the module and every helper
stands in it (its cache does not see changes elsewhere); ``error_model="numpy"``, so that a division
by zero is an infinity; no fast-math flag, which would erase the NaN of an infeasible point;
``nogil=True``, so that threads can share the blocks of an array. Signatures are written out: the
module compiles when it is imported, or loads what an earlier process compiled; where nothing can be
kept on disk, it compiles in every process.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import wrap

from ...builder import HELPERS, MATH, Parts, function_text, module_text, with_sources
from ...kernel import Kernel, level_program
from ...program import Program
from ...text import INDENT, WIDTH, write_lines
from .lookups import looks_up, parted, rooms, three_loops
from .two_forms import has_two_forms, inner_loops, scratch, stable_function

_TYPES = {"f64": "float64", "i64": "int8"}  # a status is stored as int8
NJIT = '@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)\n'
# Where people may call what is written as plain Python, too: without its wrapper that would crash.
CALLABLE = '@njit(error_model="numpy")\n'
SOURCES = Path(__file__).with_name("sources")
FILES = tuple(SOURCES / f"{name}.py" for name in ("spellings", "rooms", "given", "lookups", "reductions"))
# Where the names come from that stand in the text of Programs and loops.
IMPORTS = MATH | {
    "asarray": "numpy", "ascontiguousarray": "numpy", "broadcast_arrays": "numpy", "empty": "numpy",
    "float64": "numpy", "floor": "numpy",  # numba's math.floor gives an integer, which does not vectorise
    "int8": "numpy", "int64": "numpy", "njit": "numba", "types": "numba", "uint64": "numpy",
}  # fmt: skip
_COMPILE = """try:
    kernel = njit(signature, cache=True, error_model="numpy", nogil=True)(loops)
except RuntimeError:  # numba found no folder that it can write to
    kernel = njit(signature, error_model="numpy", nogil=True)(loops)
"""
TO_COMPILE = "function = loops\n"  # the tail of a text that the runtime compiles


def numba_parts(parts: Sequence[str], *files: Path, jit: str = NJIT) -> Parts:
    """Parts of a module behind all that they call, of these files and of this language's own."""
    return with_sources(parts, (*files, *FILES, HELPERS), jit, IMPORTS)


def emit_numba(kernel: Kernel, docstring: str, tail: str = _COMPILE) -> str:
    """The source of the module; `tail` says what becomes of `loops` and its `signature`."""
    return module_text(docstring, numba_parts([*loops_parts(kernel), tail]))


def loops_parts(kernel: Kernel) -> list[str]:
    """The loops as a plain function, what they call, and their signature."""
    given = input_types(kernel)
    shape = ", ".join([":"] * (kernel.axes - 1) + ["::1"])
    given += [f"types.{_TYPES[kernel.types.get(name, 'f64')]}[{shape}]" for name in kernel.outputs]
    names = [*parameters_of(kernel), *(f"out_{name}" for name in kernel.outputs)]
    loops = function_text("loops", names, _body(kernel))
    stable = [NJIT + stable_function(kernel)] if has_two_forms(kernel) else []
    return [*stable, loops, signature("signature", "int64" if counts(kernel) else "void", given)]


def signature(name: str, answer: str, given: Sequence[str]) -> str:
    """The text of a signature under a name."""
    rows = wrap(", ".join(given), WIDTH)
    return "\n".join([f"{name} = types.{answer}(", *(INDENT + row for row in rows), ")"]) + "\n"


def counts(kernel: Kernel) -> bool:
    """True if the kernel returns the number of undecided points."""
    return kernel.close is not None and kernel.close.undecided is not None


def parameters_of(kernel: Kernel) -> list[str]:
    """An input that varies along an axis comes in as `<name>_axis`; the arrays of given tables follow."""
    own = [name if axis is None else f"{name}_axis" for name, axis in kernel.inputs.items()]
    return own + arrays_of(kernel.given)


def arrays_of(tables: Sequence[str]) -> list[str]:
    """The knots and coefficients of tables."""
    return [f"{table}_{end}" for table in tables for end in "xc"]


def input_types(kernel: Kernel) -> list[str]:
    """The types of the parameters."""
    own = ["types.float64" if axis is None else "AXIS" for axis in kernel.inputs.values()]
    return own + ["AXIS"] * 2 * len(kernel.given)


def _body(kernel: Kernel) -> list[str]:
    """The loops, those of the tables first."""
    lines = ["apart()"] if kernel.axes else []
    lines += scratch(kernel)
    lines += rooms(parted(_innermost(kernel))) if looks_up(kernel) else []
    lines += ["undecided = 0"] if counts(kernel) else []
    everywhere = tuple(range(kernel.axes))
    for table in kernel.tables:
        shape = ", ".join(f"out_{kernel.outputs[0]}.shape[{axis}]" for axis in table.along)
        lines += [f"{name}_table = empty(({shape},))" for name in table.kernel.outputs]
        lines += _loops(table.kernel, table.along, kernel.outputs[0], {}, "{}_table")
    reads = {name: table.along for table in kernel.tables for name in table.kernel.outputs}
    lines += _loops(kernel, everywhere, kernel.outputs[0], reads, "out_{}")
    return [*lines, "return undecided"] if counts(kernel) else lines


def _loops(
    kernel: Kernel,
    along: tuple[int, ...],
    measure: str,
    reads: Mapping[str, tuple[int, ...]],
    store: str,
) -> list[str]:
    """One loop nest over some axes; lengths are those of the output `measure`."""
    lines = _indented(level_program(kernel, 0), 0)
    stores = [f"{store.format(name)}[{_index(along)}] = {name}" for name in kernel.outputs]
    for depth, axis in enumerate(along):
        # The length is read from an output: an axis may have no input that is needed. An index that has no
        # sign cannot count from the end: where LLVM has to allow for that, it mistakes arrays that lie
        # next to each other in memory for overlapping ones, and a long loop then runs one by one.
        length = f"uint64(out_{measure}.shape[{axis}])"
        loads = {name: f"{name}_axis[i{axis}]" for name, on in kernel.inputs.items() if on == depth}
        loads |= {name: f"{name}_table[{_index(on)}]" for name, on in reads.items() if on[-1] == axis}
        if kernel.close is not None and depth == len(along) - 1:
            return lines + [INDENT * depth + row for row in inner_loops(kernel, length, loads)]
        if depth == len(along) - 1 and store.startswith("out") and looks_up(kernel):
            loops = three_loops(parted(_innermost(kernel)), f"i{axis}", length, loads, stores)
            return lines + [INDENT * depth + row for row in loops]
        lines.append(f"{INDENT * depth}for i{axis} in range({length}):")
        lines += [f"{INDENT * (depth + 1)}{name} = {text}" for name, text in loads.items()]
        lines += _indented(level_program(kernel, depth + 1), depth + 1)
    return lines + [INDENT * len(along) + row for row in stores]


def _innermost(kernel: Kernel) -> Program:
    """The lines of the innermost loop."""
    return level_program(kernel, kernel.axes)._replace(outputs=kernel.outputs)


def _index(along: tuple[int, ...]) -> str:
    return ", ".join(f"i{axis}" for axis in along)


def _indented(program: Program, depth: int) -> list[str]:
    return [INDENT * depth + line for line in write_lines(program, "numba")]
