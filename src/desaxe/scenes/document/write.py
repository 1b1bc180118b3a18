"""The file of a document, in the form of its suffix."""

from collections.abc import Callable
from pathlib import Path

from ...support.shown import printable
from ...support.written import require_path, write_whole
from .blocks import Block, Document, Image, Section, Text
from .html import html
from .markdown import markdown

FORMS: dict[str, Callable[[Document], str]] = {".html": html, ".md": markdown}
LARGEST, BUDGET = 2_000_000, 1_300_000  # bytes of all, and of pictures, of which text makes a third more


def require_document(path: Path, overwrite: bool) -> None:
    """ValueError or OSError where no document can be written, or where something else is."""
    if path.suffix.lower() not in FORMS:
        raise ValueError(
            f"{printable(path)}: a report is written as {' or '.join(FORMS)}; a browser prints .html to PDF"
        )
    require_path(path, overwrite)


def write_document(document: Document, path: Path, overwrite: bool = False) -> Path:
    """Write a document of at most 2 MB, whole or not at all; its path."""
    require_document(path, overwrite)
    budget, form = BUDGET, FORMS[path.suffix.lower()]
    while len((text := form(_within(document, budget))).encode()) > LARGEST and budget:
        budget //= 2
    with write_whole(path, overwrite) as staged:
        staged.write_text(text, encoding="utf-8", newline="\n")
    return path


def _within(document: Document, left: int) -> Document:
    """The document with `left` bytes of pictures, words in the place of others."""
    sections = []
    for section in document.sections:
        blocks: list[Block] = []
        for block in section.blocks:
            size = len(block.data) if isinstance(block, Image) else 0
            if isinstance(block, Image) and size > left:
                blocks.append(Text(f"{block.words}: left out, a report has at most 2 MB"))
                continue
            left -= size
            blocks.append(block)
        sections.append(Section(section.title, blocks))
    return Document(document.title, sections)
