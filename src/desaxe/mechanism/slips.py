"""Plain numbers that are almost surely in another unit than they are taken for, such as a crank of 125 m.

A warning, never an error, for single numbers that a person has typed: never in calls with arrays.
"""

import sys
import warnings
from collections.abc import Iterator, Mapping
from math import isclose, pi
from typing import Any

from .ranges import Between, PlusMinus
from .unit_system import SI, UnitSystem

LENGTHS = ("ec", "AB", "BC", "r_crank", "r_rod")
LARGEST = {
    **dict.fromkeys(LENGTHS, 20.0),
    "omega0": 1000.0,
    "omega": 1000.0,
    **dict.fromkeys(("m_crank", "m_rod", "m_slider"), 1e5),
    **dict.fromkeys(("g_X", "g_Y"), 100.0),
    "mu": 5.0,
}
LARGEST_DOUBLE = sys.float_info.max
SMALLEST = dict.fromkeys(("g_X", "g_Y"), 0.1)
LINKS, SHORTEST = ("AB", "BC"), 5e-4  # shorter ones were given in metres where another unit was named
MOST_TURNS = 2.0
# What to write instead, of the number that was written.
REMEDIES = {
    "theta": '"{number:.6g} deg"',
    **dict.fromkeys(LENGTHS, '"{number:.6g} mm"'),
    **dict.fromkeys(("omega0", "omega"), '"{number:.6g} rpm"'),
    **dict.fromkeys(("m_crank", "m_rod", "m_slider"), '"{number:.6g} g"'),
    **dict.fromkeys(("g_X", "g_Y"), '"{earth:.2f} m/s^2"'),
    "mu": "{hundredth:.6g}",
}


class UnitWarning(UserWarning):
    """A number that is almost surely meant in another unit than it is taken for."""


def warn_of_slips(written: Mapping[str, Any], units: UnitSystem = SI, stacklevel: int = 3) -> None:
    """Warn once of all plain numbers, by input, that are almost surely slips; `units` are what they mean."""
    found = [told for name, value in _alone(written) if (told := slip(name, value, units))]
    if found:
        message = f"almost surely a slip: {'; '.join(found)}"
        warnings.warn(message, UnitWarning, stacklevel=stacklevel)


def _alone(written: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Each value with its input; of one with a tolerance the value, of a range both ends."""
    for name, value in written.items():
        if isinstance(value, PlusMinus):
            yield name, value.value
        elif isinstance(value, Between):
            yield from ((name, end) for end in value)
        else:
            yield name, value


def slip(name: str, value: Any, units: UnitSystem = SI) -> str:
    """The warning about a number that is almost surely a slip; empty for texts, arrays, plausible numbers."""
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, float))
        or not 0.0 < abs(value) <= LARGEST_DOUBLE
    ):
        return ""  # a larger whole number is refused elsewhere
    conversion = units.of(name) if name in REMEDIES else None
    if conversion is None:
        return ""
    si = abs(conversion.to_si(float(value)))
    if name == "theta":
        wrong = si > 2.0 * pi * MOST_TURNS and conversion.unit == "rad" and not _is_share_of_turn(si)
    else:
        wrong = si > LARGEST[name] or si < SMALLEST.get(name, 0.0)
    in_metres = name in LINKS and conversion.si != 1 and si < SHORTEST
    if not wrong and not in_metres:
        return ""
    earth = 9.81 if value > 0 else -9.81
    remedy = '"{number:.6g} m"' if in_metres else REMEDIES[name]
    remedy = remedy.format(number=value, earth=earth, hundredth=value / 100)
    return f"{name} = {value:.6g} {conversion.unit}".removesuffix(" 1") + f", write {name} = {remedy}"


def _is_share_of_turn(angle: float) -> bool:
    """True for a multiple of 15 degrees in radians, such as pi/6: no slip."""
    share = angle / (pi / 12.0)
    return isclose(share, round(share), rel_tol=1e-12)
