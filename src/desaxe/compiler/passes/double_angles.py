"""Sine and cosine in double-double, and 1 - |sine| with a third component.

The angle less whole quarters, |y| <= pi/4, is split: y = y0 + t, where y0 has half a double's digits, so
that z = y0^2 is a double. Taylor's polynomials in z give three words of sin(y0) and cos(y0) - 1; t turns
them,

    sin(y) = sin(y0) + (sin(y0) (cos(t) - 1) + cos(y0) sin(t)),

and so for the cosine. In odd quarters |sin(theta)| is cos(y), and 1 - |sin(theta)| keeps all digits next to
the quarter. Errors: 2^-130 of the sine, relative where it is small, and so of 1 - |sine|.
"""

from typing import NamedTuple

from ..program import Argument
from .expansions import Expansions, Pair, Words

HALF_A_DOUBLE = 134217729.0  # 2^27 + 1: Dekker's constant, which splits a double


class DoubleTrigonometry(NamedTuple):
    """Constants of sine and cosine, and the lines whose values need three components."""

    limit: float  # of |angle|; beyond it the reduction is wrong
    two_over_pi: float
    pi_half: tuple[float, ...]
    sine: tuple[tuple[float, ...], ...]  # sin(y)/y in y^2, as many words each as count
    cosine: tuple[tuple[float, ...], ...]  # (cos(y) - 1)/y^2
    complement: str  # the line that is 1 - |sine|
    gap: str  # the line that is a difference of which all but the last bits may cancel


class Turned(NamedTuple):
    """Sine, cosine and 1 - |sine| of an angle."""

    sin: Words
    cos: Pair
    complement: Words


def rotated_sin(writer: Expansions, angle: Pair, constants: DoubleTrigonometry) -> Turned:
    """Sine, cosine and 1 - |sine| of an angle."""
    scaled = writer.line("mul", angle.high, constants.two_over_pi)
    quarters = writer.line("floor", writer.line("add", scaled, 0.5))
    y0, t = _split(writer, _reduced(writer, angle, quarters, constants.pi_half))
    z = writer.line("mul", y0, y0)  # exact
    sine = writer.ordered(writer.product((y0,), _series(writer, z, constants.sine)))
    less = writer.ordered(writer.product((z,), _series(writer, z, constants.cosine)))  # cos(y0) - 1
    high, low = writer.quick(1.0, less[0])
    cosine = (high, writer.line("add", low, less[1]))
    rounds = writer.line("floor", writer.line("mul", quarters, 0.25))
    quarter = writer.line("sub", quarters, writer.line("mul", 4.0, rounds))  # modulo 4
    odd = writer.line("eq", writer.line("abs", writer.line("sub", quarter, 2.0)), 1.0, kind="bool")
    start = writer.chosen(odd, less, sine)
    along = writer.chosen(odd, cosine, sine[:2])
    across = writer.chosen(odd, writer.negative(sine[:2]), cosine)
    step = _Step(writer, t)
    there = step.sine(start, along, across)  # sin(y), or cos(y) - 1
    below = writer.line("lt", there[0], 0.0, kind="bool")
    size = writer.chosen(below, writer.negative(there), there)
    rest = writer.ordered(writer.sum_of((1.0,), writer.negative(size), ordered=True))
    behind = writer.line("le", 2.0, quarter, kind="bool")
    up = writer.chosen(odd, rest, there)
    over = step.cosine(along, across)
    return Turned(
        writer.chosen(behind, writer.negative(up), up),
        Pair(*writer.chosen(behind, writer.negative(over), over)),
        writer.chosen(odd, size, rest),
    )


def _reduced(writer: Expansions, angle: Pair, quarters: str, pi_half: tuple[float, ...]) -> Words:
    """angle - quarters pi/2 in three components; each product but the last is exact."""
    first, *others = (writer.line("mul", quarters, part) for part in pi_half)
    rest = writer.line("sub", angle.high, first)  # exact
    steps = [writer.line("neg", product) for product in others]
    small = [] if angle.single else [angle.low]
    words = writer.by_size([[rest, *steps[:2]], [*steps[2:], *small], []])
    high = writer.two_sum(*words[:2])
    return (high.high, *writer.two_sum(high.low, words[2]))


def _split(writer: Expansions, y: Words) -> tuple[str, Pair]:
    """y0 and the rest of y."""
    first, second, third = y
    wide = writer.line("mul", HALF_A_DOUBLE, first)
    y0 = writer.line("sub", wide, writer.line("sub", wide, first))
    high, low = writer.two_sum(writer.line("sub", first, y0), second)
    return y0, Pair(high, writer.line("add", low, third))


def _series(writer: Expansions, z: str, coefficients: tuple[tuple[float, ...], ...]) -> Words:
    """Horner's scheme with as many components as each coefficient; each term exceeds the sum of the next."""
    *rest, last = coefficients
    total: Words = last
    for coefficient in reversed(rest):
        if len(coefficient) == 1:
            total = (writer.line("mul_add", total[0], z, coefficient[0]),)
        elif len(coefficient) == 2:
            total = _next_pair(writer, total, z, coefficient)
        else:
            levels = writer.product_levels((z,), total)
            levels = [[value, *level] for value, level in zip(coefficient, levels, strict=True)]
            total = writer.by_size(levels, ordered=True)
    return total


def _next_pair(writer: Expansions, total: Words, z: str, coefficient: tuple[float, ...]) -> Words:
    """coefficient + total z in two components."""
    product = writer.two_product(total[0], z)
    low: Argument = product.low
    if len(total) > 1:
        low = writer.line("mul_add", total[1], z, low)
    high = writer.quick(coefficient[0], product.high)
    return high.high, writer.plain_sum([high.low, coefficient[1], low])


class _Step:
    """sin(t) and cos(t) - 1 of a small angle t, and the angle sum formulas with them."""

    def __init__(self, writer: Expansions, t: Pair) -> None:
        self.writer, line = writer, writer.line
        square = writer.two_product(t.high, t.high)
        tail = line("mul_add", line("mul", 2.0, t.high), t.low, square.low)
        cubic = line("mul", line("mul", square.high, -1.0 / 6.0), t.high)
        quartic = line("mul", square.high, line("mul", square.high, 1.0 / 24.0))
        self.sin = Pair(t.high, line("add", t.low, cubic))
        self.cos = Pair(line("mul", -0.5, square.high), line("mul_add", -0.5, tail, quartic))  # less 1

    def sine(self, start: Words, along: Words, across: Words) -> Words:
        """start + along (cos(t) - 1) + across sin(t), in three components."""
        writer = self.writer
        first, second = self._product(across, self.sin), self._product(along, self.cos)
        high = writer.two_sum(first.high, second.high)
        low = writer.plain_sum([high.low, second.low, first.low])
        return writer.ordered(writer.sum_of(start, (high.high, low), ordered=True))

    def cosine(self, along: Words, across: Words) -> Words:
        """across cos(t) - along sin(t)."""
        writer = self.writer
        turn = self._product(along, self.sin)
        less = writer.line("mul", across[0], self.cos.high)
        high = writer.quick(across[0], writer.line("neg", turn.high))
        low = writer.plain_sum([high.low, across[1], writer.line("sub", less, turn.low)])
        return writer.quick(high.high, low)

    def _product(self, words: Words, t: Pair) -> Pair:
        """A product, whose low part may overlap the high one."""
        writer, (high, low) = self.writer, words
        product = writer.two_product(high, t.high)
        inner = writer.line("mul_add", low, t.high, product.low)
        return Pair(product.high, writer.line("mul_add", high, t.low, inner))
