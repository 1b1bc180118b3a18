"""A document as a page of HTML: no script, nothing from elsewhere, for the screen and for paper."""

from base64 import b64encode
from html import escape

from ...support.template import file_text, filled
from ...support.written import UNSEALED, sealed
from .blocks import Block, Document, Image, Lines, Text, TextTable


def html(document: Document) -> str:
    """The text of the page, with a checksum by which desaxe knows its own."""
    sections: list[str] = []
    for section in document.sections:
        sections += [
            f"<section>\n<h2>{escape(section.title)}</h2>",
            *map(_block, section.blocks),
            "</section>",
        ]
    page = file_text(__package__, "page.html")
    return sealed(filled(page, CHECKSUM=UNSEALED, TITLE=escape(document.title), SECTIONS=sections))


def source_of(image: Image) -> str:
    """A picture as an address that holds it."""
    return f"data:image/{image.kind};base64,{b64encode(image.data).decode()}"


def _block(block: Block) -> str:
    if isinstance(block, Text):
        return f"<p>{escape(block.words)}</p>"
    if isinstance(block, Lines):
        return f"<pre>{escape(block.text)}</pre>"
    if isinstance(block, Image):
        words = escape(block.words)
        image = f'<img src="{source_of(block)}" alt="{words}">'
        return f"<figure>\n{image}\n<figcaption>{words}</figcaption>\n</figure>"
    return _table(block)


def _table(table: TextTable) -> str:
    head = "".join(f"<th>{escape(head)}</th>" for head in table.columns)
    rows = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in table.rows]
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>"
