"""Inputs near the ends of the double range: the same mechanism in other units.

Squares and products of lengths and speeds overflow there, or lose their digits. So such points are computed
in units of length, time and mass that are powers of two times the SI units: the change is exact, and the
largest length, speed and mass come near 1.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS, SAFE
from ..mechanism.names import LENGTHS
from ..mechanism.spoken import named
from ..runtime.request import Request
from ..support.forks import IMPORTS
from ..units.parse import coherent_unit

LEAST, MOST = SAFE
SPEEDS = {"omega0": 1, "omega": 1, "alpha": 2, "g_X": 2, "g_Y": 2}  # -> its power of 1/time
WIDEST = 1e30
GRAVITY = ("g_X", "g_Y")
SMALLEST = 5e-324
_NOTHING = -(10**6)  # the exponent of 0
Powers = tuple[Any, Any, Any]  # of two, by which m, s and kg are multiplied


def is_extreme(name: str, value: float) -> bool:
    """True for a finite number that is not 0 and beyond LEAST or MOST; angles have no such range."""
    return name != "theta" and value != 0.0 and not LEAST <= abs(value) <= MOST


def check_range(caller: str, name: str, number: float) -> float:
    """The number; ValueError beyond WIDEST, where sums of products of several inputs lose their digits."""
    if name != "theta" and number != 0.0 and not 1.0 / WIDEST <= abs(number) <= WIDEST:
        limit = f"{caller} takes 0 and magnitudes from {1.0 / WIDEST:g} to {WIDEST:g}"
        raise ValueError(f"{named(name, number, 'g')}: {limit}")
    return number


def are_extreme(name: str, values: Any) -> Any:
    """An array of `is_extreme`, or False for an array without one."""
    with IMPORTS:
        import numpy as np

    if name == "theta" or not values.size:
        return False
    if values.min() >= LEAST and values.max() <= MOST:
        return False
    size = np.abs(values)
    if size.min() >= LEAST and size.max() <= MOST:
        return False
    found = (size < LEAST) & (size > 0.0) | (size > MOST) & (size < np.inf)
    return found if found.any() else False


def can_rescale(wanted: Request) -> bool:
    """False for quantities of a user's own, whose constants have units that are not known."""
    return not wanted.form.own


def rescaled(values: Mapping[str, Any]) -> tuple[dict[str, Any], Powers]:
    """The inputs, numbers or arrays that broadcast, in the new units; and these."""
    with IMPORTS:
        import numpy as np

    def exponent(name: str, more: Any = 0) -> Any:
        fraction, power = np.frexp(values[name])
        return np.where(fraction == 0.0, _NOTHING, power + more)

    def largest(exponents: list[Any]) -> Any:
        found = np.maximum.reduce(np.broadcast_arrays(_NOTHING, *exponents))
        return np.where(found == _NOTHING, 0, found)

    m = -largest([exponent(name) for name in LENGTHS if name in values])
    s = largest([exponent(n, m if n in GRAVITY else 0) // p for n, p in SPEEDS.items() if n in values])
    masses = [n for n in values if _powers(n)[2]]
    kg = -largest([exponent(n, shift(INPUTS[n].unit, (m, s, 0))) for n in masses])
    powers = m, s, kg
    new = {n: scaled(value, shift(INPUTS[n].unit, powers)) for n, value in values.items()}
    # too small beside the largest, it keeps its sign
    lost = {n: (v == 0.0) & np.not_equal(values[n], 0.0) for n, v in new.items()}
    return {n: np.where(lost[n], np.copysign(SMALLEST, v), v) for n, v in new.items()}, powers


def in_si(names: Sequence[str], values: Sequence[Any], powers: Powers, state: bool) -> list[Any]:
    """Values in the new units, as values in SI units."""
    units = (quantity(name, state).unit for name in names)
    return [scaled(value, -shift(unit, powers)) for value, unit in zip(values, units, strict=True)]


def _powers(name: str) -> tuple[int, int, int]:
    unit = coherent_unit(INPUTS[name].unit)
    return unit.m, unit.s, unit.kg


def shift(unit: str, powers: Powers) -> Any:
    """The power of two by which numbers in an SI unit are multiplied."""
    exponents = coherent_unit(unit)
    return exponents.m * powers[0] + exponents.s * powers[1] + exponents.kg * powers[2]


def scaled(value: Any, power: Any) -> Any:
    """The value times a power of two; a status, and what has no unit, as it is."""
    with IMPORTS:
        import numpy as np

    if not np.any(power):
        return value
    with np.errstate(all="ignore"):  # what no double holds is inf or 0
        return np.ldexp(value, power)
