"""A numba module that people import and keep: `point` of numbers, `evaluate` of arrays, `grid` of axes.

The formulas stand in it once, in straight lines, as functions that are inlined: `plain` where margins are
wide, `stable` anywhere, or `formulas` where there is one form. Arrays and grids run them over blocks of
points, in loops without branches.
"""

from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap

from ...builder import HELPERS, Parts, function_text, functions_of, module_text, quoted, source_of, words_of
from ...lowering import Limits, guarded_for_loops
from ...passes.slicing import keep_outputs
from ...passes.trigonometry import Trigonometry
from ...program import Line, Program
from ...text import INDENT, WIDTH, with_short_temporaries, write_lines
from ..lifted import Lifted, lifted
from ..protocol import Module, Symbol
from ..shared import arrays_of, numbers, one_line
from .module import IMPORTS, NJIT, SOURCES, SPELLINGS, numba_parts

HELPER_FILE = "_helpers"
FRONT = SOURCES / "front.py"
_TURNED = ("rotated_sin", "rotated_cos")  # there, but no functions
TEST = "has_wide_margins"
INLINED = '@njit(error_model="numpy", forceinline=True)\n'
FORMULAS = {
    "plain": "The values of a point with wide margins.",
    "stable": "The values of any point.",
    "formulas": "The values of a point.",
}
MADE = ("near_sin_cos", "sin_cos", "sines")  # functions that are written from a Program, or around one

# ---- what modules call ------------------------------------------------------------------------------


def emit_folder(
    modules: Mapping[str, tuple[Module, str]], banner: str, constants: Trigonometry
) -> dict[str, str]:
    """The texts of modules, each with its docstring, by file, and of the file of helpers that they call."""
    own = {name: _Writer(module).parts() for name, (module, _) in modules.items()}
    texts = {text for parts in own.values() for text in parts.texts}
    called = numba_parts([*_sines(constants).texts, *_front().texts, *texts])
    helpers = called._replace(texts=tuple(text for text in called.texts if text not in texts))
    words = frozenset[str]().union(*map(words_of, helpers.texts))
    front = (name for statement in source_of(FRONT).statements for name in statement.names)
    names = [*front, *functions_of(HELPERS), *functions_of(SPELLINGS), *MADE, *_TURNED]
    imports = IMPORTS | dict.fromkeys(names, f".{HELPER_FILE}")
    texts_of = {
        name: module_text(docstring, own[name]._replace(imports=imports))
        for name, (_, docstring) in modules.items()
    }
    return texts_of | {HELPER_FILE: module_text(banner, _front(), helpers._replace(words=words))}


def _front() -> Parts:
    front = source_of(FRONT)
    words = frozenset[str]().union(*(statement.words for statement in front.statements))
    return Parts(tuple(statement.text for statement in front.statements), words, front.imports)


def _sines(constants: Trigonometry) -> Parts:
    """The functions of an angle, by polynomials and beyond their reach by libm."""
    lines = (Line("sine", "sin", ("angle",)), Line("cosine", "cos", ("angle",)))
    program = Program(("angle",), lines, ("sine", "cosine"), {})
    guarded = guarded_for_loops(program, ["angle"], Limits({}, {"angle": constants.limit}), constants)
    body = ['"""Sine and cosine by polynomials; NaN beyond what their reduction holds for."""']
    near = INLINED + function_text("near_sin_cos", ["angle"], [*body, *_statements(guarded)])
    return numba_parts([near, _SINES.replace("LIMIT", repr(constants.limit))])


_SINES = '''@njit(error_model="numpy", forceinline=True)
def sin_cos(angle):
    """Sine and cosine of any angle."""
    if fabs(angle) <= LIMIT:
        return near_sin_cos(angle)
    return sin(angle), cos(angle)


@compiled
def sines(angle, sine, cosine):
    """The sines and cosines of a block of angles."""
    apart()
    size, near = uint64(angle.size), uint64(0)
    for i in range(size):
        near += uint64(1) if fabs(angle[i]) <= LIMIT else uint64(0)
        sine[i], cosine[i] = near_sin_cos(angle[i])
    if near < size:
        for i in range(size):
            if not fabs(angle[i]) <= LIMIT:
                sine[i], cosine[i] = sin(angle[i]), cos(angle[i])
'''


# ---- searches ---------------------------------------------------------------------------------------


def grid_text(module: Module, inputs: str) -> str:
    """The call that computes the outer product of inputs, a dict in the order of dimensions."""
    writer = _Writer(module)
    order = "" if module.forms.rounded else ", INPUTS"
    return f"{writer.grid(inputs)}, 1, None, threads{order})"


def search_text(module: Module, name: str, places: Sequence[int]) -> list[str]:
    """`search_<name>`, which finds the extreme value of a result over the first argument, for many designs.

    places   of the value, its derivative by that argument and further derivatives in what formulas give

    It calls what `peak_steps.py` of the scenes' exports has.
    """
    writer = _Writer(module)
    form = next(reversed(writer.forms))
    angle, others = module.angle, [name for name in writer.inputs if name != module.angle]
    design = ", ".join(others)
    taken = [*writer.inputs, *writer.sines, *writer.branch]

    def values(row: str) -> list[str]:
        cells = [f"{n}{row}" if n == angle or n in writer.sines else n for n in taken]
        return _wrapped(f"values = {form}(", cells)

    results = [f"values[{place}]" for place in places]
    sines = [f"{', '.join(writer.sines)} = sin_cos({angle})"] if writer.sines else []
    curve = [
        "apart()",
        f"for i in range(uint64({angle}.size)):",
        *_indented(1, values("[i]")),
        f"    value[i], slope[i] = {results[0]}, {results[1]}",
    ]
    point = [*sines, *values(""), *_wrapped("return (", results, ",)" if len(results) == 1 else ")")]
    parameters = [angle, *writer.sines, *others]
    given = ["nodes", *(f"{part}_nodes" for part in ("sin", "cos") if writer.sines), *others]
    texts = [
        NJIT + function_text(f"curve_{name}", [*parameters, "value", "slope"], curve),
        NJIT + function_text(f"at_{name}", [angle, *others], point),
    ]
    rows = [f"{n} = designs[{k}, i]" for k, n in enumerate(others)]
    search = _SEARCH.replace("@NAME@", name).replace("@DESIGN@", f", {design}" if design else "")
    search = search.replace("@CURVE@", ", ".join(given)).replace(
        "        @ROWS@\n", "".join(f"        {row}\n" for row in rows)
    )
    return [*texts, search]


_SEARCH = '''@compiled
def search_@NAME@(nodes, sin_nodes, cos_nodes, kind, designs, first, last, theta, out):
    """The extreme value of each design: its angle; value, slope and derivatives there."""
    value, slope = empty(nodes.size), empty(nodes.size)
    for i in range(first, last):
        @ROWS@
        curve_@NAME@(@CURVE@, value, slope)
        best, theta[i], at_node = -inf, nan, True
        for j in range(nodes.size):
            if score(kind, value[j]) > best:
                best, theta[i] = score(kind, value[j]), nodes[j]
        for j in range(nodes.size - 1):
            width = nodes[j + 1] - nodes[j]
            if not may_hold(kind, best, width, value[j], value[j + 1], slope[j], slope[j + 1]):
                continue
            end, before = nodes[j], slope[j]
            for part in range(4):
                low, high, after = end, nodes[j + 1], slope[j + 1]
                if part < 3:
                    high = nodes[j] + inside(part, slope[j], slope[j + 1]) * width
                    after = at_@NAME@(high@DESIGN@)[1]
                end, rises = high, before > 0.0
                changes = rises != (after > 0.0) and before == before and after == after
                last_x, last_slope, x, here, size = low, before, high, after, high - low
                before = after
                for step in range(100 if changes else 0):
                    new = next_guess(low, high, x, here, last_x, last_slope, size)
                    last_x, last_slope, size, x = x, here, abs(new - x), new
                    here = at_@NAME@(x@DESIGN@)[1]
                    if (here > 0.0) == rises:
                        low = x
                    else:
                        high = x
                    if here == 0.0 or size <= 4e-16 * abs(x) or high - low <= 4e-16 * abs(x):
                        break
                if changes:
                    new = score(kind, at_@NAME@(x@DESIGN@)[0])
                    if new > best + 1e-14 * abs(best) or (at_node and new >= best - 1e-14 * abs(best)):
                        best, theta[i], at_node = max(new, best), x, False
        values = at_@NAME@(theta[i]@DESIGN@)
        for k in range(out.shape[0]):
            out[k, i] = values[k]
'''


# ---- a module ---------------------------------------------------------------------------------------


def emit_alone(module: Module, docstring: str) -> str:
    """The text of a module that needs no other file."""
    own = _Writer(module).parts()
    texts = list(own.texts) + (list(module.more.texts) if module.more else [])
    called = numba_parts([*_sines(module.constants).texts, *_front().texts, *texts])
    return module_text(
        docstring,
        _front(),
        called._replace(texts=tuple(t for t in called.texts if t not in texts)),
        own,
        *([module.more] if module.more else []),
    )


def _statements(program: Program, several: bool = True) -> list[str]:
    program = with_short_temporaries(program)
    last = "," if several and len(program.outputs) == 1 else ""
    return [*write_lines(program, "numba"), *_wrapped("return (", program.outputs, f"{last})")]


def _mapping(name: str, rows: Mapping[str, str]) -> str:
    """A constant dict, wrapped."""
    text = ", ".join(f'"{key}": {value}' for key, value in rows.items())
    return "\n".join([f"{name} = {{", *(INDENT + row for row in wrap(f"{text},", WIDTH)), "}", ""])


def _wrapped(head: str, arguments: Iterable[str], tail: str = ")") -> list[str]:
    """A statement with arguments in parentheses, on one line or wrapped."""
    text = ", ".join(arguments)
    if len(head) + len(text) + len(tail) <= WIDTH:
        return [head + text + tail]
    rows = [INDENT + row for row in wrap(f"{text},", WIDTH, break_long_words=False)]
    return [head, *rows, tail.lstrip(",")] if head else ["(", *rows, f"){tail}"]


def _indented(depth: int, rows: Iterable[str]) -> list[str]:
    return [INDENT * depth + row for row in rows]


class _Writer:
    """Writes the parts of a module."""

    def __init__(self, module: Module) -> None:
        self.module = module
        forms = module.forms
        self.names = [symbol.name for symbol in module.inputs]  # that people give
        self.inputs = [*self.names, *module.fixed]  # of the formulas
        chosen = [k for k in range(len(forms.stable.outputs)) if k != forms.status or k < self.count]
        programs = {"plain": forms.plain if forms.test else None, "stable": forms.stable}
        self.forms: dict[str, Lifted] = {}
        for name, program in programs.items():
            if program is not None:
                short = keep_outputs(program, [program.outputs[k] for k in chosen])
                self.forms[name] = lifted(short, [module.angle])
        self.test = forms.test if len(self.forms) == 2 else None
        if self.test is None:
            self.forms = {"formulas": self.forms["stable"]}
        self.turns = {k: v for form in self.forms.values() for k, v in form.turns.items()}
        self.sines = [name for pair in self.turns.values() for name in pair]
        self.branch = ["branch"] if "branch" in forms.stable.inputs else []

    @property
    def count(self) -> int:
        """The number of results; what the formulas give besides is for other functions."""
        return len(self.module.outputs)

    @property
    def open_angle(self) -> str | None:
        """The argument that people give of which sine and cosine are taken."""
        return next((angle for angle in self.turns if angle in self.names), None)

    def parts(self) -> Parts:
        """All parts."""
        module = self.module
        texts = [
            f"INPUTS = {quoted(tuple(self.names))}\n",
            _mapping("UNITS", {s.name: f'"{s.unit}"' for s in (*module.inputs, *module.outputs)}),
            _mapping("OUTPUTS", {s.name: self.kind(k) for k, s in enumerate(module.outputs)}),
            *self.tables(),
            *([self.condition()] if self.test else []),
            *(self.formulas(name, form) for name, form in self.forms.items()),
            self.point(),
            *(self.function(k, symbol) for k, symbol in enumerate(module.outputs) if module.functions),
            *self.arrays(),
        ]
        words = frozenset[str]().union(*map(words_of, texts))
        return Parts(tuple(texts), words, IMPORTS | {"array": "numpy"})

    def kind(self, place: int) -> str:
        """The type of an output."""
        return "int8" if place == self.module.forms.status else "float64"

    def tables(self) -> list[str]:
        """The tables that are looked into."""
        return [
            "\n".join([f"{name} = array([", *_indented(1, numbers(column)), "])", ""])
            for name, column in arrays_of(self.module.tables).items()
        ]

    # -- one point --

    def condition(self) -> str:
        """The test of a design."""
        assert self.test is not None
        body = ['"""Whether the shorter formulas hold for a design."""', *_statements(self.test, False)]
        return INLINED + function_text(TEST, self.test.inputs, body)

    def formulas(self, name: str, form: Lifted) -> str:
        """One form of the formulas as a function."""
        program = form.program
        if not self.module.forms.rounded:
            program = guarded_for_loops(program, (), Limits({}), None)
        body = [f'"""{FORMULAS[name]}"""', *_statements(program)]
        return INLINED + function_text(name, [*self.inputs, *self.sines, *self.branch], body)

    def signature(self) -> list[str]:
        """The parameters that people give."""
        defaults = {**self.module.defaults, **dict.fromkeys(self.module.centres, "None")}
        names = [f"{n}={defaults[n]}" if n in defaults else n for n in self.names]
        return [*names, *(f"{name}=1.0" for name in self.branch)]

    def centres(self) -> list[str]:
        """The lines that put centres of mass halfway along their links."""
        return [
            f"{name}_taken = 0.5 * {link} if {name} is None else {name}"
            for name, link in self.module.centres.items()
        ]

    def value(self, name: str) -> str:
        """The text of an input of the formulas."""
        if name in self.module.fixed:
            return repr(self.module.fixed[name])
        return f"{name}_taken" if name in self.module.centres else name

    @property
    def what(self) -> str:
        """The results in words, at the start of a sentence."""
        return self.module.what[0].upper() + self.module.what[1:]

    def point(self) -> str:
        """The function of numbers."""
        values = [self.value(n) for n in (*self.inputs, *self.sines, *self.branch)]
        body = [f'"""{self.what} at a point, for your own @njit functions, too."""', *self.centres()]
        body += [f"{', '.join(pair)} = sin_cos({self.value(a)})" for a, pair in self.turns.items()]
        if self.test:
            body.append(f"if {TEST}({', '.join(map(self.value, self.test.inputs))}):")
        for depth, name in zip((1, 0) if self.test else (0,), self.forms, strict=True):
            body += _indented(depth, self.returned(name, values))
        return "@compiled\n" + function_text("point", self.signature(), body)

    def returned(self, name: str, values: Sequence[str]) -> list[str]:
        """The lines that return the results of a form."""
        if self.count == len(self.forms[name].program.outputs):
            return _wrapped(f"return {name}(", values)
        results = [f"values[{k}]" for k in range(self.count)]
        return [*_wrapped(f"values = {name}(", values), *_wrapped("return (", results, ",)")]

    def function(self, place: int, symbol: Symbol) -> str:
        """The function of one output."""
        taken = self.module.taken(symbol.name)
        meaning = one_line(symbol.meaning or symbol.name)  # a quantity of a user may come without
        given = ", ".join(name if name in taken else "nan" for name in self.names)
        body = [
            f'"""{meaning[0].upper()}{meaning[1:]} [{symbol.unit}]."""',
            f"return point({given})[{place}]",
        ]
        return "@compiled\n" + function_text(symbol.name, taken, body)

    # -- arrays --

    def arrays(self) -> list[str]:
        """The functions of arrays."""
        if not self.names:
            return ['def evaluate():\n    """The values; every input is fixed."""\n'
                    "    return dict(zip(OUTPUTS, point(), strict=True))\n"]  # fmt: skip
        broadcasts = "inputs broadcast like NumPy's; numbers give numbers"
        dimensions = "one dimension for each input of one dimension, in the order of inputs"
        return [
            self.block(),
            self.fill(),
            *([] if self.module.forms.rounded else [self.fill_rows()]),
            self.call("evaluate", "broadcast(fill, OUTPUTS, inputs", broadcasts),
            self.call("grid", self.grid("inputs"), dimensions),
        ]

    def grid(self, inputs: str) -> str:
        """The start of the call that computes the outer product of some inputs.

        With twice the digits, whose lines LLVM would duplicate for what is the same along a row, as points.
        """
        if self.module.forms.rounded:
            return f"broadcast(fill, OUTPUTS, meshed({inputs}, INPUTS)"
        return f"outer(fill_rows, {quoted(self.open_angle)}, OUTPUTS, {inputs}"

    def passed(self, names: Iterable[str]) -> str:
        """The arguments of a function, from the values at a point: of columns, sines and branch."""
        order = [*self.names, *self.sines, *self.branch]
        texts = {name: f"values[{k}]" for k, name in enumerate(order)}
        cells = [texts.get(name) or self.value(name) for name in names]
        return "*values" if cells == [*texts.values()] else ", ".join(cells)

    def block(self) -> str:
        """The loops over a block of points; a column is an array or a number."""
        calls = [f"{form}({self.passed([*self.inputs, *self.sines, *self.branch])})" for form in self.forms]
        loop = ["for i in range(size):", "    values = values_at(columns, i)"]
        rows = ["apart()", "size = uint64(targets[0].size)"]
        if len(calls) == 1:
            about = '"""Fill the outputs of a block."""'
            rows = [about, *rows, *loop, f"    store(targets, i, {calls[0]})"]
        else:
            about = (
                '"""Fill the outputs of a block: `plain` first, then `stable` where that does not hold."""'
            )
            test = f"{TEST}({self.passed(self.test.inputs if self.test else ())})"
            rows = [
                *(about, *rows, "count = uint64(0)", *loop),
                f"    count += uint64(1) if {test} else uint64(0)",
                f"    store(targets, i, {calls[0]})",
                *("if count < size:", *_indented(1, loop)),
                f"        store_unless({test}, targets, i, {calls[1]})",
            ]
        return NJIT + function_text("block", ["columns", "targets"], rows)

    def columns(self) -> int:
        """The number of arrays that a block reads."""
        return len(self.names) + len(self.sines)

    def fill(self) -> str:
        """Blocks of columns."""
        count = len(self.names)
        rows = [
            '"""Fill the outputs of points; a column of one number is that of all points."""',
            f"buffers = empty(({self.columns()}, BLOCK))",
            "hold(columns, buffers)",
            *self.fixed_sines(),
            "for start in range(first, last, BLOCK):",
            "    size = min(start + BLOCK, last) - start",
            "    parts = parts_at(columns, buffers, start, size)",
        ]
        if self.open_angle:
            place = self.names.index(self.open_angle)
            rows.append(f"    turns = buffers[{count}, :size], buffers[{count + 1}, :size]")
            rows.append(f"    sines(parts[{place}], turns[0], turns[1])")
        turns = ["turns"] if self.open_angle else self.fixed_turns()
        columns = " + ".join(["parts", *turns, *(["(branch,)"] if self.branch else [])])
        rows.append(f"    block({columns}, slices(targets, start, start + size))")
        return "@compiled\n" + function_text("fill", ["columns", "first", "last", "branch", "targets"], rows)

    def fixed_turns(self) -> list[str]:
        """The sine and cosine of an angle that is fixed, as a tuple."""
        return [f"({', '.join(self.sines)})"] if self.sines and not self.open_angle else []

    def fixed_sines(self) -> list[str]:
        """The line that takes sine and cosine of an angle that is fixed."""
        fixed = {angle: pair for angle, pair in self.turns.items() if angle in self.module.fixed}
        return [f"{', '.join(pair)} = sin_cos({self.value(angle)})" for angle, pair in fixed.items()]

    def fill_rows(self) -> str:
        """Rows of a grid, along which the columns vary that are arrays."""
        parts = ["rows_at(columns, row)", *self.fixed_turns(), *(["(branch,)"] if self.branch else [])]
        rows = [
            '"""Fill rows of a grid: a column is an array along a row, or numbers of rows with a period."""',
            *self.fixed_sines(),
            "for row in range(first, last):",
            f"    block({' + '.join(parts)}, slices(targets, row * length, (row + 1) * length))",
        ]
        return "@compiled\n" + function_text(
            "fill_rows", ["columns", "first", "last", "length", "branch", "targets"], rows
        )

    def call(self, name: str, road: str, what: str) -> str:
        """A function of arrays."""
        inputs = [f'"{n}": {self.value(n)}' for n in self.names]
        branch = "branch" if self.branch else "1"
        body = [
            f'"""{self.what} by name: {what}."""',
            *self.centres(),
            *_wrapped("inputs = {", inputs, "}"),
            f"return {road}, {branch}, out, threads)",
        ]
        return function_text(name, [*self.signature(), "out=None", "threads=None"], body)
