"""A document as a page of HTML: no script, nothing from elsewhere, for the screen and for paper."""

from base64 import b64encode
from html import escape

from ...runtime.written import UNSEALED, sealed
from .parts import Block, Document, Image, Lines, Table, Text

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
STYLE = """
@page { size: A4; margin: 16mm 14mm; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 62rem; padding: 1.5rem; color: #1b2330; background: #fff;
  font: 15px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
h1 { font-size: 1.6rem; margin: 0 0 1rem; }
h2 { font-size: 1.15rem; margin: 1.8rem 0 .6rem; border-bottom: 1px solid #b8c0cc; padding-bottom: .2rem; }
p { margin: .5rem 0; max-width: 52rem; }
table { border-collapse: collapse; margin: .6rem 0 1rem; font-variant-numeric: tabular-nums; }
th, td { padding: .22rem .9rem .22rem 0; text-align: left; vertical-align: top; overflow-wrap: break-word; }
th { font-weight: 600; border-bottom: 1px solid #838c9c; }
td { border-bottom: 1px solid #e3e7ec; }
pre { background: #f4f5f7; padding: .6rem .8rem; white-space: pre-wrap;
  overflow-wrap: anywhere; font-size: .85rem; }
figure { margin: .8rem 0; }
img { max-width: 100%; height: auto; max-height: 30rem; }
figcaption { color: #566175; font-size: .9rem; }
@media print {
  body { max-width: none; padding: 0; font-size: 9.5pt; }
  h2, p:has(+ table) { break-after: avoid; }
  figure, tr, pre { break-inside: avoid; }
  thead { display: table-header-group; }
  img { max-height: 110mm; }
  pre { background: none; border: 1px solid #b8c0cc; }
}
"""


def html(document: Document) -> str:
    """The text of the page, with a checksum by which desaxe knows its own."""
    title = escape(document.title)
    body = [f"<h1>{title}</h1>"]
    for section in document.sections:
        body += [f"<section>\n<h2>{escape(section.title)}</h2>", *map(_block, section.blocks), "</section>"]
    head = [
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f'<meta name="generator" content="desaxe report, {UNSEALED}">',
        f"<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>",
    ]
    return sealed("\n".join([*head, *body, "</body>\n</html>\n"]))


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


def _table(table: Table) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in table.heads)
    rows = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in table.rows]
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>"
