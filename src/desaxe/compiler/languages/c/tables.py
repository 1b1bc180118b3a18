"""Tables that are arguments in C: three of each, the checks, and a function that fills one from points."""

from collections.abc import Iterable, Mapping

from ..protocol import OpenTable
from ..tables import period_of
from .functions import PASSED, TABLE

FOREVER = "(double)INFINITY"
TABLE_HEADER = """\
/* {table}_c from the values {ways} at n points x: straight lines between them, or with steps != 0 each value
   up to the next point. A period's first point does not stand again at its end. c has room for {room}
   numbers. Returns the status: 4 with n < 2, a NULL{both} or what is no table. */"""


def parameters(tables: Iterable[str]) -> str:
    """The parameters of tables, behind others."""
    return "".join(f", {TABLE.format(name)}" for name in tables)


def passed(tables: Iterable[str]) -> list[str]:
    """The arguments of tables, as a function passes them on."""
    return [PASSED.format(name) for name in tables]


def checks(tables: Mapping[str, OpenTable]) -> list[str]:
    """Check tables: the numbers that Programs take, and zeros in the place of what is no table."""
    rows = []
    for name, table in tables.items():
        period = period_of(table, FOREVER)
        ends = ", ".join(f"&{name}_{end}" for end in "xcn")
        rows.append(
            f"const double {name}_valid = checked_table({ends}, {table.ways}, {period}), "
            f"{name}_first = {name}_x[0];"
        )
    return rows


def table_comment(name: str, table: OpenTable) -> list[str]:
    """The comment on the function that fills a table, with the length of what it fills."""
    both = table.ways > 1
    said = {"ways": "y (outward) and inward" if both else "y", "both": " (inward, too)" if both else ""}
    return TABLE_HEADER.format(table=name, room=f"{4 * table.ways}*(n + 1)", **said).splitlines()


def table_signature(module: str, name: str, table: OpenTable) -> str:
    """The head of the function that fills a table."""
    ways = "const double *y, const double *inward" if table.ways > 1 else "const double *y"
    return f"int {module}_{name}_table(int64_t n, const double *x, {ways}, int steps, double *c)"


def table_function(module: str, name: str, table: OpenTable) -> str:
    """The function that fills a table."""
    ways = ["y", *(["inward"] if table.ways > 1 else [])]
    missing = " || ".join(f"{each} == NULL" for each in ("x", *ways, "c"))
    period = period_of(table, FOREVER)
    rows = [
        f"{table_signature(module, name, table)} {{",
        f"  if (n < 2 || {missing}) {{",
        "    return 4;",
        "  }",
        *(
            f"  filled_table(n, x, {way}, steps, {period}, c{' + 4 * (n + 1)' if number else ''});"
            for number, way in enumerate(ways)
        ),
        "  const double *knots = x, *rows = c;",
        f"  return checked_table(&knots, &rows, &n, {table.ways}, {period}) == 0.0 ? 0 : 4;",
        "}",
        "",
    ]
    return "\n".join(rows)
