"""The kinds of reductions: what each is called, and what it is of rows of numbers in memory.

A kind is a row of `OTHERS` (a number made of all) or of `EXTREMES` (one of them, which has a place).
"""

import re
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.spelling import did_you_mean
from ...support.forks import imported
from ...support.shown import shown

Array = NDArray[Any]

# Those that exported modules have, too (`scenes/export/functions.py`), as CF's `cell_methods` call them.
KINDS = {
    "max": "maximum",
    "min": "minimum",
    "absmax": "maximum_absolute_value",
    "mean": "mean",
    "rms": "root_mean_square",
}


class Extreme(NamedTuple):
    """The sample of a row with the largest score; `method` as CF's `cell_methods` say it."""

    method: str
    score: Callable[[Array], Array]
    result: Callable[[Array], Array] = np.asarray
    combines: bool = True


class Average(NamedTuple):
    """A number made of rows, and of the numbers of points that each of their values stands for: one without.

    combines   whether that of a row follows from those of its parts
    """

    method: str
    of_rows: Callable[[Array, Array | None], Array]
    combines: bool = False


def exact_sum(rows: Array) -> Array:
    """The sum of each row, as if its rounding were that of a few operations; infinite where a value is.

    Beside a power of two that is larger than the sum of magnitudes each number splits into a high part, whose
    sum is exact, and a small rest.
    """
    largest = np.abs(rows).max(axis=-1, keepdims=True, initial=0.0)
    power = np.ldexp(1.0, np.minimum(np.frexp(largest)[1] + rows.shape[-1].bit_length(), 1023))
    high = (rows + power) - power
    total = high.sum(axis=-1) + (rows - high).sum(axis=-1)
    return np.asarray(np.where(np.isfinite(total), total, rows.sum(axis=-1)))


def _mean(rows: Array, counts: Array | None) -> Array:
    if counts is None:
        return np.asarray(exact_sum(rows) / rows.shape[-1])
    return np.asarray(exact_sum(np.where(counts > 0, rows * counts, 0.0)) / counts.sum(axis=-1))


def _scaled_root(rows: Array, counts: Array | None) -> Array:
    """The root of the mean square, of any scale: a power of two brings the squares into range."""
    sizes = np.abs(rows).max(axis=-1, initial=0.0)
    if ((sizes < 2.0**500) & (sizes > 2.0**-400)).all():
        return np.asarray(np.sqrt(_mean(rows * rows, counts)))
    largest = np.nanmax(np.where(np.isinf(rows), np.nan, np.abs(rows)), axis=-1, keepdims=True)
    factor = np.ldexp(1.0, -np.frexp(np.where(largest > 0.0, largest, 1.0))[1].clip(-1000, 1000))
    return np.asarray(np.sqrt(_mean((rows * factor) ** 2, counts)) / factor[..., 0])


def _deviation(rows: Array, counts: Array | None) -> Array:
    return _scaled_root(rows - _mean(rows, counts)[..., None], counts)


def _percentile(percent: float, rows: Array, counts: Array | None) -> Array:
    imported("numpy.ma")  # by `nanpercentile`
    return np.asarray(np.nanpercentile(rows, percent, axis=-1))


EXTREMES = {
    "max": Extreme(KINDS["max"], np.asarray),
    "min": Extreme(KINDS["min"], np.negative),
    "absmax": Extreme(KINDS["absmax"], np.abs, np.abs),
}
OTHERS = {
    "mean": Average(KINDS["mean"], _mean, True),
    "rms": Average(KINDS["rms"], _scaled_root, True),
    "std": Average("standard_deviation", _deviation),  # of all points, divided by their number
    "median": Average("median", partial(_percentile, 50.0)),
}
NAMES = (*EXTREMES, *OTHERS)
ALLOWED = f"{', '.join(NAMES)}, and percentiles such as p95"


def kind_of(kind: Any) -> str:
    """A kind as it is called: "max", "std", "p95"."""
    if isinstance(kind, (tuple, list)) and len(kind) == 2 and kind[0] == "percentile":
        kind = f"p{kind[1]:g}" if isinstance(kind[1], (int, float)) else f"p{kind[1]}"
    if isinstance(kind, str) and kind in NAMES:
        return kind
    if isinstance(kind, str) and re.fullmatch(r"p\d+(\.\d+)?", kind):
        if float(kind[1:]) > 100.0:
            raise ValueError(f"reduce: {kind!r}: a percentile is from p0 to p100")
        return f"p{float(kind[1:]):g}"
    raise ValueError(f"reduce: {shown(kind)}: {did_you_mean(str(kind)[:40], NAMES)}allowed: {ALLOWED}")


def kind_called(name: str) -> Extreme | Average:
    """The kind of a name that `kind_of` gives."""
    if name in EXTREMES:
        return EXTREMES[name]
    return OTHERS.get(name) or Average(f"percentile_{name[1:]}", partial(_percentile, float(name[1:])))


def place(kind: Extreme, rows: Array, good: Array | None) -> Array:
    """The index of the extreme of each row, the first of equals; -1 where nothing is good (None: all is)."""
    if not rows.shape[-1]:
        return np.full(rows.shape[:-1], -1)
    if good is None:
        return np.asarray(np.argmax(kind.score(rows), axis=-1))
    # Before the first -inf that is a number there may be one that stands for a NaN.
    found = np.argmax(np.where(good, kind.score(rows), -np.inf) + np.where(good, 0.0, -np.inf), axis=-1)
    found = np.where(np.take_along_axis(good, found[..., None], -1)[..., 0], found, np.argmax(good, axis=-1))
    return np.where(good.any(axis=-1), found, -1)


def average(kind: Average, rows: Array, counts: Array | None) -> Array:
    """A mean, a percentile or another average of each row."""
    if not rows.shape[-1]:
        return np.full(rows.shape[:-1], np.nan)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)  # a row without a number is NaN
        return kind.of_rows(rows, counts)
