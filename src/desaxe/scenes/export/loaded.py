"""Loads as a compiled module holds them: their tables, and what they are looked up at."""

from collections.abc import Mapping
from itertools import chain

from ...compiler.languages.shared import numbers
from ...compiler.operations import Content
from ...loads.load import Load, OverY, TableOverTheta
from ...mechanism.load_lines import LoadLines
from ..schema import SceneError


def require_tables(where: str, loads: Mapping[str, Load]) -> None:
    """SceneError for a load that cannot be written into a module."""
    for name, load in loads.items():
        if not isinstance(load, (TableOverTheta, OverY)):
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: a compiled module holds tables over theta or Y; sample "
                "the function, desaxe.over_theta(angles, f(angles)), or leave the load open as a list of "
                "values, and give it at each angle"
            )


def table_of(load: Load) -> Content:
    """Knots and coefficients of a load's table, those inward behind those outward."""
    if isinstance(load, TableOverTheta):
        return load.table.knots, [*chain.from_iterable(load.table.rows)]
    assert isinstance(load, OverY)
    ways = load.outward, load.outward if load.inward is None else load.inward
    return load.outward.knots, [*chain.from_iterable(row for table in ways for row in table.rows)]


def lines_of(name: str, load: Load) -> LoadLines:
    """The lines of a load: the place at which its table is looked up."""
    if isinstance(load, TableOverTheta):
        return LoadLines(name, "theta", load.period, load.table.knots[0])
    assert isinstance(load, OverY)
    return LoadLines(name, load.centre or "Y")


def table_text(name: str, load: Load) -> str:
    """The arrays of a load's table as text: knots, and coefficients in the distance from one."""
    rows = []
    for end, column in zip("xc", table_of(load), strict=True):
        rows += [f"{name}_{end} = array([", *(f"    {row}" for row in numbers(column)), "])"]
    return "\n".join([f"# {name}, a {repr(load).strip('<>')}: knots, and the cubics between them.", *rows])
