"""Peaks of a scene in a written module: the search over the crank angle, for designs that turn fully.

The module has the text of the search (`desaxe.peaks.search`) as it is, and nodes by the smallest margin of
the designs of a call. Peaks that need other nodes (friction, a load that varies, designs that stall or cannot
turn fully) are left out, by name.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np

from ...compiler.builder import Parts, function_text
from ...compiler.languages.numba.module import CALLABLE, numba_parts
from ...compiler.program import Program
from ...compiler.text import INDENT, read_function, with_short_temporaries, write_lines
from ...evaluation.arrays import as_array
from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.names import LENGTHS
from ...mechanism.own_lines import has_kinks
from ...peaks import search, special
from ...peaks.designs import KINDS, PeakPlan, plan_of, search_of
from ...peaks.nodes import FINEST, KEPT_APART, graded
from ...peaks.programs import Search, programs_of
from ...peaks.steps import BOUND, GUESS, STEP
from ...support.template import filled
from ...sweeps.peak_step import WORDS
from ..content import Content, Peak
from ..parts.extremes import columns_of, group_names
from .axes import arguments_of, axis_rows, number_rows, text_file
from .portable import left_out

SEARCH = Path(search.__file__)
STEPS = {"upper_bounds": BOUND, "first_guess": GUESS, "newton_step": STEP}


class ExportedPeak(NamedTuple):
    """A peak that a module can have: its function's name, the search, the inputs that are numbers."""

    name: str
    peak: Peak
    search: Search
    fixed: dict[str, float]


class PeakTexts(NamedTuple):
    """The loops that are compiled; the functions, as text; their names and meanings."""

    loops: list[Parts]
    functions: list[str]
    lines: list[str]


def carried(content: Content) -> list[ExportedPeak]:
    """The peaks of a scene that a module has."""
    if any(callable(value) for value in content.inputs.values()):
        return []  # a module under loads has their tables in its calls
    named = zip(group_names(content.peaks), content.peaks, strict=True)
    return [found for name, one in named if (found := _found(name, one, content)) is not None]


def _found(name: str, one: Peak, content: Content) -> ExportedPeak | None:
    """The search of a peak; None for one that needs nodes of its own."""
    if one.loads:
        return None
    some = dict.fromkeys(one.axes, np.array([1.0, 2.0]))  # no value of an axis is built in
    given: dict[str, Any] = {**dict.fromkeys(("ec", "AB", "BC", "omega0", "omega")), "alpha": 0.0}
    given |= {**one.fixed, **some}
    plan = plan_of(one.quantity, given, content.branch, content.accuracy)
    if "omega0" in plan.needs and given["omega0"] is None:
        given["omega0"] = 0.0
    arrays = {n: as_array(n, given[n], plan.needs, (name,)) for n in plan.needs if given.get(n) is not None}
    if "mu" in plan.parameters or has_kinks(plan.wanted.form.own) or _special(plan, one, content):
        return None
    search = search_of(plan, arrays, one.theta)
    used = (*programs_of(search).inputs, *LENGTHS, "omega0", "alpha")
    fixed = {
        n: float(given[n]) for n in dict.fromkeys(used) if n not in one.axes and given.get(n) is not None
    }
    return ExportedPeak(name, one, search, fixed)


def _special(plan: PeakPlan, one: Peak, content: Content) -> bool:
    """True if a design of the scene stalls or cannot turn fully."""
    columns = columns_of({**one.axes, **one.fixed})
    return bool(special.are_special(special.SearchedDesigns(columns, content.branch, one.theta, False)).any())


def peak_texts(content: Content) -> PeakTexts:
    """The text of the peaks of a scene; nothing where it has none, or none that a module can have."""
    found = carried(content)
    if not found:
        return PeakTexts([], [], [])
    searches: dict[Search, str] = {}
    for one in found:
        searches.setdefault(one.search, f"search{len(searches)}")
    loops, calls = [], []
    for name, text in STEPS.items():
        program = read_function(text)
        loops.append(_loops(f"{name}_loops", program, program.inputs))
        calls.append(filled(text_file("by_points"), NAME=name, ROWS=str(len(program.outputs))))
    for key, prefix in searches.items():
        curve, finish, inputs = programs_of(key)
        loops += [
            _loops(f"{prefix}_{name}", program, ("theta", *inputs))
            for name, program in (("curve", curve), ("finish", finish))
        ]
    rows = [_table_row(one, searches[one.search]) for one in found]
    state = "omega" in content.inputs
    functions = [*calls, _nodes_text(), "".join(["PEAKS = {\n", *rows, "}"])]
    functions += [_function(one, state) for one in found]
    lines = [f"{one.name}(): {_meaning(one, state)}" for one in found]
    return PeakTexts(loops, functions, lines)


def _loops(name: str, program: Program, inputs: Sequence[str]) -> Parts:
    """`<name>(given, out)`: a program at points, from a row for each input to one for each output."""
    program = with_short_temporaries(program)
    body = [f"{n} = given[{k}, i]" for k, n in enumerate(inputs) if n in program.inputs]
    body += write_lines(program, "numba")
    body += [f"out[{k}, i] = {n}" for k, n in enumerate(program.outputs)]
    loop = ["for i in range(uint64(out.shape[1])):", *(INDENT + row for row in body)]
    return numba_parts([function_text(name, ["given", "out"], loop)], jit=CALLABLE)


def _nodes_text() -> str:
    rows = []
    for number in KEPT_APART.tolist():
        least = 0.0 if number == FINEST else 4.0**-number
        rows += [f"{least!r}: array([", *(INDENT + row for row in number_rows(graded(number), 86)), "]),"]
    return filled(text_file("nodes"), DISTANCES=rows)


def _table_row(one: ExportedPeak, prefix: str) -> str:
    """The row of a peak in PEAKS."""
    slots = {n: 2 + k for k, n in enumerate(one.search.parameters)}
    slopes = {f"value_wrt_{n}": slots.get(n, 0) for n in one.peak.sensitivities}
    return filled(
        text_file("peak_row"),
        NAME=one.name,
        SEARCH=prefix,
        KIND=str(KINDS.index(one.peak.kind)),
        THETA=repr(tuple(map(float, one.peak.theta))),
        ROWS=str(2 + len(slots)),
        INPUTS=repr(programs_of(one.search).inputs),
        FIXED=repr(one.fixed),
        SLOPES=repr(slopes),
        AXES=[row for name, values in one.peak.axes.items() for row in axis_rows(name, values, "", 80)],
    )


def _meaning(one: ExportedPeak, state: bool) -> str:
    row = quantity(one.peak.quantity, state)
    low, high = one.peak.theta
    return (
        f"{WORDS[one.peak.kind]} of {one.peak.quantity} [{row.unit}] over theta from {low:g} to {high:g} rad"
    )


def _function(one: ExportedPeak, state: bool) -> str:
    axes = list(one.peak.axes)
    slopes = ", ".join(f"`value_wrt_{name}`" for name in one.peak.sensitivities)
    over = " x ".join(f"{name} [{INPUTS[name].unit}]" for name in axes) or "nothing"
    told = (
        f"A dict of arrays over {over}: `value`, `theta` where it is reached, `status` (0, or 4 for bad "
        f"input){', exact derivatives ' if slopes else ''}{slopes}. An axis that is given takes the place of "
        "the scene's. Raises ValueError for a design that stalls or cannot turn fully."
    )
    title = _meaning(one, state)
    lines = wrap(re.sub(r"\s+", " ", told), 92)
    return filled(
        text_file("peak"),
        NAME=one.name,
        GIVEN=arguments_of(axes),
        DOCSTRING=[f'"""{title[0].upper()}{title[1:]}.', "", *lines, '"""'],
        AXES=", ".join(f'"{name}": {name}' for name in axes),
    )


def left_out_of_module(content: Content) -> list[str]:
    """The parts of a scene that the Python module leaves out: of peaks those that need nodes of their own."""
    here = {one.name for one in carried(content)}
    named: Mapping[str, Peak] = dict(zip(group_names(content.peaks), content.peaks, strict=True))
    gone = {f"[[peak]] {one.quantity}" for name, one in named.items() if name not in here}
    lost = left_out(content, reduction=False)
    return [words for words in lost if not words.startswith("[[peak]]") or words in gone]
