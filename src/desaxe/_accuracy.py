"""The accuracies that can be asked for, and which of them keeps an error that a user states.

The error of a value is relative, and in proportion to 1 + the sum of its condition numbers: what the
last digits of the inputs change anyway is not counted against it.
"""

from typing import Any

from ._constants import double_constants

# Accuracy -> the error that it keeps; the fastest one first.
BOUNDS = {"fast": 8 * 2.0**-24, "standard": 8 * 2.0**-52, "extended": 2 * 2.0**-52}


def accuracy_of(asked: Any) -> str:
    """One of the accuracies by its name, or the fastest one that keeps a stated error."""
    if isinstance(asked, str) and asked in BOUNDS:
        return asked
    if not isinstance(asked, (int, float)) or isinstance(asked, bool):
        raise ValueError(f"accuracy = {asked!r}: it is one of {', '.join(BOUNDS)}, or an error such as 1e-9")
    kept = next((name for name, bound in BOUNDS.items() if bound <= asked), "")
    if not kept:
        raise ValueError(f"accuracy = {asked!r}: the smallest error is {BOUNDS['extended']:.2g}")
    return kept


def check_angle(accuracy: str, theta: float) -> None:
    """Refuse an angle that the accuracy cannot reduce exactly."""
    if accuracy == "extended" and abs(theta) > double_constants().limit:
        reach = f"accuracy='extended' reaches |theta| <= {double_constants().limit:.0f} rad"
        raise ValueError(f"theta = {theta!r}: {reach}")
