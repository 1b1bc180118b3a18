"""`synthesize`: the designs with a required stroke and time ratio.

With beta = pi (ratio - 1)/(ratio + 1), the angle that the stroke H is seen under from the crank's centre, the
triangle of both dead centres gives

    (H/2)^2 = AB^2 cos^2(beta/2) + BC^2 sin^2(beta/2),    ec = (BC^2 - AB^2) sin(beta)/H

one design for each x = AB/BC, tan^2(beta/2) <= x < 1: at the lower end a change point, at the upper one crank
and rod of one length. There is none for beta >= pi/2, a ratio of 3. The steepest rod has

    sin(max pressure angle) = (AB + ec)/BC = x + sin(beta/2) (1 - x^2)/sqrt(tan^2(beta/2) + x^2)

which is 1 at both ends and least at x^2 = 2 t (1 + t^2)/(t + sqrt(4 + 5 t^2)), t = tan(beta/2): two designs
for each angle above the least.
"""

from collections.abc import Callable
from itertools import pairwise
from math import asin, cos, inf, isclose, pi, sin, sqrt, tan
from typing import Any, NamedTuple

from ...mechanism.inputs import INPUTS, TINY, Input
from ...mechanism.messages import amount
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import units_of
from ...mechanism.read import read
from ...runtime.request import with_known_inputs
from ...support.answer import Answer
from ...support.roots import root
from ...support.shown import shown


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


WANTED = {
    row.name: row
    for row in (
        Input("stroke", "m", "distance between the dead centres"),
        Input("time_ratio", "1", "longer over shorter stroke"),
        Input("max_pressure_angle", "rad", "largest angle between rod and slider's axis"),
    )
}
THIRDS = ("BC", "AB", "max_pressure_angle")


@with_known_inputs
def synthesize(
    *,
    stroke: Any,
    time_ratio: Any,
    BC: Any = None,
    AB: Any = None,
    max_pressure_angle: Any = None,
    slow_stroke: int = 1,
) -> dict[str, Any]:
    """Every design with this stroke, time ratio and one further requirement; or why there is none.

    stroke       distance between the dead centres [m]
    time_ratio   the longer over the shorter stroke, from 1 to below 3
    one of       BC, AB: lengths [m]; max_pressure_angle [rad], of the rod
    slow_stroke  +1: the slider is slow on its way outward (branch 1, crank turning forwards), ec > 0;
                 -1: inward, ec < 0: the mirror image

    Numbers are in SI units; texts with units are understood. Gives a dict:

    solutions  list of designs, each a dict ec, AB, BC, by the length of the rod
    limits     dict of the third requirement -> (low, high): the range with designs of this stroke and
               time ratio, the ends in double precision; NaN where there is none
    status     0 one or more; 1 none; 2 the further requirement leaves the design undetermined
    message    how many, or why none

    Closed forms in plain Python (see this module's docstring); for a peak acceleration `optimize` keeps the
    stroke and the time ratio. Raises ValueError for an impossible requirement, TypeError unless exactly one
    third requirement is given.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.synthesize(stroke=0.0888, time_ratio=1.67, BC=0.064)
        >>> [round(1e3 * found["solutions"][0][name], 2) for name in ("ec", "AB", "BC")]
        [19.9, 40.05, 64.0]
    """
    thirds = {"BC": BC, "AB": AB, "max_pressure_angle": max_pressure_angle}
    given = [name for name, value in thirds.items() if value is not None]
    if len(given) != 1:
        result = " and ".join(given) or "none"
        raise TypeError(f"synthesize: expected just one of {', '.join(THIRDS)}, got {result}")
    if not isinstance(slow_stroke, (int, float)) or slow_stroke not in (1, -1):
        raise ValueError(f"slow_stroke = {shown(slow_stroke)}: it is +1 (outward) or -1 (inward)")
    (third,) = given
    H, ratio, value = (
        _wish(n, v) for n, v in (("stroke", stroke), ("time_ratio", time_ratio), (third, thirds[third]))
    )
    if ratio < 1.0:
        raise ValueError(f"time_ratio = {ratio}: the longer over the shorter stroke is at least 1")
    if ratio >= 3.0:
        why = f"time_ratio = {ratio:g}: below 3 wherever the crank turns fully"
        return _result(third, value, slow_stroke, Fitting([], *2 * (float("nan"),), why))
    family = Family(H, pi * (ratio - 1.0) / (ratio + 1.0))
    return _result(third, value, slow_stroke, _FORMS[third](family, value))


def _wish(name: str, value: Any) -> float:
    row = WANTED.get(name) or INPUTS[name]
    number = read(row._replace(least=TINY, limit="finite and more than 0"), value, "synthesize")
    if name == "max_pressure_angle" and number > pi / 2:
        angle = f"{name} = " + amount(name, number, "g", says_unit=True)
        raise ValueError(angle + ": it is at most pi/2, a right angle")
    return number


def _result(third: str, value: float, slow_stroke: int, answer: Fitting) -> Answer:
    count = len(answer.designs)
    message = answer.why or f"{count} design{'s' if count != 1 else ''}"
    if not answer.why and not count:
        wish, high = (amount(third, x, ".6g", says_unit=True) for x in (value, answer.high))
        low = amount(third, answer.low, ".6g", says_unit=answer.high == inf)
        ends = low + " on" if answer.high == inf else low + " to " + high
        message = f"none: {third} = " + wish + ", designs of this stroke and time ratio have it from " + ends
    solutions = sorted(answer.designs, key=lambda design: design["BC"])
    result = {
        "solutions": [{**design, "ec": slow_stroke * design["ec"]} for design in solutions],
        "limits": {third: (answer.low, answer.high)},
        "status": 1 if not count else 2 if answer.why else 0,
        "message": message,
    }
    return Answer(result, {"solutions": units_of(LENGTHS), "limits": units_of([third])})


# ---- one more wish ------------------------------------------------------------------------------


def _of_rod(family: Family, BC: float) -> Fitting:
    half = family.stroke / 2.0
    low, high = half, half / family.t if family.t else inf
    if not low <= BC <= high or (low == BC and family.beta):
        return Fitting([], low, high)
    share = BC * sin(family.beta / 2.0)
    AB = sqrt((half - share) * (half + share)) / cos(family.beta / 2.0)
    return Fitting([family.lengths(AB, BC)], low, high)


def _of_crank(family: Family, AB: float) -> Fitting:
    half = family.stroke / 2.0
    low, high = half * family.t, half
    if not family.beta:
        if not isclose(AB, half, rel_tol=4e-16):
            return Fitting([], half, half)
        design = {"ec": 0.0, "AB": AB, "BC": inf}
        return Fitting(
            [design],
            half,
            half,
            "time_ratio = 1: ec = 0 and AB = stroke/2, with a rod of any length BC >= AB",
        )
    if not low <= AB < high:
        return Fitting([], low, high)
    share = AB * cos(family.beta / 2.0)
    BC = sqrt((half - share) * (half + share)) / sin(family.beta / 2.0)
    return Fitting([family.lengths(AB, BC)], low, high)


def _of_lean(family: Family, angle: float) -> Fitting:
    lean, least = sin(angle), family.upright
    if not family.beta:
        return Fitting([family.design(lean)], 0.0, pi / 2)
    low = asin(min(family.lean(least), 1.0))
    if angle < low or lean >= 1.0:
        if lean >= 1.0:
            return Fitting([family.design(family.t**2)], low, pi / 2)
        return Fitting([], low, pi / 2)

    def excess(x: float) -> float:
        return family.lean(x) - lean

    ends = [family.t**2, least, 1.0]
    if excess(least) >= 0.0:
        return Fitting([family.design(least)], low, pi / 2)
    result = [root(excess, a, b) for a, b in pairwise(ends)]
    return Fitting([family.design(x) for x in result], low, pi / 2)


_FORMS: dict[str, Callable[[Family, float], Fitting]] = {
    "BC": _of_rod,
    "AB": _of_crank,
    "max_pressure_angle": _of_lean,
}
