"""Loads that a compiled module can hold: tables, and what is the sum of tables."""

from collections.abc import Mapping

from ...loads.lines import tables_of
from ...loads.load import Load
from ..schema import SceneError


def require_tables(where: str, loads: Mapping[str, Load], fmu: bool = False) -> None:
    """SceneError for a load that cannot be written into a module."""
    for name, load in loads.items():
        if not tables_of(name, load):
            instead = "leave the load open as a list of values, and give it at each angle"
            if fmu:
                instead = f"leave {name} out, and connect the FMU's input {name} to what calculates it"
            raise SceneError(
                f"{where}: loads.{name} = {load!r}: a compiled module holds tables over theta, Y, V_C; "
                f"sample the function, desaxe.over_theta(angles, f(angles)), or {instead}"
            )
