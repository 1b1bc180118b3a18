"""Loads that vary with the motion, as an integrator needs them: smooth between the kinks at which it stops.

Between two kinks a table is one polynomial, which a step may follow a little beyond the kink that ends it; a
user's function stays at the node. Nothing is held before the motion starts and after it has ended: then the
load is that of the angle and the way of turning.
"""

from collections.abc import Callable
from math import copysign, inf, isfinite, isnan, nextafter
from typing import Any

import numpy as np

from ..loads.angles import crossings, zero_of
from ..loads.arguments import by_position
from ..loads.function import FunctionOverTheta
from ..loads.load import Load, OverTheta, OverY, TableOverTheta
from ..loads.table import polynomial
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres
from ..mechanism.messages import listed, named
from ..support.checks import real_number
from ..support.deadline import Deadline
from ..support.shown import shown

AHEAD = 1e-9  # rad: which piece of a table follows an angle
AHEAD_OF_Y = 1e-6  # rad: so far from a dead centre the slider has left its position

Place = Callable[[float], tuple[float, ...]]  # crank angle -> Y and Y_wrt_theta


class Held:
    """A load as a function of (t, theta, omega)."""

    def __init__(self, load: Load) -> None:
        self.load = load
        self.place: Place = lambda theta: (0.0, 0.0)
        self._zero = 0.0  # the position from which a load over the slider's place measures
        self._piece: Callable[[float], float] | None = None

    def __call__(self, t: float, theta: float, omega: float) -> float:
        """The load now; at rest the sign of omega's zero is the way in which the crank starts."""
        if self._piece is not None:
            return self._piece(theta)
        if isinstance(self.load, OverY):
            _, slope = self.place(theta)
            return float(self.load.value(self._along(self.load, theta), slope * copysign(1.0, omega)))
        assert isinstance(self.load, OverTheta)
        return float(self.load.value(theta))

    def stand(self, place: Place, lengths: tuple[float, ...], branch: int) -> None:
        """Stand in a design; ValueError where it has not the dead centre that a load is measured from."""
        self.place = place
        if isinstance(self.load, OverY):
            self._zero = float(zero_of(self.load, [np.array([length]) for length in lengths], branch)[0])
            if isnan(self._zero):
                which = self.load.centre.removeprefix("Y_")
                raise ValueError(f"{self.load!r}: this design has no {which} dead centre")

    @property
    def turns_with_the_slider(self) -> bool:
        """True where the load jumps when the slider turns round."""
        return isinstance(self.load, OverY) and self.load.inward is not None

    def hold(self, theta: float, way: float) -> None:
        """Hold the piece that lies ahead of an angle for a crank that turns one way."""
        load = self.load
        if isinstance(load, TableOverTheta):
            self._piece = _piece_of_table(load, theta + copysign(AHEAD, way))
        elif isinstance(load, FunctionOverTheta) and load.angles:
            self._piece = _piece_of_function(load, theta + copysign(AHEAD, way))
        elif isinstance(load, OverY):
            self._piece = self._piece_over_Y(load, theta + copysign(AHEAD_OF_Y, way), way)

    def release(self) -> None:
        """Hold nothing."""
        self._piece = None

    def _along(self, load: OverY, theta: float) -> float:
        return float(load.along({"Y": self.place(theta)[0], load.centre: self._zero}))

    def _piece_over_Y(self, load: OverY, ahead: float, way: float) -> Callable[[float], float]:
        _, slope = self.place(ahead)
        table = load.inward if load.inward is not None and slope * way < 0.0 else load.outward
        piece = table.piece(self._along(load, ahead))
        row, origin = table.rows[piece], table.origin(piece)
        return lambda theta: float(polynomial(row, self._along(load, theta) - origin)[0])

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """Angles of one period at which another piece is held, and that period [rad].

        Those are all places of a table: a cubic goes no farther than its own piece, and a high order cannot
        judge a step over a knot, however smoothly the next piece follows.
        """
        load = self.load
        if isinstance(load, TableOverTheta):
            return [(angle, load.period) for angle in dict.fromkeys(load.table.knots)]
        if isinstance(load, FunctionOverTheta):
            return [(angle, load.period) for angle in load.angles]
        assert isinstance(load, OverY)
        sides = [np.array([length]) for length in lengths]
        angles = crossings(load, load.positions(smooth=True), sides, branch)[0]
        if self.turns_with_the_slider:
            angles = np.append(angles, dead_centres(sides))
        return [(angle, TURN) for angle in angles[np.isfinite(angles)].tolist()]


class UserLoad:
    """A user's function as one of (t, theta, omega), checked wherever it is called."""

    def __init__(
        self,
        name: str,
        function: Callable[..., Any],
        arguments: tuple[str, ...],
        unit: str,
        deadline: Deadline,
    ) -> None:
        self.name, self.function, self.unit, self.deadline = name, by_position(function), unit, deadline
        self.arguments = arguments
        self.slider: Place | None = None  # Y, s and Y_wrt_theta

    @property
    def follows_the_slider(self) -> bool:
        """True where the function is called with the slider's position or speed."""
        return not {"Y", "s", "V_C"}.isdisjoint(self.arguments)

    def stand(self, slider: Place) -> None:
        """Stand in a design, whose slider the function follows."""
        self.slider = slider

    def __call__(self, t: float, theta: float, omega: float) -> float:
        """The load now."""
        self.deadline.check()
        now = {"t": t, "theta": theta, "omega": omega}
        if self.slider is not None:
            now["Y"], now["s"], slope = self.slider(theta)
            now["V_C"] = slope * omega
        passed = [now[argument] for argument in self.arguments]
        value = self.function(*passed)
        try:
            number = value if type(value) is float else real_number(self.name, value)
        except (TypeError, ValueError):
            raise TypeError(
                f"{self.name} gave {shown(value)} at t = {t:g}: expected a number in {self.unit}"
            ) from None
        if not isfinite(number) and all(map(isfinite, passed)):
            where = listed([named(argument, x, "g") for argument, x in (now | {"t": t}).items()])
            limit = f": it must be a finite number in {self.unit}"
            raise ValueError(f"{self.name} gave {number} at " + where + limit)
        return number


def _piece_of_table(load: TableOverTheta, ahead: float) -> Callable[[float], float]:
    table = load.table
    reduced = table.reduced(ahead)
    piece = table.piece(reduced)
    row, origin = table.rows[piece], ahead - (reduced - table.origin(piece))
    return lambda theta: float(polynomial(row, theta - origin)[0])


def _piece_of_function(load: FunctionOverTheta, ahead: float) -> Callable[[float], float]:
    nodes = load.nodes(ahead - 2.0 * load.period, ahead + 2.0 * load.period, smooth=False)
    low = max(node for node in nodes if node <= ahead)
    high = nextafter(min(node for node in nodes if node > ahead), -inf)
    return lambda theta: float(load.value(min(max(theta, low), high)))
