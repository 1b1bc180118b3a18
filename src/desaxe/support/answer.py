"""Results: dicts with a readable repr."""

from collections.abc import Callable, Mapping
from functools import wraps
from types import MappingProxyType
from typing import Any, ParamSpec, TypeVar, cast

P = ParamSpec("P")
T = TypeVar("T")
DIGITS = 6  # shown of a number; the answer itself has all
FEW = 6  # values of an array that are all shown
WIDE = 96  # letters of a line


class Answer(dict[str, Any]):
    """A dict whose repr has a line for each name and numbers in six digits.

    inputs  of `evaluate`: what it was asked for with, by name
    about   of `peak` and others of one quantity: its name
    units   of an answer of a machine: the unit system of its numbers; SI units without
    """

    inputs: Mapping[str, Any] = MappingProxyType({})
    about: Any = None
    units: Any = None

    def __repr__(self) -> str:
        return "\n".join(_lines(self)) or "{}"


def answering(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function to return its dict as an Answer."""
    of_one = function.__code__.co_varnames[:1] == ("name",)

    @wraps(function)
    def answered(*args: P.args, **inputs: P.kwargs) -> T:
        found = function(*args, **inputs)
        if type(found) is not dict:
            return found
        answer = Answer(cast(dict[str, Any], found))
        if of_one:
            answer.about = args[0] if args else inputs.get("name")
        return cast(T, answer)

    return answered


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
