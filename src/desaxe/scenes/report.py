"""The report of a scene as text for a terminal, at most 100 columns wide."""

from collections.abc import Callable, Sequence
from math import degrees, isfinite, isnan, pi, prod
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.in_units import in_units
from ..loads.load import OverY
from ..mechanism.catalogue import quantity
from ..mechanism.names import LENGTHS
from ..mechanism.quantity_units import UnitSystem
from ..mechanism.status import PeakStatus
from ..support.shown import with_unit
from ..support.text_table import table as text_table
from ..sweeps.peak_step import WORDS
from .content import Content, Peak
from .parts.extremes import SIDEWAYS, ClaimResult, PeakResult, groups_of
from .parts.motor import MotorResult
from .parts.turning import FeasibilityResult
from .run import CheckResult, Run
from .stores.places import data_files
from .stores.tables import table_of

if TYPE_CHECKING:
    import xarray as xr

WIDTH = 100  # columns
ROWS = 24  # of a table; a longer one is thinned out
HUGE = 1e6  # percent: more is written as a power of ten
FEW = 12  # points whose values are printed
GAPS = 5  # designs that cannot turn fully


def report(content: Content, result: Run, units: UnitSystem) -> str:
    """The whole report, in these units."""
    peaks = result.peaks
    if not content.units:  # the data of peaks are in SI units then
        peaks = tuple(found._replace(dataset=in_units(found.dataset, units)) for found in peaks)
    parts = [content.title] if content.title else []
    parts += [checks_report(result.checks)] if result.checks else []
    parts += [feasibility_report(result.feasibility, units)] if result.feasibility else []
    parts += [_peak(found, units) for found in peaks]
    parts += [_steady(result.steady, content, units)] if result.steady is not None else []
    parts += [_values(content, result, units)] if result.dataset is not None else []
    parts += [files_report(content, result)] if result.files or result.failures else []
    return "\n\n".join(parts)


def table(rows: Sequence[Sequence[str]], align: str) -> list[str]:
    """Rows of cells as lines of a report; a letter of `align` for each column, l or r."""
    return text_table(rows, align, gap="   ", indent="  ")


def number(value: float) -> str:
    """A number in six digits."""
    return f"{float(value) + 0.0:.6g}"  # and no -0


# ---- printed values ------------------------------------------------------------------------------


def checks_report(results: tuple[CheckResult, ...]) -> str:
    """Printed values next to the computed ones, a block for each source."""
    sources = list(dict.fromkeys(result.check.source for result in results))
    blocks = [
        _block(source, [result for result in results if result.check.source == source]) for source in sources
    ]
    return "\n".join(["Printed and computed", *blocks])


def _block(source: str, results: list[CheckResult]) -> str:
    rows = [("", "", source, "desaxe", "in full", "")]
    last = None
    for check, computed, agrees in results:
        printed = check.printed
        full = f"{computed * printed.factor:.8g}"
        title = "" if check.title == last else check.title
        last = check.title
        cells = printed.text(printed.value), printed.text(printed.rounded(computed))
        rows.append((title, check.quantity, *cells, full, "agrees" if agrees else "DIFFERS"))
    return "\n".join(table(rows, "llr"))


# ---- feasibility ---------------------------------------------------------------------------------


def feasibility_report(found: FeasibilityResult, units: UnitSystem) -> str:
    """The section on feasibility: the limit of ec, and the designs that cannot turn."""
    lines = ["Feasibility"]
    if found.limit is not None:
        limit = (
            f"|ec| < BC - AB = {_with_unit('ec', found.limit, units)}"
            if found.limit > 0.0
            else "no ec, since BC <= AB"
        )
        lines.append(f"  the crank turns fully for {limit}")
    lines.append(f"  {found.turning} of {found.designs} designs of this scene turn fully")
    axes = _varying([one.design for one in found.infeasible], found.designs)
    for one in found.infeasible[:GAPS]:
        design = ", ".join(f"{name} = {_with_unit(name, one.design[name], units)}" for name in axes)
        gaps = " and ".join(f"{degrees(a):.2f} to {degrees(b):.2f}" for a, b in one.gaps)
        if any(b - a >= 2.0 * pi for a, b in one.gaps):
            lines.append(f"  infeasible: {design} cannot be assembled at any angle")
        else:
            lines.append(
                f"  infeasible at part of the turn: {design} cannot be assembled for theta from {gaps} deg"
            )
    more = found.designs - found.turning - GAPS
    return "\n".join(lines + ([f"  and {more} more"] if more > 0 else []))


def _varying(designs: list[dict[str, float]], count: int) -> list[str]:
    """The lengths in which these designs differ; `ec` for a single design."""
    names = list(designs[0]) if designs else []
    varying = [name for name in names if len({design[name] for design in designs}) > 1]
    return varying or (["ec"] if count > 0 else [])


# ---- peaks ---------------------------------------------------------------------------------------


def _peak(found: PeakResult, units: UnitSystem) -> str:
    """A table with a row for each design, and the claims."""
    one = found.peak
    known = quantity(one.quantity, "omega" in one.axes or "omega" in one.fixed)
    low, high = (f"{degrees(angle):g}" for angle in one.theta)
    title = one.title or f"{WORDS[one.kind].capitalize()} of {one.quantity}, {known.meaning}"
    lines = [f"{title} (theta from {low} to {high} deg)"]
    lines += table(_peak_rows(found, units), "r")
    lines += remarks(found)
    return "\n".join(lines + [_claim(one, claim, units) for claim in found.claims])


def _peak_rows(found: PeakResult, units: UnitSystem) -> list[list[str]]:
    one, dataset = found.peak, found.dataset
    symbol = {"absmax": f"|{one.quantity}|", "max": f"max {one.quantity}", "min": f"min {one.quantity}"}[
        one.kind
    ]
    slopes = [name for name in one.sensitivities if f"value_wrt_{name}" in dataset]
    base = [f"over {_design(one.at_baseline, units)}"] if "increase" in dataset else []
    side = ["side"] * bool(dataset["side"].values.any())
    rows = [[*one.axes, symbol, "at theta", *side, *base, *(f"d/d({name})" for name in slopes)]]
    angle = units.of("theta").unit
    heads = [*(dataset[name].units for name in one.axes), dataset["value"].units]
    heads += ["deg" if angle == "rad" else angle, *("" for _ in (*side, *base))]
    rows.append([*heads, *(dataset[f"value_wrt_{name}"].units for name in slopes)])
    scale = degrees(1.0) if angle == "rad" else 1.0
    for index in _thinned(list(np.ndindex(dataset["value"].shape))):
        row = [number(dataset[name].values[i]) for name, i in zip(one.axes, index, strict=True)]
        row += [number(dataset["value"].values[index]), f"{scale * dataset['theta'].values[index]:.3f}"]
        row += [f"{dataset['side'].values[index]:+d}".replace("+0", "0")] if side else []
        row += [_percent(float(dataset["increase"].values[index]))] if base else []
        row += [slope_text(found, dataset[f"value_wrt_{name}"], index) for name in slopes]
        rows.append(row)
    return rows


def _percent(value: float) -> str:
    """A change in percent as short text: a dash for NaN, a power of ten if huge."""
    form = "+.1f" if abs(value) < HUGE else "+.3g"
    return "-" if isnan(value) else f"{value:{form}} %"


def slope_text(
    found: PeakResult, slope: Any, index: tuple[int, ...], text: Callable[[float], str] = number
) -> str:
    """A sensitivity; of either sign by what points to the side where two angles share the peak."""
    value = float(slope.values[index])
    sideways = str(slope.name).removeprefix("value_wrt_") in SIDEWAYS
    both = value != 0.0 and sideways and found.mirrored[index]
    return f"+-{text(abs(value))}" if both else text(value)


def _thinned(indices: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """At most ROWS indices, evenly chosen, with the first and the last."""
    if len(indices) <= ROWS:
        return indices
    return [indices[round(k * (len(indices) - 1) / (ROWS - 1))] for k in range(ROWS)]


SIDE = "  side: of a jump of a load, from which this is the limit: -1 smaller theta, +1 larger theta"
STATUS_WORDS = {int(status): status.words for status in PeakStatus if status}


def remarks(found: PeakResult) -> list[str]:
    """Footnotes on designs without an ordinary peak and on rows left out."""
    status = found.dataset["status"].values
    lines = [
        f"  designs: {np.sum(status == code)} {words}"
        for code, words in STATUS_WORDS.items()
        if code in status
    ]
    if found.mirrored.any() and any(name in SIDEWAYS for name in found.peak.sensitivities):
        lines.append(
            "  +-: at ec = 0 the peak is at theta and at -theta; such a slope is + at one and - at the other"
        )
    if found.dataset["side"].values.any():
        lines.append(SIDE)
    fixed = [n for n, load in found.peak.loads.items() if isinstance(load, OverY) and not load.centre]
    if fixed and any(name in LENGTHS for name in found.peak.sensitivities):
        lines.append(
            f"  d/d length: {' and '.join(fixed)} over Y stays where it is, over_stroke moves with the stroke"
        )
    if status.size > ROWS:
        lines.append(f"  {ROWS} of {status.size} designs are shown")
    return lines


def _claim(one: Peak, result: ClaimResult, units: UnitSystem) -> str:
    claim = result.claim
    printed = claim.increase.text(claim.increase.value)
    where = f"{_design(claim.at, units)} over {_design(one.at_baseline, units)}"
    if not isfinite(result.computed):
        return f"  increase of {where}: {claim.source} {printed}, but there is no finite change: DIFFERS"
    computed = claim.increase.text(claim.increase.rounded(result.computed))
    verdict = "agrees" if result.agrees else "DIFFERS"
    full = f" ({result.computed:.2f} %)" if abs(result.computed) < HUGE else ""
    return f"  increase of {where}: {claim.source} {printed}, desaxe {computed}{full}: {verdict}"


def _design(inputs: dict[str, float], units: UnitSystem) -> str:
    return ", ".join(
        f"{name} = {_with_unit(name, value, units) if value else 0}" for name, value in inputs.items()
    )


def _with_unit(name: str, value: float, units: UnitSystem) -> str:
    """An input with its unit, in the units of the scene."""
    conversion = units.of(name)
    return with_unit(number(conversion.shown(value)), conversion.unit)


# ---- the steady state ----------------------------------------------------------------------------

FIGURES = ("omega_mean", "fluctuation", "power_mean", "work", "multiplier", "flywheel_inertia")


def _steady(found: MotorResult, content: Content, units: UnitSystem) -> str:
    """A table with a row for each design, and why some have no steady state."""
    rows = steady_rows(found, content, units)
    head = fill(f"Steady state on {found.asked.torque!r}", WIDTH, subsequent_indent="  ")
    return "\n".join([head, *table(rows, "r"), *steady_remarks(found)])


def steady_rows(found: MotorResult, content: Content, units: UnitSystem) -> list[list[str]]:
    """Names, units, and the figures of each design."""
    dataset = found.dataset if content.units else in_units(found.dataset, units)
    axes = list(found.asked.axes)
    names = [*axes, *(name for name in FIGURES if name in dataset.data_vars)]
    heads = ["" if dataset[name].units == "1" else dataset[name].units for name in names]
    rows = [names, heads]
    for index in _thinned(list(np.ndindex(dataset["status"].shape))):
        row = [number(dataset[name].values[k]) for name, k in zip(axes, index, strict=True)]
        rows.append([*row, *(_or_dash(dataset[name].values[index]) for name in names[len(axes) :])])
    return rows


def _or_dash(value: float) -> str:
    return "-" if isnan(value) else number(value)


def steady_remarks(found: MotorResult) -> list[str]:
    """Why designs have no steady state, the reasons each once, and the rows left out."""
    messages = np.ravel(np.asarray(found.found["message"], object)).tolist()
    lines = [f"  {message}" for message in dict.fromkeys(messages) if message != "ok"]
    more = [f"  and {len(lines) - GAPS} more reasons"] if len(lines) > GAPS else []
    left_out = [f"  {ROWS} of {len(messages)} designs are shown"] if len(messages) > ROWS else []
    return [*lines[:GAPS], *more, *left_out]


# ---- values and files ----------------------------------------------------------------------------


def _values(content: Content, result: Run, units: UnitSystem) -> str:
    """The section on the labelled result: its names and axes, and the values where they are few."""
    assert result.dataset is not None
    shape = " x ".join(f"{name} ({size})" for name, size in result.dataset.sizes.items())
    kept = "" if content.data is not None else '\n  not kept in a file: give [results] data = "out/values.nc"'
    if content.store is not None:
        kept = f"\n  in the store {content.store}" + (", group steady beside them" if content.steady else "")
        return f"Values\n  {', '.join(map(str, result.dataset.data_vars))} over {shape or 'one point'}{kept}"
    taken = content.reduction
    of = f" ({', '.join(taken.kinds)} over {', '.join(taken.axes)})" if taken else ""
    head = f"Values\n  {', '.join(content.outputs)}{of} over {shape or 'one point'}{kept}"
    return "\n".join(
        [head, *_few_values(result.dataset if content.units else in_units(result.dataset, units))]
    )


def _few_values(dataset: "xr.Dataset") -> list[str]:
    """The values of a few points: a line for each name of one point, else a table that fits."""
    if prod(dataset.sizes.values()) > FEW:
        return []
    heads, *rows = table_of(dataset)
    cells = [[number(value) if isinstance(value, float) else str(value) for value in row] for row in rows]
    if not dataset.sizes:
        return table(list(zip(heads, cells[0], strict=True)), "lr")
    lines = table([heads, *cells], "r")
    return lines if max(map(len, lines)) <= WIDTH else []


def files_report(content: Content, result: Run) -> str:
    """A line for each file that was written, and for each that was not."""
    rows: list[tuple[str, str]] = []
    if content.data is not None:
        files = [str(file) for file in data_files(content) if file in result.files]
        told = ["the values"] if content.outputs else []
        told += [f"group {name}" for name in groups_of(content)]
        rows += zip([*files, *[""] * len(told)], told, strict=False) if files else []
    rows += [
        (str(Path(picture.file)), f"{picture.quantity} over {picture.over}")
        for picture in content.pictures
        if Path(picture.file) in result.files
    ]
    parts = ["\n".join(["Written", *table(rows, "llr")])] if rows else []
    if result.failures:
        parts.append("\n".join(["Not written", *(f"  {failure}" for failure in result.failures)]))
    return "\n\n".join(parts)
