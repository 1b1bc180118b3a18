"""The values of inputs as they are written in a scene, in SI units."""

from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from math import floor

from ...loads.load import Load
from ...mechanism.inputs import INPUTS, Input
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.read import read
from ...scenes import schema
from ...units.parse import exact
from ...units.text import with_unit_of
from ..schema import SceneError, shown
from .spread import MOST, spread

Value = float | tuple[float, ...] | Load


def values_of(
    key: str,
    name: str,
    written: float | str | tuple[float | str, ...] | schema.Range,
    units: UnitSystem,
) -> Value:
    """A number, or the values of a list or range, in the SI unit of an input; plain ones are in `units`."""
    if isinstance(written, tuple):
        if not written:
            raise SceneError(f"{key} = []: expected at least one value")
        numbered = enumerate(written, 1)
        return tuple(number_of(f"{key} #{index}", name, part, units) for index, part in numbered)
    if isinstance(written, schema.Range):
        return _spread(key, name, written, units)
    return number_of(key, name, written, units)


def number_of(key: str, name: str, written: float | str, units: UnitSystem) -> float:
    """A number or text with a unit, in the SI unit of an input."""
    return read_number(INPUTS[name], key, written, units)


def read_number(row: Input, key: str, written: float | str, units: UnitSystem) -> float:
    """The number of a row; SceneError by its key where it is bad."""
    try:
        return read(row, written, "a scene", system=units)
    except ValueError as error:  # what it says after the name and the value
        reason = str(error).partition(": ")[2] or str(error)
        raise SceneError(f"{key} = {shown(written)}: {reason}") from None


def with_unit_in(units: UnitSystem, name: str, written: float | str) -> str:
    """The text of a written quantity, with its unit where it is a plain number."""
    text = written if isinstance(written, str) else repr(written)
    return str(with_unit_of(f"1 {units.of(name).unit}", text))


def _spread(key: str, name: str, written: schema.Range, units: UnitSystem) -> tuple[float, ...]:
    """The values of a range, both ends included."""
    for end in ("start", "stop"):
        number_of(f"{key}.{end}", name, getattr(written, end), units)
    start, stop = (_exactly(name, end, units) for end in (written.start, written.stop))
    if (written.num is None) == (written.step is None):
        raise SceneError(f"{key}: a range has start, stop, and either num (how many) or step (how far apart)")
    steps = written.num - 1 if written.num is not None else _steps(key, name, written, stop - start, units)
    _require_few(key, steps)
    return spread(start, stop, steps)


def _require_few(key: str, steps: int | Fraction) -> None:
    count = floor(abs(Fraction(steps))) + 1
    if count > MOST:
        number = str(count) if count < 10**18 else f"{Decimal(count):.2e}"
        raise SceneError(f"{key}: {number} values are too many, at most {MOST}")


def _exactly(name: str, written: float | str, units: UnitSystem) -> Fraction:
    """A number exactly as written, so that 0.1, 0.2, 0.3 of a range are the doubles of these texts."""
    return exact(name, with_unit_in(units, name, written), INPUTS[name].unit)


def _steps(key: str, name: str, written: schema.Range, length: Fraction, units: UnitSystem) -> int:
    # A step may be negative, where the input itself may not.
    any_number = INPUTS[name]._replace(least=None, limit="a finite number")
    read_number(any_number, f"{key}.step", written.step or 0.0, units)
    step = _exactly(name, written.step or 0.0, units)
    _require_few(key, length / step if step else Fraction(0))
    count = float(length / step) if step else 0.0
    if not (count > 0.5 and abs(count - round(count)) < 1e-6):
        raise SceneError(
            f"{key}.step = {shown(written.step)}: it must lead from start to stop in a whole number of steps"
        )
    return round(count)


def design_of(key: str, written: Mapping[str, float | str], units: UnitSystem) -> dict[str, float]:
    """A table of inputs in SI units."""
    only_inputs(key, written)
    return {name: number_of(f"{key}.{name}", name, value, units) for name, value in written.items()}


def only_inputs(key: str, names: Iterable[str]) -> None:
    """SceneError for a key that is no input."""
    for name in names:
        if name not in INPUTS:
            raise SceneError(f"{key}.{name}: unknown input; {schema.hint(name, tuple(INPUTS))}")
