"""Inputs that are not known exactly: a value and its tolerance, or a distribution."""

from math import inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.inputs import row_of
from ...mechanism.messages import amount
from ...mechanism.ranges import Between, PlusMinus, middle_of, refuse_bare_pair
from ...mechanism.read import in_si
from ...mechanism.read import read as read_number
from ...units.system import Conversion
from ...units.text import PLUS_MINUS, with_unit_of

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
    pair = _pair(name, value)
    if pair is None:
        return _number(name, value)
    nominal, tolerance = pair
    if not 0.0 <= tolerance < inf:
        text = f"{name}: a tolerance of " + amount(name, tolerance, "g")
        raise ValueError(text + "; it must be finite and at least 0")
    if tolerance == 0.0:
        return nominal
    if distribution == "uniform":
        return Inexact(name, nominal, tolerance / sqrt(3.0), tolerance, "uniform")
    return Inexact(name, nominal, tolerance / sigmas, tolerance, "normal")


def _pair(name: str, value: Any) -> tuple[float, float] | None:
    """Value and tolerance of a range, or of a text such as "10 mm +- 0.1 mm"; None for an exact input."""
    if isinstance(value, str):
        parts = [part.strip() for part in PLUS_MINUS.split(value)]
        if len(parts) == 1:
            return None
        if len(parts) > 2:
            raise ValueError(f'{name} = {value!r}: expected one value and its tolerance, "10 mm +- 0.1 mm"')
        value = PlusMinus(*parts)
    if isinstance(value, Between):
        middle, half = middle_of(name, value)
        return _number(name, middle), half
    if isinstance(value, PlusMinus):
        return _with_tolerance(name, value)
    refuse_bare_pair(name, value)
    if isinstance(value, (tuple, list)):
        raise ValueError(
            f"{name} = {value!r}: expected a pair (value, tolerance), dx.plus_minus(value, tolerance), or a "
            "range, dx.between(low, high)"
        )
    return None


def _with_tolerance(name: str, value: PlusMinus) -> tuple[float, float]:
    """The two numbers of a value and its tolerance."""
    nominal = _number(name, value[0])
    second: Any = with_unit_of(*value)
    if isinstance(second, str) and second.strip().endswith("%"):
        return nominal, _percent(name, second) * abs(nominal)
    if isinstance(second, str) or hasattr(second, "magnitude"):
        return nominal, float(in_si(row_of(name), second))
    try:
        return nominal, float(second)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: expected a pair (value, tolerance) of numbers") from None


def _percent(name: str, text: str) -> float:
    try:
        return float(text.strip().removesuffix("%")) / 100.0
    except ValueError:
        raise ValueError(f"{name}: a tolerance of {text!r}; percents are written as '0.5 %'") from None


def _number(name: str, value: Any) -> float:
    return read_number(row_of(name), value, "tolerance", EXPECTED)
