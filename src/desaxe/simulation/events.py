"""Events of a motion: the angles to watch for, those that panels pass, and words for its end."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.closed import TURN
from ..mechanism.messages import Message, amount, named
from ..support.roots import roots
from .checks import SMALL
from .law import state_of
from .loops.compiled import NODES
from .loops.cuts import KINK as CUT_AT_ANGLE
from .model import Model
from .panel import Record, basis
from .result import DONE, LIMIT, NO_INERTIA, Event

Array = NDArray[np.float64]
NEAR = 1e-9  # rad: an angle that a stretch starts from is not reached at once
Q, V, W = range(3)
NEVER = -1  # of an angle that does not end the motion
STANDSTILL, JAM = "standstill", "friction jams"
MOST_PASSAGES = 100_000  # of each dead centre that are listed


class Mark(NamedTuple):
    """A crank angle to detect, repeated at intervals of `every`; `status` is that of the end if it is one."""

    kind: str
    angle: float
    which: str = ""
    every: float = 0.0
    status: int = NEVER


def marks_of(model: Model, until: Sequence[float]) -> list[Mark]:
    """All angles to watch for."""
    marks = [Mark("angle", angle, status=DONE) for angle in until]
    marks += [Mark("dead centre", angle, which, TURN) for which, angle in model.dead_centres().items()]
    for which, angle in model.vanishing().items():  # its two sides, so near that nothing is lost
        marks += [Mark("no inertia", angle + s * SMALL, which, TURN, NO_INERTIA) for s in (-1.0, 1.0)]
    first, last = model.coordinate.first, model.coordinate.last
    if first > -inf:
        marks += [Mark("limit", first, "first", status=LIMIT), Mark("limit", last, "last", status=LIMIT)]
    return marks


def passages(model: Model, marks: Sequence[Mark], record: Record) -> tuple[list[Event], bool]:
    """The dead centres that a motion passes, and whether there were too many to list them all.

    On a panel the crank turns one way.
    """
    centres = [mark for mark in marks if mark.kind == "dead centre"]
    y = np.vstack([record.y, record.last])
    theta = np.asarray(model.coordinate.theta(y[:, Q]))
    a, b = theta[:-1], theta[1:]
    way = np.sign(b - a)
    cut = record.ends[:, 0] == CUT_AT_ANGLE
    left = np.concatenate([[True], cut[:-1]])  # an angle that the panel starts from is behind it
    passed, names, too_many = list[tuple[NDArray[np.intp], Array]](), list[str](), False
    for mark in centres:
        gap = ((mark.angle - a) * way) % TURN
        gap += np.where((gap <= np.where(left, NEAR, 0.0)) | (way == 0.0), TURN, 0.0)
        reach = np.abs(b - a) + np.where(cut, NEAR, 0.0)
        turning = np.flatnonzero(gap <= reach)
        times = (1.0 + (reach[turning] - gap[turning]) // TURN).astype(np.intp)
        listed = np.clip(MOST_PASSAGES - (np.cumsum(times) - times), 0, times)
        too_many |= bool((listed < times).any())
        index = np.repeat(turning, listed)
        before = np.arange(index.size) - np.repeat(np.cumsum(listed) - listed, listed)
        turns = np.round((a[index] + way[index] * (gap[index] + TURN * before) - mark.angle) / TURN)
        passed.append((index, mark.angle + TURN * turns))
        names += [mark.which] * index.size
    if not names:
        return [], too_many
    index, angles = (np.concatenate(columns) for columns in zip(*passed, strict=True))
    values = np.array([model.coordinate.q(angle) for angle in angles.tolist()])
    start, series = record.y[index, :W], record.series[index, :W]

    def state(s: Array) -> Array:
        moved: Array = np.einsum("kij,jk->ki", series, basis(2.0 * s - 1.0, NODES))
        return start + moved

    h = record.heads[index, 1]
    end = np.where(
        h > 0.0, (record.heads[index, 6] - record.heads[index, 0]) / np.where(h > 0.0, h, 1.0), 0.0
    )
    first, last = start[:, Q] - values, state(end)[:, Q] - values
    s = roots(lambda s: state(s)[:, Q] - values, np.zeros(index.size), end, first, last)
    s = np.where(first * last < 0.0, s, np.where(np.abs(first) < np.abs(last), 0.0, end))
    now = state_of(model, *state(s).T)
    instants, stop = record.heads[index, 0] + s * h, record.heads[index, 6]
    instants = np.where(cut[index] & (np.abs(instants - stop) <= NEAR * h), stop, instants)
    columns = (instants, model.coordinate.theta(values), now.omega)
    rows = zip(*(np.asarray(column).tolist() for column in columns), names, strict=True)
    return [Event("dead centre", *row) for row in rows], too_many


# ---- in words -------------------------------------------------------------------------------------


def time_of(t: float) -> Message:
    """An instant with its unit."""
    return amount("t", t, ".6g", says_unit=True)


def angle_of(theta: float) -> Message:
    """A crank angle with its unit."""
    return amount("theta", theta, ".6g", says_unit=True)


def words_of(mark: Mark, t: float) -> Message:
    """The message of a motion that ends at a mark."""
    if mark.status == DONE:
        return "reached the angle " + angle_of(mark.angle) + " at t = " + time_of(t)
    if mark.status == LIMIT:
        where = "reached the limit angle " + angle_of(mark.angle) + " (S = 0) at t = " + time_of(t)
        return where + ": beyond it there is no mechanism, or, at a change point, either branch"
    why = (
        f"the effective inertia vanishes at the {mark.which} dead centre: without m_crank and I_crank the "
        "crank has no speed there (M_eff -> 0); stopped "
    )
    return why + angle_of(SMALL) + " before it at t = " + time_of(t)


def failure(t: float, theta: float, omega: float, reason: str) -> Message:
    """The message of a motion that could not be followed to its end."""
    state = named("theta", theta, ".6g") + ", " + named("omega", omega, ".6g")
    return "the integration failed at t = " + time_of(t) + ", " + state + f": {reason}"
