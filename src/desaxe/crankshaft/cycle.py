"""The cycle of a crankshaft: after it all of its sliders repeat; their edges are its edges."""

from collections.abc import Mapping, Sequence
from math import lcm
from typing import Any

import numpy as np

from ..design.turn.cycle import Cycle, Motion
from ..design.turn.turn import Turn
from ..mechanism.inputs import INPUTS
from ..mechanism.names import parts
from ..mechanism.read import read
from ..support.computed import computed_once
from ..support.panels import Array
from .sums import STATE, SliderSums, state_of

NEAR = 1e-9  # rad: an angle that is an edge
SAMPLES = 64  # of a turn, for the size of what a slider adds


class ShaftCycle(Cycle):
    """Sliders over their common cycle, each by its own one."""

    def __init__(self, caller: str, sliders: SliderSums, inputs: Mapping[str, Any], ends: Any = None) -> None:
        state = {name: read(INPUTS[name], value, caller) for name, value in inputs.items() if name in STATE}
        others = {name: value for name, value in inputs.items() if name not in STATE}
        self.named = [name for name in others if name.endswith("]") or name == "I_shaft"]
        self.sliders = sliders.replaced(others)
        speed = {"omega0": state.get("omega", state.get("omega0"))}  # of conditions that depend on it
        here = (
            {**speed, **{n: v for n, v in inputs.items() if v is not None}}
            for inputs in self.sliders.inputs_of_each()
        )
        self.own = [Turn(caller, own, own.pop("branch", 1)) for own in here]
        loads = {f"{n}[{k}]": load for k, own in enumerate(self.own) for n, load in own.loads.items()}
        self.sliders = self.sliders.replaced(loads)  # functions with derivatives by differences
        backwards = state.get("omega0", state.get("omega", 1.0)) < 0.0
        turns = lcm(*(own.turns for own in self.own))
        super().__init__({**state, "sliders": self.sliders}, {}, 1, turns, backwards)
        self._ends = ends

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest angle: of the cycle, or those that were asked for."""
        return super().ends if self._ends is None else self._ends

    @property
    def has_friction(self) -> bool:
        """True if a guide has friction."""
        return any(own.has_friction for own in self.own)

    @property
    def follows_speed(self) -> bool:
        """True if a load depends on how fast the crank turns."""
        return any(own.follows_speed for own in self.own)

    def values(
        self, names: Sequence[str], theta: Array, row: Any = 0, motion: Motion | None = None, **other: Any
    ) -> dict[str, Array]:
        """Quantities at angles, NaN where there is none; `other` inputs replace those of the sliders."""
        state = {n: v for n, v in self.numbers.items() if n != "sliders"}
        state |= {n: v for n, v in other.items() if n in STATE}
        if motion is not None:
            state = {**motion(theta)}
        sliders = self.sliders.replaced({n: v for n, v in other.items() if n not in STATE})
        result = sliders.evaluate(list(names), {**state, "theta": theta})
        return {name: np.broadcast_to(result[name], theta.shape) for name in names}

    def edges(self, names: Sequence[str], motion: Motion | None = None, **other: Any) -> Array:
        """The angles between which all sliders are smooth, in one row."""
        own = [self._edges_of(k, names, motion, **other) for k in range(len(self.own))]
        return np.concatenate([np.array(self.ends), *own])[None]

    def _edges_of(self, k: int, names: Sequence[str], motion: Motion | None = None, **other: Any) -> Array:
        """The edges of a slider, at angles of the shaft within the ends."""
        own, firing = self.own[k], self.sliders.members[k].firing
        motion = motion or self._motion(other)
        inputs = {n: v for n, v in other.items() if n not in STATE}
        names = self._names_of(k, names)
        here = Cycle.edges(own, names, lambda theta: motion(theta + firing), **inputs)
        low, high = self.ends
        first = low + (here[np.isfinite(here)] + firing - low) % own.angle
        every = first[:, None] + own.angle * np.arange(np.ceil((high - low) / own.angle))
        return np.asarray(every[every <= high])

    def _names_of(self, k: int, names: Sequence[str]) -> list[str]:
        """The quantities of a slider behind names of the shaft."""
        every = (self.sliders.quantity_terms(parts(name)[0]) for name in names)
        return [*dict.fromkeys(q for terms in every for one, q in terms if one == k)]

    def _motion(self, other: Mapping[str, Any]) -> Motion:
        """The speed and acceleration of the shaft under its law, or as they are given."""
        known = {n: v for n, v in {**self.numbers, **other}.items() if n in STATE}

        def motion(theta: Array) -> dict[str, Array]:
            state = state_of({**known, "theta": theta})
            omega = 0.0 if state.omega is None else state.omega
            return {n: np.broadcast_to(v, theta.shape) for n, v in (("omega", omega), ("alpha", state.alpha))}

        return motion

    def moves(self, names: Sequence[str], angles: Array) -> dict[str, Array]:
        """By how much each input moves angles of jumps; where two sliders jump at once, the first one's."""
        moves: dict[str, Array] = {}
        free = np.ones(angles.shape, bool)
        for k, own in enumerate(self.own):
            edges = self._edges_of(k, names)
            mine = free & (np.abs(angles[..., None] - edges).min(-1, initial=np.inf) < NEAR)
            free &= ~mine
            places = (angles - self.sliders.members[k].firing).reshape(1, -1)
            moved = Cycle.moves(own, self._names_of(k, names), places)
            result = {name: shift.reshape(angles.shape) for name, shift in moved.items()}
            result |= {f"{name}[{k}]": np.ones(angles.shape) for name in ("phase", "bank")}
            for name, shift in result.items():
                moves[name] = np.where(mine, shift, moves.get(name, 0.0))
        return moves


class ShaftTurn(Turn, ShaftCycle):
    """A crankshaft over its cycle, as `Turn` is one design."""

    def __init__(self, caller: str, sliders: SliderSums, inputs: Mapping[str, Any], ends: Any = None) -> None:
        ShaftCycle.__init__(self, caller, sliders, inputs, ends)

    @computed_once
    def moving_parameters(self) -> tuple[str, ...]:
        """The inputs of the sliders that matter to the torque, and the phases."""
        every = [name for own in self.own for name in own.moving_parameters]
        phases = [f"phase[{k}]" for k in range(len(self.own))]
        return tuple(dict.fromkeys([*every, *phases, *self.named]))

    @computed_once
    def parameters(self) -> tuple[str, ...]:
        """The inputs that matter to the torque, and the speed."""
        speeds = [name for name in ("omega0", "omega", "alpha") if name in self.numbers]
        return (*self.moving_parameters, *speeds)

    @property
    def margin(self) -> float:
        """The least BC - AB - |ec|."""
        return min(own.margin for own in self.own)

    def slopes_of(self, name: str) -> dict[str, str]:
        """The derivatives of a quantity, by the inputs that it depends on."""
        result, slopes = {}, dict.fromkeys(STATE, 1.0)
        for parameter in self.parameters:
            try:
                terms = self.sliders.terms(f"{name}_wrt_{parameter}", slopes)
            except ValueError:  # a motion does not depend on masses
                continue
            if terms:
                result[parameter] = f"{name}_wrt_{parameter}"
        return result

    def floor(self, name: str) -> float:
        """The magnitude of a sum that is rounding beside what a single slider adds."""
        state = {n: v for n, v in self.numbers.items() if n != "sliders"}
        return float(self.sliders.floor(name, {**state, "theta": self.samples}))

    @property
    def samples(self) -> Array:
        """Angles at which the size of what a slider adds is seen."""
        return np.linspace(*self.ends, SAMPLES * self.turns)
