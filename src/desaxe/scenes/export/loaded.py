"""Loads as a compiled module holds them: their tables as text."""

from collections.abc import Mapping

from ...compiler.languages.shared import numbers
from ...loads.load import Load, OverY, TableOverTheta
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


def table_text(name: str, load: Load) -> str:
    """The arrays of a load's table as text: knots, and coefficients in the distance from one."""
    rows = []
    for end, column in zip("xc", load.arrays(), strict=True):
        rows += [f"{name}_{end} = array([", *(f"    {row}" for row in numbers(column)), "])"]
    return "\n".join([f"# {name}, a {load.told().strip('<>')}: knots, and the cubics between them.", *rows])
