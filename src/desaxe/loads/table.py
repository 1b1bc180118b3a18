"""Tables as piecewise polynomials: periodic over the crank angle, held beyond their ends over a position.

A number is looked up in plain Python, which needs only `math`; arrays go through NumPy. At a break the piece
to the right holds, value and derivative alike.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from math import copysign, floor, inf, nan, nextafter, sqrt
from typing import Any, NamedTuple

from ..support.computed import computed_once
from ..support.extras import needed
from ..support.lazy import np

Row = tuple[float, float, float, float]

KINDS = ("cubic", "linear", "step")
SAME = 1e-9  # of the largest value or slope: what differs by less is no jump and no kink


@dataclass(frozen=True)
class Table:
    """Cubics in the distance from the left end of each piece.

    knots   ascending; the period ends where the first one begins again
    rows    coefficients c0 to c3: rows[i] holds from knots[i - 1] to knots[i]. Without a period rows[0] and
            the last row hold beyond the ends, and are constant
    period  None where values are held beyond the ends
    """

    knots: tuple[float, ...]
    rows: tuple[Row, ...]
    period: float | None = None

    def affine(self, factor: float, number: float) -> "Table":
        """The table times a factor, plus a number."""
        rows = tuple((factor * a + number, factor * b, factor * c, factor * d) for a, b, c, d in self.rows)
        return Table(self.knots, rows, self.period)

    def reduced(self, x: float) -> float:
        """The angle shifted into the first period."""
        if self.period is None or x - x != 0.0:
            return x
        first = self.knots[0]
        x -= self.period * floor((x - first) / self.period)
        if x < first:
            return x + self.period  # perhaps rounded to the end, where the last piece holds
        before = x - self.period
        return before if before >= first else x

    def first_right(self, x: float) -> float:
        """The smallest double that belongs to the piece right of a knot: whole periods are rounded."""
        low, high = x - 1e-9, x + 1e-9
        here = self.piece(self.reduced(high))
        if self.piece(self.reduced(x)) == here != self.piece(self.reduced(nextafter(x, -inf))):
            return x
        while low < (middle := low + 0.5 * (high - low)) < high:  # next to 0 doubles are too many to walk
            low, high = (low, middle) if self.piece(self.reduced(middle)) == here else (middle, high)
        return high

    def piece(self, x: float) -> int:
        """The index of the piece at a reduced argument."""
        return bisect_right(self.knots, x)

    def origin(self, piece: int) -> float:
        """The left end of a piece, from which its cubic is measured."""
        return self.knots[max(piece - 1, 0)]

    def both(self, x: Any) -> tuple[Any, Any]:
        """Value and derivative at a number or an array; NaN at a non-finite argument."""
        if not isinstance(x, float):
            return self._arrays(x)
        if x - x != 0.0:
            return nan, nan
        x = self.reduced(x)
        piece = self.piece(x)
        return polynomial(self.rows[piece], x - self.origin(piece))

    def _arrays(self, x: Any) -> tuple[Any, Any]:
        knots, rows = self._numpy
        x = np.asarray(x, float)
        with np.errstate(invalid="ignore"):
            if self.period is not None:
                first, period = knots[0], self.period
                x = x - period * np.floor((x - first) / period)
                x = np.where(x < first, x + period, np.where(x - period >= first, x - period, x))
            piece = np.searchsorted(knots, x, side="right")
            distance = np.where(np.isfinite(x), x - knots[np.maximum(piece - 1, 0)], np.nan)
            value, slope = polynomial(rows.take(piece, axis=1), distance)
        return value, slope

    @computed_once
    def _numpy(self) -> tuple[Any, Any]:
        return np.array(self.knots), np.array(self.rows).T

    def __getstate__(self) -> dict[str, Any]:
        """The state without the arrays, which are rebuilt when needed."""
        return {"knots": self.knots, "rows": self.rows, "period": self.period}

    @property
    def values(self) -> tuple[float, ...]:
        """The value at each knot, that to the right at a jump; no zero has a sign."""
        return tuple(row[0] + 0.0 for row in self.rows[1:])

    @computed_once
    def jumps_at_points(self) -> bool:
        """True where a place is given twice: the value there is that of the side ahead."""
        return any(a == b for a, b in pairwise(self.knots))

    @computed_once
    def range(self) -> tuple[float, float]:
        """The least and the largest value anywhere, between the knots too."""
        result = list(self.values)
        ends = (*self.knots[1:], self.knots[0] + self.period) if self.period is not None else self.knots[1:]
        for row, left, right in zip(self.rows[1:], self.knots, ends, strict=False):
            result += [polynomial(row, s)[0] for s in _flat_points(row) if 0.0 < s < right - left]
        return min(result) + 0.0, max(result) + 0.0

    @computed_once
    def kinks(self) -> tuple[float, ...]:
        """The knots at which the value jumps or the derivative does."""
        return tuple(dict.fromkeys(x for x, jump, kink in self._changes() if jump or kink))

    @computed_once
    def jumps(self) -> tuple[float, ...]:
        """The knots at which the value jumps."""
        return tuple(dict.fromkeys(x for x, jump, _ in self._changes() if jump))

    def _changes(self) -> list[tuple[float, bool, bool]]:
        """Each knot with two flags: the value jumps, the derivative jumps."""
        slopes = [abs(d) for row in self.rows for d in row[1:]]
        high, steep = max(abs(row[0]) for row in self.rows), max(slopes, default=0.0)
        result = []
        for i, x in enumerate(self.knots):
            before = len(self.knots) if i == 0 and self.period is not None else i
            end = x + self.period if i == 0 and self.period is not None else x
            left = polynomial(self.rows[before], end - self.origin(before))
            right = self.rows[i + 1]
            jump, kink = abs(left[0] - right[0]) > SAME * high, abs(left[1] - right[1]) > SAME * steep
            result.append((x, jump, kink))
        return result


class Arrays(NamedTuple):
    """Knots, and four coefficients for each piece: one more than there are knots, for each way in turn."""

    knots: list[float]
    coefficients: list[float]


def arrays_of(*ways: Table) -> Arrays:
    """The arrays of tables over the same knots."""
    rows = chain.from_iterable(table.rows for table in ways)
    return Arrays([*ways[0].knots], [*chain.from_iterable(rows)])


def polynomial(row: Any, s: Any) -> tuple[Any, Any]:
    """A cubic and its derivative."""
    c0, c1, c2, c3 = row
    return c0 + s * (c1 + s * (c2 + s * c3)), c1 + s * (2.0 * c2 + s * (3.0 * c3))


def _flat_points(row: Row) -> list[float]:
    """The distances at which the derivative of a cubic is 0."""
    _, c1, c2, c3 = row
    a, half = 3.0 * c3, c2
    square = half * half - a * c1
    if square < 0.0 or (a == 0.0 and half == 0.0):
        return []
    q = -(half + copysign(sqrt(square), half))
    return [x / y for x, y in ((q, a), (c1, q)) if y != 0.0]


def periodic(x: Sequence[float], y: Sequence[float], kind: str, period: float) -> Table:
    """The table through (x, y), which do not repeat the first point at the end of the period."""
    ends, values = [*x[1:], x[0] + period], [*y[1:], y[0]]
    slopes = periodic_slopes(x, y, period) if kind == "cubic" else []
    rows = _rows(list(zip(x, y, ends, values, strict=True)), kind, slopes, True)
    return Table(tuple(x), (rows[-1], *rows), period)


def held(x: Sequence[float], y: Sequence[float], kind: str) -> Table:
    """The table through (x, y), constant beyond its ends."""
    slopes = _slopes(x, y) if kind == "cubic" else _monotone_slopes(x, y) if kind == "smooth" else []
    rows = _rows(list(zip(x[:-1], y[:-1], x[1:], y[1:], strict=True)), kind, slopes, False)
    return Table(tuple(x), ((y[0], 0.0, 0.0, 0.0), *rows, (y[-1], 0.0, 0.0, 0.0)))


def _rows(
    spans: Sequence[tuple[float, float, float, float]], kind: str, slopes: Sequence[float], closed: bool
) -> list[Row]:
    """The coefficients between neighbours (x, y) and (x, y); for cubics with these slopes at the knots."""
    rows: list[Row] = []
    for i, (a, left, b, right) in enumerate(spans):
        if a == b:  # a jump: a piece of no width
            rows.append((left, 0.0, 0.0, 0.0))
            continue
        width, chord = b - a, (right - left) / (b - a)
        if kind == "step":
            rows.append((left, 0.0, 0.0, 0.0))
        elif kind == "linear":
            rows.append((left, chord, 0.0, 0.0))
        else:
            m, n = slopes[i], slopes[(i + 1) % len(slopes) if closed else i + 1]
            rows.append((left, m, (3.0 * chord - 2.0 * m - n) / width, (m + n - 2.0 * chord) / width**2))
    return rows


def periodic_slopes(x: Sequence[float], y: Sequence[float], period: float) -> list[float]:
    """The slopes at the knots of the periodic cubic spline: those with which its second derivative is smooth.

    With the widths h and the slopes d of the chords,
    h_i m_(i-1) + 2 (h_(i-1) + h_i) m_i + h_(i-1) m_(i+1) = 3 (h_i d_(i-1) + h_(i-1) d_i), round and round.
    """
    n = len(x)
    h = [b - a for a, b in zip(x, [*x[1:], x[0] + period], strict=True)]
    d = [(b - a) / width for a, b, width in zip(y, [*y[1:], y[0]], h, strict=True)]
    below = h
    middle = [2.0 * (h[i - 1] + h[i]) for i in range(n)]
    above = [h[i - 1] for i in range(n)]
    right = [3.0 * (h[i] * d[i - 1] + h[i - 1] * d[i]) for i in range(n)]
    # All but the last slope as p + q (last slope); then the last equation.
    edge = [0.0] * (n - 1)
    edge[0] -= below[0]
    edge[-1] -= above[n - 2]
    p = _tridiagonal(below, middle, above, right[:-1])
    q = _tridiagonal(below, middle, above, edge)
    total = middle[-1] + below[-1] * q[-1] + above[-1] * q[0]
    last = (right[-1] - below[-1] * p[-1] - above[-1] * p[0]) / total
    return [*(a + b * last for a, b in zip(p, q, strict=True)), last]


def _tridiagonal(
    below: Sequence[float], middle: Sequence[float], above: Sequence[float], right: Sequence[float]
) -> list[float]:
    """The solution of a diagonally dominant system."""
    pivots, result = [middle[0]], [right[0]]
    for i in range(1, len(right)):
        factor = below[i] / pivots[-1]
        pivots.append(middle[i] - factor * above[i - 1])
        result.append(right[i] - factor * result[-1])
    result[-1] /= pivots[-1]
    for i in range(len(right) - 2, -1, -1):
        result[i] = (result[i] - above[i] * result[i + 1]) / pivots[i]
    return result


def _monotone_slopes(x: Sequence[float], y: Sequence[float]) -> list[float]:
    """Slopes with which cubics rise and fall only where the values do.

    F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984): a weighted harmonic mean of both chords;
    at the ends that of the parabola through three points, as far as the cubic stays monotone.
    """
    h = [b - a for a, b in pairwise(x)]
    d = [(b - a) / width for (a, b), width in zip(pairwise(y), h, strict=True)]
    if len(d) == 1:
        return [d[0], d[0]]
    result = [_end_slope(*h[:2], *d[:2])]
    for (left, right), (before, after) in zip(pairwise(h), pairwise(d), strict=True):
        first, second = 2.0 * right + left, right + 2.0 * left
        same = before * after > 0.0
        result.append((first + second) / (first / before + second / after) if same else 0.0)
    return [*result, _end_slope(h[-1], h[-2], d[-1], d[-2])]


def _end_slope(own: float, other: float, chord: float, beyond: float) -> float:
    """The slope at an end, next to a chord of width `own`; `beyond` is the next chord."""
    slope = ((2.0 * own + other) * chord - own * beyond) / (own + other)
    if slope * chord <= 0.0:
        return 0.0
    return slope if chord * beyond > 0.0 or abs(slope) <= 3.0 * abs(chord) else 3.0 * chord


def _slopes(x: Sequence[float], y: Sequence[float]) -> list[float]:
    """The slopes at the knots of the cubic spline without a period ("not-a-knot")."""
    with needed('a load of kind="cubic" over Y', "simulate"):
        from scipy.interpolate import CubicSpline
    result: list[float] = CubicSpline(x, y)(x, 1).tolist()
    return result
