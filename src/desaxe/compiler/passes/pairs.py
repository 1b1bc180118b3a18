"""Double-double arithmetic: operations with relative errors below 2^-100.

Where a low part is known to be 0, as for inputs and constants, nothing is done for it.
Source of the algorithms: Dekker 1971; Knuth; Joldes, Muller, Popescu 2017.
"""

from collections.abc import Callable, Mapping

from ..program import Argument, number
from .double_angles import DoubleTrigonometry, Turned, rotated_sin
from .expansions import Expansions, Pair


class Pairs(Expansions):
    """Appends the lines of one operation after the other."""

    def __init__(self, constants: DoubleTrigonometry) -> None:
        super().__init__()
        self.constants = constants
        self.angles: dict[Pair, Turned] = {}
        self.signs: set[Argument] = {1.0, -1.0}  # what is 1 or -1

    # ---- sums ------------------------------------------------------------------------------------

    def add(self, a: Pair, b: Pair) -> Pair:
        """a + b; what cancels loses nothing."""
        if a.single and b.single:
            return self.two_sum(a.high, b.high)
        if a.single or b.single:
            one, other = (a, b) if b.single else (b, a)
            high, low = self.two_sum(one.high, other.high)
            return self.quick(high, self.line("add", one.low, low))
        sums, rest = self.two_sum(a.high, b.high), self.two_sum(a.low, b.low)
        first = self.quick(sums.high, self.line("add", sums.low, rest.high))
        return self.quick(first.high, self.line("add", rest.low, first.low))

    def neg(self, a: Pair) -> Pair:
        """-a."""
        return Pair(self.line("neg", a.high), 0.0 if a.single else self.line("neg", a.low))

    def sub(self, a: Pair, b: Pair) -> Pair:
        """a - b."""
        return self.add(a, self.neg(b))

    # ---- products --------------------------------------------------------------------------------

    def mul(self, a: Pair, b: Pair) -> Pair:
        """a b."""
        product = self.line("mul", a.high, b.high)
        if self.is_scale(a) or self.is_scale(b):  # nothing is rounded
            factor, other = (a, b) if self.is_scale(a) else (b, a)
            return Pair(product, 0.0 if other.single else self.line("mul", factor.high, other.low))
        low = self.line("two_product_error", a.high, b.high)
        if a.single and b.single:
            return Pair(product, low)
        for high, other in ((a.high, b), (b.high, a)):
            if not other.single:
                low = self.line("mul_add", high, other.low, low)
        return self.quick(product, low)

    def is_scale(self, a: Pair) -> bool:
        """True if a product with `a` is exact: a sign, or a constant power of two."""
        return a.single and (a.high in self.signs or _is_power_of_two(a))

    def div(self, a: Pair, b: Pair) -> Pair:
        """a / b: a quotient of doubles, and what its residual adds to it."""
        if _is_power_of_two(b):
            return self.mul(a, Pair(1.0 / number(b.high)))
        inverse = self.line("div", 1.0, b.high)
        quotient = self.line("mul", a.high, inverse)
        product = Pair(self.line("mul", quotient, b.high), self.line("two_product_error", quotient, b.high))
        rest = self.line("sub", self.line("sub", a.high, product.high), product.low)
        if not a.single:
            rest = self.line("add", rest, a.low)
        if not b.single:
            rest = self.line("sub", rest, self.line("mul", quotient, b.low))
        return self.quick(quotient, self.line("mul", rest, inverse))

    def sqrt(self, a: Pair) -> Pair:
        """The square root: Newton's step from that of the high part; 0 of 0."""
        root = self.line("sqrt", a.high)
        square = Pair(self.line("mul", root, root), self.line("two_product_error", root, root))
        rest = self.line("sub", self.line("sub", a.high, square.high), square.low)
        if not a.single:
            rest = self.line("add", rest, a.low)
        step = self.line("div", rest, self.line("mul", 2.0, root))
        none = self.line("eq", root, 0.0, kind="bool")
        return self.quick(root, self.line("select", none, 0.0, step))

    def hypot(self, a: Pair, b: Pair) -> Pair:
        """The root of a^2 + b^2; the squares must neither overflow nor vanish."""
        return self.sqrt(self.add(self.mul(a, a), self.mul(b, b)))

    # ---- signs and choices -----------------------------------------------------------------------

    def size(self, a: Pair) -> Pair:
        """|a|."""
        if a.single:
            return Pair(self.line("abs", a.high))
        below = self.line("lt", a.high, 0.0, kind="bool")
        return self.select(Pair(below), self.neg(a), a)

    def copysign(self, a: Pair, b: Pair) -> Pair:
        """|a| with the sign of b."""
        high = self.line("copysign", a.high, b.high)
        if a.single:
            return Pair(high)
        rotated_sin = self.line("eq", high, a.high, kind="bool")
        return Pair(high, self.line("select", rotated_sin, a.low, self.line("neg", a.low)))

    def select(self, condition: Pair, a: Pair, b: Pair) -> Pair:
        """a where the condition holds, else b."""
        high = self.line("select", condition.high, a.high, b.high)
        if a.single and b.single:
            return Pair(high)
        return Pair(high, self.line("select", condition.high, a.low, b.low))

    def floor(self, a: Pair) -> Pair:
        """The floor of the high part."""
        return Pair(self.line("floor", a.high))

    # ---- angles ----------------------------------------------------------------------------------

    def atan2(self, y: Pair, x: Pair) -> Pair:
        """The angle of doubles, and what is left of it, small enough to be its own tangent."""
        angle = self.line("atan2", y.high, x.high)
        (sine, low, _), cosine, _ = self.rotated_sin(Pair(angle))
        across = self.sub(self.mul(y, cosine), self.mul(x, Pair(sine, low)))
        along = self.line("mul_add", x.high, cosine.high, self.line("mul", y.high, sine))
        step = self.line("div", across.high, along)
        none = self.line("eq", along, 0.0, kind="bool")
        return self.quick(angle, self.line("select", none, 0.0, step))

    def rotated_sin(self, angle: Pair) -> Turned:
        """Sine and cosine of an angle, computed once per angle."""
        if angle not in self.angles:
            self.angles[angle] = rotated_sin(self, angle, self.constants)
        return self.angles[angle]

    def quarter_turned(self, sine: Pair, cosine: Pair, quarters: Pair) -> Pair:
        """The sine after a whole number of quarter turns, for both components."""
        words = ((sine.high, cosine.high), (sine.low, cosine.low))
        return Pair(*(self.line("rotated_sin", a, b, quarters.high) for a, b in words))


def _is_power_of_two(a: Pair) -> bool:
    """True for a constant power of two, by which a product is exact."""
    if not (a.single and isinstance(a.high, float)) or a.high == 0.0:
        return False
    ratio = abs(a.high).as_integer_ratio()
    return all(part & (part - 1) == 0 for part in ratio)


RULES: Mapping[str, Callable[..., Pair]] = {
    "copy": lambda pairs, a: a,
    "add": Pairs.add,
    "sub": Pairs.sub,
    "mul": Pairs.mul,
    "mul_add": lambda pairs, a, b, c: pairs.add(pairs.mul(a, b), c),
    "div": Pairs.div,
    "neg": Pairs.neg,
    "abs": Pairs.size,
    "sqrt": Pairs.sqrt,
    "hypot": Pairs.hypot,
    "atan2": Pairs.atan2,
    "floor": Pairs.floor,
    "copysign": Pairs.copysign,
    "rotated_sin": Pairs.quarter_turned,
    "rotated_cos": lambda pairs, sine, cosine, quarters: pairs.quarter_turned(
        cosine, pairs.neg(sine), quarters
    ),
    "select": Pairs.select,
    "power_of_two": lambda pairs, a: Pair(pairs.line("power_of_two", a.high)),
    # A table is of doubles: what it is looked up at is one.
    **{
        op: lambda pairs, x, table, piece, op=op: Pair(pairs.line(op, x.high, table.high, piece.high))
        for op in ("lookup_piece", "lookup", "lookup_slope")
    },
}
