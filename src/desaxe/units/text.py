"""A number with its unit as text.

Nothing but a number and a unit passes: no sums, lists or decimal commas, which a unit library may
take for something else ("1,5 rad" for 15 rad).
"""

import re
from collections.abc import Sequence

from .dimensions import product

_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_FACTOR = r"(?:[^\W\d_]+(?:_[^\W\d_]+)*(?:(?:\^|\*\*)?-?[1-9])?|%|\u00b0)"
_UNIT = rf"(?:1?\s*/\s*)?{_FACTOR}(?:\s*[*/\u00b7]\s*{_FACTOR}|\s+{_FACTOR})*"
_FORM, _UNIT_ALONE = re.compile(rf"\s*({_NUMBER})\s*({_UNIT})?\s*"), re.compile(rf"\s*{_UNIT}\s*")
_TERM = re.compile(r"(/?)\s*([^\W\d]+|%|\u00b0)(?:\^(-?[0-9]+))?")
PLUS_MINUS = re.compile(r"\u00b1|\+-|\+/-")  # between a value and its tolerance
_SUPERSCRIPTS = str.maketrans("\u00b2\u00b3", "23")


def split_quantity(text: str, example: str = '"125 mm"') -> tuple[str, str]:
    """The number and the unit (may be empty) of a text; ValueError where it is anything else."""
    match = _FORM.fullmatch(text)
    if match is None:
        raise ValueError(f"it must be a number, or a number with a unit such as {example}{_remedy(text)}")
    return match[1], match[2] or ""


def _remedy(text: str) -> str:
    """The remedy for a text that is no quantity; empty for one whose mistake is unknown."""
    if re.search(r"[0-9],[0-9]", text):
        return "; a decimal point is a point, not a comma"
    if re.search(r"[0-9\w]\s*[-+*/(]\s*[0-9\w(]", text):
        return "; a text is not computed: give the number itself, as math.pi / 2 is"
    return ""


def terms_of(unit: str) -> list[tuple[str, int]]:
    """The names and powers of a unit, `kg m2/s^2`, with a division for one term each; ValueError for none."""
    text = spelled(unit)
    if text.strip() == "1":
        return []
    if _UNIT_ALONE.fullmatch(text) is None:
        raise ValueError("unknown unit")
    return [(name, (-1 if slash else 1) * int(power or 1)) for slash, name, power in _TERM.findall(text)]


def with_unit_of(other: object, text: object) -> object:
    """A text that is a number alone with the unit of another text; anything else as it is.

    A drawing's "12 mm +- 0.1" is a tolerance of 0.1 mm.
    """
    if isinstance(text, str) and isinstance(other, str):
        parts, known = _FORM.fullmatch(text), _FORM.fullmatch(other)
        if parts and known and known[2] and not parts[2]:
            return f"{parts[1]} {known[2]}"
    return text


def spelled(unit: str) -> str:
    """A unit in the spelling of the catalogue: m/s^2 for m/s2."""
    return re.sub(r"([^\W\d_])(?:\*\*)?(-?[1-9])(?![0-9])", r"\1^\2", unit.translate(_SUPERSCRIPTS))


def quotient(unit: str, others: Sequence[str]) -> str:
    """The unit of a derivative, reduced: of N*m by m it is N, of m/s^2 by rad/s m/s/rad."""
    powers: dict[str, int] = {}
    for text, sign in ((unit, 1), *((other, -1) for other in others)):
        for name, power in terms_of(text):
            powers[name] = powers.get(name, 0) + sign * power
    return product(powers)


def quantity_text(text: str) -> str:
    """A number with its unit in the spelling of the catalogue; ValueError where it is anything else."""
    number, unit = split_quantity(text)
    return f"{number} {spelled(unit)}".rstrip()


def plain_number(text: str) -> float | None:
    """The number that a text is; None for anything else, and for what Python alone reads as one: 1_0, ١."""
    if "_" in text or not text.isascii():
        return None
    try:
        return float(text)
    except ValueError:
        return None
