"""A JavaScript module (ES2015) and its types: `import { evaluate, a_C } from "./name.js"`."""

from ..text import with_short_temporaries
from .javascript import HEADER, emit_javascript
from .protocol import Module, Symbol
from .shared import one_line, refuse_taken, with_safe_names

KEYWORDS = frozenset(
    (
        "arguments", "await", "break", "case", "catch", "class", "const", "continue", "debugger", "default",
        "delete", "do", "else", "enum", "eval", "export", "extends", "false", "finally", "for", "function",
        "if", "implements", "import", "in", "instanceof", "interface", "let", "new", "null", "package",
        "private", "protected", "public", "return", "static", "super", "switch", "this", "throw", "true",
        "try", "typeof", "undefined", "var", "void", "while", "with", "yield", "values", "INPUTS", "OUTPUTS",
        "UNITS",
    )
)  # fmt: skip
EXPORTS = ("evaluate", "INPUTS", "OUTPUTS", "UNITS")
EVALUATE = """\
/** All outputs by name; numbers, or arrays of one length (a number goes with every element). */
export function evaluate(inputs) {
  for (const name of INPUTS) {
    if (inputs[name] === undefined) throw new TypeError(`${name} is missing (needed: ${INPUTS})`);
  }
  const given = INPUTS.map((name) => inputs[name]);
  const lengths = given.filter((value) => typeof value !== "number").map((value) => value.length);
  if (!lengths.length) {
    const found = values(...given);
    return Object.fromEntries(OUTPUTS.map((name, place) => [name, found[place]]));
  }
  if (lengths.some((length) => length !== lengths[0])) throw new RangeError("arrays must have one length");
  const arrays = OUTPUTS.map(() => new Float64Array(lengths[0]));
  for (let k = 0; k < lengths[0]; k++) {
    values(...given.map((value) => (typeof value === "number" ? value : value[k]))).forEach((one, place) => {
      arrays[place][k] = one;
    });
  }
  return Object.fromEntries(OUTPUTS.map((name, place) => [name, arrays[place]]));
}
"""


class JavaScript:
    """An ES module; see this file's docstring."""

    name = "javascript"
    suffix = ".js"
    second_order = False
    own_functions = False
    extended = True

    def files(self, module: Module, freestanding: bool = False) -> dict[str, str]:
        """`name.js` and `name.d.ts`."""
        return {f"{module.name}.js": _source(module), f"{module.name}.d.ts": _types(module)}


def _source(module: Module) -> str:
    program = module.forms.stable
    inputs = [_safe(symbol.name) for symbol in module.inputs]
    program = program._replace(inputs=tuple(symbol.name for symbol in module.inputs))
    # An output may be an input, or stand twice: it is returned as it is called here.
    program = with_safe_names(with_short_temporaries(program), KEYWORDS)
    program = program._replace(outputs=program.outputs[: len(module.outputs)])
    units = ", ".join(f'{s.name}: "{s.unit}"' for s in _once((*module.inputs, *module.outputs)))
    refuse_taken((symbol.name for symbol in module.outputs), EXPORTS)
    functions = [
        f"/** {_about(symbol)} */\nfunction output_{place}({', '.join(inputs)}) {{\n"
        f"  return values({', '.join(inputs)})[{place}];\n}}\n"
        for place, symbol in enumerate(module.outputs)
    ]
    return "\n".join(
        [
            _comment(module),
            HEADER,
            f"export const INPUTS = {_list(module.inputs)};",
            f"export const OUTPUTS = {_list(module.outputs)};",
            f"export const UNITS = {{ {units} }};",
            "",
            emit_javascript(program, "values"),
            *functions,
            _exports(module),
            EVALUATE,
        ]
    )


def _types(module: Module) -> str:
    given = ", ".join(f"{_safe(symbol.name)}: number" for symbol in module.inputs)
    functions = [
        f"/** {_about(symbol)} */\ndeclare function output_{place}({given}): number;"
        for place, symbol in enumerate(module.outputs)
    ]
    return "\n".join(
        [
            _comment(module),
            "type Values = number | readonly number[] | Float64Array;",
            "",
            "export interface Inputs<T = Values> {",
            *(f"  /** {_about(symbol)} */\n  {symbol.name}: T;" for symbol in module.inputs),
            "}",
            "",
            "export interface Outputs<T> {",
            *(f"  /** {_about(symbol)} */\n  {symbol.name}: T;" for symbol in module.outputs),
            "}",
            "",
            f"export const INPUTS: readonly [{', '.join(_quoted(module.inputs))}];",
            f"export const OUTPUTS: readonly [{', '.join(_quoted(module.outputs))}];",
            "export const UNITS: Readonly<Record<string, string>>;",
            "",
            *functions,
            _exports(module),
            "export function evaluate(inputs: Inputs<number>): Outputs<number>;",
            "export function evaluate(inputs: Inputs): Outputs<Float64Array>;",
            "",
        ]
    )


def _exports(module: Module) -> str:
    """The outputs under their names, which inside of the module hide nothing: Math, Infinity, a keyword."""
    names = ", ".join(f"output_{place} as {symbol.name}" for place, symbol in enumerate(module.outputs))
    return f"export {{ {names} }};\n"


def _safe(name: str) -> str:
    return f"{name}_" if name in KEYWORDS else name


def _once(symbols: tuple[Symbol, ...]) -> list[Symbol]:
    return list({symbol.name: symbol for symbol in symbols}.values())


def _about(symbol: Symbol) -> str:
    return f"[{symbol.unit}] {one_line(symbol.meaning)}" + (f" ({symbol.source})" if symbol.source else "")


def _quoted(symbols: tuple[Symbol, ...]) -> list[str]:
    return [f'"{symbol.name}"' for symbol in symbols]


def _list(symbols: tuple[Symbol, ...]) -> str:
    return f"[{', '.join(_quoted(symbols))}]"


def _comment(module: Module) -> str:
    return "\n".join(["/*", *(f" * {one_line(line)}".rstrip() for line in module.head), " */"])
