"""Peaks of flat designs: the plan of a request, and the search over all designs."""

from collections.abc import Mapping
from contextlib import nullcontext
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.passes.guard import BAD_INPUT
from ..definitions.conditions import conditions_of
from ..evaluation.arrays import are_good
from ..loads.load import Load
from ..mechanism.catalogue import has, of_design, quantity
from ..mechanism.constants import constants
from ..mechanism.names import LENGTHS, STATUS, sensitivity
from ..mechanism.own import Register, register, using
from ..mechanism.own_lines import has_kinks
from ..runtime.accuracy import accuracy_of
from ..runtime.kernels import STRUCTURAL_ZEROS
from ..runtime.request import Request, is_steady, request
from ..runtime.threads import run_parts
from ..runtime.wide_margins import all_have_wide_margins, have_wide_margins
from ..support.progress import Portions, progress_bar
from . import special
from .compiled import LONGEST_PART, Groups, is_compiled, kernel_for, run
from .course import course_of
from .differences import with_slopes
from .jumps import at_jumps
from .loaded import ValuesUnderLoads, with_nodes
from .nodes import Array, classes, coarser, shared_nodes
from .programs import Search, needs_own, programs_of
from .special import SearchedDesigns
from .under import search_under, tables_under, with_own

KINDS = ("absmax", "max", "min")
LARGE = 1_000  # designs that may take long: a bar tells
# Designs of a thread that does all of the work on them; of fewer, threads share the search alone.
LEAST_ALL_THROUGH = 16_384


class Checked(NamedTuple):
    """Designs whose invalid inputs are NaN, where those are, and which designs have nodes of their own."""

    designs: SearchedDesigns
    bad: NDArray[np.bool_]
    special: NDArray[np.bool_]

    def part(self, rows: slice) -> "Checked":
        """Consecutive designs."""
        return Checked(self.designs.part(rows), self.bad[rows], self.special[rows])


class PeakPlan(NamedTuple):
    """A request to search, the parameters of its gradient, and all inputs that it needs."""

    wanted: Request
    parameters: tuple[str, ...]
    needs: tuple[str, ...]

    @property
    def name(self) -> str:
        """The quantity."""
        return self.wanted.shown[0]


class Sought(NamedTuple):
    """The extreme values that are sought, of any designs: of what, of which kind, over which angles."""

    plan: PeakPlan
    kind: str
    branch: int
    ends: tuple[float, float]
    threads: int | None = None
    loads: Mapping[str, Load] = MappingProxyType({})  # those that vary with the motion

    @property
    def numbers(self) -> list[str]:
        """The inputs that are numbers or arrays."""
        return [name for name in self.plan.needs if name not in self.loads]


class Work(NamedTuple):
    """A search: the record of what is sought, the Programs for special and usual designs, progress."""

    sought: Sought
    search: Search
    usual: Search
    told: Portions  # of the designs that are done


MOST_PLANS = 1024
_PLANS: dict[Any, PeakPlan] = {}


def plan_of(name: str, given: dict[str, Any], branch: int, accuracy: Any) -> PeakPlan:
    """The plan of a request, which depends on its names only."""
    shown = frozenset(n for n, value in given.items() if value is not None)
    if type(accuracy) is not str or accuracy != "standard":
        accuracy = accuracy_of(accuracy)
    now = register()
    key = name, shown, is_steady(given["alpha"]), branch, accuracy, now
    plan = _PLANS.get(key)
    if plan is None:
        if len(_PLANS) > MOST_PLANS:
            _PLANS.clear()
        plan = _PLANS[key] = _new_plan(name, dict(given), branch, accuracy, now)
    return plan


def _new_plan(name: str, given: dict[str, Any], branch: int, accuracy: Any, known: Register) -> PeakPlan:
    if name == STATUS or of_design(name, known):
        raise ValueError(f"{name} has no peak over theta")
    state = given["omega"] is not None
    quantity(name, state, known)
    slope = sensitivity(name, "theta")
    names = (name, slope) if has(slope, state, known) else (name,)
    wanted = request(names, given, branch, accuracy, known)
    parameters = tuple(n for n in wanted.inputs if n != "theta")
    if "omega0" not in parameters and given["omega0"] is None and not state:
        given["omega0"] = 0.0
    if "mu" not in parameters:
        given["mu"] = None  # what friction does matters to forces only
    told = request((STATUS,), {**given, "theta": 0.0}, branch, accuracy, known).inputs
    needs = (*parameters, *(n for n in told if n not in (*parameters, "theta")))
    return PeakPlan(wanted, parameters, needs)


def search_of(plan: PeakPlan, arrays: dict[str, Array], ends: tuple[float, float]) -> Search:
    """The search to compile; a scalar input of 0 is folded unless the gradient needs it."""
    wanted = plan.wanted
    name = wanted.names[0]
    known = [n for n in STRUCTURAL_ZEROS if n in plan.parameters and n in arrays]
    zeros = [n for n in known if arrays[n].size == 1 and arrays[n].item() == 0.0]
    if zeros:
        kept = needs_own(name, plan.parameters)
        zeros = [n for n in zeros if n not in kept]
    fixed = (*wanted.fixed, *((n, 0.0) for n in zeros))
    extended = wanted.accuracy == "extended"
    far = max(abs(ends[0]), abs(ends[1])) > constants().limit
    return Search(name, plan.parameters, wanted.form, fixed, extended, far)


def peaks_of_designs(sought: Sought, search: Search, columns: dict[str, Array]) -> dict[str, Any]:
    """Value, angle, gradient and status of flat designs."""
    plan = sought.plan
    kinks = "mu" in plan.parameters or has_kinks(plan.wanted.form.own)
    loads = with_slopes(sought.loads, *sought.ends) if sought.loads else {}
    conditions = conditions_of(plan.wanted.form.own)
    names = tuple(condition.name for condition in conditions)
    checked = _checked(
        SearchedDesigns(columns, sought.branch, sought.ends, kinks, loads, plan.wanted.accuracy, names)
    )
    size = checked.designs.size
    usual = search if loads else _in_form(search, checked)
    with using(conditions), progress_bar(unit="designs") if size > LARGE else nullcontext() as watch:
        return _all(Work(sought, search, usual, Portions(size, f"peaks of {plan.name}", watch)), checked)


def _all(work: Work, checked: Checked) -> dict[str, Any]:
    """The peaks of all designs; many that are alike, in parts."""
    size, usual, threads = checked.designs.size, work.usual, work.sought.threads
    loads = checked.designs.loads
    if loads or size < 2 * LEAST_ALL_THROUGH or (checked.special & ~checked.bad).any():
        return _peaks(work, checked, threads)
    kernel_for(usual, size)  # one for all parts: their order must not change a digit
    found: dict[int, dict[str, Any]] = {}

    def part(first: int, last: int) -> None:
        found[first] = _peaks(work, checked.part(slice(first, last)), 1)
        work.told.add(last - first)

    run_parts(part, size, threads, LEAST_ALL_THROUGH, LONGEST_PART)
    return _joined([found[first] for first in sorted(found)])


def _joined(parts: list[dict[str, Any]]) -> dict[str, Any]:
    """The results of consecutive designs as those of all."""
    columns = {name: [part[name] for part in parts] for name in parts[0]}
    return {
        name: _joined(column) if isinstance(column[0], dict) else np.concatenate(column)
        for name, column in columns.items()
    }


def _peaks(work: Work, checked: Checked, threads: int | None) -> dict[str, Any]:
    """Value, angle, gradient and status of some designs."""
    sought, search, usual, told = work
    name, kind = sought.plan.name, sought.kind
    designs, bad, own_nodes = checked
    columns = designs.columns
    out = np.empty((2 + len(search.parameters), designs.size))
    theta = np.empty(designs.size)
    status = np.zeros(designs.size, np.int8)
    number = KINDS.index(kind)
    rows = np.flatnonzero(~own_nodes)
    marked = designs.loads or designs.conditions
    loaded = ValuesUnderLoads(name, search, designs, course_of(designs), told) if marked else None
    under = _compiled_under(loaded, checked, rows.size) if rows.size and loaded is not None else None
    if under is not None and loaded is not None:
        tables = tables_under(under, designs, loaded.course)
        grouped = partial(_classed, designs, rows)
        if not programs_of(under, False).own_nodes:
            grouped = partial(_classed_with, designs, rows, loaded.course.nodes[0])
        run(under, columns, rows.size, grouped, number, theta, out, threads, tables)
    elif rows.size and loaded is not None:
        for part, nodes in with_nodes(_classed(designs, rows), loaded.course.nodes):
            loaded.run(part, nodes, number, theta, out)
    elif rows.size:
        run(usual, columns, rows.size, partial(_classed, designs, rows), number, theta, out, threads)
    if bad.any():
        out[:, bad], status[bad] = np.nan, BAD_INPUT
    rows = np.flatnonzero((own_nodes | np.isnan(out[0]) if rows.size else own_nodes) & ~bad)
    for start in range(0, rows.size, special.BLOCK):
        part = rows[start : start + special.BLOCK]
        some = designs.part(part)
        nodes, limits = special.own_nodes(some)
        if loaded is not None:
            nodes = np.sort(np.append(nodes, loaded.course.nodes[part], axis=1), axis=1)
            loaded.run(part, nodes, number, theta, out)
        else:
            cost = special.NODES * rows.size if rows.size > 1 else 1  # one alone: its loops as they stand
            run(search, columns, cost, partial(_each, part, nodes), number, theta, out, threads)
            told.add(part.size)
        found = special.SearchResult(out[0, part], theta[part], out[1, part], status[part])
        marks = () if loaded is None else (loaded.course.kinks, loaded.course.jumps)
        at = (mark.angles[part] for mark in marks)
        usable = special.complete(name, kind, some, nodes, limits, found, search.parameters, *at)
        out[0, part], theta[part], status[part] = found.value, found.theta, found.status
        out[2:, part] = np.where(usable, out[2:, part], np.nan)
    theta[np.isnan(out[0])] = np.nan
    side = np.zeros(designs.size, np.int8)
    if loaded is not None:
        side = at_jumps(loaded, number, np.isin(status, special.USABLE) & np.isfinite(out[0]), theta, out)
    if kind == "min" and not designs.rubs:
        kinks = np.empty((designs.size, 0)) if loaded is None else loaded.course.kinks.angles
        out[2:, special.stays_zero(designs, theta, out[0], out[1], kinks)] = 0.0
    value = np.abs(out[0]) if kind == "absmax" else out[0]
    gradient = dict(zip(search.parameters, out[2:], strict=True))
    return {"value": value, "theta": theta, "side": side, "gradient": gradient, "status": status}


def _compiled_under(loaded: ValuesUnderLoads, checked: Checked, count: int) -> Search | None:
    """The compiled search for `count` designs under loads; None where NumPy searches."""
    if not loaded.derived:
        return None
    search = search_under(loaded.search, loaded.all, loaded.designs, loaded.course)
    search = search and _in_form(search, checked)
    return search if search is not None and is_compiled(search, count) else None


def _classed_with(
    designs: SearchedDesigns, rows: NDArray[np.intp], nodes: Array, coarse: bool = False
) -> Groups:
    """The designs by their classes, with the nodes of a load that all share."""
    return with_own(_classed(designs, rows, coarse), nodes)


def _each(rows: NDArray[np.intp], nodes: Array, together: bool = False) -> Groups:
    """Designs with nodes of their own, a row each: a group each, or all `together`, nodes in columns."""
    if together:
        return Groups(rows, np.array([0, rows.size]), nodes.T, np.array([0, nodes.shape[1]]))
    edges = np.arange(rows.size + 1)
    return Groups(rows, edges, nodes.reshape(-1), edges * nodes.shape[1])


def _in_form(search: Search, checked: Checked) -> Search:
    """The search in plain forms, if all designs of the usual kind have wide margins.

    A second one, for a few that are not, would take longer to compile than it saves.
    """
    own, rows = checked.designs.lengths, np.flatnonzero(~checked.special)
    if not rows.size or search.extended or not own:
        return search
    lengths = {name: _at(column, rows) for name, column in zip(LENGTHS, own, strict=True)}
    if all_have_wide_margins(search.form, **lengths) or have_wide_margins(lengths, search.form).all():
        return search._replace(form=search.form._replace(wide_margins=True))
    return search


def _at(column: Array, rows: NDArray[np.intp]) -> Array:
    """The values of some designs; of all of them without a copy."""
    return column if rows.size == column.size else column[rows]


def _checked(designs: SearchedDesigns) -> Checked:
    """The designs with NaN for invalid values, which would give a finite, wrong result."""
    bad = np.zeros(designs.size, np.bool_)
    columns = dict(designs.columns)
    if designs.size > 1:  # one was checked where it came in
        for name, column in columns.items():
            fine = are_good(name, column)
            if not fine.all():
                columns[name] = np.where(fine, column, np.nan)
                bad |= ~fine
    designs = designs._replace(columns=columns)
    return Checked(designs, bad, special.are_special(designs))


def _classed(designs: SearchedDesigns, rows: NDArray[np.intp], coarse: bool = False) -> Groups:
    """The designs by their classes, which share nodes; `coarse`: by few of them."""
    lengths = [_at(column, rows) for column in designs.lengths]
    numbers = classes(*lengths) if lengths else np.zeros(rows.size, np.int16)
    if coarse:
        numbers = coarser(numbers)
    if rows.size == 1 or (numbers == numbers[0]).all():
        nodes = shared_nodes(int(numbers[0]), *designs.theta)
        return Groups(rows, np.array([0, rows.size]), nodes, np.array([0, nodes.size]))
    places = np.argsort(numbers, kind="stable")
    numbers = numbers[places]
    first = np.append(0, 1 + np.flatnonzero(numbers[1:] != numbers[:-1]))
    grids = [shared_nodes(int(number), *designs.theta) for number in numbers[first]]
    starts = np.append(first, rows.size)
    node_starts = np.cumsum([0, *(grid.size for grid in grids)])
    return Groups(rows[places], starts, np.concatenate(grids), node_starts)
