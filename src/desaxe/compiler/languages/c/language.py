"""The header and the source of a module in C99: texts of `module/`, filled."""

from collections.abc import Iterable, Mapping, Sequence

from ....support.template import file_text, filled
from ...operations import Content
from ...passes.trigonometry import Trigonometry, expand_trigonometry
from ...passes.value_numbering import value_numbering
from ...program import Line, Program
from ..lifted import Lifted, lifted
from ..protocol import Language, Module, Symbol
from ..shared import arrays_of, called, comment, described, numbers, with_helpers
from .functions import static_function
from .helpers import CPLUSPLUS, HELPERS, PRAGMAS
from .steps import HEADER, step_texts

STRIP = 128  # points of an array whose sines are computed ahead, on the stack
STABLE = "the form for designs near a change point; right everywhere"
PLAIN = "the form for designs with wide margins, in which nothing cancels"


class C(Language):
    """C99, called by one point or by arrays; see the package."""

    name = "c"
    suffix = ".c"
    steps = True
    about = "FOLDER/name.h and name.c, C99, named as the folder"

    def files(self, module: Module) -> dict[str, str]:
        """`name.h` and `name.c`."""
        return {f"{module.name}.h": _header(module), f"{module.name}.c": _Source(module).text()}


def _part(name: str, **values: str | Sequence[str]) -> str:
    """A text of `module/`, filled."""
    return filled(file_text(__package__, "module", name), **values)


def _header(module: Module) -> str:
    name = module.name
    functions = [_part(f"{solver}.h", NAME=name) for solver in module.solvers]
    functions += [filled(HEADER, NAME=name)] if module.motion is not None else []
    return _part(
        "header.h",
        NAME=name,
        GUARD=f"{name.upper()}_H",
        COMMENT=comment([*module.head, "", *_table("in", module.inputs), *_table("out", module.outputs)]),
        FUNCTIONS="\n".join(functions).splitlines() + [""] * bool(functions),
    )


def _table(array: str, symbols: Iterable[Symbol]) -> list[str]:
    """Comment lines that name each index of in[] and out[]."""
    return [f"  {array}[{index}]  {described(symbol)}" for index, symbol in enumerate(symbols)]


class _Source:
    """Writes the parts of the source and puts them together."""

    def __init__(self, module: Module) -> None:
        self.module, forms = module, module.forms
        self.names = [symbol.name for symbol in module.inputs]
        self.unused = [] if self.names else ["(void)in;"]
        self.stable = lifted(forms.stable)
        self.plain = lifted(forms.plain) if forms.plain and forms.test else None
        self.test = forms.test if self.plain else None
        turning = {**self.stable.turns, **(self.plain.turns if self.plain else {})}
        self.turns = {a: pair for a, pair in turning.items() if a in self.names}

    def text(self) -> str:
        """The text of the whole file."""
        module = self.module
        name, motion = module.name, module.motion
        steps = [] if motion is None else step_texts(name, motion, self.names)
        functions = "\n".join([*self._forms(), self._point(), self._array(), *self._solvers(), *steps])
        angles = [sine_and_cosine(module.constants)] if called(functions, ["sin_cos"]) else []
        names = {
            "inputs": [symbol.name for symbol in module.inputs],
            "input_units": [symbol.unit for symbol in module.inputs],
            "outputs": [symbol.name for symbol in module.outputs],
            "output_units": [symbol.unit for symbol in module.outputs],
        }
        return "\n".join(
            [
                comment(module.head),
                f'#include "{name}.h"',
                "#include <math.h>",
                *(["#include <stdint.h>"] if module.tables else []),
                "",
                CPLUSPLUS,
                PRAGMAS,
                *with_helpers("\n".join([*angles, functions]), HELPERS),
                *angles,
                *tables_text(module.tables),
                functions,
                *(
                    f"const char *const {name}_{array}[] = {{{', '.join([*map(quoted, texts), 'NULL'])}}};"
                    for array, texts in names.items()
                ),
                "",
            ]
        )

    # -- the forms --

    def _forms(self) -> list[str]:
        arguments = [*self.names, *(name for pair in self.turns.values() for name in pair)]
        count, status = len(self.module.outputs), self.module.forms.status
        stable = STABLE if self.plain else ""
        texts = [static_function("stable", self.stable.program, arguments, count, status, stable)]
        if self.plain and self.test:
            texts.append(static_function("plain", self.plain.program, arguments, count, status, PLAIN))
            texts.append(static_function("has_wide_margins", self.test, self.test.inputs, 0, 0))
        return texts

    def _tested(self, element: str) -> str:
        """The arguments of the test."""
        inputs = self.test.inputs if self.test else ()
        return ", ".join(element.format(self.names.index(name)) for name in inputs)

    def _point(self) -> str:
        turns, pairs = [], []
        for angle in self.turns:
            turns += [f"double turn_{angle}[2];", f"sin_cos(in[{self.names.index(angle)}], turn_{angle});"]
            pairs += [f"turn_{angle}[0]", f"turn_{angle}[1]"]
        inputs = [f"in[{index}]" for index in range(len(self.names))]
        arguments = ", ".join([*inputs, *pairs, *(["out"] if self.module.outputs else [])])
        plain = [f"if (has_wide_margins({self._tested('in[{}]')})) {{", f"  return plain({arguments});", "}"]
        values = {"NAME": self.module.name, "ARGUMENTS": arguments}
        return _part("point.c", UNUSED=self.unused, TURNS=turns, PLAIN=plain if self.plain else [], **values)

    def _array(self) -> str:
        """Strips of an array: sines ahead, then one loop in the form that the strip's designs share."""
        results = [f"out_{index}" for index in range(len(self.module.outputs))]
        columns = [
            *(f"const double *restrict in_{k} = in[{k}] + start;" for k in range(len(self.names))),
            *(f"double *restrict {one} = out[{k}] + start;" for k, one in enumerate(results)),
        ]
        turns, pairs, strip = "", [], {"STRIP": str(STRIP), "LIMIT": repr(self.module.constants.limit)}
        for number, angle in enumerate(self.turns):
            turns += _part("turns.c", K=str(number), ANGLE=f"in_{self.names.index(angle)}", **strip)
            pairs += [f"sines_{number}[k]", f"cosines_{number}[k]"]
        value = ["value"] if results else []
        arguments = ", ".join([*(f"in_{k}[k]" for k in range(len(self.names))), *pairs, *value])
        stored = [f"{one}[k] = value[{k}];" for k, one in enumerate(results)]

        def loop(call: str) -> list[str]:
            buffer = [f"double value[{len(results)}];"] if results else []
            return _part("loop.c", VALUE=buffer, CALL=call, STORED=stored).splitlines()

        plain, stable, test = f"plain({arguments})", f"stable({arguments})", self._tested("in_{}[k]")
        loops = loop(stable)
        if self.plain:
            either = loop(f"has_wide_margins({test}) ? {plain} : {stable}")
            two = {"PLAIN": loop(plain), "STABLE": loops, "EITHER": either}
            loops = _part("loops.c", TEST=test, **two).splitlines()
        parts = {"UNUSED": self.unused, "COLUMNS": columns, "TURNS": turns.splitlines(), "LOOPS": loops}
        return _part("array.c", NAME=self.module.name, STRIP=str(STRIP), **parts)

    # -- further functions --

    def _solvers(self) -> list[str]:
        texts = []
        for name, solver in self.module.solvers.items():
            program, extra = solver.solve, [symbol.name for symbol in solver.arguments]
            used = [one for one in (*extra, *self.names) if one in program.inputs]
            count, slopes = len(program.outputs) - 1, lifted(solver.slopes) if solver.slopes else None
            texts.append(static_function(f"{name}_angles", program, used, count, count))
            result = next(iter(slopes.turns)) if slopes else "angles"
            angles = ", ".join([*self._passed(used, dict(zip(extra, extra, strict=True))), result])
            values = {"NAME": self.module.name, "ANGLES": angles}
            if slopes:
                texts.append(self._slopes(name, slopes))
                angle, pair = next(iter(slopes.turns.items()))
                words = {angle: "theta[k]", pair[0]: "turn[0]", pair[1]: "turn[1]"}
                values["SLOPES"] = ", ".join([*self._passed(slopes.program.inputs, words), "slope"])
            unused = [] if "in[" in "".join(values.values()) else ["(void)in;"]
            texts.append(_part(f"{name}.c", UNUSED=unused, **values))
        return texts

    def _passed(self, names: Iterable[str], words: Mapping[str, str]) -> list[str]:
        return [words.get(name) or f"in[{self.names.index(name)}]" for name in names]

    def _slopes(self, name: str, slopes: Lifted) -> str:
        count = len(slopes.program.outputs)
        return static_function(f"{name}_slopes", slopes.program, slopes.program.inputs, count, None)


def tables_text(tables: Mapping[str, Content]) -> list[str]:
    """The content of the tables that are looked into."""
    rows = []
    for name, column in arrays_of(tables).items():
        rows += [f"static const double {name}[] = {{", *(f"  {row}" for row in numbers(column)), "};"]
    rows += [f"static const int64_t {name}_n = {len(knots)};" for name, (knots, _) in tables.items()]
    return [*rows, *([""] if rows else [])]


def sine_and_cosine(constants: Trigonometry) -> str:
    """`near_sin_cos(x, out)` by polynomials, and `sin_cos(x, out)`, by libm beyond their limit."""
    lines = (Line("sine", "sin", ("x",)), Line("cosine", "cos", ("x",)))
    program = expand_trigonometry(Program(("x",), lines, ("sine", "cosine"), {}), constants)
    limit = repr(constants.limit)
    about = f"sine and cosine by polynomials, for |x| <= {limit}"
    near = static_function("near_sin_cos", value_numbering(program), ["x"], 2, None, about)
    return near + "\n" + _part("sin_cos.c", LIMIT=limit)


def quoted(text: str) -> str:
    """A text as a C string."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
