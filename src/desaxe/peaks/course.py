"""Loads and conditions of designs over the crank angle: kinks, jumps, and the nodes that a search needs."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arcs import Arcs, arcs_of, meeting_in_turn
from ..loads.along_motion import SPEEDS, OfMotion, members_of, speeds_of
from ..loads.angles import meeting_and_bent
from ..loads.load import Load, OverTheta, OverY
from ..mechanism.closed.angles import dead_centres, repeated
from ..runtime.request import request
from ..support.roots import sign_changes
from .nodes import Array
from .programs import Evaluations, Search
from .search import sign_changes_of
from .special import AT_KINK, ROUNDED, SearchedDesigns, are_special, even_nodes, own_nodes

# What keeps a kink where it is: angle, position, dead centre, distance from one, speed, conditions.
FIXED, CROSSING, TURNING, FROM_OUTER, FROM_INNER, SPEED, CONDITION = range(7)
KIND_OF = {"": CROSSING, "Y_outer": FROM_OUTER, "Y_inner": FROM_INNER}
BESIDE = 16.0  # last bits of an angle: so near to a jump is next to it


class Marks(NamedTuple):
    """Angles of each design, NaN in empty places, and what keeps each of them."""

    angles: Array
    kinds: NDArray[np.int8]

    def of(self, kind: int) -> Array:
        """The angles of a kind."""
        return self.angles[:, self.kinds == kind]


class Course(NamedTuple):
    """The loads of designs over a range of angles.

    nodes  where a search looks, besides the nodes of every design: a row for all, or one for each
    kinks  where a load is not smooth; every dead centre under a load over Y
    jumps  the first angle after each jump
    arcs   those of the loads over Y that jump
    turns  the dead centres, at which friction jumps; those of `jumps` first, which are exact; conditions
    leaps  where a member of a sum of loads jumps over Y: there rounding decides which side a value is of
    """

    nodes: Array
    kinks: Marks
    jumps: Marks
    arcs: Mapping[str, Arcs]
    turns: Array
    leaps: Array

    def pieces(self, rows: NDArray[np.intp], theta: Array) -> dict[str, NDArray[np.intp]]:
        """The pieces to hold at angles of the designs `rows`."""
        return {name: arcs.at(rows, theta) for name, arcs in self.arcs.items()}

    def nodes_of(self, rows: NDArray[np.intp]) -> Array:
        """The nodes of the designs `rows`: one row for all, or one for each."""
        return self.nodes if len(self.nodes) == 1 else self.nodes[rows]

    def aside(self, rows: NDArray[np.intp], theta: Array) -> Array:
        """The angles of the designs `rows`, moved off dead centres, where friction jumps."""
        room = ROUNDED * np.spacing(1.0 + np.abs(theta))
        for turns in self.turns.T:
            apart = theta - turns[rows]
            near = np.abs(apart) < room
            if near.any():
                theta = np.where(near, turns[rows] + np.where(apart >= 0.0, room, -room), theta)
        return theta


def course_of(designs: SearchedDesigns) -> Course:
    """The loads and conditions of designs over their range of angles."""
    low, high = designs.theta
    over_Y = {name: load for name, load in designs.loads.items() if isinstance(load, OverY)}
    of_motion = {name: load for name, load in designs.loads.items() if isinstance(load, OfMotion)}
    members = members_of(of_motion.values())
    lengths = designs.lengths if over_Y or of_motion or designs.rubs else []
    dead = dead_centres(lengths) if lengths else np.empty((designs.size, 0))
    met = {name: meeting_and_bent(load, lengths, designs.branch) for name, load in over_Y.items()}
    arcs = _arcs(designs, {name: every for name, (every, _) in met.items()}, dead)
    turning = repeated(dead, low, high) if lengths else dead
    parts = [
        _over_Y(over_Y[name], arcs.get(name), designs, *met[name], turning)
        if name in met
        else _over_theta(load, designs)
        for name, load in designs.loads.items()
        if name not in of_motion
    ]
    parts += [_over_theta(load, designs) for load in members if isinstance(load, OverTheta)]
    leaps = [np.empty((designs.size, 0))]
    for load in members:
        if isinstance(load, OverY):
            every, bent = meeting_and_bent(load, lengths, designs.branch)
            parts.append(_over_Y(load, None, designs, every, bent, turning))
            if load.jumping:
                (own,) = _arcs(designs._replace(loads={"": load}), {"": every}, dead).values()
                leaps.append(np.where(own.leaps, own.starts, np.nan))
    parts += _at_speeds(speeds_of(members), designs)
    known = [*(angles for part in parts for angles, _ in (*part.kinks, *part.jumps)), turning]
    conditions = _conditions(designs, np.concatenate(known, axis=1)) if designs.conditions else []
    parts += conditions
    nodes = np.concatenate([np.full((designs.size, 1), low), *(part.nodes for part in parts)], axis=1)
    nodes = np.where(np.isfinite(nodes), np.clip(nodes, low, high), low)
    if not (over_Y or of_motion or designs.conditions):
        nodes = nodes[:1]
    some = (nodes != low).any(axis=0)  # of four turns that a range may touch, most are empty
    some[0] = True
    nodes = nodes[:, some]
    kinks, jumps = (_marks([mark for part in parts for mark in part[k]], designs.size) for k in (1, 2))
    turns = [jumps.of(TURNING), turning, *(angles for part in conditions for angles, _ in part.jumps)]
    return Course(nodes, kinks, jumps, arcs, *(np.concatenate(every, axis=1) for every in (turns, leaps)))


class _Part(NamedTuple):
    """The additions of a load to a course: nodes; kinks and jumps, angles of each with what keeps them."""

    nodes: Array
    kinks: list[tuple[Array, int]]
    jumps: list[tuple[Array, int]]


def _conditions(designs: SearchedDesigns, known: Array) -> list[_Part]:
    """The angles at which conditions change their sign, but for those at which a load or friction jumps."""
    start = np.full((designs.size, 1), designs.theta[0])
    nodes = own_nodes(designs)[0]
    edges = np.where(np.isfinite(known), np.clip(known, *designs.theta), start)
    room = ROUNDED * np.spacing(1.0 + np.abs(edges))
    nodes = np.sort(np.concatenate([nodes, edges - room, edges + room], axis=1), axis=1)
    parts = []
    for number, name in enumerate(designs.conditions):

        def value(rows: NDArray[np.intp], theta: Array, name: str = name) -> Any:
            return designs.values((name,), rows, theta)[name]

        angles = sign_changes(value, nodes)
        at_load = (np.abs(angles[:, :, None] - known[:, None]) <= AT_KINK).any(axis=2)
        angles = np.where(at_load, np.nan, angles)
        marks = [(angles, CONDITION + number)]
        parts.append(_Part(np.append(angles, np.nextafter(angles, -inf), axis=1), marks, marks))
    return parts


def _at_speeds(speeds: Sequence[float], designs: SearchedDesigns) -> list[_Part]:
    """The angles at which the slider has the speeds of a table: there is a kink."""
    if not speeds:
        return []
    inputs = {**dict.fromkeys(SPEEDS), "theta": 0.0, **designs.columns}
    velocity = request(("V_C", "V_C_wrt_theta"), inputs, designs.branch, "standard")
    values = Evaluations(Search(velocity.names[0], (), velocity.form, velocity.fixed))
    block = values.block(designs, np.arange(designs.size))
    nodes = own_nodes(designs)[0].T if are_special(designs).any() else even_nodes(designs)[:, None]
    parts = []
    for speed in speeds:

        def excess(theta: Array, block: Array, speed: float = speed) -> tuple[Array, Array]:
            value, slope = values.curve(theta, block)
            return value - speed, slope

        angles = sign_changes_of(excess, nodes, block)
        room = BESIDE * np.spacing(1.0 + np.abs(angles))
        beside = np.concatenate([angles - room, angles + room], axis=1)
        parts.append(_Part(beside, [(angles, SPEED)], []))
    return parts


def _over_theta(load: Load, designs: SearchedDesigns) -> _Part:
    low, high = designs.theta
    assert isinstance(load, OverTheta)
    own = _jumps_over_theta(load, low, high)
    every = np.unique(np.concatenate([load.nodes(low, high, smooth=True), own, np.nextafter(own, -inf)]))
    marks = [(np.broadcast_to(own, (designs.size, own.size)), FIXED)]
    return _Part(np.broadcast_to(every, (designs.size, every.size)), marks, marks)


def _jumps_over_theta(load: OverTheta, low: float, high: float) -> Array:
    """The first angle after each kink or jump of a load over theta."""
    room = BESIDE * float(np.spacing(max(abs(low), abs(high))))
    return np.array(load.nodes(low - room, high + room, smooth=False))


def _over_Y(
    load: OverY, arcs: Arcs | None, designs: SearchedDesigns, every: Array, bent: Array, turning: Array
) -> _Part:
    crossing, own = KIND_OF[load.centre], repeated(bent, *designs.theta)
    kinks = [(own, crossing), (turning, TURNING)]
    if arcs is None:
        room = BESIDE * np.spacing(1.0 + np.abs(own))  # so that no search halves its way to a kink
        smooth = [] if every is bent else [repeated(every, *designs.theta)]
        return _Part(np.concatenate([own - room, own + room, *smooth], axis=1), kinks, [])
    jumps = [(np.where(arcs.turns, arcs.starts, np.nan), TURNING)]
    jumps += [(np.where(arcs.leaps & ~arcs.turns, arcs.starts, np.nan), crossing)]
    before = np.nextafter(arcs.starts, -inf)  # where the slope is that of the arc before
    return _Part(np.append(arcs.starts, before, axis=1), kinks, jumps)


def _arcs(designs: SearchedDesigns, met: Mapping[str, Array], dead: Array) -> dict[str, Arcs]:
    """The arcs of the loads over Y that jump; of designs with NaN among their inputs those of others."""
    clean = {name: np.where(np.isnan(column), 1.0, column) for name, column in designs.columns.items()}
    arcs = {
        name: arcs_of(load, clean, designs.branch, designs.theta, meeting_in_turn(load, every, dead))
        for name, every in met.items()
        if isinstance(load := designs.loads[name], OverY) and load.jumping
    }
    if len(designs.loads) > 1:
        _join_jumps(designs._replace(columns=clean), arcs)
    return arcs


def _join_jumps(designs: SearchedDesigns, arcs: dict[str, Arcs]) -> None:
    """Let arcs begin where another load jumps at the same angle, as far as rounding tells."""
    for name, own in arcs.items():
        others = [np.full((designs.size, 1), np.nan)]
        others += [np.where(arcs[n].leaps, arcs[n].starts, np.nan) for n in arcs if n != name]
        for load in designs.loads.values():
            if isinstance(load, OverTheta):
                angles = _jumps_over_theta(load, *designs.theta)
                others.append(np.broadcast_to(angles, (designs.size, angles.size)))
        angles = np.concatenate(others, axis=1)[:, None, :]
        apart = np.abs(np.where(own.leaps, own.starts, np.nan)[:, :, None] - angles)
        for row, number in np.argwhere((apart <= BESIDE * np.spacing(np.abs(angles))).any(axis=2)).tolist():
            near = angles[row, 0]
            own.starts[row, number] = near[np.nanargmin(np.abs(near - own.starts[row, number]))]


def _marks(parts: list[tuple[Array, int]], size: int) -> Marks:
    """Angles and what keeps them, from parts; without places that are empty in every design."""
    angles = np.concatenate([np.empty((size, 0)), *(part for part, _ in parts)], axis=1)
    kinds = np.concatenate([np.empty(0, np.int8), *(np.full(a.shape[1], kind, np.int8) for a, kind in parts)])
    used = ~np.isnan(angles).all(axis=0)
    return Marks(angles[:, used], kinds[used])
