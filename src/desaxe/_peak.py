"""`peak`: the refined extremum of a quantity over the crank angle, with its exact gradient.

For each design: a sweep that is graded towards the quarters and the limit angles, where peaks are
as narrow as the root of the margin; every change of sign of the exact derivative by theta is
bracketed and refined; ends of the range and of feasible arcs count. By the envelope theorem the
gradient of the extreme value is the partial derivative at the extreme angle. Friction makes kinks
and jumps, where it has none, and arcs in which no forces balance, towards which they grow without bound.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array, broadcast_shape
from ._peak_sweep import Array, Designs, sweep, values_at
from ._request import as_number, check_inputs, request
from .catalogue import quantity
from .names import LOADS, sensitivity

KINDS = ("absmax", "max", "min")
BLOCK = 4096  # designs at a time
STEPS = 80  # of a refinement; it ends when every bracket is down to a last bit
SMOOTH = 1e-6  # of the median slope: what is left of the slope at the top of a smooth peak is less
JAMS, TWO_BALANCES = 5, 6  # the status where friction leaves no balance of forces, or two


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
    theta: tuple[float, float] = (0.0, 2.0 * np.pi),
    accuracy: str | float = "standard",
    **loads: Any,
) -> dict[str, Any]:
    """The extreme value of a quantity over the crank angle; designs broadcast like NumPy.

    kind    "absmax" (the largest magnitude), "max" or "min"
    theta   range of crank angles [rad]; its ends count
    others  as in `evaluate`, masses and loads among them

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

    Raises ValueError for an unknown kind, or a quantity whose derivative by theta is not derived.
    """
    slope = _slope_name(name, omega is not None)
    if kind not in KINDS:
        raise ValueError(f"kind = {kind!r}: it is one of {', '.join(KINDS)}")
    low, high = _range(theta, name)
    given = {"ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "alpha": alpha, "omega": omega, **loads}
    check_inputs("peak", loads, LOADS)
    wanted = request((name, slope), given, branch, accuracy)
    parameters = [n for n in wanted.inputs if n != "theta"]
    if "omega0" not in parameters and omega0 is None and omega is None:
        given["omega0"] = 0.0  # which only the status uses
    if "mu" not in parameters:
        given["mu"] = None  # what friction does matters to forces only
    told = request((name, slope, "status"), given, branch, accuracy).inputs
    needs = [*parameters, *(n for n in told if n not in (*parameters, "theta"))]
    arrays = {n: as_array(n, given.get(n), needs, (name,)) for n in needs}
    shape = broadcast_shape(arrays)
    columns = {n: np.broadcast_to(a, shape).reshape(-1) for n, a in arrays.items()}
    count = int(np.prod(shape))
    parts = []
    for start in range(0, count, BLOCK):
        block = {n: column[start : start + BLOCK] for n, column in columns.items()}
        designs = Designs(block, branch, wanted.accuracy, (low, high), tuple(parameters))
        parts.append(_peaks(name, slope, kind, designs))
    return _shaped(parts, shape, parameters)


def _range(theta: Any, name: str) -> tuple[float, float]:
    """The ends of the range of crank angles."""
    try:
        first, last = theta
    except (TypeError, ValueError):
        raise ValueError(f"theta = {theta!r}: a range (lower end, upper end) is wanted") from None
    low, high = (as_number("theta", end, ("theta",), (name,)) for end in (first, last))
    if low is None or high is None or low > high:
        raise ValueError(f"theta = ({first}, {last}): two angles, the lower one first")
    return low, high


def _slope_name(name: str, state: bool) -> str:
    """The derivative by theta of a name; ValueError where there is none."""
    quantity(name, state)
    slope = sensitivity(name, "theta")
    try:
        quantity(slope, state)
    except ValueError:
        raise ValueError(f"peak of {name}: its derivative by theta is not derived") from None
    return slope


# ---- one block of designs -----------------------------------------------------------------------


def _peaks(name: str, slope: str, kind: str, designs: Designs) -> dict[str, Any]:
    rows = np.arange(next(iter(designs.columns.values())).size)
    nodes, ends = sweep(designs)
    swept = values_at((name, slope, "status"), designs, np.repeat(rows, nodes.shape[1]), nodes.reshape(-1))
    value, rate, status = (swept[n].reshape(nodes.shape) for n in (name, slope, "status"))
    candidate_rows, candidates = _refined(slope, designs, nodes, rate)
    # Every node counts as well: the ends of the range and of arcs are among them.
    brink_rows, brinks, codes = _brinks(designs, nodes, status)
    candidate_rows, candidates = np.append(candidate_rows, brink_rows), np.append(candidates, brinks)
    at_roots = values_at((name,), designs, candidate_rows, candidates)[name]
    best_value, best_theta = _best(kind, value, nodes, candidate_rows, at_roots, candidates)
    result: dict[str, Any] = {"value": best_value, "theta": best_theta, "status": _status(status)}
    _mark_limits(kind, result, value, nodes, ends)
    turns = _turns(slope, designs, result, rate)
    turns[brink_rows[result["theta"][brink_rows] == brinks]] = True
    jams = brink_rows[(result["theta"][brink_rows] == brinks) & (codes == JAMS)]
    result["value"][jams] = np.copysign(np.inf, result["value"][jams])
    result["status"][turns & (result["status"] == 0)] = 2
    result["theta"] = np.where(np.isnan(result["value"]), np.nan, result["theta"])
    result["gradient"] = _gradient(name, kind, designs, result, turns)
    if kind == "absmax":
        result["value"] = np.abs(result["value"])
    return result


# ---- refinement ---------------------------------------------------------------------------------


def _refined(slope: str, designs: Designs, nodes: Array, rate: Array) -> tuple[NDArray[np.intp], Array]:
    """The angles at which the derivative changes sign, each with the row of its design."""
    with np.errstate(invalid="ignore"):
        change = np.sign(rate[:, :-1]) * np.sign(rate[:, 1:]) < 0
    rows, columns = np.nonzero(change)
    a, b = nodes[rows, columns], nodes[rows, columns + 1]
    fa, fb = rate[rows, columns], rate[rows, columns + 1]
    return rows, _roots(lambda theta: values_at((slope,), designs, rows, theta)[slope], a, b, fa, fb)


def _roots(function: Any, a: Array, b: Array, fa: Array, fb: Array) -> Array:
    """The root in each bracket, by Chandrupatla's method (inverse quadratic steps, else halving)."""
    c, fc = a.copy(), fa.copy()
    fraction = np.full(a.shape, 0.5)
    for _ in range(STEPS):
        if not a.size:
            break
        theta = a + fraction * (b - a)
        value = function(theta)
        same = np.sign(value) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = theta, value
        best = np.where(np.abs(fa) < np.abs(fb), a, b)
        tolerance = 2.0 * np.finfo(float).eps * np.abs(best)
        width = np.abs(b - a)
        if bool(np.all((width <= tolerance) | (fa == 0.0) | ~np.isfinite(fa))):
            break
        fraction = _next_fraction(a, b, c, fa, fb, fc, 0.5 * tolerance / np.maximum(width, tolerance))
    return np.where(np.abs(fa) < np.abs(fb), a, b)


def _next_fraction(a: Array, b: Array, c: Array, fa: Array, fb: Array, fc: Array, least: Array) -> Array:
    with np.errstate(all="ignore"):
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        quadratic = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        step = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    step = np.where(quadratic & np.isfinite(step), step, 0.5)
    return np.clip(step, least, 1.0 - least)


# ---- choosing -----------------------------------------------------------------------------------


def _score(kind: str, value: Array) -> Array:
    """What is to be made as large as possible; NaN never wins."""
    score = {"absmax": np.abs(value), "max": value, "min": -value}[kind]
    return np.where(np.isnan(score), -np.inf, score)


def _best(
    kind: str, value: Array, nodes: Array, rows: NDArray[np.intp], at_roots: Array, roots: Array
) -> tuple[Array, Array]:
    """The best of the nodes and the refined candidates of each design: its value and angle."""
    every = np.arange(len(value))
    column = np.argmax(_score(kind, value), axis=1)
    best_value, best_theta = value[every, column].copy(), nodes[every, column].copy()
    score = _score(kind, at_roots)
    best_root = np.full(len(value), -np.inf)
    np.maximum.at(best_root, rows, score)
    # Of roots that share the best value but for rounding, the one at the smallest angle.
    shares = np.flatnonzero(score >= best_root[rows] - 1e-14 * np.abs(best_root[rows]))
    order = shares[np.argsort(-roots[shares], kind="stable")]  # the smallest angle is written last
    winner = np.full(len(value), -1)
    winner[rows[order]] = order
    known = winner >= 0
    better = np.zeros(len(value), bool)
    # An extremum that a node happens to hit counts as refined: it has the same value.
    nearly = _score(kind, best_value[known])
    better[known] = score[winner[known]] >= nearly - 1e-14 * np.abs(nearly)
    best_value[better], best_theta[better] = at_roots[winner[better]], roots[winner[better]]
    return best_value, best_theta


def _status(status: NDArray[np.int8]) -> NDArray[np.int8]:
    """What friction does at some of the angles; else 0 where any is ok, else what is wrong at the first."""
    usable = ((status == 0) | (status == 2)).any(axis=1)
    found = np.where(usable, np.int8(0), status[:, 0]).astype(np.int8)
    for code in (TWO_BALANCES, JAMS):
        found[(status == code).any(axis=1)] = code
    return found


def _mark_limits(
    kind: str, result: dict[str, Any], value: Array, nodes: Array, ends: list[tuple[int, float]]
) -> None:
    """An extremum at a limit angle has status 2; what has no bound there is infinite."""
    for row, end in ends:
        usable = np.isfinite(value[row])
        if not usable.any():
            continue
        near = np.flatnonzero(usable)[np.argmin(np.abs(nodes[row, usable] - end))]
        if abs(nodes[row, near] - end) > 1e-6:
            continue
        bounded = not _grows(nodes[row, usable], value[row, usable], end, value[row, near])
        at_end = result["theta"][row] == nodes[row, near]
        grows = not bounded and _score(kind, value[row, near]) >= _score(kind, result["value"][row])
        if at_end or grows:
            result["status"][row] = 2
            result["theta"][row] = end
            if not bounded:
                result["value"][row] = np.copysign(np.inf, value[row, near])


def _grows(nodes: Array, value: Array, end: float, last: float) -> bool:
    """Whether a quantity grows without bound towards an end: as the distance to a negative power."""
    away = np.abs(nodes - end)
    farther = value[np.argmin(np.abs(np.log2(np.maximum(away, 1e-16)) + 20.0))]  # 2^-20 away
    return bool(abs(last) > 16.0 * abs(farther))


def _brinks(
    designs: Designs, nodes: Array, status: NDArray[np.int8]
) -> tuple[NDArray[np.intp], Array, NDArray[np.int8]]:
    """The last angles before friction leaves no balance of forces, or two: rows, angles and status beyond."""
    fine, bad = status == 0, (status == JAMS) | (status == TWO_BALANCES)
    rows, columns = np.nonzero((fine[:, :-1] & bad[:, 1:]) | (bad[:, :-1] & fine[:, 1:]))
    forth = fine[rows, columns]
    inside = np.where(forth, nodes[rows, columns], nodes[rows, columns + 1])
    beyond = np.where(forth, nodes[rows, columns + 1], nodes[rows, columns])
    for _ in range(60 if rows.size else 0):
        middle = 0.5 * (inside + beyond)
        balanced = values_at(("status",), designs, rows, middle)["status"] == 0
        inside, beyond = np.where(balanced, middle, inside), np.where(balanced, beyond, middle)
    return rows, inside, values_at(("status",), designs, rows, beyond)["status"]


def _turns(slope: str, designs: Designs, result: Mapping[str, Any], rate: Array) -> NDArray[np.bool_]:
    """Which extrema are at a kink or jump, whose angle moves with the design."""
    if not designs.rubs:
        return np.zeros(len(rate), np.bool_)
    low, high = designs.theta
    rows = np.arange(len(rate))
    theta = result["theta"]
    left = np.abs(values_at((slope,), designs, rows, np.nan_to_num(theta))[slope])
    steep = np.sort(np.where(np.isfinite(rate), np.abs(rate), np.inf), axis=1)
    usual = steep[rows, np.isfinite(steep).sum(axis=1) // 2]
    turns: NDArray[np.bool_] = (left > SMOOTH * usual) & (theta != low) & (theta != high)
    return turns


def _gradient(
    name: str, kind: str, designs: Designs, result: Mapping[str, Any], turns: NDArray[np.bool_]
) -> dict[str, Array]:
    """The partial derivatives at the extreme angle."""
    parameters = designs.parameters
    names = tuple(sensitivity(name, p) for p in parameters)
    rows = np.arange(len(result["theta"]))
    found = values_at(names, designs, rows, np.nan_to_num(result["theta"]))
    sign = np.sign(result["value"]) if kind == "absmax" else 1.0
    usable = np.isin(result["status"], (0, JAMS, TWO_BALANCES)) & ~turns & np.isfinite(result["value"])
    with np.errstate(invalid="ignore"):
        return {p: np.where(usable, sign * found[n], np.nan) for p, n in zip(parameters, names, strict=True)}


def _shaped(parts: list[dict[str, Any]], shape: tuple[int, ...], parameters: list[str]) -> dict[str, Any]:
    """The blocks put together in the shape of the designs; plain numbers for one design."""

    def joined(arrays: list[Any], dtype: Any = np.float64) -> Any:
        array = np.concatenate(arrays) if arrays else np.empty(0, dtype)
        return array.reshape(shape) if shape else array[0].item()

    names = list(parts[0]["gradient"]) if parts else parameters
    return {
        "value": joined([part["value"] for part in parts]),
        "theta": joined([part["theta"] for part in parts]),
        "gradient": {n: joined([part["gradient"][n] for part in parts]) for n in names},
        "status": joined([part["status"] for part in parts], np.int8),
    }
