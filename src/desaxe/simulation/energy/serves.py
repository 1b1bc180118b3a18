"""The limits of the energy form: time does not enter, there is no friction, and M_eff stays > 0."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...loads.angles import turns_of, zero_of
from ...loads.load import OverY, TableOverTheta
from .panels import MOST_TURNS, Designs

ENERGY, PANELS, INTEGRATOR = "energy", "panels", "DOP853"  # what `method` of a result says


def served(designs: Designs) -> Any:
    """True for each design whose motion is smooth in its coordinate up to the limit angles, if it has any."""
    there = np.isfinite(designs.middle)
    if isinstance(designs.force, OverY):
        there &= np.isfinite(zero_of(designs.force, designs.lengths, designs.branch))
    return there


def tables_alone(varying: Mapping[str, Any], mu: Any) -> bool:
    """True where all that varies with the motion are tables that repeat after few turns, without friction."""
    if np.any(mu) or not all(_is_table(name, load) for name, load in varying.items()):
        return False
    try:
        turns_of("simulate", varying, MOST_TURNS)
    except ValueError:
        return False
    return True


def _is_table(name: str, load: Any) -> bool:
    return isinstance(load, TableOverTheta) or (isinstance(load, OverY) and name != "torque")


def refuse(varying: Mapping[str, Any], mu: Any, options: Mapping[str, bool]) -> None:
    """ValueError where the energy form is asked for and cannot serve.

    options   those of an integrator, and whether each is given
    """
    given = [name for name, there in options.items() if there]
    other = [name for name, load in varying.items() if callable(load) and not _is_table(name, load)]
    if other:
        _refuse(f"the {other[0]} is a function, of time or speed perhaps; give a table")
    if np.any(mu):
        _refuse("friction hangs on the acceleration that it changes")
    if not tables_alone({n: v for n, v in varying.items() if callable(v)}, mu):
        _refuse(f"the loads do not repeat after {MOST_TURNS} turns")
    if given:
        _refuse(f"{given[0]} is for an integrator")


def _refuse(why: str) -> None:
    raise ValueError(f"method = 'energy': {why}; without method= the integrator follows")


def no_energy_form(designs: str) -> str:
    """The message for designs that the energy form has given up."""
    return (
        f"method = 'energy': {designs} no energy form that ends: an equilibrium that is approached, no "
        "inertia at some angle, or a limit angle without mass on rod or slider"
    )


def some_of(rows: Any, count: int) -> str:
    """Designs among many, in words."""
    return f"{rows.size} of {count} designs, the first of them number {rows[0]}, have"
