"""Peaks of flat designs: the plan of a request, and the search over all designs."""

from collections.abc import Iterator, Mapping
from contextlib import nullcontext
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.passes.guard import BAD_INPUT
from ..evaluation.arrays import are_good
from ..loads.along_motion import SPEEDS, OfMotion, with_derivatives
from ..loads.angles import cycle
from ..loads.load import Load
from ..mechanism.catalogue import has, of_design, quantity
from ..mechanism.constants import constants
from ..mechanism.names import LENGTHS, STATUS, sensitivity
from ..mechanism.own import Register, register, using
from ..mechanism.own_lines import conditions_of, has_kinks
from ..runtime.executor import have_wide_margins
from ..runtime.kernels import STRUCTURAL_ZEROS
from ..runtime.request import Request, accuracy_of, is_steady, request
from ..runtime.threads import run_parts
from ..support.progress import Portions, progress_bar
from .course import course_of
from .jumps import at_jumps
from .loaded import Rows, ValuesUnderLoads, with_slopes
from .nodes import Array, classes, shared_nodes
from .programs import Evaluations, Search, needs_own
from .search import search_block, sign_changes_of
from .special import (
    AT_KINK,
    USABLE,
    SearchedDesigns,
    SearchResult,
    are_special,
    balanced_nodes,
    complete,
    own_nodes,
    rubbing_nodes,
    stays_zero,
    turns_over,
)

Quantity = Evaluations | ValuesUnderLoads
KINDS = ("absmax", "max", "min")
LARGE = 1_000  # designs that may take long: a bar tells
MOST = 2**16  # values at a time, so that their arrays stay in the cache
# Designs of a part: at least what pays for a thread, at most half a second of work.
USUAL_PART, COSTLY_PART = (8_192, 65_536), (512, 1_024)
SPECIAL_BLOCK = 1_024  # designs


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


def sought_of(
    name: str,
    kind: str,
    inputs: dict[str, Any],
    loads: Mapping[str, Load],
    branch: int,
    accuracy: Any,
    ends: tuple[float, float] | None = None,
) -> Sought:
    """The extreme values of a request, under those loads that it depends on; by default over their cycle."""
    plan = plan_of(name, {**inputs, **loads}, branch, accuracy)
    acting = {n: load for n, load in loads.items() if n in plan.parameters}
    if any(isinstance(load, OfMotion) and load.follows_speed for load in acting.values()):
        steady = is_steady(inputs["alpha"])
        speeds = [n for n in SPEEDS if inputs[n] is not None and not (n == "alpha" and steady)]
        parameters, needs = (
            tuple(dict.fromkeys((*names, *speeds))) for names in (plan.parameters, plan.needs)
        )
        plan = plan._replace(parameters=parameters, needs=needs)
    return Sought(plan, kind, int(branch), ends or (0.0, cycle(acting)), None, acting)


class Work(NamedTuple):
    """A search: the record of what is sought, the Programs for special and usual designs, progress."""

    sought: Sought
    search: Search
    usual: Search
    told: Portions  # of the designs that are done


MOST_PLANS = 1024
_PLANS: dict[Any, PeakPlan] = {}


def plan_of(name: str, inputs: dict[str, Any], branch: int, accuracy: Any) -> PeakPlan:
    """The plan of a request, which depends on its names only."""
    shown = frozenset(n for n, value in inputs.items() if value is not None)
    if type(accuracy) is not str or accuracy != "standard":
        accuracy = accuracy_of(accuracy)
    now = register()
    key = name, shown, is_steady(inputs["alpha"]), branch, accuracy, now
    plan = _PLANS.get(key)
    if plan is None:
        if len(_PLANS) > MOST_PLANS:
            _PLANS.clear()
        plan = _PLANS[key] = _new_plan(name, dict(inputs), branch, accuracy, now)
    return plan


def _new_plan(name: str, given: dict[str, Any], branch: int, accuracy: Any, known: Register) -> PeakPlan:
    if name == STATUS or of_design(name, known):
        raise ValueError(f"{name} has no peak over theta")
    state = given["omega"] is not None
    quantity(name, state, known)
    slope = sensitivity(name, "theta")
    names = (name, slope) if has(slope, state, known) else (name,)
    requested = request(names, given, branch, accuracy, known)
    parameters = tuple(n for n in requested.inputs if n != "theta")
    if "omega0" not in parameters and given["omega0"] is None and not state:
        given["omega0"] = 0.0
    if "mu" not in parameters:
        given["mu"] = None  # what friction does matters to forces only
    message = request((STATUS,), {**given, "theta": 0.0}, branch, accuracy, known).inputs
    needs = (*parameters, *(n for n in message if n not in (*parameters, "theta")))
    return PeakPlan(requested, parameters, needs)


def search_of(plan: PeakPlan, arrays: dict[str, Array], ends: tuple[float, float]) -> Search:
    """The search to compile; a scalar input of 0 is folded unless the gradient needs it."""
    requested = plan.wanted
    name = requested.names[0]
    known = [n for n in STRUCTURAL_ZEROS if n in plan.parameters and n in arrays]
    zeros = [n for n in known if arrays[n].size == 1 and arrays[n].item() == 0.0]
    if zeros:
        kept = needs_own(name, plan.parameters)
        zeros = [n for n in zeros if n not in kept]
    fixed = (*requested.fixed, *((n, 0.0) for n in zeros))
    extended = requested.accuracy == "extended"
    far = max(abs(ends[0]), abs(ends[1])) > constants().limit
    return Search(name, plan.parameters, requested.form, fixed, extended, far)


def peaks_of_designs(sought: Sought, search: Search, columns: dict[str, Array]) -> dict[str, Any]:
    """Value, angle, gradient and status of flat designs."""
    plan = sought.plan
    kinks = "mu" in plan.parameters or has_kinks(plan.wanted.form.own)
    loads = with_slopes(with_derivatives(sought.loads, columns), *sought.ends) if sought.loads else {}
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
    """The peaks of all designs; of many in parts, on some threads."""
    found: dict[int, dict[str, Any]] = {}

    def part(first: int, last: int) -> None:
        with np.errstate(all="ignore"):
            found[first] = PartialSearch(work, checked.part(slice(first, last))).result()
        work.told.add(last - first)

    costly = checked.designs.loads or checked.designs.conditions or checked.special.any()
    least, longest = COSTLY_PART if costly else USUAL_PART
    run_parts(part, checked.designs.size, work.sought.threads, least, longest)
    return _joined([found[first] for first in sorted(found)])


def _joined(parts: list[dict[str, Any]]) -> dict[str, Any]:
    """The results of consecutive designs as those of all."""
    if len(parts) == 1:
        return parts[0]
    columns = {name: [part[name] for part in parts] for name in parts[0]}
    return {
        name: _joined(column) if isinstance(column[0], dict) else np.concatenate(column)
        for name, column in columns.items()
    }


class PartialSearch:
    """The search over some designs, whose results it completes in place."""

    def __init__(self, work: Work, checked: Checked) -> None:
        self.name, self.kind, self.work = work.sought.plan.name, work.sought.kind, work
        self.designs, self.bad, self.special = checked
        size, designs = self.designs.size, self.designs
        self.out = np.full((2 + len(work.search.parameters), size), np.nan)
        self.theta, self.status = np.full(size, np.nan), np.zeros(size, np.int8)
        self.course = course_of(designs) if designs.loads or designs.conditions else None
        self.quantity = self._quantity(self.name, work.search)

    def _quantity(self, name: str, key: Search) -> Quantity:
        """The quantity of a search; under loads all designs have one form."""
        return (
            Evaluations(key)
            if self.course is None
            else ValuesUnderLoads(name, key, self.designs, self.course)
        )

    def result(self) -> dict[str, Any]:
        """Value, angle, gradient and status."""
        self._search_usual()
        self.out[:, self.bad], self.status[self.bad] = np.nan, BAD_INPUT
        again = np.flatnonzero((self.special | np.isnan(self.out[0])) & ~self.bad)
        for start in range(0, again.size, SPECIAL_BLOCK):
            self._search_special(again[start : start + SPECIAL_BLOCK])
        out, theta, status, designs, course = self.out, self.theta, self.status, self.designs, self.course
        theta[np.isnan(out[0])] = np.nan
        side = np.zeros(designs.size, np.int8)
        if isinstance(self.quantity, ValuesUnderLoads):
            usable = np.isin(status, USABLE) & np.isfinite(out[0])
            side = at_jumps(self.quantity, KINDS.index(self.kind), usable, theta, out)
        if self.kind == "min" and not designs.rubs:
            kinks = np.empty((designs.size, 0)) if course is None else course.kinks.angles
            out[2:, stays_zero(designs, theta, out[0], out[1], kinks)] = 0.0
        value = np.abs(out[0]) if self.kind == "absmax" else out[0]
        gradient = dict(zip(self.work.search.parameters, out[2:], strict=True))
        return {"value": value, "theta": theta, "side": side, "gradient": gradient, "status": status}

    def _search_usual(self) -> None:
        """Search the designs that turn fully and at all angles have one balance of forces."""
        usual = self.work.usual
        quantity = Evaluations(usual) if self.course is None else self.quantity
        for rows, grid in _classed(self.designs, np.flatnonzero(~self.special)):
            nodes = grid[:, None]
            if self.course is not None:
                nodes = with_nodes(nodes, self.course.nodes_of(rows))
            if not self.designs.rubs:
                self._run(quantity, rows, nodes)
                continue
            nodes = with_nodes(nodes, self._rubbing(rows, nodes, usual))
            self._run(quantity, rows, nodes)
            value, _ = quantity.curve(nodes, quantity.block(self.designs, rows))
            turned = rows[
                turns_over(self.designs, self._found(rows), nodes.T, value.T, *self._marks(rows)[:1])
            ]
            self.status[turned], self.out[2:, turned] = 2, np.nan

    def _search_special(self, rows: Rows) -> None:
        """Search designs at nodes of their own, and tell what their extrema mean."""
        some, search = self.designs.part(rows), self.work.search
        own, limits = own_nodes(some)
        nodes = np.ascontiguousarray(own.T)
        if self.course is not None:
            nodes = with_nodes(nodes, self.course.nodes_of(rows))
        if "mu" in some.columns:
            nodes = with_nodes(nodes, self._rubbing(rows, nodes, search))
            nodes = np.ascontiguousarray(balanced_nodes(some, nodes.T).T)
        self._run(self.quantity, rows, nodes)
        result = self._found(rows)
        usable = complete(
            self.name, self.kind, some, nodes.T, limits, result, search.parameters, *self._marks(rows)
        )
        self.out[0, rows], self.theta[rows], self.status[rows] = result.value, result.theta, result.status
        self.out[2:, rows] = np.where(usable, self.out[2:, rows], np.nan)

    def _run(self, quantity: Quantity, rows: Rows, nodes: Array) -> None:
        """Search designs, with one column of nodes or one for each."""
        size, kind = max(1, MOST // len(nodes)), KINDS.index(self.kind)
        for first in range(0, rows.size, size):
            part = rows[first : first + size]
            own = nodes if nodes.shape[1] == 1 else nodes[:, first : first + size]
            block = quantity.block(self.designs, part)
            self.theta[part], self.out[:, part] = search_block(
                quantity.curve, quantity.finish, kind, own, block
            )

    def _rubbing(self, rows: Rows, nodes: Array, key: Search) -> Array:
        """The nodes of friction, a row a design; where loads have a kink or jump there are some."""
        side = self._quantity("N_C", key._replace(name="N_C", parameters=()))
        turns = sign_changes_of(side.curve, nodes, side.block(self.designs, rows))
        for marks in self._marks(rows):
            turns[(np.abs(turns[:, :, None] - marks[:, None]) <= AT_KINK).any(axis=2)] = np.nan
        return rubbing_nodes(self.designs.part(rows), turns)

    def _found(self, rows: Rows) -> SearchResult:
        return SearchResult(self.out[0, rows], self.theta[rows], self.out[1, rows], self.status[rows])

    def _marks(self, rows: Rows) -> tuple[Array, ...]:
        """The angles of kinks and jumps of the loads."""
        course = self.course
        return () if course is None else (course.kinks.angles[rows], course.jumps.angles[rows])


def with_nodes(nodes: Array, more: Array) -> Array:
    """A column of nodes for each row of more, ascending."""
    rows = np.broadcast_to(nodes.T, (len(more) if nodes.shape[1] == 1 else nodes.shape[1], len(nodes)))
    more = np.broadcast_to(more, (len(rows), more.shape[1]))
    return np.ascontiguousarray(np.sort(np.concatenate([rows, more], axis=1), axis=1).T)


def _in_form(search: Search, checked: Checked) -> Search:
    """The search in plain forms, if all designs of the usual kind have wide margins.

    A second one, for a few that are not, would take longer to compile than it saves.
    """
    own, rows = checked.designs.lengths, np.flatnonzero(~checked.special)
    if not rows.size or search.extended or not own:
        return search
    lengths = {name: column[rows] for name, column in zip(LENGTHS, own, strict=True)}
    if have_wide_margins(search.form, **lengths):
        return search._replace(form=search.form._replace(wide_margins=True))
    return search


def _checked(designs: SearchedDesigns) -> Checked:
    """The designs with NaN for invalid values, which would give a finite, wrong result."""
    bad = np.zeros(designs.size, np.bool_)
    columns = dict(designs.columns)
    for name, column in columns.items():
        fine = are_good(name, column)
        if not fine.all():
            columns[name] = np.where(fine, column, np.nan)
            bad |= ~fine
    designs = designs._replace(columns=columns)
    return Checked(designs, bad, are_special(designs))


def _classed(designs: SearchedDesigns, rows: Rows) -> Iterator[tuple[Rows, Array]]:
    """Designs by their classes, with the nodes that each class shares."""
    lengths = [column[rows] for column in designs.lengths]
    numbers = classes(*lengths) if lengths else np.zeros(rows.size, np.int16)
    for number in np.unique(numbers).tolist():
        yield rows[numbers == number], shared_nodes(number, *designs.theta)
