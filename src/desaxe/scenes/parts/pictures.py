"""[[picture]]: families of curves as files."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

from ...evaluation.grid import grid
from ...evaluation.in_units import in_units
from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import UnitSystem
from ...support.forks import IMPORTS
from ..content import Content, PlanRow, RequestPlan, Sink
from ..reading.values import (
    Value,
    design_of,
    only_inputs,
    require_for_grid,
    require_known,
    single,
    values_of,
    with_others,
)
from ..schema import SceneError, hint, shown
from .grid import arrays_of


@dataclass(frozen=True)
class PictureRequest:
    """A family of curves and the file it goes to."""

    key = "picture"
    title: str
    file: str
    quantity: str
    over: str
    family: str | None
    inputs: dict[str, Value]

    def plan(self, content: Content) -> RequestPlan:
        """The points of its curves; running draws them into the file, in the units of the report."""
        points = prod(len(value) for value in self.inputs.values() if isinstance(value, tuple))
        work = [PlanRow(f"picture of {self.quantity}", points, "points", f"drawn to {self.file}")]
        return RequestPlan(lambda sink: self._draw(content, sink), 1, work, self.file)

    def _draw(self, content: Content, sink: Sink) -> list[Path]:
        sink.steps.next(f"drawing {self.file}")
        axes = drawn(self, content, sink.units)
        with IMPORTS:
            from ...plot import save
        return [save(axes.figure, self.file, overwrite=sink.overwrite)]


def picture_of(
    key: str, table: Mapping[str, Any], inputs: Mapping[str, Value], units: UnitSystem
) -> PictureRequest:
    """The curves of a [[picture]]."""
    name, over, written = table["quantity"], table.get("over", "theta"), table.get("family", {})
    only_inputs(f"{key}.family", written)
    if len(written) > 1:
        raise SceneError(f"{key}.family: one input makes a family, got {', '.join(written)}")
    family = {n: values_of(f"{key}.family.{n}", n, value, units) for n, value in written.items()}
    at = design_of(f"{key}.at", table.get("at", {}), units)
    there = with_others(with_others(inputs, at), family)
    require_known(f"{key}.quantity", name, "omega" in there)
    needed = require_for_grid(f"{key}.quantity", (name,), there)
    if over not in INPUTS:
        raise SceneError(f"{key}.over = {shown(over)}: unknown input; {hint(over, tuple(INPUTS))}")
    if not isinstance(there.get(over), tuple) or over in family:
        raise SceneError(
            f"{key}.over = {shown(over)}: it must be an input that has a list or range of values"
        )
    member = next(iter(family), None)
    curves = [n for n in (member, over) if n is not None]
    fixed = single(key, [n for n in needed if n not in curves], there)
    values = {**{n: there[n] for n in curves}, **fixed}
    return PictureRequest(table.get("title", ""), table["file"], name, over, member, values)


def drawn(picture: PictureRequest, content: Content, units: UnitSystem) -> Any:
    """The curves of a picture, in these units; returns the Axes."""
    with IMPORTS:
        from ...plot import curves

    # With the names of the outputs the kernel of the grid serves here too, where all inputs are the same.
    shared = picture.quantity in content.outputs and set(picture.inputs) == set(content.inputs)
    names = content.outputs if shared else (picture.quantity,)
    options: dict[str, Any] = {"accuracy": content.accuracy, "threads": content.threads}
    values: Any = grid(names, branch=content.branch, **options, **arrays_of(picture.inputs))
    dataset = in_units(values, units)
    axes: Any = curves(dataset, picture.quantity, over=picture.over, family=picture.family).axes
    title = picture.title or content.title
    if title:
        axes.set_title(" ".join(title.split()), loc="left", parse_math=False)  # text, no TeX
    return axes
