"""The inputs of the mechanism: what each is, its unit, its limits."""

from math import inf
from typing import Any, NamedTuple, TypedDict


class Input(NamedTuple):
    """An input: a finite number of at least `least`."""

    name: str
    unit: str
    meaning: str
    least: float | None = None
    limit: str = "a finite number"


class Inputs(TypedDict, total=False):
    """The inputs as keyword arguments, for editors and type checkers; a test compares them with INPUTS."""

    theta: Any
    ec: Any
    AB: Any
    BC: Any
    omega0: Any
    alpha: Any
    omega: Any
    m_crank: Any
    m_rod: Any
    m_slider: Any
    I_crank: Any
    I_rod: Any
    r_crank: Any
    r_rod: Any
    F_X: Any
    F_Y: Any
    g_X: Any
    g_Y: Any
    mu: Any


TINY = 5e-324  # the least number that is more than nothing: a rod of 0 is no rod
_INERTIA = "a finite moment of inertia >= 0"

INPUTS = {
    row.name: row
    for row in (
        Input("theta", "rad", "crank angle, from the slider axis"),
        Input("ec", "m", "eccentricity: the slider axis is at X = -ec"),
        Input("AB", "m", "crank length", 0.0, "a finite length >= 0"),
        Input("BC", "m", "length of the connecting rod", TINY, "a finite length > 0"),
        Input("omega0", "rad/s", "angular speed of the crank at theta = 0"),
        Input("alpha", "rad/s^2", "angular acceleration of the crank, constant"),
        Input("omega", "rad/s", "angular speed of the crank at this instant, instead of omega0"),
        Input("m_crank", "kg", "mass of the crank", 0.0, "a finite mass >= 0"),
        Input("m_rod", "kg", "mass of the connecting rod", 0.0, "a finite mass >= 0"),
        Input("m_slider", "kg", "mass of the slider", 0.0, "a finite mass >= 0"),
        Input("I_crank", "kg*m^2", "moment of inertia of the crank about its centre of mass", 0.0, _INERTIA),
        Input("I_rod", "kg*m^2", "moment of inertia of the rod about its centre of mass", 0.0, _INERTIA),
        Input("r_crank", "m", "from the crank centre towards the crank pin: the crank's centre of mass"),
        Input("r_rod", "m", "from the crank pin towards the slider: the rod's centre of mass"),
        Input("F_X", "N", "external force on the slider along X"),
        Input("F_Y", "N", "external force on the slider along Y"),
        Input("g_X", "m/s^2", "gravity along X"),
        Input("g_Y", "m/s^2", "gravity along Y"),
        Input("mu", "1", "Coulomb friction coefficient of the slider's guide", 0.0, "a finite number >= 0"),
    )
}
SAFE = 1e-100, 1e100  # magnitudes between which nothing overflows, nor underflows to a wrong value
LEAST = {name: row.least for name, row in INPUTS.items() if row.least is not None}


def is_good(name: str, value: float) -> bool:
    """True for a valid value of this input."""
    least = INPUTS[name].least
    return -inf < value < inf and (least is None or least <= value)
