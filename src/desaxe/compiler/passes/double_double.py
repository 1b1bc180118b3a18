"""Twice the digits: every number becomes an unevaluated sum of two doubles.

A value is `high + low`, where `high` is the sum rounded to a double, so `low` holds the next 53 bits.
What an addition or a product rounds away is itself a double (two-sum; two-product by a fused
multiply-add) and is kept. The loop stays straight-line code without branches, so it vectorises like
the plain one. Where a low part is known to be 0, as for inputs and constants, nothing is done for it.

The pass keeps twice the digits of the program it is given, no more: it belongs on a program that is
stable to begin with. One difference needs more: of BC - |u|, at the last double inside a limit angle,
half of the digits of a pair cancel. So this gap, and what it is made of, is formed in three words.
"""

from ..program import Argument, Line, Program, names_in
from .double_angles import DoubleTrigonometry
from .expansions import Pair, Words
from .fold import fold_constants
from .pairs import RULES, Pairs
from .slicing import drop_unused
from .value_numbering import value_numbering

WIDE = ("copy", "add", "sub", "neg", "mul", "select")  # what three words are kept through


def double_double(program: Program, constants: DoubleTrigonometry) -> Program:
    """The program in double-double; its outputs are the high parts, rounded once.

    Precondition: |angle| <= constants.limit wherever the result matters. Effect: values that are
    finite keep about 100 bits; comparisons look at high parts; an infinity may become NaN. Error terms
    of two-sum and two-product are 0, because the sums and products themselves keep them; so is `rounding`.
    The line constants.complement is known to be 1 - |sine|, and is taken from the angle.
    """
    writer = _Writer(program, constants)
    for line in program.lines:
        writer.assign(line)
    wide = program._replace(lines=tuple(writer.lines))
    return drop_unused(value_numbering(fold_constants(wide)))


def with_extended_only_forms(program: Program) -> Program:
    """The program with `extended_only(x)` as x: it takes the forms that only twice the digits need.

    Precondition: not folded yet, which makes them false.
    """
    lines = (line._replace(op="copy") if line.op == "extended_only" else line for line in program.lines)
    return program._replace(lines=tuple(lines))


class _Writer(Pairs):
    """Appends lines; maps every name to its double-double, and the terms of the gap to three components."""

    def __init__(self, program: Program, constants: DoubleTrigonometry) -> None:
        super().__init__(constants)
        self.pairs: dict[str, Pair] = {name: Pair(name) for name in program.inputs}
        self.types |= dict.fromkeys(program.inputs, "f64")
        self.words: dict[str, Words] = {}
        self.wide = _made_of(program, constants.gap)
        self.sizes: set[Argument] = set()  # what is not negative

    def assign(self, line: Line) -> None:
        """Write a line of the plain program; its high part gets its name."""
        self.types[line.name] = line.type
        if line.type != "f64":
            self.lines.append(self.decided(line))
            self.pairs[line.name] = Pair(line.name)
            return
        words = self.in_three_words(line)
        if words:
            self.words[line.name] = words
        result = self.pair_of(line, words)
        self.lines.append(Line(line.name, "copy", (result.high,)))
        self.pairs[line.name] = result._replace(high=line.name) if isinstance(result.high, str) else result
        if _is_sign(line, self.signs):
            self.signs.add(line.name)
        if line.op == "abs":
            self.sizes.add(line.name)

    def decided(self, line: Line) -> Line:
        """A boolean or integer line: it compares high parts. No magnitude is below 0."""
        args = tuple(self.of(a).high if isinstance(a, str) else a for a in line.args)
        if line.op == "lt" and args[0] in self.sizes and args[1] == 0.0:
            return line._replace(op="copy", args=(False,))
        return line._replace(args=args)

    def pair_of(self, line: Line, words: Words) -> Pair:
        """The double-double of a line; `words` are its three components, if it has them."""
        if words and line.name == self.constants.gap:
            return self.after_cancelling(words)
        if words and (line.name == self.constants.complement or line.op == "sin"):
            return Pair(*words[:2])
        if line.op == "cos":
            return self.rotated_sin(self.of(line.args[0])).cos
        if line.op in ("two_sum_error", "two_product_error", "rounding"):
            return Pair(0.0)
        return RULES[line.op](self, *map(self.of, line.args))

    def of(self, argument: Argument) -> Pair:
        """The double-double of an argument; booleans and integers stand for themselves."""
        return self.pairs[argument] if isinstance(argument, str) else Pair(argument)

    def words_of(self, argument: Argument) -> Words:
        """All components of an argument: one to three."""
        if isinstance(argument, str) and argument in self.words:
            return self.words[argument]
        pair = self.of(argument)
        return (pair.high,) if pair.single else tuple(pair)

    def in_three_words(self, line: Line) -> Words:
        """Three components of the sine, of 1 - |sine| and of the terms of the gap; none for other lines."""
        if line.op == "sin":
            return self.rotated_sin(self.of(line.args[0])).sin
        if line.name == self.constants.complement and self.angles:
            return next(reversed(self.angles.values())).complement
        if line.name not in self.wide:
            return ()
        if line.op == "select":
            return self.chosen(self.of(line.args[0]).high, *map(self.words_of, line.args[1:]))
        words = [self.words_of(a) for a in line.args]
        if line.op == "mul":
            for sign, other in (words, words[::-1]):
                if sign[0] in self.signs:
                    return tuple(self.line("mul", sign[0], word) for word in other)
            return self.product(*words)
        if line.op == "neg" or line.op == "sub":
            words[-1] = self.negative(words[-1])
        return self.sum_of(*words)


def _made_of(program: Program, gap: str) -> set[str]:
    """The gap and the lines that it is a sum, product or select of."""
    requested = {gap}
    for line in reversed(program.lines):
        if line.name in requested and line.op in WIDE:
            requested.update(names_in(line.args[line.op == "select" :]))
    return {line.name for line in program.lines if line.name in requested and line.op in WIDE}


def _is_sign(line: Line, signs: set[Argument]) -> bool:
    """True if a line is 1 or -1 for any inputs."""
    values = {"copysign": line.args[:1], "select": line.args[1:], "neg": line.args, "copy": line.args}
    return line.op in values and all(value in signs for value in values[line.op])
