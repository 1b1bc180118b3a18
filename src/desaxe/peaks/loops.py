"""The search for the extreme value of each design, in plain loops, whose text stands in written modules.

It stands in a module with the functions `sweep`, `points` and `finish`, which are written from the
Program of the quantity at hand. Designs of one group share their nodes; they go through in
blocks whose arrays stay in the cache, and every loop over a block is one that vectorises:

sweep     value and slope at the nodes
bound     between two nodes, at most how good an extremum can be, if there can be one: where the slope
          changes sign, or where the cubic through both values and slopes nearly has an extremum
divide    what may beat the best node is looked at again at three angles in between; towards an end that is
          itself an extremum, or nearly, they are graded: two maxima close to each other have one between
refine    Newton's method on the slope, whose derivative is that of the quartic through five slopes at first,
          then the secant; the bracket is halved where a step would leave it, does not shrink, or goes to
          an extremum of the other sort
choose    the best of the refined extrema and the nodes, ends of the range among them; of extrema that are
          equal but for rounding the first

A NaN wins no comparison: angles at which a quantity has no value take no part.

columns   the inputs of the designs, a row each; order has the designs group by group
tables    those of loads (`tables`); none for most searches
kind      0 the largest magnitude, 1 the largest, 2 the smallest value
out       rows: value, derivative by theta, gradient (of the magnitude for kind 0)
"""

from __future__ import annotations

from math import fabs, inf, nan
from typing import TYPE_CHECKING

from numpy import empty, int64, uint64

if TYPE_CHECKING:
    from typing import Any

    WORK = 1  # rows of what `sweep` keeps of each design

    def sweep(count: Any, nodes: Any, block: Any, tables: Any, work: Any, value: Any, slope: Any) -> None:
        """The quantity and its derivative by theta at every node, for `count` designs."""

    def points(rows: Any, count: Any, theta: Any, block: Any, tables: Any, value: Any, slope: Any) -> None:
        """The quantity and its derivative by theta, each at its own angle."""

    def finish(count: Any, theta: Any, block: Any, tables: Any, out: Any) -> None:
        """The quantity, its derivative by theta and its gradient."""


BLOCK = 128  # designs
TIE = 1e-14  # values that differ by less are equal
DIP = 0.25  # of the steeper end: half is usual, less means that the slope may vanish in between
FLAT = 0.02  # an end that much flatter than the other may be an extremum itself, with others next to it
EPS = 2.220446049250313e-16
# Rows of a root: its bracket, the slope's sign at the low end, the bracket's first width, how far it is, the
# slope's derivative, angle and slope of the step before; and what it begins with.
LOW, HIGH, THETA, SIGN, WIDTH, DONE, LAST, BEND, PREVIOUS, SLOPE = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
BEFORE, AFTER, FIRST, FIFTH, ROWS = 10, 11, 12, 16, 17
STEPS = 100  # a bracket of any width is down to its last bit before


def score(kind: int, value: float) -> float:
    """The objective: |value|, value or -value, to be maximised."""
    return fabs(value) if kind == 0 else (value if kind == 1 else -value)


def gather(count: Any, chosen: Any, columns: Any, block: Any) -> None:
    """The first inputs of chosen designs, as many as there is room for, next to each other."""
    for p in range(block.shape[0]):
        source, target = columns[p], block[p]
        for i in range(count):
            target[i] = source[chosen[i]]


def own_nodes(tables: Any) -> int:
    """The number of nodes that each design has of its own."""
    return 0


def nodes_of(count: Any, shared: Any, block: Any, tables: Any) -> Any:
    """The nodes of designs: those of their group."""
    return shared


def one(here: Any, i: Any) -> Any:
    """The node of a design, of those that share it."""
    return here


def inverse(width: float) -> float:
    """1 / width; 0 where nodes coincide."""
    return 1.0 / width if width > 0.0 else 0.0


def highest(
    kind: int, width: float, per_width: float, value_a: float, value_b: float, a: float, b: float
) -> float:
    """At most how good an extremum between two nodes with slopes a and b can be; NaN where none can be."""
    middle = 1.5 * per_width * (value_b - value_a) - 0.25 * (a + b)  # slope of the cubic
    rising = a > 0.0
    more = fabs(a) if fabs(a) > fabs(b) else fabs(b)
    dips = (middle if rising else -middle) < DIP * more
    steepest = fabs(middle) if fabs(middle) > more else more
    top_a, top_b = score(kind, value_a), score(kind, value_b)
    top = (top_a if top_a > top_b else top_b) + width * steepest
    less = fabs(a) if fabs(a) < fabs(b) else fabs(b)
    return top if (rising != (b > 0.0)) | dips | (less < FLAT * more) else nan


def bound(
    kind: int, count: Any, nodes: Any, value: Any, slope: Any, best: Any, theta: Any, upper: Any
) -> None:
    """The best node of each design, and the bounds between nodes: NaN where no extremum is."""
    for i in range(uint64(count)):
        best[i], theta[i] = -inf, nan
    for j in range(nodes.shape[0]):
        here, row = nodes[j], value[j]
        for i in range(uint64(count)):
            new, place, before = score(kind, row[i]), one(here, i), theta[i]
            better = new > best[i]
            best[i] = new if better else best[i]
            theta[i] = place if better else before
    for j in range(1, nodes.shape[0]):
        left, right, row = nodes[j - 1], nodes[j], upper[j]
        value_a, value_b, slope_a, slope_b = value[j - 1], value[j], slope[j - 1], slope[j]
        for i in range(uint64(count)):
            width = one(right, i) - one(left, i)
            top = highest(kind, width, inverse(width), value_a[i], value_b[i], slope_a[i], slope_b[i])
            row[i] = top if width > 0.0 else nan


def candidates(count: Any, nodes: Any, upper: Any, best: Any, places: Any, owners: Any) -> int:
    """Collect the intervals whose bound exceeds the best node: index and design; return their number."""
    found = 0
    for j in range(1, nodes.shape[0]):
        row = upper[j]
        for i in range(count):
            places[found], owners[found] = j - 1, i
            found += 1 if row[i] >= best[i] else 0
    return found


def interior(count: Any, nodes: Any, places: Any, owners: Any, slope: Any, theta: Any, even: Any) -> None:
    """Three angles inside of each interval: even, or graded towards an end that is flat."""
    for c in range(count):
        j, i = places[c], owners[c]
        low = one(nodes[j], i)
        width = one(nodes[j + 1], i) - low
        a, b = fabs(slope[j, i]), fabs(slope[j + 1, i])
        even[c] = 0 if a < FLAT * b or b < FLAT * a else 1
        if even[c] == 1:
            first, second, third = 0.25, 0.5, 0.75
        elif a < b:
            first, second, third = 1.0 / 512.0, 1.0 / 32.0, 0.25
        else:
            first, second, third = 0.75, 31.0 / 32.0, 511.0 / 512.0
        theta[0, c], theta[1, c], theta[2, c] = low + first * width, low + second * width, low + third * width


def brackets(
    count: Any, nodes: Any, places: Any, owners: Any, slope: Any, thetas: Any, slopes: Any, even: Any,
    roots: Any, whose: Any,
) -> int:  # fmt: skip
    """The brackets in which the slope changes sign: a column of `roots` each, rows LOW to FIFTH."""
    found = 0
    for c in range(count):
        j, i = places[c], owners[c]
        low, before, last = one(nodes[j], i), slope[j, i], slope[j + 1, i]
        for k in range(4):
            high = thetas[k, c] if k < 3 else one(nodes[j + 1], i)
            after = slopes[k, c] if k < 3 else last
            if (before > 0.0) != (after > 0.0) and before == before and after == after:
                roots[LOW, found], roots[HIGH, found] = low, high
                roots[THETA, found], roots[WIDTH, found] = (k if even[c] == 1 else -1), high - low
                roots[BEFORE, found], roots[AFTER, found] = before, after
                roots[FIRST, found], roots[FIFTH, found] = slope[j, i], last
                for m in range(3):
                    roots[FIRST + 1 + m, found] = slopes[m, c]
                whose[found] = i
                found += 1
            low, before = high, after
    return found


def quartic(k0: float, k1: float, k2: float, k3: float, k4: float, s: float) -> float:
    """k0 + k1 s + ... + k4 s^4."""
    return k0 + s * (k1 + s * (k2 + s * (k3 + s * k4)))


def quartic_slope(k1: float, k2: float, k3: float, k4: float, s: float) -> float:
    """The derivative of the quartic."""
    return k1 + s * (2.0 * k2 + s * (3.0 * k3 + s * (4.0 * k4)))


def begin(count: Any, roots: Any) -> None:
    """The first guess: where the quartic through the five slopes is 0, and its derivative there.

    Before: THETA has the bracket's number among four even ones, or -1. After: rows SIGN to SLOPE are set.
    """
    lows, thetas, widths, befores, afters = (
        roots[LOW],
        roots[THETA],
        roots[WIDTH],
        roots[BEFORE],
        roots[AFTER],
    )
    first, second, third, fourth, fifth = (
        roots[FIRST], roots[FIRST + 1], roots[FIRST + 2], roots[FIRST + 3], roots[FIFTH],
    )  # fmt: skip
    bends = roots[BEND]
    for i in range(uint64(count)):
        g0, g1, g2, g3, g4 = first[i], second[i], third[i], fourth[i], fifth[i]
        a1, b1, b2, b3 = g1 - g0, g2 - g1, g3 - g2, g4 - g3
        a2, c2 = 0.5 * (b1 - a1), 0.5 * (b2 - b1)
        a3 = (c2 - a2) * (1.0 / 3.0)
        a4 = (0.5 * (b3 - b2) - c2 - (c2 - a2)) * (1.0 / 12.0)
        k1, k2, k3 = a1 - a2 + 2.0 * a3 - 6.0 * a4, a2 - 3.0 * a3 + 11.0 * a4, a3 - 6.0 * a4
        k, width, low, before, after = thetas[i], widths[i], lows[i], befores[i], afters[i]
        part = before / (before - after)
        s = k + part
        s -= quartic(g0, k1, k2, k3, a4, s) / quartic_slope(k1, k2, k3, a4, s)
        s -= quartic(g0, k1, k2, k3, a4, s) / quartic_slope(k1, k2, k3, a4, s)
        bend = quartic_slope(k1, k2, k3, a4, s)
        s -= quartic(g0, k1, k2, k3, a4, s) / bend
        inside = (k >= 0.0) & (k <= s) & (s <= k + 1.0)
        place, secant = s - k, after - before
        thetas[i] = low + (place if inside else part) * width
        bends[i] = (bend if inside else secant) / width
    signs, done, lasts, previous, slopes = (
        roots[SIGN], roots[DONE], roots[LAST], roots[PREVIOUS], roots[SLOPE],
    )  # fmt: skip
    for i in range(uint64(count)):
        signs[i] = 1.0 if befores[i] > 0.0 else -1.0
        lasts[i] = widths[i]
        done[i], previous[i], slopes[i] = 0.0, nan, nan


def newton(count: Any, roots: Any, slope: Any) -> int:
    """One Newton step for every unfinished root; return the number of unfinished ones.

    The slope's derivative is that of the quartic at first, then the one that the last two slopes tell.
    """
    lows, highs, theta, signs, widths = roots[LOW], roots[HIGH], roots[THETA], roots[SIGN], roots[WIDTH]
    done, last, bends, thetas, slopes = roots[DONE], roots[LAST], roots[BEND], roots[PREVIOUS], roots[SLOPE]
    for i in range(uint64(count)):
        # Everything is read before anything is chosen: a read that depends on a choice stays a branch.
        x, s, sign, width, was_done = theta[i], slope[i], signs[i], widths[i], done[i]
        low, high, bend, before = lows[i], highs[i], bends[i], last[i]
        up = s * sign > 0.0
        low, high = (x if up else low), (high if up else x)
        secant = (s - slopes[i]) / (x - thetas[i])
        bend = secant if fabs(secant) < inf else bend
        step = -s / bend
        new = x + step
        size = fabs(step)
        good = (low <= new) & (new <= high) & (bend * sign < 0.0) & (size <= 0.5 * before)
        room = EPS * (fabs(new) + width)
        near = good & ((size <= 4.0 * room) | ((size * before <= room * width) & (before < width)))
        between, span = 0.5 * (low + high), high - low
        closed = (span <= EPS * (fabs(low) + fabs(high))) | (s == 0.0)
        new = new if good else between
        theta[i] = x if closed | (was_done > 0.0) else new
        thetas[i], slopes[i], bends[i] = x, s, bend
        last[i] = size if good else span
        lows[i], highs[i] = low, high
        done[i] = 1.0 if near | closed else was_done
    left = 0
    for i in range(uint64(count)):
        left += 1 if done[i] == 0.0 else 0
    return left


def choose(
    kind: int, count: Any, roots: Any, whose: Any, value: Any, best: Any, theta: Any, taken: Any
) -> None:
    """Choose for each design the best root, if it is as good as the best node."""
    for c in range(count):
        i = whose[c]
        new = score(kind, value[c])
        best[i] = new if new > best[i] else best[i]
        taken[i] = 0
    for c in range(count):
        i = whose[c]
        if taken[i] == 0 and score(kind, value[c]) >= best[i] - TIE * fabs(best[i]):
            theta[i], taken[i] = roots[THETA, c], 1


def told(kind: int, count: Any, chosen: Any, here: Any, found: Any, theta: Any, out: Any) -> None:
    """The angles and what was found there, for the designs chosen; of |value| for kind 0."""
    for i in range(count):
        theta[chosen[i]] = here[i]
    for r in range(out.shape[0]):
        row, target = found[r], out[r]
        for i in range(count):
            turned = kind == 0 and r > 1 and found[0, i] < 0.0
            target[chosen[i]] = -row[i] if turned else row[i]


def search(
    columns: Any, order: Any, starts: Any, nodes: Any, node_starts: Any, tables: Any, kind: int, theta: Any,
    out: Any,
) -> None:  # fmt: skip
    """The extreme value of every design: its angle and what `finish` computes there."""
    inputs, results, more = columns.shape[0], out.shape[0], own_nodes(tables)
    longest, most = 1, 1
    for g in range(starts.size - 1):
        longest = max(longest, node_starts[g + 1] - node_starts[g])
        most = max(most, min(BLOCK, starts[g + 1] - starts[g]))
    longest += more
    value, slope, upper = (empty((longest, most)), empty((longest, most)), empty((longest, most)))
    block, work, found = empty((inputs, most)), empty((WORK, most)), empty((results, most))
    best, here, taken = empty(most), empty(most), empty(most, int64)
    room = longest * most + 1
    places, owners, whose = empty(room, int64), empty(room, int64), empty(4 * room, int64)
    even = empty(room, int64)
    wide = 64
    inner = empty((3, wide)), empty((3, wide)), empty((3, wide))
    own, roots = empty((inputs - more, wide)), empty((ROWS, wide))
    for g in range(starts.size - 1):
        shared = nodes[node_starts[g] : node_starts[g + 1]]
        for start in range(starts[g], starts[g + 1], BLOCK):
            stop = min(start + BLOCK, starts[g + 1])
            count = stop - start
            gather(count, order[start:stop], columns, block)
            grid = nodes_of(count, shared, block, tables)
            sweep(count, grid, block, tables, work, value, slope)
            bound(kind, count, grid, value, slope, best, here, upper)
            some = candidates(count, grid, upper, best, places, owners)
            if 4 * some > wide:
                wide = 8 * some + 64
                inner = empty((3, wide)), empty((3, wide)), empty((3, wide))
                own, roots = empty((inputs - more, wide)), empty((ROWS, wide))
            thetas, values, slopes = inner
            gather(some, owners, block, own)
            interior(some, grid, places, owners, slope, thetas, even)
            points(int64(3), some, thetas, own, tables, values, slopes)
            ready = brackets(some, grid, places, owners, slope, thetas, slopes, even, roots, whose)
            begin(ready, roots)
            gather(ready, whose, block, own)
            left, step = ready, 0
            while left > 0 and step < STEPS:
                points(int64(1), ready, roots[THETA : THETA + 1], own, tables, values, slopes)
                left = newton(ready, roots, slopes[0])
                step += 1
            choose(kind, ready, roots, whose, values[0], best, here, taken)
            finish(count, here, block, tables, found)
            told(kind, count, order[start:stop], here, found, theta, out)
