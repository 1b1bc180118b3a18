"""Results: dicts with a readable repr, which know the units of their numbers."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

DIGITS = 6  # shown of a number; the answer itself has all
FEW = 6  # values of an array that are all shown
WIDE = 96  # letters of a line


class Answer(dict[str, Any]):
    """A dict whose repr has a line for each name and numbers in six digits.

    units   key -> unit of its numbers, nested like the answer; what it leaves out has none. Or a function of
            the answer that gives them when they are first looked at
    system  of an answer of a machine: its unit system; None for SI units
    inputs  of `evaluate`: what it was asked for with, by name
    """

    inputs: Mapping[str, Any] = MappingProxyType({})
    system: Any = None
    _units: "Mapping[Any, Any] | Callable[[Any], Mapping[Any, Any]]" = MappingProxyType({})

    def __init__(
        self,
        values: Mapping[Any, Any] | None = None,
        units: "Mapping[Any, Any] | Callable[[Any], Mapping[Any, Any]] | None" = None,
        **more: Any,
    ) -> None:
        super().__init__(values or {}, **more)
        if units is not None:
            self._units = units

    @property
    def units(self) -> Mapping[Any, Any]:
        """The units of the numbers by key."""
        if callable(self._units):
            self._units = self._units(self)
        return self._units

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_units": self.units}

    def become(self, units: Mapping[Any, Any], system: Any) -> None:
        """Have other units now: what a conversion of the numbers ends with."""
        self._units, self.system = units, system

    def convert_rest(self, shown: Any) -> None:
        """Convert what is not under a key; `shown` is a `Shown` of `evaluation.in_units`."""

    def __repr__(self) -> str:
        return "\n".join(_lines(self)) or "{}"


def _lines(mapping: Mapping[Any, Any]) -> list[str]:
    """A line for each name; a mapping too long for one line follows indented."""
    width = max((len(str(name)) for name in mapping), default=0)
    lines = []
    for name, value in mapping.items():
        text = _text(value)
        if isinstance(value, Mapping) and len(text) > WIDE - width:
            lines += [str(name), *(f"    {line}" for line in _lines(value))]
        else:
            lines.append(f"{name!s:{width}}  {text}")
    return lines


def _text(value: Any) -> str:
    """A value in one line."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{name}: {_text(part)}' for name, part in value.items())}}}"
    if isinstance(value, (list, tuple)):
        left, right = "[]" if isinstance(value, list) else "()"
        return f"{left}{', '.join(map(_text, value))}{right}"
    if getattr(value, "shape", ()):
        return _array(value)
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)


def _array(array: Any) -> str:
    """All values of a small array, else its shape and the range of its numbers."""
    if array.size <= FEW:
        return _text(array.tolist())
    shape = "x".join(map(str, array.shape))
    if array.dtype.kind not in "fiu":
        return f"{shape} {array.dtype}"
    known = array[array == array]
    gaps = f", {array.size - known.size} nan" if known.size < array.size else ""
    ends = f" {known.min():.{DIGITS}g} .. {known.max():.{DIGITS}g}" if known.size else ""
    return f"{shape} {array.dtype}{ends}{gaps}"
