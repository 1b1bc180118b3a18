"""A quantity under loads that vary with the motion, with total derivatives.

Loads are lines of the Programs of the search: one over the crank angle is an input, as its derivative is; a
table over the slider's place is an argument of the machine code. Between jumps the piece of such a table is
held, as the arcs of each design tell it, so that next to a jump a value is the limit from its side; there are
nodes on both.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import evaluate_arrays
from ..evaluation.call import Call
from ..evaluation.under_loads import MOTION, LoadInputs, plan_for, totals_under
from ..loads.along_motion import SPEEDS, STENCIL, STEP, OfMotion
from ..loads.function import FunctionOverTheta
from ..loads.load import Load, OverTheta, OverY
from ..mechanism.load_lines import LoadLines, Total, Under
from ..mechanism.names import LENGTHS, sensitivity
from .course import Course
from .nodes import Array
from .programs import Search, compiled, needs_own, totals_of
from .special import SearchedDesigns

Rows = NDArray[np.intp]
PLACES = np.arange(-4.0, 5.0)  # of nine values in steps, and the slope of their polynomial by powers
BY_POWERS = np.arange(1.0, 9.0)[:, None] * np.linalg.inv(np.vander(PLACES, increasing=True))[1:]


class ValuesUnderLoads:
    """A quantity, its slope over theta and its gradient, for designs under loads.

    The input of a design in a block is its number.
    """

    def __init__(self, name: str, search: Search, designs: SearchedDesigns, course: Course) -> None:
        self.designs, self.course, self.search = designs, course, search
        self.all = [name, *(sensitivity(name, p) for p in ("theta", *search.parameters))]
        self.under, self.loads = search_under(search, self.all, designs)
        self.tables = {name: np.asarray(table) for name, table in self.loads.tables().items()}

    def at(self, count: int, rows: Rows, theta: Array, pieces: dict[str, Rows] | None = None) -> list[Array]:
        """Value, slope and gradient, the first `count` of them, at angles that broadcast with some designs.

        pieces   of the loads that jump, without those that hold at these angles
        """
        held = self.course.pieces(rows, theta) if pieces is None else pieces
        aside = self.course.aside(rows, theta) if pieces is None and self.designs.rubs else theta
        result = [*self._of_totals(count, rows, aside, held)][:count]
        if aside is not theta:
            result[0] = np.where(aside == theta, result[0], result[0] + result[1] * (theta - aside))
        return result

    def _of_totals(self, count: int, rows: Rows, theta: Array, held: dict[str, Rows]) -> Sequence[Array]:
        """Value, slope and gradient by machine code, or the first two."""
        totals = compiled(totals_of, self.under, "curve" if count == 2 else "finish")
        inputs = {**self.tables, **over_theta_at(self.designs.loads, theta), "theta": theta}
        inputs |= {f"{force}_piece": piece.astype(float) for force, piece in held.items()}
        if self.loads.motion is not None:
            inputs |= self._of_motion(rows, theta, totals.inputs)
        columns = self.designs.columns
        for name in totals.inputs:
            if name in columns:
                column = columns[name]
                inputs[name] = column[rows] if column.strides[0] else column[:1]  # or one number for all
        return totals(inputs)

    def _of_motion(self, rows: Rows, theta: Array, needed: Sequence[str]) -> dict[str, Any]:
        """Loads over columns of the motion, and their derivatives that are needed."""
        motion, columns = self.loads.motion, self.designs.columns
        assert motion is not None
        given = {name: column[rows] for name, column in columns.items() if name in (*LENGTHS, *SPEEDS)}
        given = dict(zip((*given, "theta"), np.broadcast_arrays(*given.values(), theta), strict=True))
        flat = {name: np.where(np.isnan(x), 1.0, x).reshape(-1) for name, x in given.items()}
        known = evaluate_arrays(Call(motion, motion.inputs), flat, 1)
        of_motion = [n for n in needed if n not in columns and n != "theta"]
        loads = {n: a for n, a in self.designs.loads.items() if isinstance(a, OfMotion)}
        result = LoadInputs(loads, tuple(of_motion), motion).at(flat, known)
        return {
            name: np.broadcast_to(x, flat["theta"].shape).reshape(given["theta"].shape)
            for name, x in result.items()
        }

    def block(self, designs: SearchedDesigns, rows: Rows) -> Array:
        """The inputs of designs for `curve` and `finish`."""
        return rows[None].astype(float)

    def curve(self, theta: Array, block: Array) -> tuple[Array, Array]:
        """Value and slope at angles that broadcast with the rows of the block."""
        value, slope = self.at(2, block[0].astype(np.intp), theta)
        return value, slope

    def finish(self, theta: Array, block: Array) -> Array:
        """Value, slope and gradient at an angle of each design: a row each."""
        return np.array(self.at(len(self.all), block[0].astype(np.intp), theta))


def search_under(search: Search, names: Sequence[str], designs: SearchedDesigns) -> tuple[Search, LoadInputs]:
    """The search of total derivatives under loads, and the inputs that these give.

    names   the quantity, its slope over theta, its gradient

    Where these are not derived, they are those of the Program, line by line, at a fixed force; ValueError
    for a quantity that depends on the slope of a load, of which they would need the second one.
    """
    name, *_ = names
    own = needs_own(search.name, ("theta", *search.parameters))
    inputs = {**dict.fromkeys(MOTION), "alpha": 0.0, "theta": 0.0, **designs.columns}
    _, plan = plan_for((name,) if own else names, {**inputs, **designs.loads})
    if own and plan.terms.get(name):
        raise ValueError(
            f"peak of {name}: it has the slope of {' and '.join(plan.loads)}, whose second one its own slope "
            f'would need; grid("{name}", reduce={{"theta": "absmax"}}, ...) takes the largest of samples'
        )
    asked, _, own_inputs = totals_under(plan, inputs, designs.branch, "standard")
    under = asked.form.under
    assert under is not None
    assert own_inputs is not None
    under = under._replace(loads=tuple(_line(line, designs.loads[line.force]) for line in under.loads))
    if own:
        under = _of_partial(search, under, plan.loads)
    return search._replace(form=search.form._replace(under=under)), own_inputs


def _of_partial(search: Search, under: Under, loads: Mapping[str, Load]) -> Under:
    """The totals of a quantity and its derivatives from those at a fixed force, and the motion they need."""
    name, motion = search.name, dict[str, None]()
    forces, totals = tuple(loads), [Total(search.name, tuple(loads))]
    for p in ("theta", *search.parameters):
        terms = tuple(
            (sensitivity(name, force), force, p) for force in forces if p in loads[force].parameters
        )
        totals.append(Total(sensitivity(name, p), forces, terms))
    for load in loads.values():
        if isinstance(load, OverY):
            motion |= dict.fromkeys(
                load.motion(p for p in load.parameters if p in ("theta", *search.parameters))
            )
    names = tuple((one, one) for one in (*(total.name for total in totals), *motion))
    return under._replace(names=names, totals=tuple(totals))


def _line(line: LoadLines, load: Load) -> LoadLines:
    if line.parts:
        return line
    if isinstance(load, OverY):
        return line._replace(held=True, ways=False) if load.jumping else line
    return LoadLines(line.force, "")


def over_theta_at(loads: Mapping[str, Load], theta: Array) -> dict[str, Any]:
    """Values and derivatives at crank angles of the loads over them."""
    result: dict[str, Any] = {}
    for name, load in loads.items():
        if isinstance(load, OverTheta):
            for key, values in zip((name, f"{name}_by_theta"), load.both(theta.reshape(-1)), strict=True):
                result[key] = values.reshape(theta.shape)
    return result


# ---- functions without a derivative ------------------------------------------------------------------


def with_slopes(loads: Mapping[str, Load], low: float, high: float) -> dict[str, Load]:
    """The loads, with the derivative of a user's function by differences where it was not given.

    They only lead the search: what it finds is a value of the function itself.
    """
    return {
        name: replace(load, derivative=Differences(load, _nodes(load, low, high)).at)
        if isinstance(load, FunctionOverTheta) and not load.has_slope
        else load
        for name, load in loads.items()
    }


def _nodes(load: FunctionOverTheta, low: float, high: float) -> tuple[float, ...]:
    """The nodes of a function in a range, and one or more on either side."""
    return tuple(load.nodes(low - 2.0 * load.period, high + 2.0 * load.period, smooth=False))


class Differences(NamedTuple):
    """The derivative of a load by differences; `nodes` are those at which it may jump."""

    load: FunctionOverTheta
    nodes: tuple[float, ...]

    def at(self, theta: Any) -> Any:
        """The derivative at a number or an array."""
        theta = np.asarray(theta, float)
        if self.nodes:
            return self._between(theta)
        total = np.zeros(theta.shape)
        for steps, weight in STENCIL:
            ahead, behind = (self.load.value(theta + side * steps * STEP) for side in (1.0, -1.0))
            total += weight * (ahead - behind)
        return total / STEP

    def _between(self, theta: Any) -> Any:
        """The derivative from values between the nodes on both sides: none from beyond a jump."""
        after = np.searchsorted(self.nodes, theta, side="right")
        low, high = np.array(self.nodes)[after - 1], np.nextafter(self.nodes, -inf)[after]
        step = np.minimum(STEP, 0.125 * (high - low))
        centre = np.clip(theta, low + 4.0 * step, high - 4.0 * step)
        result = self.load.value(np.clip(centre + PLACES.reshape(-1, *[1] * theta.ndim) * step, low, high))
        powers = ((theta - centre) / step) ** np.arange(8.0).reshape(-1, *[1] * theta.ndim)
        return (np.tensordot(BY_POWERS, result, axes=1) * powers).sum(axis=0) / step
