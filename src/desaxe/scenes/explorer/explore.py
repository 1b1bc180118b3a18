"""`explore`: a scene or inputs, as one page that is open in any browser."""

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ...evaluation.labelled import loads_of
from ...mechanism.inputs import INPUTS
from ...mechanism.keywords import check_inputs, with_known_keywords
from ...mechanism.names import LOADS
from ...mechanism.own import using
from ...mechanism.quantity_units import UnitSystem
from ...runtime.request import as_number, check_common, several
from ...support.forks import IMPORTS
from ...support.written import require_path
from .content import FORCES, STATE, PageContent, Value, content, forces_first, is_loaded
from .write import write_page

TITLE = "Offset slider-crank"
START = ("a_C", "a_C_wrt_ec")  # what the two charts show first where a scene names nothing


@with_known_keywords
def explore(
    source: str | PathLike[str] | Mapping[str, Any] | None = None,
    path: str | PathLike[str] = "explorer.html",
    *,
    names: Iterable[str] | None = None,
    branch: int = 1,
    title: str = TITLE,
    units: str | Mapping[str, str] | UnitSystem | None = None,
    overwrite: bool = False,
    **inputs: Any,
) -> Path:
    """Write an explorer page: one HTML file that works offline in any browser.

    source  a scene (`desaxe.scene`, a TOML file or a mapping); or give inputs instead, as to `evaluate`:
            ec, AB, BC [m], omega0 (or omega) [rad/s], alpha [rad/s^2], masses and loads, each a number,
            text with a unit, or a list, whose values are compared (all of
            up to five, four of more; the page says which are not shown). F_X and F_Y may be tables,
            springs, dampers or sums of these, to which the page adds a constant
    path    the file to write
    branch  of inputs: +1 (the papers) or -1; a scene has its own, and its own title
    title   what the page is headed with
    units   what the fields, values, tables and files of the page are in when it is opened, such as
            "mm, deg, rpm"; by default the scene's, or values in SI units. Inputs here are in SI units
            all the same
    names   the quantities that the page knows, each with its first sensitivities; without it those of
            the motion, drive torque and guide force where masses or loads are given, and those that the
            scene names
    overwrite  replace a file that is no such page; without it FileExistsError

    Returns the path. On the page lengths, speed and acceleration can be changed; it draws the mechanism
    to scale and quantities over the crank angle, with the numbers of `evaluate`: from the same Program,
    emitted as JavaScript. Raises ValueError or TypeError, which name what is wrong; needs the extra
    `explore`.

        dx.explore("examples/compactor.toml", "explorer.html")
        dx.explore(ec=["0 mm", "150 mm"], AB="125 mm", BC="350 mm", omega0="1500 rpm")

    See docs/choose.md: which call for which question.
    """
    place = Path(path)
    require_path(place, overwrite)
    own = UnitSystem.read(units)
    result = content_of(source, names, branch, title, inputs)
    return write_page(result._replace(units=own) if own else result, place, overwrite)


def content_of(
    source: Any,
    names: Iterable[str] | None = None,
    branch: int = 1,
    title: str = TITLE,
    inputs: Mapping[str, Any] = MappingProxyType({}),
) -> PageContent:
    """The content of the page that `explore` writes for these arguments."""
    names = None if names is None else (names,) if isinstance(names, str) else several(names)
    if source is None:
        check_common(inputs, branch)
        check_inputs("explore", inputs, tuple(INPUTS))
        numbers, loads = loads_of(inputs)
        values = {n: _value(n, v) for n, v in numbers.items()}
        given = {**values, **loads}
        return content(title, branch, given, FORCES if is_loaded(given) else START, names)
    if inputs:
        page = isinstance(source, (str, PathLike)) and Path(source).suffix != ".toml"
        beside = (
            f"path={str(source)!r} is the page to write" if page else f"{', '.join(inputs)} beside a scene"
        )
        raise TypeError(f"explore: give a scene or inputs, not both ({beside})")
    return _of_scene(source, names)


def _of_scene(source: Any, names: Iterable[str] | None) -> PageContent:
    """The content of a scene: its outputs, and the quantities of its peaks and pictures."""
    with IMPORTS:
        from ..scene import Scene, scene

    known = source if isinstance(source, Scene) else scene(source)
    inside = known.content
    requests: tuple[Any, ...] = (*inside.peaks, *inside.of("picture"))
    asked = [*inside.outputs, *(one.quantity for one in requests)]
    shown = [name for name in asked if name not in STATE]
    with using(inside.definitions):
        if is_loaded(inside.inputs):
            shown = forces_first(shown, "omega" in inside.inputs)
        page = content(inside.title or TITLE, inside.branch, inside.inputs, shown or START, names)
    return page._replace(units=inside.units, fields=known.shown_in)


def _value(name: str, inputs: Any) -> Value:
    """A number or several, in SI units."""
    requested = ("ec", "AB", "BC", "omega0", "alpha", *LOADS)
    number = as_number(name, inputs, requested, ("explore",))
    if number is not None:
        return number
    result = [as_number(name, value, requested, ("explore",)) for value in inputs]
    if not result or None in result:
        raise TypeError(f"{name} = {inputs!r}: a number or a list of numbers")
    return tuple(value for value in result if value is not None)
