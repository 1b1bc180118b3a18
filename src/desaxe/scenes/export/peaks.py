"""Peaks of a scene in a module of numba: a search over the crank angle, for designs that turn fully.

It is made of plain loops: one set of nodes that is dense enough for every design, since their number grows
with the logarithm of the margin only, and the secant method, kept in its bracket, on the derived slope. Peaks
that need nodes of their own (friction, a load that varies, designs that stall or cannot turn fully), and
those of quantities without a derived slope, are left out by name.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ...compiler.builder import function_text, quoted
from ...compiler.languages.numba.library import curve_text
from ...compiler.languages.protocol import Module
from ...evaluation.arrays import as_array
from ...mechanism.catalogue import has, quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.names import LENGTHS, sensitivity
from ...mechanism.own_lines import has_kinks
from ...peaks import special
from ...peaks.designs import KINDS, PeakPlan, plan_of
from ...sweeps.peak_step import WORDS
from ..content import Content, columns_of
from ..parts.peaks import Peak
from .axes import arguments_of, axis_rows
from .portable import left_out


class ExportedPeak(NamedTuple):
    """A peak that a module can have.

    name     of its function
    names    of the value, its slope and its derivatives
    slopes   `value_wrt_<parameter>` -> the place of the derivative behind the value, 0 without one
    fixed    the inputs that are numbers
    opened   those that are not what the scene has
    """

    name: str
    peak: Peak
    names: tuple[str, ...]
    slopes: dict[str, int]
    fixed: dict[str, float]
    opened: tuple[str, ...]


def carried(content: Content) -> list[ExportedPeak]:
    """The peaks of a scene that a module has."""
    if any(callable(value) for value in content.inputs.values()):
        return []  # a module under loads has their tables in its formulas
    named = zip(content.groups, content.peaks, strict=False)
    return [result for name, one in named if (result := _exported(name, one, content)) is not None]


def _exported(name: str, one: Peak, content: Content) -> ExportedPeak | None:
    """A peak; None for one that needs nodes of its own, or has no derived slope."""
    if one.loads:
        return None
    some = dict.fromkeys(one.axes, np.array([1.0, 2.0]))  # no value of an axis is built in
    given: dict[str, Any] = {**dict.fromkeys(("ec", "AB", "BC", "omega0", "omega")), "alpha": 0.0}
    given |= {**one.fixed, **some}
    state = given["omega"] is not None
    plan = plan_of(one.quantity, given, content.branch, content.accuracy)
    for n in plan.needs:
        if given.get(n) is not None:
            as_array(n, given[n], plan.needs, (name,))
    by = [p for p in one.sensitivities if p in plan.parameters]
    names = (one.quantity, *(sensitivity(one.quantity, p) for p in ("theta", *by)))
    rubs = "mu" in plan.parameters or has_kinks(plan.wanted.form.own)
    if rubs or not all(has(n, state) for n in names) or _special(plan, one, content):
        return None
    numbers = {n: float(given[n]) for n in dict.fromkeys((*plan.needs, *LENGTHS, "omega0", "alpha"))
               if n not in one.axes and given.get(n) is not None}  # fmt: skip
    opened = [n for n in one.axes if not isinstance(content.inputs.get(n), tuple)]
    opened += [n for n, value in numbers.items() if n in plan.needs and content.inputs.get(n, 0.0) != value
               and not isinstance(content.inputs.get(n), tuple)]  # fmt: skip
    if "theta" not in content.inputs or not isinstance(content.inputs["theta"], tuple):
        opened = ["theta", *opened]
    slopes = {f"value_wrt_{p}": 1 + by.index(p) + 1 if p in by else 0 for p in one.sensitivities}
    return ExportedPeak(name, one, names, slopes, numbers, tuple(opened))


def _special(plan: PeakPlan, one: Peak, content: Content) -> bool:
    """True if a design of the scene stalls or cannot turn fully."""
    columns = columns_of({**one.axes, **one.fixed})
    return bool(special.are_special(special.SearchedDesigns(columns, content.branch, one.theta, False)).any())


def peak_texts(
    peaks: Sequence[ExportedPeak], module: Module, names: Sequence[str]
) -> tuple[list[str], list[str]]:
    """The searches and functions of peaks, and a line on each."""
    known = [symbol.name for symbol in module.outputs]
    known += [name for name in names if name not in known]
    searches = dict.fromkeys(one.names for one in peaks)
    called = {names: f"{names[0]}_{k}" if k else names[0] for k, names in enumerate(searches)}
    texts = [
        text
        for names, name in called.items()
        for text in curve_text(module, name, [known.index(each) for each in names])
    ]
    functions = [_function(one, called[one.names], module) for one in peaks]
    return [*texts, *functions], [f"    {one.name}(): {_meaning(one)}" for one in peaks]


def _meaning(one: ExportedPeak) -> str:
    low, high = one.peak.theta
    row = quantity(one.peak.quantity, "omega" in one.fixed or "omega" in one.peak.axes)
    return (
        f"{WORDS[one.peak.kind]} of {one.peak.quantity} [{row.unit}] over theta from {low:g} to {high:g} rad"
    )


def _function(one: ExportedPeak, search: str, module: Module) -> str:
    axes = one.peak.axes
    over = " x ".join(f"{name} [{INPUTS[name].unit}]" for name in axes) or "nothing"
    inputs = [*(symbol.name for symbol in module.inputs), *module.fixed]
    designs = tuple(name for name in inputs if name != "theta")
    meaning, ends = _meaning(one), tuple(map(float, one.peak.theta))
    body = [
        f'"""{meaning[0].upper()}{meaning[1:]}, as arrays over {over}: see `extremum`."""',
        "axes = {",
        *(row for name, values in axes.items() for row in axis_rows(name, values, "    ", 80)),
        *([f"    **{quoted(one.fixed)},"] if one.fixed else []),
        "}",
        f"kind, ends = {KINDS.index(one.peak.kind)}, {ends}",
        f"inputs, slopes = {quoted(designs)}, {quoted(one.slopes)}",
        f"return extremum(search_{search}, kind, ends, axes, locals(), inputs, slopes)",
    ]
    return function_text(one.name, arguments_of([*axes]), body)


def left_out_of_module(content: Content) -> list[str]:
    """The parts of a scene that the Python module leaves out: of peaks those that need nodes of their own."""
    here = {one.name for one in carried(content)}
    named: Mapping[str, Peak] = dict(zip(content.groups, content.peaks, strict=False))
    gone = {f"[[peak]] {one.quantity}" for name, one in named.items() if name not in here}
    lost = left_out(content, reduction=False)
    return [words for words in lost if not words.startswith("[[peak]]") or words in gone]
