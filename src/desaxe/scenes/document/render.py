"""Blocks as text for a terminal, as a page of HTML without scripts, and as Markdown."""

import re
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from textwrap import fill
from typing import Any

from ...support.template import file_text, filled
from ...support.text_table import table
from ...support.written import UNSEALED, sealed
from .blocks import Block, Document, Image, Lines, Section, Text, TextTable

WIDTH = 100  # columns of a terminal
WHOLE: Any = {"break_long_words": False, "break_on_hyphens": False}
_SPECIAL = re.compile(r"([\\`*\[\]|#~]|(?<!\w)_|_(?!\w))")


# ---- text ----------------------------------------------------------------------------------------


def terminal(title: str, sections: Sequence[Section]) -> str:
    """The title and the sections, at most 100 columns wide where their cells are short; no pictures."""
    parts = ["\n".join([one.title, *filter(None, map(_text, one.blocks))]) for one in sections]
    return "\n\n".join([title, *parts] if title else parts)


def _text(block: Block) -> str:
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


# ---- HTML ----------------------------------------------------------------------------------------


def html(document: Document) -> str:
    """The text of a page for the screen and for paper, with a checksum by which desaxe knows its own."""
    sections: list[str] = []
    for section in document.sections:
        blocks = map(element, section.blocks)
        sections += [f"<section>\n<h2>{escape(section.title)}</h2>", *blocks, "</section>"]
    page = file_text(__package__, "page.html")
    return sealed(filled(page, CHECKSUM=UNSEALED, TITLE=escape(document.title), SECTIONS=sections))


def address(image: Image) -> str:
    """A picture as an address that holds it."""
    return f"data:image/{image.kind};base64,{b64encode(image.data).decode()}"


def element(block: Block) -> str:
    """A block as HTML."""
    if isinstance(block, Text):
        return f"<p>{escape(block.words)}</p>"
    if isinstance(block, Lines):
        return f"<pre>{escape(block.text)}</pre>"
    if isinstance(block, Image):
        words = escape(block.words)
        image = f'<img src="{address(block)}" alt="{words}">'
        return f"<figure>\n{image}\n<figcaption>{words}</figcaption>\n</figure>"
    head = "".join(f"<th>{escape(head)}</th>" for head in block.columns)
    rows = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in block.rows]
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>"


# ---- Markdown ------------------------------------------------------------------------------------


def markdown(document: Document) -> str:
    """Texts and tables as they are read, pictures at the end, the checksum by which desaxe knows its own."""
    images: list[Image] = []
    parts = [f"# {_plain(document.title)}"]
    for section in document.sections:
        parts += [f"## {_plain(section.title)}", *(_paragraph(block, images) for block in section.blocks)]
    parts += [f"[picture-{k}]: {address(image)}" for k, image in enumerate(images, 1)]
    return sealed("\n\n".join([*parts, f"<!-- desaxe report, {UNSEALED} -->"]) + "\n")


def _paragraph(block: Block, images: list[Image]) -> str:
    if isinstance(block, Text):
        return _plain(block.words)
    if isinstance(block, Lines):
        if "<" in block.text:  # where a reader that does not know indented code would see a tag
            return f"<pre>{escape(block.text, quote=False)}</pre>"
        return "\n".join(f"    {line}" for line in block.text.splitlines())
    if isinstance(block, Image):
        images.append(block)
        return f"![{_plain(block.words)}][picture-{len(images)}]"
    rows = [[_plain(cell) for cell in row] for row in (block.columns, *block.rows)]
    rows.insert(1, ["---"] * len(block.heads))
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _plain(text: str) -> str:
    """A text that means nothing but itself, in one line."""
    return _SPECIAL.sub(r"\\\1", escape(" ".join(text.split()), quote=False))
