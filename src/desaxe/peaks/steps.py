"""The straight lines of a search, as text that the compiler reads: a bound, a first guess, a step.

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

from ..compiler.text import read_function
from .evaluations import ProgramFunction, compiled

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


def upper_bounds(*arrays: Any) -> Any:
    """BOUND of arrays that broadcast."""
    return compiled(_of_text, BOUND).call(*arrays)


def first_guess(*arrays: Any) -> Any:
    """GUESS of arrays that broadcast."""
    return compiled(_of_text, GUESS).call(*arrays)


def newton_step(*arrays: Any) -> Any:
    """STEP of arrays that broadcast."""
    return compiled(_of_text, STEP).call(*arrays)


def _of_text(text: str) -> ProgramFunction:
    program = read_function(text)
    return ProgramFunction(program, program.inputs)
