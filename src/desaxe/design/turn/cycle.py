"""Designs over a cycle: the turn, or the turns after which their loads repeat, from edge to edge.

Between edges every quantity is smooth: ends of the cycle, dead centres, the crank across the guide (where a
design next to a change point bends within the root of its margin), the angles at which pieces of loads meet,
those at which the slider changes the side of a guide with friction, and zeros of the conditions of
user-defined quantities.

A quantity may jump at some of them, which move with the design: at the angle t(p) where a function keeps its
value, c(t, p) = 0, an integral over the angle gains (before - after) dt/dp with dt/dp = -c_p/c_t.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...evaluation.evaluate import evaluate
from ...loads.angles import crossings, meeting_angles
from ...loads.load import Load, OverY
from ...mechanism.closed.angles import dead_centres, repeated
from ...mechanism.names import LENGTHS, sensitivity
from ...runtime.request import request
from ...support.computed import computed_once
from ...support.panels import WIDEST, Array, Panels, resolved

MOST_TURNS = 4  # after which the loads must repeat; two in a four-stroke engine
NEAR = 1e-9  # rad: an edge is where something keeps its value
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
        self.numbers, self.loads, self.branch, self.turns = dict(numbers), dict(loads), int(branch), turns
        self.backwards = backwards

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
        found = evaluate(list(names), theta=theta, branch=self.branch, **present)
        return {name: np.broadcast_to(found[name], theta.shape) for name in names}

    @computed_once
    def _moving(self) -> list[tuple[tuple[str, ...], Array]]:
        """Quantities that keep their value at angles of jumps, which move; the angles, in rows."""
        loads = [load for load in self.loads.values() if isinstance(load, OverY) and load.jumps]
        meeting = [(load.kept, crossings(load, load.jumps, self.lengths, self.branch)) for load in loads]
        groups = [(("Y_wrt_theta",), dead_centres(self.lengths)), *meeting]
        return [(kept, repeated(angles, *self.ends)) for kept, angles in groups]

    def moves(self, angles: Array) -> dict[str, Array]:
        """By how much each length moves angles of jumps, in rows [1/m]; 0 for other angles."""
        moves = {name: np.zeros(angles.shape) for name in LENGTHS}
        free = np.ones(angles.shape, bool)
        lengths = dict(zip(LENGTHS, self.lengths, strict=True))
        for kept, marks in self._moving:
            gaps = (np.abs(angles - mark[:, None]) % self.angle for mark in marks.T)
            row, k = np.nonzero(free & _any_near(gaps, self.angle, angles.shape))
            if not row.size:
                continue
            free[row, k] = False
            names = [sensitivity(kept[0], "theta"), *(sensitivity(name, p) for name in kept for p in LENGTHS)]
            at: dict[str, Any] = {name: length[row] for name, length in lengths.items()}
            by = evaluate(
                list(dict.fromkeys(names)), theta=angles[row, k], branch=self.branch, omega0=1.0, **at
            )
            along = by[names[0]]
            for p in LENGTHS:
                slope = by[sensitivity(kept[0], p)] - sum(by[sensitivity(name, p)] for name in kept[1:])
                with np.errstate(invalid="ignore", divide="ignore"):
                    moves[p][row, k] = np.where(along == 0.0, 0.0, -slope / along)
        return moves

    def edges(self, names: Sequence[str], motion: Motion | None = None, **other: Any) -> Array:
        """The angles between which quantities are smooth: a row for each design, in any order, with NaN."""
        size = self.lengths[0].size
        low, high = self.ends
        across = repeated(ACROSS, low, high)
        met = meeting_angles(self.loads.values(), high, self.lengths, self.branch, low)
        dead = repeated(dead_centres(self.lengths), low, high)
        parts = [np.array([[low, high]]), across[None], met, dead]
        edges = np.concatenate([np.broadcast_to(part, (size, part.shape[1])) for part in parts], axis=1)
        if self.has_friction and self._depend_on_friction(names):
            sides = resolved(
                lambda theta, row: self.values(["N_C"], theta, row, motion, **{**other, "mu": None}), edges
            )
            edges = np.concatenate([edges, sides.roots(sides.values["N_C"])], axis=1)
        return edges

    def panels(
        self, names: Sequence[str], edges: Array | None = None, widest: float = WIDEST, **other: Any
    ) -> Panels:
        """Quantities over the cycle, in panels on which each is a polynomial."""
        edges = self.edges(names, **other) if edges is None else edges
        return resolved(lambda theta, row: self.values(names, theta, row, **other), edges, widest)

    def _depend_on_friction(self, names: Sequence[str]) -> bool:
        return "mu" in request(names, {**self.numbers, **self.loads}, self.branch, "standard").inputs


def _any_near(gaps: Any, angle: float, shape: tuple[int, ...]) -> Array:
    near = np.zeros(shape, bool)
    for gap in gaps:
        near |= np.minimum(gap, angle - gap) < NEAR
    return near
