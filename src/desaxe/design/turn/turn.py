"""One design over its cycle: its inputs, checked, and its quantities in panels between edges."""

from collections.abc import Mapping, Sequence
from math import fsum
from typing import Any

import numpy as np

from ...evaluation.labelled import loads_of
from ...loads.angles import turns_of
from ...loads.resolve import VARIABLE
from ...mechanism.inputs import INPUTS
from ...mechanism.keywords import check_inputs
from ...mechanism.messages import amount, named
from ...mechanism.names import LENGTHS
from ...mechanism.read import read
from ...mechanism.status import PointStatus
from ...runtime.request import as_number, check_common, check_sliders, is_steady, request
from ...support.computed import computed_once
from ...support.panels import Array
from .cycle import MOST_TURNS, Cycle, Motion

WIDEST = 1e30  # of magnitudes: sums of products of several inputs lose their digits beyond
CREEP = 1e-100  # rad/s: friction and loads have their way, inertia does nothing; a torque below it is none
JAMS = int(PointStatus.NO_FORCE_BALANCE)


class NoCycleError(ValueError):
    """A quantity is undefined at some angle of the turn; `status` is the reason."""

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status


class Turn(Cycle):
    """The inputs of one design, checked; its quantities over its cycle."""

    def __init__(
        self, caller: str, inputs: Mapping[str, Any], branch: int, accelerates: bool = False
    ) -> None:
        inputs = {name: v for name, v in inputs.items() if name != "alpha" or not is_steady(v)}
        known = [n for n in INPUTS if n not in ("theta", "omega") and (accelerates or n != "alpha")]
        check_inputs(caller, inputs, known)
        check_common({}, branch)
        given, loads = loads_of({name: value for name, value in inputs.items() if value is not None})
        turns = turns_of(caller, loads, MOST_TURNS)
        numbers = {name: _number(caller, name, value) for name, value in given.items()}
        super().__init__(numbers, loads, branch, turns, numbers.get("omega0", 1.0) < 0.0)
        for name in LENGTHS:
            if name not in self.numbers:
                as_number(name, None, LENGTHS, (caller,))

    def floor(self, name: str) -> float:
        """The magnitude up to which a coefficient of a sum over sliders is rounding; 0 of one slider."""
        return 0.0

    @computed_once
    def parameters(self) -> tuple[str, ...]:
        """The inputs that are numbers and matter to the torque."""
        return self._parameters(self.numbers)

    @computed_once
    def moving_parameters(self) -> tuple[str, ...]:
        """The inputs that are numbers and matter to the torque at a varying speed, but for the speed."""
        state = {"omega": 1.0, "alpha": 1.0}
        numbers = {n: value for n, value in self.numbers.items() if n != "omega0"}
        return tuple(n for n in self._parameters({**numbers, **state}) if n not in state)

    def _parameters(self, numbers: Mapping[str, float]) -> tuple[str, ...]:
        asked = request(("T_in",), {**numbers, **self.loads}, self.branch, "standard")
        return tuple(n for n in asked.inputs if n != "theta" and n not in self.loads)

    @property
    def direction(self) -> float:
        """1 where the crank turns forwards, -1 backwards."""
        return -1.0 if self.backwards else 1.0

    @property
    def margin(self) -> float:
        """BC - AB - |ec|, rounded once."""
        return fsum((self.numbers["BC"], -self.numbers["AB"], -abs(self.numbers["ec"])))

    def values(
        self, names: Sequence[str], theta: Array, row: Any = 0, motion: Motion | None = None, **other: Any
    ) -> dict[str, Array]:
        """Quantities at angles; NoCycleError where there is none."""
        result = super().values([*names, "status"], theta, row, motion, **other)
        status = result.pop("status")
        bad = ~np.isfinite([result[name] for name in names]).all(0)
        if bad.any():
            codes, k = status[bad], int(np.argmax(bad))
            why = JAMS if JAMS in codes else int(codes[0]) or 4
            angle = named("theta", theta[k], ".6g")
            message = f"{', '.join(names)}: no value at " + angle + f" (status {status[k]})"
            raise NoCycleError(message, why)
        return result

    def moves(self, names: Sequence[str], angles: Array) -> dict[str, Array]:
        """By how much each input moves angles of jumps of quantities; 0 for other angles."""
        return {name: moves[0] for name, moves in super().moves(names, angles[None]).items()}

    def edges(self, names: Sequence[str], motion: Motion | None = None, **other: Any) -> Array:
        """The angles between which quantities are smooth, in any order; NaN in between."""
        return np.asarray(super().edges(names, motion, **other)[0])


def turn_of(
    caller: str, inputs: Mapping[str, Any], branch: int, sliders: Any, accelerates: bool = False
) -> Turn:
    """A design, or several sliders on one crankshaft, which know their turn themselves."""
    if sliders is None:
        return Turn(caller, inputs, branch, accelerates)
    check_sliders(sliders)
    turn: Turn = sliders.turn(caller, inputs, accelerates)
    return turn


def turning(caller: str, inputs: Mapping[str, Any], branch: int, sliders: Any = None) -> Turn:
    """A design whose crank turns fully, at constant speed."""
    turn = turn_of(caller, inputs, branch, sliders)
    if turn.margin < 0.0:
        raise cannot_turn(caller, turn)
    return turn


def cannot_turn(caller: str, turn: Turn) -> ValueError:
    """The error for a design whose crank cannot turn fully."""
    margin = amount("margin", turn.margin, "g", says_unit=True)
    return ValueError(f"{caller}: the crank cannot turn fully, margin = " + margin + " is less than 0")


def _number(caller: str, name: str, value: Any) -> float:
    more = " or a function of theta, over_theta or over_Y" if name in VARIABLE else ""
    each = f"[desaxe.{caller}({name}=value, ...) for value in values]"
    one = f"one number{more}, for one design; call it for each of them, as in {each}"
    return check_range(caller, name, read(INPUTS[name], value, caller, one))


def check_range(caller: str, name: str, number: float) -> float:
    """The number; ValueError beyond WIDEST."""
    if name != "theta" and abs(number) not in (0.0, CREEP) and not 1.0 / WIDEST <= abs(number) <= WIDEST:
        limit = f"{caller} takes 0 and magnitudes from {1.0 / WIDEST:g} to {WIDEST:g}"
        raise ValueError(named(name, number, "g") + f": {limit}")
    return number
