"""`Machine.report`: everything about a machine as one page to hand on."""

import warnings
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ..definitions.tables import tables_of
from ..mechanism.messages import errors_in
from ..mechanism.names import LOADS
from ..mechanism.own import used_by, using
from ..mechanism.slips import warn_of_slips
from ..scenes.content import Sink
from ..scenes.document.page import Page, checked, require_document, write_page
from ..scenes.scene import compute, steps_of
from ..support.files import as_path
from ..support.progress import progress_bar
from .scenes import data_of, with_inputs

MOTION, FORCES, STANDING = ("Y", "V_C", "a_C"), ("T_in", "N_C"), ("Y", "phi")


def write_report(
    machine: Any, path: str | PathLike[str], outputs: Any, options: dict[str, Any], more: Mapping[str, Any]
) -> Path:
    """Compute the scene of a machine and write its document; the path."""
    if "results" in more:
        raise TypeError("report: no results are written but the page: leave results out")
    page = Page(as_path("path", path), "", **options)
    require_document(page.path, page.overwrite)
    names = _usual(machine) if outputs is None else outputs
    with progress_bar() as watch, warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        warn_of_slips(machine.in_units(), machine.units)
        scene = machine.scene(names, **more)
        content, units = scene.content, scene.shown_in
        page = checked(page, content, units)
        with using(content.definitions), errors_in(units):
            steps = steps_of(content)
            steps.watch, steps.total = watch, steps.total + 1
            run = compute(content, Sink(steps, page.overwrite))
            own = [one for one in heard if one.category.__module__.startswith("desaxe.")]
            command = _command(machine, page.path, names, options, more)
            page = page._replace(command=command, warnings=tuple(str(one.message) for one in own))
            steps.next(f"writing {page.path.name}")
            return write_page(page, content, run, units)


def _usual(machine: Mapping[str, Any]) -> tuple[str, ...]:
    """The default outputs: the motion, and forces under masses or loads."""
    if not ("omega0" in machine or "omega" in machine):
        return STANDING
    return (*MOTION, *(FORCES if any(name in machine for name in LOADS) else ()))


def _command(
    machine: Any, path: Path, outputs: Any, options: Mapping[str, Any], more: Mapping[str, Any]
) -> str:
    """The calls that make the report again, of the machine as a scene: its tables of loads are data."""
    rest = with_inputs(machine, more)[1]
    try:
        data = data_of(machine, outputs, more)[0]
    except TypeError as error:  # a load that is a function
        return f"machine.report({str(path)!r}, ...): {error}"
    rest = {key: value if key == "theta" else data.pop(key) for key, value in rest.items() if key != "units"}
    names = (outputs,) if isinstance(outputs, str) else tuple(outputs)
    if own := tables_of(used_by(names)):
        data["quantities"] = own
    asked = {"outputs": outputs, **{n: v for n, v in options.items() if v and n != "overwrite"}, **rest}
    words = [repr(str(path)), *(f"{name}={value!r}" for name, value in asked.items())]
    return f"machine = desaxe.Machine({data!r})\nmachine.report({', '.join(words)})"
