"""`crossings`: the angles at which a quantity passes through a value, and its share of the cycle above it."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.labelled import refuse_other_labels
from ...loads.angles import turns_of
from ...mechanism.catalogue import has, quantity
from ...mechanism.closed.limits import margin_of
from ...mechanism.inputs import Input
from ...mechanism.keywords import with_known_keywords
from ...mechanism.names import LENGTHS, sensitivity
from ...mechanism.quantity_units import slopes_of, unit_of
from ...mechanism.read import read, read_array
from ...mechanism.status import CrossingStatus
from ...runtime.request import check_common, is_steady
from ...support.answer import Answer
from ...support.panels import NODES, Array, Panels
from .cycle import MOST_TURNS, Cycle, input_rows
from .turn import NoCycleError, Turn, turn_of

TOGETHER = 3e-8  # rad: crossings that are nearer are one, or a tangency
NEAR = 1e-6  # rad: so are those, where what is between them is a difference that is none
EQUAL = 1e-14  # of the largest value: a difference that is none
JUMP = 1e-9  # of the largest value: a change at one angle that is a jump
AT_EDGE = 1e-12  # rad
LARGEST = 1e-6  # rad: correction of a root by Newton's method


class Crossings(NamedTuple):
    """The crossings of one design, ascending, and its share above the value."""

    theta: Array
    rising: Array
    side: Array
    share: float


NONE = Crossings(np.empty(0), np.empty(0), np.empty(0), np.nan)


@with_known_keywords
def crossings(
    name: str, *, value: Any = 0.0, branch: int = 1, sliders: Any = None, **inputs: Any
) -> dict[str, Any]:
    """The crank angles at which a quantity passes through a value, and how long it is above it.

    name    any quantity or sensitivity: a force in the rod for its reversal, "T_in", "V_C"
    value   in the quantity's unit
    inputs  as in `evaluate`, without theta: numbers and arrays, which broadcast, for many designs; F_X and
            F_Y may vary with the motion
    sliders filled in by a `Crankshaft`; what its sliders cancel to rounding is 0

    Returns a dict; of several designs the last axis of arrays has the crossings, padded with NaN:

    theta     angles [rad] in one cycle of crank and loads, ascending
    rising    1 where the quantity grows with the angle, -1 where it falls
    side      0; at a jump through the value the side of theta, -1 or 1, on which the quantity is larger
    count     of crossings
    share     of the cycle in which the quantity is larger than the value
    gradient  dict input -> derivatives of theta, of jumps, too; NaN under a function without `derivative`
    status    0; 1 the crank does not turn fully, 2 change point, 3 equal to the value at all angles, 4 bad
              input, 5 no value at some angles

    A quantity that touches the value does not cross it; where it stays at it for a while, both ends of the
    stretch are crossings if it leaves it. Panels between kinks and jumps are halved until the
    quantity is resolved; Newton's method with the derived slope ends each search. Raises as `evaluate` does.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> reversal = dx.crossings("V_C", ec=0.0, AB=0.1, BC=0.3, omega0=10.0)
        >>> [round(float(angle), 6) for angle in reversal["theta"]], round(reversal["share"], 6)
        ([0.0, 3.141593], 0.5)
    """
    check_common({}, branch)
    if inputs.pop("theta", None) is not None:
        raise TypeError("crossings: theta is the answer; the cycle is that of crank and loads")
    if inputs.get("omega") is None and not is_steady(inputs.get("alpha", 0.0)):
        raise TypeError("crossings: alpha: no turn repeats the one before; give the state, omega and alpha")
    if sliders is not None:
        return _of_shaft(name, value, turn_of("crossings", inputs, branch, sliders))
    row = Input("value", quantity(name, inputs.get("omega") is not None).unit, "")
    refuse_other_labels({**inputs, "value": value})
    rows = input_rows("crossings", inputs, {"value": read_array(row, value)})
    status = np.where(
        rows.bad, CrossingStatus.BAD_INPUT, _status(*(rows.each(rows.numbers[n]) for n in LENGTHS))
    )
    numbers, level = {n: rows.each(v) for n, v in rows.numbers.items()}, rows.each(rows.more["value"])
    cycle = Cycle(numbers, rows.loads, branch, turns_of("crossings", rows.loads, MOST_TURNS))
    result = [NONE] * rows.size
    for k in np.flatnonzero(status == 0).tolist():
        result[k], status[k] = _of_one(cycle.part([k]), name, float(level[k]))
    return _answer(name, result, status, rows.shape, cycle)


def _status(ec: Array, AB: Array, BC: Array) -> Array:
    """Why designs have no crossings; 0 for those that may."""
    return _status_of(margin_of(ec, AB, BC))


def _status_of(margin: Array) -> Array:
    codes = CrossingStatus.CANNOT_TURN, CrossingStatus.CHANGE_POINT
    return np.select([margin < 0.0, margin == 0.0], codes, 0).astype(np.int8)


def _of_shaft(name: str, value: Any, turn: Turn) -> Answer:
    """The crossings of a sum over the sliders of a crankshaft."""
    level = read(Input("value", unit_of(name), ""), value, "crossings")
    result, status = NONE, int(_status_of(np.array(turn.margin)))
    if not status:
        try:
            result, status = _of_one(turn, name, level, turn.floor(name))
        except NoCycleError:
            status = int(CrossingStatus.NO_VALUE)
    return _answer(name, [result], np.array([status], np.int8), (), turn)


def _of_one(cycle: Cycle, name: str, level: float, floor: float = 0.0) -> tuple[Crossings, int]:
    """The crossings of one design, and its status; floor: the magnitude up to which values are rounding."""
    panels = cycle.panels([name])
    edges, values = panels.edges.ravel(), panels.values[name].reshape(-1, NODES)
    if not np.isfinite(values).all():
        return NONE, CrossingStatus.NO_VALUE
    height = values - level
    largest = np.abs(values).max()
    least = max(EQUAL * max(largest, abs(level)), floor)
    if np.abs(height).max() <= least:
        return NONE._replace(share=0.0), CrossingStatus.EQUAL
    one = Panels(edges, {name: height})
    sampled = one.samples(height)
    stays = bool((np.abs(height) <= least).all(axis=1).any())  # at the value, on a panel
    least = least if stays else 0.0
    roots = _sign_changes(one, height, cycle.angle, least)
    if stays:  # either end of such a stretch may be a crossing
        others = _sign_changes(one, -height, cycle.angle, least)
        apart = np.abs(others[:, None] - roots)
        apart = np.minimum(apart, cycle.angle - apart).min(axis=1, initial=np.inf)
        roots = np.append(roots, others[apart > TOGETHER])
    roots = np.sort(roots)
    gaps = np.diff(roots, append=roots[:1] + cycle.angle)
    between = np.abs(one.at((roots + 0.5 * gaps) % cycle.angle + edges[0], height))
    is_close = (gaps < TOGETHER) | ((gaps < NEAR) & (between <= EQUAL * largest))
    theta = _odd(roots, is_close, cycle.angle) + edges[0]
    ends = one.ends(height)
    jumps = np.roll(ends[:, 1], 1) - ends[:, 0]  # at the start of each panel: before - after
    gap = np.abs(theta[:, None] - edges[:-1]) % cycle.angle
    edge = np.minimum(gap, cycle.angle - gap)
    at = edge.argmin(axis=1) if theta.size else np.empty(0, int)
    is_jump = (edge.min(axis=1, initial=np.inf) <= AT_EDGE) & (np.abs(jumps[at]) > JUMP * largest)
    theta = (np.where(is_jump, edges[at], _polished(cycle, name, theta, level)) - edges[0]) % cycle.angle
    order = np.argsort(theta)
    theta, is_jump = theta[order] + edges[0], is_jump[order]
    middle = theta + 0.5 * np.diff(theta, append=theta[:1] + cycle.angle)
    between = one.at((middle - edges[0]) % cycle.angle + edges[0], height)
    sign = np.where(np.abs(between) <= least, 0.0, np.sign(between))
    above = sign > 0.0
    share = float(np.diff(theta, append=theta[:1] + cycle.angle)[above].sum() / cycle.angle)
    share = share if theta.size else float(sampled[np.abs(sampled).argmax()] > 0.0)
    change = np.sign(sign - np.roll(sign, 1))
    rising = np.where(change == 0.0, np.where(above, 1.0, -1.0), change)
    order = np.argsort(theta % cycle.angle)
    side = np.where(is_jump, rising, 0.0)
    return Crossings((theta % cycle.angle)[order], rising[order], side[order], share), CrossingStatus.OK


def _sign_changes(panels: Panels, height: Array, angle: float, least: float) -> Array:
    """Angles from the start of the cycle at which a function changes its sign; -least counts as positive."""
    first, last = panels.samples(height)[[0, -1]] < -least
    roots = panels.roots(height, least)
    roots = np.append(roots, panels.edges[:1]) if first != last else roots
    return np.asarray((roots - panels.edges[0]) % angle)


def _odd(roots: Array, is_close: NDArray[np.bool_], angle: float) -> Array:
    """One root for each odd number of them that are together, none for an even one: a tangency.

    is_close  that a root and the next one are together, of the last one the first one of the next cycle
    """
    if not roots.size:
        return roots
    first = int(np.argmin(is_close)) + 1  # behind a gap: no group goes around the end of the cycle
    roots = np.concatenate([roots[first:], roots[:first] + angle])
    groups = np.split(roots, np.flatnonzero(~np.roll(is_close, -first)[:-1]) + 1)
    return np.array([group[group.size // 2] for group in groups if group.size % 2])


def _polished(cycle: Cycle, name: str, theta: Array, level: float) -> Array:
    """Roots after a step of Newton's method with the derived slope."""
    along = sensitivity(name, "theta")
    if not theta.size or not _has_slope(cycle, along):
        return theta
    here = cycle.values([name, along], theta, np.zeros(theta.shape, int))
    with np.errstate(all="ignore"):
        step = (here[name] - level) / here[along]
    return np.asarray(np.where(np.abs(step) < LARGEST, theta - step, theta))


def _has_slope(cycle: Cycle, along: str) -> bool:
    """True if the slope by theta is derived, and that of each load is known."""
    loads = cycle.loads.values()
    return isinstance(cycle, Turn) or (
        has(along, "omega" in cycle.numbers) and all(load.has_slope for load in loads)
    )


def _answer(
    name: str, found: Sequence[Crossings], status: Array, shape: tuple[int, ...], cycle: Cycle
) -> Answer:
    most = max((one.theta.size for one in found), default=0)
    columns = {key: np.full((len(found), most), np.nan) for key in ("theta", "rising", "side")}
    for k, one in enumerate(found):
        for key, column in columns.items():
            column[k, : one.theta.size] = getattr(one, key)
    gradient = _gradient(cycle, name, columns["theta"], columns["side"])
    result: dict[str, Any] = {key: column.reshape(*shape, most) for key, column in columns.items()}
    counts, shares = [one.theta.size for one in found], [one.share for one in found]
    for key, of_designs in {"count": counts, "share": shares, "status": status}.items():
        numbers = np.asarray(of_designs)
        result[key] = numbers.reshape(shape) if shape else numbers[0].item()
    result["gradient"] = {p: slope.reshape(*shape, most) for p, slope in gradient.items()}
    units = {"theta": unit_of("theta"), "gradient": slopes_of("theta", gradient)}
    return Answer(result, units, CrossingStatus)


def _gradient(cycle: Cycle, name: str, theta: Array, side: Array) -> dict[str, Array]:
    """The derivatives of angles by each input: -q_p / q_theta, at jumps those of the jump."""
    slopes = cycle.slopes_of(name)
    along = sensitivity(name, "theta")
    row, k = np.nonzero(np.isfinite(theta))
    if not row.size or not _has_slope(cycle, along):
        return {p: np.full(theta.shape, np.nan) for p in slopes}
    here = cycle.values([along, *slopes.values()], theta[row, k], row)
    moves = cycle.moves([name], theta) if np.any(side[row, k]) else {}
    gradient = {}
    for p, slope in slopes.items():
        gradient[p] = np.full(theta.shape, np.nan)
        with np.errstate(all="ignore"):
            gradient[p][row, k] = -here[slope] / here[along]
        shift = moves.get(p, np.zeros(theta.shape))
        gradient[p] = np.where(np.nan_to_num(side) != 0.0, shift, gradient[p])
    return gradient
