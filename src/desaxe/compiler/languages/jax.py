"""A Python module over `jax.numpy`: a function for each name, whose derivatives are the derived ones.

A formula that is differentiated by machine loses its digits where it cancels, whatever its own form. So
each function has a rule for its tangent, made of the functions of the derivatives' names, which in turn have
theirs: `grad`, `jacfwd`, `hessian`, `vmap` and `jit` see exact derivatives in the stable form.
"""

import re

from ..builder import HELPERS as SHARED
from ..builder import functions_of
from ..program import Program
from ..text import INDENT, with_short_temporaries
from .protocol import Language, Module, Symbol
from .shared import (
    arrays_of,
    called,
    documented,
    numbers,
    one_line,
    statements,
    types_of,
    with_helpers,
    with_safe_names,
)
from .words import words_of

NUMPY = (
    "copysign",
    "cos",
    "exp",
    "floor",
    "hypot",
    "inf",
    "log",
    "logical_and",
    "logical_not",
    "logical_or",
    "nan",
    "searchsorted",
    "sin",
    "sqrt",
    "where",
)
RENAMED = {"atan2": "arctan2", "fabs": "abs", "pow": "power"}  # readable text -> jax.numpy
OWN = ("asarray", "custom_jvp", "finfo", "float32", "result_type", "stop_gradient", "zeros_like", "int8")
WORDS = {"nan": "nan", "inf": "inf", "True": "True", "False": "False"}
HELPERS = {
    "two_sum_error": functions_of(SHARED)["two_sum_error"] + "\n",
    "two_product_error": '''def two_product_error(a, b):
    """What rounding took from a * b, exactly (Dekker)."""
    product = a * b
    splitter = 2.0 ** ((finfo(result_type(product)).nmant + 2) // 2) + 1.0
    wide = splitter * a
    a_high = wide - (wide - a)
    a_low = a - a_high
    wide = splitter * b
    b_high = wide - (wide - b)
    b_low = b - b_high
    return a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low) + 0.0
''',
    "mul_add": '''def mul_add(a, b, c):
    """a * b + c, rounded as often as the machine likes."""
    return a * b + c
''',
    "extended_only": '''def extended_only(a):
    """Whether to take a form that only twice the digits tell from the other: not here."""
    return logical_and(a, False)
''',
    "rounding": '''def rounding(a):
    """What rounding may take from a number of this size in four operations."""
    return 2.0 * finfo(result_type(a)).eps * fabs(a)
''',
    "power_of_two": '''def power_of_two(a):
    """The power of two that is not below a size (Rump), within what the floating type holds."""
    kind = finfo(result_type(a))
    most = 2.0 ** (kind.maxexp - 64)
    size = where(a < most, a, most)
    size = where(1.0 / most < size, size, 1.0 / most)
    wide = 2.0 ** (kind.nmant + 1) * size
    step = (wide + size) - wide
    return where(0.0 < step, step, size)
''',
    "lookup_piece": '''def lookup_piece(x, knots, way):
    """The number of the piece of a table at x; those of the way back follow."""
    knots = asarray(knots)
    back = where(way < 0.0, knots.size + 1, 0)
    return searchsorted(knots, x, side="right") + back
''',
    "lookup": '''def lookup(x, knots, rows, piece):
    """The value of a piece of a table at x, beyond its ends too."""
    s, a, b, c, d = row_of(x, knots, rows, piece)
    return a + s * (b + s * (c + s * d))
''',
    "lookup_slope": '''def lookup_slope(x, knots, rows, piece):
    """The slope of a piece of a table at x, beyond its ends too."""
    s, _, b, c, d = row_of(x, knots, rows, piece)
    return b + s * (2.0 * c + s * (3.0 * d))
''',
    "row_of": '''def row_of(x, knots, rows, piece):
    """The distance from the left knot of a piece, and its coefficients."""
    knots, rows = asarray(knots), asarray(rows)
    at = piece % (knots.size + 1)
    distance = x - knots[where(at > 0, at - 1, 0)]
    return (distance, *(rows[4 * piece + k] for k in range(4)))
''',
    "rotated_sin": '''def rotated_sin(sine, cosine, quarters):
    """The sine of an angle and whole quarter turns, from the angle's own."""
    value = where(quarters % 2.0 == 1.0, cosine, sine)
    return where(quarters % 4.0 >= 2.0, -value, value)
''',
    "rotated_cos": '''def rotated_cos(sine, cosine, quarters):
    """The cosine of an angle and whole quarter turns, from the angle's own."""
    value = where(quarters % 2.0 == 1.0, sine, cosine)
    return where((quarters + 1.0) % 4.0 >= 2.0, -value, value)
''',
}
USE = (
    'It needs jax, and nothing of desaxe. Float64 wants jax.config.update("jax_enable_x64", True);',
    "float32 arrays are computed in float32.",
)
RULES = '''def with_derivatives(name, function):
    """A function of all INPUTS whose derivatives are the functions in DERIVATIVES."""
    known = custom_jvp(function)

    def rule(inputs, tangents):
        value = known(*inputs)
        total = zeros_like(value)
        for place, tangent in enumerate(tangents):
            if isinstance(tangent, SymbolicZero) or INPUTS[place] not in NEEDS[name]:
                continue
            derivative = DERIVATIVES[name].get(INPUTS[place])
            if derivative is None:
                raise NotImplementedError(f"{name} has no derived derivative by {INPUTS[place]}")
            total = total + FUNCTIONS[derivative](*inputs) * tangent
        return value, total

    known.defjvp(rule, symbolic_zeros=True)
    return known


def floats(*inputs):
    """The inputs in one floating type: float32 stays, whole numbers become floats."""
    arrays = [asarray(value) for value in inputs]
    kind = result_type(*arrays) if arrays else float
    kind = kind if issubdtype(kind, floating) else result_type(kind, 1.0)
    return [array.astype(kind) for array in arrays]
'''
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
    found = []
    for name, column in arrays_of(module.tables).items():
        rows = "".join(f"{INDENT}{row}\n" for row in numbers(column))
        found.append(f"{name} = array([\n{rows}])\n")
    return found


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
    program = with_safe_names(with_short_temporaries(program), words_of("jax").lines)
    whole = types_of(program).get(program.outputs[0]) == "i64"
    rows = [
        f"{line} = {right}" + (f"  # {note}" if note else "")
        for line, right, note in statements(program, "jax", WORDS)
    ]
    result = program.outputs[0]
    returned = f"asarray(stop_gradient({result}), int8)" if whole else f"asarray({result})"
    return "\n".join(
        [f"def _{name}({', '.join(inputs)}):", *(INDENT + row for row in [*rows, f"return {returned}"]), ""]
    )


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
