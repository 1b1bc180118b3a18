"""The limits of the energy form: time does not enter, there is no friction, and M_eff stays > 0."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...loads.load import Load
from .panels import Designs

ENERGY, INTEGRATOR = "energy", "DOP853"  # what `method` of a result says
TABLE = "the torque is a table"


def served(designs: Designs) -> Any:
    """True for each design whose motion is smooth in its coordinate up to the limit angles, if it has any."""
    return np.isfinite(designs.middle)


def refuse(torque: Any, loads: Mapping[str, Any], mu: Any, options: Mapping[str, bool]) -> None:
    """ValueError where the energy form is asked for and cannot serve.

    options   those of an integrator, and whether each is given
    """
    varying = [name for name, load in loads.items() if callable(load)]
    given = [name for name, there in options.items() if there]
    if callable(torque):
        _refuse("the torque is a function of time or speed" if not isinstance(torque, Load) else TABLE)
    if varying:
        _refuse(f"{varying[0]} varies with the motion")
    if np.any(mu):
        _refuse("friction hangs on the acceleration that it changes")
    if given:
        _refuse(f"{given[0]}= is for an integrator")


def _refuse(why: str) -> None:
    raise ValueError(f"method = 'energy': {why}; without method= the integrator follows")


def no_energy_form(rows: Any, count: int) -> str:
    """The message for designs that the energy form has given up."""
    return (
        f"method = 'energy': {rows.size} of {count} designs, the first of them number {rows[0]}, have no "
        "energy form that ends: they approach an equilibrium, have no inertia at some angle, or a limit "
        "angle without mass on rod or slider"
    )
