"""Tables that are arguments of a module of numba: the text that takes them."""

from collections.abc import Iterable, Mapping

from ...compiler.languages.protocol import OpenTable
from ...compiler.languages.tables import period_of

TAKEN = '''def taken_table(x, c, ways, period):
    """What the code takes of a table: two numbers, knots, coefficients; zeros where something is none."""
    x, c = (ascontiguousarray(column).reshape(-1) for column in doubles(knots=x, coefficients=c))
    valid, first = checked_table(x, c, ways, period)
    return (valid, first, x, c) if valid == 0.0 else (valid, 0.0, arange(2.0), zeros(24))
'''


def taking(tables: Mapping[str, OpenTable]) -> list[str]:
    """The lines that take the tables."""
    return [
        f"{n}_valid, {n}_first, {n}_x, {n}_c = "
        f"taken_table({n}_x, {n}_c, {table.ways}, {period_of(table, 'inf')})"
        for n, table in tables.items()
    ]


def call_of(inputs: Mapping[str, int | None], tables: Iterable[str]) -> list[str]:
    """The arguments of a kernel over axes, of which the first is cut into blocks."""
    own = {None: "{}", 0: 'axes["{}"][start:stop]'}
    given = [own.get(axis, 'axes["{}"]').format(name) for name, axis in inputs.items()]
    return [*given, *(f"{name}_{end}" for name in tables for end in "xc")]
