"""C from SymPy's printer, as its users write it: a nest of loops, compiled by gcc and called by ctypes.

Common subexpressions are shared, each computed in the outermost loop that knows its inputs; powers of
roots are products, never calls of `pow`. Sine and cosine come from one call of `sincos`; with fast math
they have loops of their own over strips, which gcc vectorises with the C library's `libmvec`.
"""

import ctypes
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import sympy as sp
from sympy.codegen.rewriting import create_expand_pow_optimization
from sympy.printing.c import C99CodePrinter

from ..formulas import forms, symbol
from ..work import Array, Inputs, Work, swept
from . import Run

OPTIONS = ("-O3", "-march=native", "-fPIC", "-fopenmp")
FAST = ("-ffast-math",)
HIGHEST = 8  # power that is written as a product
STRIP = 512  # points whose sines are computed ahead
HEAD = "#define _GNU_SOURCE\n#include <math.h>\n"
STRIPS = f"""
for (long start = 0; start < n[AXIS]; start += {STRIP}) {{
const long stop = start + {STRIP} < n[AXIS] ? start + {STRIP} : n[AXIS];
double sines[{STRIP}], cosines[{STRIP}];
for (long k = start; k < stop; k++) sines[k - start] = sin(theta_[k]);
for (long k = start; k < stop; k++) cosines[k - start] = cos(theta_[k]);
for (long iAXIS = start; iAXIS < stop; iAXIS++) {{
const double sine = sines[iAXIS - start], cosine = cosines[iAXIS - start];
"""
ONE_BY_ONE = "double sine, cosine;\nsincos(theta, &sine, &cosine);\n"
SINE, COSINE = sp.symbols("sine cosine", real=True)
Line = tuple[sp.Symbol, sp.Expr]


class _Printer(C99CodePrinter):
    """SymPy's, but for negative powers: 1.0/(x*x), which it writes as a call of pow."""

    def _print_Pow(self, expr: sp.Pow) -> str:
        if expr.exp.is_integer and expr.exp < -1:
            return f"1.0/({self._print(EXPAND(sp.Pow(expr.base, -expr.exp)))})"
        text: str = super()._print_Pow(expr)
        return text


EXPAND = create_expand_pow_optimization(HIGHEST)


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int, fast_math: bool) -> Run:
    """A peak goes through the angles in the outer loop, so that each has its sine once."""
    peak = work.kind == "peak"
    points = swept(inputs, theta_first=True) if peak else inputs
    function = _compiled(_source(work.names, points, peak, threads, fast_math), fast_math)
    sizes = (ctypes.c_long * len(points.shape))(*points.shape)
    held = [column.ctypes.data_as(ctypes.c_void_p) for column in points.columns.values()]  # and the arrays

    def run() -> Sequence[Array]:
        if peak:
            places = [np.full(points.shape[1], -1.0), np.empty(points.shape[1])]
        else:
            places = list(out or [np.empty(points.shape) for _ in work.names])
        function(sizes, *held, *(place.ctypes.data_as(ctypes.c_void_p) for place in places))
        return places

    return run


def _compiled(source: str, fast_math: bool) -> ctypes._CFuncPtr:
    with tempfile.TemporaryDirectory() as folder:
        text, code, library = (Path(folder, f"work.{end}") for end in ("c", "o", "so"))
        text.write_text(source, encoding="utf-8")
        options = (*OPTIONS, *(FAST if fast_math else ()))
        subprocess.run(["gcc", *options, "-c", str(text), "-o", str(code)], check=True)
        # Linked without -ffast-math, which would flush subnormal numbers of the whole process to zero.
        subprocess.run(["gcc", *OPTIONS, "-shared", str(code), "-o", str(library), "-lm"], check=True)
        function = ctypes.CDLL(str(library)).work
    function.restype = None
    return function


def _source(names: Sequence[str], points: Inputs, peak: bool, threads: int, fast_math: bool) -> str:
    """The whole file: a loop for each axis, results stored at its end."""
    lines, answers = _lines(names, points)
    parameters = [f"const double *restrict {name}_" for name in points.columns]
    parameters += [f"double *restrict {name}_" for name in (("best", "where") if peak else names)]
    text = f"{HEAD}void work(const long *n, {', '.join(parameters)}) {{\n"
    text += "#pragma omp parallel for\n" if threads > 1 and not peak else ""
    last = len(points.shape) - 1
    for axis in range(last + 1):
        turns, strips = points.axis.get("theta") == axis, fast_math and axis == last
        loop = f"for (long i{axis} = 0; i{axis} < n[{axis}]; i{axis}++) {{\n"
        text += STRIPS.replace("AXIS", str(axis)) if turns and strips else loop
        for name in (name for name, own in points.axis.items() if own == axis):
            text += f"const double {name} = {name}_[i{axis}];\n"
        text += ONE_BY_ONE if turns and not strips else ""
        text += "".join(_statements(lines, points, axis))
    text += _best(answers) if peak else _stored(names, answers, last)
    return text + "}" * text.count("{")  # of which none has been closed


def _best(answers: Sequence[sp.Expr]) -> str:
    value = _Printer().doprint(answers[0])
    return (
        f"const double value = fabs({value});\n"
        "const int more = value > best_[i1];\n"
        "best_[i1] = more ? value : best_[i1];\nwhere_[i1] = more ? theta : where_[i1];\n"
    )


def _stored(names: Sequence[str], answers: Sequence[sp.Expr], last: int) -> str:
    place = "i0"
    for axis in range(1, last + 1):
        place = f"({place})*n[{axis}] + i{axis}"
    return "".join(f"{n}_[{place}] = {_Printer().doprint(x)};\n" for n, x in zip(names, answers, strict=True))


def _lines(names: Sequence[str], points: Inputs) -> tuple[list[Line], list[sp.Expr]]:
    """Common subexpressions and results, with sine, cosine and roots as symbols."""
    theta = symbol("theta")
    angles = {sp.sin(theta): SINE, sp.cos(theta): COSINE}
    shared, answers = sp.cse([form.subs(angles) for form in forms(names, points)], sp.numbered_symbols("t"))
    roots: dict[sp.Expr, sp.Symbol] = {}

    def root(power: sp.Pow) -> sp.Expr:
        one = roots.setdefault(power.base, sp.Symbol(f"root{len(roots)}", positive=True))
        return one ** (2 * power.exp)

    lines: list[Line] = []
    for name, form in [*shared, *((None, answer) for answer in answers)]:
        known = len(roots)
        plain = form.replace(lambda part: part.is_Pow and part.exp.is_Rational and part.exp.q == 2, root)
        lines += [(one, sp.sqrt(base)) for base, one in list(roots.items())[known:]]
        lines.append((name, EXPAND(plain)))
    return lines[: len(lines) - len(answers)], [form for _, form in lines[len(lines) - len(answers) :]]


def _statements(lines: list[Line], points: Inputs, axis: int) -> Iterator[str]:
    """The lines that belong to this loop: all their inputs are known here, and not before."""
    depth = {symbol(name): own for name, own in points.axis.items()}
    depth[SINE] = depth[COSINE] = points.axis.get("theta", -1)
    for name, form in lines:
        depth[name] = max((depth[part] for part in form.free_symbols), default=0)
        if depth[name] == axis:
            yield f"const double {name} = {_Printer().doprint(form)};\n"
