"""Checks of options, with errors that name the option, the value and the limit."""

from typing import Any

from .shown import shown


def whole_number(name: str, value: Any, least: int, most: int) -> int:
    """A whole number within limits; a NumPy integer is one, a boolean is none."""
    whole = hasattr(value, "__index__") and getattr(value, "shape", ()) == () and not isinstance(value, bool)
    if not whole or not least <= int(value) <= most:
        raise ValueError(f"{name} = {shown(value)}: a whole number, at least {least} and at most {most}")
    return int(value)


def yes_or_no(**options: Any) -> None:
    """TypeError for an option that is neither True nor False."""
    for name, value in options.items():
        if not isinstance(value, bool):
            raise TypeError(f"{name} = {shown(value)}: it is True or False")


def real_number(name: str, value: Any) -> float:
    """A real number as a float, which may be inf or NaN; no text, no boolean, no array."""
    kind = getattr(getattr(value, "dtype", None), "kind", "f")
    plain = isinstance(value, (int, float)) or hasattr(value, "dtype")
    if isinstance(value, bool) or not plain or kind not in "fiu" or getattr(value, "shape", ()) != ():
        raise TypeError(f"{name} = {shown(value)}: expected a number")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} = {shown(value)}: it is beyond the largest double, 1.8e308") from None
