"""The slider's place, exactly: on which side of a jump a crank angle is, for the doubles as they are.

Next to a jump the last bit of Y decides which piece of a table holds, at a dead centre that of its slope.
Here are as many bits as that takes, in integers: some 30 us, for what rounding leaves open.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import frexp, isqrt
from typing import NamedTuple

BITS, MOST = 128, 8192
SPARE = 32  # bits, which sine and cosine may lose


class Slider:
    """The slider at a crank angle. It is less than a position beyond it, so `bisect` finds its piece."""

    def __init__(self, theta: float, lengths: Sequence[float], branch: int) -> None:
        _, AB, BC = self.lengths = lengths
        self.theta = theta if AB else 0.0  # a crank without length is always at 0, where nothing is rounded
        self.branch, self._unit = branch, frexp(AB + BC)[1]
        self._states: dict[int, _State] = {}

    def __lt__(self, position: float) -> bool:
        return self._sign(lambda state, bits: state.Y - _integer(position, bits - self._unit)) < 0

    @property
    def way(self) -> int:
        """The sign of dY/dtheta; at a dead centre, which only the angle 0 can be, of the way that follows."""
        _, AB, BC = self.lengths
        if not AB:
            return 0
        return self._sign(lambda state, bits: state.slope) or (-1 if BC + self.branch * AB > 0.0 else 1)

    def _sign(self, value_of: "Callable[[_State, int], int]") -> int:
        bits = BITS
        while True:
            state = self._states.get(bits) or self._state(bits)
            value = value_of(state, bits)
            if abs(value) > state.error:
                return 1 if value > 0 else -1
            # Sine and cosine of an angle other than 0 are transcendental: with enough bits nothing is equal.
            if self.theta == 0.0 or bits >= MOST:
                return 0
            bits *= 2

    def _state(self, bits: int) -> "_State":
        ec, AB, BC = (_integer(length, bits - self._unit) for length in self.lengths)
        sine, cosine = _sine_cosine(self.theta, bits)
        across = ec + (AB * sine >> bits)
        rise = isqrt(max(BC * BC - across * across, 0))
        slope = -(sine * rise + self.branch * cosine * across) >> bits
        error = 16 + (8 << bits) // max(rise, 1)
        found = self._states[bits] = _State((AB * cosine >> bits) + self.branch * rise, slope, error)
        return found


class FromDeadCentre(Slider):
    """The slider by its distance from a dead centre: less than a distance nearer to it."""

    def __init__(self, theta: float, lengths: Sequence[float], branch: int, dead_centre: str) -> None:
        super().__init__(theta, lengths, branch)
        self.outer = dead_centre == "outer"

    def _state(self, bits: int) -> "_State":
        Y, slope, error = super()._state(bits)
        ec, AB, BC = (_integer(length, bits - self._unit) for length in self.lengths)
        along = BC + AB if self.outer else BC - AB
        height = isqrt(max(along * along - ec * ec, 0))
        centre = self.branch * (height if along >= 0 else -height)
        error += 16 + (8 << bits) // max(height, 1)
        found = self._states[bits] = _State(abs(centre - Y), slope, error)
        return found


class _State(NamedTuple):
    """Position, a multiple of its slope, and what is rounded of either at most."""

    Y: int
    slope: int
    error: int


def _integer(x: float, bits: int) -> int:
    """The multiple of 2^-bits at or below a double."""
    numerator, denominator = x.as_integer_ratio()
    return (numerator << bits) // denominator if bits >= 0 else numerator // (denominator << -bits)


def _sine_cosine(theta: float, bits: int) -> tuple[int, int]:
    """Sine and cosine, as multiples of 2^-bits."""
    whole, work = max(frexp(theta)[1], 0), bits + SPARE
    quarter = _pi(work + whole) >> 1
    quadrant, rest = divmod(_integer(theta, work + whole) + (quarter >> 1), quarter)
    angle = rest - (quarter >> 1) >> whole
    square, sine, term, k = angle * angle >> work, angle, angle, 1
    while term:
        k += 2
        term = -(term * square >> work) // (k * (k - 1))
        sine += term
    cosine = isqrt((1 << 2 * work) - sine * sine)
    turned = ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[quadrant & 3]
    return turned[0] >> SPARE, turned[1] >> SPARE


@lru_cache(maxsize=64)
def _pi(bits: int) -> int:
    """pi by Machin's formula, as a multiple of 2^-bits."""
    work = bits + SPARE
    return 4 * (4 * _inverse_tangent(5, work) - _inverse_tangent(239, work)) >> SPARE


def _inverse_tangent(n: int, bits: int) -> int:
    """The inverse tangent of 1/n."""
    power = total = (1 << bits) // n
    k, sign = 1, 1
    while power:
        power //= n * n
        k, sign = k + 2, -sign
        total += sign * (power // k)
    return total
