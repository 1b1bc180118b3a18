"""The report of a scene as text for a terminal."""

from ..mechanism.quantity_units import UnitSystem
from .content import Content
from .document.results import files, in_units_shown, results
from .document.terminal import terminal
from .run import Run


def report(content: Content, run: Run, units: UnitSystem) -> str:
    """The whole report, in these units."""
    shown = in_units_shown(content, run, units)
    return terminal(content.title, [*results(content, shown, units), *files(content, run)])


def files_report(content: Content, run: Run) -> str:
    """The part of it on the files."""
    return terminal("", [*files(content, run)])
