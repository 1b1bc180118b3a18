"""A Kernel as a self-contained numba module: `kernel(*inputs, *outputs)` fills the outputs.

A kernel in two forms answers how many points hang on rounding.

Rules that numba's issue tracker teaches: every option is a literal in the module and every helper
stands in it (its cache does not see changes elsewhere); ``error_model="numpy"``, so that a division
by zero is an infinity; no fast-math flag, which would erase the NaN of an infeasible point;
``nogil=True``, so that threads can share the blocks of an array. Signatures are written out: the
module compiles when it is imported, or loads what an earlier process compiled; where nothing can be
kept on disk, it compiles in every process.
"""

from collections.abc import Container, Mapping
from textwrap import wrap

from ...kernel import Kernel, level_program, stable_branch_programs
from ...operations import HELPERS, NUMBA_HELPERS, OPERATIONS
from ...program import Line, Program
from ...text import INDENT, WIDTH, write_lines
from .two_forms import WIDE, has_two_forms, inner_loops, rooms, scratch, stable_function

_TYPES = {"f64": "float64", "i64": "int8"}  # a status is stored as int8
_NUMPY_CALLS = {"floor"}  # numba's math.floor gives an integer, which does not vectorise
_COMPILE = """try:
    kernel = njit(signature, cache=True, error_model="numpy", nogil=True)(loops)
except RuntimeError:  # numba found no folder that it can write to
    kernel = njit(signature, error_model="numpy", nogil=True)(loops)
"""
TO_COMPILE = "function = loops\n"  # the tail of a text that the runtime compiles
# Without the promise, LLVM tests before a loop whether any two arrays overlap, and lets the loop run one by
# one where that takes too many tests: from some twelve outputs on. Without the attribute it takes vectors of
# 256 bits where the processor has some of 512, which take half as many instructions.
_APART = """@intrinsic
def apart(typingctx):
    \"\"\"The promise that what is written to shares no memory with anything else; the widest vectors.\"\"\"

    def code(context, builder, signature, args):
        for argument in context.call_conv.get_arguments(builder.function):
            if argument.type.is_pointer:
                argument.add_attribute("noalias")
        # past llvmlite's list of attributes, which has none with a value
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.none(), code
"""
# An input may be an array that must not be written to; numba's signature strings cannot say so.
_INPUT = 'axis = types.Array(types.float64, 1, "C", readonly=True)\n'


def emit_numba(kernel: Kernel, docstring: str, tail: str = _COMPILE) -> str:
    """The source of the module; `tail` says what becomes of `loops` and its `signature`."""
    return "\n\n".join([_header(kernel, docstring, []), *_helpers(kernel), _function(kernel, tail)])


def emit_numba_with_front(kernel: Kernel, docstring: str, front: str, optional: Container[str] = ()) -> str:
    """A kernel's module with a function `evaluate(...)` that broadcasts like NumPy; `front` is its docstring.

    Precondition: one axis, along which every input but `branch` varies. Inputs that are `optional` are
    0 by default; those after them that are not are keywords.
    """
    numpy_names = ("ascontiguousarray", "broadcast_arrays", "empty", "float64", "int8")
    used = [name for name in numpy_names if name != "int8" or "i64" in kernel.types.values()]
    parts = [
        _header(kernel, docstring, used),
        *_helpers(kernel),
        _function(kernel, _COMPILE),
        _front(kernel, front, optional),
    ]
    return "\n\n".join(parts)


def _header(kernel: Kernel, docstring: str, numpy_names: list[str]) -> str:
    lines = _all_lines(kernel)
    called = {_called(line.op) for line in lines} - {""}
    calls = sorted(called - _NUMPY_CALLS)
    constants = {str(a) for line in lines for a in line.args if isinstance(a, float) and a - a != 0.0}
    numpy_names = [*numpy_names, *(["empty"] if kernel.tables else [])]
    from_numpy = sorted(
        {*numpy_names, *constants, *(called & _NUMPY_CALLS), *(["uint64"] * (kernel.axes > 0))}
    )
    imports = [f"from math import {', '.join(calls)}\n"] if calls else []
    imports.append("from numba import njit, types")
    imports += ["from numba.core import cgutils, codegen"] if has_two_forms(kernel) else []
    if kernel.axes or any(line.op in NUMBA_HELPERS for line in lines):
        imports.append("from numba.extending import intrinsic")
    imports += [f"from numpy import {', '.join(from_numpy)}"] if from_numpy else []
    given = [f'{WIDE} = "+avx512f" in codegen.get_host_cpu_features()\n'] if has_two_forms(kernel) else []
    given += [_INPUT] if any(axis is not None for axis in kernel.inputs.values()) else []
    return "\n".join([f'"""{docstring}"""\n', *imports, "", *given])


def _all_lines(kernel: Kernel) -> list[Line]:
    """The lines of all loops, tables included."""
    kernels = [*(table.kernel for table in kernel.tables), kernel]
    bodies = [level_program(each, level) for each in kernels for level in range(each.axes + 1)]
    bodies += stable_branch_programs(kernel) if kernel.close else ()
    return [line for body in bodies for line in body.lines]


def helper_sources(operations: Container[str]) -> list[str]:
    """The functions that the spellings of these operations call."""
    return [
        NUMBA_HELPERS.get(name, f'@njit(error_model="numpy")\n{HELPERS[name]}')
        for name in HELPERS
        if name in operations
    ]


def _helpers(kernel: Kernel) -> list[str]:
    sources = helper_sources({line.op for line in _all_lines(kernel)})
    sources += [_APART] if kernel.axes else []
    return [*sources, rooms(kernel), stable_function(kernel)] if has_two_forms(kernel) else sources


def _called(op: str) -> str:
    """The function of `math` that the spelling of an operation calls, if it does."""
    name, bracket, _ = OPERATIONS[op].numba.partition("(")
    return name if bracket and name not in HELPERS else ""


def _function(kernel: Kernel, tail: str) -> str:
    """The loops as a plain function, and what the tail makes of it."""
    types = ["types.float64" if axis is None else "axis" for axis in kernel.inputs.values()]
    shape = ", ".join([":"] * (kernel.axes - 1) + ["::1"])
    types += [f"types.{_TYPES[kernel.types.get(name, 'f64')]}[{shape}]" for name in kernel.outputs]
    names = [*_parameters(kernel), *(f"out_{name}" for name in kernel.outputs)]
    rows = wrap(", ".join(types), WIDTH)
    return "\n".join(
        [
            "def loops(",
            *(f"{INDENT}{name}," for name in names),
            "):",
            *_body(kernel),
            f"\n\nsignature = types.{'int64' if counts(kernel) else 'void'}(",
            *(INDENT + row for row in rows),
            ")",
            tail,
        ]
    )


def counts(kernel: Kernel) -> bool:
    """True if the kernel returns the number of undecided points."""
    return kernel.close is not None and kernel.close.undecided is not None


def _parameters(kernel: Kernel) -> list[str]:
    """An input that varies along an axis comes in as `<name>_axis`."""
    return [name if axis is None else f"{name}_axis" for name, axis in kernel.inputs.items()]


def _body(kernel: Kernel) -> list[str]:
    """The loops, those of the tables first."""
    lines = [f"{INDENT}apart()"] if kernel.axes else []
    lines += [INDENT + row for row in scratch(kernel)]
    lines += [f"{INDENT}undecided = 0"] if counts(kernel) else []
    everywhere = tuple(range(kernel.axes))
    for table in kernel.tables:
        shape = ", ".join(f"out_{kernel.outputs[0]}.shape[{axis}]" for axis in table.along)
        lines += [f"{INDENT}{name}_table = empty(({shape},))" for name in table.kernel.outputs]
        lines += _loops(table.kernel, table.along, kernel.outputs[0], {}, "{}_table")
    reads = {name: table.along for table in kernel.tables for name in table.kernel.outputs}
    lines += _loops(kernel, everywhere, kernel.outputs[0], reads, "out_{}")
    return [*lines, f"{INDENT}return undecided"] if counts(kernel) else lines


def _loops(
    kernel: Kernel,
    along: tuple[int, ...],
    measure: str,
    reads: Mapping[str, tuple[int, ...]],
    store: str,
) -> list[str]:
    """One loop nest over some axes; lengths are those of the output `measure`."""
    lines = _indented(level_program(kernel, 0), 1)
    for depth, axis in enumerate(along):
        # The length is read from an output: an axis may have no input that is needed. An index that has no
        # sign cannot count from the end: where LLVM has to allow for that, it mistakes arrays that lie
        # next to each other in memory for overlapping ones, and a long loop then runs one by one.
        length = f"uint64(out_{measure}.shape[{axis}])"
        loads = {name: f"{name}_axis[i{axis}]" for name, on in kernel.inputs.items() if on == depth}
        loads |= {name: f"{name}_table[{_index(on)}]" for name, on in reads.items() if on[-1] == axis}
        if kernel.close is not None and depth == len(along) - 1:
            return lines + [INDENT * (depth + 1) + row for row in inner_loops(kernel, length, loads)]
        lines.append(f"{INDENT * (depth + 1)}for i{axis} in range({length}):")
        lines += [f"{INDENT * (depth + 2)}{name} = {text}" for name, text in loads.items()]
        lines += _indented(level_program(kernel, depth + 1), depth + 2)
    pad = INDENT * (len(along) + 1)
    return lines + [f"{pad}{store.format(name)}[{_index(along)}] = {name}" for name in kernel.outputs]


def _index(along: tuple[int, ...]) -> str:
    return ", ".join(f"i{axis}" for axis in along)


def _indented(program: Program, depth: int) -> list[str]:
    return [INDENT * depth + line for line in write_lines(program, "numba")]


def _front(kernel: Kernel, docstring: str, optional: Container[str]) -> str:
    """The function `evaluate(...)`: broadcast, allocate, run, return a mapping."""
    axes = [name for name, axis in kernel.inputs.items() if axis is not None]
    parameters = _with_defaults(axes, optional)
    parameters += ["branch=1.0"] if "branch" in kernel.inputs else []
    arguments = [f"flat[{axes.index(name)}]" if name in axes else name for name in kernel.inputs]
    names = ", ".join(f'"{name}"' for name in kernel.outputs)
    integers = [name for name in kernel.outputs if kernel.types.get(name) == "i64"]
    kind = f"int8 if name in {tuple(integers)} else float64" if integers else "float64"
    body = [
        f'"""{docstring}"""',
        f"arrays = broadcast_arrays({', '.join(axes)})",
        "flat = [ascontiguousarray(array, dtype=float64).ravel() for array in arrays]",
        f"out = {{name: empty(arrays[0].shape, {kind}) for name in OUTPUTS}}",
        f"kernel({', '.join(arguments)}, *(array.reshape(-1) for array in out.values()))",
        "return out",
    ]
    head = f"OUTPUTS = ({names},)\n\n\ndef evaluate({', '.join(parameters)}):"
    return "\n".join([head, *(INDENT + line for line in body)]) + "\n"


def _with_defaults(names: list[str], optional: Container[str]) -> list[str]:
    """Parameters of a function; a star stands before the first that has no default after one that has."""
    found: list[str] = []
    for name in names:
        if name not in optional and found and found[-1].endswith("=0.0") and "*" not in found:
            found.append("*")
        found.append(f"{name}=0.0" if name in optional else name)
    return found
