"""The names of units with their exact sizes in SI."""

from fractions import Fraction
from typing import NamedTuple

from . import dimensions as of
from .dimensions import Unit

PI = Fraction("3.14159265358979323846264338327950288419716939937510")
GRAVITY, POUND, INCH = Fraction("9.80665"), Fraction("0.45359237"), Fraction("0.0254")
_POUND_FORCE, _FOOT = POUND * GRAVITY, 12 * INCH
_POWER_OF_TEN = {"G": 9, "M": 6, "k": 3, "h": 2, "d": -1, "c": -2, "m": -3, "n": -9}
_POWER_OF_TEN |= dict.fromkeys("uµμ", -6)


class ScaledUnit(NamedTuple):
    """A unit: its exact size in the coherent SI unit, and that unit."""

    size: Fraction
    si: Unit


def _names(names: str, si: Unit, size: Fraction | int = 1) -> dict[str, ScaledUnit]:
    return dict.fromkeys(names.split(), ScaledUnit(Fraction(size), si))


def _prefixed(symbol: str, prefixes: str, si: Unit, size: Fraction | int = 1) -> dict[str, ScaledUnit]:
    """A symbol without and with each of these prefixes."""
    sizes = {prefix: size * Fraction(10) ** _POWER_OF_TEN[prefix] for prefix in prefixes}
    return {symbol: ScaledUnit(Fraction(size), si)} | {
        prefix + symbol: ScaledUnit(scaled, si) for prefix, scaled in sizes.items()
    }


UNITS = {
    **_prefixed("m", "kdcmuµμn", of.LENGTH),
    **_names("inch inches in", of.LENGTH, INCH),
    **_names("foot feet ft", of.LENGTH, _FOOT),
    **_prefixed("s", "muµμn", of.TIME),
    **_names("minute minutes min", of.TIME, 60),
    **_names("hour hours h hr", of.TIME, 3600),
    **_prefixed("rad", "muµμ", of.ANGLE),
    **_names("degree degrees deg °", of.ANGLE, PI / 180),
    **_names("turn revolution rev", of.ANGLE, 2 * PI),
    **_names("rpm RPM revolutions_per_minute", of.ANGULAR_SPEED, PI / 30),
    **_prefixed("Hz", "kM", of.PER_TIME),
    **_prefixed("g", "kmuµμ", of.MASS, Fraction(1, 1000)),
    **_names("t", of.MASS, 1000),
    **_names("pound pounds lb", of.MASS, POUND),
    **_names("ounce ounces oz", of.MASS, POUND / 16),
    **_prefixed("N", "GMkhdcmuµμ", of.FORCE),
    **_names("kgf", of.FORCE, GRAVITY),
    **_names("lbf", of.FORCE, _POUND_FORCE),
    **_prefixed("J", "GMkm", of.ENERGY),
    **_prefixed("W", "GMkm", of.POWER),
    **_names("horsepower hp", of.POWER, 550 * _FOOT * _POUND_FORCE),
    **_prefixed("Pa", "GMkhm", of.PRESSURE),
    **_prefixed("bar", "km", of.PRESSURE, 10**5),
    **_names("psi", of.PRESSURE, _POUND_FORCE / INCH**2),
    **_names("standard_gravity", of.ACCELERATION, GRAVITY),
    **_names("percent %", of.NONE, Fraction(1, 100)),
}
# Units whose letters people write in the wrong case, or without the blank, by SI unit.
COMMON = {
    "m": ("mm", "cm", "m"),
    "rad": ("deg", "rad"),
    "rad/s": ("rpm",),
    "kg": ("kg", "g"),
    "N": ("kN", "N"),
    "N*m": ("N m", "kN m", "N mm"),
    "kg*m^2": ("kg m^2", "kg m2", "kg mm^2", "kg mm2"),
    "W": ("kW", "W"),
    "J": ("kJ", "J"),
}


def did_you_mean_unit(unit: str, si: str) -> str:
    """The question "did you mean kN? " for kn, which is a knot, or "N m" for Nm; empty for other units."""
    letters = unit.replace(" ", "").lower()
    others = (name for name in COMMON.get(si, ()) if name != unit)
    near = next((name for name in others if name.replace(" ", "").lower() == letters), "")
    return f"did you mean {near}? " if near else ""
