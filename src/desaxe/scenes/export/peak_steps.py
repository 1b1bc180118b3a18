"""Steps of a search for an extremum: functions of numbers, which go into a written module as they stand."""

from numba import njit


@njit(error_model="numpy")
def score(kind, value):
    """The number that is to be large: the magnitude for kind 0, the value, or for kind 2 its negative."""
    return abs(value) if kind == 0 else value if kind == 1 else -value


@njit(error_model="numpy")
def may_hold(kind, best, width, value_a, value_b, slope_a, slope_b):
    """True if an extremum between two nodes may beat the best, by the slope of the cubic between them."""
    middle = 1.5 * (value_b - value_a) / width - 0.25 * (slope_a + slope_b)
    more, less = max(abs(slope_a), abs(slope_b)), min(abs(slope_a), abs(slope_b))
    dips = (middle if slope_a > 0.0 else -middle) < 0.25 * more
    top = max(score(kind, value_a), score(kind, value_b)) + width * max(abs(middle), more)
    return top >= best and ((slope_a > 0.0) != (slope_b > 0.0) or dips or less < 0.02 * more)


@njit(error_model="numpy")
def inside(part, slope_a, slope_b):
    """The ends of the first three of four parts of an interval, nearer to an end that is flat."""
    size_a, size_b = abs(slope_a), abs(slope_b)
    if size_a < 0.02 * size_b:
        return (0.001953125, 0.03125, 0.25)[part]
    if size_b < 0.02 * size_a:
        return (0.75, 0.96875, 0.998046875)[part]
    return (0.25, 0.5, 0.75)[part]


@njit(error_model="numpy")
def next_guess(low, high, x, slope, last, last_slope, size):
    """The secant's root, or the middle of a bracket that it leaves or does not shrink."""
    new = x - slope * (x - last) / (slope - last_slope)
    return new if low <= new <= high and abs(new - x) <= 0.5 * size else 0.5 * (low + high)
