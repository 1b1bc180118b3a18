"""The constants of the written-out sine and cosine, from generated/."""

from functools import cache
from typing import TYPE_CHECKING

from ..compiler.passes.trigonometry import Trigonometry
from ..support.forks import IMPORTS, imported

if TYPE_CHECKING:
    from ..compiler.passes.double_angles import DoubleTrigonometry


@cache
def constants() -> Trigonometry:
    """Sine and cosine coefficients for float64."""
    return Trigonometry(**imported("desaxe.generated.trigonometry").CONSTANTS)


@cache
def double_constants() -> "DoubleTrigonometry":
    """Sine and cosine coefficients for double-double."""
    with IMPORTS:
        from ..compiler.passes.double_angles import DoubleTrigonometry

    return DoubleTrigonometry(**imported("desaxe.generated.trigonometry").DOUBLE)


def limit_of(accuracy: str) -> float:
    """The largest angle that the written-out sine and cosine of an accuracy reduce exactly."""
    return double_constants().limit if accuracy == "extended" else constants().limit
