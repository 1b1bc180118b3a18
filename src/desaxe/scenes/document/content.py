"""The whole document of a scene that was computed: which sections, in which order."""

import platform
import warnings
from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from importlib import import_module
from importlib.metadata import version
from types import MappingProxyType
from typing import NamedTuple

from ...evaluation.labels import source
from ...mechanism.quantity_units import UnitSystem
from ...support.extras import needed
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


class DocumentContext(NamedTuple):
    """The content of a document beside its scene: the command, warnings so far, tolerances [SI]."""

    command: str
    warnings: tuple[str, ...] = ()
    tolerances: Mapping[str, float] = MappingProxyType({})
    fluctuation: float = 0.03


def require_drawing() -> None:
    """Fail early where what draws the pictures, or labels the values, is not installed."""
    for module in ("matplotlib.figure", "xarray"):
        with needed("a report"):
            import_module(module)


def document_of(content: Content, run: Run, units: UnitSystem, asked: DocumentContext) -> Document:
    """The document of a scene's results, in these units."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        run = replace(run, peaks=(*run.peaks, *peaks_of_outputs(content)))
        shown = in_units_shown(content, run, units)
        sections = [
            inputs(content, units),
            mechanism(content, units),
            *results(content, shown, units),
            curves(content, shown, units),
            drive(content, units, asked.fluctuation),
            spread(content, units, asked.tolerances),
        ]
    own = [str(one.message) for one in heard if one.category.__module__.startswith("desaxe.")]
    told = [*asked.warnings, *own, *statuses(run.dataset), *run.failures]
    known = [section for section in sections if section is not None]
    return Document(content.title or TITLE, [*known, _warned(told), _origin(asked.command)])


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
