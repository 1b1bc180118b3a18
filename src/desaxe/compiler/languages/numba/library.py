"""A numba module that people import and keep: `point` of numbers, `evaluate` of arrays, `grid` of axes.

The formulas stand in it once, in straight lines, as functions that are inlined: `plain` where margins are
wide, `stable` anywhere. Arrays and grids run them over blocks of points, in loops without branches.
"""

from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap
from typing import NamedTuple

from ...builder import HELPERS, Parts, function_text, functions_of, module_text, source_of, words_of
from ...lowering import Limits, guarded_for_loops
from ...passes.trigonometry import Trigonometry
from ...program import Line, Program, renamed
from ...text import INDENT, WIDTH, with_short_temporaries, write_lines
from ..shared import types_of
from .module import IMPORTS, NJIT, SOURCES, numba_parts

HELPER_FILE = "_helpers"
FRONT = SOURCES / "front.py"
TEST = "has_wide_margins"
INLINED = '@njit(error_model="numpy", forceinline=True)\n'
FORMULAS = {"plain": "The values of a point with wide margins.", "stable": "The values of any point."}


class Library(NamedTuple):
    """The content of a module.

    head          lines of its docstring ahead of the names
    what          its results in words
    stable        the program of the outputs
    plain         the shorter one, for points that pass the test
    test          the program of one condition
    angle         the input of which programs take sine and cosine
    sines         names of these by operation
    constants     of the written-out sine and cosine
    units         of inputs and outputs
    defaults      input -> the text of its default
    centres       input -> the input of which it is half by default
    least         input -> its smallest valid value
    """

    head: str
    what: str
    stable: Program
    plain: Program
    test: Program
    angle: str
    sines: Mapping[str, str]
    constants: Trigonometry
    units: Mapping[str, str]
    defaults: Mapping[str, str]
    centres: Mapping[str, str]
    least: Mapping[str, float]

    @property
    def inputs(self) -> list[str]:
        """The inputs that vary from point to point."""
        return [name for name in self.stable.inputs if name != "branch"]

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the results."""
        return self.stable.outputs


def emit_helpers(banner: str, constants: Trigonometry) -> str:
    """The text of the file that all modules call."""
    spelled = ["mul_add", "rotated_sin", "two_product_error", "two_sum_error", "rounding", "apart"]
    calls = "".join(f"{name}()\n" for name in spelled)  # asks for their text
    formulas = numba_parts([_sin_cos(constants), calls])
    formulas = formulas._replace(texts=tuple(text for text in formulas.texts if text != calls))
    front = source_of(FRONT)
    texts = tuple(statement.text for statement in front.statements)
    words = frozenset[str]().union(*(statement.words for statement in front.statements))
    return module_text(
        banner, formulas, Parts((*texts, _SINES), words | words_of(_SINES), {**IMPORTS, **front.imports})
    )


_SINES = (
    "@compiled\n"
    + '''def sines(angle, sine, cosine):
    """The sines and cosines of a block of angles."""
    apart()
    for i in range(uint64(angle.size)):
        sine[i], cosine[i] = sin_cos(angle[i])
'''
)


def _sin_cos(constants: Trigonometry) -> str:
    """The function of both for an angle."""
    lines = (Line("sine", "sin", ("angle",)), Line("cosine", "cos", ("angle",)))
    program = Program(("angle",), lines, ("sine", "cosine"), {})
    guarded = guarded_for_loops(program, ["angle"], Limits({}, {"angle": constants.limit}), constants)
    body = [
        '"""Sine and cosine of an angle; NaN beyond what its reduction holds for."""',
        *_statements(guarded),
    ]
    return INLINED + function_text("sin_cos", ["angle"], body)


def _statements(program: Program) -> list[str]:
    program = with_short_temporaries(program)
    return [*write_lines(program, "numba"), *_wrapped("return (", program.outputs)]


def emit_library(library: Library) -> str:
    """The text of the module."""
    own = [
        _units(library),
        _kinds(library),
        _condition(library),
        _formulas("plain", library.plain, library),
        _formulas("stable", library.stable, library),
        _point(library),
        _block(library),
        _fill(library),
        _fill_rows(library),
        _call("evaluate", "broadcast(fill", "inputs broadcast like NumPy's; numbers give numbers", library),
        _call(
            "grid",
            f'outer(fill_rows, "{library.angle}"',
            "one dimension for each input of one dimension, in the order of inputs",
            library,
        ),
    ]
    helpers = dict.fromkeys([*functions_of(FRONT), *functions_of(HELPERS), *_MADE], f".{HELPER_FILE}")
    imports = IMPORTS | {"BLOCK": f".{HELPER_FILE}"} | helpers
    words = frozenset[str]().union(*map(words_of, own))
    return module_text(library.head, Parts(tuple(own), words, imports))


_MADE = ("sines", "sin_cos", "apart", "mul_add", "rotated_sin", "rotated_cos", "two_product_error")


def _mapping(name: str, rows: Mapping[str, str]) -> str:
    """A constant dict, wrapped."""
    text = ", ".join(f'"{key}": {value}' for key, value in rows.items())
    return "\n".join([f"{name} = {{", *(INDENT + row for row in wrap(f"{text},", WIDTH)), "}", ""])


def _units(library: Library) -> str:
    return _mapping("UNITS", {n: f'"{library.units[n]}"' for n in (*library.inputs, *library.outputs)})


def _kinds(library: Library) -> str:
    types = types_of(library.stable)
    return _mapping("OUTPUTS", {n: "int8" if types[n] == "i64" else "float64" for n in library.outputs})


def _wrapped(head: str, arguments: Iterable[str], tail: str = ")") -> list[str]:
    """A statement with arguments in parentheses, on one line or wrapped."""
    text = ", ".join(arguments)
    if len(head) + len(text) + len(tail) <= WIDTH:
        return [head + text + tail]
    rows = [INDENT + row for row in wrap(f"{text},", WIDTH, break_long_words=False)]
    return [head, *rows, tail] if head else ["(", *rows, f"){tail}"]


def _condition(library: Library) -> str:
    body = ['"""Whether the shorter formulas hold for a design."""', *_statements(library.test)]
    return INLINED + function_text(TEST, library.test.inputs, body)


def _parameters(library: Library) -> list[str]:
    """The parameters of the formulas."""
    names = [name for name in library.stable.inputs if name != "branch"]
    branch = [name for name in library.stable.inputs if name == "branch"]
    return [*names, *library.sines.values(), *branch]


def _formulas(name: str, program: Program, library: Library) -> str:
    """One form of the formulas as a function."""
    sines = with_given_sines(program, library.sines)
    # A design that passes the test has lengths that are good.
    checked = [n for n in library.inputs if name == "stable" or n not in library.test.inputs]
    limits = Limits(library.least, {library.angle: library.constants.limit})
    guarded = guarded_for_loops(sines, checked, limits, None)
    body = [f'"""{FORMULAS[name]}"""', *_statements(guarded)]
    return INLINED + function_text(name, _parameters(library), body)


def with_given_sines(program: Program, sines: Mapping[str, str]) -> Program:
    """The program with sine and cosine of its angle as inputs.

    Precondition: it has no other calls of them.
    """
    calls = {line.name: sines[line.op] for line in program.lines if line.op in sines}
    lines = tuple(line for line in program.lines if line.name not in calls)
    notes = {name: note for name, note in program.notes.items() if name not in calls}
    inputs = (*program.inputs, *sines.values())
    return renamed(program._replace(inputs=inputs, lines=lines, notes=notes), calls)


def _signature(library: Library) -> list[str]:
    """The parameters that people give."""
    defaults = {**library.defaults, **dict.fromkeys(library.centres, "None")}
    names = [f"{n}={defaults[n]}" if n in defaults else n for n in library.inputs]
    return [*names, *(["branch=1.0"] if "branch" in library.stable.inputs else [])]


def _centres(library: Library) -> list[str]:
    """The lines that put centres of mass halfway along their links."""
    return [
        f"{name}_taken = 0.5 * {link} if {name} is None else {name}" for name, link in library.centres.items()
    ]


def _taken(name: str, library: Library) -> str:
    return f"{name}_taken" if name in library.centres else name


def _point(library: Library) -> str:
    """The function of numbers."""
    values = [_taken(name, library) for name in _parameters(library)]
    body = [
        f'"""{library.what[0].upper()}{library.what[1:]} at a point, for your own @njit functions, too."""',
        *_centres(library),
        f"{', '.join(library.sines.values())} = sin_cos({library.angle})",
        f"if {TEST}({', '.join(library.test.inputs)}):",
        *(INDENT + row for row in _wrapped("return plain(", values)),
        *_wrapped("return stable(", values),
    ]
    return "@compiled\n" + function_text("point", _signature(library), body)


def _block(library: Library) -> str:
    """The loops over a block of points, each input an array or a number."""
    names = _parameters(library)
    values = [name if name == "branch" else f"value_at({name}, i)" for name in names]
    targets = [f"{name}_out[i]" for name in library.outputs]
    test = f"{TEST}({', '.join(f'value_at({name}, i)' for name in library.test.inputs)})"
    loop = "for i in range(size):"
    rows = [
        '"""Fill the outputs of a block: `plain` first, then `stable` where that does not hold."""',
        "apart()",
        f"size, wide = uint64({library.outputs[0]}_out.size), uint64(0)",
        loop,
        f"    wide += uint64(1) if {test} else uint64(0)",
        *_indented(1, [*_wrapped("values = plain(", values), *_wrapped("", targets, " = values")]),
        "if wide < size:",
        f"    {loop}",
        *_indented(2, [*_wrapped("before = (", targets), *_wrapped("values = stable(", values)]),
        f"        values = before if {test} else values",
        *_indented(2, _wrapped("", targets, " = values")),
    ]
    return NJIT + function_text("block", [*names, *(f"{name}_out" for name in library.outputs)], rows)


def _indented(depth: int, rows: Iterable[str]) -> list[str]:
    return [INDENT * depth + row for row in rows]


def _fill(library: Library) -> str:
    """Blocks of columns."""
    count = len(library.inputs)
    parts = [f"part_of(columns[{k}], buffers[{k}], start, size)" for k in range(count)]
    sines = [f"buffers[{count + k}, :size]" for k in range(len(library.sines))]
    rows = [
        '"""Fill the outputs of points; a column of one number is that of all points."""',
        f"buffers = empty(({count + len(library.sines)}, BLOCK))",
        "hold(columns, buffers)",
        "for start in range(0, length, BLOCK):",
        "    stop = min(start + BLOCK, length)",
        "    size = stop - start",
        f"    sines({', '.join([parts[library.inputs.index(library.angle)], *sines])})",
        *_indented(1, _block_call(library, [*parts, *sines])),
    ]
    return "@compiled\n" + function_text("fill", ["columns", "length", "branch", "targets"], rows)


def _fill_rows(library: Library) -> str:
    """Rows of a grid, along which the columns vary that are arrays."""
    parts = [f"row_part(columns[{k}], row)" for k in range(len(library.inputs) + len(library.sines))]
    rows = [
        '"""Fill rows of a grid; a column is an array along the row, or numbers of rows with a period."""',
        "for row in range(rows):",
        "    start, stop = row * length, (row + 1) * length",
        *_indented(1, _block_call(library, parts)),
    ]
    return "@compiled\n" + function_text(
        "fill_rows", ["columns", "rows", "length", "branch", "targets"], rows
    )


def _block_call(library: Library, parts: Sequence[str]) -> list[str]:
    branch = ["branch"] if "branch" in library.stable.inputs else []
    targets = [f"targets[{k}][start:stop]" for k in range(len(library.outputs))]
    return _wrapped("block(", [*parts, *branch, *targets])


def _call(name: str, road: str, what: str, library: Library) -> str:
    """A function of arrays."""
    inputs = [f'"{n}": {_taken(n, library)}' for n in library.inputs]
    branch = "branch" if "branch" in library.stable.inputs else "1"
    body = [
        f'"""{library.what[0].upper()}{library.what[1:]} by name: {what}."""',
        *_centres(library),
        *_wrapped("inputs = {", inputs, "}"),
        f"return {road}, OUTPUTS, inputs, {branch}, out)",
    ]
    return function_text(name, [*_signature(library), "out=None"], body)
