"""Words that no name in a written file can be, a table for each language: its own, and those in use.

Where a language has a function for each output, one of such a name would take the place of what the file
calls; a file of such a name, that of a module, header or function that it needs. Both are refused by name.
"""

import keyword
import sys
from typing import NamedTuple


class Words(NamedTuple):
    """Words that no line of a program is called (it gets an underscore), nor an output, nor a module."""

    lines: frozenset[str] = frozenset()
    outputs: frozenset[str] = frozenset()
    modules: frozenset[str] = frozenset()


def words_of(language: str) -> Words:
    """The table of a language."""
    return _TABLES[language]


_C = Words(
    lines=frozenset((
        "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum",
        "extern", "float", "for", "goto", "if", "inline", "int", "long", "register", "restrict", "return",
        "short", "signed", "sizeof", "static", "struct", "switch", "typedef", "union", "unsigned", "void",
        "volatile", "while", "out", "NAN", "INFINITY",
        # of C++, which compiles the files, too
        "alignas", "alignof", "and", "and_eq", "asm", "bitand", "bitor", "bool", "catch", "char16_t",
        "char32_t", "class", "compl", "const_cast", "constexpr", "decltype", "delete", "dynamic_cast",
        "explicit", "export", "false", "friend", "mutable", "namespace", "new", "noexcept", "not", "not_eq",
        "nullptr", "operator", "or", "or_eq", "private", "protected", "public", "reinterpret_cast",
        "static_assert", "static_cast", "template", "this", "thread_local", "throw", "true", "try", "typeid",
        "typename", "using", "virtual", "wchar_t", "xor", "xor_eq",
    )),
    # Headers of the standard library, in whose way `name.h` may stand. Outputs are only texts and comments.
    modules=frozenset((
        "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "iso646", "limits", "locale",
        "math", "setjmp", "signal", "stdarg", "stdbool", "stddef", "stdint", "stdio", "stdlib", "string",
        "tgmath", "time", "wchar", "wctype",
    )),
)  # fmt: skip

_JAVASCRIPT = frozenset((
    # reserved, in modules too
    "arguments", "await", "break", "case", "catch", "class", "const", "continue", "debugger", "default",
    "delete", "do", "else", "enum", "eval", "export", "extends", "false", "finally", "for", "function",
    "if", "implements", "import", "in", "instanceof", "interface", "let", "new", "null", "package",
    "private", "protected", "public", "return", "static", "super", "switch", "this", "throw", "true", "try",
    "typeof", "var", "void", "while", "with", "yield",
    "then",  # import() takes a module that exports it for a promise
    # used
    "Array", "ArrayBuffer", "Float64Array", "Infinity", "Math", "NaN", "Object", "RangeError", "TypeError",
    "undefined",
    # defined
    "False", "INPUTS", "OUTPUTS", "True", "UNITS", "evaluate", "inf", "lookup", "lookup_piece",
    "lookup_slope", "nan", "number", "values",
))  # fmt: skip

_OCTAVE = frozenset((
    # reserved, here and in MATLAB
    "arguments", "break", "case", "catch", "classdef", "continue", "do", "else", "elseif", "end",
    "end_try_catch", "end_unwind_protect", "endarguments", "endclassdef", "endenumeration", "endevents",
    "endfor", "endfunction", "endif", "endmethods", "endparfor", "endproperties", "endspmd", "endswitch",
    "endwhile", "enumeration", "events", "for", "function", "global", "if", "methods", "otherwise", "parfor",
    "persistent", "properties", "return", "spmd", "switch", "try", "until", "unwind_protect",
    "unwind_protect_cleanup", "while",
    # called
    "Inf", "NaN", "abs", "all", "any", "atan2", "cos", "diff", "double", "error", "exp",
    "false", "fix", "floor", "hypot", "isfinite", "islogical", "isnumeric", "isreal", "log", "max",
    "min", "mod", "numel", "ones", "reshape", "sin", "size", "sqrt", "true", "zeros",
    # defined
    "copysign", "extended_only", "logarithm", "looked_up", "looked_up_slope", "lookup_piece",
    "mul_add", "numbers", "power_of", "root", "rotated_cos", "rotated_sin", "rounding", "row_of",
    "select", "shape", "two_product_error", "two_sum_error",
))  # fmt: skip

_JAX = frozenset((
    *keyword.kwlist,
    # built in
    "NotImplementedError", "enumerate", "float", "isinstance", "range",
    # imported
    "SymbolicZero", "array", "asarray", "atan2", "copysign", "cos", "custom_jvp", "exp", "fabs", "finfo",
    "float32", "floating", "floor", "hypot", "inf", "int8", "issubdtype", "log", "logical_and", "logical_not",
    "logical_or", "nan", "pow", "result_type", "searchsorted", "sin", "sqrt", "stop_gradient", "where",
    "zeros_like",
    # defined
    "DERIVATIVES", "FUNCTIONS", "INPUTS", "NEEDS", "OUTPUTS", "UNITS", "evaluate", "floats", "lookup",
    "lookup_piece", "lookup_slope", "row_of", "with_derivatives",
))  # fmt: skip

# What else a module defines for itself depends on the scene: its text is looked at.
_NUMBA = frozenset((
    *keyword.kwlist,
    # built in
    "OverflowError", "RuntimeError", "TypeError", "ValueError", "abs", "bool", "dict", "enumerate", "exec",
    "float", "globals", "int", "isinstance", "len", "list", "max", "min", "range", "set", "str", "sum",
    "tuple", "type", "zip",
    # imported
    "Any", "ThreadPoolExecutor", "annotations", "append", "arange", "arcsinh", "argmax", "array", "asarray",
    "ascontiguousarray", "atan2", "broadcast_shapes", "broadcast_to", "can_cast", "concatenate", "copysign",
    "copyto", "cos", "cpu_count", "empty", "errstate", "exp", "fabs", "float64", "floor", "fmax", "frexp",
    "inf", "int64", "int8", "intrinsic", "isfinite", "ldexp", "linspace", "log", "nan", "ndarray", "njit",
    "overload", "pi", "pow", "prod", "sin", "sinh", "sqrt", "take_along_axis", "types", "uint64", "unique",
    "where", "zeros",
    # defined
    "AXES", "BLOCK", "INPUTS", "OUTPUTS", "UNITS", "block", "compiled", "evaluate", "fill", "fill_rows",
    "formulas", "grid", "has_wide_margins", "plain", "point", "reduced", "run", "spaced", "stable",
    "with_axes",
))  # fmt: skip

# What a module imports, and what that imports in turn.
_PYTHON_MODULES = frozenset((*sys.stdlib_module_names, "jax", "jaxlib", "llvmlite", "numba", "numpy"))

# The tables of loads that a module holds or takes: pieces, how many knots, knots.
_OF_LOADS = frozenset(("F_X_c", "F_X_n", "F_X_x", "F_Y_c", "F_Y_n", "F_Y_x"))

_TABLES = {
    "c": _C._replace(lines=_C.lines | _OF_LOADS),
    "jax": Words(_JAX | _OF_LOADS, _JAX | _OF_LOADS, _PYTHON_MODULES),
    "javascript": Words(_JAVASCRIPT | _OF_LOADS, _JAVASCRIPT | _OF_LOADS),
    "numba": Words(outputs=_NUMBA, modules=_PYTHON_MODULES),
    "octave": Words(_OCTAVE | _OF_LOADS, modules=_OCTAVE),
}
