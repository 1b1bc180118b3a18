"""The limits of the energy form: time does not enter, there is no friction, and M_eff stays > 0."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...loads.angles import turns_of, zero_of
from ...loads.load import OverY, TableOverTheta
from .panels import MOST_TURNS, Designs

ENERGY = "energy"  # what `method` of a result says


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
