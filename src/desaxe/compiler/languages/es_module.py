"""A JavaScript module (ES2015) and its types: `import { evaluate, a_C } from "./name.js"`."""

from ...support.template import file_text, filled
from .javascript import HEADER, SPELLING, TABLES, emit_javascript
from .protocol import Language, Module, Symbol
from .shared import arrays_of, comment, numbers, one_line

EVALUATE = file_text(__package__, "es_module.js")
TYPES = file_text(__package__, "es_module.d.ts")


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
    program = program._replace(outputs=program.outputs[: len(module.outputs)])
    symbols = {symbol.name: symbol for symbol in (*module.inputs, *module.outputs)}
    units = (f'{name}: "{symbol.unit}"' for name, symbol in symbols.items())
    tables = [
        row
        for name, column in arrays_of(module.tables).items()
        for row in (f"const {name} = [", *(f"  {row}" for row in numbers(column)), "];")
    ]
    return "\n".join(
        [
            comment(module.head),
            HEADER,
            *([TABLES] if module.tables else []),
            *tables,
            f"export const INPUTS = {_list(module.inputs)};",
            f"export const OUTPUTS = {_list(module.outputs)};",
            f"export const UNITS = {{ {', '.join(units)} }};",
            "",
            emit_javascript(program, "values"),
            *(_function(module, symbol, place) for place, symbol in enumerate(module.outputs)),
            EVALUATE,
        ]
    )


def _function(module: Module, symbol: Symbol, place: int) -> str:
    """The function of one output; an argument that it does not take is NaN."""
    taken = module.taken(symbol.name)
    names = [one.name for one in module.inputs]
    checked = [f'number("{n}", {SPELLING.safe(n)})' if n in taken else "NaN" for n in names]
    head = f"{_about(symbol)}\nexport function {_signature(module, symbol, '')} {{"
    return f"{head}\n  return values({', '.join(checked)})[{place}];\n}}\n"


def _types(module: Module) -> str:
    fields = {
        "INPUTS": [row for s in module.inputs for row in (_about(s), f"{s.name}: T;")],
        "OUTPUTS": [row for s in module.outputs for row in (_about(s), f"{s.name}: T;")],
        "FUNCTIONS": [
            row
            for s in module.outputs
            for row in (_about(s), f"export function {_signature(module, s, ': number')}: number;")
        ],
    }
    lists = {"NAMES": _list(module.inputs), "RESULTS": _list(module.outputs)}
    return filled(TYPES, COMMENT=comment(module.head), **fields, **lists)


def _signature(module: Module, symbol: Symbol, kind: str) -> str:
    parameters = (f"{SPELLING.safe(name)}{kind}" for name in module.taken(symbol.name))
    return f"{symbol.name}({', '.join(parameters)})"


def _about(symbol: Symbol) -> str:
    source = f" ({symbol.source})" if symbol.source else ""
    return f"/** [{symbol.unit}] {one_line(symbol.meaning)}{source} */"


def _list(symbols: tuple[Symbol, ...]) -> str:
    names = (f'"{symbol.name}"' for symbol in symbols)
    return f"[{', '.join(names)}]"
