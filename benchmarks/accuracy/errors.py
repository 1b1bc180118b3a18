"""Errors against the truth, as multiples of the promised bounds.

A promise of `standard` is 8 ulp x (1 + the sum of condition numbers): what the last digits of the inputs
change anyway is not counted against a value. A share of 1 is that promise kept, just. The promise of
`extended` is 2 ulp whatever the condition, with a floor of 2^-96 of the quantity's scale.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

import mpmath
import numpy as np

from desaxe.oracle.families import points
from desaxe.oracle.truth import conditions, truth_all, ulp_error

from .contenders import INPUTS, NAMES, Array, Contender, Run

ULPS = 8  # of the promise of standard
TOP = 2.0**53  # ulp: no digit is right, or there is no number
FLOOR = mpmath.mpf(2) ** -96  # of the scale, for errors in plain ulp
DRAWS = 50  # at most, for each point that is taken
FAR = 1000.0  # rad
ENOUGH = 2048  # points in an array, so that desaxe compiles instead of computing them one by one
DEGREES = {"V_C": 1, "a_C": 2, "a_C_wrt_ec": 2}  # of the crank's speed, in the scale
RANGE = mpmath.mpf(2) ** -1022, mpmath.mpf(2) ** 1024


class Case(NamedTuple):
    """A point, and for each name the true value, the allowed error, and the floor of the error scale."""

    point: Mapping[str, Any]
    exact: Mapping[str, mpmath.mpf]
    bounds: Mapping[str, float]  # ulp
    floors: Mapping[str, mpmath.mpf]


class Statistics(NamedTuple):
    """Errors of one contender in one family: as shares of standard's promise, and in plain ulp.

    A share is told where the promise leaves a digit; ulp where the truth is not exactly zero.
    """

    worst: float
    median: float
    worst_ulp: float
    median_ulp: float
    values: int


def cases(family: str, count: int, seed: int, branches: Sequence[int]) -> list[Case]:
    """Seeded points of a family on these branches, with their truth."""
    result = []
    drawn = (point for point in points(family, DRAWS * count, seed) if point["branch"] in branches)
    for point in islice(drawn, count):
        here: dict[str, Any] = dict(point)
        exact = {name: x for name, x in truth_all(NAMES, **here).items() if _is_a_double(x)}
        bounds = {name: ULPS * (1 + conditions(name, **here)) for name in exact}
        result.append(Case(here, exact, bounds, {name: _scale(name, here) * FLOOR for name in exact}))
    return result


def _is_a_double(x: mpmath.mpf) -> bool:
    """True for 0, and for a number in the range of normal doubles."""
    return bool(mpmath.isfinite(x) and (x == 0 or RANGE[0] <= abs(x) < RANGE[1]))


def _scale(name: str, point: Mapping[str, Any]) -> mpmath.mpf:
    """AB omega for V_C, AB omega^2 for a_C; a derivative by ec over the larger of |ec| and AB."""
    theta, ec, AB, omega0, alpha = (mpmath.mpf(point[p]) for p in ("theta", "ec", "AB", "omega0", "alpha"))
    with mpmath.workdps(60):
        size = AB * mpmath.sqrt(omega0 * omega0 + 2 * alpha * theta) ** DEGREES[name]
        return size / max(abs(ec), AB) if name.endswith("_wrt_ec") else size


class Judge:
    """Holds a contender's functions, one for each branch."""

    def __init__(self, contender: Contender) -> None:
        self.contender, self.runs = contender, dict[int, Run]()

    def statistics(self, family: Sequence[Case]) -> Statistics:
        """The contender's errors at these points."""
        shares, plain = [], []
        for case, answer in zip(family, self._answers(family), strict=True):
            for name, exact in case.exact.items():
                value = answer[NAMES.index(name)]
                if exact:
                    plain.append(_plain(value, exact, case.floors[name]))
                if case.bounds[name] < TOP:
                    shares.append(_share(value, exact, case.bounds[name]))
        return Statistics(
            max(shares), float(np.median(shares)), max(plain), float(np.median(plain)), len(plain)
        )

    def _answers(self, family: Sequence[Case]) -> list[Any]:
        """A row of values for each point."""
        answers: list[Any] = [None] * len(family)
        groups: dict[tuple[int, bool], list[int]] = {}
        for index, case in enumerate(family):
            far = abs(case.point["theta"]) > FAR  # one such angle makes a whole array another kernel's
            groups.setdefault((case.point["branch"], far), []).append(index)
        for (branch, _), chosen in groups.items():
            rows = self._run(branch, [family[index].point for index in chosen])
            for index, row in zip(chosen, rows.T.tolist(), strict=True):
                answers[index] = row
        return answers

    def _run(self, branch: int, some: Sequence[Mapping[str, Any]]) -> Array:
        if branch not in self.runs:
            self.runs[branch] = self.contender.make(branch)
        columns = np.array([[point[name] for point in some] for name in INPUTS])
        copies = 1 if self.contender.few else math.ceil(ENOUGH / len(some))
        inputs = np.tile(columns, copies)
        answers = self.runs[branch](inputs, np.empty((len(NAMES), inputs.shape[1])))
        return np.array(list(answers))[:, : len(some)]


def _plain(value: float, exact: mpmath.mpf, floor: mpmath.mpf) -> float:
    """The error in ulp: 0 below the floor, TOP if the value is no finite number."""
    if math.isfinite(value) and abs(mpmath.mpf(value) - exact) <= floor:
        return min(ulp_error(value, exact), 0.5)
    return min(ulp_error(value, exact), TOP)


def _share(value: float, exact: mpmath.mpf, bound: float) -> float:
    return min(ulp_error(value, exact) / bound, TOP / ULPS)
