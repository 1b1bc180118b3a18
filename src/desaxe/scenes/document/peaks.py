"""The section on peaks: value, angle, side of a jump, status and gradient of each design."""

from collections.abc import Iterator
from math import degrees, prod
from typing import Any

import numpy as np

from ...evaluation.in_units import in_units
from ...mechanism.catalogue import quantity
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import PeakStatus
from ...support.progress import Steps
from ...support.shown import with_unit
from ...sweeps.peak_step import WORDS
from .. import schema
from ..content import Content
from ..parts.extremes import PeakResult, peaks_of
from ..reading.requested import peak_of
from ..report import remarks, slope_text
from ..schema import SceneError
from .parts import MOST, Block, Section, Text, TextTable, axes_of, cell, thinned

DESIGNS, ROWS = 1000, 24  # that are searched for peaks nobody named, that are listed
SIDES = {-1: "-1, before it", 0: "0, no jump", 1: "+1, after it"}


def peaks(content: Content, found: tuple[PeakResult, ...], units: UnitSystem) -> Section | None:
    """The peaks of the scene, and those of its other outputs; None without any."""
    blocks: list[Block] = []
    for one in found:
        dataset = one.dataset if content.units else in_units(one.dataset, units)
        blocks += _blocks(one._replace(dataset=dataset), units)
    for one in _others(content):
        blocks += _blocks(one._replace(dataset=in_units(one.dataset, units)), units)
    return Section("Peaks", blocks) if blocks else None


def _others(content: Content) -> Iterator[PeakResult]:
    """The largest magnitudes of outputs that no [[peak]] is about."""
    if prod(len(values) for values in axes_of(content.inputs).values()) > DESIGNS:
        return
    for name in content.outputs:
        if not any(one.quantity == name for one in content.peaks):
            try:
                wanted = peak_of("report", schema.PeakTable(quantity=name), content.inputs, content.units)
            except SceneError:  # a status, or a quantity of the whole design
                continue
            yield peaks_of(wanted, content, Steps(1, None))


def _blocks(found: PeakResult, units: UnitSystem) -> list[Block]:
    one, dataset = found.peak, found.dataset
    known = quantity(one.quantity, "omega" in one.axes or "omega" in one.fixed)
    title = one.title or f"{WORDS[one.kind].capitalize()} of {one.quantity}, {known.meaning}"
    low, high = (f"{degrees(angle):g}" for angle in one.theta)
    places = list(np.ndindex(dataset["value"].shape))
    blocks: list[Block] = [Text(f"{title} (theta from {low} to {high} deg)")]
    blocks.append(_values(found, units, thinned(places, ROWS)))
    slopes = [str(name) for name in dataset.data_vars if str(name).startswith("value_wrt_")]
    if slopes:
        few = thinned(places)
        heads = ("derivative by", "unit", *(_called(found, place) or "this design" for place in few))
        rows = [_slopes(found, dataset[name], few) for name in slopes]
        blocks.append(TextTable(heads, rows))
    told = [line.strip() for line in remarks(found)]
    told += [f"Derivatives of {MOST} of {len(places)} designs are shown"] * (len(places) > MOST)
    return [*blocks, *(Text(words) for words in told)]


def _slopes(found: PeakResult, slope: Any, places: list[Any]) -> list[str]:
    """A derivative of the peaks of these designs."""
    parameter, unit = str(slope.name).removeprefix("value_wrt_"), _unit(slope)
    return [parameter, unit, *(slope_text(found, slope, place, cell) for place in places)]


def _values(found: PeakResult, units: UnitSystem, places: list[Any]) -> TextTable:
    one, dataset = found.peak, found.dataset
    angle = units.of("theta").unit
    scale = degrees(1.0) if angle == "rad" else 1.0
    axes = [f"{name} [{_unit(dataset[name])}]" for name in one.axes]
    heads = [*axes, f"value [{_unit(dataset['value'])}]"]
    heads += [f"at theta [{'deg' if angle == 'rad' else angle}]", "side of a jump", "status"]
    rows = []
    for place in places:
        status = PeakStatus(int(dataset["status"].values[place]))
        row = [cell(float(dataset[n].values[k])) for n, k in zip(one.axes, place, strict=True)]
        row += [
            cell(float(dataset["value"].values[place])),
            cell(scale * float(dataset["theta"].values[place])),
        ]
        rows.append([*row, SIDES[int(dataset["side"].values[place])], f"{status:d} {status.words}"])
    return TextTable([head.replace(" [1]", "") for head in heads], rows)


def _called(found: PeakResult, place: tuple[int, ...]) -> str:
    """A design by the inputs in which it differs from the others."""
    dataset = found.dataset
    return ", ".join(
        with_unit(f"{n} = {cell(float(dataset[n].values[k]))}", dataset[n].attrs["units"])
        for n, k in zip(found.peak.axes, place, strict=True)
    )


def _unit(array: Any) -> str:
    return str(array.attrs["units"]).replace("*", " ")
