"""Panels of time by compiled loops: the law as numbers for them, and what they return as panels."""

from collections.abc import Callable
from ctypes import CFUNCTYPE, c_double, c_int64, c_void_p, cast
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.llvm.loops import address
from .drive import FunctionCurve
from .law import Guide, Law, Rates
from .loops import newton, state
from .loops.compiled import panels as compiled_panels
from .panel import ENDS, INTEGRAL, NODES, PLACES, RUNNING, SERIES, Panel

Array = NDArray[np.float64]
BRIEF = 64  # panels of a call, which neither an interrupt nor a deadline stops
TABLE = np.vstack([PLACES[None], RUNNING, INTEGRAL, SERIES[-2:], ENDS])
_CALLED = CFUNCTYPE(c_int64, c_int64, c_int64, c_int64)


class PanelLimits(NamedTuple):
    """The end of a motion, its tolerance, and the angles and speeds at which it is cut."""

    t_end: float
    rtol: float
    sharp: float
    kinks: Array
    knots: Array


class Collocation:
    """Panels of one law after the other; the memory that they take while they are made."""

    def __init__(self, limits: PanelLimits, most: int) -> None:
        """Allocate the records of a call."""
        self.limits = limits
        self.rows, self.matrix = np.empty((newton.ROWS, NODES)), np.empty((2 * NODES, 2 * NODES))
        self.heads, self.records = np.empty((most + 1, 6)), np.empty((most + 1, 3, NODES + 1))
        self.rates = np.empty((most + 1, 7, NODES))
        self.error: BaseException | None = None
        self.stops = False

    def advance(
        self, law: Law, t: float, y: Array, wish: float, top: float, before: Panel | None, most: int
    ) -> tuple[list[Panel], float]:
        """Panels from a state on, none of which but the last may be cut; the length that they suggest.

        No panel: none resolves the law, however short. Raises what a load has raised that ends the motion.
        """
        law_numbers, data, keeper = self._numbers(law)
        clock = np.array([t, wish, self.limits.t_end, self.limits.sharp])
        scales, count = np.array([self.limits.rtol, top, top]), np.zeros(1)
        if before is not None:
            count[0] = 1.0
            self.heads[0] = before.start, before.h, before.error, *before.y
            self.records[0] = before.series
        size, self.error, self.stops = min(most + 1, len(self.heads)), None, False
        cuts = self.limits.kinks, self.limits.knots
        records = self.heads[:size], self.records[:size], self.rates[:size]
        known = law_numbers, data, TABLE, self.rows, self.matrix
        compiled_panels()(y.copy(), clock, scales, *cuts, *known, *records, count)
        del keeper
        made = int(count[0])
        if self.error is not None and (self.stops or not made):
            raise self.error
        return [self._panel(law, k) for k in range(1, made + 1)], float(clock[1])

    def part_of(self, panel: Panel, h: float, top: float) -> Panel | None:
        """A panel solved again up to a part of it; None where that fails."""
        limits, none = self.limits, np.empty((0, 2))
        self.limits = PanelLimits(panel.start + h, limits.rtol, limits.sharp, none, none[:, 0])
        try:
            panels, _ = self.advance(panel.law, panel.start, panel.y, h, top, panel, 1)
        except (ValueError, ArithmeticError):
            return None
        finally:
            self.limits = limits
        return panels[0] if panels and abs(panels[0].h - h) <= 1e-12 * h else None

    def _panel(self, law: Law, k: int) -> Panel:
        start, h, error, *_ = self.heads[k].tolist()
        t_end = self.limits.t_end
        stop = t_end if start + h >= t_end * (1.0 - 1e-15) else start + h
        y, series = self.heads[k, 3:].copy(), self.records[k].copy()
        q, v, work, omega, *guide = self.rates[k].copy()
        rates = Rates(q, v, work, omega, Guide(*guide) if law.rubs else None)
        return Panel(law, start, h, y, series, stop, error, rates)

    # ---- the law ------------------------------------------------------------------------------

    def _numbers(self, law: Law) -> tuple[Array, Array, Any]:
        """The numbers of a law, the packed inputs of its kernel, and what must live during a call."""
        numbers, arc = np.zeros(state.NUMBERS), law.model.coordinate
        numbers[state.HALF : state.TORQUE] = arc.half, arc.first, arc.last
        torque, *forces = law.drive.torque, law.drive.F_Y, law.drive.F_X
        forms, keeper = [curve.closed_form for curve in (torque, *forces)], [self._guarded(self._answer(law))]
        if isinstance(torque, FunctionCurve) and not torque.follows_the_slider:
            keeper.append(self._guarded(_torques(torque)))
            forms[0] = state.FUNCTION, _address(keeper[1])
        numbers[state.RUBS], numbers[state.ANSWER] = law.rubs, _address(keeper[0])
        data = np.zeros(1)
        if None not in forms:
            kernel, data = law.model.kernel
            numbers[state.KERNEL] = kernel.code.address
            for first, form in zip((state.TORQUE, state.FORCE, state.SIDEWAYS), forms, strict=True):
                numbers[first : first + len(form or ())] = form
            if law.rubs:
                guide, inputs = law.model.guide_kernel
                numbers[state.CONTACT : state.NUMBERS] = (
                    guide.code.address, address(inputs), law.model.mu * law.side * law.direction,
                    law.pressed, law.model.branch,
                )  # fmt: skip
        return numbers, data, keeper

    def _guarded(self, work: Callable[[int, int, int], None]) -> Any:
        """A function for the loops; they go on after an error of a load, and stop after all others."""

        def guarded(first: int, second: int, third: int) -> int:
            if self.stops:
                return newton.STOP
            try:
                work(first, second, third)
            except (ValueError, ArithmeticError) as raised:  # a load has no value: the panel may be shorter
                self.error = raised
                return newton.NONE
            except BaseException as raised:
                self.error, self.stops = raised, True
                return newton.STOP
            self.error = None
            return 0

        return _CALLED(guarded)

    def _answer(self, law: Law) -> Callable[[int, int, int], None]:
        """The function that the loops call where the law has no closed form: of state, rows, slopes."""

        def answer(state_at: int, _: int, slopes: int) -> None:
            q, v = _memory(state_at, 2 * NODES).reshape(2, NODES)
            self._fill(law, q, v, bool(slopes))

        return answer

    def _fill(self, law: Law, q: Array, v: Array, slopes: bool) -> None:
        rows, here = self.rows, law.here(self.rows[newton.TIME], q, v)
        rates = here.rates
        rows[newton.ANGLE], rows[newton.SLOPE], rows[newton.SPEED] = here.theta, here.slope, here.omega
        rows[newton.RATE_Q], rows[newton.RATE_V], rows[newton.RATE_W] = rates[:3]
        rows[newton.CURVED] = rates.v / (here.root * here.slope)
        if rates.guide is not None:
            rows[newton.NORMAL : newton.ROWS] = np.broadcast_arrays(*rates.guide)
        if slopes:
            jacobian = law.jacobian(here, q)
            for k, row in enumerate((newton.Q_BY_Q, newton.Q_BY_V, newton.V_BY_Q, newton.V_BY_V)):
                rows[row] = jacobian[k]


def _torques(curve: FunctionCurve) -> Callable[[int, int, int], None]:
    """A user's torque as the loops call it: rows of t, theta and omega, and one to fill in."""

    def torques(rows_at: int, apart: int, count: int) -> None:
        rows = _memory(rows_at, 3 * apart + count)
        rows[3 * apart :] = curve.at(*(rows[k * apart : k * apart + count] for k in range(3)))

    return torques


def _memory(start: int, size: int) -> Array:
    memory: Any = (c_double * size).from_address(start)
    return np.frombuffer(memory)


def _address(function: Any) -> int:
    return cast(function, c_void_p).value or 0
