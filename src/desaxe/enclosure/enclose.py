"""`enclose`: a guaranteed range of a quantity over a box of tolerances.

Branch and bound in ball arithmetic (`balls`), once for the largest value and once for the smallest.
What a box can hold is bounded by the program over it, and by the mean-value form: the value at its
centre and the exact sensitivities over it. Where a sensitivity keeps its sign, the extreme value is
at one end of that input, and the box loses a dimension. The box with the largest bound is cut next,
until that bound is as good as a value that is attained.
"""

from collections.abc import Sequence
from heapq import heappop, heappush
from itertools import islice, product
from math import inf, isfinite, nan, nextafter, pi
from typing import Any, NamedTuple

from flint import arb, ctx

from ..compiler.passes.differentiate import with_derivatives
from ..compiler.program import Program
from ..loads.resolve import without_loads
from ..mechanism.catalogue import has, quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs, with_known_keywords
from ..mechanism.messages import named
from ..mechanism.names import sensitivity
from ..mechanism.quantity_units import unit_of
from ..mechanism.ranges import Between, PlusMinus, ends_of, refuse_bare_pair
from ..mechanism.status import EnclosureStatus
from ..runtime.request import Request, as_number, check_common, request
from ..runtime.specialise import specialise
from ..support.answer import Answer
from ..support.checks import real_number, whole_number
from ..support.deadline import Deadline
from ..support.shown import shown
from ..units.text import PLUS_MINUS
from .balls import BITS, PARTLY, Enclosure, Interval, ball, enclosures

Box = tuple[Interval, ...]  # of the inputs that vary

FINEST = 2.0**-40  # a box without a finite bound is not cut below this, relative to its place
EXACT = "standard"  # a request has an accuracy; over balls it says nothing
CORNERS = 64  # of the box, looked at first
MORE_BITS = (BITS, 512, 2048)  # for the value at a point
ENOUGH = 64  # bits of it
WHOLE_TURN = (0.0, nextafter(2 * pi, inf))  # not less than one
LAST_BIT = 2.0**-52
SMALLEST = 2.0**-1073
ENDS = "expected a number or a pair, dx.between(low, high) or dx.plus_minus(value, tolerance)"


@with_known_keywords
def enclose(
    name: str,
    *,
    theta: Any = None,
    ec: Any = None,
    AB: Any = None,
    BC: Any = None,
    omega0: Any = None,
    alpha: Any = 0.0,
    omega: Any = None,
    branch: int = 1,
    rtol: float = 1e-6,
    boxes: int = 10_000,
    timeout: float | None = 120.0,
    **loads: Any,
) -> dict[str, Any]:
    """The range of a quantity or sensitivity over a box of inputs, guaranteed.

    Each input is a number (exact), `dx.between(low, high)` or `dx.plus_minus(value, tolerance)`, in SI units
    or texts with units, as in `evaluate`, masses and loads among them:
    `enclose("a_C", theta=1.0, ec=dx.plus_minus("10 mm", "0.1 mm"), ...)`. Every combination of values within
    the ranges counts.

    rtol     how much wider than the true range the result may be at each end, relative to the range
    boxes    the limit of boxes at each end; the result is guaranteed even then, only wider
    timeout  seconds after which it ends with a TimeoutError; None for no limit

    Returns a dict:

    lower, upper   no value in the box is below or above these; rounded outwards. -inf and inf where no
                   bound can be proved, as next to a limit angle
    inner          (low, high): values this small and this large are attained in the box, so that the
                   true extremes are within lower .. inner[0] and inner[1] .. upper. NaN if none is known
    status         0 the quantity is defined in all of the box; 1 nowhere in it; 2 some of the box is
                   infeasible or stalled or has no balance of forces, or touches a change point or limit
                   angle, or it could not be decided: lower and upper then hold for the feasible part
    tight          whether both ends are as near to the truth as `rtol` asks
    boxes          how many boxes were looked at

    Needs the extra `rigorous`. Raises ValueError for an unknown name, or `status`, or a bad value.

    See docs/choose.md: which call for which question.
    """
    check_inputs("enclose", loads, (*INPUTS, "branch", "rtol", "boxes", "timeout"))
    quantity(name, omega is not None)
    if name == "status":
        raise ValueError("status is not a real number: see `status` of the result")
    if not real_number("rtol", rtol) > 0.0:
        raise ValueError(f"rtol = {rtol}: expected a number above 0")
    whole_number("boxes", boxes, 1, 10**7)
    deadline = Deadline("enclose", timeout)
    inputs = {"theta": theta, "ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "alpha": alpha, "omega": omega}
    check_common(inputs, branch)
    without_loads("enclose", loads, "the range of its values, {name} = (low, high) as dx.between(low, high)")
    inputs.update(loads)
    function = _function(name, inputs, branch)
    with ctx.workprec(BITS):
        result = _range(function, rtol, boxes, deadline)
    return Answer(result, dict.fromkeys(("lower", "upper", "inner"), unit_of(name)), EnclosureStatus)


# ---- the quantity over boxes ----------------------------------------------------------------------


class BoxedQuantity(NamedTuple):
    """A quantity as a function of boxes of its varying inputs, with derivatives."""

    value: Program
    full: Program  # the value and its derivatives
    varying: tuple[str, ...]
    fixed: dict[str, Interval]
    whole: Box

    def over(self, box: Box) -> Enclosure:
        """The value and its derivatives over a box."""
        return enclosures(self.full, self._inputs(box))

    def defined(self, box: Box) -> Enclosure:
        """The value alone."""
        return enclosures(self.value, self._inputs(box))

    def at(self, point: Sequence[float]) -> Any:
        """The value at a point in sufficient precision; None if it may be undefined there."""
        inputs = self._inputs(tuple((x, x) for x in point))
        for bits in MORE_BITS:
            result = enclosures(self.value, inputs, bits)
            (value,) = result.values
            if value is not None and value.rel_accuracy_bits() >= ENOUGH:
                break
        return None if value is None or result.flags & PARTLY or not value.is_finite() else value

    def _inputs(self, box: Box) -> dict[str, Interval]:
        return {**self.fixed, **dict(zip(self.varying, box, strict=True))}


def _function(name: str, given: dict[str, Any], branch: int) -> BoxedQuantity:
    intervals = {p: _interval(p, value, name) for p, value in given.items() if value is not None}
    plain: dict[str, Any] = {p: low if low == high else (low, high) for p, (low, high) in intervals.items()}
    alone = request((name,), plain, branch, EXACT)
    for p in alone.inputs:
        if p not in intervals:
            as_number(p, None, alone.inputs, (name,))  # raises if it is missing
    own = {p: intervals[p] for p in alone.inputs}
    varying = tuple(p for p, (low, high) in own.items() if low < high)
    slopes = tuple(sensitivity(name, p) for p in varying)
    fixed = {p: ends for p, ends in own.items() if p not in varying}
    program = _program(alone)
    if all(has(slope, "omega" in plain) for slope in slopes):
        full = _program(request((name, *slopes), plain, branch, EXACT))
    else:
        full = with_derivatives(program, varying)
    whole = tuple(_turned(own[p]) if p == "theta" and _turns(program) else own[p] for p in varying)
    return BoxedQuantity(program, full, varying, fixed, whole)


def _turns(program: Program) -> bool:
    """True if theta enters only through sine and cosine."""
    return all(line.op in ("sin", "cos") for line in program.lines if "theta" in line.args)


def _turned(theta: Interval) -> Interval:
    """The interval of theta, reduced to one turn if it is longer."""
    return WHOLE_TURN if theta[1] - theta[0] > WHOLE_TURN[1] else theta


def _program(requested: Request) -> Program:
    return specialise(requested.names, requested.form, requested.fixed)


def _interval(name: str, value: Any, requested: str) -> Interval:
    """The interval of an input: a number, pair or range as two doubles."""
    if isinstance(value, PlusMinus):
        value = Between(*ends_of(name, value))
    refuse_bare_pair(name, value)
    if isinstance(value, (tuple, list)) and not isinstance(value, Between):
        raise ValueError(f"{name} = {shown(value)}: {ENDS}")
    if isinstance(value, str) and PLUS_MINUS.search(value):
        raise ValueError(f"{name} = {value!r}: {ENDS}")
    ends = value if isinstance(value, Between) else (value, value)
    low, high = (as_number(name, end, (name,), (requested,)) for end in ends)
    if low is None or high is None:
        raise ValueError(f"{name} = {shown(value)}: {ENDS}")
    if low > high:
        raise ValueError(named(name, value) + ": expected two numbers, the lower one first")
    return low, high


# ---- the search -----------------------------------------------------------------------------------


def _range(function: BoxedQuantity, rtol: float, limit: int, deadline: Deadline) -> dict[str, Any]:
    status, count = _status(function, limit, deadline)
    if status == 1:
        return {"lower": nan, "upper": nan, "inner": (nan, nan), "status": 1, "tight": True, "boxes": count}
    search = Bisection(function, rtol, limit, deadline)
    upper, lower = search.largest(1), -search.largest(-1)
    low, high = search.inner
    return {
        "lower": lower,
        "upper": upper,
        "inner": (min(low, high), max(low, high)) if isfinite(low) else (nan, nan),  # both round inwards
        "status": status,
        "tight": search.tight,
        "boxes": count + search.count,
    }


def _status(function: BoxedQuantity, limit: int, deadline: Deadline) -> tuple[int, int]:
    """The status (0 defined in all of the box, 1 nowhere, 2 otherwise) and the number of boxes used."""
    corners = [tuple((x, x) for x in corner) for corner in islice(product(*function.whole), CORNERS)]
    boxes, count, known = [function.whole], 0, {_defined(function, corner) for corner in corners}
    while boxes and not {True, False} <= known:
        deadline.check()
        box, count = boxes.pop(), count + 1
        here = _defined(function, box)
        known.add(here)
        if here is None:
            pieces = _halves(function, box, _sizes(function, box), FINEST) if count < limit else ()
            if not pieces:
                return 2, count
            boxes += pieces
    return 2 if {True, False} <= known else 1 if False in known else 0, count


def _defined(function: BoxedQuantity, box: Box) -> bool | None:
    """True if the quantity is defined in all of a box, False if nowhere, None if undecided."""
    result = function.defined(box)
    return False if result.values == (None,) else None if result.flags & PARTLY else True


class BoundedBox(NamedTuple):
    """A box, the upper bound of the quantity in it, and the influence of each input."""

    upper: float
    box: Box
    weights: tuple[float, ...]


class Bisection:
    """Branch and bound for the largest value of a quantity (sign 1) or of its negative (sign -1)."""

    def __init__(self, function: BoxedQuantity, rtol: float, limit: int, deadline: Deadline) -> None:
        self.function, self.rtol, self.limit, self.deadline = function, rtol, limit, deadline
        self.inner = (inf, -inf)  # attained
        self.count = 0
        self.tight = True

    def largest(self, sign: int) -> float:
        """An upper bound within the tolerance, or as tight as the limit of boxes allows."""
        heap: list[tuple[float, int, int, BoundedBox]] = []
        pieces: tuple[Box, ...] = (self.function.whole,)
        depth, end, bound = 0, self.count + self.limit, -inf
        while pieces:
            for box in pieces:
                node = self._look(sign, box)
                if node is not None:  # of nearly equal bounds the deepest first: it soon shows a good value
                    heappush(heap, (-self._coarse(node.upper), -depth, self.count, node))
            pieces = ()
            while heap and not pieces:
                _, depth, _, node = heappop(heap)
                depth = 1 - depth
                if node.upper > self._goal(sign):
                    pieces = self._pieces(node) if self.count < end else ()
                    if not pieces:
                        self.tight = False
                        return max(bound, node.upper, *(entry[-1].upper for entry in heap))
                else:
                    bound = max(bound, node.upper)
        return bound

    def _coarse(self, bound: float) -> float:
        """A bound in steps of the tolerance."""
        low, high = self.inner
        step = self.rtol * (high - low)
        return round(bound / step) * step if low < high and isfinite(bound / step) else bound

    def _pieces(self, node: BoundedBox) -> tuple[Box, ...]:
        finest = 0.0 if isfinite(node.upper) else FINEST
        return _halves(self.function, node.box, node.weights, finest)

    def _goal(self, sign: int) -> float:
        """The bound at which the search stops: the attained value plus the tolerance."""
        low, high = self.inner
        best = high if sign > 0 else -low
        margin = max(self.rtol * (high - low), 2 * LAST_BIT * abs(best), SMALLEST)
        return best + margin if isfinite(best) else -inf

    def _look(self, sign: int, box: Box) -> BoundedBox | None:
        """Bound the quantity over a box; None if it is defined nowhere in it."""
        while True:
            self.deadline.check()
            self.count += 1
            result = self.function.over(box)
            value, *slopes = result.values
            if value is None:
                return None
            smooth = not result.flags and all(slope is not None and slope.is_finite() for slope in slopes)
            if not smooth or all(low == high for low, high in box):
                upper = min(_up(sign * value), self._at_centre(sign, box)[1])
                return BoundedBox(upper, box, _sizes(self.function, box))
            smaller = tuple(_end(ends, sign * slope) for ends, slope in zip(box, slopes, strict=True))
            if smaller == box:
                return self._centred(sign, box, value, slopes)
            box = smaller

    def _at_centre(self, sign: int, box: Box) -> tuple[Any, float]:
        """The value at the centre, noted as attained; and a bound for the box, if that is all of it."""
        value = self.function.at([_middle(ends) for ends in box])
        if value is None:
            return None, inf
        low, high = self.inner
        self.inner = min(low, _up(value)), max(high, _down(value))
        return value, _up(sign * value) if all(low == high for low, high in box) else inf

    def _centred(self, sign: int, box: Box, value: Any, slopes: list[Any]) -> BoundedBox:
        """The better one of the program's own bound and the mean-value form."""
        centre, upper = self._at_centre(sign, box)
        swings = [slope * (ball(ends) - _middle(ends)) for ends, slope in zip(box, slopes, strict=True)]
        if centre is not None:
            upper = min(upper, _up(sign * sum(swings, centre)))
        return BoundedBox(min(upper, _up(sign * value)), box, tuple(float(abs(x).upper()) for x in swings))


def _end(ends: Interval, slope: Any) -> Interval:
    """The end of an input at which a quantity with this slope is largest; both if its sign is open."""
    low, high = ends
    return (high, high) if slope >= 0 else (low, low) if slope <= 0 else ends


def _middle(ends: Interval) -> float:
    """The point at which to bisect: 0, where kinks are, if it is inside; else the middle or an end."""
    low, high = ends
    return 0.0 if low < 0.0 < high else min(max(low + 0.5 * (high - low), low), high)


def _sizes(function: BoxedQuantity, box: Box) -> tuple[float, ...]:
    """The sides of a box relative to their inputs: angles to one radian, lengths to the longest."""
    ends = {**function.fixed, **dict(zip(function.varying, function.whole, strict=True))}
    largest = {name: max(abs(low), abs(high)) for name, (low, high) in ends.items()}
    length = max((largest[name] for name in ("ec", "AB", "BC") if name in largest), default=1.0)
    scales = {**largest, "theta": 1.0, "ec": length, "AB": length, "BC": length}
    return tuple((high - low) / scales[name] for name, (low, high) in zip(function.varying, box, strict=True))


def _halves(function: BoxedQuantity, box: Box, weights: tuple[float, ...], finest: float) -> tuple[Box, ...]:
    """The box cut across the input that matters most; nothing if no number lies between its ends."""
    sizes = _sizes(function, box)
    can = [k for k, (low, high) in enumerate(box) if low < _middle((low, high)) < high and sizes[k] > finest]
    if not can:
        return ()
    k = max(can, key=lambda k: weights[k])
    (low, high), middle = box[k], _middle(box[k])
    return tuple((*box[:k], ends, *box[k + 1 :]) for ends in ((low, middle), (middle, high)))


def _up(x: Any) -> float:
    """The upper end of a ball as a double, rounded up."""
    end = x.upper()
    near = float(end)
    if near != near:
        return inf
    return near if arb(near) >= end else nextafter(near, inf)


def _down(x: Any) -> float:
    return -_up(-x)
