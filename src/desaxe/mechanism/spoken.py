"""Numbers in messages, in the units of the machine or scene whose call it is; SI units without."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

from ..support.forks import IMPORTS
from ..support.shown import shown, with_unit

if TYPE_CHECKING:
    from .quantity_units import UnitSystem

UNITS: "ContextVar[UnitSystem | None]" = ContextVar("UNITS", default=None)


@contextmanager
def speaking(units: "UnitSystem") -> Iterator[None]:
    """Messages written in this block are in these units."""
    before = UNITS.set(units)
    try:
        yield
    finally:
        UNITS.reset(before)


def spoken(name: Any, value: Any, form: str = "", says_unit: bool = False) -> str:
    """The text of a number in SI units, or of a pair, that is a value of this quantity, input or measure.

    form       of its digits, all of them without; what is no number is shown as it is
    says_unit  True: in SI units, too, its unit follows; other units always do
    """
    with IMPORTS:
        from .quantity_units import SI, conversion_of, unit_of

    conversion = conversion_of(unit_of(name), UNITS.get() or SI)
    plain = conversion.si == 1
    unit = conversion.unit if says_unit or not plain else "1"

    if plain and not form:
        return with_unit(shown(value), unit)

    def text(number: Any) -> str:
        return f"{conversion.shown(float(number)):{form or '.15g'}}"

    if hasattr(value, "ndim") and value.ndim:
        return with_unit(shown(conversion.shown(value)), unit)
    parts = value if isinstance(value, (tuple, list)) else (value,)
    if not all(isinstance(part, (int, float)) or hasattr(part, "is_integer") for part in parts):
        return shown(value)
    told = text(value) if parts is not value else f"({', '.join(map(text, parts))})"
    return with_unit(told, unit)


def named(name: str, value: Any, form: str = "") -> str:
    """The text "ec = 30 mm" for an eccentricity of 0.03 m in a machine's millimetres."""
    return f"{name} = {spoken(name, value, form)}"
