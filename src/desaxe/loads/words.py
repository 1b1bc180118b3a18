"""Loads in words: in a line, and shorter in a cell of a table."""

from collections.abc import Sequence
from typing import Any

from ..mechanism.quantity_units import UnitSystem
from ..support.shown import with_unit
from .table import Table


def told(load: Any, conversion: Any = None) -> str:
    """Tables in a line: kind and range of each curve, and of its points where the curve goes beyond."""
    unit = load.unit or "1"
    if conversion is not None and conversion.si != 1:
        unit = conversion.unit
    ranges = ", inward ".join(_range(way, unit, conversion) for way in load.tables)
    return f"<load over {load.place}: {len(load.tables[0].knots)} points, {load.kind}, {ranges}>"


def _range(way: Table, unit: str, conversion: Any) -> str:
    curve, points = (
        " to ".join(f"{end if conversion is None else conversion.shown(end):g}" for end in ends)
        for ends in (way.range, (min(way.values), max(way.values)))
    )
    return with_unit(curve, unit) + (f" (points {points})" if points != curve else "")


def brief(load: Any, name: str, units: UnitSystem) -> str:
    """The load of an input in a few words, with the range of both ways together."""
    conversion = units.of(name)
    if not load.tables:
        words: str = load.in_units(units).told(conversion)
        return words[1:-1].removeprefix("load ")
    ends = [conversion.shown(end) for table in load.tables for end in table.range]
    return f"over {load.over}, " + with_unit(span(ends), conversion.unit)


def span(ends: Sequence[float]) -> str:
    """The range of numbers in four digits, without exponents where six will do."""
    least, most = (f"{x:g}" if "e" in f"{x:.4g}" else f"{x:.4g}" for x in (min(ends), max(ends)))
    return f"{least} to {most}"
