"""The designs that share one stroke and time ratio, by x = AB/BC; the equations stand in `synthesize`."""

from math import cos, sin, sqrt, tan
from typing import NamedTuple


class Family(NamedTuple):
    """The designs of one stroke and time ratio, by x = AB/BC."""

    stroke: float
    beta: float

    @property
    def t(self) -> float:
        """tan(beta/2)."""
        return tan(self.beta / 2.0)

    def design(self, x: float) -> dict[str, float]:
        """The lengths."""
        BC = self.stroke / 2.0 / cos(self.beta / 2.0) / sqrt(self.t * self.t + x * x)
        return self.lengths(x * BC, BC)

    def lengths(self, AB: float, BC: float) -> dict[str, float]:
        """The lengths, with the eccentricity that goes with crank and rod."""
        ec = (BC - AB) * (BC + AB) * sin(self.beta) / self.stroke
        return {"ec": ec, "AB": AB, "BC": BC}

    def lean(self, x: float) -> float:
        """The sine of the largest pressure angle."""
        return x + sin(self.beta / 2.0) * (1.0 - x) * (1.0 + x) / sqrt(self.t * self.t + x * x)

    @property
    def upright(self) -> float:
        """x where the rod leans least."""
        t = self.t
        return sqrt(2.0 * t * (1.0 + t * t) / (t + sqrt(4.0 + 5.0 * t * t)))


class Fitting(NamedTuple):
    """The designs found, the range of feasible values of the third requirement, and why there is none."""

    designs: list[dict[str, float]]
    low: float
    high: float
    why: str = ""
