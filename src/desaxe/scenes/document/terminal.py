"""Sections as text for a terminal, at most 100 columns wide where their cells are short."""

from collections.abc import Sequence
from textwrap import fill
from typing import Any

from ...support.text_table import table
from .blocks import Block, Lines, Section, Text, TextTable

WIDTH = 100  # columns
WHOLE: Any = {"break_long_words": False, "break_on_hyphens": False}


def terminal(title: str, sections: Sequence[Section]) -> str:
    """The title and the sections; pictures are left out."""
    parts = ["\n".join([one.title, *filter(None, map(_block, one.blocks))]) for one in sections]
    return "\n\n".join([title, *parts] if title else parts)


def _block(block: Block) -> str:
    if isinstance(block, Text):
        return fill(block.words, WIDTH, initial_indent="  ", subsequent_indent="    ", **WHOLE)
    if isinstance(block, Lines):
        return block.text
    return "\n".join(text_table(block)) if isinstance(block, TextTable) else ""


def text_table(block: TextTable) -> list[str]:
    """The lines of a table: columns of numbers flush right, units in a line of their own."""
    sides = [_side(column) for column in zip(*block.rows, strict=True)] or ["l"]
    heads = [row for row in (block.heads, block.units) if any(row)]
    lines = table([*heads, *block.rows], "".join(sides), gap="   ", indent="  ")
    return [*map(_cut, lines)] if block.is_cut else lines


def _cut(line: str) -> str:
    """A line that fits; what is lost is the end of a text."""
    return line if len(line) <= WIDTH else line[: line.rindex(" ", 0, WIDTH - 4)].rstrip(" ,;") + ", ..."


def _side(column: Sequence[str]) -> str:
    return "r" if all(cell[:1] in "+-.0123456789<" for cell in column) else "l"
