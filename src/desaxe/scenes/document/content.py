"""The whole document of a scene that was computed: which sections, in which order."""

import platform
import warnings
from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from ...evaluation.labels import source
from ...mechanism.quantity_units import UnitSystem
from ..content import Content
from ..run import Run
from .blocks import Document, Lines, Section, Text, TextTable
from .curves import curves, statuses
from .drive import drive
from .inputs import inputs, mechanism
from .peaks import peaks_of_outputs
from .results import in_units_shown, results
from .spread import spread

TITLE = "Offset slider-crank"
PACKAGES = ("numpy", "numba")
DRIVEN = ("T_in",)  # drawn with the drive


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


def document_of(content: Content, run: Run, units: UnitSystem, page: Page) -> Document:
    """The document of a scene's results, in these units."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        run = replace(run, peaks=(*run.peaks, *peaks_of_outputs(content)))
        shown = in_units_shown(content, run, units)
        driven = drive(content, units, page.fluctuation)
        sections = [
            inputs(content, units),
            mechanism(content, units),
            *results(content, shown, units),
            curves(content, shown, units, DRIVEN if driven else ()),
            driven,
            spread(content, units, page.tolerances),
        ]
    own = [str(one.message) for one in heard if one.category.__module__.startswith("desaxe.")]
    told = [*page.warnings, *own, *statuses(run.dataset), *run.failures]
    known = [section for section in sections if section is not None]
    return Document(content.title or TITLE, [*known, _warned(told), _origin(page.command)])


def _warned(words: list[str]) -> Section:
    """The warnings, and the points without a value."""
    return Section("Warnings", [Text(one) for one in dict.fromkeys(words)] or [Text("none")])


def _origin(command: str) -> Section:
    """Versions, date and command."""
    python = f"{platform.python_version()} ({platform.python_implementation()}, {platform.machine()})"
    rows = [("desaxe", source().removeprefix("desaxe ")), ("Python", python)]
    rows += [(name, version(name)) for name in PACKAGES]
    rows.append(("made", f"{datetime.now().astimezone():%Y-%m-%d %H:%M %z}"))
    return Section("Origin", [TextTable(("", "version"), rows), Text("Made by:"), Lines(command)])
