"""Public functions of `desaxe`: those of its rooms, which warn of slips of units in their keywords."""

from collections.abc import Callable, Mapping
from functools import wraps
from math import inf
from typing import Any, ParamSpec, TypeVar

from ..support.forks import IMPORTS
from .typical import FORCES, KINDS

P = ParamSpec("P")
T = TypeVar("T")
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
                with IMPORTS:
                    from .slips import warn_of_slips

                warn_of_slips(inputs, inputs=inputs, once=True)
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
