"""The values of inputs as they are written in a scene, in SI units."""

from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from math import floor

from ...loads.load import Load
from ...mechanism.inputs import INPUTS, Input
from ...mechanism.read import read
from ...scenes import schema
from ...units.parse import exact
from ..schema import SceneError, shown
from .spread import MOST, spread

Value = float | tuple[float, ...] | Load


def values_of(key: str, name: str, written: float | str | tuple[float | str, ...] | schema.Range) -> Value:
    """A number, or the values of a list or range, in the SI unit of an input."""
    if isinstance(written, tuple):
        if not written:
            raise SceneError(f"{key} = []: expected at least one value")
        return tuple(number_of(f"{key} #{index}", name, part) for index, part in enumerate(written, 1))
    if isinstance(written, schema.Range):
        return _spread(key, name, written)
    return number_of(key, name, written)


def number_of(key: str, name: str, written: float | str) -> float:
    """A number or text with a unit, in the SI unit of an input."""
    return read_number(INPUTS[name], key, written)


def read_number(row: Input, key: str, written: float | str) -> float:
    """The number of a row; SceneError by its key where it is bad."""
    try:
        return read(row, written, "a scene")
    except ValueError as error:  # what it says after the name and the value
        reason = str(error).partition(": ")[2] or str(error)
        raise SceneError(f"{key} = {shown(written)}: {reason}") from None


def _spread(key: str, name: str, written: schema.Range) -> tuple[float, ...]:
    """The values of a range, both ends included."""
    for end in ("start", "stop"):
        number_of(f"{key}.{end}", name, getattr(written, end))
    start, stop = _exactly(name, written.start), _exactly(name, written.stop)
    if (written.num is None) == (written.step is None):
        raise SceneError(f"{key}: a range has start, stop, and either num (how many) or step (how far apart)")
    steps = written.num - 1 if written.num is not None else _steps(key, name, written, stop - start)
    _require_few(key, steps)
    return spread(start, stop, steps)


def _require_few(key: str, steps: int | Fraction) -> None:
    count = floor(abs(Fraction(steps))) + 1
    if count > MOST:
        number = str(count) if count < 10**18 else f"{Decimal(count):.2e}"
        raise SceneError(f"{key}: {number} values are too many, at most {MOST}")


def _exactly(name: str, written: float | str) -> Fraction:
    """A number exactly as written, so that 0.1, 0.2, 0.3 of a range are the doubles of these texts."""
    return exact(name, written if isinstance(written, str) else repr(float(written)), INPUTS[name].unit)


def _steps(key: str, name: str, written: schema.Range, length: Fraction) -> int:
    # A step may be negative, where the input itself may not.
    any_number = INPUTS[name]._replace(least=None, limit="a finite number")
    read_number(any_number, f"{key}.step", written.step or 0.0)
    step = _exactly(name, written.step or 0.0)
    _require_few(key, length / step if step else Fraction(0))
    count = float(length / step) if step else 0.0
    if not (count > 0.5 and abs(count - round(count)) < 1e-6):
        raise SceneError(
            f"{key}.step = {shown(written.step)}: it must lead from start to stop in a whole number of steps"
        )
    return round(count)


def design_of(key: str, written: Mapping[str, float | str]) -> dict[str, float]:
    """A table of inputs in SI units."""
    only_inputs(key, written)
    return {name: number_of(f"{key}.{name}", name, value) for name, value in written.items()}


def only_inputs(key: str, names: Iterable[str]) -> None:
    """SceneError for a key that is no input."""
    for name in names:
        if name not in INPUTS:
            raise SceneError(f"{key}.{name}: unknown input; {schema.hint(name, tuple(INPUTS))}")
