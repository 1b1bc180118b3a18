"""A Python module over `jax.numpy`: a function for each name, whose derivatives are the derived ones.

A formula that is differentiated by machine loses its digits where it cancels, whatever its own form. So
each function has a rule for its tangent, made of the functions of the derivatives' names, which in turn have
theirs: `grad`, `jacfwd`, `hessian`, `vmap` and `jit` see exact derivatives in the stable form.
"""

import re

from ...support.template import file_text
from ..builder import HELPERS as SHARED
from ..builder import functions_of
from ..program import Program
from ..text import INDENT
from .protocol import Language, Module, Symbol
from .shared import (
    Spelling,
    arrays_of,
    called,
    documented,
    functions_in,
    numbers,
    one_line,
    types_of,
    with_helpers,
)

NUMPY = (
    "copysign", "cos", "exp", "floor", "hypot", "inf", "log", "logical_and", "logical_not", "logical_or",
    "nan", "searchsorted", "sin", "sqrt", "where",
)  # fmt: skip
RENAMED = {"atan2": "arctan2", "fabs": "abs", "pow": "power"}  # readable text -> jax.numpy
OWN = ("asarray", "custom_jvp", "finfo", "float32", "result_type", "stop_gradient", "zeros_like", "int8")
SPELLING = Spelling("jax", "{name} = {right}", "  # {}")
HELPERS = {
    "two_sum_error": functions_of(SHARED)["two_sum_error"] + "\n",
    **functions_in(file_text(__package__, "jax_helpers.txt")),
}
USE = (
    'It needs jax, and nothing of desaxe. Float64 wants jax.config.update("jax_enable_x64", True);',
    "float32 arrays are computed in float32.",
)
RULES = file_text(__package__, "jax_rules.txt")
EVALUATE = '''def evaluate(*, {inputs}):
    """All OUTPUTS, by name. What has no value is NaN."""
    inputs = floats({inputs})
    return {{name: FUNCTIONS[name](*inputs) for name in OUTPUTS}}
'''


class Jax(Language):
    """A module over jax.numpy; see this file's docstring."""

    name = "jax"
    suffix = ".py"
    about = "a Python module over jax.numpy, with exact derivatives"
    second_order = True
    extended = False  # products may be fused with sums

    def files(self, module: Module) -> dict[str, str]:
        """`name.py`."""
        return {f"{module.name}.py": _text(module)}


def _text(module: Module) -> str:
    inputs = [symbol.name for symbol in module.inputs]
    functions = [_function(name, program, inputs) for name, program in module.values.items()]
    public = [_public(symbol, inputs, module.taken(symbol.name)) for symbol in module.outputs]
    evaluate = EVALUATE.format(inputs=", ".join(inputs)).replace("(*, )", "()")
    body = "\n\n".join([*_content(module), RULES, *functions, _tables(module), *public, evaluate])
    helpers = with_helpers("\n".join(functions), HELPERS)
    code = "\n\n".join([*helpers, body])
    return "\n".join(
        [f'"""{documented(module, USE)}"""', "", *_imports(code), "", "", code.rstrip("\n"), ""]
    ).replace("\n\n\n\n", "\n\n\n")


def _content(module: Module) -> list[str]:
    """The tables as arrays of NumPy, whose doubles stay doubles."""
    result = []
    for name, column in arrays_of(module.tables).items():
        rows = "".join(f"{INDENT}{row}\n" for row in numbers(column))
        result.append(f"{name} = array([\n{rows}])\n")
    return result


def _imports(code: str) -> list[str]:
    used = {word for word in (*NUMPY, *OWN, "floating", "issubdtype") if f"{word}" in _words(code)}
    numpy = sorted(used - {"custom_jvp", "stop_gradient"})
    numpy += [f"{theirs} as {ours}" for ours, theirs in RENAMED.items() if called(code, [ours])]
    return [
        "from jax import custom_jvp",
        "from jax.custom_derivatives import SymbolicZero",
        *(["from jax.lax import stop_gradient"] if "stop_gradient" in used else []),
        f"from jax.numpy import {', '.join(numpy)}",
        *(["from numpy import array"] if " = array([" in code else []),
    ]


def _words(code: str) -> set[str]:
    without_strings = re.sub(r'""".*?"""', "", code, flags=re.DOTALL)
    return set(re.findall(r"\w+", re.sub(r"#.*", "", without_strings)))


def _function(name: str, program: Program, inputs: list[str]) -> str:
    """`_name(*inputs)`: the values, without derivatives."""
    result = SPELLING.safe(program.outputs[0])
    whole = types_of(program).get(program.outputs[0]) == "i64"
    returned = f"asarray(stop_gradient({result}), int8)" if whole else f"asarray({result})"
    rows = [*SPELLING.statements(program), f"return {returned}"]
    return "\n".join([f"def _{name}({', '.join(inputs)}):", *(INDENT + row for row in rows), ""])


def _public(symbol: Symbol, inputs: list[str], taken: list[str]) -> str:
    given = ", ".join(name if name in taken else "nan" for name in inputs)
    meaning = f"{symbol.meaning or symbol.name} [{symbol.unit}]" + (
        f", {symbol.source}" if symbol.source else ""
    )
    return "\n".join(
        [
            f"def {symbol.name}({', '.join(taken)}):",
            f'{INDENT}"""{one_line(meaning[0].upper() + meaning[1:])}."""',
            f'{INDENT}return FUNCTIONS["{symbol.name}"](*floats({given}))',
            "",
        ]
    )


def _tables(module: Module) -> str:
    inputs = tuple(symbol.name for symbol in module.inputs)
    whole = {name for name, p in module.values.items() if types_of(p).get(p.outputs[0]) == "i64"}
    units = {symbol.name: symbol.unit for symbol in (*module.inputs, *module.outputs)}
    rows = [
        f"INPUTS = {inputs!r}",
        f"OUTPUTS = {tuple(symbol.name for symbol in module.outputs)!r}",
        f"UNITS = {units!r}",
        "# Name -> input -> the name of the derivative, and the inputs that a name depends on.",
        "DERIVATIVES = {",
        *(f"{INDENT}{name!r}: {dict(by)!r}," for name, by in module.derivatives.items()),
        "}",
        "NEEDS = {",
        *(
            f"{INDENT}{name!r}: {tuple(n for n in inputs if n in program.inputs)!r},"
            for name, program in module.values.items()
        ),
        "}",
        "FUNCTIONS = {",
        *(
            f"{INDENT}{name!r}: _{name},"
            if name in whole
            else f"{INDENT}{name!r}: with_derivatives({name!r}, _{name}),"
            for name in module.values
        ),
        "}",
        "",
    ]
    return "\n".join(rows)
