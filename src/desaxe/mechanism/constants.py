"""The constants of the written-out sine and cosine, from generated/."""

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from ..compiler.passes.trigonometry import Trigonometry

if TYPE_CHECKING:
    from ..compiler.passes.double_angles import DoubleTrigonometry


@cache
def constants() -> Trigonometry:
    """Sine and cosine coefficients for float64."""
    return Trigonometry(**import_module("desaxe.generated.trigonometry").CONSTANTS)


@cache
def double_constants() -> "DoubleTrigonometry":
    """Sine and cosine coefficients for double-double."""
    from ..compiler.passes.double_angles import DoubleTrigonometry

    return DoubleTrigonometry(**import_module("desaxe.generated.trigonometry").DOUBLE)
