"""Loads that a compiled module can hold: tables."""

from collections.abc import Mapping

from ...loads.lines import tables_of
from ...loads.load import Load
from ..schema import SceneError


def require_tables(where: str, loads: Mapping[str, Load], alone: bool = False) -> None:
    """SceneError for a load that cannot be written into a module; alone: as one table over theta or Y."""
    held = (
        "an FMU holds tables over theta or Y"
        if alone
        else "a compiled module holds tables over theta, Y, V_C"
    )
    for name, load in loads.items():
        if not tables_of(name, load) or (alone and name not in tables_of(name, load)):
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: {held}; sample "
                "the function, desaxe.over_theta(angles, f(angles)), or leave the load open as a list of "
                "values, and give it at each angle"
            )
