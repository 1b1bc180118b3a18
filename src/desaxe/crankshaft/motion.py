"""The equation of motion of a crankshaft: inertia, gravity's torque and that of loads and guides are sums.

The loads of all sliders, F_Y dY/dtheta, less the friction of all guides are one torque on the shaft. With c
and k of `simulation.law`, and p the sign of its normal force, each guide takes

    c |N| = s (n0 + n1 alpha),    s = c p/(1 - k p),    alpha = (Q - sum s n0)/(M + sum s n1),

and the signs are those with which alpha agrees.
"""

from collections.abc import Callable, Mapping
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np

from ..loads.angles import cycle
from ..loads.load import Load
from ..mechanism.closed import TURN
from ..mechanism.messages import message_of
from ..simulation.checks import design_values, drive_of, model_of
from ..simulation.coordinate import Coordinate
from ..simulation.drive import NOTHING, Acting, Actuation, Called, kinks_of, needs_of
from ..simulation.loops.law import TORQUE
from ..simulation.model import Model
from ..support.deadline import Deadline
from .sums import SliderSums

Moves = Callable[[float], Mapping[str, float]]
AT_LIMIT = 1e-9  # rad


class Piece(NamedTuple):
    """A slider in the motion: its model, its loads, the angle of the shaft at which it begins."""

    model: Model
    loads: Actuation
    firing: float

    def force(
        self, acting: Acting, t: Any, theta: Any, omega: Any, direction: float, low: float, high: float
    ) -> Any:
        """The value of one of its loads at angles of the shaft."""
        slider, f = self.model.slider_of(), self.firing
        state = t, theta - f, omega, direction, low - f, high - f
        return sum(factor * Called(part, slider).at(*state) for factor, part in acting.terms)


class ShaftTorque(Called):
    """The torque of the loads and guides of all sliders on the shaft."""

    directed = True

    def __init__(self, shaft: "ShaftModel") -> None:
        self.shaft = shaft
        parts = [part for one in shaft.pieces for acting in one.loads for _, part in acting.terms]
        needs = (name for part in parts for name in needs_of(part))
        self.needs = tuple(dict.fromkeys(("theta", *needs, *(("omega",) if shaft.rubs else ()))))
        self.cycle = cycle({str(k): part for k, part in enumerate(parts) if isinstance(part, Load)})

    def at(
        self, t: Any, theta: Any, omega: Any, direction: float = 0.0, low: float = -inf, high: float = inf
    ) -> Any:
        """The loads, and what friction takes."""
        piece = direction, low, high
        push = sum(
            one.force(one.loads.F_Y, t, theta, omega, *piece) * one.model.slider(theta - one.firing)[2]
            for one in self.shaft.pieces
        )
        return push - self._taken(t, theta, omega, piece, push) if self.shaft.rubs else push

    def _taken(self, t: Any, theta: Any, omega: Any, piece: Any, push: Any) -> Any:
        """The torque of friction; NaN where no signs of the normal forces agree, or no forces balance."""
        still, steeper, weight, *_ = self.shaft.quantities(theta)
        torque = Called(self.shaft.drive.torque.value, self.shaft.slider_of()).at(t, theta, omega)
        push = push + torque - weight - 0.5 * steeper * omega**2
        rubbing = [one for one in self.shaft.pieces if one.model.mu]
        guides = [_guide(one, t, theta, omega, *piece) for one in rubbing]
        normal, by_alpha, arm, wedge = (np.array(rows) for rows in zip(*guides, strict=True))
        alpha, pressed = push / still, np.zeros(normal.shape)
        with np.errstate(all="ignore"):
            for _ in range(2 * len(guides) + 2):
                before, pressed = pressed, np.copysign(1.0, normal + by_alpha * alpha)
                if (before == pressed).all():
                    break
                share = arm * pressed / (1.0 - wedge * pressed)
                inertia = still + (share * by_alpha).sum(0)
                alpha = (push - (share * normal).sum(0)) / inertia
            good = ((before == pressed) & (wedge * pressed < 1.0)).all(0) & (inertia > 0.0)
        return np.where(good, push - still * alpha, nan)

    @property
    def kinks(self) -> tuple[float, Any]:
        """The angles of the shaft at which pieces of a load meet, and friction turns round."""
        result = list[float]()
        for model, loads, firing in self.shaft.pieces:
            kinks = [kinks_of(part, model.slider_of()) for acting in loads for _, part in acting.terms]
            kinks += [(TURN, np.array([*model.dead_centres().values()] if model.mu else []))]
            for period, angles in kinks:
                for k in range(max(1, round(self.cycle / period))):
                    result += (angles + firing + k * period).tolist()
        return self.cycle, np.array(result)

    def moves(self, theta: float) -> Mapping[str, float]:
        """By how much inputs, and phases, move a kink at an angle of the shaft."""
        return self.shaft.moves(theta)


def _guide(one: Piece, t: Any, theta: Any, omega: Any, direction: float, *ends: float) -> tuple[Any, ...]:
    """Normal force without friction at alpha = 0, its slope by alpha, arm c and wedge k of a guide."""
    forces = [one.force(acting, t, theta, omega, direction, *ends) for acting in one.loads[1:]]
    theta = theta - one.firing
    normal, by_alpha, _, phi = one.model.contact(theta, omega, *map(np.asarray, forces))
    turning, travel = direction or np.copysign(1.0, omega), one.model.slider(theta)[2]
    wedge = one.model.mu * one.model.branch * np.tan(phi) * np.sign(travel) * turning
    return np.broadcast_arrays(normal, by_alpha, one.model.mu * np.abs(travel) * turning, wedge)


class ShaftModel(Model):
    """Several sliders on a crankshaft as a model of the motion, between the limit angles of all."""

    def __init__(
        self, sliders: SliderSums, theta0: float, torque: Acting, moves: Moves, deadline: Deadline
    ) -> None:
        self.sliders, self.mu, self.branch, self.moves = sliders, 0.0, 1, moves
        self.values = {"AB": 1.0}  # of the travel
        self.pieces = []
        for k, inputs in enumerate(sliders.inputs_of_each()):
            firing = float(sliders.members[k].firing)
            loads = drive_of(0.0, inputs.get("F_X"), inputs.get("F_Y"), deadline)
            try:
                model = model_of(design_values(inputs), inputs.get("branch", 1), theta0 - firing, loads)
            except ValueError as error:
                raise ValueError(f"slider {k}, under theta - firing[{k}]: " + message_of(error)) from None
            self.pieces.append(Piece(model, loads, firing))
        self.rubs = any(one.model.mu for one in self.pieces)
        self.coordinate = self._coordinate()
        self.drive = Actuation(torque, Acting(0.0), Acting(0.0))
        self.terms = [*self._terms(), (TORQUE, 1.0, ShaftTorque(self))]

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickle has the sliders but not what drives them, which may be any function."""
        theta = self.coordinate.theta(0.0)
        return ShaftModel, (self.sliders, theta, NOTHING.torque, dict, Deadline("simulate", None))

    def _coordinate(self) -> Coordinate:
        """The coordinate between the nearest limit angles of all sliders."""
        arcs = [(one.model.coordinate, one.firing) for one in self.pieces]
        first, of_first = max((arc.first + f, k) for k, (arc, f) in enumerate(arcs))
        last, of_last = min((arc.last + f, k) for k, (arc, f) in enumerate(arcs))
        both = [arcs[k][0].half > 0.0 for k in (of_first, of_last)]
        if both[0] != both[1]:
            raise ValueError(
                f"simulate: at one limit angle of sliders {of_first} and {of_last} the inertia grows without "
                "bound, at the other it does not: give both a slider's mass"
            )
        return Coordinate(first, last, 0.5 * (last - first) if both[0] else 0.0)

    @property
    def lengths(self) -> tuple[float, ...]:
        """There are none of the shaft."""
        return (nan, nan, nan)

    @property
    def friction(self) -> float | None:
        """That of the sliders."""
        return None if self.rubs else 0.0

    def limit(self, theta: float) -> dict[str, float]:
        """The shift of a limit angle by the inputs of the slider that has it, and its phase."""
        result: dict[str, float] = {}
        for k, (model, _, firing) in enumerate(self.pieces):
            arc = model.coordinate
            if min(abs(theta - firing - end) for end in (arc.first, arc.last)) < AT_LIMIT:
                own = model.limit(theta - firing)
                result |= {**own, **{f"{n}[{k}]": v for n, v in own.items()}}
                result |= {f"phase[{k}]": 1.0, f"bank[{k}]": 1.0}
        return result

    def family(self) -> None:
        """There is no kernel of the shaft."""

    def quantities(self, theta: Any) -> tuple[Any, ...]:
        """Inertia and gravity's torque with their slopes, the potential energy; there is no slider."""
        each = (one.model.quantities(theta - one.firing) for one in self.pieces)
        inertia, steeper, weight, heavier, _, _, potential, _ = map(sum, zip(*each, strict=True))
        none = np.zeros(np.shape(theta))
        return inertia + float(self.sliders.I_shaft), steeper, weight, heavier, none, none, potential, none

    def dead_centres(self) -> dict[str, float]:
        """There are none of the shaft."""
        return {}
