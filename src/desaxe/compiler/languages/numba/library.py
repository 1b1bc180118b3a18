"""A numba module that people import and keep: `point` of numbers, `evaluate` of arrays, `grid` of axes.

The formulas stand in it once, in straight lines, as functions that are inlined: `plain` where margins are
wide, `stable` anywhere, or `stable` alone. Arrays and grids run them over blocks of points, in loops
without branches, which stand in the helpers (sources/front.py).

Rules that numba's issue tracker teaches: every option is a literal and every helper stands in the module, or
in the one file beside it (its cache does not see changes elsewhere); ``error_model="numpy"``, so that a
division by zero is an infinity; no fast-math flag, which would erase the NaN of an infeasible point;
``nogil=True``, so that threads can share the blocks of an array.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from textwrap import wrap

from ...builder import (
    HELPERS,
    MATH,
    Parts,
    function_text,
    module_text,
    quoted,
    with_sources,
    words_of,
)
from ...lowering import Limits, guarded_for_loops
from ...passes.slicing import keep_outputs
from ...passes.trigonometry import Trigonometry
from ...program import Line, Program
from ...text import INDENT, WIDTH, with_short_temporaries, write_lines
from ..lifted import lifted
from ..protocol import Module, Symbol
from ..shared import arrays_of, numbers, one_line

SOURCES = Path(__file__).with_name("sources")
FRONT, SPELLINGS = SOURCES / "front.py", SOURCES / "spellings.py"
HELPER_FILE = "_helpers"
# Where the names come from that stand in the text of Programs and loops.
IMPORTS = MATH | {
    "array": "numpy", "empty": "numpy", "float64": "numpy",
    "floor": "numpy",  # math.floor gives an integer: no vectors
    "int8": "numpy", "int64": "numpy", "njit": "numba", "types": "numba", "uint64": "numpy",
}  # fmt: skip
FORMULAS = {
    "has_wide_margins": "Whether the shorter formulas hold for a design.",
    "plain": "The values of a point with wide margins.",
    "stable": "The values of any point.",
}
_SINES = '''@inlined
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


# ---- files -----------------------------------------------------------------------------------------


def emit_folder(
    modules: Mapping[str, tuple[Module, str]], banner: str, constants: Trigonometry
) -> dict[str, str]:
    """The texts of modules, each with its docstring, by file, and of the file of helpers that they call."""
    texts = {name: _Writer(module).texts() for name, (module, _) in modules.items()}
    helpers = _helpers([text for own in texts.values() for text in own], constants)
    beside = dict.fromkeys((name for text in helpers.texts for name in _defined(text)), f".{HELPER_FILE}")
    files = {HELPER_FILE: module_text(banner, helpers)}
    for name, (_, docstring) in modules.items():
        files[name] = module_text(docstring, _parts(texts[name], IMPORTS | beside))
    return files


def emit_alone(module: Module, docstring: str) -> str:
    """The text of a module that needs no other file."""
    texts = _Writer(module).texts()
    more = [module.more] if module.more else []
    behind = [*texts, *(text for part in more for text in part.texts)]
    return module_text(docstring, _helpers(behind, module.constants), _parts(texts, IMPORTS), *more)


def _parts(texts: Sequence[str], imports: Mapping[str, str]) -> Parts:
    return Parts(tuple(texts), frozenset[str]().union(*map(words_of, texts)), imports)


def _helpers(texts: Sequence[str], constants: Trigonometry) -> Parts:
    """Select the helpers that texts call: decorators and loops first, sines last."""
    behind = [*texts, sines := _sines(constants)]
    front = with_sources([*behind, _INNER], [FRONT], imports=IMPORTS)
    every = with_sources(front.texts, [SPELLINGS, HELPERS], "@inner\n", front.imports)
    loops = [text for text in front.texts if text not in (*behind, _INNER)]
    called = [text for text in every.texts if text not in front.texts]
    return _parts([*loops, *called, sines], every.imports)


_INNER = "@inner"  # the decorator of what is called


def _defined(text: str) -> Iterable[str]:
    """The names that a text defines at its top."""
    rows = [row for row in text.splitlines() if row[:1].isalpha() or row[:1] == "_"]
    for row in rows:
        head = row.removeprefix("def ")
        yield from head.partition("(")[0].split(", ") if head != row else head.partition(" = ")[0].split(", ")


def _sines(constants: Trigonometry) -> str:
    """The functions of an angle, by polynomials and beyond their reach by libm."""
    lines = (Line("sine", "sin", ("angle",)), Line("cosine", "cos", ("angle",)))
    program = Program(("angle",), lines, ("sine", "cosine"), {})
    guarded = guarded_for_loops(program, ["angle"], Limits({}, {"angle": constants.limit}), constants)
    about = '"""Sine and cosine by polynomials; NaN beyond what their reduction holds for."""'
    near = "@inlined\n" + function_text("near_sin_cos", ["angle"], [about, *_statements(guarded)])
    return near + "\n\n" + _SINES.replace("LIMIT", repr(constants.limit))


# ---- a module ---------------------------------------------------------------------------------------


def grid_text(module: Module, inputs: str) -> str:
    """The call that computes the outer product of inputs, a dict in the order of dimensions."""
    return _Writer(module).grid(inputs)


def curve_text(module: Module, name: str, indices: Sequence[int]) -> list[str]:
    """`curve_<name>` of an angle, its sine and cosine, and a design, and `search_<name>` for many designs.

    indices   of the value, its derivative by the angle and further derivatives in what formulas give

    They call what `peak_steps.py` of the scenes' exports has.
    """
    writer = _Writer(module)
    turns = [f"sin_{module.angle}", f"cos_{module.angle}"]
    design = [one for one in writer.inputs if one != module.angle]
    body = [
        f"values = stable({', '.join([*writer.inputs, *(turns if writer.angle else ()), '1.0'])})",
        *_wrapped("return (", [f"values[{k}]" for k in indices]),
    ]
    search = ["kind", "nodes", "turns", "designs", "first", "last", "angles", "out"]
    return [
        "@inlined\n" + function_text(f"curve_{name}", [module.angle, *turns, *design], body),
        "@compiled\n"
        + function_text(f"search_{name}", search, [f"search(curve_{name}, {', '.join(search)})"]),
    ]


def _statements(program: Program) -> list[str]:
    program = with_short_temporaries(program)
    return [*write_lines(program, "numba"), *_wrapped("return (", program.outputs)]


def _wrapped(head: str, arguments: Iterable[str], tail: str = ")") -> list[str]:
    """A statement with arguments in parentheses, on one line or wrapped; one alone is a tuple."""
    text = ", ".join(arguments)
    text += "," if head == "return (" and ", " not in text else ""
    if len(head) + len(text) + len(tail) <= WIDTH:
        return [head + text + tail]
    rows = [INDENT + row for row in wrap(f"{text.rstrip(',')},", WIDTH, break_long_words=False)]
    return [head, *rows, tail]


class _Writer:
    """Writes the texts of a module."""

    def __init__(self, module: Module) -> None:
        self.module, forms = module, module.forms
        self.count = len(module.outputs)  # what formulas give besides is for other functions
        self.names = [symbol.name for symbol in module.inputs]  # that people give
        self.inputs = [*self.names, *module.fixed]  # of the formulas
        self.branch = ["branch"] if "branch" in forms.stable.inputs else []
        indices = [k for k in range(len(forms.stable.outputs)) if k != forms.status or k < self.count]
        two = forms.plain is not None and forms.test is not None
        programs = {"plain": forms.plain, "stable": forms.stable} if two else {"stable": forms.stable}
        lifts = {
            name: lifted(keep_outputs(program, [program.outputs[k] for k in indices]), [module.angle])
            for name, program in programs.items()
            if program is not None
        }
        self.forms = {"has_wide_margins": forms.test} if two and forms.test else {}
        self.forms |= {name: form.program for name, form in lifts.items()}
        self.angle = module.angle if any(form.turns for form in lifts.values()) else None
        turns = [f"sin_{self.angle}", f"cos_{self.angle}"] if self.angle else []
        self.parameters = [*self.inputs, *turns, "branch"]

    def texts(self) -> list[str]:
        """All texts."""
        module = self.module
        units = [f'"{s.name}": "{s.unit}"' for s in (*module.inputs, *module.outputs)]
        tables = [
            "\n".join([f"{name} = array([", *(INDENT + row for row in numbers(column)), "])"])
            for name, column in arrays_of(module.tables).items()
        ]
        constants = [
            f"INPUTS = {quoted(tuple(self.names))}",
            *_wrapped("OUTPUTS = results(", (f'"{symbol.name}"' for symbol in module.outputs)),
            *_wrapped("UNITS = {", units, "}"),
            *([f"HALVES = {quoted(dict(module.centres))}"] if module.centres else []),
            *([f"FIXED = {quoted(dict(module.fixed))}"] if module.fixed else []),
            *tables,
        ]
        return [
            "\n".join(constants),
            *(self.formulas(name, program) for name, program in self.forms.items()),
            self.point(),
            *(self.function(k, symbol) for k, symbol in enumerate(module.outputs) if module.functions),
            *(self.arrays() if self.names else [_WITHOUT_INPUTS]),
        ]

    def formulas(self, name: str, program: Program) -> str:
        """One form of the formulas, or the test of a design, as a function."""
        if not self.module.forms.rounded:
            program = guarded_for_loops(program, (), Limits({}), None)
        rows = _statements(program)
        rows[-1] = f"return {program.outputs[0]}" if name == "has_wide_margins" else rows[-1]
        return "@inlined\n" + function_text(name, self.parameters, [f'"""{FORMULAS[name]}"""', *rows])

    def signature(self) -> list[str]:
        """The parameters that people give."""
        defaults = {**self.module.defaults, **dict.fromkeys(self.module.centres, "None")}
        names = [f"{n}={defaults[n]}" if n in defaults else n for n in self.names]
        return [*names, *(f"{name}=1.0" for name in self.branch)]

    def what(self, how: str) -> list[str]:
        """The docstring of a function."""
        what = self.module.what
        return [f'"""{what[0].upper()}{what[1:]}{how}."""']

    def point(self) -> str:
        """The function of numbers."""
        centres = self.module.centres
        given = {n: repr(value) for n, value in self.module.fixed.items()}
        given |= {n: f"{n}_taken" for n in centres} | ({} if self.branch else {"branch": "1.0"})
        values = [given.get(n, n) for n in self.parameters]
        body = [*self.what(" at a point, for your own @njit functions, too")]
        body += [f"{n}_taken = 0.5 * {link} if {n} is None else {n}" for n, link in centres.items()]
        if self.angle:
            pair = f"sin_{self.angle}, cos_{self.angle}"
            body.append(f"{pair} = sin_cos({given.get(self.angle, self.angle)})")
        if "plain" in self.forms:
            body += [*_wrapped("if has_wide_margins(", values, "):")]
            body += [INDENT + row for row in self.returned("plain", values)]
        return "@compiled\n" + function_text(
            "point", self.signature(), [*body, *self.returned("stable", values)]
        )

    def returned(self, name: str, values: Sequence[str]) -> list[str]:
        """The lines that return the results of a form."""
        every = self.count == len(self.forms[name].outputs)
        return _wrapped(f"return {name}(", values, ")" if every else f")[:{self.count}]")

    def function(self, index: int, symbol: Symbol) -> str:
        """The function of one output."""
        taken = self.module.taken(symbol.name)
        meaning = one_line(symbol.meaning or symbol.name)  # a quantity of a user may come without
        passed = ", ".join(name if name in taken else "nan" for name in self.names)
        about = f'"""{meaning[0].upper()}{meaning[1:]} [{symbol.unit}]."""'
        return "@compiled\n" + function_text(symbol.name, taken, [about, f"return point({passed})[{index}]"])

    # -- arrays --

    def arrays(self) -> list[str]:
        """The functions of arrays."""
        forms = "has_wide_margins, plain, stable" if "plain" in self.forms else "None, None, stable"
        angle = self.inputs.index(self.angle) if self.angle else None
        points = ["columns", "first", "last", "branch", "targets"]
        rows = ["columns", "first", "last", "length", "branch", "targets"]
        inputs = "{**locals(), **FIXED}" if self.module.fixed else "locals()"
        signature = [*self.signature(), "out=None", "threads=None"]
        broadcasts = " by name: inputs broadcast like NumPy's; numbers give numbers"
        dimensions = " by name: one dimension for each input of one dimension, in the order of inputs"
        fill = [f"fill_points({forms}, {angle}, {', '.join(points)})"]
        fill_rows = [f"fill_grid({forms}, {', '.join(rows)})"]
        evaluate = [*self.what(broadcasts), f"return broadcast(fill, {self.passed(inputs)})"]
        return [
            "@compiled\n" + function_text("fill", points, fill),
            *([] if self.as_points else ["@compiled\n" + function_text("fill_rows", rows, fill_rows)]),
            function_text("evaluate", signature, evaluate),
            function_text("grid", signature, [*self.what(dimensions), f"return {self.grid(inputs)}"]),
        ]

    @property
    def as_points(self) -> bool:
        """True if a grid runs as points: of twice the digits LLVM would duplicate what a row shares."""
        return self.module.forms.rounded

    def passed(self, inputs: str) -> str:
        """The arguments of a call that fills arrays."""
        names = "(*INPUTS, *FIXED)" if self.module.fixed else "INPUTS"
        return f"{names}, OUTPUTS, {inputs}" + ", HALVES" * bool(self.module.centres)

    def grid(self, inputs: str) -> str:
        """The call that computes the outer product of some inputs, a dict with `threads`."""
        if self.as_points:
            return f"broadcast(fill, {self.passed(f'{{**{inputs}, **meshed({inputs}, INPUTS)[1]}}')})"
        angle = f'"{self.angle}"' if self.angle else None
        return f"outer(fill_rows, {angle}, {self.passed(inputs)})"


_WITHOUT_INPUTS = '''def evaluate():
    """The values; every input is fixed."""
    return dict(zip(OUTPUTS, point(), strict=True))
'''
