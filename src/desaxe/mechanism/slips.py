"""Plain numbers that are almost surely in another unit than they are taken for, such as a crank of 125 m.

A warning, never an error, for single numbers that a person has typed, in a few digits: never for arrays and
their elements. A force has no size of its own by which a slip would show; but none is larger than what the
rod could carry.
"""

import sys
import warnings
from collections.abc import Iterator, Mapping
from math import isclose, pi
from types import MappingProxyType
from typing import Any, NamedTuple

from ..support.shown import with_unit
from ..units.parse import factor_to_si
from ..units.system import Conversion
from ..units.text import plain_number
from .inputs import INPUTS
from .quantity_units import SI, UnitSystem
from .ranges import Between, PlusMinus
from .read import number_of
from .typical import (
    FARTHEST,
    FORCES,
    GRAVITY,
    KINDS,
    MOST_PERCENT,
    SHARE,
    SIZE,
    TURNS,
    Typical,
)

LINKS, SHORTEST = ("AB", "BC"), 5e-4  # m: shorter ones are in metres where another unit is meant
WEAKEST = 0.1  # m/s^2: a gravity below is in m/s^2 where another unit is meant
SMALL_OFFSET = 5e-4  # of the crank: no smaller one is meant to be one
LARGE_OFFSET = 5.0  # of crank and rod: a larger one is in millimetres
BESIDE = ("AB", "BC", "alpha", *FORCES)  # inputs beside which others are a slip
STRONGEST = 1e9  # Pa: of steel, in a rod half as thick as it is long; those of presses carry some 2e7
WARNED: set[Any] = set()  # kinds of slips in calls of functions


class UnitWarning(UserWarning):
    """A number that is almost surely meant in another unit than it is taken for."""


class Slip(NamedTuple):
    """A slip in words, and its kind."""

    kind: Any
    words: str


def warn_once(inputs: Mapping[str, Any]) -> None:
    """Warn of slips in the keywords of a public function; of each kind once a process."""
    slips = [slip for slip in slips_in(inputs, SI, inputs) if slip.kind not in WARNED]
    if slips:
        WARNED.update(slip.kind for slip in slips)
        _warn(slips, 4)


def warn_of_slips(
    written: Mapping[str, Any],
    units: UnitSystem = SI,
    stacklevel: int = 3,
    inputs: Mapping[str, Any] = MappingProxyType({}),
) -> None:
    """Warn of all slips in one warning; the arguments are those of `slips_in`."""
    slips = slips_in(written, units, inputs)
    if slips:
        _warn(slips, stacklevel + 1)


def _warn(slips: list[Slip], stacklevel: int) -> None:
    text = "; ".join(slip.words for slip in slips)
    warnings.warn(f"almost surely a slip: {text}", UnitWarning, stacklevel=stacklevel)


def slips_in(
    written: Mapping[str, Any], units: UnitSystem = SI, inputs: Mapping[str, Any] = MappingProxyType({})
) -> list[Slip]:
    """The plain numbers, by input, that are almost surely slips; `units` are what they mean.

    inputs   in SI units or as texts, beside which an offset is too small or too large, a force too large
    """
    inputs = {name: _in_si(name, value) for name, value in inputs.items() if name in BESIDE}
    slips = [slip for name, value in _alone(written) if (slip := _slip(name, value, units, inputs))]
    return [*slips, *_offset(written.get("ec"), units, inputs), *_forces(inputs, units)]


def _in_si(name: str, value: Any) -> Any:
    """A text in SI units, None where it is no number; any other value as it is."""
    try:
        return number_of(INPUTS[name], value) if isinstance(value, str) else value
    except ValueError:  # which the call itself says
        return None


def _offset(ec: Any, units: UnitSystem, inputs: Mapping[str, Any]) -> Iterator[Slip]:
    """An offset that is tiny beside the crank, and none in metres, or in metres and far beyond both links."""
    conversion, AB, BC = units.of("ec"), inputs.get("AB"), inputs.get("BC")
    ec = plain_number(ec) if isinstance(ec, str) else ec
    if type(ec) not in (int, float) or type(AB) is not float or abs(ec) > sys.float_info.max:
        return
    si = abs(conversion.to_si(float(ec)))
    if conversion.si != 1 and 0.0 < si < SMALL_OFFSET * AB < abs(ec):
        yield Slip("small ec", f'ec = {ec:.6g} {conversion.unit}, write ec = "{ec:.6g} m"')
    far = type(BC) is float and LARGE_OFFSET * (AB + BC) < si <= FARTHEST
    if conversion.si == 1 and far and _is_typed(ec):
        yield Slip(SIZE, f'ec = {ec:.6g} m beside links of {AB:.6g} and {BC:.6g} m, write ec = "{ec:.6g} mm"')


def _forces(inputs: Mapping[str, Any], units: UnitSystem) -> Iterator[Slip]:
    """Forces, numbers and tables, that no rod of this length could carry."""
    length = inputs.get("BC", 0.0)
    if isinstance(length, tuple) or getattr(length, "ndim", 0) == 1:
        length = max((one for one in length if isinstance(one, (int, float))), default=0.0)
    if not isinstance(length, (int, float)) or not SHORTEST < length <= FARTHEST:
        return
    for name in FORCES:
        value = inputs.get(name)
        size = abs(value) if isinstance(value, (int, float)) else getattr(value, "largest", 0.0)
        stress = 4.0 * size / length**2
        if stress > STRONGEST and _is_typed(size):
            force, along = units.of(name), units.of("BC")
            yield Slip(
                FORCES,
                f"{name} up to {force.shown(size):.6g} {force.unit} on a rod of {along.shown(length):.6g} "
                f"{along.unit}: half as thick as it is long it would carry {1e-9 * stress:.2g} GPa",
            )


def _alone(written: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Each value with its input; of one with a tolerance the value, of a range both ends."""
    for name, value in written.items():
        if isinstance(value, PlusMinus):
            yield name, value.value
        elif isinstance(value, Between):
            yield from ((name, end) for end in value)
        else:
            yield name, value


def _slip(name: str, value: Any, units: UnitSystem, inputs: Mapping[str, Any]) -> Slip | None:
    """The slip of a number, or of a text without a unit."""
    kind = KINDS.get(name)
    value = plain_number(value) if isinstance(value, str) else value
    conversion = units.of(name) if kind else None
    if kind is None or conversion is None or type(value) not in (int, float) or not _is_typed(value):
        return None
    si = abs(conversion.to_si(float(value)))
    wrong = kind.most < si <= kind.beyond
    if kind is TURNS:
        wrong = wrong and conversion.unit == "rad" and _is_in_degrees(si) and not inputs.get("alpha")
    in_si = conversion.si != 1 and ((name in LINKS and si < SHORTEST) or (kind is GRAVITY and si < WEAKEST))
    if not wrong and not in_si:
        return None
    remedy = '"{number:.6g} m"' if in_si and kind is SIZE else kind.remedy
    remedy = remedy.format(number=value, earth=9.81 if value > 0 else -9.81, hundredth=value / 100)
    written = with_unit(f"{name} = {value:.6g}", conversion.unit)
    if kind is SHARE and value > MOST_PERCENT:
        return Slip(kind, f"{written}, where a slip of 1 is standstill: is it a speed, in the wrong order?")
    if wrong and not _is_in_smaller_unit(remedy, kind, conversion):
        limit = with_unit(f"{conversion.shown(kind.most):.6g}", conversion.unit)
        return Slip(kind, f"{written}, where more than {limit} is unusual")
    return Slip(kind, f"{written}, write {name} = {remedy}")


def _is_in_smaller_unit(remedy: str, kind: Typical, conversion: Conversion) -> bool:
    """False for a remedy in the unit that was meant anyhow, or in a larger one."""
    unit = remedy.strip('"').partition(" ")[2]
    return not unit or kind is GRAVITY or factor_to_si(unit, unit, kind.unit) < conversion.si


def _is_typed(value: float) -> bool:
    """True for a finite number other than 0 that a person writes: it has few digits."""
    return 0.0 < abs(value) < 1e15 and float(f"{value:.6g}") == value


def _is_in_degrees(angle: float) -> bool:
    """True for whole and half degrees; a multiple of 15 degrees in radians, such as pi/6, is none."""
    share = angle / (pi / 12.0)
    return (2.0 * angle).is_integer() and not isclose(share, round(share), rel_tol=1e-12)
