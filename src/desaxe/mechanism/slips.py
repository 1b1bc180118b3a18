"""Plain numbers that are almost certainly in another unit than they are taken for, such as a crank of 125 m.

A warning, never an error, for numbers that a person has typed, in a few digits: also the ends of ranges and
the largest number of a list, never an array. A force has no size of its own by which a slip would show; but
none is larger than what the rod could carry.
"""

import sys
import warnings
from collections.abc import Iterator, Mapping
from math import isclose, pi
from types import MappingProxyType
from typing import Any, NamedTuple

from ..support.lazy import np
from ..support.shown import with_unit
from ..units.parse import factor_to_si
from ..units.system import Conversion
from ..units.text import plain_number
from .inputs import INPUTS
from .public import FARTHEST, FORCES, GRAVITY, KINDS, MOST_PERCENT, SHARE, SIZE, TURNS, Typical
from .quantity_units import SI, UnitSystem
from .ranges import Between, PlusMinus
from .read import number_of

SPANS, SHORTEST = ("AB", "BC", "spacing"), 5e-4  # m: shorter ones are in metres where another unit is meant
PHASES = ("phase", "bank", "firing")  # whose steps are of a turn
WEAKEST = 0.1  # m/s^2: a gravity below is in m/s^2 where another unit is meant
SMALL_OFFSET = 5e-4  # of the crank: no smaller one is meant to be one
LARGE_OFFSET = 5.0  # of crank and rod: a larger one is in millimetres
BESIDE = ("AB", "BC", "alpha", *FORCES)  # inputs beside which others are a slip
MOST_LOOKED_AT = 1000  # numbers of a list
STRONGEST = 1e9  # Pa: of steel, in a rod half as thick as it is long; those of presses carry some 2e7
NO_VALUES = ("chunks", "reduce")  # mappings by input of numbers that are none of its values
WARNED: set[Any] = set()  # kinds of slips in calls of functions


class UnitWarning(UserWarning):
    """A number that is almost certainly meant in another unit than the one assumed."""


class Slip(NamedTuple):
    """A slip in words, and its kind."""

    kind: Any
    words: str


def warn_of_slips(
    written: Mapping[str, Any],
    units: UnitSystem = SI,
    stacklevel: int = 3,
    inputs: Mapping[str, Any] = MappingProxyType({}),
    once: bool = False,
) -> None:
    """Warn, in one warning, of plain numbers that are almost certainly slips; `units` are what they mean.

    inputs   in SI units or as texts, beside which an offset is too small or too large, a force too large
    once     of each kind once a process
    """
    inputs = {name: _in_si(name, value) for name, value in inputs.items() if name in BESIDE}
    slips = [slip for name, value in _typed(written) if (slip := _slip(name, value, units, inputs))]
    slips += [*_offset(written.get("ec"), units, inputs), *_forces(inputs, units)]
    if once:
        slips = [slip for slip in slips if slip.kind not in WARNED]
        WARNED.update(slip.kind for slip in slips)
    if slips:
        text = "; ".join(slip.words for slip in slips)
        warnings.warn(f"almost certainly a slip: {text}", UnitWarning, stacklevel=stacklevel)


def _in_si(name: str, value: Any) -> Any:
    """A text in SI units, None where it is no number; any other value as it is."""
    try:
        return number_of(INPUTS[name], value) if isinstance(value, str) else value
    except ValueError:  # which the call itself says
        return None


def _typed(written: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """The numbers that a person typed, by input: of a range both ends, of a list the largest."""
    for name, value in written.items():
        if name in NO_VALUES:
            continue
        if isinstance(value, Mapping):
            yield from _typed(value)
            continue
        numbers = _numbers(value)
        if not isinstance(value, Between):
            numbers = [max(numbers, key=abs)] if numbers else []
        yield from ((name, number) for number in numbers if isinstance(name, str) and _is_typed(number))


def _numbers(value: Any) -> list[float]:
    """The plain numbers that a value has, of those that are doubles; of one with a tolerance the value."""
    if isinstance(value, (list, tuple)):
        parts = value[:1] if isinstance(value, PlusMinus) else [*value[:MOST_LOOKED_AT], *value[-1:]]
    else:
        parts = (value,)
    plain = (plain_number(part) if isinstance(part, str) else part for part in parts)
    numbers = (part for part in plain if isinstance(part, (int, float)) and type(part) in (int, float))
    return [number for number in numbers if abs(number) <= sys.float_info.max]


def _offset(written: Any, units: UnitSystem, inputs: Mapping[str, Any]) -> Iterator[Slip]:
    """An offset that is tiny beside the crank, and none in metres, or in metres and far beyond both links."""
    conversion, AB, BC = units.of("ec"), inputs.get("AB"), inputs.get("BC")
    if not isinstance(AB, float) or isinstance(written, (list, tuple)):
        return
    for ec in _numbers(written):
        si = abs(conversion.to_si(float(ec)))
        if conversion.si != 1 and 0.0 < si < SMALL_OFFSET * AB < abs(ec):
            yield Slip("small ec", f'ec = {ec:.6g} {conversion.unit}, write ec = "{ec:.6g} m"')
        far = isinstance(BC, float) and LARGE_OFFSET * (AB + BC) < si <= FARTHEST
        if conversion.si == 1 and far and _is_typed(ec):
            beside = f"ec = {ec:.6g} m beside links of {AB:.6g} and {BC:.6g} m"
            yield Slip(SIZE, f'{beside}, write ec = "{ec:.6g} mm"')


def _forces(inputs: Mapping[str, Any], units: UnitSystem) -> Iterator[Slip]:
    """Forces, numbers and tables, that no rod of this length could carry."""
    loads = {name: inputs[name] for name in FORCES if inputs.get(name) is not None}
    rods: Any = inputs.get("BC") if loads else 0.0
    if hasattr(rods, "tolist"):
        rods = np.ravel(rods)[:MOST_LOOKED_AT].tolist()
    length = max(_numbers(rods), default=0.0)
    for name, value in loads.items() if SHORTEST < length <= FARTHEST else ():
        numbers = _numbers(value) if isinstance(value, (int, float)) else []
        size = max(map(abs, numbers), default=getattr(value, "largest", 0.0))
        stress = 4.0 * size / length**2
        if stress > STRONGEST and _is_typed(size):
            force, along = units.of(name), units.of("BC")
            yield Slip(
                FORCES,
                f"{name} up to {force.shown(size):.6g} {force.unit} on a rod of {along.shown(length):.6g} "
                f"{along.unit}: half as thick as it is long it would carry {1e-9 * stress:.2g} GPa",
            )


def _slip(name: str, value: float, units: UnitSystem, inputs: Mapping[str, Any]) -> Slip | None:
    """The slip of a number."""
    base = name.partition("[")[0]
    kind = KINDS.get(base)
    if kind is None:
        return None
    conversion = units.of(name)
    si = abs(conversion.to_si(float(value)))
    wrong = kind.most < si <= kind.beyond
    if kind is TURNS:
        wrong = wrong and conversion.unit == "rad" and _is_in_degrees(si) and not inputs.get("alpha")
    if base in PHASES and conversion.unit == "deg" and _is_in_radians(abs(value)):
        return Slip("radians", f'{name} = {value:.6g} deg, write {name} = "{value:.6g} rad"')
    in_si = conversion.si != 1 and ((base in SPANS and si < SHORTEST) or (kind is GRAVITY and si < WEAKEST))
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


def _is_in_radians(angle: float) -> bool:
    """True for a multiple of 15 degrees, from 30 on, in radians of three digits or more."""
    share = angle / (pi / 12.0)
    near = abs(share - round(share)) * (pi / 12.0) < 1e-3 * max(angle, 1.0)
    return near and 2 <= round(share) <= 48 and not (20.0 * angle).is_integer()
