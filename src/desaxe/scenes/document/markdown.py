"""A document as Markdown: texts and tables as they are read, its pictures at the end of the file."""

import re
from collections.abc import Sequence
from html import escape

from ...support.written import UNSEALED, sealed
from .blocks import Block, Document, Image, Lines, Text
from .html import source_of

_SPECIAL = re.compile(r"([\\`*\[\]|#~]|(?<!\w)_|_(?!\w))")


def markdown(document: Document) -> str:
    """The text of the file, with a checksum by which desaxe knows its own."""
    images: list[Image] = []
    parts = [f"# {_plain(document.title)}"]
    for section in document.sections:
        parts += [f"## {_plain(section.title)}", *(_block(block, images) for block in section.blocks)]
    parts += [f"[picture-{k}]: {source_of(image)}" for k, image in enumerate(images, 1)]
    return sealed("\n\n".join([*parts, f"<!-- desaxe report, {UNSEALED} -->"]) + "\n")


def _block(block: Block, images: list[Image]) -> str:
    if isinstance(block, Text):
        return _plain(block.words)
    if isinstance(block, Lines):
        if "<" in block.text:  # where a reader that does not know indented code would see a tag
            return f"<pre>{escape(block.text, quote=False)}</pre>"
        return "\n".join(f"    {line}" for line in block.text.splitlines())
    if isinstance(block, Image):
        images.append(block)
        return f"![{_plain(block.words)}][picture-{len(images)}]"
    rule = ["---"] * len(block.heads)
    return "\n".join([_row(block.columns), _row(rule, plain=True), *map(_row, block.rows)])


def _row(cells: Sequence[str], plain: bool = False) -> str:
    return f"| {' | '.join(cell if plain else _plain(cell) for cell in cells)} |"


def _plain(text: str) -> str:
    """A text that means nothing but itself, in one line."""
    return _SPECIAL.sub(r"\\\1", escape(" ".join(text.split()), quote=False))
