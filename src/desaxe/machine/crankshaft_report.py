"""`Crankshaft.report`: its sliders, drive, peaks and balance as one page to hand on."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..evaluation.labels import source
from ..mechanism.messages import errors_in
from ..scenes.content import Content, Sink
from ..scenes.document.blocks import (
    Document,
    Lines,
    Section,
    Text,
    TextTable,
    cell,
    image_of,
    with_unit,
)
from ..scenes.document.page import require_document, write_document
from ..scenes.document.render import terminal
from ..scenes.parts.motor import ROWS, OnMotor
from ..scenes.scene import compute, steps_of
from ..scenes.schema import SceneError
from ..scenes.stores.files import check_place, write
from ..support.answer import cleaned
from ..support.files import as_path
from ..support.shown import printed

OUTPUTS = ("T_in", "F_shaking_X", "F_shaking_Y", "M_shaking")
BALANCE = ("F_inertia_X", "F_inertia_Y", "M_inertia", "C_inertia_X", "C_inertia_Y")
ORDERS = 6
OF_ONE = ("reduce", "check", "peak", "picture")  # keys of a scene of one slider


def write_report(
    shaft: Any,
    path: str | PathLike[str],
    outputs: Sequence[str] | None,
    fluctuation: float,
    overwrite: bool,
    title: str = "",
) -> Path:
    """Compute and write the page of a crankshaft; its path."""
    file = as_path("path", path)
    require_document(file, overwrite)
    names = OUTPUTS if outputs is None else (outputs,) if isinstance(outputs, str) else tuple(outputs)
    return _write(title or _title(shaft), _sections(shaft, names, fluctuation), file, overwrite)


class ShaftScene(NamedTuple):
    """A scene file with [crankshaft]: the crankshaft, the scene of one slider, and what it asks for."""

    shaft: Any
    content: Content
    title: str
    outputs: tuple[str, ...]
    data: Path | None

    def run(self, overwrite: bool, page: Path | None = None) -> str:
        """The report as text once outputs, and steady states, are in [results] data; and the page of it."""
        if self.data is not None:
            check_place(self.data, overwrite)
        if page is not None:
            require_document(page, overwrite)
        units: Any = self.content.units
        fluctuation: Any = 0.03  # that of `Crankshaft.report`
        requests = [self._on_shaft(one) for one in self.content.of("steady")]
        content = replace(self.content, requests=tuple(requests))
        with errors_in(units):
            run = compute(content, Sink(steps_of(content)))
        for one in self.content.of("steady"):
            fluctuation = one.fixed.get("fluctuation", fluctuation)
        sections = [*_sections(self.shaft, self.outputs, fluctuation), *run.blocks(content, units)]
        files: list[Path] = []
        if self.data is not None:
            theta = self.shaft.units.of("theta").shown(np.asarray(content.inputs.get("theta", 0.0), float))
            groups = dict(zip(content.groups, (one.dataset for one in run.answers), strict=True))
            files += write(self.data, self.shaft.grid(list(self.outputs), theta=theta), groups, overwrite)
        if page is not None:
            files.append(_write(self.title, sections, page, overwrite))
        written = [Section("Written", [Text(str(file)) for file in files])] if files else []
        return terminal(self.title, [*sections, *written])

    def _on_shaft(self, one: OnMotor) -> OnMotor:
        """Steady states of the shaft, which has all inputs but those of the flywheel, on a motor."""
        fixed = {n: value for n, value in one.fixed.items() if n in (*ROWS, "omega0")}
        return replace(one, fixed=fixed, sliders=self.shaft["sliders"])


def requested(shaft: Any, content: Content, data: Mapping[str, Any]) -> ShaftScene:
    """The requests of a scene file with [crankshaft]; SceneError for those of one slider."""
    wrong = next((key for key in OF_ONE if data.get(key)), None)
    if wrong is not None:
        raise SceneError(f"{wrong}: of one slider; a crankshaft has outputs, and data in [results]")
    names, file = tuple(data.get("outputs") or OUTPUTS), data.get("results", {}).get("data")
    shaft.evaluate(list(names), theta=0.0)  # ValueError for a name that is none
    title = data.get("title") or _title(shaft)
    return ShaftScene(shaft, content, title, names, None if file is None else Path(file))


def _write(title: str, sections: Sequence[Section], file: Path, overwrite: bool) -> Path:
    """Write a page of sections; its path."""
    return write_document(Document(title, [*sections, Section("Origin", [Lines(source())])]), file, overwrite)


def _title(shaft: Any) -> str:
    return f"Crankshaft with {len(shaft.members)} sliders"


def _sections(shaft: Any, names: Sequence[str], fluctuation: float) -> list[Section]:
    return [_sliders(shaft), _drive(shaft, fluctuation), _peaks(shaft, names), _balance(shaft)]


def _unit(shaft: Any, name: str) -> str:
    return printed(shaft.units.of(name).unit)


def _sliders(shaft: Any) -> Section:
    """The angles of the sliders, and the inputs of each."""
    heads: tuple[str, ...] = ("phase", "bank", "firing", "position")
    members = shaft["sliders"].members
    if members[0].position is None:
        heads = heads[:-1]
    rows = [
        (str(k), *(cell(float(shaft.units.of(n).shown(getattr(member, n)))) for n in heads))
        for k, member in enumerate(members)
    ]
    angles = TextTable(("slider", *heads), rows, ("", *(_unit(shaft, n) for n in heads)))
    inertia = with_unit(shaft.units, "I_shaft", shaft["sliders"].I_shaft)
    alike = [one for k, one in enumerate(shaft.members) if one not in shaft.members[:k]]
    return Section("Sliders", [angles, Text(f"I_shaft = {inertia}"), *(Lines(repr(one)) for one in alike)])


def _drive(shaft: Any, fluctuation: float) -> Section:
    """Torque, power and flywheel, with the torque of each slider."""
    result = shaft.drive(fluctuation=fluctuation)
    picture = image_of(shaft.plot.each("T_in").figure, "Torque of all sliders and of each")
    return Section("Drive", [TextTable(("figure", "value"), result.rows()), picture])


def _peaks(shaft: Any, names: Sequence[str]) -> Section:
    """The largest magnitudes, their angles, and what inputs do to them."""
    tables = []
    for name in names:
        top, unit, angle = shaft.peak(name), _unit(shaft, name), _unit(shaft, "theta")
        rows = [(name, cell(top["value"]), unit), ("at theta", cell(top["theta"]), angle)]
        for p, slope in cleaned(top["gradient"], top.units["gradient"]).items():
            rows.append((f"by {p}", cell(slope), printed(shaft.units.of(name).per([shaft.units.of(p)]).unit)))
        tables.append(TextTable(("largest magnitude", "value", "unit"), rows))
    return Section("Peaks", tables)


def _balance(shaft: Any) -> Section:
    """The harmonics of inertia forces and couples, and the weights that balance the first two orders."""
    placed = shaft["sliders"].members[0].position is not None
    balance = BALANCE if placed else BALANCE[:3]
    series = {name: shaft.harmonics(name, orders=ORDERS) for name in balance}
    first = series[balance[0]]["order"]
    rows = [
        (f"{order:g}", *(cell(result["amplitude"][k]) for result in series.values()))
        for k, order in enumerate(first)
        if order == int(order)
    ]
    orders = TextTable(("order", *balance), rows, ("", *(_unit(shaft, name) for name in balance)))
    weight = shaft.counterweight()
    parts = {"on the shaft": weight, "turning against it": weight["counter_rotating"]}
    for way, part in weight["second_order"].items():
        parts[f"at twice the speed, {way.replace('_', '-')}"] = part
    rows = [(words, cell(part["product"]), cell(part["angle"])) for words, part in parts.items()]
    units = ("", _unit(shaft, "product"), _unit(shaft, "angle"))
    star = image_of(shaft.plot.star("F_inertia_Y", order=1).figure, "Star of the first order")
    return Section("Balance", [orders, TextTable(("weight", "mass x radius", "angle"), rows, units), star])
