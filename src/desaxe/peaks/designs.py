"""Peaks of flat designs: the plan of a request, and the search over all designs."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.passes.guard import BAD_INPUT
from ..loads.load import Load
from ..mechanism.catalogue import has, quantity
from ..mechanism.constants import constants
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, sensitivity
from ..mechanism.own import changes, forget_on_change
from ..mechanism.own_lines import has_kinks
from ..runtime.accuracy import accuracy_of
from ..runtime.kernels import STRUCTURAL_ZEROS
from ..runtime.request import Request, is_steady, request
from ..runtime.specialise import plain_form
from ..runtime.wide_margins import have_wide_margins
from . import special
from .compiled import Groups, run
from .loaded import kinks_of, moved_with_kinks, run_under_loads, with_nodes, with_slopes
from .nodes import Array, classes, shared_nodes
from .programs import WITHOUT_COURSE, Search, needs_own
from .special import Designs

KINDS = ("absmax", "max", "min")


class Plan(NamedTuple):
    """A request to search, the parameters of its gradient, and all inputs that it needs."""

    wanted: Request
    parameters: tuple[str, ...]
    needs: tuple[str, ...]


MOST_PLANS = 1024
_PLANS: dict[Any, Plan] = {}
forget_on_change(_PLANS)


def plan_of(name: str, given: dict[str, Any], branch: int, accuracy: Any) -> Plan:
    """The plan of a request, which depends on its names only."""
    shown = frozenset(n for n, value in given.items() if value is not None)
    if type(accuracy) is not str:
        accuracy = accuracy_of(accuracy)
    key = name, shown, is_steady(given["alpha"]), branch, accuracy
    plan = _PLANS.get(key)
    if plan is None:
        if len(_PLANS) > MOST_PLANS:
            _PLANS.clear()
        before = changes()
        plan = _new_plan(name, dict(given), branch, accuracy)
        if changes() == before:  # no name has got another meaning meanwhile
            _PLANS[key] = plan
    return plan


def _new_plan(name: str, given: dict[str, Any], branch: int, accuracy: Any) -> Plan:
    if name in WITHOUT_COURSE:
        raise ValueError(f"{name} has no peak over theta")
    state = given["omega"] is not None
    quantity(name, state)
    slope = sensitivity(name, "theta")
    names = (name, slope) if has(slope, state) else (name,)
    wanted = request(names, given, branch, accuracy)
    parameters = tuple(n for n in wanted.inputs if n != "theta")
    if "omega0" not in parameters and given["omega0"] is None and not state:
        given["omega0"] = 0.0
    if "mu" not in parameters:
        given["mu"] = None  # what friction does matters to forces only
    told = request((*names, "status"), given, branch, accuracy).inputs
    needs = (*parameters, *(n for n in told if n not in (*parameters, "theta")))
    return Plan(wanted, parameters, needs)


def search_of(plan: Plan, arrays: dict[str, Array], ends: tuple[float, float]) -> Search:
    """The search to compile; a scalar input of 0 is folded unless the gradient needs it."""
    wanted = plan.wanted
    name = wanted.names[0]
    kept = needs_own(name, plan.parameters)
    zeros = [
        (n, 0.0)
        for n in STRUCTURAL_ZEROS
        if n in plan.parameters
        and n not in kept
        and n in arrays
        and arrays[n].size == 1
        and arrays[n].item() == 0.0
    ]
    extended = wanted.accuracy == "extended"
    far = max(abs(ends[0]), abs(ends[1])) > constants().limit
    return Search(name, plan.parameters, wanted.form, (*wanted.fixed, *zeros), extended, far)


def peaks_of_designs(
    plan: Plan,
    kind: str,
    search: Search,
    columns: dict[str, Array],
    branch: int,
    ends: tuple[float, float],
    threads: int | None,
    varying: Mapping[str, Load] | None = None,
) -> dict[str, Any]:
    """Value, angle, gradient and status of flat designs; `varying` are their loads that vary with theta."""
    kinks = "mu" in plan.parameters or has_kinks(plan.wanted.form.own)
    designs = Designs(columns, branch, ends, kinks, dict(varying or {}), plan.wanted.accuracy)
    return _peaks(plan.wanted.shown[0], kind, search, designs, threads)


def _peaks(name: str, kind: str, search: Search, designs: Designs, threads: int | None) -> dict[str, Any]:
    """Value, angle, gradient and status of flat designs."""
    out = np.empty((2 + len(search.parameters), designs.size))
    theta = np.empty(designs.size)
    status = np.zeros(designs.size, np.int8)
    columns = _good(designs)
    number = KINDS.index(kind)
    ends = special.are_special(designs)
    rows = np.flatnonzero(~ends)
    if designs.loads:
        designs = designs._replace(columns=columns, loads=with_slopes(designs.loads))
    kinks, own = kinks_of(designs) if designs.loads else (None, np.empty((designs.size, 0)))
    if rows.size and designs.loads:
        groups = with_nodes(_classed(designs, rows), own)
        run_under_loads(name, search, designs, groups, number, theta, out)
    elif rows.size:
        run(_in_form(search, columns, rows), columns, _classed(designs, rows), number, theta, out, threads)
    bad = np.any([np.isnan(column) for column in columns.values()], axis=0)
    out[:, bad], status[bad] = np.nan, BAD_INPUT
    rows = np.flatnonzero((ends | np.isnan(out[0]) if rows.size else ends) & ~bad)
    for start in range(0, rows.size, special.BLOCK):
        part = rows[start : start + special.BLOCK]
        some = designs.part(part)
        nodes, limits = special.own_nodes(some)
        nodes = np.sort(np.concatenate([nodes, own[part]], axis=1), axis=1)
        edges = np.arange(part.size + 1)
        groups = Groups(part, edges, nodes.reshape(-1), edges * nodes.shape[1])
        if designs.loads:
            run_under_loads(name, search, designs, groups, number, theta, out)
        else:
            run(search, columns, groups, number, theta, out, threads)
        found = special.Found(out[0, part], theta[part], out[1, part], status[part])
        at = kinks.angles[part] if kinks is not None else None
        usable = special.complete(name, kind, some, nodes, limits, found, at)
        out[0, part], theta[part], status[part] = found.value, found.theta, found.status
        out[2:, part] = np.where(usable, out[2:, part], np.nan)
    theta[np.isnan(out[0])] = np.nan
    if kinks is not None:
        moved_with_kinks(number, designs, kinks, theta, out, search.parameters)
    value = np.abs(out[0]) if kind == "absmax" else out[0]
    gradient = dict(zip(search.parameters, out[2:], strict=True))
    return {"value": value, "theta": theta, "gradient": gradient, "status": status}


def _in_form(search: Search, columns: dict[str, Array], rows: NDArray[np.intp]) -> Search:
    """The search in plain forms, if those are shorter and all these designs have wide margins.

    A second one, for a few that are not, would take longer to compile than it saves.
    """
    names = search.name, sensitivity(search.name, "theta")
    derived = tuple(name for name in names if has(name))
    known = all(name in columns for name in LENGTHS)
    if search.extended or not known or plain_form(derived, search.form, search.fixed) is None:
        return search
    wide_margins = have_wide_margins({name: _at(columns[name], rows) for name in LENGTHS}, search.form).all()
    return search._replace(form=search.form._replace(wide_margins=True)) if wide_margins else search


def _at(column: Array, rows: NDArray[np.intp]) -> Array:
    """The values of some designs; of all of them without a copy."""
    return column if rows.size == column.size else column[rows]


def _good(designs: Designs) -> dict[str, Array]:
    """The inputs with NaN for invalid values, which would give a finite, wrong result."""
    if designs.size == 1:
        return designs.columns  # checked where it came in
    good = {}
    for name, column in designs.columns.items():
        least = INPUTS[name].least
        fine = np.isfinite(column) if least is None else np.isfinite(column) & (column >= least)
        good[name] = column if fine.all() else np.where(fine, column, np.nan)
    return good


def _classed(designs: Designs, rows: NDArray[np.intp]) -> Groups:
    """The designs by their classes, which share nodes."""
    lengths = [_at(designs.columns[n], rows) for n in LENGTHS if n in designs.columns]
    numbers = np.zeros(rows.size, np.int16) if len(lengths) < 3 else classes(*lengths)
    if rows.size == 1 or (numbers == numbers[0]).all():
        nodes = shared_nodes(int(numbers[0]), *designs.theta)
        return Groups(rows, np.array([0, rows.size]), nodes, np.array([0, nodes.size]))
    places = np.argsort(numbers, kind="stable")
    numbers = numbers[places]
    first = np.flatnonzero(np.diff(numbers, prepend=-1))
    grids = [shared_nodes(int(number), *designs.theta) for number in numbers[first]]
    starts = np.append(first, rows.size)
    node_starts = np.cumsum([0, *(grid.size for grid in grids)])
    return Groups(rows[places], starts, np.concatenate(grids), node_starts)
