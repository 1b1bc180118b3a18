"""The search for the extreme value of each design, in arrays.

bounds      value and slope at the nodes bound how good an extremum between two of them can be (`steps.BOUND`)
candidates  what may beat the best node is looked at again at three angles in between; towards an end that is
            itself an extremum, or nearly, they are graded: two maxima close to each other have one between
roots       Newton's method on the slope, in brackets (`steps.GUESS`, `steps.STEP`)
choice      the best of the refined extrema and the nodes, ends of the range among them; of extrema that are
            equal but for rounding the first

A NaN wins no comparison: angles at which a quantity has no value take no part.

kind    0 the largest magnitude, 1 the largest, 2 the smallest value
block   the inputs of the designs, a row each
"""

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .nodes import Array
from .steps import BOUND, GUESS, STEP, compiled

TIE = 1e-14  # values that differ by less are equal
FLAT = 0.02  # an end that much flatter than the other may be an extremum itself, with others next to it
STEPS = 100  # a bracket of any width is down to its last bit before
EVEN = np.array([[0.25], [0.5], [0.75]])
LOW_END = np.array([[1 / 512], [1 / 32], [1 / 4]])  # graded towards the low end
HIGH_END = 1.0 - LOW_END[::-1]


class Curve(Protocol):
    """A quantity over the crank angle, of the designs of a block."""

    def curve(self, theta: Array, block: Array) -> tuple[Array, Array]:
        """Value and slope at angles that broadcast with the rows of the block."""

    def finish(self, theta: Array, block: Array) -> Array:
        """Value, slope and gradient at an angle of each design: a row each."""


class SlopeBrackets(NamedTuple):
    """Brackets in which the slope changes its sign: designs, ends, slopes at both, and for a first guess."""

    owners: NDArray[np.intp]
    low: Array
    high: Array
    before: Array
    after: Array
    number: Array
    slopes: Array


def search(quantity: Curve, kind: int, nodes: Array, block: Array) -> tuple[Array, Array]:
    """The angle of the extreme value of each design of a block, and what `finish` has there.

    The gradient is that of the magnitude for kind 0.

    nodes   ascending angles: one column for all designs, or one for each
    """
    value, slope = quantity.curve(nodes, block)
    top = score(kind, value)
    best = np.fmax.reduce(top, axis=0)
    best[np.isnan(best)] = -np.inf
    upper = compiled(BOUND).call(
        np.diff(nodes, axis=0), value[:-1], value[1:], top[:-1], top[1:], slope[:-1], slope[1:]
    )
    first = np.flatnonzero(upper >= best)
    theta = np.full(best.size, np.nan)
    if first.size:
        found = brackets(quantity, nodes, divmod(first, best.size), slope, block)
        owners = found.owners
        angles, values = refined(quantity, found, block[:, owners])
        new = score(kind, values)
        np.fmax.at(best, owners, new)
        good = np.flatnonzero(new >= best[owners] - TIE * np.abs(best[owners]))[::-1]
        theta[owners[good]] = angles[good]  # of equal ones the first, which is written last
    at_node = np.flatnonzero(np.isnan(theta) & (best > -np.inf))
    if at_node.size:
        number = np.nanargmax(top[:, at_node], axis=0)
        theta[at_node] = nodes[number, _columns(nodes, at_node)]
    out = quantity.finish(theta, block)
    if kind == 0:
        out[2:] *= np.where(out[0] < 0.0, -1.0, 1.0)
    return theta, out


def score(kind: int, value: Array) -> Array:
    """The objective, to be maximised."""
    return np.abs(value) if kind == 0 else value if kind == 1 else -value


def _columns(nodes: Array, designs: NDArray[np.intp]) -> Any:
    """The columns of the nodes of designs."""
    return designs if nodes.shape[1] > 1 else 0


class _Values(NamedTuple):
    """The values of a quantity in the place of its slopes."""

    quantity: Curve

    def curve(self, theta: Array, block: Array) -> tuple[Array, Array]:
        """Slope and value."""
        value, slope = self.quantity.curve(theta, block)
        return slope, value


def zeros(quantity: Curve, nodes: Array, block: Array) -> Array:
    """The angles at which values change their sign between nodes: a row a design, NaN in empty places."""
    value, _ = quantity.curve(nodes, block)
    rising = value > 0.0
    first = np.flatnonzero(rising[:-1] != rising[1:])
    found = brackets(_Values(quantity), nodes, divmod(first, value.shape[1]), value, block)
    angles, _ = refined(_Values(quantity), found, block[:, found.owners])
    order = np.argsort(found.owners, kind="stable")
    owners = found.owners[order]
    table = np.full((value.shape[1], int(np.bincount(owners, minlength=1).max())), np.nan)
    table[owners, np.arange(owners.size) - np.searchsorted(owners, owners)] = angles[order]
    return table


def brackets(
    quantity: Curve | _Values, nodes: Array, places: Any, slope: Array, block: Array
) -> SlopeBrackets:
    """The brackets inside of intervals: `places` are the numbers of their first nodes, and designs."""
    j, i = places
    column = _columns(nodes, i)
    low, high, a, b = nodes[j, column], nodes[j + 1, column], slope[j, i], slope[j + 1, i]
    size_a, size_b = np.abs(a), np.abs(b)
    even = ~((size_a < FLAT * size_b) | (size_b < FLAT * size_a))
    inner = low + np.where(even, EVEN, np.where(size_a < size_b, LOW_END, HIGH_END)) * (high - low)
    _, slopes = quantity.curve(inner, block[:, i])
    angles, known = np.vstack([low, inner, high]), np.vstack([a, slopes, b])
    rising = known > 0.0
    changes = (rising[:-1] != rising[1:]) & ~np.isnan(known[:-1] + known[1:])
    c, k = np.nonzero(changes.T)
    number = np.where(even[c], k, -1.0)
    return SlopeBrackets(
        i[c], angles[k, c], angles[k + 1, c], known[k, c], known[k + 1, c], number, known[:, c]
    )


def refined(quantity: Curve | _Values, found: SlopeBrackets, block: Array) -> tuple[Array, Array]:
    """The roots of the slope in brackets, and the values there; `block` has the design of each."""
    _, low, high, before, after, number, slopes = found
    width = high - low
    x, bend = compiled(GUESS).call(number, low, width, before, after, *slopes)
    size, sign = width, np.where(before > 0.0, 1.0, -1.0)
    last_x = last_slope = np.full(x.size, np.nan)
    angles, values = np.empty(x.size), np.empty(x.size)
    rows, end = np.arange(x.size), np.zeros(x.size)
    for _ in range(STEPS):
        value, slope = quantity.curve(x, block)
        angles[rows], values[rows] = x, value
        new, low, high, size, bend, new_end = compiled(STEP).call(
            x, slope, low, high, sign, width, size, bend, last_x, last_slope
        )
        state: Any = new, low, high, sign, width, size, bend, x, slope, new_end
        on = np.flatnonzero((end == 0.0) & (new_end < 2.0))
        if not on.size:
            break
        if on.size < rows.size:
            rows, block = rows[on], block[:, on]
            state = [row[on] for row in state]
        x, low, high, sign, width, size, bend, last_x, last_slope, end = state
    return angles, values
