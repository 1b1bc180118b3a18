"""The whole document of a scene that was computed: which sections, in which order, and its file."""

import platform
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from datetime import datetime
from importlib import import_module
from importlib.metadata import version
from math import prod
from os.path import abspath
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from ...evaluation.labels import source
from ...mechanism.quantity_units import UnitSystem
from ...support.extras import needed
from ...support.progress import Steps
from ...support.shown import printable
from ...support.written import require_path, write_whole
from ..content import Content, RequestAnswer, Run, Sink
from ..parts.peaks import peak_of
from ..schema import SceneError
from .blocks import Block, Document, Image, Lines, Section, Text, TextTable
from .curves import curves, statuses
from .design import axes_of, drive, inputs, mechanism, read_tolerances, spread
from .render import html, markdown

TITLE = "Offset slider-crank"
PACKAGES = ("numpy", "numba")
DRIVEN = ("T_in",)  # drawn with the drive
FORMS: dict[str, Callable[[Document], str]] = {".html": html, ".md": markdown}
ORDER = ("check", "feasibility", "peak", "steady", "outputs")  # of the answers
DESIGNS = 1000  # that are searched for peaks nobody named
LARGEST, BUDGET = 2_000_000, 1_300_000  # bytes of all, and of pictures, of which text makes a third more


class Page(NamedTuple):
    """A report to be written: its file, .html or .md, and its content beside the scene.

    command     the call that makes it
    tolerances  input -> half its range; in SI units once it is checked
    """

    path: Path
    command: str
    tolerances: Mapping[str, Any] = MappingProxyType({})
    fluctuation: float = 0.03
    overwrite: bool = False
    warnings: tuple[str, ...] = ()


def checked(page: Page, content: Content, units: UnitSystem) -> Page:
    """The page of a scene with its tolerances in SI units; an error where it cannot be written or drawn."""
    for module in ("matplotlib.figure", "xarray"):
        with needed("a report"):
            import_module(module)
    require_document(page.path, page.overwrite)
    others = [content.data, content.store, *(picture.file for picture in content.of("picture"))]
    if abspath(page.path) in [abspath(other) for other in others if other is not None]:
        raise ValueError(f"report {printable(page.path)}: another result of the scene is written there")
    return page._replace(tolerances=read_tolerances(content, units, page.tolerances))


def write_page(page: Page, content: Content, run: Run, units: UnitSystem) -> Path:
    """Write the report of a scene's results in these units; its path."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        answers = [*run.answers, *_peaks_of_outputs(content)]
        run = replace(run, answers=tuple(sorted(answers, key=lambda one: ORDER.index(one.key))))
        shown = run.to(content, units)
        driven = drive(content, units, page.fluctuation)
        sections = [
            inputs(content, units),
            mechanism(content, units),
            *(one.blocks(units) for one in shown.answers),
            curves(content, shown, units, DRIVEN if driven else ()),
            driven,
            spread(content, units, page.tolerances),
        ]
    messages = [str(one.message) for one in heard if one.category.__module__.startswith("desaxe.")]
    messages = [*page.warnings, *messages, *statuses(run.dataset), *run.failures]
    warned = Section("Warnings", [Text(one) for one in dict.fromkeys(messages)] or [Text("none")])
    known = [section for section in sections if section is not None]
    document = Document(content.title or TITLE, [*known, warned, _origin(page.command)])
    return write_document(document, page.path, page.overwrite)


def _peaks_of_outputs(content: Content) -> Iterator[RequestAnswer]:
    """The largest magnitudes of outputs that no [[peak]] is about."""
    if prod(len(values) for values in axes_of(content.inputs).values()) > DESIGNS:
        return
    for name in content.outputs:
        if not any(one.quantity == name for one in content.peaks):
            try:
                request = peak_of("report", {"quantity": name}, content.inputs, content.units)
            except SceneError:  # a status, or a quantity of the whole design
                continue
            yield request.plan(content).run(Sink(Steps(1, None))).to(content.units)


def _origin(command: str) -> Section:
    """Versions, date and command."""
    python = f"{platform.python_version()} ({platform.python_implementation()}, {platform.machine()})"
    rows = [("desaxe", source().removeprefix("desaxe ")), ("Python", python)]
    rows += [(name, version(name)) for name in PACKAGES]
    rows.append(("made", f"{datetime.now().astimezone():%Y-%m-%d %H:%M %z}"))
    return Section("Origin", [TextTable(("", "version"), rows), Text("Made by:"), Lines(command)])


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
            else:
                blocks.append(block)
                left -= size
        sections.append(Section(section.title, blocks))
    return Document(document.title, sections)
