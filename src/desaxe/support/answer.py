"""Results: dicts with a readable repr, which know the units of their numbers."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from .shown import with_unit

DIGITS = 6  # shown of a number; the answer itself has all
FEW = 6  # values of an array that are all shown
ROUNDED = 2.0**-46  # of the largest slope of a unit: a smaller one is what rounding leaves of 0
WIDE = 96  # letters of a line


class Answer(dict[str, Any]):
    """A dict whose repr has a line for each name, with numbers in six digits and their units.

    units   key -> unit of its numbers, nested like the answer; what it leaves out has none. Or a function of
            the answer that gives them when they are first looked at
    codes   the enumeration of its status codes, whose texts the repr has
    system  of an answer of a machine: its unit system; None for SI units
    inputs  of `evaluate`, and of `simulate` of many designs: what it was asked for with, by name
    """

    inputs: Mapping[str, Any] = MappingProxyType({})
    system: Any = None
    codes: Any = None
    _units: "Mapping[Any, Any] | Callable[[Any], Mapping[Any, Any]]" = MappingProxyType({})

    def __init__(
        self,
        values: Mapping[Any, Any] | None = None,
        units: "Mapping[Any, Any] | Callable[[Any], Mapping[Any, Any]] | None" = None,
        codes: Any = None,
        **more: Any,
    ) -> None:
        super().__init__(values or {}, **more)
        if units is not None:
            self._units = units
        if codes is not None:
            self.codes = codes

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
        return "\n".join(lines_of(self, self.units, self.codes)) or "{}"


def lines_of(mapping: Mapping[Any, Any], units: Any, codes: Any = None) -> list[str]:
    """A line for each name; a mapping too long for one line follows indented."""
    width = max((len(str(name)) for name in mapping), default=0)
    lines = []
    for name, value in mapping.items():
        unit = _unit_of(units, name)
        part = cleaned(value, unit) if name == "gradient" else value
        text = text_of(part, unit)
        if isinstance(part, Mapping) and len(text) > WIDE - width:
            lines += [str(name), *(f"    {line}" for line in lines_of(part, unit))]
        else:
            reason = _reason(value, codes) if name == "status" else ""
            lines.append(f"{name!s:{width}}  {text}{reason}")
    return lines


def cleaned(gradient: Any, units: Any) -> Any:
    """A gradient in which slopes are 0 that vanish to rounding beside the largest of the same unit."""
    if not isinstance(gradient, Mapping):
        return gradient
    result = {key: cleaned(part, _unit_of(units, key)) for key, part in gradient.items()}
    slopes = {key: part for key, part in result.items() if isinstance(part, float)}
    for key, slope in slopes.items():
        unit = str(_unit_of(units, key))
        most = max(abs(other) for name, other in slopes.items() if str(_unit_of(units, name)) == unit)
        result[key] = slope if not abs(slope) <= ROUNDED * most else 0.0
    return result


def _unit_of(units: Any, key: Any) -> Any:
    """The unit of a key, or the units of what is under it; one text holds for all of them."""
    return units.get(key, "") if isinstance(units, Mapping) else units


def _reason(value: Any, codes: Any) -> str:
    """The text of a status that is not 0; of an array, that of each of its codes."""
    if codes is None or not hasattr(value, "__int__"):
        return ""
    if not getattr(value, "shape", ()):
        return f": {codes(int(value)).words}" if value else ""
    message = [f"{code}: {codes(code).words}" for code in sorted({*value.reshape(-1).tolist()} - {0})]
    return f" ({'; '.join(message)})" if message else ""


def text_of(value: Any, unit: Any = "") -> str:
    """A value in one line, with its unit, or with the units of its parts."""
    if isinstance(value, Mapping):
        return _mapping(value, [_unit_of(unit, name) for name in value])
    if hasattr(value, "_fields"):
        return _mapping(value._asdict(), [_unit_of(unit, name) for name in value._fields])
    if isinstance(value, (list, tuple)):
        left, right = "[]" if isinstance(value, list) else "()"
        if not isinstance(unit, str):
            return f"{left}{', '.join(text_of(part, unit) for part in value)}{right}"
        return with_unit(f"{left}{', '.join(map(text_of, value))}{right}", unit)
    if getattr(value, "shape", ()):
        return _array(value, unit)
    text = f"{value + 0.0:.{DIGITS}g}" if isinstance(value, float) else str(value)  # no -0
    return with_unit(text, unit) if isinstance(unit, str) and _is_number(value) else text


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value == value


def _mapping(mapping: Mapping[Any, Any], units: Sequence[Any]) -> str:
    """A mapping in one line; a unit that all of it has stands behind it."""
    one = units[0] if units and isinstance(units[0], str) and len({*map(str, units)}) == 1 else ""
    parts = zip(mapping.items(), units, strict=True)
    message = ", ".join(f"{name}: {text_of(part, '' if one else unit)}" for (name, part), unit in parts)
    return with_unit(f"{{{message}}}", one)


def _array(array: Any, unit: Any) -> str:
    """All values of a small array, else its shape and the range of its numbers."""
    if array.size <= FEW:
        return text_of(array.tolist(), unit)
    shape = "x".join(map(str, array.shape))
    if array.dtype.kind not in "fiu":
        return f"{shape} {array.dtype}"
    known = array[array == array]
    gaps = f", {array.size - known.size} nan" if known.size < array.size else ""
    ends = f" {known.min():.{DIGITS}g} .. {known.max():.{DIGITS}g}" if known.size else ""
    return f"{with_unit(f'{shape} {array.dtype}{ends}', unit if ends else '')}{gaps}"
