"""Public functions of `desaxe`: those of its rooms, which warn of slips of units in their keywords.

A number beyond the size that is typical of an input is almost certainly in another unit than it is taken for.
"""

from collections.abc import Callable, Mapping
from functools import wraps
from math import inf, pi
from typing import Any, NamedTuple, ParamSpec, TypeVar

from ..support.forks import imported
from .inputs import UNITS

P = ParamSpec("P")
T = TypeVar("T")
FORCES = ("F_X", "F_Y")
FARTHEST = 20.0  # m: no size of a mechanism is larger


class Typical(NamedTuple):
    """A kind of input: above `most` it is a slip, unless it is above `beyond` as well: then it is meant.

    remedy  to be written instead, of the number that was written; another unit alone where it is smaller
    unit    the SI unit
    """

    most: float
    beyond: float
    remedy: str
    unit: str = "1"


SIZE = Typical(FARTHEST, 2e4, '"{number:.6g} mm"', "m")
TURNS = Typical(4.0 * pi, 3600.0, '"{number:.6g} deg"', "rad")
SPEED = Typical(1000.0, 1e5, '"{number:.6g} rpm"', "rad/s")
MASS = Typical(1e5, 1e8, '"{number:.6g} g"', "kg")
GRAVITY = Typical(100.0, 1e5, '"{earth:.2f} m/s^2"', "m/s^2")
_BY_UNIT = {kind.unit: kind for kind in (TURNS, SIZE, SPEED, MASS, GRAVITY)}
SHARE, MOST_PERCENT = Typical(3.0, inf, '"{number:.6g} %"'), 100.0
KINDS = {
    **{name: _BY_UNIT[unit] for name, unit in UNITS.items() if unit in _BY_UNIT},
    "Y": SIZE,
    "mu": Typical(10.0, 100.0, "{hundredth:.6g}"),
    "breakdown_slip": SHARE,
}
# Numbers up to which a function need not look closer; those of offsets and forces depend on the lengths.
HARMLESS = {name: kind.most for name, kind in KINDS.items()} | {"ec": 0.3, "F_X": 1e4, "F_Y": 1e4}
LOOKS = [1000]  # calls that are still looked at: what a person has typed is among the first of a process


def warning(function: Callable[P, T]) -> Callable[P, T]:
    """Make the public function of `desaxe`, which warns of slips in its keywords: once for each kind."""

    @wraps(function)
    def public(*args: P.args, **inputs: P.kwargs) -> T:
        if LOOKS[0]:
            LOOKS[0] -= 1
            if not all(map(_is_harmless, inputs, inputs.values())):
                imported("desaxe.mechanism.slips").warn_of_slips(inputs, inputs=inputs, once=True)
        try:
            return function(*args, **inputs)
        except TypeError as error:
            if args and "positional argument" in str(error):
                error.args = (f"{error}; inputs are given by name, such as theta=1.0",)
            raise

    public.__module__ = "desaxe"
    return public


def _is_harmless(name: str, value: Any) -> bool:
    """True for a value that needs no closer look."""
    if type(value) is float or type(value) is int:
        return name not in HARMLESS or -HARMLESS[name] <= value <= HARMLESS[name]
    if name in FORCES:
        return bool(getattr(value, "largest", inf) <= HARMLESS[name])
    return not isinstance(value, (str, tuple, list, Mapping))
