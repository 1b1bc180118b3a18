"""The file of a document, in the form of its suffix."""

from collections.abc import Callable, Iterable
from importlib import import_module
from os.path import abspath
from pathlib import Path

from ...mechanism.quantity_units import UnitSystem
from ...support.extras import needed
from ...support.shown import printable
from ...support.written import require_path, write_whole
from ..content import Content
from ..run import Run
from .blocks import Block, Document, Image, Section, Text
from .content import Page, document_of
from .html import html
from .markdown import markdown
from .spread import read_tolerances

FORMS: dict[str, Callable[[Document], str]] = {".html": html, ".md": markdown}
LARGEST, BUDGET = 2_000_000, 1_300_000  # bytes of all, and of pictures, of which text makes a third more


def checked(page: Page, content: Content, units: UnitSystem, heard: Iterable[str] = ()) -> Page:
    """The page of a scene with its tolerances in SI units; an error where it cannot be written or drawn."""
    for module in ("matplotlib.figure", "xarray"):
        with needed("a report"):
            import_module(module)
    require_document(page.path, page.overwrite)
    others = [content.data, content.store, *(picture.file for picture in content.pictures)]
    if abspath(page.path) in [abspath(other) for other in others if other is not None]:
        raise ValueError(f"report {printable(page.path)}: another result of the scene is written there")
    return page._replace(tolerances=read_tolerances(content, units, page.tolerances), warnings=tuple(heard))


def write_page(page: Page, content: Content, run: Run, units: UnitSystem) -> Path:
    """Write the report of a scene's results; its path."""
    return write_document(document_of(content, run, units, page), page.path, page.overwrite)


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
