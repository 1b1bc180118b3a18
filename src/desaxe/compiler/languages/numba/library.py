"""A numba module that people import and keep: `point` of numbers, `evaluate` of arrays, `grid` of axes.

The formulas stand in it once, in straight lines, as functions that are inlined: `plain` where margins are
wide, `stable` anywhere, or `stable` alone; lines at the end that both have are `rest`. Arrays and grids run
them over blocks of points, in loops without branches, which stand in the helpers (sources.py).

Rules that numba's issue tracker teaches: every option is a literal and every helper stands in the module, or
in the one file beside it (its cache does not see changes elsewhere); ``error_model="numpy"``, so that a
division by zero is an infinity; no fast-math flag, which would erase the NaN of an infeasible point;
``nogil=True``, so that threads can share the blocks of an array.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from sys import float_info
from textwrap import wrap

from ...builder import HELPERS, MATH, Parts, function_text, module_text, quoted, with_sources, words_of
from ...lowering import Limits, guarded_for_loops
from ...passes.guard import GUARDED
from ...passes.slicing import drop_unused, keep_outputs
from ...passes.trigonometry import Trigonometry
from ...program import Argument, Line, Program, names_in
from ...text import INDENT, WIDTH, with_short_temporaries, write_lines
from ..lifted import lifted
from ..protocol import Module, Symbol
from ..shared import arrays_of, numbers, one_line

SOURCES = Path(__file__).with_name("sources.py")
HELPER_FILE = "_helpers"
# Where the names come from that stand in the text of Programs and loops.
IMPORTS = MATH | {
    "array": "numpy", "empty": "numpy", "float64": "numpy",
    "floor": "numpy",  # math.floor gives an integer: no vectors
    "int8": "numpy", "int64": "numpy", "njit": "numba", "types": "numba", "uint64": "numpy",
}  # fmt: skip
FORMULAS = {
    "has_wide_margins": "Whether the shorter formulas hold for a design.",
    "rest": "The values that follow from those of either form.",
    "plain": "The values of a point with wide margins.",
    "stable": "The values of any point.",
}
TEST = "@inlined\ndef has_wide_margins("
SHARED = 12  # lines at least that a function of their own is for


# ---- files -----------------------------------------------------------------------------------------


def emit_folder(
    modules: Mapping[str, tuple[Module, str]], banner: str, constants: Trigonometry
) -> dict[str, str]:
    """The texts of modules, each with its docstring, by file, and of the file of helpers that they call."""
    texts = {name: Writer(module).texts() for name, (module, _) in modules.items()}
    every = [text for own in texts.values() for text in own]
    tests = [text for text in every if text.startswith(TEST)]
    common = tests[:1] if len({*tests}) == 1 < len(tests) else []  # one test, for several modules
    helpers = _helpers(every, constants)
    helpers = helpers._replace(texts=(*helpers.texts, *common))
    beside = dict.fromkeys((name for text in helpers.texts for name in _defined(text)), f".{HELPER_FILE}")
    files = {HELPER_FILE: module_text(banner, helpers)}
    for name, (_, docstring) in modules.items():
        own = [text for text in texts[name] if text not in common]
        files[name] = module_text(docstring, _parts(own, IMPORTS | beside))
    return files


def emit_alone(module: Module, docstring: str) -> str:
    """The text of a module that needs no other file."""
    texts = Writer(module).texts()
    more = [module.more] if module.more else []
    behind = [*texts, *(text for part in more for text in part.texts)]
    return module_text(docstring, _helpers(behind, module.constants), _parts(texts, IMPORTS), *more)


def _parts(texts: Sequence[str], imports: Mapping[str, str]) -> Parts:
    return Parts(tuple(texts), frozenset[str]().union(*map(words_of, texts)), imports)


def _helpers(texts: Sequence[str], constants: Trigonometry) -> Parts:
    """Select the helpers that texts call, with the sine of an angle."""
    behind = [*texts, *_sines(constants), "@inner"]
    every = with_sources(behind, [SOURCES, HELPERS], "@inner\n", IMPORTS)
    return _parts([text for text in every.texts if text not in (*texts, "@inner")], every.imports)


def _defined(text: str) -> Iterable[str]:
    """The names that a text defines at its top."""
    rows = [row for row in text.splitlines() if row[:1].isalpha() or row[:1] == "_"]
    for row in rows:
        head = row.removeprefix("def ")
        yield from head.partition("(")[0].split(", ") if head != row else head.partition(" = ")[0].split(", ")


def _sines(constants: Trigonometry) -> list[str]:
    """The functions of an angle, by polynomials and beyond their reach by libm."""
    lines = (Line("sine", "sin", ("angle",)), Line("cosine", "cos", ("angle",)))
    program = Program(("angle",), lines, ("sine", "cosine"), {})
    guarded = guarded_for_loops(program, ["angle"], Limits({}, {"angle": constants.limit}), constants)
    about = '"""Sine and cosine by polynomials; NaN beyond what their reduction holds for."""'
    near = "@inlined\n" + function_text("near_sin_cos", ["angle"], [about, *_statements(guarded)])
    return [f"LIMIT = {constants.limit!r}  # of an angle, for its polynomials", near]


# ---- formulas ---------------------------------------------------------------------------------------


def _statements(program: Program, head: str = "return (") -> list[str]:
    """The assignments of a program, its guards first, and what it returns."""
    rows, program = _without_guards(with_short_temporaries(program))
    return [*rows, *write_lines(program, "numba"), *_wrapped(head, program.outputs)]


def _wrapped(head: str, arguments: Iterable[str], tail: str = ")") -> list[str]:
    """A statement with arguments in parentheses, on one line or wrapped; one alone is a tuple."""
    text = ", ".join(arguments)
    text += "," if text and head.endswith(" (") and ", " not in text else ""
    if len(head) + len(text) + len(tail) <= WIDTH:
        return [head + text + tail]
    rows = [INDENT + row for row in wrap(f"{text.rstrip(',')},", WIDTH, break_long_words=False)]
    return [head, *rows, tail]


def _without_guards(program: Program) -> tuple[list[str], Program]:
    """Rows that guard several inputs each, and the program that takes what they give as inputs."""
    guards = dict(_guards(program))
    rows: list[list[str]] = []
    for name in guards:
        row = [*rows[-1], name] if rows else [name]
        fits = len(_guard_row(row, guards)) <= WIDTH - len(INDENT)
        rows = [*rows[:-1], row] if rows and fits else [*rows, [name]]
    left = tuple(line for line in program.lines if line.name not in guards)
    rest = drop_unused(program._replace(inputs=(*program.inputs, *guards), lines=left))
    return [_guard_row(row, guards) for row in rows], rest


def _guard_row(names: Sequence[str], guards: Mapping[str, str]) -> str:
    return f"{', '.join(names)} = {', '.join(guards[name] for name in names)}"


def _guards(program: Program) -> Iterator[tuple[str, str]]:
    """The guarded inputs whose guard is a helper's, each with the call."""
    lines = {line.name: line for line in program.lines}
    nothing = Line("", "", (0.0, 0.0))

    def line_of(argument: Argument) -> Line:
        return lines.get(str(argument), nothing)

    for line in program.lines:
        if line.op != "select" or not line.name.endswith(GUARDED):
            continue
        test = line_of(line.args[0])
        first, second = map(line_of, test.args) if test.op == "and" else (test, nothing)
        size = line_of(first.args[0])
        if first.args[1] == float_info.max and size.op == "abs" and second is nothing:
            yield line.name, f"finite({line.args[1]})"
        elif first.args == (line.args[1], float_info.max) and second.args[1] == line.args[1]:
            yield line.name, f"at_least({second.args[0]!r}, {line.args[1]})"


class SharedEnd:
    """The named lines that two forms compute in the same way, and on which no other line depends.

    `status` is one of them: what makes it 4 cannot be where margins are wide.
    """

    def __init__(self, plain: Program, stable: Program, status: str) -> None:
        self.stable, known = stable, {line.name for line in stable.lines}
        guarded = known - {line.name for line in plain.lines}
        # A design of wide margins has good lengths: they need no guard.
        self.bare = {f"{n}{GUARDED}": n for n in plain.inputs if f"{n}{GUARDED}" in guarded}
        numbers: dict[tuple[object, ...], int] = {}
        of_plain = _values(plain, {n: good for good, n in self.bare.items()}, numbers)
        of_stable = _values(stable, {}, numbers)
        same = {
            n for n, (k, _) in of_stable.items() if n in of_plain and (of_plain[n][0] == k or n == status)
        }
        every = [*of_plain.items(), *of_stable.items()]
        while used := same & {leaf for n, (_, leaves) in every if n not in same for leaf in leaves}:
            same -= used
        lines = tuple(line for line in stable.lines if line.name in same or line.name not in of_stable)
        heads = tuple(name for name in of_stable if name not in same)
        self.rest = drop_unused(stable._replace(inputs=(*stable.inputs, *heads), lines=lines))
        self.pays = len(same) >= SHARED

    def head(self, program: Program) -> Program:
        """The lines of a form that the rest needs."""
        names = {} if program is self.stable else self.bare
        return keep_outputs(program, [names.get(name, name) for name in self.rest.inputs])


def _values(
    program: Program, aliases: Mapping[str, str], numbers: dict[tuple[object, ...], int]
) -> dict[str, tuple[int, frozenset[str]]]:
    """Named lines, each with a number for its operations down to other names, and these names."""
    named, values = {*program.notes, *program.outputs}, dict[str, tuple[int, frozenset[str]]]()
    for line in program.lines:
        parts: list[object] = [line.op]
        leaves = frozenset[str]()
        for argument in line.args:
            if isinstance(argument, str) and argument in values and argument not in named:
                parts.append(values[argument][0])
                leaves |= values[argument][1]
            else:
                parts.append(aliases.get(str(argument), str(argument)))
                leaves |= {aliases.get(name, name) for name in names_in([argument])}
        values[line.name] = numbers.setdefault(tuple(parts), len(numbers)), leaves
    return {name: value for name, value in values.items() if name in named}


# ---- a module ---------------------------------------------------------------------------------------


def curve_text(module: Module, name: str, indices: Sequence[int]) -> list[str]:
    """`curve_<name>` of an angle, its sine and cosine, and a design, and `search_<name>` for many designs.

    indices   of the value, its derivative with respect to the angle and further derivatives in what formulas
    give

    They call what `peak_steps.py` of the scenes' exports has.
    """
    writer, angle = Writer(module), module.angle
    turns = [f"sin_{angle}", f"cos_{angle}"]
    design = [one for one in writer.inputs if one != angle]
    inputs = [f"designs[{design.index(n)}, i]" if n in design else n for n in writer.inputs]
    values = ", ".join([*inputs, *(turns if writer.angle else ()), "1.0"])
    curve = [f"values = stable({values})", *_wrapped("return (", [f"values[{k}]" for k in indices])]
    names = ["kind", "nodes", "turns", "designs", "first", "last", "angles"]
    targets = ", ".join(f"out[{k}, i]" for k in range(len(indices)))
    search = [
        f"search(curve_{name}, {', '.join(names)})",
        "for i in range(first, last):",
        f"{INDENT}{targets} = curve_{name}(angles[i], *sin_cos(angles[i]), designs, i)",
    ]
    return [
        "@inlined\n" + function_text(f"curve_{name}", [angle, *turns, "designs", "i"], curve),
        "@compiled\n" + function_text(f"search_{name}", [*names, "out"], search),
    ]


class Writer:
    """Writes the texts of a module."""

    def __init__(self, module: Module) -> None:
        self.module, forms = module, module.forms
        self.count = len(module.outputs)  # what formulas give besides is for other functions
        self.names = [symbol.name for symbol in module.inputs]  # that people give
        self.inputs = [*self.names, *module.fixed]  # of the formulas
        self.branch = ["branch"] if "branch" in forms.stable.inputs else []
        indices = [k for k in range(len(forms.stable.outputs)) if k != forms.status or k < self.count]
        self.status = forms.stable.outputs[forms.status] if forms.status >= 0 else ""
        two = forms.plain is not None and forms.test is not None
        programs = {"plain": forms.plain, "stable": forms.stable} if two else {"stable": forms.stable}
        lifts = {
            name: lifted(self.rounded(keep_outputs(one, [one.outputs[k] for k in indices])), [module.angle])
            for name, one in programs.items()
            if one is not None
        }
        self.forms = {"has_wide_margins": self.rounded(forms.test)} if two and forms.test else {}
        self.forms |= {name: form.program for name, form in lifts.items()}
        self.angle = module.angle if any(form.turns for form in lifts.values()) else None
        turns = [f"sin_{self.angle}", f"cos_{self.angle}"] if self.angle else []
        self.parameters = [*self.inputs, *turns, "branch"]

    def rounded(self, program: Program) -> Program:
        """The program with fused products, where they may be."""
        return program if self.module.forms.rounded else guarded_for_loops(program, (), Limits({}), None)

    def texts(self) -> list[str]:
        """All texts."""
        module = self.module
        symbols = (*module.inputs, *module.outputs)
        tables = [
            "\n".join([f"{name} = array([", *(INDENT + row for row in numbers(column)), "])"])
            for name, column in arrays_of(module.tables).items()
        ]
        constants = [
            *_wrapped("INPUTS = (", map(quoted, self.names)),
            *_wrapped("OUTPUTS = results(", (quoted(symbol.name) for symbol in module.outputs)),
            *_wrapped("UNITS = units(INPUTS, OUTPUTS, ", (quoted(one.unit) for one in symbols)),
            *tables,
        ]
        return [
            "\n".join(constants),
            *self.formulas(),
            self.point(),
            *(self.function(k, symbol) for k, symbol in enumerate(module.outputs) if module.functions),
            *(self.arrays() if self.names else [_WITHOUT_INPUTS]),
        ]

    def formulas(self) -> list[str]:
        """The forms of the formulas, and the test of a design, as functions."""
        forms, parameters = self.forms, dict.fromkeys(self.forms, self.parameters)
        call, texts = "return (", []
        if "plain" in forms:
            end = SharedEnd(forms["plain"], forms["stable"], self.status)
            test = [name for name in self.parameters if name in forms["has_wide_margins"].inputs]
            first = 1 + max(map(self.parameters.index, test), default=-1)
            parameters["has_wide_margins"] = [*self.parameters[:first], "*_"]
            if end.pays:
                forms = {
                    name: end.head(one) if name in ("plain", "stable") else one for name, one in forms.items()
                }
                parameters["rest"] = [*end.rest.inputs]
                texts = [_function("rest", parameters["rest"], _statements(end.rest))]
                call = "return rest("
        for name, one in forms.items():
            is_test = name == "has_wide_margins"
            rows = _statements(one, "return (" if is_test else call)
            if is_test:
                rows[-1] = f"return {one.outputs[0]}"
            texts.append(_function(name, parameters[name], rows))
        return texts

    def signature(self) -> list[str]:
        """The parameters that people give."""
        defaults = {**self.module.defaults, **dict.fromkeys(self.module.centres, "None")}
        names = [f"{n}={defaults[n]}" if n in defaults else n for n in self.names]
        return [*names, *(f"{name}=1.0" for name in self.branch)]

    @property
    def in_forms(self) -> str:
        """The forms, as arguments."""
        return "has_wide_margins, plain, stable" if "plain" in self.forms else "None, None, stable"

    def point(self) -> str:
        """The function of numbers."""
        what, centres = self.module.what, self.module.centres
        values = {n: repr(value) for n, value in self.module.fixed.items()} | {n: f"{n}_" for n in centres}
        inputs = [values.get(name, name) for name in self.parameters]
        body = [f'"""{what[0].upper()}{what[1:]} at a point, for your own @njit functions, too."""']
        body += [f"{n}_ = 0.5 * {link} if {n} is None else {n}" for n, link in centres.items()]
        if self.angle:
            turns = f"sin_{self.angle}, cos_{self.angle}"
            body.append(f"{turns} = sin_cos({values.get(self.angle, self.angle)})")
        if not self.branch:
            inputs[-1] = "1.0"
        some = "" if self.count == len(self.forms["stable"].outputs) else f"[:{self.count}]"
        body += _wrapped("inputs = (", inputs)
        if "plain" in self.forms:
            body += ["if has_wide_margins(*inputs):", f"{INDENT}return plain(*inputs){some}"]
        return "@compiled\n" + function_text(
            "point", self.signature(), [*body, f"return stable(*inputs){some}"]
        )

    def function(self, index: int, symbol: Symbol) -> str:
        """The function of one output."""
        taken = self.module.taken(symbol.name)
        meaning = one_line(symbol.meaning or symbol.name)  # a quantity of a user may come without
        passed = ", ".join(name if name in taken else "nan" for name in self.names)
        about = f'"""{meaning[0].upper()}{meaning[1:]} [{symbol.unit}]."""'
        return "@compiled\n" + function_text(symbol.name, taken, [about, f"return point({passed})[{index}]"])

    def arrays(self) -> list[str]:
        """The functions of arrays."""
        angle = self.inputs.index(self.angle) if self.angle else 0
        arguments = ["columns", "turns", "first", "last", "length", "branch", "targets"]
        passed = ["fill", "point", "OUTPUTS", "INPUTS"]
        passed += [f'"{self.angle}"'] if self.angle else []
        passed += [f"halves={quoted(dict(self.module.centres))}"] if self.module.centres else []
        passed += ["fixed=FIXED"] if self.module.fixed else []
        # Of twice the digits LLVM would duplicate what a row shares.
        passed += ["rows=False"] if self.module.forms.rounded else []
        fill = [f"fill_rows({self.in_forms}, columns[{angle}], {', '.join(arguments)})"]
        front = "\n".join(_wrapped("evaluate, grid = functions_of_arrays(", passed))
        fixed = [f"FIXED = {quoted(dict(self.module.fixed))}"] if self.module.fixed else []
        return ["@compiled\n" + function_text("fill", arguments, fill), "\n".join([*fixed, front])]


def _function(name: str, parameters: Sequence[str], rows: Sequence[str]) -> str:
    return "@inlined\n" + function_text(name, parameters, [f'"""{FORMULAS[name]}"""', *rows])


_WITHOUT_INPUTS = '''def evaluate():
    """The values; every input is fixed."""
    return dict(zip(OUTPUTS, point(), strict=True))
'''
