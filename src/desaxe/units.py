"""Units at the border: text such as "10 mm" and pint quantities become SI numbers (extra `units`)."""

from functools import cache
from typing import Any

from ._quantity_text import quantity_text
from .extras import MissingExtraError, needed
from .inputs import INPUTS


@cache
def registry() -> Any:
    """pint's registry; revolutions per minute are turns of 2 pi."""
    with needed("a value with a unit"):
        import pint
    return pint.UnitRegistry()


def in_si(name: str, value: Any) -> Any:
    """The magnitude of a text or pint quantity in the SI unit of an input; errors name both."""
    return in_unit(name, value, INPUTS[name].unit)


def in_unit(name: str, value: Any, unit: str) -> Any:
    """The magnitude of a text or pint quantity in a unit."""
    if isinstance(value, str):
        plain = _plain_number(value)
        if plain is not None:
            return plain
        value = _parsed(name, value)
    try:
        return value.to(unit).magnitude
    except Exception as error:
        raise ValueError(f"{name} = {value}: not a quantity in {unit} ({error})") from None


def _plain_number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _parsed(name: str, text: str) -> Any:
    try:
        return registry().Quantity(quantity_text(text))
    except MissingExtraError:
        raise
    except Exception as error:
        raise ValueError(f"{name} = {text!r}: cannot be read as a number with a unit ({error})") from None
