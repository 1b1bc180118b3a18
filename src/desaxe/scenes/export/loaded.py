"""Loads as a compiled module holds them: their tables as text, or as arguments."""

from collections.abc import Mapping

from ...compiler.languages.protocol import OpenTable, Symbol
from ...compiler.languages.shared import numbers
from ...loads.load import Load, OverY, TableOverTheta
from ...loads.table import Arrays
from ...mechanism.inputs import INPUTS
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


def tables_of(loads: Mapping[str, Load], opened: bool) -> tuple[dict[str, Arrays], dict[str, OpenTable]]:
    """The tables of loads by name: frozen, or arguments."""
    if opened:
        return {}, {name: open_table(name, load) for name, load in loads.items()}
    return {name: load.arrays() for name, load in loads.items()}, {}


def open_table(name: str, load: Load) -> OpenTable:
    """A load's table as an argument: what it is over, its period and its ways stay as they are."""
    symbol = Symbol(name, INPUTS[name].unit, INPUTS[name].meaning)
    if isinstance(load, TableOverTheta):
        return OpenTable(symbol, f"theta [rad], with a period of {load.period!r}", load.period)
    assert isinstance(load, OverY)
    place = f"the distance from the {load.centre[2:]} dead centre" if load.centre else "Y"
    if load.inward is None:
        return OpenTable(symbol, f"{place} [m]")
    return OpenTable(symbol, f"{place} [m]; the pieces of the way inward are behind those outward", ways=2)


def table_text(name: str, load: Load, table: Arrays) -> str:
    """The arrays of a load's table as text: knots, and coefficients in the distance from one."""
    rows = []
    for end, column in zip("xc", table, strict=True):
        rows += [f"{name}_{end} = array([", *(f"    {row}" for row in numbers(column)), "])"]
    return "\n".join([f"# {name}, a {load.told().strip('<>')}: knots, and the cubics between them.", *rows])
