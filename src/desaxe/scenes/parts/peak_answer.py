"""The peaks of designs: values, angles, sides and slopes, and the claims about them, as a section."""

from dataclasses import dataclass
from math import degrees, isfinite, isnan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.load import OverY
from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import PeakStatus
from ...support.answer import cleaned
from ...support.shown import printed
from ...sweeps.peak_step import WORDS
from ..content import RequestAnswer
from ..document.blocks import ROWS, Block, Section, Text, TextTable, cell, thinned, with_unit

SIDEWAYS = ("ec", "F_X", "g_X")  # change sign where the mechanism is mirrored at the Y axis
HUGE = 1e6  # percent: more is written as a power of ten
SYMBOLS = {"absmax": "|{}|", "max": "max {}", "min": "min {}"}
WRT = "value_wrt_"
SIDE = "side: of a jump of a load, from which this is the limit: -1 smaller theta, +1 larger theta"
MIRRORED = "+-: at ec = 0 the peak is at theta and at -theta; such a slope is + at one and - at the other"


class ClaimResult(NamedTuple):
    """A claimed increase of a peak over its baseline and the computed one, in percent."""

    claim: Any  # a Claim of `peaks`
    computed: float
    agrees: bool


@dataclass(frozen=True, kw_only=True)
class PeakResult(RequestAnswer):
    """The peaks of all designs, labelled, and the checked claims about them.

    `dataset` has over the designs' dimensions: `value`, `theta`, `side`, `status`, `value_wrt_<parameter>`
    and, where there is a baseline, `increase` over it in percent. `mirrored` tells the designs with
    ec = 0 that reach the peak at -theta as well, where the derivatives with respect to what points to the
    side (ec, F_X, g_X) have the other sign.
    """

    key = "peak"
    peak: Any  # a Peak of `peaks`
    claims: tuple[ClaimResult, ...]
    mirrored: NDArray[np.bool_]

    def blocks(self, units: UnitSystem) -> Section:
        """A row for each design, its slopes, and the claims."""
        one = self.peak
        known = quantity(one.quantity, one.state)
        low, high = (f"{degrees(angle):g}" for angle in one.theta)
        title = one.title or f"{WORDS[one.kind].capitalize()} of {one.quantity}, {known.meaning}"
        blocks: list[Block] = [_designs(self, units)]
        if not one.axes:
            blocks += _gradient(self, units)
        blocks += map(Text, [*_remarks(self), *(_claim(self, claim, units) for claim in self.claims)])
        return Section(f"{title} (theta from {low} to {high} deg)", blocks)


def _designs(result: PeakResult, units: UnitSystem) -> TextTable:
    """A row for each design; of several the slopes that are requested, too."""
    one, dataset = result.peak, result.dataset
    angle = units.of("theta").unit
    scale = degrees(1.0) if angle == "rad" else 1.0
    slopes = [p for p in one.sensitivities if one.axes and f"{WRT}{p}" in dataset]
    has_sides, is_based = bool(dataset["side"].values.any()), "increase" in dataset
    heads = [*one.axes, SYMBOLS[one.kind].format(one.quantity), "at theta", *["side"] * has_sides]
    heads += [f"over {_design(one.at_baseline, units)}"] * is_based + [f"d/d({p})" for p in slopes]
    units_of = [*(_unit(dataset[name]) for name in (*one.axes, "value")), "deg" if scale > 1.0 else angle]
    units_of += [*[""] * (has_sides + is_based), *(_slope_unit(result, p, units) for p in slopes)]
    rows = []
    for index in thinned(list(np.ndindex(dataset["value"].shape)), ROWS):
        at = {name: dataset[name].values[index] for name in ("value", "theta", "side")}
        row = [cell(dataset[name].values[k]) for name, k in zip(one.axes, index, strict=True)]
        row += [cell(at["value"]), cell(scale * at["theta"])]
        row += [f"{at['side']:+d}".replace("+0", "0")] * has_sides
        row += [_percent(float(dataset["increase"].values[index]))] if is_based else []
        values = _slopes(result, index, units) if slopes else {}
        rows.append([*row, *(values[p] for p in slopes)])
    return TextTable(heads, rows, units_of)


def _gradient(result: PeakResult, units: UnitSystem) -> list[Block]:
    """The whole gradient of one design, a row for each parameter."""
    rows = [(p, slope, _slope_unit(result, p, units)) for p, slope in _slopes(result, (), units).items()]
    return [TextTable(("derivative by", "value", "unit"), rows)] if rows else []


def _slopes(result: PeakResult, index: tuple[int, ...], units: UnitSystem) -> dict[str, str]:
    """The slopes of a design; of either sign by what points to the side where two angles share the peak."""
    columns = {str(n).removeprefix(WRT): c for n, c in result.dataset.items() if str(n).startswith(WRT)}
    gradient = {p: float(column.values[index]) for p, column in columns.items()}
    slopes = cleaned(gradient, {p: _slope_unit(result, p, units) for p in columns})
    shared = {p for p in SIDEWAYS if slopes.get(p) and result.mirrored[index]}
    return {p: f"+-{cell(abs(v))}" if p in shared else cell(v) for p, v in slopes.items()}


def _slope_unit(result: PeakResult, parameter: str, units: UnitSystem) -> str:
    """The unit of a slope: of one with respect to a mass or an inertia that of the value, divided."""
    if not INPUTS[parameter].unit.startswith("kg"):
        return _unit(result.dataset[WRT + parameter])
    divisor = printed(units.of(parameter).unit)
    return f"{_unit(result.dataset['value'])}/{f'({divisor})' if ' ' in divisor else divisor}"


def _unit(array: Any) -> str:
    return printed(str(array.attrs["units"]))


def _percent(value: float) -> str:
    """A change in percent as short text: a dash for NaN, a power of ten if huge."""
    text = f"{value:+.1f}" if abs(value) < HUGE else f"{value:+.3g}"
    return "-" if isnan(value) else f"{text[1:] if float(text) == 0.0 else text} %"


def _remarks(result: PeakResult) -> list[str]:
    """Footnotes on designs without an ordinary peak and on rows left out."""
    one, status = result.peak, result.dataset["status"].values
    counts = {code: int(np.sum(status == int(code))) for code in PeakStatus if code}
    lines = [f"designs: {count} {code.words}" for code, count in counts.items() if count]
    if result.mirrored.any() and any(name in SIDEWAYS for name in one.sensitivities):
        lines.append(MIRRORED)
    if result.dataset["side"].values.any():
        lines.append(SIDE)
    fixed = [n for n, load in one.loads.items() if isinstance(load, OverY) and not load.centre]
    if fixed and any(name in LENGTHS for name in one.sensitivities):
        named = " and ".join(fixed)
        lines.append(f"d/d length: {named} over Y stays where it is, over_stroke moves with the stroke")
    if status.size > ROWS:
        lines.append(f"{ROWS} of {status.size} designs are shown")
    return lines


def _claim(result: PeakResult, checked: ClaimResult, units: UnitSystem) -> str:
    claim = checked.claim
    published = claim.increase.text(claim.increase.value)
    where = f"{_design(claim.at, units)} over {_design(result.peak.at_baseline, units)}"
    if not isfinite(checked.computed):
        return f"increase of {where}: {claim.source} {published}, but there is no finite change: DIFFERS"
    computed = claim.increase.text(claim.increase.rounded(checked.computed))
    verdict = "agrees" if checked.agrees else "DIFFERS"
    full = f" ({checked.computed:.2f} %)" if abs(checked.computed) < HUGE else ""
    return f"increase of {where}: {claim.source} {published}, desaxe {computed}{full}: {verdict}"


def _design(inputs: dict[str, float], units: UnitSystem) -> str:
    return ", ".join(f"{n} = {with_unit(units, n, v) if v else 0}" for n, v in inputs.items())
