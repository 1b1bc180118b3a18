"""Inputs that are not known exactly: a value and its tolerance, or a distribution."""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.inputs import row_of
from ...mechanism.ranges import Between, PlusMinus, middle_of, refuse_bare_pair, value_and_tolerance
from ...mechanism.read import read as read_number
from ...units.system import Conversion
from ...units.text import PLUS_MINUS

Array = NDArray[np.float64]
DISTRIBUTIONS = ("normal", "uniform")
EXPECTED = "a number, a value and tolerance (dx.plus_minus), a range (dx.between), or a distribution"


class Inexact(NamedTuple):
    """One input: its mean, its standard deviation, and its limits."""

    name: str
    mean: float
    std: float
    tolerance: float | None
    kind: Any  # "normal", "uniform" or a distribution with .ppf

    def drawn(self, random: np.random.Generator, count: int) -> Array:
        """Random samples of the input."""
        if self.kind == "normal":
            return random.normal(self.mean, self.std, count)
        share = random.random(count)
        if self.kind == "uniform":
            return self.mean + (2.0 * share - 1.0) * float(self.tolerance or 0.0)
        return np.asarray(self.kind.ppf(share))


class DistributionInSI:
    """A distribution of numbers in another unit, in SI units: what `read` takes of a frozen one of SciPy."""

    def __init__(self, distribution: Any, conversion: Conversion) -> None:
        self.distribution, self.conversion = distribution, conversion

    def ppf(self, share: Any) -> Any:
        """Quantiles in SI units."""
        return self.conversion.to_si(self.distribution.ppf(share))

    def stats(self, moments: str) -> tuple[float, float]:
        """Mean and variance in SI units."""
        mean, variance = (float(x) for x in self.distribution.stats(moments=moments))
        si = self.conversion.si
        return float(self.conversion.to_si(mean)), variance * float(si * si)


def read(name: str, value: Any, distribution: str, sigmas: float) -> float | Inexact:
    """A number, or an input that is not known exactly; errors name it."""
    if hasattr(value, "ppf"):
        mean, variance = (float(x) for x in value.stats(moments="mv"))
        return Inexact(name, mean, sqrt(variance), None, value)
    if isinstance(value, str) and len(parts := PLUS_MINUS.split(value)) > 1:
        if len(parts) > 2:
            raise ValueError(f'{name} = {value!r}: expected one value and its tolerance, "10 mm +- 0.1 mm"')
        value = PlusMinus(*(part.strip() for part in parts))
    tolerance = 0.0
    if isinstance(value, (PlusMinus, Between)):
        reader: Any = value_and_tolerance if isinstance(value, PlusMinus) else middle_of
        value, tolerance = reader(name, value)
    refuse_bare_pair(name, value)
    if isinstance(value, (tuple, list)):
        rule = "expected a pair (value, tolerance), dx.plus_minus(value, tolerance), or a range, "
        raise ValueError(f"{name} = {value!r}: {rule}dx.between(low, high)")
    nominal = read_number(row_of(name), value, "tolerance", EXPECTED)
    if tolerance == 0.0:
        return nominal
    std = tolerance / (sqrt(3.0) if distribution == "uniform" else sigmas)
    return Inexact(name, nominal, std, tolerance, distribution)
