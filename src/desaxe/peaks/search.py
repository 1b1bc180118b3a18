"""The search for the extreme value of each design, in arrays; plain loops in written modules.

bounds      value and slope at the nodes bound how good an extremum between two of them can be
candidates  what may beat the best node is looked at again at three angles in between; towards an end that is
            itself an extremum, or nearly, they are graded: two maxima close to each other have one between
roots       Newton's method on the slope, in brackets
choice      the best of the refined extrema and the nodes, ends of the range among them; of extrema that are
            equal but for rounding the first

A NaN wins no comparison: angles at which a quantity has no value take no part.

kind    0 the largest magnitude, 1 the largest, 2 the smallest value
curve   curve(theta, block): value and slope at angles that broadcast with the rows of a block of designs
finish  finish(theta, block): value, slope and gradient at an angle of each design, a row each
block   the inputs of the designs, a row each
nodes   ascending angles: one column for all designs, or one for each
"""

from typing import Any

from numpy import (
    arange,
    argsort,
    array,
    bincount,
    diff,
    empty,
    flatnonzero,
    fmax,
    full,
    inf,
    isnan,
    nan,
    nanargmax,
    nonzero,
    searchsorted,
    vstack,
    where,
    zeros,
)

from .steps import first_guess, newton_step, upper_bounds

TIE = 1e-14  # values that differ by less are equal
FLAT = 0.02  # an end that much flatter than the other may be an extremum itself, with others next to it
MOST_STEPS = 100  # a bracket of any width is down to its last bit before
EVEN = array([[0.25], [0.5], [0.75]])
LOW_END = array([[1 / 512], [1 / 32], [1 / 4]])  # graded towards the low end
HIGH_END = array([[3 / 4], [31 / 32], [511 / 512]])


def search_block(curve: Any, finish: Any, kind: int, nodes: Any, block: Any) -> tuple[Any, Any]:
    """The angle of the extreme value of each design, and what `finish` has there.

    The gradient is that of the magnitude for kind 0.
    """
    value, slope = curve(nodes, block)
    top = score_of(kind, value)
    best = fmax.reduce(top, axis=0)
    best[isnan(best)] = -inf
    upper = upper_bounds(diff(nodes, axis=0), value[:-1], value[1:], top[:-1], top[1:], slope[:-1], slope[1:])
    first = flatnonzero(upper >= best)
    theta = full(best.size, nan)
    if first.size:
        owners, *brackets = brackets_in(curve, nodes, divmod(first, best.size), slope, block)
        angles, values = roots_in(curve, brackets, block[:, owners])
        new = score_of(kind, values)
        fmax.at(best, owners, new)
        good = flatnonzero(new >= best[owners] - TIE * abs(best[owners]))[::-1]
        theta[owners[good]] = angles[good]  # of equal ones the first, which is written last
    at_node = flatnonzero(isnan(theta) & (best > -inf))
    if at_node.size:
        number = nanargmax(top[:, at_node], axis=0)
        theta[at_node] = nodes[number, at_node if nodes.shape[1] > 1 else 0]
    out = finish(theta, block)
    if kind == 0:
        out[2:] *= where(out[0] < 0.0, -1.0, 1.0)
    return theta, out


def score_of(kind: int, value: Any) -> Any:
    """The objective, to be maximised."""
    return abs(value) if kind == 0 else value if kind == 1 else -value


def brackets_in(curve: Any, nodes: Any, places: Any, slope: Any, block: Any) -> tuple[Any, ...]:
    """The brackets inside of some intervals in which the slope changes its sign.

    places  the numbers of the intervals' first nodes, and designs

    Designs; low and high ends, slopes there; which of four even brackets (-1: none), all five slopes.
    """
    j, i = places
    column = i if nodes.shape[1] > 1 else 0
    low, high, a, b = nodes[j, column], nodes[j + 1, column], slope[j, i], slope[j + 1, i]
    even = ~((abs(a) < FLAT * abs(b)) | (abs(b) < FLAT * abs(a)))
    inner = low + where(even, EVEN, where(abs(a) < abs(b), LOW_END, HIGH_END)) * (high - low)
    _, slopes = curve(inner, block[:, i])
    angles, known = vstack([low, inner, high]), vstack([a, slopes, b])
    rising = known > 0.0
    changes = (rising[:-1] != rising[1:]) & ~isnan(known[:-1] + known[1:])
    c, k = nonzero(changes.T)
    number = where(even[c], k, -1.0)
    return i[c], angles[k, c], angles[k + 1, c], known[k, c], known[k + 1, c], number, known[:, c]


def roots_in(curve: Any, brackets: Any, block: Any) -> tuple[Any, Any]:
    """The roots of the slope in brackets, and the values there; `block` has the design of each."""
    low, high, before, after, number, slopes = brackets
    width = high - low
    x, bend = first_guess(number, low, width, before, after, *slopes)
    size, sign = width, where(before > 0.0, 1.0, -1.0)
    last_x = last_slope = full(x.size, nan)
    angles, values = empty(x.size), empty(x.size)
    rows, end = arange(x.size), zeros(x.size)
    for _ in range(MOST_STEPS):
        value, slope = curve(x, block)
        angles[rows], values[rows] = x, value
        new, low, high, size, bend, new_end = newton_step(
            x, slope, low, high, sign, width, size, bend, last_x, last_slope
        )
        state: Any = new, low, high, sign, width, size, bend, x, slope, new_end
        on = flatnonzero((end == 0.0) & (new_end < 2.0))
        if not on.size:
            break
        if on.size < rows.size:
            rows, block = rows[on], block[:, on]
            state = [row[on] for row in state]
        x, low, high, sign, width, size, bend, last_x, last_slope, end = state
    return angles, values


def sign_changes_of(curve: Any, nodes: Any, block: Any) -> Any:
    """The angles at which values change their sign between nodes: a row a design, NaN in empty places."""

    def values(theta: Any, own: Any) -> Any:
        return curve(theta, own)[::-1]

    value, _ = curve(nodes, block)
    rising, size = value > 0.0, value.shape[1]
    first = flatnonzero(rising[:-1] != rising[1:])
    owners, *brackets = brackets_in(values, nodes, divmod(first, size), value, block)
    angles, _ = roots_in(values, brackets, block[:, owners])
    order = argsort(owners, kind="stable")
    owners = owners[order]
    table = full((size, bincount(owners, minlength=1).max()), nan)
    table[owners, arange(owners.size) - searchsorted(owners, owners)] = angles[order]
    return table
