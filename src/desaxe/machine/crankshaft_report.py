"""`Crankshaft.report`: its sliders, drive, peaks and balance as one page to hand on."""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..evaluation.labels import source
from ..scenes.document.blocks import Document, Lines, Section, Text, TextTable, cell, image_of
from ..scenes.document.page import require_document, write_document
from ..scenes.document.render import terminal
from ..scenes.schema import SceneError
from ..scenes.stores.files import check_place, write
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
    origin = Section("Origin", [Lines(source())])
    return write_document(
        Document(title or _title(shaft), [*_sections(shaft, names, fluctuation), origin]), file, overwrite
    )


def run_text(shaft: Any, data: Mapping[str, Any], theta: Any, overwrite: bool) -> str:
    """The report of a scene file with [crankshaft] as text, once its outputs are in [results] data.

    theta  its crank angles [rad]: outputs over them are what the file gets
    """
    wrong = next((key for key in OF_ONE if data.get(key)), None)
    if wrong is not None:
        raise SceneError(f"{wrong}: of one slider; a crankshaft has outputs, and data in [results]")
    names, results = tuple(data.get("outputs") or OUTPUTS), data.get("results", {})
    files: list[Path] = []
    if "data" in results:
        path = Path(results["data"])
        check_place(path, overwrite)
        angles = shaft.units.of("theta").shown(np.asarray(theta, float))
        files = write(path, shaft.grid(list(names), theta=angles), {}, overwrite)
    written = [Section("Written", [Text(str(file)) for file in files])] if files else []
    return terminal(data.get("title") or _title(shaft), [*_sections(shaft, names, 0.03), *written])


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
    alike = [one for k, one in enumerate(shaft.members) if one not in shaft.members[:k]]
    return Section("Sliders", [angles, *(Lines(repr(one)) for one in alike)])


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
        for p, slope in top["gradient"].items():
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
