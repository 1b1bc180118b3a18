"""The sections on checks, feasibility, steady states, values and files: in reports and on the terminal."""

from collections.abc import Iterator
from dataclasses import replace
from math import degrees, pi, prod
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...evaluation.in_units import in_units
from ...mechanism.quantity_units import UnitSystem
from ...support.shown import printed
from ..content import Content, Run
from ..parts.checks import CheckResult
from ..parts.motor import MotorResult
from ..parts.turning import FeasibilityResult
from ..stores.files import data_files
from ..stores.tables import table_of
from .blocks import Block, Section, Text, TextTable, cell, thinned
from .design import with_unit
from .peaks import ROWS, peak
from .render import terminal

if TYPE_CHECKING:
    import xarray as xr

FEW = 12  # points whose values are printed
GAPS = 5  # designs that cannot turn fully, reasons without a steady state
FIGURES = ("omega_mean", "fluctuation", "power_mean", "work", "multiplier", "flywheel_inertia")


def results_text(content: Content, run: Run, units: UnitSystem) -> str:
    """The results in these units as text for a terminal."""
    return terminal(content.title, [*results(content, in_units_shown(content, run, units), units)])


def files_text(content: Content, run: Run) -> str:
    """The files that were written, and those that were not, as text."""
    return terminal("", [*files(content, run)])


def in_units_shown(content: Content, run: Run, units: UnitSystem) -> Run:
    """The results in the units of the report: they are in those of the scene, in SI units without."""
    if content.units:
        return run
    peaks = tuple(one._replace(dataset=in_units(one.dataset, units)) for one in run.peaks)
    steady = run.steady and run.steady._replace(dataset=in_units(run.steady.dataset, units))
    return replace(run, peaks=peaks, steady=steady, dataset=run.dataset and in_units(run.dataset, units))


def results(content: Content, run: Run, units: UnitSystem) -> Iterator[Section]:
    """The sections on all that was computed, which is in these units."""
    if run.checks:
        yield Section("Checks", list(_checks(run.checks)))
    if run.feasibility is not None:
        yield Section("Feasibility", [Text(line) for line in _feasibility(run.feasibility, units)])
    yield from (peak(one, units) for one in run.peaks)
    if run.steady is not None:
        yield Section("Steady state", _steady(run.steady))
    if run.dataset is not None:
        yield Section("Values", _values(content, run.dataset))


def _checks(checked: tuple[CheckResult, ...]) -> Iterator[TextTable]:
    """Printed values next to the computed ones, a table for each source."""
    for source in dict.fromkeys(one.check.source for one in checked):
        rows: list[tuple[str, ...]] = []
        last = None
        for check, computed, agrees in (one for one in checked if one.check.source == source):
            number = check.printed
            cells = number.text(number.value), number.text(number.rounded(computed))
            full = f"{computed * number.factor:.8g}"
            title = "" if check.title == last else check.title
            last = check.title
            rows.append((title, check.quantity, *cells, full, "agrees" if agrees else "DIFFERS"))
        yield TextTable(("", "", source, "desaxe", "in full", ""), rows)


def _feasibility(result: FeasibilityResult, units: UnitSystem) -> Iterator[str]:
    """The limit of ec, and the designs that cannot turn."""
    if result.limit is not None:
        limit = f"|ec| < BC - AB = {with_unit(units, 'ec', result.limit)}"
        yield f"the crank turns fully for {limit if result.limit > 0.0 else 'no ec, since BC <= AB'}"
    yield f"{result.turning} of {result.designs} designs of this scene turn fully"
    designs = [one.design for one in result.infeasible]
    names = [n for n in (designs or [{}])[0] if len({design[n] for design in designs}) > 1] or ["ec"]
    for one in result.infeasible[:GAPS]:
        design = ", ".join(f"{name} = {with_unit(units, name, one.design[name])}" for name in names)
        gaps = " and ".join(f"{degrees(a):.2f} to {degrees(b):.2f}" for a, b in one.gaps)
        if any(b - a >= 2.0 * pi for a, b in one.gaps):
            yield f"infeasible: {design} cannot be assembled at any angle"
        else:
            yield f"infeasible at part of the turn: {design} cannot be assembled for theta from {gaps} deg"
    more = result.designs - result.turning - GAPS
    if more > 0:
        yield f"and {more} more"


def _steady(result: MotorResult) -> list[Block]:
    """A row for each design, and why some have no steady state."""
    dataset, axes = result.dataset, list(result.asked.axes)
    figures = [name for name in FIGURES if name in dataset.data_vars]
    rows = []
    for index in thinned(list(np.ndindex(dataset["status"].shape)), ROWS):
        row = [cell(dataset[name].values[k]) for name, k in zip(axes, index, strict=True)]
        rows.append([*row, *(cell(dataset[name].values[index]) for name in figures)])
    names = [*axes, *figures]
    messages = np.ravel(np.asarray(result.found["message"], object)).tolist()
    reasons = [message for message in dict.fromkeys(messages) if message != "ok"]
    remarks = [*reasons[:GAPS], *[f"and {len(reasons) - GAPS} more reasons"] * (len(reasons) > GAPS)]
    remarks += [f"{ROWS} of {len(messages)} designs are shown"] * (len(messages) > ROWS)
    table = TextTable(names, rows, [printed(dataset[name].units) for name in names])
    return [Text(f"On {result.asked.torque!r}."), table, *map(Text, remarks)]


def _values(content: Content, dataset: "xr.Dataset") -> list[Block]:
    """The names and axes of the labelled result, and the values where they are few."""
    shape = " x ".join(f"{name} ({size})" for name, size in dataset.sizes.items()) or "one point"
    if content.store is not None:
        kept = f"in the store {content.store}" + (", group steady beside them" if content.steady else "")
        return [Text(f"{', '.join(map(str, dataset.data_vars))} over {shape}"), Text(kept)]
    taken = content.reduction
    of = f" ({', '.join(taken.kinds)} over {', '.join(taken.axes)})" if taken else ""
    return [Text(f"{', '.join(content.outputs)}{of} over {shape}"), *_few_values(dataset)]


def _few_values(dataset: "xr.Dataset") -> Iterator[TextTable]:
    """A row for each quantity that has one value; a table of a few points."""
    arrays = dataset.data_vars.values()
    single = [a for a in arrays if not a.ndim and (a.name != "margin" or not dataset.sizes)]
    if single:
        rows = [(str(a.name), cell(float(a)), printed(a.attrs.get("units", "1"))) for a in single]
        yield TextTable(("quantity", "value", "unit"), rows)
    if dataset.sizes and prod(dataset.sizes.values()) <= FEW:
        heads, *points = table_of(dataset.drop_vars([str(a.name) for a in single]))
        yield TextTable(heads, [[cell(v) if isinstance(v, float) else str(v) for v in row] for row in points])


def files(content: Content, run: Run) -> Iterator[Section]:
    """A row for each file that was written, and a line for each that was not."""
    paths = [str(file) for file in data_files(content) if file in run.files]
    parts = ["the values"] * bool(content.outputs) + [f"group {name}" for name in content.groups]
    rows = [*zip([*paths, *[""] * len(parts)], parts, strict=False)] if paths else []
    rows += [
        (one.file, f"{one.quantity} over {one.over}")
        for one in content.pictures
        if Path(one.file) in run.files
    ]
    if rows:
        yield Section("Written", [TextTable(("", ""), rows)])
    elif run.dataset is not None and content.data is None and content.store is None:
        yield Section("Not kept in a file", [Text('give [results] data = "out/values.nc"')])
    if run.failures:
        yield Section("Not written", [Text(failure) for failure in run.failures])
