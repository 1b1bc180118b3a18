"""A JavaScript module (ES2015) and its types: `import { evaluate, a_C } from "./name.js"`."""

from ...support.template import file_text
from ..text import with_short_temporaries
from .javascript import HEADER, TABLES, emit_javascript
from .protocol import Language, Module, Symbol
from .shared import arrays_of, numbers, one_line, safe_name, with_safe_names
from .words import words_of

WORDS = words_of("javascript").lines
EVALUATE = file_text(__package__, "es_module.js")


class JavaScript(Language):
    """An ES module; see this file's docstring."""

    name = "javascript"
    suffix = ".js"
    about = "an ES module and its types"

    def files(self, module: Module) -> dict[str, str]:
        """`name.js` and `name.d.ts`."""
        return {f"{module.name}.js": _source(module), f"{module.name}.d.ts": _types(module)}


def _source(module: Module) -> str:
    program = module.forms.stable
    program = program._replace(inputs=tuple(symbol.name for symbol in module.inputs))
    # An output may be an input, or stand twice: it is returned as it is called here.
    program = with_safe_names(with_short_temporaries(program), WORDS)
    program = program._replace(outputs=program.outputs[: len(module.outputs)])
    units = ", ".join(f'{s.name}: "{s.unit}"' for s in _once((*module.inputs, *module.outputs)))
    functions = [_function(module, symbol, place) for place, symbol in enumerate(module.outputs)]
    return "\n".join(
        [
            _comment(module),
            HEADER,
            *([TABLES] if module.tables else []),
            *_content(module),
            f"export const INPUTS = {_list(module.inputs)};",
            f"export const OUTPUTS = {_list(module.outputs)};",
            f"export const UNITS = {{ {units} }};",
            "",
            emit_javascript(program, "values"),
            *functions,
            EVALUATE,
        ]
    )


def _content(module: Module) -> list[str]:
    """The tables that are looked into."""
    found = []
    for name, column in arrays_of(module.tables).items():
        found += [f"const {name} = [", *(f"  {row}" for row in numbers(column)), "];"]
    return found


def _function(module: Module, symbol: Symbol, place: int) -> str:
    """The function of one output; an argument that it does not take is NaN."""
    taken = module.taken(symbol.name)
    given = ", ".join(safe_name(name, WORDS) for name in taken)
    names = [one.name for one in module.inputs]
    checked = [f'number("{n}", {safe_name(n, WORDS)})' if n in taken else "NaN" for n in names]
    head = f"/** {_about(symbol)} */\nexport function {symbol.name}({given}) {{"
    return f"{head}\n  return values({', '.join(checked)})[{place}];\n}}\n"


def _types(module: Module) -> str:
    functions = []
    for symbol in module.outputs:
        taken = [f"{safe_name(name, WORDS)}: number" for name in module.taken(symbol.name)]
        functions.append(
            f"/** {_about(symbol)} */\nexport function {symbol.name}({', '.join(taken)}): number;"
        )
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
            "",
            "export function evaluate(inputs: Inputs<number>): Outputs<number>;",
            "export function evaluate(inputs: Inputs): Outputs<Float64Array>;",
            "",
        ]
    )


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
