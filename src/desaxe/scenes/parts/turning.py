"""The designs of a scene that turn fully, and the angles that the others cannot reach."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees, pi, prod
from typing import Any, NamedTuple

import numpy as np

from ...design.feasibility.feasibility import feasibility
from ...evaluation.evaluate import evaluate
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import UnitSystem
from ..content import Content, RequestAnswer, RequestPlan, columns_of
from ..document.blocks import Section, Text, with_unit

MOST_DESIGNS = 10_000_000  # that are looked at for feasibility; a sweep has the margin of all
MOST_SHOWN = 100  # designs that cannot turn fully, looked at one by one
GAPS = 5  # of these that are listed


class Infeasible(NamedTuple):
    """A design that cannot turn fully, and the ranges of crank angles [rad] that it cannot reach."""

    design: dict[str, float]
    gaps: tuple[tuple[float, float], ...]


@dataclass(frozen=True, kw_only=True)
class FeasibilityResult(RequestAnswer):
    """The number of designs that turn fully, and the first ones that do not.

    `limit` is the largest |ec| with which the crank turns fully [m], where AB and BC are numbers.
    """

    key = "feasibility"
    designs: int
    turning: int
    infeasible: tuple[Infeasible, ...]
    limit: float | None

    def blocks(self, units: UnitSystem) -> Section:
        """The limit of ec, and the designs that cannot turn."""
        return Section("Feasibility", [Text(line) for line in self._lines(units)])

    def _lines(self, units: UnitSystem) -> Iterator[str]:
        if self.limit is not None:
            limit = f"|ec| < BC - AB = {with_unit(units, 'ec', self.limit)}"
            yield f"the crank turns fully for {limit if self.limit > 0.0 else 'no ec, since BC <= AB'}"
        yield f"{self.turning} of {self.designs} designs of this scene turn fully"
        designs = [one.design for one in self.infeasible]
        names = [n for n in (designs or [{}])[0] if len({design[n] for design in designs}) > 1] or ["ec"]
        for one in self.infeasible[:GAPS]:
            design = ", ".join(f"{name} = {with_unit(units, name, one.design[name])}" for name in names)
            gaps = " and ".join(f"{degrees(a):.2f} to {degrees(b):.2f}" for a, b in one.gaps)
            part, where = " at part of the turn", f"for theta from {gaps} deg"
            if any(b - a >= 2.0 * pi for a, b in one.gaps):
                part, where = "", "at any angle"
            yield f"infeasible{part}: {design} cannot be assembled {where}"
        more = self.designs - self.turning - GAPS
        if more > 0:
            yield f"and {more} more"


@dataclass(frozen=True)
class Feasibility:
    """The designs of the lengths, a number or a tuple each."""

    key = "feasibility"
    lengths: dict[str, Any]

    @property
    def designs(self) -> int:
        """The number of designs."""
        return prod(len(value) for value in self.lengths.values() if isinstance(value, tuple))

    def plan(self, content: Content) -> RequestPlan:
        """The margins of all designs, and the gaps of some that do not turn."""
        return RequestPlan(lambda _: self._answer())

    def _answer(self) -> FeasibilityResult:
        columns: dict[str, Any] = columns_of(self.lengths)
        margins: Any = evaluate("margin", **columns)
        rows = np.flatnonzero(margins < 0.0)
        designs = [{n: float(column[row]) for n, column in columns.items()} for row in rows[:MOST_SHOWN]]
        result = tuple(Infeasible(one, _gaps(feasibility(**one)["theta_intervals"])) for one in designs)
        AB, BC, limit = self.lengths["AB"], self.lengths["BC"], None
        if not (isinstance(AB, tuple) or isinstance(BC, tuple)):
            limit = feasibility(ec=0.0, AB=AB, BC=BC)["margin"]
        turning = margins.size - rows.size
        return FeasibilityResult(designs=margins.size, turning=turning, infeasible=result, limit=limit)


def feasibility_of(inputs: dict[str, Any]) -> list[Feasibility]:
    """The feasibility of a scene's designs; none without all lengths, or for too many designs."""
    request = Feasibility({name: value for name, value in inputs.items() if name in LENGTHS})
    return [request] if len(request.lengths) == 3 and request.designs <= MOST_DESIGNS else []


def _gaps(intervals: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The gaps of a turn between these intervals, starting at angles from 0 to 2 pi."""
    if not intervals:
        return ((0.0, 2.0 * pi),)
    starts = [start for start, _ in intervals[1:]] + [intervals[0][0] + 2.0 * pi]
    gaps = [(stop, start) for (_, stop), start in zip(intervals, starts, strict=True)]
    return tuple(sorted((a - 2.0 * pi, b - 2.0 * pi) if a >= 2.0 * pi else (a, b) for a, b in gaps))
