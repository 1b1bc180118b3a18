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

The straight lines are texts that the compiler reads:

BOUND  at most how good an extremum between two nodes can be, from values, scores and slopes a and b at both;
       NaN where there can be none: an extremum is where the slope changes its sign, or where the cubic
       through both values and slopes nearly has one
GUESS  where the quartic through five slopes g0 to g4 is 0, in the bracket `number` of four even ones (in any
       that is not even, -1, the secant's root), and its derivative there
STEP   of Newton's method on the slope, whose derivative is that of the quartic at first, then the one that
       the last two slopes tell; the bracket is halved where a step would leave it, does not shrink, or goes
       to an extremum of the other sort. `end` is 1 where the root is known but for its last bit, 2 where it
       is at `x` itself
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

from ..compiler.text import read_function
from .programs import ProgramFunction, compiled

TIE = 1e-14  # values that differ by less are equal
FLAT = 0.02  # an end that much flatter than the other may be an extremum itself, with others next to it
MOST_STEPS = 100  # a bracket of any width is down to its last bit before
EVEN = array([[0.25], [0.5], [0.75]])
LOW_END = array([[1 / 512], [1 / 32], [1 / 4]])  # graded towards the low end
HIGH_END = array([[3 / 4], [31 / 32], [511 / 512]])
BOUND = """
def bound(width, value_a, value_b, top_a, top_b, a, b):
    middle = 1.5 * (value_b - value_a) / width - 0.25 * (a + b)  # slope of the cubic
    size_a = fabs(a)
    size_b = fabs(b)
    more = size_a if size_b < size_a else size_b
    less = size_b if size_b < size_a else size_a
    rising = 0.0 < a
    falls = not (0.0 < b)
    changes = falls if rising else 0.0 < b
    along = middle if rising else -middle
    dips = along < 0.25 * more  # half is usual, less means that the slope may vanish in between
    flat = less < 0.02 * more  # an end may be an extremum itself, with others next to it
    steepest = more if fabs(middle) < more else fabs(middle)
    top = (top_a if top_b < top_a else top_b) + width * steepest
    some = ((changes or dips) or flat) and 0.0 < width
    upper = top if some else nan
    return upper
"""
GUESS = """
def guess(number, low, width, before, after, g0, g1, g2, g3, g4):
    a1 = g1 - g0
    b1 = g2 - g1
    b2 = g3 - g2
    a2 = 0.5 * (b1 - a1)
    c2 = 0.5 * (b2 - b1)
    a3 = (c2 - a2) * 0.3333333333333333
    a4 = (0.5 * (g4 - g3 - b2) - c2 - (c2 - a2)) * 0.08333333333333333
    k1 = a1 - a2 + 2.0 * a3 - 6.0 * a4
    k2 = a2 - 3.0 * a3 + 11.0 * a4
    k3 = a3 - 6.0 * a4
    part = before / (before - after)
    s0 = number + part
    bend0 = k1 + s0 * (2.0 * k2 + s0 * (3.0 * k3 + s0 * (4.0 * a4)))
    s1 = s0 - (g0 + s0 * (k1 + s0 * (k2 + s0 * (k3 + s0 * a4)))) / bend0
    bend1 = k1 + s1 * (2.0 * k2 + s1 * (3.0 * k3 + s1 * (4.0 * a4)))
    s2 = s1 - (g0 + s1 * (k1 + s1 * (k2 + s1 * (k3 + s1 * a4)))) / bend1
    bend_there = k1 + s2 * (2.0 * k2 + s2 * (3.0 * k3 + s2 * (4.0 * a4)))
    s = s2 - (g0 + s2 * (k1 + s2 * (k2 + s2 * (k3 + s2 * a4)))) / bend_there
    inside = (0.0 <= number and number <= s) and s <= number + 1.0
    theta = low + (s - number if inside else part) * width
    bend = (bend_there if inside else after - before) / width
    return theta, bend
"""
STEP = """
def step(x, slope, low, high, sign, width, size, bend, last_x, last_slope):
    up = 0.0 < slope * sign
    lower = x if up else low
    upper = high if up else x
    secant = (slope - last_slope) / (x - last_x)
    slant = secant if fabs(secant) < inf else bend
    change = -slope / slant
    target = x + change
    change_size = fabs(change)
    good = (lower <= target and target <= upper) and (slant * sign < 0.0 and change_size <= 0.5 * size)
    room = 2.220446049250313e-16 * (fabs(target) + width)
    square = change_size * size <= room * width and size < width
    near = good and (change_size <= 4.0 * room or square)
    span = upper - lower
    ends = fabs(lower) + fabs(upper)
    closed = span <= 2.220446049250313e-16 * ends or slope == 0.0
    theta = x if closed else (target if good else 0.5 * (lower + upper))
    new_size = change_size if good else span
    end = 2.0 if closed else (1.0 if near else 0.0)
    return theta, lower, upper, new_size, slant, end
"""


def search_block(curve: Any, finish: Any, kind: int, nodes: Any, block: Any) -> tuple[Any, Any]:
    """The angle of the extreme value of each design, and what `finish` has there.

    The gradient is that of the magnitude for kind 0.
    """
    value, slope = curve(nodes, block)
    top = score_of(kind, value)
    best = fmax.reduce(top, axis=0)
    best[isnan(best)] = -inf
    ends = value[:-1], value[1:], top[:-1], top[1:], slope[:-1], slope[1:]
    upper = _lines(BOUND, diff(nodes, axis=0), *ends)
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


def _lines(text: str, *arrays: Any) -> Any:
    """The results of a text of straight lines, for arrays that broadcast."""
    return compiled(_of_text, text).call(*arrays)


def _of_text(text: str) -> ProgramFunction:
    program = read_function(text)
    return ProgramFunction(program, program.inputs)


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
    x, bend = _lines(GUESS, number, low, width, before, after, *slopes)
    size, sign = width, where(before > 0.0, 1.0, -1.0)
    last_x = last_slope = full(x.size, nan)
    angles, values = empty(x.size), empty(x.size)
    rows, end = arange(x.size), zeros(x.size)
    for _ in range(MOST_STEPS):
        value, slope = curve(x, block)
        angles[rows], values[rows] = x, value
        new, low, high, size, bend, new_end = _lines(
            STEP, x, slope, low, high, sign, width, size, bend, last_x, last_slope
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
