"""A value in a message, shortened; a path or another text without what steers a terminal."""

from typing import Any

LONGEST = 80


def printable(value: Any) -> str:
    """A text, or a path, in which control characters and others that no screen shows are spelled out."""
    text = str(value)
    return text if text.isprintable() else repr(text)[1:-1]


def shown(value: Any) -> str:
    """The repr of a value, shortened in the middle."""
    if isinstance(value, int) and abs(value) >= 10**LONGEST:  # Python refuses to write the longest ones
        return f"a whole number of {value.bit_length()} bits"
    try:
        text = repr(value[: 2 * LONGEST] + value[-LONGEST:]) if _is_long(value) else repr(value)
    except Exception:  # of a class that is not ours
        text = f"a value of type {type(value).__name__}"
    text = printable(" ".join(text.split()))
    half = LONGEST // 2
    return text if len(text) <= LONGEST else f"{text[:half]} ... {text[-half:]}"


def _is_long(value: Any) -> bool:
    return isinstance(value, (str, bytes, list, tuple)) and len(value) > 3 * LONGEST


def printed(unit: str) -> str:
    """A unit as it is printed after a number: N m for N*m, nothing for a plain number."""
    return "" if unit == "1" else unit.replace("*", " ")


def with_unit(number: str, unit: str) -> str:
    """The text of a number and its unit."""
    return f"{number} {printed(unit)}".rstrip()


def in_brief(result: list[str], most: int = 30) -> str:
    """The first lines of some differences, as text, and how many lines are left out."""
    lines = "".join(result).splitlines(True)
    rest = len(lines) - most
    more = f"... and {rest} more lines in {len(result)} files\n" if rest > 0 else ""
    return "".join(lines[:most]) + more
