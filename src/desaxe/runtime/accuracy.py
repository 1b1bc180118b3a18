"""The accuracies by name, and the cheapest one that keeps a given error.

The error of a value is relative, and in proportion to 1 + the sum of its condition numbers: what the
last digits of the inputs change anyway is not counted against it.
"""

from typing import Any

from ..mechanism.constants import double_constants
from ..mechanism.messages import amount, named
from ..support.shown import shown

ACCURACIES = ("standard", "extended")
# Accuracy -> the error that it keeps everywhere; the cheaper one first.
BOUNDS = {"standard": 8 * 2.0**-52, "extended": 2 * 2.0**-52}


def accuracy_of(asked: Any) -> str:
    """The accuracy of this name, or the cheapest one that keeps a given error everywhere."""
    if isinstance(asked, str) and asked in ACCURACIES:
        return asked
    if not isinstance(asked, (int, float)) or isinstance(asked, bool):
        known = ", ".join(ACCURACIES)
        raise ValueError(f"accuracy = {shown(asked)}: it is one of {known}, or an error such as 1e-9")
    kept = next((name for name, bound in BOUNDS.items() if bound <= asked), "")
    if not kept:
        raise ValueError(f"accuracy = {shown(asked)}: the smallest error is {BOUNDS['extended']:.2g}")
    return kept


def check_angle(accuracy: str, theta: float) -> None:
    """Refuse an angle that the accuracy cannot reduce exactly."""
    if accuracy == "extended" and abs(theta) > double_constants().limit:
        reach = amount("theta", double_constants().limit, ".0f", says_unit=True)
        raise ValueError(named("theta", theta) + ": accuracy='extended' reaches |theta| <= " + reach)
