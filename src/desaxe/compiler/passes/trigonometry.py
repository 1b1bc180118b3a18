"""Sine and cosine written out: no call, no branch, so that the loop vectorises.

The angle is reduced by whole quarters q to |y| <= pi/4. pi/2 comes in parts so short that q times a
part is exact: next to a multiple of pi/2, where the rod's geometry needs cos(theta) to its last digit,
all differences are exact but the last, and nothing is lost. A program in plain forms has no such need: for
it, two words of pi/2 do, which lose nothing where products are fused with their sums, and elsewhere what the
angle's own last digit is worth.
"""

from typing import NamedTuple

from ..program import Argument, Line, Program
from .guard import GUARDED
from .slicing import drop_unused


class Trigonometry(NamedTuple):
    """The constants of the expansion, made by the derivation."""

    limit: float  # of |angle|; beyond it the expansion is wrong
    two_over_pi: float
    pi_half: tuple[float, ...]
    pi_half_words: tuple[float, ...]
    sine: tuple[float, ...]
    cosine: tuple[float, ...]


def expand_trigonometry(program: Program, constants: Trigonometry, plain: bool = False) -> Program:
    """The program without sin and cos.

    Precondition: |angle| <= constants.limit wherever the result matters; in a `plain` program the angle may
    be wrong by half its last digit. Effect: each `sin` and `cos` of an input becomes arithmetic; both of the
    same angle share all of it. Error at most 2 ulp. Those of an expression, of any size, stay calls.
    """
    writer = _Writer(constants, constants.pi_half_words if plain else constants.pi_half)
    for line in program.lines:
        if line.op in ("sin", "cos") and _is_input(line.args[0], program):
            writer.lines.append(line._replace(op="copy", args=(writer.of_angle(line.args[0], line.op),)))
        else:
            writer.lines.append(line)
    return drop_unused(program._replace(lines=tuple(writer.lines)))


def _is_input(angle: Argument, program: Program) -> bool:
    """True for an input, checked or not."""
    return isinstance(angle, str) and angle.removesuffix(GUARDED) in program.inputs


class _Writer:
    """Appends lines; knows which angles have been expanded."""

    def __init__(self, constants: Trigonometry, pi_half: tuple[float, ...]) -> None:
        self.constants = constants
        self.pi_half = pi_half
        self.lines: list[Line] = []
        self.known: dict[Argument, dict[str, str]] = {}
        self.count = 0

    def line(self, op: str, *args: Argument, kind: str = "f64") -> str:
        self.count += 1
        self.lines.append(Line(f"_trig{self.count}", op, args, kind))
        return self.lines[-1].name

    def of_angle(self, angle: Argument, op: str) -> str:
        """The name of its sine or cosine."""
        if angle not in self.known:
            quarters = self._quarters(angle)
            rest = self._reduced(angle, quarters)
            sides = self._sine(rest), self._cosine(rest)
            self.known[angle] = {
                "sin": self.line("rotated_sin", *sides, quarters),
                "cos": self.line("rotated_cos", *sides, quarters),
            }
        return self.known[angle][op]

    def _quarters(self, angle: Argument) -> str:
        turns = self.line("mul", angle, self.constants.two_over_pi)
        return self.line("floor", self.line("add", turns, 0.5))

    def _reduced(self, angle: Argument, quarters: str) -> str:
        """angle - quarters pi/2; products with parts are exact, and so is every difference that cancels."""
        rest: Argument = angle
        for part in self.pi_half:
            rest = self.line("sub", rest, self.line("mul", quarters, part))
        return str(rest)

    def _polynomial(self, z: str, coefficients: tuple[float, ...]) -> str:
        *rest, value = coefficients
        result: Argument = value
        for coefficient in reversed(rest):
            op = "sub" if coefficient < 0.0 else "add"
            result = self.line(op, self.line("mul", result, z), abs(coefficient))
        return str(result)

    def _sine(self, y: str) -> str:
        """y + y z P(z)."""
        z = self.line("mul", y, y)
        cubic = self.line("mul", self.line("mul", y, z), self._polynomial(z, self.constants.sine))
        return self.line("add", y, cubic)

    def _cosine(self, y: str) -> str:
        """1 - z/2 + z^2 Q(z)."""
        z = self.line("mul", y, y)
        whole = self.line("sub", 1.0, self.line("mul", 0.5, z))
        quartic = self.line("mul", self.line("mul", z, z), self._polynomial(z, self.constants.cosine))
        return self.line("add", whole, quartic)
