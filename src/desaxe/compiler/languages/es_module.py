"""A JavaScript module (ES2015) and its types: `import { evaluate, a_C } from "./name.js"`."""

from collections.abc import Iterator, Sequence

from ...support.template import file_text, filled
from ..passes.slicing import keep_outputs
from ..program import Program
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
            *_values(module, program),
            EVALUATE,
        ]
    )


def _values(module: Module, program: Program) -> Iterator[str]:
    """The functions of all outputs, of those of each group, and of each output."""
    if not module.groups:
        yield emit_javascript(program, "values")
        for index, symbol in enumerate(module.outputs):
            yield _function(module, symbol, "values", program.inputs, index)
        return
    symbols, calls = {symbol.name: symbol for symbol in module.outputs}, []
    outputs = dict(zip(symbols, program.outputs, strict=True))
    for k, names in enumerate(module.groups):
        part = keep_outputs(program, [outputs[name] for name in names])
        yield emit_javascript(part, f"values_{k}")
        for index, name in enumerate(names):
            yield _function(module, symbols[name], f"values_{k}", part.inputs, index)
        calls.append(f"...values_{k}({_safe(part.inputs)})")
    yield f"const values = ({_safe(program.inputs)}) => [{', '.join(calls)}];\n"


def _safe(names: Sequence[str]) -> str:
    return ", ".join(map(SPELLING.safe, names))


def _function(module: Module, symbol: Symbol, function: str, inputs: Sequence[str], index: int) -> str:
    """The function of one output by that of several; an argument that it does not take is NaN."""
    taken = module.taken(symbol.name)
    checked = [f'number("{n}", {SPELLING.safe(n)})' if n in taken else "NaN" for n in inputs]
    head = f"{_about(symbol)}\nexport function {_signature(module, symbol, '')} {{"
    return f"{head}\n  return {function}({', '.join(checked)})[{index}];\n}}\n"


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
