"""The designs of a scene, and SI numbers in the units of a report."""

from collections.abc import Mapping
from itertools import product
from math import degrees, isnan
from typing import Any, NamedTuple

from ...mechanism.quantity_units import UnitSystem
from ...support.shown import printed
from ..content import Content
from ..reading.values import Value
from .blocks import NONE, cell, thinned

MOST = 6  # designs beside each other


class Design(NamedTuple):
    """One design of a scene: what it is called, and its inputs in SI units, without crank angles."""

    words: str
    inputs: dict[str, Any]


def designs_of(content: Content, units: UnitSystem) -> list[Design]:
    """The designs of a scene, a few of many."""
    several = axes_of(content.inputs)
    fixed = {n: v for n, v in content.inputs.items() if n not in several and n != "theta"}
    counts = [range(len(values)) for values in several.values()]
    chosen = [
        {name: values[k] for (name, values), k in zip(several.items(), indices, strict=True)}
        for indices in thinned(list(product(*counts)), MOST)
    ]
    return [
        Design(", ".join(f"{n} = {with_unit(units, n, v)}" for n, v in one.items()), {**fixed, **one})
        for one in chosen
    ]


def axes_of(inputs: Mapping[str, Value]) -> dict[str, tuple[float, ...]]:
    """The inputs with several values, but the crank angle."""
    return {n: v for n, v in inputs.items() if isinstance(v, tuple) and n != "theta"}


def unit_of(units: UnitSystem, name: str) -> str:
    """The unit of a name as a table has it; angles in radians are shown in degrees."""
    unit = units.of(name).unit
    return "deg" if unit == "rad" else printed(unit)


def in_unit(units: UnitSystem, name: str, value: float) -> str:
    """A number in SI units as a table has it."""
    conversion = units.of(name)
    return cell(degrees(value) if conversion.unit == "rad" else float(conversion.shown(value)))


def with_unit(units: UnitSystem, name: str, value: float) -> str:
    """A number in SI units with its unit."""
    return NONE if isnan(value) else f"{in_unit(units, name, value)} {unit_of(units, name)}".rstrip()
