"""Designs over a cycle: the turn, or the turns after which their loads repeat, from edge to edge.

Between edges every quantity is smooth: ends of the cycle, dead centres, the crank across the guide (where a
design next to a change point bends within the root of its margin), the angles at which pieces of loads meet,
those at which the slider changes the side of a guide with friction, and zeros of the conditions of
user-defined quantities.

A quantity may jump at some of them, which move with the design: at the angle t(p) where a function keeps its
value, c(t, p) = 0, an integral over the angle gains (before - after) dt/dp with dt/dp = -c_p/c_t.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import are_good, as_array, broadcast_shape
from ...evaluation.evaluate import evaluate
from ...evaluation.labelled import loads_of
from ...loads.along_motion import members_of, speeds_of, with_derivatives
from ...loads.angles import crossings, meeting_angles, shift
from ...loads.load import Load, OverY
from ...mechanism.catalogue import has
from ...mechanism.closed.angles import dead_centres, repeated
from ...mechanism.names import LENGTHS, sensitivity
from ...mechanism.own import used_by, using
from ...mechanism.own_lines import conditions_of
from ...runtime.request import as_number, request
from ...support.computed import computed_once
from ...support.panels import WIDEST, Array, Panels, resolved
from ...support.roots import sign_changes


class InputRows(NamedTuple):
    """The inputs of designs: a number for all of them, or an array with one for each.

    more   further numbers of a caller; `bad` are designs with a number that is no value of its input
    """

    shape: tuple[int, ...]
    numbers: dict[str, Any]
    more: dict[str, Any]
    loads: dict[str, Load]
    bad: NDArray[np.bool_]

    @property
    def size(self) -> int:
        """The number of designs."""
        return self.bad.size

    def each(self, value: Any) -> Array:
        """One number for each design."""
        return np.broadcast_to(value, (self.size,))


def input_rows(
    caller: str,
    inputs: Mapping[str, Any],
    more: Mapping[str, Array] | None = None,
    needed: Iterable[str] = LENGTHS,
) -> InputRows:
    """The inputs that are not None, broadcast; an error names one that is missing, or wholly bad."""
    numbers, loads = loads_of({name: value for name, value in inputs.items() if value is not None})
    for name in needed:
        if name not in numbers:
            as_number(name, None, LENGTHS, (caller,))
    arrays = {name: as_array(name, value, LENGTHS, (caller,)) for name, value in numbers.items()}
    more = more or {}
    shape = broadcast_shape({**arrays, **more})
    good = [np.broadcast_to(are_good(name, a), shape) for name, a in arrays.items()]
    good += [np.broadcast_to(np.isfinite(a), shape) for a in more.values()]
    bad = ~np.logical_and.reduce([np.ones(shape, bool), *good]).reshape(-1)
    scales = arrays if "omega" in arrays or "omega0" in arrays else {**arrays, "omega": np.array(1.0)}

    def rows(values: Mapping[str, Array]) -> dict[str, Any]:
        return {n: np.broadcast_to(v, shape).reshape(-1) if v.ndim else v.item() for n, v in values.items()}

    return InputRows(shape, rows(arrays), rows(more), with_derivatives(loads, scales), bad)


MOST_TURNS = 4  # after which the loads must repeat; two in a four-stroke engine
NEAR = 1e-9  # rad: an edge is where something keeps its value
SAMPLES = 512  # of a turn, between which a condition changes its sign once
ACROSS = np.array([0.5 * np.pi, 1.5 * np.pi])  # a crank across its guide
Motion = Callable[[Array], dict[str, Array]]  # angles -> omega and alpha there


class Cycle:
    """Designs in rows: inputs, each a number or one for each design, and loads that vary with the motion."""

    def __init__(
        self,
        numbers: Mapping[str, Any],
        loads: Mapping[str, Load],
        branch: int,
        turns: int,
        backwards: bool = False,
    ) -> None:
        self.numbers, self.loads = dict(numbers), with_derivatives(loads, numbers)
        self.branch, self.turns = int(branch), turns
        self.backwards = backwards

    def part(self, index: Any) -> "Cycle":
        """Some of the designs."""
        numbers = {name: value[index] if np.ndim(value) else value for name, value in self.numbers.items()}
        return Cycle(numbers, self.loads, self.branch, self.turns, self.backwards)

    @property
    def angle(self) -> float:
        """The angle of the cycle [rad], > 0."""
        return 2.0 * np.pi * self.turns

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest angle of the cycle; it begins at 0, in the direction of turning."""
        return (-self.angle, 0.0) if self.backwards else (0.0, self.angle)

    @computed_once
    def lengths(self) -> list[Array]:
        """ec, AB and BC of each design."""
        lengths = (np.atleast_1d(np.asarray(self.numbers[name], float)) for name in LENGTHS)
        size = max((np.size(value) for value in self.numbers.values()), default=1)
        return [np.broadcast_to(length, (size,)) for length in lengths]

    @property
    def has_friction(self) -> bool:
        """True if a guide has friction."""
        return bool(np.any(self.numbers.get("mu", 0.0)))

    @property
    def follows_speed(self) -> bool:
        """True if a load depends on how fast the crank turns."""
        return any(load.follows_speed for load in self.loads.values())

    def values(
        self, names: Sequence[str], theta: Array, row: Any = 0, motion: Motion | None = None, **other: Any
    ) -> dict[str, Array]:
        """Quantities at angles of the designs `row`, NaN where there is none.

        motion  the state at angles, in place of omega0; `other` replaces inputs of the designs
        """
        state = {} if motion is None else {**motion(theta), "omega0": None}
        numbers = {name: value[row] if np.ndim(value) else value for name, value in self.numbers.items()}
        inputs = {**numbers, **self.loads, **state, **other}
        present = {name: value for name, value in inputs.items() if value is not None}
        result = evaluate(list(names), theta=theta, branch=self.branch, **present)
        return {name: np.broadcast_to(result[name], theta.shape) for name in names}

    def _moving(self, names: Sequence[str]) -> list[tuple[tuple[str, ...], Array]]:
        """A quantity, or two whose difference stays the same at angles of jumps, and these, in rows."""
        every = members_of(self._loads_of(names))
        loads = [load for load in every if isinstance(load, OverY) and load.jumps]
        meeting = [(load.needs, crossings(load, load.jumps, self.lengths, self.branch)) for load in loads]
        groups = [(("Y_wrt_theta",), dead_centres(self.lengths)), *meeting]
        return [*((kept, repeated(angles, *self.ends)) for kept, angles in groups), *self._conditions(names)]

    def _conditions(self, names: Sequence[str]) -> list[tuple[tuple[str, ...], Array]]:
        """Conditions of user-defined quantities, and where each changes its sign."""
        nodes = np.tile(np.linspace(*self.ends, SAMPLES * self.turns + 1), (self.lengths[0].size, 1))
        conditions = conditions_of(used_by(names))
        result: list[tuple[tuple[str, ...], Array]] = []
        for name in (condition.name for condition in conditions):

            def value(row: Array, theta: Array, name: str = name) -> Array:
                return Cycle.values(self, [name], theta, row)[name]

            with using(conditions):
                result.append(((name,), sign_changes(value, nodes)))
        return result

    def moves(self, names: Sequence[str], angles: Array) -> dict[str, Array]:
        """By how much each input moves angles of jumps of quantities, in rows [1/its unit]; 0 for others."""
        moves: dict[str, Array] = {}
        free = np.ones(angles.shape, bool)
        for kept, marks in self._moving(names):
            gaps = (np.abs(angles - mark[:, None]) % self.angle for mark in marks.T)
            row, k = np.nonzero(free & _any_near(gaps, self.angle, angles.shape))
            if not row.size:
                continue
            free[row, k] = False
            for p, by in self._shifts(names, kept, row, angles[row, k]).items():
                moves.setdefault(p, np.zeros(angles.shape))[row, k] = by
        return moves

    def _shifts(
        self, names: Sequence[str], kept: tuple[str, ...], row: Array, theta: Array
    ) -> dict[str, Array]:
        """The derivatives of angles at which a quantity, or the difference of two, keeps its value."""
        conditions = conditions_of(used_by(names))
        of_motion = kept[0] not in {condition.name for condition in conditions}
        parameters = LENGTHS if of_motion else tuple(p for p in self.numbers if p != "theta")
        along, state = sensitivity(kept[0], "theta"), "omega" in self.numbers
        with using(conditions):
            slopes = {p: [sensitivity(name, p) for name in kept] for p in parameters}
            slopes = {p: both for p, both in slopes.items() if all(has(name, state) for name in both)}
            by = Cycle.values(self, [along, *(name for both in slopes.values() for name in both)], theta, row)
        shifts = {}
        for p in slopes:
            with np.errstate(invalid="ignore", divide="ignore"):
                shifts[p] = np.where(by[along] == 0.0, 0.0, shift(kept, p, by))
        return shifts

    def edges(self, names: Sequence[str], motion: Motion | None = None, **other: Any) -> Array:
        """The angles between which quantities are smooth: a row for each design, in any order, with NaN."""
        size = self.lengths[0].size
        low, high = self.ends
        across = repeated(ACROSS, low, high)
        loads = self._loads_of(names)
        met = meeting_angles(loads, high, self.lengths, self.branch, low)
        jumps = [angles for _, angles in self._moving(names)]
        parts = [np.array([[low, high]]), across[None], met, *jumps]
        edges = np.concatenate([np.broadcast_to(part, (size, part.shape[1])) for part in parts], axis=1)
        speeds = speeds_of(loads)
        if speeds:
            moving = resolved(lambda theta, row: self.values(["V_C"], theta, row, motion, **other), edges)
            edges = np.concatenate([edges, *(moving.roots(moving.values["V_C"] - v) for v in speeds)], axis=1)
        if self.has_friction and "mu" in self._inputs_of(names):
            sides = resolved(
                lambda theta, row: self.values(["N_C"], theta, row, motion, **{**other, "mu": None}), edges
            )
            edges = np.concatenate([edges, sides.roots(sides.values["N_C"])], axis=1)
        return edges

    def slopes_of(self, name: str) -> dict[str, str]:
        """The derivatives of a quantity by the inputs that are numbers."""
        state = "omega" in self.numbers
        return {p: by for p in self.numbers if has(by := sensitivity(name, p), state)}

    def panels(
        self, names: Sequence[str], edges: Array | None = None, widest: float = WIDEST, **other: Any
    ) -> Panels:
        """Quantities over the cycle, in panels on which each is a polynomial."""
        edges = self.edges(names, **other) if edges is None else edges
        return resolved(lambda theta, row: self.values(names, theta, row, **other), edges, widest)

    def _inputs_of(self, names: Sequence[str]) -> Iterable[str]:
        """The inputs that matter to quantities; all of them to none."""
        every = {**self.numbers, **self.loads}
        return request(names, every, self.branch, "standard").inputs if names else every

    def _loads_of(self, names: Sequence[str]) -> list[Load]:
        """The loads that matter to quantities."""
        inputs = self._inputs_of(names) if self.loads else ()
        return [load for name, load in self.loads.items() if name in inputs]


def _any_near(gaps: Any, angle: float, shape: tuple[int, ...]) -> Array:
    near = np.zeros(shape, bool)
    for gap in gaps:
        near |= np.minimum(gap, angle - gap) < NEAR
    return near


def integrated(
    panels: Panels, value: Array, jump: Array, slopes: Mapping[str, Array], moves: Mapping[str, Array]
) -> tuple[Any, dict[str, Any]]:
    """The integral of a function over a cycle, and its derivatives from those of the function.

    jump    of the function at the end of each panel, before - after; moves: of these ends, by input
    """
    by = {p: panels.integral(slope) for p, slope in slopes.items()}
    by |= {p: by[p] + (jump * moves[p]).sum(-1) for p in by if p in moves}
    return panels.integral(value), by
