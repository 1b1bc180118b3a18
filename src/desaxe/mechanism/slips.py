"""Plain numbers that are almost surely in another unit than they are taken for, such as a crank of 125 m.

A warning, never an error, for single numbers that a person has typed: never in calls with arrays. A force has
no size of its own by which a slip would show; but none is larger than what the rod could carry.
"""

import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import wraps
from math import isclose, pi
from types import MappingProxyType
from typing import Any, ParamSpec, TypeVar

from ..support.shown import with_unit
from ..units.text import plain_number
from .quantity_units import SI, UnitSystem
from .ranges import Between, PlusMinus

P = ParamSpec("P")
T = TypeVar("T")
SIZES = ("ec", "AB", "BC", "r_crank", "r_rod")
LARGEST = {
    **dict.fromkeys(SIZES, 20.0),
    "omega0": 1000.0,
    "omega": 1000.0,
    **dict.fromkeys(("m_crank", "m_rod", "m_slider"), 1e5),
    **dict.fromkeys(("g_X", "g_Y"), 100.0),
    "mu": 5.0,
    "synchronous_speed": 1000.0,
    "breakdown_slip": 3.0,
}
LARGEST_DOUBLE = sys.float_info.max
SMALLEST = dict.fromkeys(("g_X", "g_Y"), 0.1)
LINKS, SHORTEST = ("AB", "BC"), 5e-4  # shorter ones were given in metres where another unit was named
SMALL_OFFSET = 5e-4  # of the crank: no smaller one is meant to be one
MOST_TURNS = 2.0
FORCES = ("F_X", "F_Y")
STRONGEST = 1e9  # Pa: of steel, in a rod half as thick as it is long; those of presses carry some 2e7
# What to write instead, of the number that was written.
REMEDIES = {
    "theta": '"{number:.6g} deg"',
    **dict.fromkeys(SIZES, '"{number:.6g} mm"'),
    **dict.fromkeys(("omega0", "omega"), '"{number:.6g} rpm"'),
    **dict.fromkeys(("m_crank", "m_rod", "m_slider"), '"{number:.6g} g"'),
    **dict.fromkeys(("g_X", "g_Y"), '"{earth:.2f} m/s^2"'),
    "mu": "{hundredth:.6g}",
    "synchronous_speed": '"{number:.6g} rpm"',
    "breakdown_slip": '"{number:.6g} %"',
}


class UnitWarning(UserWarning):
    """A number that is almost surely meant in another unit than it is taken for."""


def warning(function: Callable[P, T]) -> Callable[P, T]:
    """Make the public function of `desaxe`: it warns of slips in its keywords, which are in SI units."""

    @wraps(function)
    def public(*args: P.args, **inputs: P.kwargs) -> T:
        warn_of_slips(inputs, inputs=inputs)
        return function(*args, **inputs)

    public.__module__ = "desaxe"
    return public


def warn_of_slips(
    written: Mapping[str, Any],
    units: UnitSystem = SI,
    stacklevel: int = 3,
    inputs: Mapping[str, Any] = MappingProxyType({}),
) -> None:
    """Warn once of all plain numbers, by input, that are almost surely slips; `units` are what they mean.

    inputs   in SI units, among which forces are looked for
    """
    found = [told for name, value in _alone(written) if (told := slip(name, value, units))]
    found += _offset_in_metres(written.get("ec"), units, inputs.get("AB"))
    found += slips_of_forces(inputs, units)
    if found:
        message = f"almost surely a slip: {'; '.join(found)}"
        warnings.warn(message, UnitWarning, stacklevel=stacklevel)


def _offset_in_metres(ec: Any, units: UnitSystem, AB: Any) -> list[str]:
    """The warning about an offset that is tiny beside the crank, and none in metres."""
    conversion = units.of("ec")
    if conversion.si == 1 or type(ec) not in (int, float) or type(AB) is not float:
        return []
    if not 0.0 < abs(conversion.to_si(float(ec))) < SMALL_OFFSET * AB or not abs(ec) > SMALL_OFFSET * AB:
        return []
    return [f'ec = {ec:.6g} {conversion.unit}, write ec = "{ec:.6g} m"']


def slips_of_forces(inputs: Mapping[str, Any], units: UnitSystem = SI) -> list[str]:
    """The warnings about forces, numbers and tables, that no rod of this length could carry."""
    length, found = inputs.get("BC", 0.0), []
    rod = max(length, default=0.0) if hasattr(length, "__len__") else length
    for name in FORCES if rod else ():
        value = inputs.get(name)
        size = abs(value) if isinstance(value, (int, float)) else getattr(value, "largest", 0.0)
        stress = 4.0 * size / rod**2
        if stress > STRONGEST:
            force, along = units.of(name), units.of("BC")
            found.append(
                f"{name} up to {force.shown(size):.6g} {force.unit} on a rod of {along.shown(rod):.6g} "
                f"{along.unit}: half as thick as it is long it would carry {1e-9 * stress:.2g} GPa"
            )
    return found


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
    """The warning about a number, or a text without a unit, that is almost surely a slip; else empty."""
    value = plain_number(value) if isinstance(value, str) else value
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
    return with_unit(f"{name} = {value:.6g}", conversion.unit) + f", write {name} = {remedy}"


def _is_share_of_turn(angle: float) -> bool:
    """True for a multiple of 15 degrees in radians, such as pi/6: no slip."""
    share = angle / (pi / 12.0)
    return isclose(share, round(share), rel_tol=1e-12)
