"""`tolerance`: the scatter of a quantity whose inputs have tolerances, by derivatives, samples and ranges."""

from collections.abc import Mapping, Sequence
from itertools import product
from math import sqrt
from typing import Any

import numpy as np

from ...evaluation.labelled import loads_of
from ...loads.along_motion import with_derivatives
from ...mechanism.catalogue import has, inputs_of, quantity
from ...mechanism.keywords import with_known_keywords
from ...mechanism.names import LENGTHS, sensitivity
from ...mechanism.ranges import Between
from ...mechanism.status import ToleranceStatus
from ...runtime.request import as_number, check_common, check_sliders
from ...support.checks import whole_number
from ...support.forks import IMPORTS, imported
from ...support.progress import Steps, progress_bar
from ...support.shown import shown
from ..measures import checked, is_named
from .function import SampledQuantity
from .scatter import Tolerance
from .uncertain import DISTRIBUTIONS, Array, Inexact, read

BLOCK = 65536  # samples at a time
FAR = 3.0  # standard deviations of a distribution within which a jump is looked for
STEP = 1e-3  # of a standard deviation or so: how far beside the means it is looked for kinks and jumps
PERCENTS = (0.135, 2.5, 50.0, 97.5, 99.865)
BOXES = 2000  # of an enclosure
MOST_CORNERED = 10  # inputs
MOST_SAMPLES = 10**8
MANY, SOME, FEW = 100_000, 10_000, 1_000  # samples of a quantity at a point, of a peak, of one of a sum


@with_known_keywords
def tolerance(
    name: Any,
    *,
    branch: int = 1,
    distribution: str = "normal",
    sigmas: float = 3.0,
    samples: int | None = None,
    seed: int = 0,
    sliders: Any = None,
    **inputs: Any,
) -> Tolerance:
    """The scatter of a quantity due to tolerances or distributions of its inputs.

    name          a quantity at a crank angle, as for `evaluate` ("a_C", with theta=), or one of a whole
                  design: "stroke", "time_ratio", ..., or a peak such as ("absmax", "a_C")
    inputs        each a number (exact); `dx.plus_minus(value, tolerance)`, the same as a text
                  "10 mm +- 0.1 mm" or "10 mm +- 1 %"; `dx.between(low, high)`; or a distribution of
                  scipy.stats, frozen. F_X and F_Y may vary with the motion
    distribution  within a tolerance: "normal", the tolerance being that many `sigmas`, or "uniform"
    samples       of the Monte Carlo, by default 100000, or 10000 of a peak, 1000 of several sliders
    sliders       filled in by a `Crankshaft`, of which a quantity at a crank angle or a peak is asked for

    Returns a dict that prints three lines: the value, its spread, what drives it; `report()` has all:

    value          with every input at its mean
    gradient       dict of the exact derivatives with respect to what varies
    first_order    dict mean, std: of the linear function with these derivatives
    monte_carlo    dict mean, std, mean_error, std_error (one standard error each), least, largest,
                   percentiles (dict percent -> value), samples, infeasible (share of samples without value)
    contributions  dict input -> share of the first-order variance, the largest first; an input whose
                   derivative is 0 has none, whatever it does further away: see monte_carlo
    worst_case     dict lower, upper: with every input anywhere within its tolerance; None for distributions.
                   `guaranteed` says whether no such inputs give a value outside: True by `enclose` (extra
                   `rigorous`), False from the middle and all corners alone, NaN where one has no value.
                   Inputs beyond their tolerances are not covered: `sigmas` says how many standard deviations
                   a tolerance is (None: uniform, no input is beyond), `outside` which share of the Monte
                   Carlo samples lies outside
    agreement      dict mean, std: how far the Monte Carlo is from the first order, in standard errors; far
                   where the quantity is curved
    status         0 ok; 1 no value at the means; 2 some samples have none; 3 a kink at the means, such as
                   that of |ec| at ec = 0: derivatives say little; 4 the value jumps along an input within its
                   tolerance (three standard deviations of a distribution), 5 it has no derivative at
                   the means (a peak at a limit angle): trust the samples alone

    Inputs vary independently. Raises as `evaluate` does.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> ec, AB = dx.plus_minus(0.02, 1e-4), dx.plus_minus(0.04, 5e-5)
        >>> found = dx.tolerance("stroke", ec=ec, AB=AB, BC=0.064)
        >>> list(found["contributions"]), round(1e6 * found["first_order"]["std"], 1)
        (['AB', 'ec'], 64.3)
    """
    _check(distribution, sigmas, samples, seed)
    check_common(inputs, branch)
    check_sliders(sliders)
    numbers, loads = loads_of({n: v for n, v in inputs.items() if v is not None})
    given: dict[str, Any] = {n: read(n, v, distribution, sigmas) for n, v in numbers.items()}
    means = {n: v.mean if isinstance(v, Inexact) else v for n, v in given.items()}
    given |= with_derivatives(loads, means)
    rough = [value for value in given.values() if isinstance(value, Inexact)]
    if not rough:
        missing = "".join(f"; {name} is missing" for name in LENGTHS if name not in given)
        raise ValueError(
            f"tolerance: every input is exact; give one as dx.plus_minus(value, tolerance){missing}"
        )
    function = _function(name, given if sliders is None else {**given, "sliders": sliders}, branch)
    count = samples or (MANY if function.at_point else SOME if sliders is None else FEW)
    covered = float(sigmas) if distribution == "normal" else None
    with progress_bar() as watch:
        return _answer(name, function, rough, Steps(3, watch), count, seed, covered)


def _answer(
    name: Any,
    function: SampledQuantity,
    rough: Sequence[Inexact],
    progress: Steps,
    count: int,
    seed: int,
    covered: float | None,
) -> Tolerance:
    """The answer of `tolerance` for inputs that were read; `covered`: the sigmas of a tolerance."""
    progress.next("derivatives")
    centre = {row.name: row.mean for row in rough}
    value = float(np.reshape(function.values({n: np.array([x]) for n, x in centre.items()}), -1)[0])
    slopes = function.slopes({n: np.array([x]) for n, x in centre.items()})[0]
    std = np.array([row.std for row in rough])
    reach = np.array([row.std * FAR if row.tolerance is None else row.tolerance for row in rough])
    parts = (slopes * std) ** 2
    total = float(parts.sum())
    shares = {row.name: float(p / total) if total else 0.0 for row, p in zip(rough, parts, strict=True)}
    first = {"mean": value, "std": sqrt(total)}
    progress.next(f"{count} samples")
    result = _sampled(function, rough, count, seed)
    drawn = _monte_carlo(result)
    progress.next("worst case")

    def apart(key: str) -> float:
        """The distance of the samples from the first order, in standard errors."""
        error = drawn[f"{key}_error"]
        return float((drawn[key] - first[key]) / error) if error else 0.0

    status = function.status(centre, STEP * std, reach)
    if np.isnan(value) or drawn["infeasible"]:
        status = ToleranceStatus.NO_VALUE if np.isnan(value) else ToleranceStatus.SOME_WITHOUT
    answer = {
        "value": value,
        "gradient": {row.name: float(s) for row, s in zip(rough, slopes, strict=True)},
        "first_order": first,
        "monte_carlo": drawn,
        "contributions": dict(sorted(shares.items(), key=lambda item: -item[1])),
        "worst_case": _worst_case(function, value, slopes, rough, result, covered),
        "agreement": {key: apart(key) for key in ("mean", "std")},
        "status": int(status),
    }
    return Tolerance(answer, name)


def _check(distribution: str, sigmas: Any, samples: Any, seed: Any) -> None:
    if not isinstance(distribution, str) or distribution not in DISTRIBUTIONS:
        raise ValueError(f"distribution = {shown(distribution)}: it is one of {', '.join(DISTRIBUTIONS)}")
    if not (isinstance(sigmas, (int, float)) and 1e-6 <= sigmas <= 1e6):
        raise ValueError(f"sigmas = {shown(sigmas)}: expected a finite number above 0, from 1e-6 to 1e6")
    if samples is not None:
        whole_number("samples", samples, 2, MOST_SAMPLES)
    whole_number("seed", seed, 0, 2**32 - 1)


def _function(name: Any, inputs: Mapping[str, Any], branch: int) -> SampledQuantity:
    several, state = "sliders" in inputs, "omega" in inputs
    design = isinstance(name, (tuple, list)) or (is_named(name) and (name != "margin" or not several))
    fixed = {n: v for n, v in inputs.items() if not isinstance(v, Inexact)}
    varying = tuple(n for n in inputs if n not in fixed)
    if design and name != "margin" and "theta" in inputs:
        raise ValueError(f"theta: {name} is of a whole turn")
    for length in LENGTHS if design and not several else ():
        if length not in inputs:
            as_number(length, None, LENGTHS, ("tolerance",))
    if not design and not several:
        quantity(name, state)
        if name == "status":
            raise ValueError("status is not a real number")
        for p in varying:
            if p in inputs_of(name, state) and not has(sensitivity(name, p), state):
                raise ValueError(f"tolerance of {name}: its derivative with respect to {p} is not derived")
    return SampledQuantity(checked(name) if design else ("at", None, name), fixed, varying, branch)


def _sampled(function: SampledQuantity, rough: Sequence[Inexact], count: int, seed: int) -> Array:
    """The values of random samples, drawn and evaluated in blocks."""
    random = np.random.default_rng(seed)
    blocks = []
    for start in range(0, count, BLOCK):
        size = min(BLOCK, count - start)
        blocks.append(function.values({row.name: row.drawn(random, size) for row in rough}))
    return np.concatenate(blocks)


def _monte_carlo(every: Array) -> dict[str, Any]:
    """Mean, scatter and percentiles of samples; those without a value are counted."""
    known = every[np.isfinite(every)]
    about = {"samples": every.size, "infeasible": 1.0 - known.size / every.size}
    if known.size < 2:
        nothing = dict.fromkeys(("mean", "std", "mean_error", "std_error", "least", "largest"), np.nan)
        return {**nothing, "percentiles": {}, **about}
    imported("numpy.ma")  # by `percentile`
    mean, std = float(known.mean()), float(known.std(ddof=1))
    fourth = float(np.mean((known - mean) ** 4))
    return {
        "mean": mean,
        "std": std,
        "mean_error": std / sqrt(known.size),
        "std_error": sqrt(max(fourth - std**4, 0.0) / known.size) / (2.0 * std) if std else 0.0,
        "least": float(known.min()),
        "largest": float(known.max()),
        "percentiles": dict(zip(PERCENTS, np.percentile(known, PERCENTS).tolist(), strict=True)),
        **about,
    }


def _worst_case(
    function: SampledQuantity,
    value: float,
    slopes: Array,
    rough: Sequence[Inexact],
    samples: Array,
    sigmas: float | None,
) -> dict[str, Any] | None:
    """The extreme values within all tolerances, and the share of the samples outside; see `tolerance`."""
    reach = {row.name: (row.mean, row.tolerance) for row in rough if row.tolerance is not None}
    if len(reach) < len(rough):
        return None
    ranges = {name: Between(mean - size, mean + size) for name, (mean, size) in reach.items()}
    sure = _enclosed(function.at_point, {**function.fixed, **ranges}, function.branch)
    every = np.append(function.values(_corners(rough, slopes)), value) if sure is None else np.array(sure)
    lower, upper, known = float(every.min()), float(every.max()), samples[np.isfinite(samples)]
    outside = float(((known < lower) | (known > upper)).mean()) if known.size else np.nan
    worst = {"lower": lower, "upper": upper, "guaranteed": sure is not None}
    return {**worst, "sigmas": sigmas, "outside": outside}


def _corners(rough: Sequence[Inexact], slopes: Array) -> dict[str, Array]:
    """Every input at either end of its tolerance; of very many inputs only where the derivatives point."""
    sides = np.sign(slopes) * np.array([[-1.0], [1.0]])
    if len(rough) <= MOST_CORNERED:
        sides = np.array(list(product((-1.0, 1.0), repeat=len(rough))))
    return {row.name: row.mean + sides[:, i] * float(row.tolerance or 0) for i, row in enumerate(rough)}


def _enclosed(name: str, ranges: Mapping[str, Any], branch: int) -> tuple[float, float] | None:
    """The guaranteed range; None where nothing guarantees it."""
    varies = any(map(callable, ranges.values()))  # a load that varies with the motion
    if not name or "sliders" in ranges or varies:
        return None
    try:
        with IMPORTS:
            from ...enclosure.enclose import enclose
    except ModuleNotFoundError:  # the extra `rigorous`
        return None
    result = enclose(name, branch=branch, boxes=BOXES, **ranges)
    ends = result["lower"], result["upper"]
    return ends if np.isfinite(ends).all() else None
