"""The inputs of the mechanism: what each is, its unit, its limits."""

from math import inf
from typing import NamedTuple


class Input(NamedTuple):
    """One input. It must be finite and at least `least`."""

    name: str
    unit: str
    meaning: str
    least: float | None = None
    limit: str = "a finite number"


# The smallest length that is more than nothing: a rod of 0 is no rod.
_TINY = 5e-324

INPUTS = {
    row.name: row
    for row in (
        Input("theta", "rad", "crank angle, from the slider axis"),
        Input("ec", "m", "eccentricity: the slider axis is at X = -ec"),
        Input("AB", "m", "crank length", 0.0, "a finite length >= 0"),
        Input("BC", "m", "length of the connecting rod", _TINY, "a finite length > 0"),
        Input("omega0", "rad/s", "angular speed of the crank at theta = 0"),
        Input("alpha", "rad/s^2", "angular acceleration of the crank, constant"),
        Input("omega", "rad/s", "angular speed of the crank at this instant, instead of omega0"),
    )
}
LEAST = {name: row.least for name, row in INPUTS.items() if row.least is not None}


def is_good(name: str, value: float) -> bool:
    """Whether a number is one that this input can have."""
    least = INPUTS[name].least
    return -inf < value < inf and (least is None or least <= value)
