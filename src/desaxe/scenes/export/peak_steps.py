"""Search for extrema: functions that go into a written module, compiled."""

# ruff: noqa: F821

from numpy import empty, inf, nan


def score(kind, value):
    """The number that is to be large: the magnitude for kind 0, the value, or for kind 2 its negative."""
    return abs(value) if kind == 0 else value if kind == 1 else -value


def may_hold(kind, best, width, value_a, value_b, slope_a, slope_b):
    """True if an extremum between two nodes may beat the best, by the slope of the cubic between them."""
    middle = 1.5 * (value_b - value_a) / width - 0.25 * (slope_a + slope_b)
    more, less = max(abs(slope_a), abs(slope_b)), min(abs(slope_a), abs(slope_b))
    dips = (middle if slope_a > 0.0 else -middle) < 0.25 * more
    top = max(score(kind, value_a), score(kind, value_b)) + width * max(abs(middle), more)
    return top >= best and ((slope_a > 0.0) != (slope_b > 0.0) or dips or less < 0.02 * more)


def inside(part, slope_a, slope_b):
    """The ends of the first three of four parts of an interval, nearer to an end that is flat."""
    size_a, size_b = abs(slope_a), abs(slope_b)
    if size_a < 0.02 * size_b:
        return (0.001953125, 0.03125, 0.25)[part]
    if size_b < 0.02 * size_a:
        return (0.75, 0.96875, 0.998046875)[part]
    return (0.25, 0.5, 0.75)[part]


def search(curve, kind, nodes, turns, designs, first, last, theta):
    """The angle of the extreme value of each design.

    `curve` gives value and slope of an angle, its sine and cosine, and a design. Between nodes that may hold
    more than the best one the slope's root is searched for by secants in a bracket.
    """
    value, slope = empty(nodes.size), empty(nodes.size)
    for i in range(first, last):
        for j in range(nodes.size):
            values = curve(nodes[j], turns[0][j], turns[1][j], designs, i)
            value[j], slope[j] = values[0], values[1]
        best, theta[i], at_node = -inf, nan, True
        for j in range(nodes.size):
            if score(kind, value[j]) > best:
                best, theta[i] = score(kind, value[j]), nodes[j]
        for j in range(nodes.size - 1):
            width = nodes[j + 1] - nodes[j]
            if not may_hold(kind, best, width, value[j], value[j + 1], slope[j], slope[j + 1]):
                continue
            end, before = nodes[j], slope[j]
            for part in range(4):
                low, high, after = end, nodes[j + 1], slope[j + 1]
                if part < 3:
                    high = nodes[j] + inside(part, slope[j], slope[j + 1]) * width
                    after = curve(high, *sin_cos(high), designs, i)[1]
                if (before > 0.0) != (after > 0.0) and before == before and after == after:
                    x = stationary(curve, designs, i, low, high, before, after)
                    new = score(kind, curve(x, *sin_cos(x), designs, i)[0])
                    if new > best + 1e-14 * abs(best) or (at_node and new >= best - 1e-14 * abs(best)):
                        best, theta[i], at_node = max(new, best), x, False
                end, before = high, after


def stationary(curve, designs, i, low, high, before, after):
    """The root of the slope in a bracket: the secant's, or the middle where that leaves it or is slow."""
    last, last_slope, x, slope, size = low, before, high, after, high - low
    for _ in range(100):
        new = x - slope * (x - last) / (slope - last_slope)
        if not (low <= new <= high and abs(new - x) <= 0.5 * size):
            new = 0.5 * (low + high)
        last, last_slope, size, x = x, slope, abs(new - x), new
        slope = curve(x, *sin_cos(x), designs, i)[1]
        if (slope > 0.0) == (before > 0.0):
            low = x
        else:
            high = x
        if slope == 0.0 or size <= 4e-16 * abs(x) or high - low <= 4e-16 * abs(x):
            break
    return x
