"""Loads that a compiled module can hold: tables, and what is the sum of tables."""

from collections.abc import Mapping

from ...loads.lines import tables_of
from ...loads.load import Load, OverY, TableOverTheta
from ..schema import SceneError


def table_of(name: str, load: Load) -> Load | None:
    """The one table over theta, Y or the stroke that a load is, as a spring is one; None where it is none."""
    parts = [*tables_of(name, load).values()]
    return parts[0] if len(parts) == 1 and isinstance(parts[0], (TableOverTheta, OverY)) else None


def require_tables(where: str, loads: Mapping[str, Load]) -> None:
    """SceneError for a load that cannot be written into a module."""
    for name, load in loads.items():
        if not tables_of(name, load):
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: a compiled module holds tables over theta, Y, V_C; "
                "sample the function, desaxe.over_theta(angles, f(angles)), or leave the load open as a list "
                "of values, and give it at each angle"
            )


def require_one_table(where: str, loads: Mapping[str, Load]) -> None:
    """SceneError for a load that an FMU cannot hold."""
    for name, load in loads.items():
        if table_of(name, load) is None:
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: an FMU holds, for each force, one table over theta, Y or "
                f"the stroke, or one spring; leave {name} out, and connect the FMU's input {name} to what "
                "calculates it, from theta, omega and outputs as Y and V_C"
            )
