"""numba as a language: functions of one output each, and loop nests."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from ...builder import module_text
from ...passes.guard import BAD_INPUT
from ...program import Program, tables_in
from ...text import INDENT, with_short_temporaries, write_lines
from ..protocol import Language, Module, OpenTable, Symbol
from ..shared import one_line, types_of
from ..tables import columns_of, period_of
from .module import CALLABLE, emit_numba, numba_parts

NO_TABLES: Mapping[str, OpenTable] = MappingProxyType({})
CHECKED = '''def checked_table(x, c, ways, period):
    """0, or NaN where something is no table; the first knot."""
    if x.size < 2 or c.size < 4 * ways * (x.size + 1):
        return nan, 0.0
    good = isfinite(x).all() and isfinite(c).all() and x[-1] - x[0] < period
    good = good and (x[:-1] <= x[1:]).all() and (x[:-2] < x[2:]).all()
    return (0.0 if good else nan), x[0]
'''
SCALAR = '''def scalar(function):
    """A function of floats for @njit functions, and for Python; compiled at the first call."""
    try:
        return njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba found no folder that it can write to
        return njit(error_model="numpy")(function)
'''


class Numba(Language):
    """Python that numba compiles; see the package."""

    name = "numba"
    suffix = ".py"
    about = "FILE.py: `point(...)`, `evaluate(...)`, `run()`; it needs NumPy and numba"
    open_tables = True
    loops = staticmethod(emit_numba)

    def files(self, module: Module) -> dict[str, str]:
        """`name.py`: for each result a function of its own."""
        scalars = [(one, module.values[one.name], module.taken(one.name)) for one in module.outputs]
        parts = scalar_parts(scalars)
        head = "\n".join(map(one_line, module.head))
        return {f"{module.name}.py": module_text(f"{head}\n", numba_parts(parts, jit=CALLABLE))}


def scalar_parts(
    scalars: Sequence[tuple[Symbol, Program, Sequence[str]]], tables: Mapping[str, OpenTable] = NO_TABLES
) -> list[str]:
    """A function of numbers for each output: its Program, and the inputs that it takes; tables come last."""
    checked = [CALLABLE + CHECKED.replace("def ", "def compiled_")] if tables else []
    return [SCALAR, *checked, *(_scalar(*one, tables) for one in scalars)]


def _scalar(symbol: Symbol, program: Program, inputs: Sequence[str], tables: Mapping[str, OpenTable]) -> str:
    meaning = symbol.meaning or symbol.name  # a quantity of one's own may come without
    lines = [
        f'"""{meaning[0].upper()}{meaning[1:]} [{symbol.unit}]."""',
        *(f"{given} = float({given})" for given in inputs if given in program.inputs),
        *_checks(program, tables),
        *write_lines(with_short_temporaries(program), "numba"),
        f"return {program.outputs[0]}",
    ]
    rows = [INDENT + line for line in lines]
    given = ", ".join([*inputs, *columns_of(tables)])
    return "\n".join(["@scalar", f"def {symbol.name}({given}):", *rows, ""])


def _checks(program: Program, tables: Mapping[str, OpenTable]) -> list[str]:
    """The lines that check the tables of a program."""
    bad = BAD_INPUT if types_of(program)[program.outputs[0]] == "i64" else "nan"
    rows = []
    for name, table in tables.items():
        if name in tables_in(program):
            period = period_of(table, "inf")
            found = f"compiled_checked_table({name}_x, {name}_c, {table.ways}, {period})"
            rows += [f"{name}_valid, {name}_first = {found}", f"if not {name}_valid == 0.0:"]
            rows.append(f"{INDENT}return {bad}")
    return rows
