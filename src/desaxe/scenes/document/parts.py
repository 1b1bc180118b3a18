"""The parts of a document: texts, tables, pictures."""

from collections.abc import Mapping, Sequence
from io import BytesIO
from itertools import product
from math import degrees, isnan
from typing import Any, NamedTuple

from ...mechanism.quantity_units import UnitSystem
from ...support.shown import printed
from ..content import Content
from ..reading.values import Value
from ..report import number

LARGE = 300_000  # bytes of a drawing: a larger one becomes an image of dots
MOST = 6  # designs beside each other
NONE = "\u2013"  # where there is no value


class Text(NamedTuple):
    """A paragraph."""

    words: str


class Lines(NamedTuple):
    """Lines that stay as they are."""

    text: str


class TextTable(NamedTuple):
    """Rows of cells under their headings."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


class Image(NamedTuple):
    """A picture, and what it shows in words."""

    words: str
    kind: str  # svg+xml or png
    data: bytes


Block = Text | Lines | TextTable | Image


class Section(NamedTuple):
    """A heading and what is below it."""

    title: str
    blocks: Sequence[Block]


class Document(NamedTuple):
    """A title and sections."""

    title: str
    sections: Sequence[Section]


def image_of(figure: Any, words: str) -> Image:
    """A matplotlib Figure as lines, or as dots where it has too many."""
    drawn = BytesIO()
    figure.savefig(drawn, format="svg", metadata={"Date": None, "Creator": None})
    if drawn.tell() <= LARGE:
        return Image(words, "svg+xml", drawn.getvalue())
    dots = BytesIO()
    figure.savefig(dots, format="png", dpi=110.0)
    return Image(words, "png", dots.getvalue())


def cell(value: float) -> str:
    """A number in six digits; a dash where there is none."""
    return NONE if isnan(value) else number(value)


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
        {name: values[k] for (name, values), k in zip(several.items(), places, strict=True)}
        for places in thinned(list(product(*counts)))
    ]
    return [
        Design(", ".join(f"{n} = {with_unit(units, n, v)}" for n, v in one.items()), {**fixed, **one})
        for one in chosen
    ]


def axes_of(inputs: Mapping[str, Value]) -> dict[str, tuple[float, ...]]:
    """The inputs with several values, but the crank angle."""
    return {n: v for n, v in inputs.items() if isinstance(v, tuple) and n != "theta"}


def thinned(items: list[Any], most: int = MOST) -> list[Any]:
    """At most `most` items, evenly chosen, with the first and the last."""
    if len(items) <= most:
        return items
    return [items[round(k * (len(items) - 1) / (most - 1))] for k in range(most)]
