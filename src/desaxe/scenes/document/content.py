"""The whole document of a scene that was computed: which sections, in which order."""

import warnings
from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import NamedTuple

from ...mechanism.quantity_units import UnitSystem
from ...support.extras import needed
from ..content import Content
from ..report import checks_report, feasibility_report
from ..run import Run
from .curves import curves, statuses
from .drive import drive
from .inputs import inputs, mechanism
from .motor import motor
from .origin import origin, warned
from .parts import Document, Lines, Section
from .peaks import peaks
from .spread import spread

TITLE = "Offset slider-crank"


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
        sections = [
            inputs(content, units),
            mechanism(content, units),
            _checked(run, units),
            curves(content, run.dataset, units),
            peaks(content, run.peaks, units),
            drive(content, units, asked.fluctuation),
            motor(content, run.steady, units),
            spread(content, units, asked.tolerances),
        ]
    own = [str(one.message) for one in heard if one.category.__module__.startswith("desaxe.")]
    told = [*asked.warnings, *own, *statuses(run.dataset), *run.failures]
    known = [section for section in sections if section is not None]
    return Document(content.title or TITLE, [*known, warned(told), origin(asked.command)])


def _checked(run: Run, units: UnitSystem) -> Section | None:
    """The printed values beside the computed ones, and the designs that cannot turn fully."""
    told = [checks_report(run.checks)] if run.checks else []
    found = run.feasibility
    told += [feasibility_report(found, units)] if found and found.turning < found.designs else []
    return Section("Checks", [Lines(text) for text in told]) if told else None
