"""Sine and cosine written out: no call, no branch, so that the loop vectorises.

The angle is reduced by whole quarters q to |y| <= pi/4. pi/2 comes in parts so short that q times a
part is exact, and what each subtraction rounds away is kept in a second word: next to a multiple
of pi/2, where the rod's geometry needs cos(theta) to its last digit, nothing is lost.
"""

from typing import NamedTuple

from ..program import Argument, Line, Program
from .slicing import drop_unused


class Trigonometry(NamedTuple):
    """The constants of the expansion, made by the derivation."""

    limit: float  # of |angle|; beyond it the expansion is wrong
    two_over_pi: float
    pi_half: tuple[float, ...]
    sine: tuple[float, ...]
    cosine: tuple[float, ...]


def expand_trigonometry(program: Program, constants: Trigonometry, light: bool = False) -> Program:
    """The program without sin and cos.

    Precondition: |angle| <= constants.limit wherever the result matters. Effect: each `sin` and
    `cos` becomes arithmetic; both of the same angle share all of it. Error at most 1 ulp; a `light`
    one drops what the reduction rounds away, for some ulp x (1 + condition).
    """
    writer = _Light(constants) if light else _Writer(constants)
    for line in program.lines:
        if line.op in ("sin", "cos"):
            writer.lines.append(line._replace(op="copy", args=(writer.of_angle(line.args[0], line.op),)))
        else:
            writer.lines.append(line)
    return drop_unused(program._replace(lines=tuple(writer.lines)))


class _Writer:
    """Appends lines; knows which angles have been expanded."""

    def __init__(self, constants: Trigonometry) -> None:
        self.constants = constants
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
            high, low = self._reduced(angle, quarters)
            self.known[angle] = self._placed(quarters, self._sine(high, low), self._cosine(high, low))
        return self.known[angle][op]

    def _quarters(self, angle: Argument) -> str:
        turns = self.line("mul", angle, self.constants.two_over_pi)
        return self.line("floor", self.line("add", turns, 0.5))

    def _reduced(self, angle: Argument, quarters: str) -> tuple[str, str]:
        """angle - quarters pi/2 as a sum of two doubles."""
        first, *others, last = self.constants.pi_half
        high = self.line("sub", angle, self.line("mul", quarters, first))  # exact
        low = ""
        for part in others:
            step = self.line("neg", self.line("mul", quarters, part))  # exact
            lost = self.line("two_sum_error", high, step)
            high = self.line("add", high, step)
            low = self.line("add", low, lost) if low else lost
        low = self.line("sub", low, self.line("mul", quarters, last))
        total = self.line("add", high, low)
        return total, self.line("add", self.line("sub", high, total), low)

    def _polynomial(self, z: str, coefficients: tuple[float, ...]) -> str:
        *rest, value = coefficients
        result: Argument = value
        for coefficient in reversed(rest):
            op = "sub" if coefficient < 0.0 else "add"
            result = self.line(op, self.line("mul", result, z), abs(coefficient))
        return str(result)

    def _sine(self, y: str, low: str) -> str:
        """y + (y z P(z) + low (1 - z/2)), with the small terms summed first."""
        z = self.line("mul", y, y)
        cubic = self.line("mul", self.line("mul", y, z), self._polynomial(z, self.constants.sine))
        slope = self.line("sub", 1.0, self.line("mul", 0.5, z))
        return self.line("add", y, self.line("add", cubic, self.line("mul", low, slope)))

    def _cosine(self, y: str, low: str) -> str:
        """1 - z/2 + (z^2 Q(z) - y low), with what 1 - z/2 rounds away put back."""
        z = self.line("mul", y, y)
        half = self.line("mul", 0.5, z)
        whole = self.line("sub", 1.0, half)
        lost = self.line("sub", self.line("sub", 1.0, whole), half)
        quartic = self.line("mul", self.line("mul", z, z), self._polynomial(z, self.constants.cosine))
        small = self.line("sub", self.line("add", lost, quartic), self.line("mul", y, low))
        return self.line("add", whole, small)

    def _placed(self, quarters: str, sine: str, cosine: str) -> dict[str, str]:
        """Swap and sign by the quarter, which is counted modulo 4 in floats."""
        rounds = self.line("floor", self.line("mul", quarters, 0.25))
        quarter = self.line("sub", quarters, self.line("mul", 4.0, rounds))
        odd = self.line("eq", self.line("abs", self.line("sub", quarter, 2.0)), 1.0, kind="bool")
        across = self.line("select", odd, cosine, sine)
        along = self.line("select", odd, sine, cosine)
        lower = self.line("le", 2.0, quarter, kind="bool")
        behind = self.line("eq", self.line("abs", self.line("sub", quarter, 1.5)), 0.5, kind="bool")
        return {
            "sin": self.line("select", lower, self.line("neg", across), across),
            "cos": self.line("select", behind, self.line("neg", along), along),
        }


class _Light(_Writer):
    """Without second words."""

    def _reduced(self, angle: Argument, quarters: str) -> tuple[str, str]:
        rest: Argument = angle
        for part in self.constants.pi_half:
            rest = self.line("sub", rest, self.line("mul", quarters, part))
        return str(rest), ""

    def _sine(self, y: str, low: str) -> str:
        """y + y z P(z)."""
        z = self.line("mul", y, y)
        return self.line(
            "add", y, self.line("mul", self.line("mul", y, z), self._polynomial(z, self.constants.sine))
        )

    def _cosine(self, y: str, low: str) -> str:
        """1 - z/2 + z^2 Q(z)."""
        z = self.line("mul", y, y)
        whole = self.line("sub", 1.0, self.line("mul", 0.5, z))
        quartic = self.line("mul", self.line("mul", z, z), self._polynomial(z, self.constants.cosine))
        return self.line("add", whole, quartic)
