"""Twice the digits: every number becomes an unevaluated sum of two doubles.

A value is `high + low`, where `high` is the sum rounded to a double, so `low` holds the next 53 bits.
What an addition or a product rounds away is itself a double (two-sum; two-product by a fused
multiply-add) and is kept. The loop stays straight-line code without branches, so it vectorises like
the plain one. Where a low part is known to be 0, as for inputs and constants, nothing is done for it.

The pass keeps twice the digits of the program it is given, no more: it belongs on a program that is
stable to begin with. Relative errors of one operation are below 2^-100, cancelling sums included.
Source of the algorithms: Dekker 1971; Knuth; Joldes, Muller, Popescu 2017.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from ..program import Argument, Line, Program
from .fold import fold_constants
from .number import number_values
from .slicing import drop_unused


class DoubleTrigonometry(NamedTuple):
    """Constants of sine and cosine to twice the digits, made by the derivation; high and low parts."""

    limit: float  # of |angle|; beyond it the reduction is wrong
    two_over_pi: float
    pi_half: tuple[float, ...]
    sine: tuple[tuple[float, float], ...]
    cosine: tuple[tuple[float, float], ...]


class Pair(NamedTuple):
    """The sum of two names or constants; a low part of 0.0 is none at all."""

    high: Argument
    low: Argument = 0.0

    @property
    def single(self) -> bool:
        """Whether the high part is all there is."""
        return self.low == 0.0 and not isinstance(self.low, str)


def double_digits(program: Program, constants: DoubleTrigonometry) -> Program:
    """The program in pairs; its outputs are the high parts, rounded once.

    Precondition: |angle| <= constants.limit wherever the result matters. Effect: values that are
    finite keep about 100 bits; comparisons look at high parts; an infinity may become NaN. Error terms
    of two-sum and two-product are 0, because the sums and products themselves keep them; so is `rounding`.
    """
    writer = _Writer(program, constants)
    for line in program.lines:
        writer.assign(line)
    wide = program._replace(lines=tuple(writer.lines))
    return drop_unused(number_values(fold_constants(wide)))


class _Writer:
    """Appends lines; knows the pair of every name."""

    def __init__(self, program: Program, constants: DoubleTrigonometry) -> None:
        self.constants = constants
        self.lines: list[Line] = []
        self.pairs: dict[str, Pair] = {name: Pair(name) for name in program.inputs}
        self.types: dict[str, str] = dict.fromkeys(program.inputs, "f64")
        self.angles: dict[Pair, dict[str, Pair]] = {}

    def assign(self, line: Line) -> None:
        """Write a line of the plain program; its high part gets its name."""
        if line.type != "f64" or line.op in ("lt", "le", "eq"):
            args = tuple(self.of(a).high if isinstance(a, str) else a for a in line.args)
            self.lines.append(line._replace(args=args))
            self.pairs[line.name], self.types[line.name] = Pair(line.name), line.type
            return
        result = self.computed(line.op, line.args)
        self.lines.append(Line(line.name, "copy", (result.high,)))
        self.types[line.name] = "f64"
        self.pairs[line.name] = result._replace(high=line.name)

    def of(self, argument: Argument) -> Pair:
        """The pair of an argument; truth values and whole numbers are their own."""
        return self.pairs[argument] if isinstance(argument, str) else Pair(argument)

    def line(self, op: str, *args: Argument, kind: str = "f64") -> str:
        """One more line of doubles."""
        name = f"_d{len(self.lines)}"
        self.lines.append(Line(name, op, args, kind))
        self.types[name] = kind
        return name

    def computed(self, op: str, args: tuple[Argument, ...]) -> Pair:
        """The pair of one operation."""
        if op in ("sin", "cos"):
            return self.turned(self.of(args[0]))[op]
        if op in ("two_sum_error", "two_product_error", "rounding"):
            return Pair(0.0)
        return _RULES[op](self, *map(self.of, args))

    # ---- sums ------------------------------------------------------------------------------------

    def two_sum(self, a: Argument, b: Argument) -> Pair:
        """a + b, exactly."""
        return Pair(self.line("add", a, b), self.line("two_sum_error", a, b))

    def quick(self, a: Argument, b: Argument) -> Pair:
        """a + b, exactly, where a is the larger one."""
        total = self.line("add", a, b)
        return Pair(total, self.line("sub", b, self.line("sub", total, a)))

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
        if _is_power_of_two(a) or _is_power_of_two(b):  # nothing is rounded
            factor, other = (a, b) if _is_power_of_two(a) else (b, a)
            return Pair(product, 0.0 if other.single else self.line("mul", factor.high, other.low))
        error = self.line("two_product_error", a.high, b.high)
        if a.single and b.single:
            return Pair(product, error)
        return self.quick(product, self.line("add", error, self.cross(a, b)))

    def cross(self, a: Pair, b: Pair) -> Argument:
        """The sum of high times low."""
        parts = [(a.high, b.low)] * (not b.single) + [(b.high, a.low)] * (not a.single)
        products = [self.line("mul", high, low) for high, low in parts]
        return products[0] if len(products) == 1 else self.line("add", *products)

    def div(self, a: Pair, b: Pair) -> Pair:
        """a / b: a quotient of doubles, and what its residual adds to it."""
        if _is_power_of_two(b):
            return self.mul(a, Pair(1.0 / float(b.high)))
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

    def quarter_turned(self, sine: Pair, cosine: Pair, quarters: Pair) -> Pair:
        """Both words turn alike; the number of quarters is whole."""
        words = ((sine.high, cosine.high), (sine.low, cosine.low))
        return Pair(*(self.line("turned", a, b, quarters.high) for a, b in words))

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
        turned = self.line("eq", high, a.high, kind="bool")
        return Pair(high, self.line("select", turned, a.low, self.line("neg", a.low)))

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
        turned = self.turned(Pair(angle))
        across = self.sub(self.mul(y, turned["cos"]), self.mul(x, turned["sin"]))
        along = self.line(
            "add", self.line("mul", x.high, turned["cos"].high), self.line("mul", y.high, turned["sin"].high)
        )
        step = self.line("div", across.high, along)
        none = self.line("eq", along, 0.0, kind="bool")
        return self.quick(angle, self.line("select", none, 0.0, step))

    def turned(self, angle: Pair) -> dict[str, Pair]:
        """Sine and cosine of an angle, once."""
        if angle not in self.angles:
            scaled = self.line("mul", angle.high, self.constants.two_over_pi)
            quarters = self.line("floor", self.line("add", scaled, 0.5))
            y = self._reduced(angle, quarters)
            z = self.mul(y, y)
            cubic = self.mul(self.mul(y, z), self._polynomial(z, self.constants.sine))
            quartic = self.mul(self.mul(z, z), self._polynomial(z, self.constants.cosine))
            whole = self.add(Pair(1.0), self.mul(Pair(-0.5), z))
            self.angles[angle] = self._placed(quarters, self.larger(y, cubic), self.larger(whole, quartic))
        return self.angles[angle]

    def larger(self, a: Pair, b: Pair) -> Pair:
        """a + b where a is the larger one and they do not cancel."""
        high, low = self.quick(a.high, b.high)
        for part in (a, b):
            low = low if part.single else self.line("add", low, part.low)
        return self.quick(high, low)

    def _reduced(self, angle: Pair, quarters: str) -> Pair:
        """angle - quarters pi/2; each product but the last is exact."""
        first, *others = self.constants.pi_half
        result = Pair(self.line("sub", angle.high, self.line("mul", quarters, first)), angle.low)  # exact
        for part in others:
            result = self.add(result, Pair(self.line("neg", self.line("mul", quarters, part))))
        return result

    def _polynomial(self, z: Pair, coefficients: tuple[tuple[float, float], ...]) -> Pair:
        """Horner: in doubles where the terms are small, in pairs where they are not."""
        *rest, (value, _) = coefficients
        total = Pair(value)
        for high, low in reversed(rest):
            if low:
                total = self.larger(Pair(high, low), self.mul(z, total))
            else:
                product = self.line("mul", total.high, z.high)
                total = Pair(self.line("add", product, high))
        return total

    def _placed(self, quarters: str, sine: Pair, cosine: Pair) -> dict[str, Pair]:
        """Swap and sign by the quarter, which is counted modulo 4 in floats."""
        rounds = self.line("floor", self.line("mul", quarters, 0.25))
        quarter = self.line("sub", quarters, self.line("mul", 4.0, rounds))
        odd = Pair(self.line("eq", self.line("abs", self.line("sub", quarter, 2.0)), 1.0, kind="bool"))
        across, along = self.select(odd, cosine, sine), self.select(odd, sine, cosine)
        lower = Pair(self.line("le", 2.0, quarter, kind="bool"))
        away = self.line("abs", self.line("sub", quarter, 1.5))
        behind = Pair(self.line("eq", away, 0.5, kind="bool"))
        return {
            "sin": self.select(lower, self.neg(across), across),
            "cos": self.select(behind, self.neg(along), along),
        }


def _is_power_of_two(a: Pair) -> bool:
    """Whether it is a constant that scales without rounding."""
    if not (a.single and isinstance(a.high, float)) or a.high == 0.0:
        return False
    ratio = abs(a.high).as_integer_ratio()
    return all(part & (part - 1) == 0 for part in ratio)


_RULES: Mapping[str, Callable[..., Pair]] = {
    "copy": lambda writer, a: a,
    "add": _Writer.add,
    "sub": _Writer.sub,
    "mul": _Writer.mul,
    "muladd": lambda writer, a, b, c: writer.add(writer.mul(a, b), c),
    "turned": _Writer.quarter_turned,
    "div": _Writer.div,
    "neg": _Writer.neg,
    "abs": _Writer.size,
    "sqrt": _Writer.sqrt,
    "atan2": _Writer.atan2,
    "floor": _Writer.floor,
    "copysign": _Writer.copysign,
    "select": _Writer.select,
}
