"""The law of designs as numbers for compiled loops, with the pieces of their loads.

Pieces are rows of where they start, and their numbers for both ways (`loops.law.piece`). Over the slider's
position they lie between the crank angles at which they meet.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.llvm.loops import address
from ..evaluation.evaluate import evaluate
from ..loads.angles import crossings, zero_of
from ..loads.elements import Spring
from ..loads.load import OverY, TableOverTheta
from ..loads.motors import Kloss, OverOmega
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres, passages
from ..mechanism.names import LENGTHS
from .loops.compiled import DesignFamily, packed
from .loops.law import (
    CALLS,
    CONTACT,
    CONTACT_DATA,
    COUNT,
    ENERGY,
    FUNCTION,
    HALF,
    KERNEL,
    KIND,
    KLOSS,
    LEANS,
    MU,
    OVER_OMEGA,
    OVER_THETA,
    OVER_Y,
    RUBS,
    SHEET,
    SLOTS,
    TERM,
    TERMS,
    TINY,
)  # fmt: skip

Array = NDArray[np.float64]


class LoadPieces(NamedTuple):
    """Pieces: rows of angle or speed, and both lists of numbers; for each design, or one for all.

    period   0: they are over the speed
    """

    period: float
    rows: Array


def table_sheet(load: TableOverTheta | OverOmega) -> LoadPieces:
    """The pieces of a table over angle or speed."""
    table, over_angle = load.table, isinstance(load, TableOverTheta)
    starts = table.knots if over_angle else (-np.inf, *table.knots)
    rows = table.rows[1:] if over_angle else table.rows
    kind, first = (OVER_THETA, 1) if over_angle else (OVER_OMEGA, 0)
    numbers = [(kind, table.origin(k), *row, 0.0) for k, row in enumerate(rows, first)]
    return _sheet(
        load.period if isinstance(load, TableOverTheta) else 0.0, np.array([starts]), numbers, numbers
    )


def meeting_angles(load: OverY, lengths: Sequence[Array], branch: int) -> Array:
    """The angles at a table's positions, and the dead centres where another table holds behind them."""
    angles = crossings(load, load.positions(smooth=True), lengths, branch)
    if load.centre and np.any(lengths[1] > lengths[2]):  # a long crank takes the slider past the dead centre
        zero = np.reshape(zero_of(load, lengths, branch), (-1, 1))
        angles = np.concatenate([angles, passages(zero, lengths, branch)], axis=1)
    if load.inward is not None:
        angles = np.concatenate([angles, dead_centres(lengths)], axis=1)
    return angles


def sheet_over_Y(
    load: OverY, lengths: Sequence[Array], branch: int, arc: Array, slider: Callable[[Array], Any]
) -> LoadPieces:
    """The pieces of a table over the slider's position.

    arc      of each design: both limit angles, or infinite
    slider   Y and Y_wrt_theta at angles of each design
    """
    angles = meeting_angles(load, lengths, branch)
    least = np.nanmin(np.column_stack([angles, np.full(len(angles), TURN)]), axis=1)
    bounded = np.isfinite(arc[:, :1])
    start = np.where(bounded, arc[:, :1], least[:, None])
    edges = np.hstack([start + (angles - start) % TURN, np.where(bounded, arc[:, 1:], start)])
    edges = np.sort(np.hstack([start, np.where(np.isnan(edges), start, edges)]), axis=1)
    middle = 0.5 * (edges + np.hstack([edges[:, 1:], start + TURN]))
    Y, slope = slider(middle)
    zero = zero_of(load, lengths, branch)[:, None]
    side = np.copysign(1.0, Y - zero) if load.centre else np.ones(Y.shape)
    known = np.array([(table.origin(k), *row) for table in load.tables for k, row in enumerate(table.rows)])
    ways = []
    for way in (1.0, -1.0):
        rows = known[np.asarray(load.piece(load.along({"Y": Y, load.centre: zero}), slope * way))]
        origin = (side * zero + rows[..., 0])[..., None]
        kind = np.full(origin.shape, OVER_Y)
        ways.append(np.concatenate([kind, origin, rows[..., 1:], side[..., None]], axis=-1))
    return _sheet(TURN, edges, *ways)


def _sheet(period: float, starts: Array, forth: Any, back: Any) -> LoadPieces:
    rows = np.empty((*starts.shape, 1 + 2 * SLOTS))
    rows[..., 0], rows[..., 1 : 1 + SLOTS], rows[..., 1 + SLOTS :] = starts, forth, back
    return LoadPieces(period, rows)


def compiles(load: Any) -> bool:
    """True for a load that is a list of pieces, or a closed form."""
    return isinstance(load, (TableOverTheta, OverY, Spring, OverOmega, Kloss))


class FunctionPieces(NamedTuple):
    """A function at addresses for either way of turning.

    varies   by angle, by speed
    angles   at which it bends
    """

    addresses: tuple[int, int]
    varies: tuple[float, float] = (1.0, 1.0)
    period: float = TURN
    angles: Array = np.empty(0)

    @property
    def ends(self) -> bool:
        """True where pieces do not go on smoothly behind their ends."""
        return self.angles.size > 0 and self.addresses[0] == self.addresses[1]

    def sheet(self) -> LoadPieces:
        """The pieces of the function, which differ in the angles between which they hold."""
        starts = np.unique(self.angles % self.period) if self.angles.size else np.zeros(1)
        ways = ((FUNCTION, one, -np.inf, np.inf, *self.varies, 0.0) for one in self.addresses)
        return _sheet(self.period if self.angles.size else 0.0, starts[None], *ways)


class LawNumbers:
    """The law of designs for compiled loops: numbers (see `loops.law`), packed inputs, pieces, knots.

    flat     inputs of the designs
    arcs     half of the arc and limit angles of each
    family   of their kernel; None where there is none
    terms    of torque and forces: which, factor, and numbers, a table, a motor or a function
    """

    def __init__(
        self,
        flat: Mapping[str, Array],
        branch: int,
        arcs: Array,
        family: DesignFamily | None,
        terms: Sequence[tuple[float, float, Any]],
    ) -> None:
        size, mu = len(arcs), flat["mu"]
        self.flat, self.branch, self.arcs = flat, branch, arcs[:, 1:]
        self.law, self.data = np.zeros((size, TERMS + TERM * len(terms))), np.zeros((size, 1))
        self.sheets, self.knots = np.empty((size, 0, 1 + 2 * SLOTS)), np.empty(0)
        self.law[:, HALF:RUBS], self.law[:, LEANS], self.law[:, COUNT] = arcs, branch, len(terms)
        self.law[:, MU], self.law[:, RUBS], self.law[:, TINY] = mu, mu != 0.0, 1e-9 * flat["AB"]
        for n, (arm, factor, form) in enumerate(terms):
            self._add(TERMS + TERM * n, arm, factor, form)
        if family is None:
            return
        inputs = {"branch": float(branch), **dict.fromkeys(("F_X", "F_Y"), np.nan), **flat}
        kernel = family.kernel()
        self.data, self.law[:, KERNEL] = packed(kernel, inputs, size), kernel.code.address
        if mu.any():
            guide = family.guide()
            self.contact = packed(guide, inputs, size)
            self.law[:, CONTACT] = guide.code.address
            self.law[:, CONTACT_DATA] = address(self.contact) + self.contact.strides[0] * np.arange(size)

    def _add(self, at: int, arm: float, factor: float, form: Any) -> None:
        """Add a term, whose numbers start at a column."""
        law, first = self.law, at + KIND
        law[:, at], law[:, at + 1] = arm, factor
        if isinstance(form, np.ndarray):
            law[:, first + 1] = size = form
        elif isinstance(form, Kloss):
            most, slip, speed, gear = (self.flat.get(n, np.array([x])) for n, x in form.numbers.items())
            columns = KLOSS, gear * np.copysign(most, speed), slip, speed, gear
            law[:, first : first + 5] = np.stack(np.broadcast_arrays(*columns), axis=1)
            size = most
        else:
            sheet = self._sheet(form)
            rows = np.broadcast_to(sheet.rows, (len(law), *sheet.rows.shape[1:]))
            law[:, at + SHEET : at + KIND - 1] = self.sheets.shape[1], rows.shape[1], sheet.period
            self.sheets, size = np.concatenate([self.sheets, rows], axis=1), np.zeros(1)
            if isinstance(form, Spring):
                size = form.stiffness * self.flat["AB"]
            elif isinstance(form, FunctionPieces):
                law[:, first : first + SLOTS] = rows[:, 0, 1 : 1 + SLOTS]
                law[:, CALLS] = np.maximum(law[:, CALLS], 2.0 if form.ends else 1.0)
            else:
                size = np.abs(rows[:, :, 3]).max(axis=1)
        if arm < 2.0:
            law[:, ENERGY] = np.maximum(
                law[:, ENERGY], np.abs(factor * size) * (self.flat["AB"] if arm else 1.0)
            )

    def _sheet(self, load: Any) -> LoadPieces:
        if isinstance(load, FunctionPieces):
            return load.sheet()
        if isinstance(load, OverY):
            lengths = [self.flat[name] for name in LENGTHS]
            return sheet_over_Y(load, lengths, self.branch, self.arcs, self._slider)
        if isinstance(load, Spring):
            numbers = (OVER_Y, load.table.origin(0), *load.table.rows[0], 1.0)
            return _sheet(0.0, np.zeros((1, 1)), numbers, numbers)
        if isinstance(load, OverOmega):
            self.knots = np.array(load.knots)
        return table_sheet(load)

    def _slider(self, theta: Array) -> tuple[Any, Any]:
        inputs: dict[str, Any] = {name: self.flat[name][:, None] for name in LENGTHS}
        both = evaluate(["Y", "Y_wrt_theta"], theta=theta, branch=self.branch, **inputs)
        return both["Y"], both["Y_wrt_theta"]
