"""Tables looked up at the points of a block, whose places are in rooms."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy import int64, uint64

if TYPE_CHECKING:
    from typing import Any

    def apart() -> None:
        """The promise that what is written to shares no memory with anything else."""

    def get(room: Any, place: Any) -> float:
        """The value at a place of a room."""

    def put(room: Any, place: Any, value: float) -> None:
        """Keep a value at a place of a room."""


FEW = 16  # knots: to count those that are not above a place is quicker than to search, and vectorises


def find_pieces(count: Any, at: Any, way: Any, knots: Any, piece: Any) -> None:
    """The numbers of the pieces; those of the way back follow. Of NaN it is the first."""
    apart()
    size = uint64(knots.size)
    back = float(knots.size + 1)
    for i in range(count):
        put(piece, i, back if get(way, i) < 0.0 else 0.0)
    if size <= FEW:
        for k in range(size):
            knot = knots[k]
            for i in range(count):
                put(piece, i, get(piece, i) + (1.0 if knot <= get(at, i) else 0.0))
        return
    first, most = knots[0], float(size - uint64(2))
    scale = (most + 1.0) / (knots[size - uint64(1)] - first)
    for i in range(count):
        x, low, high = get(at, i), uint64(0), size
        guess = (x - first) * scale  # right where knots are even: then there is nothing to search
        guess = guess if guess > 0.0 else 0.0
        place = uint64(guess if guess < most else most)
        if (knots[place] <= x) & (x < knots[place + uint64(1)]):
            low = high = place + uint64(1)
        while low < high:
            middle = (low + high) >> uint64(1)
            below = knots[middle] <= x
            low, high = (middle + uint64(1) if below else low), (high if below else middle)
        put(piece, i, get(piece, i) + float(low))


def look_up(count: Any, at: Any, piece: Any, knots: Any, rows: Any, value: Any) -> None:
    """The values of pieces, beyond their ends too."""
    apart()
    back = int64(knots.size + 1)
    for i in range(count):
        number = int64(get(piece, i))
        own = number - back if number >= back else number
        s = get(at, i) - knots[uint64(own - 1 if own > 0 else 0)]
        k = uint64(4 * number)
        b, c, d = rows[k + uint64(1)], rows[k + uint64(2)], rows[k + uint64(3)]
        put(value, i, rows[k] + s * (b + s * (c + s * d)))


def look_up_slope(count: Any, at: Any, piece: Any, knots: Any, rows: Any, value: Any) -> None:
    """The slopes of pieces, beyond their ends too."""
    apart()
    back = int64(knots.size + 1)
    for i in range(count):
        number = int64(get(piece, i))
        own = number - back if number >= back else number
        s = get(at, i) - knots[uint64(own - 1 if own > 0 else 0)]
        k = uint64(4 * number)
        put(value, i, rows[k + uint64(1)] + s * (2.0 * rows[k + uint64(2)] + s * (3.0 * rows[k + uint64(3)])))
