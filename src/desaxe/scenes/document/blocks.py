"""Blocks of reports: sections of texts, tables, pictures; numbers as their cells."""

from collections.abc import Sequence
from io import BytesIO
from math import degrees, isnan
from typing import Any, NamedTuple

from ...mechanism.quantity_units import UnitSystem
from ...support.shown import printed

ROWS = 24  # designs that a table lists
LARGE = 300_000  # bytes of a drawing: a larger one becomes an image of dots
NONE = "-"  # where there is no value


class Text(NamedTuple):
    """A paragraph."""

    words: str


class Lines(NamedTuple):
    """Lines that stay as they are."""

    text: str


class TextTable(NamedTuple):
    """Rows of cells under their headings, and the units of the columns."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    units: Sequence[str] = ()
    is_cut: bool = False  # on a terminal that is too narrow for the texts of its last column

    @property
    def columns(self) -> list[str]:
        """The headings with their units."""
        units = self.units or [""] * len(self.heads)
        return [f"{head} [{unit}]" if unit else head for head, unit in zip(self.heads, units, strict=True)]


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
    """A number in six digits, and no -0; a dash where there is none."""
    return NONE if isnan(value) else f"{float(value) + 0.0:.6g}"


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


def thinned(items: list[Any], most: int) -> list[Any]:
    """At most `most` items, evenly chosen, with the first and the last."""
    if len(items) <= most:
        return items
    return [items[round(k * (len(items) - 1) / (most - 1))] for k in range(most)]
