"""Numbers as sums of two or three doubles: the building blocks of their arithmetic.

What an addition or a product rounds away is itself a double (two-sum; two-product by a fused multiply-add)
and is kept as a lower word. All of it is straight-line code without branches.
Source of the algorithms: Dekker 1971; Knuth; Joldes, Muller, Popescu 2017.
"""

from collections.abc import Sequence
from typing import NamedTuple

from ..program import Argument, Line


class Pair(NamedTuple):
    """The sum of two names or constants; a low part of 0.0 means a plain double."""

    high: Argument
    low: Argument = 0.0

    @property
    def single(self) -> bool:
        """True if there is no low part."""
        return _is_nothing(self.low)


Words = tuple[Argument, ...]  # a sum of up to three, the larger ones first


def _is_nothing(argument: Argument) -> bool:
    return argument == 0.0 and not isinstance(argument, str)


class Expansions:
    """Appends lines of sums and products that are exact, or exact to three components."""

    def __init__(self) -> None:
        self.lines: list[Line] = []
        self.types: dict[str, str] = {}

    def line(self, op: str, *args: Argument, kind: str = "f64") -> str:
        """Append a line; return its name."""
        name = f"_d{len(self.lines)}"
        self.lines.append(Line(name, op, args, kind))
        self.types[name] = kind
        return name

    # ---- exact -----------------------------------------------------------------------------------

    def two_sum(self, a: Argument, b: Argument) -> Pair:
        """a + b, exactly."""
        return Pair(self.line("add", a, b), self.line("two_sum_error", a, b))

    def quick(self, a: Argument, b: Argument) -> Pair:
        """a + b, exactly, where a is the larger one."""
        total = self.line("add", a, b)
        return Pair(total, self.line("sub", b, self.line("sub", total, a)))

    def two_product(self, a: Argument, b: Argument) -> Pair:
        """a b, exactly."""
        return Pair(self.line("mul", a, b), self.line("two_product_error", a, b))

    # ---- up to three words -----------------------------------------------------------------------

    def negative(self, words: Words) -> Words:
        """The components of -a."""
        return tuple(self.line("neg", word) for word in words)

    def chosen(self, condition: Argument, first: Words, second: Words) -> Words:
        """The components of `first` if the condition is true, else those of `second`."""
        count = max(len(first), len(second))
        pairs = zip(_padded(first, count), _padded(second, count), strict=True)
        return tuple(self.line("select", condition, a, b) for a, b in pairs)

    def sum_of(self, *numbers: Words, ordered: bool = False) -> Words:
        """A sum in three components; `ordered`: of two numbers, the larger one first."""
        levels = [[number[size] for number in numbers if len(number) > size] for size in range(3)]
        return self.by_size(levels, ordered)

    def product(self, a: Words, b: Words) -> Words:
        """A product in three components."""
        levels = self.product_levels(_padded(a, 3), _padded(b, 3))
        return self.by_size(levels)

    def product_levels(self, a: Words, b: Words) -> list[list[Argument]]:
        """The terms of a product of two three-component numbers, by magnitude."""
        levels: list[list[Argument]] = [[], [], []]
        for i, x in enumerate(a):
            for j, y in enumerate(b):
                if i + j > 2 or _is_nothing(x) or _is_nothing(y):
                    continue
                levels[i + j].append(self.line("mul", x, y))
                if i + j < 2:
                    levels[i + j + 1].append(self.line("two_product_error", x, y))
        return levels

    def by_size(self, levels: Sequence[Sequence[Argument]], ordered: bool = False) -> Words:
        """The components of the sum of all terms; each level is some 53 bits below the one before.

        What each addition rounds away goes to the level below; there is none below the last.
        """
        words: list[Argument] = []
        lost: list[Argument] = []
        for size, level in enumerate(levels[:-1]):
            terms, lost = [*level, *lost], []
            total: Argument = terms[0] if terms else 0.0
            for term in terms[1:]:
                pair = self.quick(total, term) if ordered and size == 0 else self.two_sum(total, term)
                total = pair.high
                lost.append(pair.low)
            words.append(total)
        return (*words, self.plain_sum([*levels[-1], *lost]))

    def plain_sum(self, terms: Sequence[Argument]) -> Argument:
        """The sum in doubles."""
        total: Argument = terms[0] if terms else 0.0
        for term in terms[1:]:
            total = self.line("add", total, term)
        return total

    def ordered(self, words: Words) -> Words:
        """Renormalise three components, the first by far the largest, so that they do not overlap."""
        first, second, third = words
        high = self.quick(first, second)
        return (high.high, *self.quick(high.low, third))

    def after_cancelling(self, words: Words) -> Pair:
        """The sum of three components, of which the first may have cancelled, as a double-double."""
        first, second, third = _padded(words, 3)
        lower = self.two_sum(second, third)
        upper = self.two_sum(first, lower.high)
        rest = self.two_sum(upper.low, lower.low)
        return self.two_sum(upper.high, rest.high)


def _padded(words: Words, count: int) -> Words:
    return (*words, *[0.0] * (count - len(words)))
