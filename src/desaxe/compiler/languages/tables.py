"""Tables that are arguments of a module: their names, and the comment on their layout."""

from collections.abc import Mapping
from math import inf
from textwrap import wrap

from .protocol import OpenTable


def numbers_of(tables: Mapping[str, OpenTable]) -> list[str]:
    """The inputs of Programs that are made of tables: NaN where one is none, and the first knot."""
    return [f"{name}_{end}" for name in tables for end in ("valid", "first")]


def columns_of(tables: Mapping[str, OpenTable]) -> list[str]:
    """The arguments: knots and coefficients."""
    return [f"{name}_{end}" for name in tables for end in "xc"]


def period_of(table: OpenTable, infinity: str) -> str:
    """The period as text."""
    return repr(table.period) if table.period < inf else infinity


def described(tables: Mapping[str, OpenTable], first: int = 0) -> list[str]:
    """The layout of tables whose arrays count from `first`, as lines of a comment."""
    if not tables:
        return []
    rows = [""]
    for name, table in tables.items():
        rows.append(f"{name}_x, {name}_c: {table.symbol.meaning} [{table.symbol.unit}] over {table.over}")
    a, b, c, d = (f"c[4*k + {first + power}]".replace(" + 0", "") for power in range(4))
    from_knot = "x[k]" if first else "x[k - 1]"
    said = (
        f"A table has n >= 2 ascending knots x, one given twice is a jump, and n + 1 pieces. Piece k, from 0 "
        f"on, is {a} + s*({b} + s*({c} + s*{d})) with s = place - {from_knot}, in piece 0 as in piece 1; "
        "piece 0 holds below the first knot, piece n from the last one on. "
    )
    if any(table.period < inf for table in tables.values()):
        said += "With a period no place is below the first knot, and the last lies less than one from it. "
    said += "Fewer knots, knots out of order and numbers that are not finite are bad input, status 4."
    return [*rows, *wrap(said, 96)]
