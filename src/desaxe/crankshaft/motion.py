"""The equation of motion of a crankshaft: inertia, gravity's torque and that of loads and guides are sums.

The loads of all sliders, F_Y dY/dtheta, less the friction of all guides are one torque, in the law's place
for the force of a slider whose travel is the crank angle itself. With c and k of `simulation.law`, and p the
sign of its normal force, each guide takes

    c |N| = s (n0 + n1 alpha),    s = c p/(1 - k p),    alpha = (Q - sum s n0)/(M + sum s n1),

and the signs are those with which alpha agrees.
"""

from collections.abc import Callable, Mapping, Sequence
from math import nan
from typing import Any, NamedTuple

import numpy as np

from ..mechanism.closed import TURN
from ..mechanism.messages import message_of
from ..simulation.checks import design_values, drive_of, model_of
from ..simulation.coordinate import Coordinate
from ..simulation.drive import ConstantCurve, Curve, Slopes, difference
from ..simulation.model import NOTHING, Actuation, Model, Still
from ..support.deadline import Deadline
from .sums import SliderSums

Moves = Callable[[float], Mapping[str, float]]
AT_LIMIT = 1e-9  # rad


class Piece(NamedTuple):
    """A slider in the motion: its model, the loads that hold, the angle of the shaft at which it begins."""

    model: Model
    loads: Actuation
    firing: float


class ShaftTorque(Curve):
    """The torque of the loads and guides of all sliders on the shaft.

    direction   in which the crank turns, which friction opposes; 0: as omega says
    """

    def __init__(self, pieces: Sequence[Piece], shaft: "ShaftModel", torque: Curve, direction: float) -> None:
        self.pieces, self.shaft, self.torque, self.direction = pieces, shaft, torque, direction
        self.depends_on_time = any(curve.depends_on_time for one in pieces for curve in one.loads)

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The loads, and what friction takes."""
        push = sum(
            one.loads.F_Y.at(t, theta - one.firing, omega) * one.model.slider(theta - one.firing)[2]
            for one in self.pieces
        )
        return push - self._taken(t, theta, omega, push) if self.shaft.rubs else push

    def _taken(self, t: Any, theta: Any, omega: Any, push: Any) -> Any:
        """The torque of friction; NaN where no signs of the normal forces agree, or no forces balance."""
        still = self.shaft.still(theta)
        push = push + self.torque.at(t, theta, omega) - still.weight - 0.5 * still.inertia_slope * omega**2
        guides = [self._guide(one, t, theta - one.firing, omega) for one in self.pieces if one.model.mu]
        normal, by_alpha, arm, wedge = (np.array(rows) for rows in zip(*guides, strict=True))
        alpha, pressed = push / still.inertia, np.zeros(normal.shape)
        with np.errstate(all="ignore"):
            for _ in range(2 * len(guides) + 2):
                before, pressed = pressed, np.copysign(1.0, normal + by_alpha * alpha)
                if (before == pressed).all():
                    break
                share = arm * pressed / (1.0 - wedge * pressed)
                inertia = still.inertia + (share * by_alpha).sum(0)
                alpha = (push - (share * normal).sum(0)) / inertia
            good = ((before == pressed) & (wedge * pressed < 1.0)).all(0) & (inertia > 0.0)
        return np.where(good, push - still.inertia * alpha, nan)

    def _guide(self, one: Piece, t: Any, theta: Any, omega: Any) -> tuple[Any, ...]:
        """Normal force without friction at alpha = 0, its slope by alpha, arm c and wedge k of a guide."""
        forces = (curve.at(t, theta, omega) for curve in one.loads[1:])
        normal, by_alpha, _, lean = one.model.contact(theta, omega, *map(np.asarray, forces))
        turning = self.direction or np.copysign(1.0, omega)
        travel = one.model.slider(theta)[2]
        arm = one.model.mu * np.abs(travel) * turning
        return np.broadcast_arrays(normal, by_alpha, arm, one.model.mu * lean * np.sign(travel) * turning)

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The torque and its derivatives, by differences under friction."""
        if self.shaft.rubs:
            value = self.at(t, theta, omega) if value is None else value
            size = float(np.max(np.abs(omega)))
            by_theta = difference(lambda x: self.at(t, x, omega), theta, 1.0, value)
            return Slopes(value, by_theta, difference(lambda x: self.at(t, theta, x), omega, size, value))
        total: list[Any] = [0.0, 0.0, 0.0]
        for model, loads, firing in self.pieces:
            force, still = loads.F_Y.slopes(t, theta - firing, omega), model.still(theta - firing)
            by_theta = force.theta * still.travel + force.value * still.bend
            parts = force.value * still.travel, by_theta, force.omega * still.travel
            total = [before + part for before, part in zip(total, parts, strict=True)]
        return Slopes(*total)

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """The pieces of all loads that hold from a state on."""
        state = omega, direction, growing
        pieces = [one._replace(loads=one.loads.ahead(theta - one.firing, *state)) for one in self.pieces]
        return ShaftTorque(pieces, self.shaft, self.torque.ahead(theta, *state), direction)

    def moves(self, theta: float) -> Mapping[str, float]:
        """By how much inputs, and phases, move a kink at an angle of the shaft."""
        return self.shaft.moves(theta)

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """The angles of the shaft at which pieces of a load meet, and friction turns round."""
        result = []
        for model, loads, firing in self.pieces:
            own = [kink for curve in loads for kink in curve.kinks(model.lengths, model.branch)]
            own += [(angle, TURN) for angle in model.dead_centres().values() if model.mu]
            result += [(angle + firing, period) for angle, period in own]
        return result


class ShaftModel(Model):
    """Several sliders on a crankshaft as a model of the motion, between the limit angles of all."""

    def __init__(
        self, sliders: SliderSums, theta0: float, torque: Curve, moves: Moves, deadline: Deadline
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
        self.drive = Actuation(torque, ConstantCurve(0.0), ShaftTorque(self.pieces, self, torque, 0.0))

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

    def still(self, theta: Any) -> Still:
        """Inertia and gravity's torque with their slopes; the travel is the crank angle."""
        each = [one.model.still(theta - one.firing) for one in self.pieces]
        inertia, steeper, weight, heavier, *_ = map(sum, zip(*each, strict=True))
        return Still(inertia + float(self.sliders.I_shaft), steeper, weight, heavier, 1.0, 0.0)

    def potential(self, theta: Any) -> Any:
        """The potential energy [J]."""
        return sum(one.model.potential(theta - one.firing) for one in self.pieces)

    def dead_centres(self) -> dict[str, float]:
        """There are none of the shaft."""
        return {}
