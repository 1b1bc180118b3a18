"""`peak`: the refined extremum of a quantity over the crank angle, with its exact gradient.

The search runs compiled, for many designs in a call (`search`); the first few designs of a kind
run it in plain Python. By the envelope theorem the gradient of the extreme value is the partial
derivative at the extreme angle. Friction makes kinks and jumps, where it has none, and arcs in which
no forces balance, towards which they grow without bound (`special`).
"""

from collections.abc import Mapping
from typing import Any, NamedTuple
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import as_array, broadcast_shape
from ..evaluation.loaded import loads_of
from ..loads.load import Load, LoadWarning, OverTheta
from ..loads.resolve import VARIABLE
from ..mechanism.catalogue import has, quantity
from ..mechanism.constants import constants
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, sensitivity
from ..mechanism.own import changes, forget_on_change
from ..mechanism.own_lines import has_kinks
from ..runtime.accuracy import accuracy_of
from ..runtime.kernels import STRUCTURAL_ZEROS
from ..runtime.request import Request, as_number, check_common, check_inputs, is_steady, request
from ..runtime.specialise import plain_form
from ..runtime.wide_margins import have_wide_margins
from ..support.shown import shown as shown_value
from . import special
from .compiled import Groups, run
from .loaded import kinks_of, moved_with_kinks, run_under_loads, with_nodes, with_slopes
from .nodes import Array, classes, shared_nodes
from .programs import WITHOUT_COURSE, Search, needs_own
from .special import Designs

KINDS = ("absmax", "max", "min")
MOST_TURNS = 1000  # of a range of crank angles
TURN = (0.0, 2.0 * np.pi)
MANY = 60  # values of a load: more are no designs that anybody compares
INPUTS_OF_PEAK = (*INPUTS, "branch", "kind", "accuracy", "threads")


def peak(
    name: str,
    *,
    ec: Any = None,
    AB: Any = None,
    BC: Any = None,
    omega0: Any = None,
    alpha: Any = 0.0,
    omega: Any = None,
    branch: int = 1,
    kind: str = "absmax",
    theta: tuple[float, float] = TURN,
    accuracy: str | float = "standard",
    threads: int | None = None,
    **loads: Any,
) -> dict[str, Any]:
    """The extreme value of a quantity over the crank angle; designs broadcast like NumPy.

    kind    "absmax" (the largest magnitude), "max" or "min"
    theta   range of crank angles [rad]; its ends count. By default a turn, or the period of a longer load
    threads how many share the work, all that pay without; the answer is the same
    others  as in `evaluate`, masses and loads among them. F_X and F_Y may vary with the motion; at a jump
            both one-sided limits count, and `gradient` by such a force is that by a constant added to it

    Gives a dict, floats for one design and arrays for many:

    value     the extreme value; a magnitude for "absmax". inf where it grows without bound at a
              limit angle of a mechanism that cannot turn fully
    theta     the crank angle where it is reached
    gradient  dict parameter -> exact derivative of the value (ec, AB, BC, omega0 or omega, alpha, as
              far as the quantity depends on them); NaN where the value is not finite or is reached
              at a limit angle, or where friction turns round or begins to jam
    status    0 ok, 1 cannot be assembled anywhere in the range, 2 reached at a limit angle or change
              point, or at an angle at which the friction turns round, 3 stalled in all of the range,
              4 bad input; 5 friction jams at some of the angles (no forces balance), 6 two sets of
              forces balance at some: the value is that of all others, inf where it grows without
              bound towards those at which friction jams

    Where two angles share the extreme value, as by symmetry at ec = 0, one of them is told, and the
    gradient is the one-sided derivative there.

    Warns (LoadWarning) of a long array for F_X or F_Y and no other array: those are designs, not angles.
    Raises ValueError for an unknown quantity or kind.
    """
    if not isinstance(name, str):
        raise TypeError(f"peak: one name is wanted, such as 'a_C', got {shown_value(name)}")
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"kind = {shown_value(kind)}: it is one of {', '.join(KINDS)}")
    given = {"ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "alpha": alpha, "omega": omega, **loads}
    check_inputs("peak", loads, INPUTS_OF_PEAK)
    check_common(given, branch, threads)
    _, varying = loads_of(given)
    plan = _plan(name, given, branch, accuracy)
    varying = {n: load for n, load in varying.items() if n in plan.parameters}
    ends = _range(_whole_period(varying) if theta is TURN else theta, name)
    _warn_of_columns(given, plan)
    if "omega0" in plan.needs and omega0 is None:
        given["omega0"] = 0.0 if "omega0" not in plan.parameters else None  # which only the status uses
    arrays = {n: as_array(n, given.get(n), plan.needs, (name,)) for n in plan.needs if n not in varying}
    shape = broadcast_shape(arrays)
    columns = {n: _flat(a, shape) for n, a in arrays.items()}
    kinks = "mu" in plan.parameters or has_kinks(plan.wanted.form.own)
    designs = Designs(columns, branch, ends, kinks, varying, plan.wanted.accuracy)
    found = _peaks(name, kind, _search(plan, arrays, ends), designs, threads)
    return _shaped(found, shape)


def _range(theta: Any, name: str) -> tuple[float, float]:
    """The ends of the range of crank angles."""
    try:
        first, last = theta
    except (TypeError, ValueError):
        raise ValueError(f"theta = {shown_value(theta)}: a range (lower end, upper end) is wanted") from None
    low, high = (as_number("theta", end, ("theta",), (name,)) for end in (first, last))
    if low is None or high is None or low > high:
        raise ValueError(
            f"theta = ({shown_value(first)}, {shown_value(last)}): two angles, the lower one first"
        )
    if high - low > MOST_TURNS * 2.0 * np.pi:
        turns = (high - low) / (2.0 * np.pi)
        raise ValueError(f"theta = ({low:g}, {high:g}): {turns:.3g} turns are too many, at most {MOST_TURNS}")
    return low, high


def _whole_period(loads: Mapping[str, Load]) -> tuple[float, float]:
    """One turn, or as many as the longest period of a load has."""
    periods = [load.period for load in loads.values() if isinstance(load, OverTheta)]
    return 0.0, max([TURN[1], *periods])


def _warn_of_columns(given: Mapping[str, Any], plan: "_Plan") -> None:
    """A long array of loads and no other array are hardly designs: more likely a load over theta."""
    shapes = {n: np.shape(getattr(given.get(n), "magnitude", given.get(n, 0.0))) for n in plan.needs}
    arrays = {n: shape for n, shape in shapes.items() if shape}
    for name, shape in arrays.items():
        if name in VARIABLE and len(arrays) == 1 and len(shape) == 1 and shape[0] > MANY:
            warn(
                f"{name}: peak takes an array for so many designs, here {shape[0]} that differ in {name} "
                f"alone; for a load over the crank angle give {name}=desaxe.over_theta(angles, values)",
                LoadWarning,
                stacklevel=3,
            )


def _flat(array: Array, shape: tuple[int, ...]) -> Array:
    """A value for each design."""
    return np.broadcast_to(array, shape).reshape(-1) if shape else array.reshape(1)


class _Plan(NamedTuple):
    """A request to search, the parameters of its gradient, and every input that the answer needs."""

    wanted: Request
    parameters: tuple[str, ...]
    needs: tuple[str, ...]


MOST_PLANS = 1024
_PLANS: dict[Any, _Plan] = {}
forget_on_change(_PLANS)


def _plan(name: str, given: dict[str, Any], branch: int, accuracy: Any) -> _Plan:
    """The plan of what is asked for, from its names alone."""
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


def _new_plan(name: str, given: dict[str, Any], branch: int, accuracy: Any) -> _Plan:
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
    return _Plan(wanted, parameters, needs)


def _search(plan: _Plan, arrays: dict[str, Array], ends: tuple[float, float]) -> Search:
    """What to compile: a scalar of 0 makes whole terms vanish, if nothing has to be differentiated by it."""
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


# ---- designs ------------------------------------------------------------------------------------


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
    rows = np.flatnonzero(ends | np.isnan(out[0]) if rows.size else ends)
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
    wide_margins = have_wide_margins({name: columns[name][rows] for name in LENGTHS}, search.form).all()
    return search._replace(form=search.form._replace(wide_margins=True)) if wide_margins else search


def _good(designs: Designs) -> dict[str, Array]:
    """The inputs, NaN where they are bad: one that is would give a finite, wrong answer."""
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
    lengths = [designs.columns[n][rows] for n in LENGTHS if n in designs.columns]
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


def _shaped(found: dict[str, Any], shape: tuple[int, ...]) -> dict[str, Any]:
    """The answers in the shape of the designs; plain numbers for one design."""

    def shaped(array: NDArray[Any]) -> Any:
        return array.reshape(shape) if shape else array[0].item()

    gradient = {name: shaped(slope) for name, slope in found.pop("gradient").items()}
    parts = {name: shaped(array) for name, array in found.items()}
    return {"value": parts["value"], "theta": parts["theta"], "gradient": gradient, "status": parts["status"]}
