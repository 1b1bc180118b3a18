"""Messages whose numbers are quantities: in SI units as text, in a front end's units at its border.

A message is put together with `+`, not in an f-string, which would leave the SI text alone of it.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from ..support.forks import IMPORTS
from ..support.shown import shown, with_unit

if TYPE_CHECKING:
    from .quantity_units import UnitSystem


class NamedValue(NamedTuple):
    """A number in SI units, or a pair, that is a value of a quantity, input or measure.

    form       of its digits, all of them without; what is no number is shown as it is
    says_unit  True: in SI units, too, its unit follows; other units always do
    """

    name: Any
    value: Any
    form: str = ""
    says_unit: bool = False

    def text(self, system: "UnitSystem | None" = None) -> str:
        """The number in the units of a system; in SI units without."""
        with IMPORTS:
            from .quantity_units import SI, conversion_of, unit_of

        conversion = conversion_of(unit_of(self.name), system or SI)
        value, plain = self.value, conversion.si == 1
        unit = conversion.unit if self.says_unit or not plain else "1"

        if plain and not self.form:
            return with_unit(shown(value), unit)
        if getattr(value, "ndim", 0):
            return with_unit(shown(conversion.shown(value)), unit)
        parts = value if isinstance(value, (tuple, list)) else (value,)
        if not all(isinstance(part, (int, float)) or hasattr(part, "is_integer") for part in parts):
            return shown(value)
        digits = [f"{conversion.shown(float(part)):{self.form or '.15g'}}" for part in parts]
        return with_unit(digits[0] if parts is not value else f"({', '.join(digits)})", unit)


class Message(str):
    """A text that knows which of its numbers are quantities."""

    parts: tuple[str | NamedValue, ...]

    def __new__(cls, *parts: str | NamedValue) -> "Message":
        """Join texts, messages and quantities."""
        flat = [p for part in parts for p in (part.parts if isinstance(part, Message) else (part,))]
        message = super().__new__(cls, "".join(p if isinstance(p, str) else p.text() for p in flat))
        message.parts = tuple(flat)
        return message

    def __add__(self, other: str) -> "Message":
        return Message(self, other)

    def __radd__(self, other: str) -> "Message":
        return Message(other, self)

    def __getnewargs__(self) -> tuple[str | NamedValue, ...]:  # type: ignore[override]
        return self.parts

    def removeprefix(self, prefix: str, /) -> "Message":
        """The message without a text that it begins with."""
        first, *others = self.parts
        return Message(first.removeprefix(prefix) if isinstance(first, str) else first, *others)

    def in_units(self, system: "UnitSystem") -> str:
        """The text with its quantities in the units of a system."""
        return "".join(part if isinstance(part, str) else part.text(system) for part in self.parts)


def amount(name: Any, value: Any, form: str = "", says_unit: bool = False) -> Message:
    """The message of a number in SI units alone; the arguments are those of `NamedValue`."""
    return Message(NamedValue(name, value, form, says_unit))


def named(name: str, value: Any, form: str = "") -> Message:
    """The message "ec = 0.03", which is "ec = 30 mm" in millimetres."""
    return f"{name} = " + amount(name, value, form)


def listed(messages: list[Message], separator: str = ", ") -> Message:
    """Messages one after the other."""
    return Message(*[part for message in messages for part in (separator, message)][1:])


def message_of(error: Exception) -> str:
    """The text of an error, a message where it is one."""
    whole = len(error.args) == 1 and isinstance(error.args[0], Message)
    return error.args[0] if whole else str(error)


@contextmanager
def errors_in(system: "UnitSystem") -> Iterator[None]:
    """Errors out of this block have their quantities in these units."""
    try:
        yield
    except Exception as error:
        error.args = tuple(arg.in_units(system) if isinstance(arg, Message) else arg for arg in error.args)
        raise
