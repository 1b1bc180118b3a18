"""Loads that a compiled module can hold: tables."""

from collections.abc import Mapping

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
