"""The header and the source of a module in C99."""

from collections.abc import Iterable, Mapping

from ....support.template import filled
from ...operations import Content
from ...passes.trigonometry import Trigonometry, expand_trigonometry
from ...passes.value_numbering import value_numbering
from ...program import Line, Program
from ..lifted import Lifted, lifted
from ..protocol import Language, Module, Solver, Symbol
from ..shared import arrays_of, called, numbers, one_line, with_helpers
from .functions import static_function
from .helpers import CPLUSPLUS, HELPERS, PRAGMAS
from .steps import HEADER, step_texts

STRIP = 128  # points of an array whose sines are computed ahead, on the stack


class C(Language):
    """C99, called by one point or by arrays; see the package."""

    name = "c"
    suffix = ".c"
    about = "FOLDER/name.h and name.c, C99, named as the folder"

    def files(self, module: Module) -> dict[str, str]:
        """`name.h` and `name.c`."""
        return {f"{module.name}.h": _header(module), f"{module.name}.c": _Source(module).text()}


# ---- the header ----------------------------------------------------------------------------------


def _header(module: Module) -> str:
    name = module.name
    guard = f"{name.upper()}_H"
    listed = [
        *_table("in", module.inputs),
        *_table("out", module.outputs),
    ]
    functions = [
        "/* One point; returns its status. */",
        f"int {name}_point(const double in[], double out[]);",
        "",
        "/* n points: in[k] and out[k] are arrays. What is written shares no memory with anything else. */",
        f"void {name}_array(size_t n, const double *const in[], double *const out[]);",
    ]
    for solver, given in module.solvers.items():
        functions += ["", *SOLVER_TEXTS[solver].format(name=name).splitlines()]
        functions.append(f"{_signature(name, solver, given)};")
    if module.motion is not None:
        functions += ["", *filled(HEADER, NAME=name).rstrip().splitlines()]
    tables = [
        "/* Names and SI units, in order; NULL at the end. */",
        *(f"extern const char *const {name}_{table}[];" for table in _tables(module)),
    ]
    return "\n".join(
        [
            comment([*module.head, "", *listed]),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            "#include <stddef.h>",
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            *functions,
            "",
            *tables,
            "",
            "#ifdef __cplusplus",
            "}",
            "#endif",
            "",
            "#endif",
            "",
        ]
    )


SOLVER_TEXTS = {
    "inverse": """\
/* The crank angles theta[0] <= theta[1] in (-pi, pi] that put the slider at Y, NaN where there is none, and
   the crank's speed and acceleration there for the slider's V_C and a_C (NaN at a dead centre). Of in[], laid
   out as for {name}_point, only the lengths are read. Status: 0 one or two angles, 1 none, 2 dead centre,
   4 bad input. */""",
    "limits": """\
/* The crank angles at which the mechanism can be assembled, from angles[0] to angles[1] and from angles[2] to
   angles[3], NaN where there is no such interval; one that crosses 2 pi goes on beyond it. Of in[] only the
   lengths are read. Status: 0 the crank turns fully, 1 it does not, 2 change point, 4 bad input. */""",
}


def _signature(name: str, solver: str, given: Solver) -> str:
    arguments = "".join(f"double {symbol.name}, " for symbol in given.arguments)
    if given.slopes is None:
        return f"int {name}_{solver}({arguments}const double in[], double angles[4])"
    return (
        f"int {name}_{solver}(double Y, double V_C, double a_C, const double in[],\n"
        f"{' ' * len(f'int {name}_{solver}(')}double theta[2], double omega[2], double alpha[2])"
    )


def _tables(module: Module) -> dict[str, list[str]]:
    return {
        "inputs": [symbol.name for symbol in module.inputs],
        "input_units": [symbol.unit for symbol in module.inputs],
        "outputs": [symbol.name for symbol in module.outputs],
        "output_units": [symbol.unit for symbol in module.outputs],
    }


def _table(array: str, symbols: Iterable[Symbol]) -> list[str]:
    """Comment lines that name each index of in[] and out[]."""
    return [
        f"  {array}[{index}]  {symbol.name} [{symbol.unit}]: {symbol.meaning}"
        + (f" ({symbol.source})" if symbol.source else "")
        for index, symbol in enumerate(symbols)
    ]


def comment(lines: Iterable[str]) -> str:
    """A comment of these lines."""

    def row(line: str) -> str:
        indent = line[: len(line) - len(line.lstrip())]
        return f" * {indent}{one_line(line)}".rstrip()

    return "\n".join(["/*", *map(row, lines), " */"])


# ---- the source ----------------------------------------------------------------------------------


class _Source:
    """Writes the parts of the source and puts them together."""

    def __init__(self, module: Module) -> None:
        self.module = module
        forms = module.forms
        self.stable = lifted(forms.stable)
        self.plain = lifted(forms.plain) if forms.plain else None
        self.test = forms.test if forms.plain and forms.test else None
        turning = {**self.stable.turns, **(self.plain.turns if self.plain else {})}
        self.turns = {a: pair for a, pair in turning.items() if a in self.names}
        self.solvers = {
            name: (solver, lifted(solver.slopes) if solver.slopes else None)
            for name, solver in module.solvers.items()
        }

    @property
    def names(self) -> list[str]:
        """The arguments, in order."""
        return [symbol.name for symbol in self.module.inputs]

    def text(self) -> str:
        """The text of the whole file."""
        name, motion = self.module.name, self.module.motion
        steps = [] if motion is None else step_texts(name, motion, self.names)
        functions = "\n".join([*self._forms(), self._point(), self._array(), *self._solvers(), *steps])
        tables = [
            f"const char *const {name}_{table}[] = {{{', '.join([*map(quoted, texts), 'NULL'])}}};"
            for table, texts in _tables(self.module).items()
        ]
        return "\n".join(
            [
                comment(self.module.head),
                f'#include "{name}.h"',
                "#include <math.h>",
                *(["#include <stdint.h>"] if self.module.tables else []),
                "",
                CPLUSPLUS,
                PRAGMAS,
                *self._helpers(functions),
                *tables_text(self.module.tables),
                functions,
                *tables,
                "",
            ]
        )

    # -- what is called --

    def _helpers(self, functions: str) -> list[str]:
        angles = [sine_and_cosine(self.module.constants)] if called(functions, ["sin_cos"]) else []
        return [*with_helpers("\n".join([*angles, functions]), HELPERS), *angles]

    # -- the forms --

    def _forms(self) -> list[str]:
        stable = "the form for designs near a change point; right everywhere" if self.plain else ""
        given, count, status = self._arguments(), len(self.module.outputs), self.module.forms.status
        found = [static_function("stable", self.stable.program, given, count, status, stable)]
        if self.plain and self.test:
            plain = "the form for designs with wide margins, in which nothing cancels"
            found.append(static_function("plain", self.plain.program, given, count, status, plain))
            found.append(static_function("has_wide_margins", self.test, self.test.inputs, 0, 0))
        return found

    def _arguments(self) -> list[str]:
        pairs = [name for pair in self.turns.values() for name in pair]
        return self.names + pairs

    def _point(self) -> str:
        inputs = [f"in[{index}]" for index in range(len(self.names))]
        lines = ["(void)in;"] if not self.names else []
        pairs = []
        for angle in self.turns:
            lines += [f"double turn_{angle}[2];", f"sin_cos(in[{self.names.index(angle)}], turn_{angle});"]
            pairs += [f"turn_{angle}[0]", f"turn_{angle}[1]"]
        out = ["out"] if self.module.outputs else []
        given = ", ".join([*inputs, *pairs, *out])
        if self.plain and self.test:
            test = ", ".join(f"in[{self.names.index(name)}]" for name in self.test.inputs)
            lines += [f"if (has_wide_margins({test})) {{", f"  return plain({given});", "}"]
        lines.append(f"return stable({given});")
        head = f"int {self.module.name}_point(const double in[], double out[]) {{"
        return "\n".join([head, *(f"  {line}" for line in lines), "}"]) + "\n"

    def _array(self) -> str:
        """Strips of an array: sines ahead, then one loop in the form that the strip's designs share."""
        name = self.module.name
        rows = [f"void {name}_array(size_t n, const double *const in[], double *const out[]) {{"]
        rows += ["  (void)in;"] if not self.names else []
        rows += [
            f"  for (size_t start = 0; start < n; start += {STRIP}) {{",
            f"    const size_t count = n - start < {STRIP} ? n - start : {STRIP};",
        ]
        strips = [f"in_{index}" for index in range(len(self.names))]
        rows += [f"    const double *restrict {s} = in[{index}] + start;" for index, s in enumerate(strips)]
        results = [f"out_{index}" for index in range(len(self.module.outputs))]
        rows += [f"    double *restrict {s} = out[{index}] + start;" for index, s in enumerate(results)]
        pairs = []
        for number, angle in enumerate(self.turns):
            pairs += [f"sines_{number}[k]", f"cosines_{number}[k]"]
            rows += _turning(number, f"in_{self.names.index(angle)}", repr(self.module.constants.limit))
        given = ", ".join([*(f"{s}[k]" for s in strips), *pairs])
        if self.plain and self.test:
            test = ", ".join(f"in_{self.names.index(n)}[k]" for n in self.test.inputs)
            rows += [
                "    size_t wide = 0;",
                "    for (size_t k = 0; k < count; k++) {",
                f"      wide += (size_t)has_wide_margins({test});",
                "    }",
                "    if (wide == count) {",
                *_loop("plain({})", given, results, 6),
                "    } else if (wide == 0) {",
                *_loop("stable({})", given, results, 6),
                "    } else {",
                *_loop(f"has_wide_margins({test}) ? plain({{}}) : stable({{}})", given, results, 6),
                "    }",
            ]
        else:
            rows += _loop("stable({})", given, results, 4)
        return "\n".join([*rows, "  }", "}"]) + "\n"

    # -- further functions --

    def _solvers(self) -> list[str]:
        found = []
        for name, (solver, slopes) in self.solvers.items():
            arguments = [*(s.name for s in solver.arguments), *self.names]
            solve = f"{name}_angles"
            own = [a for a in arguments if a in solver.solve.inputs]
            results = len(solver.solve.outputs) - 1  # and the status
            found.append(static_function(solve, solver.solve, own, results, results))
            given = self._given(solver.solve, solver)
            head = f"{_signature(self.module.name, name, solver)} {{"
            if slopes is None:
                lines = [f"return {solve}({', '.join([*given, 'angles'])});"]
            else:
                found.append(self._slopes(name, slopes))
                lines = self._rates(name, solve, given, slopes)
            lines = lines if "in[" in "".join(lines) else ["(void)in;", *lines]
            found.append("\n".join([head, *(f"  {line}" for line in lines), "}"]) + "\n")
        return found

    def _given(self, program: Program, solver: Solver) -> list[str]:
        own = [symbol.name for symbol in solver.arguments]
        order = [name for name in (*own, *self.names) if name in program.inputs]
        return [name if name in own else f"in[{self.names.index(name)}]" for name in order]

    def _slopes(self, name: str, slopes: Lifted) -> str:
        count = len(slopes.program.outputs)
        return static_function(f"{name}_slopes", slopes.program, slopes.program.inputs, count, None)

    def _rates(self, name: str, solve: str, given: list[str], slopes: Lifted) -> list[str]:
        angle, pair = next(iter(slopes.turns.items()))
        words = {angle: "theta[k]", pair[0]: "turn[0]", pair[1]: "turn[1]"}
        arguments = [words.get(n) or f"in[{self.names.index(n)}]" for n in slopes.program.inputs]
        return [
            f"const int status = {solve}({', '.join([*given, angle])});",
            "for (int k = 0; k < 2; k++) {",
            "  double turn[2], slope[2];",
            "  sin_cos(theta[k], turn);",
            f"  {name}_slopes({', '.join([*arguments, 'slope'])});",
            "  const double along = status == 2 ? (double)NAN : slope[0];",
            "  omega[k] = V_C / along;",
            "  alpha[k] = (a_C - omega[k] * omega[k] * slope[1]) / along;",
            "}",
            "return status;",
        ]


def _turning(number: int, strip: str, limit: str) -> list[str]:
    return [
        f"    double sines_{number}[{STRIP}], cosines_{number}[{STRIP}];",
        f"    int far_{number} = 0;",
        "    for (size_t k = 0; k < count; k++) {",
        f"      far_{number} |= !(fabs({strip}[k]) <= {limit});",
        "    }",
        "    for (size_t k = 0; k < count; k++) {",
        "      double turn[2];",
        f"      near_sin_cos({strip}[k], turn);",
        f"      sines_{number}[k] = turn[0];",
        f"      cosines_{number}[k] = turn[1];",
        "    }",
        f"    for (size_t k = 0; far_{number} && k < count; k++) {{",
        "      double turn[2];",
        f"      sin_cos({strip}[k], turn);",
        f"      sines_{number}[k] = turn[0];",
        f"      cosines_{number}[k] = turn[1];",
        "    }",
    ]


def _loop(call: str, given: str, results: list[str], indent: int) -> list[str]:
    """One loop over a strip: call a function and store its results."""
    pad = " " * indent
    values = [f"double value[{len(results)}];"] if results else []
    value = "value" if results else ""
    whole = call.replace("{}", ", ".join([part for part in (given, value) if part]))
    return [
        f"{pad}for (size_t k = 0; k < count; k++) {{",
        *(f"{pad}  {row}" for row in values),
        f"{pad}  (void)({whole});",
        *(f"{pad}  {result}[k] = value[{index}];" for index, result in enumerate(results)),
        f"{pad}}}",
    ]


def tables_text(tables: Mapping[str, Content]) -> list[str]:
    """The content of the tables that are looked into."""
    rows = []
    for name, column in arrays_of(tables).items():
        rows += [f"static const double {name}[] = {{", *(f"  {row}" for row in numbers(column)), "};"]
    rows += [f"static const int64_t {name}_n = {len(knots)};" for name, (knots, _) in tables.items()]
    return [*rows, *([""] if rows else [])]


def sine_and_cosine(constants: Trigonometry) -> str:
    """`sin_cos(x, out)`, with what it calls, by libm beyond the limit."""
    return f"{_near_sin_cos(constants)}\n{_sin_cos(repr(constants.limit))}"


def _near_sin_cos(constants: Trigonometry) -> str:
    """`near_sin_cos(x, out)`: sine and cosine, written out."""
    lines = (Line("sine", "sin", ("x",)), Line("cosine", "cos", ("x",)))
    program = expand_trigonometry(Program(("x",), lines, ("sine", "cosine"), {}), constants)
    comment = f"sine and cosine by polynomials, for |x| <= {constants.limit!r}"
    return static_function("near_sin_cos", value_numbering(program), ["x"], 2, None, comment)


def _sin_cos(limit: str) -> str:
    """`sin_cos(x, out)`: the same for any angle."""
    return "\n".join(
        [
            "/* The same; beyond the angles that the polynomials' reduction keeps exact, from libm. */",
            "static void sin_cos(double x, double out[]) {",
            f"  if (fabs(x) <= {limit}) {{",
            "    near_sin_cos(x, out);",
            "  } else {",
            "    out[0] = sin(x);",
            "    out[1] = cos(x);",
            "  }",
            "}",
            "",
        ]
    )


def quoted(text: str) -> str:
    """A text as a C string."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
