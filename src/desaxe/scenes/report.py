"""The report of a scene as text for a terminal."""

from ..mechanism.quantity_units import UnitSystem
from .content import Content
from .document.results import files, in_units_shown, results
from .document.terminal import terminal
from .run import Run


def report(content: Content, run: Run, units: UnitSystem) -> str:
    """The whole report, in these units."""
    return "\n\n".join(filter(None, (results_report(content, run, units), files_report(content, run))))


def results_report(content: Content, run: Run, units: UnitSystem) -> str:
    """All but the files."""
    return terminal(content.title, [*results(content, in_units_shown(content, run, units), units)])


def files_report(content: Content, run: Run) -> str:
    """The files that were written, and those that were not."""
    return terminal("", [*files(content, run)])
