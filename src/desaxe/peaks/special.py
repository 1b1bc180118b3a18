"""Special designs: with limit angles, a stall, or friction that reverses or jams.

Their nodes are their own: graded towards the quarters, the limit angles and, with friction, the dead
centres, down to the distance of two doubles. What their extrema mean is told here.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.values import values
from ..loads.load import Load
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres, limit_angles, repeated
from ..mechanism.closed.functions import closed_form
from ..mechanism.closed.limits import LIMITS
from ..mechanism.names import LENGTHS
from ..mechanism.status import PeakStatus
from .nodes import Array

UNIFORM = 240  # nodes per turn
GRADED = 2.0 ** -np.arange(1.0, 46.0)  # distances from a quarter or a limit angle, down to 3e-14
AROUND = np.concatenate([-GRADED, [0.0], GRADED])
AT_KINK = 2.0**-40  # rad: an extremum so near to a kink is at the kink
SMOOTH = 1e-6  # of the median slope: what is left of the slope at the top of a smooth peak is less
ACROSS = 1e-6  # of the cosine of an angle: as far as a search ends from a jump
JAMS, TWO_BALANCES = int(PeakStatus.NO_FORCE_BALANCE), int(PeakStatus.TWO_FORCE_BALANCES)
USABLE = (0, JAMS, TWO_BALANCES)  # with one of these an extremum may have a gradient
MARGIN_ROUNDING = 2.0**-50  # of BC: more than BC - AB - |ec| may lose to rounding
FARTHER = 2.0**-20  # rad from a limit angle: unbounded quantities have grown from there on, in a wide arc
TOUCHES = 2.0**-20  # rad from an extremum: where its tangent is 0 there, a magnitude is
ROUNDED = 64.0  # last bits of an angle: so near to a dead centre rounding may take the other side's friction
SURE = 1.0 - 1e-6  # less than 1 by more than rounding
REACH = 1.0  # rad: a stall nearer to the range than this shapes what is in it


class SearchedDesigns(NamedTuple):
    """Flat arrays of the inputs of some designs, what is fixed for all, and the range of theta."""

    columns: dict[str, Array]
    branch: int
    theta: tuple[float, float]
    rubs: bool  # whether friction has a say, or another source of kinks and jumps
    loads: Mapping[str, Load] = MappingProxyType({})  # those that vary with the motion
    accuracy: str = "standard"
    conditions: tuple[str, ...] = ()  # quantities that are 0 where a user-defined one may jump or have a kink

    @property
    def size(self) -> int:
        """The number of designs."""
        return next(iter(self.columns.values())).size

    @property
    def lengths(self) -> list[Array]:
        """ec, AB and BC of each design; nothing where the quantity does without some of them."""
        known = all(name in self.columns for name in LENGTHS)
        return [self.columns[name] for name in LENGTHS] if known else []

    def part(self, rows: Any) -> "SearchedDesigns":
        """The designs of these rows."""
        return self._replace(columns={name: column[rows] for name, column in self.columns.items()})

    def values(self, names: tuple[str, ...], rows: NDArray[np.intp], theta: Array) -> dict[str, Any]:
        """Values of names by their name, for the designs `rows` at one angle each."""
        inputs: dict[str, Any] = {name: column[rows] for name, column in self.columns.items()}
        given = {"alpha": 0.0, **inputs, **self.loads, "theta": theta}
        result: dict[str, Any] = values(list(names), given, self.branch)
        return result


def are_special(designs: SearchedDesigns) -> NDArray[np.bool_]:
    """Mask of the designs that cannot turn fully, stall in the range or near it, or have friction."""
    columns = designs.columns
    special = ~_only_rub(designs) if designs.rubs else np.zeros(designs.size, np.bool_)
    if designs.lengths:
        ec, AB, BC = designs.lengths
        special |= ~(BC - AB - np.abs(ec) > MARGIN_ROUNDING * BC)
    if "alpha" in columns and "omega0" in columns:
        low, high = designs.theta
        stop = _stall(columns["omega0"], columns["alpha"])
        special |= (stop > low - REACH) & (stop < high + REACH)
    return special


def _only_rub(designs: SearchedDesigns) -> NDArray[np.bool_]:
    """Mask of the designs of which friction jams at no angle: mu |tan(phi)| < 1."""
    if "mu" not in designs.columns or designs.conditions:
        return np.zeros(designs.size, np.bool_)
    ec, AB, BC = designs.lengths
    steepest = (np.abs(ec) + AB) / BC  # the sine of phi
    mu = designs.columns["mu"]
    result: NDArray[np.bool_] = (mu * steepest) ** 2 < SURE * (1.0 - steepest**2)
    return result


def rubbing_nodes(designs: SearchedDesigns, turns: Array) -> Array:
    """Nodes at the angles of kinks and jumps, where friction or the side of the guide turns, and beside them.

    turns   angles at which the side of the guide turns: a row a design, NaN in empty places
    """
    low, high = designs.theta
    dead = repeated(dead_centres(designs.lengths), low, high)
    marks = np.concatenate([dead, np.where((turns >= low) & (turns <= high), turns, np.nan)], axis=1)
    room = ROUNDED * np.spacing(1.0 + np.abs(marks))
    nodes = np.concatenate([marks - room, marks, marks + room], axis=1)
    return np.where(np.isnan(nodes), low, np.clip(nodes, low, high))


def _stall(omega0: Array, alpha: Array) -> Array:
    """The angle at which omega0^2 + 2 alpha theta = 0."""
    with np.errstate(all="ignore"):
        return -(omega0 * omega0) / (2.0 * alpha)


def even_nodes(designs: SearchedDesigns) -> Array:
    """Crank angles at equal steps."""
    low, high = designs.theta
    return np.linspace(low, high, int(UNIFORM * max(1.0, (high - low) / TURN)) + 1)


def own_nodes(designs: SearchedDesigns) -> tuple[Array, list[tuple[int, float]]]:
    """Crank angles for each design, ascending, and its limit angles inside the range."""
    low, high = designs.theta
    first, last = int(np.floor(low / np.pi)) - 1, int(np.ceil(high / np.pi)) + 1
    marks = np.array([low, high, *(np.pi * (0.5 + k) for k in range(first, last))])
    common = np.append(even_nodes(designs), marks[:, None] + AROUND)
    own = _limit_angles(designs)
    inside = np.argwhere((low <= own) & (own <= high)).tolist()
    ends = [(row, float(own[row, k])) for row, k in inside]
    lengths = designs.lengths
    if designs.rubs and lengths:
        own = np.append(own, repeated(dead_centres(lengths), low, high), axis=1)
    if "mu" in designs.columns and lengths:
        own = np.append(own, repeated(_ends_of_balance(lengths, designs.columns["mu"]), low, high), axis=1)
    width = int(np.isfinite(own).sum(axis=1).max(initial=0))
    near = np.sort(own, axis=1)[:, :width, None] + AROUND
    near = np.where(np.isnan(near), low, near).reshape(designs.size, -1)
    both = np.append(np.broadcast_to(common, (designs.size, common.size)), near, axis=1)
    return np.sort(np.clip(both, low, high), axis=1), ends


def balanced_nodes(designs: SearchedDesigns, nodes: Array) -> Array:
    """The nodes without those of an arc with one balance of forces that rounding alone makes.

    Where two balances end and jamming begins the next double may have one, and any value.
    """
    size, count = nodes.shape
    status = designs.values(("status",), np.repeat(np.arange(size), count), nodes.reshape(-1))["status"]
    bad = np.isin(status.reshape(size, count), (JAMS, TWO_BALANCES))
    before = np.maximum.accumulate(np.where(bad, nodes, -np.inf), axis=1)
    after = np.minimum.accumulate(np.where(bad, nodes, np.inf)[:, ::-1], axis=1)[:, ::-1]
    return np.where(after - before < AT_KINK, before, nodes)


def _ends_of_balance(lengths: list[Array], mu: Array) -> Array:
    """The angles in a turn at which friction begins or ends to jam, |mu tan(phi)| = 1; NaN elsewhere."""
    ec, AB, BC = (length[:, None] for length in lengths)
    with np.errstate(invalid="ignore"):
        first = np.arcsin((BC / np.hypot(1.0, mu[:, None]) * [1.0, -1.0] - ec) / AB)
    return np.append(first, np.pi - first, axis=1)


def _limit_angles(designs: SearchedDesigns) -> Array:
    """The angles at which designs stop being feasible, or stall, in the range or near it; NaN elsewhere."""
    (low, high), columns, lengths = designs.theta, designs.columns, designs.lengths
    result = np.empty((designs.size, 0))
    if lengths:
        angles = limit_angles(lengths)
        whole = angles[:, 1:2] - angles[:, 0:1] == TURN
        result = repeated(np.where(whole, np.nan, angles), low, high)
    if "alpha" in columns and "omega0" in columns:
        stops = _stall(columns["omega0"], columns["alpha"])
        near = (stops > low - REACH) & (stops < high + REACH)
        result = np.append(result, np.where(near, stops, np.nan)[:, None], axis=1)
    return result


# ---- what the extrema mean ------------------------------------------------------------------------


class SearchResult(NamedTuple):
    """The results of a search for some designs, to be completed in place."""

    value: Array
    theta: Array
    slope: Array  # at theta
    status: NDArray[np.int8]


def complete(
    name: str,
    kind: str,
    designs: SearchedDesigns,
    nodes: Array,
    ends: list[tuple[int, float]],
    result: SearchResult,
    parameters: tuple[str, ...],
    kinks: Array | None = None,
    jumps: Array | None = None,
) -> NDArray[np.bool_]:
    """Add limit angles, ends of the force balance and status to the results.

    Which have a derivative with respect to each of the parameters is returned: a row for each parameter.

    value   signed, also for "absmax"
    kinks   for each design angles at which a load has a kink: there the slope does not vanish
    jumps   and those at which one jumps: there a balance of forces may end without anything growing
    """
    rows = np.arange(designs.size)
    swept = designs.values((name, "status"), np.repeat(rows, nodes.shape[1]), nodes.reshape(-1))
    value, status = (swept[n].reshape(nodes.shape) for n in (name, "status"))
    jams, turns = _at_force_limits(name, kind, designs, nodes, swept, result, jumps)
    result.status[:] = _status(status)
    _mark_limits(kind, result, value, nodes, ends)
    turns |= turns_over(designs, result, nodes, value, kinks)
    fixed = _at_change_point(designs, result) & ~turns
    turns |= fixed
    result.value[jams] = np.copysign(np.inf, result.value[jams])
    # Without a value at any angle but a change point, which is all that a stalling crank reaches, too.
    result.status[(turns | np.isnan(result.value)) & (result.status == 0)] = 2
    usable = np.isin(result.status, USABLE) & ~turns & np.isfinite(result.value)
    moved_by = np.array([p in LENGTHS for p in parameters], np.bool_)[:, None]  # what moves a change point
    return usable | (fixed & np.isfinite(result.value) & ~moved_by)


def _at_change_point(designs: SearchedDesigns, result: SearchResult) -> NDArray[np.bool_]:
    """True where a crank lies across its guide at a change point, in line with the rod: rates jump there."""
    if not designs.lengths:
        return np.zeros(designs.size, bool)
    upper, lower = closed_form(LIMITS, ("upper", "lower")).arrays(*designs.lengths)
    margin = np.where(np.sin(result.theta) > 0.0, upper, lower)
    across: NDArray[np.bool_] = (margin == 0.0) & (np.abs(np.cos(result.theta)) < ACROSS)
    return across


def stays_zero(
    designs: SearchedDesigns, theta: Array, value: Array, slope: Array, kinks: Array
) -> NDArray[np.bool_]:
    """True where the smallest value is a magnitude's 0 but for rounding, which moves and stays 0.

    kinks   for each design angles at which a load has a kink, which may be at 0 too
    """
    low, high = designs.theta
    turns = (high - low) / TURN
    closed = turns == round(turns) and not np.any(designs.columns.get("alpha", 0.0))
    inside = (theta != low) & (theta != high) | closed
    at_kink = (np.abs(kinks - theta[:, None]) <= AT_KINK).any(axis=1)
    result: NDArray[np.bool_] = inside & ~at_kink & (np.abs(value) < TOUCHES * np.abs(slope))
    return result


def score(kind: str, value: Array) -> Array:
    """The objective, to be maximised; -inf for NaN."""
    good = {"absmax": np.abs(value), "max": value, "min": -value}[kind]
    return np.where(np.isnan(good), -np.inf, good)


def _at_force_limits(
    name: str,
    kind: str,
    designs: SearchedDesigns,
    nodes: Array,
    swept: dict[str, Any],
    result: SearchResult,
    jumps: Array | None,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Let the last angles with exactly one force balance take part in the search.

    Which designs have their extremum where it jams, and which at either.
    """
    value, status = (swept[n].reshape(nodes.shape) for n in (name, "status"))
    fine, bad = status == 0, (status == JAMS) | (status == TWO_BALANCES)
    rows, columns = np.nonzero((fine[:, :-1] & bad[:, 1:]) | (bad[:, :-1] & fine[:, 1:]))
    jams, turns = np.zeros(designs.size, np.bool_), np.zeros(designs.size, np.bool_)
    if not rows.size:
        return jams, turns
    forth = fine[rows, columns]
    here, there = (rows, columns + np.where(forth, 0, 1)), (rows, columns + np.where(forth, 1, 0))
    inside, beyond, values, codes = nodes[here], nodes[there], value[here], status[there]
    for _ in range(60):
        middle = 0.5 * (inside + beyond)
        # Both of one call: at the brink rounding decides, and another program may round in another way.
        at = designs.values((name, "status"), rows, middle)
        balanced = at["status"] == 0
        inside, beyond = np.where(balanced, middle, inside), np.where(balanced, beyond, middle)
        values, codes = np.where(balanced, at[name], values), np.where(balanced, codes, at["status"])
    if jumps is not None:
        values = np.where((np.abs(jumps[rows] - inside[:, None]) <= AT_KINK).any(axis=1), np.nan, values)
    for row, theta, value, code in zip(rows, inside, values, codes, strict=True):
        best = value == value and score(kind, value) >= score(kind, result.value[row])
        if best:
            result.value[row], result.theta[row] = value, theta
        if best or abs(result.theta[row] - theta) <= AT_KINK:  # a node may be nearer, where rounding differs
            jams[row], turns[row] = code == JAMS, True
    return jams, turns


def _status(status: NDArray[np.int8]) -> NDArray[np.int8]:
    """The status of a design: that of friction at any angle, else 0 if one angle is ok, else the first."""
    usable = ((status == 0) | (status == 2)).any(axis=1)
    result = np.where(usable, np.int8(0), status[:, 0]).astype(np.int8)
    for code in (TWO_BALANCES, JAMS):
        result[(status == code).any(axis=1)] = code
    return result


def _mark_limits(
    kind: str, result: SearchResult, value: Array, nodes: Array, ends: list[tuple[int, float]]
) -> None:
    """An extremum at a limit angle has status 2; what has no bound there is infinite."""
    for row, end in ends:
        usable = ~np.isnan(value[row])
        if not usable.any():
            continue
        near = np.flatnonzero(usable)[np.argmin(np.abs(nodes[row, usable] - end))]
        if abs(nodes[row, near] - end) > 1e-6:
            continue
        others = [abs(angle - end) for other, angle in ends if other == row and angle != end]
        reference = min(FARTHER, 0.5 * min(others, default=np.inf))
        bounded = not _grows(nodes[row, usable], value[row, usable], end, value[row, near], reference)
        # The search may have stopped beyond `near`, where only more digits show that it is infeasible.
        at_end = abs(result.theta[row] - end) <= max(abs(nodes[row, near] - end), 0.5 * GRADED[-1])
        grows = not bounded and score(kind, value[row, near]) >= score(kind, result.value[row])
        if at_end or grows:
            result.status[row] = 2
            result.theta[row] = end
            if not bounded:
                result.value[row] = np.copysign(np.inf, value[row, near])


def _grows(nodes: Array, value: Array, end: float, last: float, reference: float) -> bool:
    """True if a quantity is unbounded towards an end: there far above its value at the reference distance."""
    away = np.log2(np.maximum(np.abs(nodes - end), 1e-16))
    farther = value[np.argmin(np.abs(away - np.log2(reference)))]
    return bool(abs(last) > 16.0 * abs(farther))


def turns_over(
    designs: SearchedDesigns, result: SearchResult, nodes: Array, value: Array, kinks: Array | None = None
) -> NDArray[np.bool_]:
    """Mask of the extrema at a kink or jump whose angle moves with the design, but for those of loads."""
    if not designs.rubs:
        return np.zeros(designs.size, np.bool_)
    low, high = designs.theta
    with np.errstate(all="ignore"):
        steep = np.abs(np.diff(value) / np.diff(nodes))
    steep = np.sort(np.where(np.isfinite(steep), steep, np.inf), axis=1)
    usual = steep[np.arange(len(steep)), np.isfinite(steep).sum(axis=1) // 2]
    turns: NDArray[np.bool_] = (
        (np.abs(result.slope) > SMOOTH * usual) & (result.theta != low) & (result.theta != high)
    )
    if kinks is not None:
        turns &= ~(np.abs(kinks - result.theta[:, None]) <= AT_KINK).any(axis=1)
    return turns
