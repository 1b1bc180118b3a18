"""A Program in ball arithmetic (python-flint's `arb`): enclosures of its lines over a box of inputs.

Over the reals, the two sides of some selects are the same function (they differ in rounding alone):
where a ball does not decide such a condition, either side will do, and both may be intersected. Any
other undecided condition gives the hull of both sides. So each ball holds the values at all points
of the box at which they are defined, and flags say what else is known:

PARTLY   undefined at some point of the box, perhaps: a root of what may be negative, a stalled crank,
         friction that may jam
JUMPS    may be discontinuous in the box: a condition with two different sides is not decided

The signs of sin(theta) and of u are chosen once for a box: with sigma = 1 or -1 for the one, sigma
sin(theta) for |sin(theta)| and nu = 1 or -1 for the other, all equations of the derivation are identities
for either sigma and nu. So they are for either answer to the questions whether the crank is near a quarter
and whether it and the rod fold back on each other, if it is the same answer everywhere.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from flint import arb, ctx

from ..compiler.passes.differentiate import original
from ..compiler.program import Argument, Line, Program
from ..mechanism.own_lines import PREFIX

Interval = tuple[float, float]
Value = Any  # an arb, None where it is undefined in all of the box; a bool, None where it is undecided

PARTLY, JUMPS = 1, 2
BITS = 128
# Selects whose sides are the same function.
SAME = ("bend", "phi_wrt_theta_theta_theta", "phi_wrt_theta_theta_theta_theta")
NEAR_QUARTER = ("le", (0.5, "abs_sin"))


class Enclosure(NamedTuple):
    """The balls of the outputs, and the flags of the first of them."""

    values: tuple[Value, ...]
    flags: int


def ball(interval: Interval) -> Any:
    """The smallest ball around an interval."""
    low, high = interval
    return arb(low) if low == high else arb(low).union(arb(high))


def enclosures(program: Program, box: Mapping[str, Interval], bits: int = BITS) -> Enclosure:
    """Enclosures of the outputs of a program over a box, in `bits` of precision."""
    with ctx.workprec(bits):
        run = _Run(program, box)
        for line in program.lines:
            run.step(line)
        values = tuple(run.scope[name] for name in program.outputs)
        return Enclosure(values, run.flags.get(program.outputs[0], 0))


class _Run:
    """A run of a program: the balls and flags of the lines evaluated so far, by name."""

    def __init__(self, program: Program, box: Mapping[str, Interval]) -> None:
        self.box = box
        self.scope: dict[str, Value] = {name: ball(box[name]) for name in program.inputs}
        self.flags: dict[str, int] = {}
        self.conditions: dict[Argument, Line] = {}
        self.out = 1  # sigma nu

    def step(self, line: Line) -> None:
        name, op, args, kind = line
        flag = 0
        if kind == "bool":
            self.conditions[name] = line
            value = self._condition(op, args)
            flag = self._flag(args)
        elif op == "select":
            value, flag = self._select(name, args)
        else:
            here = [self.value(a) for a in args]
            flag = self._flag(args)
            value = None if None in here else self._number(line, here)
            own = name.startswith(PREFIX) and op in ("sqrt", "log", "pow")
            if (own or (op == "sqrt" and args == ("D",))) and value is not None and not here[0] > 0:
                flag |= PARTLY
        self.scope[name] = value
        if flag:
            self.flags[name] = flag

    def value(self, argument: Argument) -> Value:
        if isinstance(argument, str):
            return self.scope[argument]
        if isinstance(argument, float):
            return arb(argument) if argument == argument else None
        return argument

    def _flag(self, args: tuple[Argument, ...]) -> int:
        flag = 0
        if self.flags:
            for argument in args:
                if isinstance(argument, str):
                    flag |= self.flags.get(argument, 0)
        return flag

    def _number(self, line: Line, here: list[Any]) -> Value:
        name, op, args, _ = line
        if original(name) == "abs_sin":
            return here[0] * self._sigma()
        if name == "side":
            return arb(self._sigma())
        if name == "AB_out":
            self.out = self._out(here[1])
        if name == "pin_side":
            return arb(self.out * self._sigma())
        if original(name) == "AB_out":
            return here[0] * self.out
        if op == "mul" and args[0] == args[1]:
            return (here[0] * here[0]).nonnegative_part()
        if op == "atan2" and args[0] == "S":  # S is not negative: no half turn is lost
            return arb.pi() / 2 - arb.atan2(here[1], here[0])
        return _NUMBERS[op](*here)

    def _out(self, x: Any) -> int:
        return 1 if x.mid() >= 0 else -1

    def _sigma(self) -> int:
        return -1 if self.scope["sin_theta"] < 0 else 1

    def _condition(self, op: str, args: tuple[Argument, ...]) -> bool | None:
        here = [self.value(a) for a in args]
        if op in _LOGIC:
            return _LOGIC[op](*here)
        if None in here:  # as NaN compares
            return False
        if op == "eq" and here[0] is here[1]:  # a copy
            return True
        (a, b), (c, d) = (self._ends(argument, x) for argument, x in zip(args, here, strict=True))
        if op == "eq":
            return True if a == b == c == d else False if b < c or d < a else None
        if (op, args) == NEAR_QUARTER or (op, args[1]) == ("lt", "S"):  # either answer will do
            return bool(here[0].mid() < here[1].mid())
        if op == "lt":
            return True if b < c else False if a >= d else None
        return True if b <= c else False if a > d else None

    def _ends(self, argument: Argument, x: Any) -> tuple[Any, Any]:
        """End points of a ball; for an input, its exact interval."""
        ends = self.box.get(argument) if isinstance(argument, str) else None
        return (x.lower(), x.upper()) if ends is None else (arb(ends[0]), arb(ends[1]))

    def _select(self, name: str, args: tuple[Argument, ...]) -> tuple[Value, int]:
        condition, sides = args[0], args[1:]
        decided = self.value(condition)
        if decided is not None:
            side = sides[0 if decided else 1]
            return self.value(side), self._flag((condition, side))
        flag = self._flag(args)
        first, second = map(self.value, sides)
        if first is None or second is None:
            return (second if first is None else first), flag | PARTLY
        if original(name) in SAME:
            return _common(first, second), flag
        _, op, compared, _ = self.conditions[condition]
        if op == "lt" and sides == (-1.0, compared[0]):  # the sign of x, after x > 0: x stands for 0
            second = arb(0)
        return first.union(second), flag | (0 if op == "eq" else JUMPS)  # a limit that the other side has


def _common(first: Any, second: Any) -> Any:
    """The intersection of two enclosures of one value."""
    if not first.is_finite():
        return second
    return first.intersection(second) if second.is_finite() else first


def _root(x: Any) -> Any:
    """The root of the non-negative part of a ball."""
    if x > 0:
        return x.sqrt()
    return None if x < 0 else arb(0).union(x.upper().sqrt())


def _product(a: Any, b: Any) -> Any:
    """a b; from the ends where the product of balls, which is wider, leaves the sign open."""
    product = a * b
    if product > 0 or product < 0 or a.is_exact() or b.is_exact() or not product.is_finite():
        return product
    ends = [x * y for x in (a.lower(), a.upper()) for y in (b.lower(), b.upper())]
    return ends[0].union(ends[1]).union(ends[2]).union(ends[3])


def _power(a: Any, b: Any) -> Any:
    """a to a power that is no integer, of the non-negative part of a."""
    if a > 0:
        return a**b
    return None if a < 0 or not b > 0 else arb(0).union(a.upper() ** b)


def _and(a: bool | None, b: bool | None) -> bool | None:
    return False if a is False or b is False else True if a and b else None


def _not(a: bool | None) -> bool | None:
    return None if a is None else not a


_LOGIC: dict[str, Callable[..., bool | None]] = {
    "and": _and,
    "or": lambda a, b: _not(_and(_not(a), _not(b))),
    "not": _not,
    "extended_only": lambda a: False,
}


def _rotated_sin(sine: Any, cosine: Any, quarters: Any) -> Any:
    """The sine after a number of quarter turns; the union over all numbers in an uncertain one."""
    whole = quarters.unique_fmpz()
    if whole is None:
        return sine.union(-sine).union(cosine).union(-cosine)
    return (sine, cosine, -sine, -cosine)[int(whole) % 4]


_NUMBERS: dict[str, Callable[..., Any]] = {
    "copy": lambda a: a,
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": _product,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "abs": lambda a: abs(a).nonnegative_part(),
    "sqrt": _root,
    "sin": lambda a: a.sin(),
    "cos": lambda a: a.cos(),
    "atan2": arb.atan2,
    "hypot": lambda a, b: _root((a * a).nonnegative_part() + (b * b).nonnegative_part()),
    "exp": lambda a: a.exp(),
    "log": lambda a: a.log() if a > 0 else None if a <= 0 else arb.neg_inf().union(a.upper().log()),
    "pow": _power,
    "copysign": lambda a, b: a if b > 0 else -a if b < 0 else a.union(-a),  # of a positive a
    "two_sum_error": lambda a, b: arb(0),  # nothing is rounded
    "two_product_error": lambda a, b: arb(0),
    "mul_add": lambda a, b, c: _product(a, b) + c,
    "rounding": lambda a: arb(0),
    "power_of_two": lambda a: arb(1),  # no value depends on it
    "rotated_sin": _rotated_sin,
    "rotated_cos": lambda sine, cosine, quarters: _rotated_sin(cosine, -sine, quarters),
}
