"""The inputs as they are written in a scene: in SI units, the units of their texts, and what needs them."""

from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from math import floor
from typing import Any

from ...loads.load import Load
from ...mechanism.catalogue import law_name, of_design, quantity
from ...mechanism.inputs import INPUTS, Input
from ...mechanism.names import FORCE_STATUS, LENGTHS, LOADS, STATUS
from ...mechanism.program import Variant, program_of
from ...mechanism.quantity_units import SI, UnitSystem
from ...mechanism.ranges import Between
from ...mechanism.read import read
from ...runtime.request import needs_no_speed
from ...units.parse import exact
from ...units.system import DIMENSIONS
from ...units.text import split_quantity, with_unit_of
from ..schema import SECTIONS, SceneError, hint, shown
from .spread import MOST, spread

Value = float | tuple[float, ...] | Load

OPTIONAL = ("alpha", *LOADS)  # 0 where they are not given, or half of a length
ENDS = ("start", "stop", "step")
WORDS = ("printed", "quantities", "reduce")  # tables whose texts are no values of inputs
# What the text of an input says of all quantities of its dimension; a rate does not follow the lengths.
SHARED = {
    si: name
    for name, si in DIMENSIONS.items()
    if name in ("length", "angle", "angular speed", "mass", "force")
}
RATES = {name: DIMENSIONS[name] for name in ("velocity", "acceleration", "jerk")}


def values_of(key: str, name: str, written: Any, units: UnitSystem) -> Value:
    """A number, or the values of a list or range, in the SI unit of an input; plain ones are in `units`."""
    if isinstance(written, list):
        if not written:
            raise SceneError(f"{key} = []: expected at least one value")
        return tuple(number_of(f"{key} #{k}", name, part, units) for k, part in enumerate(written, 1))
    if isinstance(written, Mapping):
        return _spread(key, name, written, units)
    return number_of(key, name, written, units)


def number_of(key: str, name: str, written: float | str, units: UnitSystem) -> float:
    """A number or text with a unit, in the SI unit of an input."""
    return read_number(INPUTS[name], key, written, units)


def read_number(row: Input, key: str, written: float | str, units: UnitSystem) -> float:
    """The number of a row; SceneError by its key where it is bad."""
    try:
        return read(row, written, "a scene", system=units)
    except TypeError:
        reason = f"it must be {row.limit}"
    except ValueError as error:  # what it says after the name and the value
        reason = str(error).partition(": ")[2] or str(error)
    raise SceneError(f"{key} = {shown(written)}: {reason}")


def with_unit_in(units: UnitSystem, name: str, written: float | str) -> str:
    """The text of a written quantity, with its unit where it is a plain number."""
    text = written if isinstance(written, str) else repr(written)
    return str(with_unit_of(f"1 {units.of(name).unit}", text))


def _spread(key: str, name: str, written: Mapping[str, Any], units: UnitSystem) -> tuple[float, ...]:
    """The values of a range, both ends included; 0.1, 0.2, 0.3 of one are the doubles of these texts."""
    for end in ("start", "stop"):
        if end not in written:
            raise SceneError(f"{key}.{end} is missing: a range has start, stop, and num or step")
        number_of(f"{key}.{end}", name, written[end], units)
    if ("num" in written) == ("step" in written):
        raise SceneError(f"{key}: a range has start, stop, and either num (how many) or step (how far apart)")
    start, stop = (_exactly(name, written[end], units) for end in ("start", "stop"))
    steps = Fraction(written.get("num", 1) - 1)
    if "step" in written:  # which may be negative, where the input itself may not
        any_number = INPUTS[name]._replace(least=None, limit="a finite number")
        read_number(any_number, f"{key}.step", written["step"], units)
        step = _exactly(name, written["step"], units)
        steps = (stop - start) / step if step else Fraction(0)
    count = floor(abs(steps)) + 1
    if count > MOST:
        number = str(count) if count < 10**18 else f"{Decimal(count):.2e}"
        raise SceneError(f"{key}: {number} values are too many, at most {MOST}")
    if not (steps > 0.5 and abs(steps - round(steps)) < 1e-6):
        raise SceneError(
            f"{key}.step = {shown(written['step'])}: it must lead from start to stop in a whole number of "
            "steps"
        )
    return spread(start, stop, round(steps))


def _exactly(name: str, written: float | str, units: UnitSystem) -> Fraction:
    return exact(name, with_unit_in(units, name, written), INPUTS[name].unit)


def is_sum(written: Any) -> bool:
    """True for a list with a table of a load: it is the sum of its parts."""
    return isinstance(written, list) and any(isinstance(part, Mapping) for part in written)


def design_of(key: str, written: Mapping[str, float | str], units: UnitSystem) -> dict[str, float]:
    """A table of inputs in SI units."""
    only_inputs(key, written)
    return {name: number_of(f"{key}.{name}", name, value, units) for name, value in written.items()}


def only_inputs(key: str, names: Iterable[str]) -> None:
    """SceneError for a key that is no input."""
    for name in names:
        if name not in INPUTS:
            raise SceneError(f"{key}.{name}: unknown input; {hint(name, tuple(INPUTS))}")


def written_inputs(data: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs as the scene has them, of a range its ends: what slips of units are looked for in."""
    every = [pair for section in SECTIONS for pair in data.get(section, {}).items()]
    pairs = [(name, value) for name, value in every if not is_sum(value)]
    return {
        name: Between(value.get("start"), value.get("stop")) if isinstance(value, Mapping) else value
        for name, value in pairs
    }


def units_written(data: Mapping[str, Any]) -> UnitSystem:
    """The units that the texts of a scene are written in: "60 mm" says mm of ec, and of lengths at all.

    The first text of an input counts. Velocities, accelerations and sensitivities stay in SI units.
    """
    units: dict[str, str] = {}
    for name, unit in _written_units(data):
        units.setdefault(name, unit)
        dimension = SHARED.get(INPUTS[name].unit)
        if dimension is not None:
            units.setdefault(dimension, unit)
    return UnitSystem(UnitSystem.read({**RATES, **units}).units, quotients=False) if units else SI


def _written_units(part: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Input and unit of every text of an input, in the order in which they stand in the scene."""
    if isinstance(part, Mapping):
        for name, value in part.items():
            if name not in WORDS:
                yield from _written_units(value, key if name in ENDS else str(name))
    elif isinstance(part, list):
        for value in part:
            yield from _written_units(value, key)
    elif isinstance(part, str) and key in INPUTS and part.strip()[:1] in "+-.0123456789":
        unit = split_quantity(part)[1]
        if unit:
            yield key, unit


# ---- what quantities need ------------------------------------------------------------------------


def require_known(key: str, name: str, state: bool) -> None:
    """Refuse a name that is no quantity, under the law or for a given state."""
    try:
        quantity(name, state)
    except ValueError as error:
        raise SceneError(f"{key} = {shown(name)}: {error}") from None


def needs_of(names: Iterable[str], inputs: Mapping[str, Any]) -> tuple[str, ...]:
    """The inputs that quantities can use, under the law or for a given state; a speed where they need one."""
    state = "omega" in inputs
    law = tuple(law_name(name) if state else name for name in names)
    if "mu" in inputs:  # then the status includes that of friction
        law = tuple(FORCE_STATUS if name == STATUS else name for name in law)
    left = {"branch", *({"omega0"} - set(inputs) if needs_no_speed(law) else ())}
    return tuple(name for name in program_of(law, Variant(state)).inputs if name not in left)


def require(key: str, needs: Iterable[str], what: str, inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs from those given; SceneError for a missing one."""
    for name in needs:
        if name not in inputs and name not in OPTIONAL:
            raise SceneError(f"{key}: {what} needs {INPUTS[name].section}.{name}, which is missing")
    return [name for name in needs if name in inputs]


def require_quantity(key: str, name: str, inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs of a quantity at a point; SceneError for an unknown one, or a missing input."""
    require_known(key, name, "omega" in inputs)
    return require(key, needs_of((name,), inputs), name, inputs)


def require_for_grid(key: str, names: tuple[str, ...], inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs of a grid, which has `status` and `margin` too; they need no speed."""
    still = "theta" not in inputs and all(name == STATUS or of_design(name) for name in names)
    used = needs_of([name for name in names if not (still and name == STATUS)], inputs)
    needs = dict.fromkeys([*used, *LENGTHS, *(() if still else ("theta",))])
    return require(key, needs, ", ".join(names), inputs)


def with_others(inputs: Mapping[str, Value], other: Mapping[str, Value]) -> dict[str, Value]:
    """Replace inputs by others; a given state replaces the law, and vice versa."""
    swapped = {"omega": "omega0", "omega0": "omega"}
    replaced = {swapped[name] for name in other if name in swapped}
    return {**{name: value for name, value in inputs.items() if name not in replaced}, **other}


def single(key: str, names: Iterable[str], inputs: Mapping[str, Value]) -> dict[str, Any]:
    """Inputs that must be single: a number or a load that varies; SceneError for a list or range."""
    result: dict[str, Any] = {}
    for name in names:
        value = inputs[name]
        if isinstance(value, tuple):
            family = f", or family.{name} for a curve of each" if key.startswith("picture") else ""
            raise SceneError(f"{key}: {name} has {len(value)} values, expected one: give at.{name}{family}")
        result[name] = value
    return result
