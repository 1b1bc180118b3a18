"""The equation of motion of a crankshaft: inertia, gravity's torque and that of the loads are sums.

The loads of all sliders are one torque, F_Y dY/dtheta summed, in the law's place for the force of a slider
whose travel is the crank angle itself.
"""

from collections.abc import Callable, Mapping, Sequence
from math import nan
from typing import Any

from ..simulation.checks import design_values, drive_of
from ..simulation.coordinate import FREE
from ..simulation.drive import ConstantCurve, Curve, Slopes
from ..simulation.model import NOTHING, Actuation, Model, Still
from ..support.deadline import Deadline
from .sums import SliderSums

Moves = Callable[[float], Mapping[str, float]]


class LoadTorque(Curve):
    """The torque of the loads of all sliders on the shaft."""

    def __init__(self, models: Sequence[Model], curves: Sequence[Curve], firing: Any, moves: Moves) -> None:
        self.models, self.curves, self.firing, self.of_kinks = models, curves, firing, moves
        self.depends_on_time = any(curve.depends_on_time for curve in curves)

    def at(self, t: Any, theta: Any, omega: Any) -> Any:
        """The sum of force times travel."""
        rows = zip(self.models, self.curves, self.firing, strict=True)
        return sum(curve.at(t, theta - f, omega) * model.slider(theta - f)[2] for model, curve, f in rows)

    def slopes(self, t: Any, theta: Any, omega: Any, value: Any = None) -> Slopes:
        """The sum and its derivatives."""
        total: list[Any] = [0.0, 0.0, 0.0]
        for model, curve, f in zip(self.models, self.curves, self.firing, strict=True):
            force, still = curve.slopes(t, theta - f, omega), model.still(theta - f)
            by_theta = force.theta * still.travel + force.value * still.bend
            parts = force.value * still.travel, by_theta, force.omega * still.travel
            total = [before + part for before, part in zip(total, parts, strict=True)]
        return Slopes(*total)

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> Curve:
        """The pieces of all loads that hold from a state on."""
        rows = zip(self.curves, self.firing, strict=True)
        pieces = [curve.ahead(theta - f, omega, direction, growing) for curve, f in rows]
        return LoadTorque(self.models, pieces, self.firing, self.of_kinks)

    def moves(self, theta: float) -> Mapping[str, float]:
        """By how much inputs, and phases, move a kink at an angle of the shaft."""
        return self.of_kinks(theta)

    def kinks(self, lengths: tuple[float, ...], branch: int) -> list[tuple[float, float]]:
        """The angles of the shaft at which pieces of a load meet."""
        rows = zip(self.models, self.curves, self.firing, strict=True)
        return [
            (angle + f, period)
            for model, curve, f in rows
            for angle, period in curve.kinks(model.lengths, model.branch)
        ]


class ShaftModel(Model):
    """Several sliders on a crankshaft that turns fully, without friction, as a model of the motion."""

    def __init__(self, sliders: SliderSums, torque: Curve, moves: Moves, deadline: Deadline) -> None:
        self.sliders, self.coordinate, self.mu, self.branch = sliders, FREE, 0.0, 1
        self.values = {"AB": 1.0}  # of the travel
        self.firing = [float(member.firing) for member in sliders.members]
        self.models = []
        for inputs in sliders.inputs_of_each():
            drive = drive_of(0.0, inputs.get("F_X"), inputs.get("F_Y"), deadline)
            self.models.append(Model(design_values(inputs), inputs.get("branch", 1), FREE, drive))
        loads = LoadTorque(self.models, [model.drive.F_Y for model in self.models], self.firing, moves)
        self.drive = Actuation(torque, ConstantCurve(0.0), loads)

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickle has the sliders but not what drives them, which may be any function."""
        return ShaftModel, (self.sliders, NOTHING.torque, dict, Deadline("simulate", None))

    @property
    def lengths(self) -> tuple[float, ...]:
        """There are none of the shaft."""
        return (nan, nan, nan)

    def still(self, theta: Any) -> Still:
        """Inertia and gravity's torque with their slopes; the travel is the crank angle."""
        each = [model.still(theta - f) for model, f in zip(self.models, self.firing, strict=True)]
        inertia, steeper, weight, heavier, *_ = map(sum, zip(*each, strict=True))
        return Still(inertia + float(self.sliders.I_shaft), steeper, weight, heavier, 1.0, 0.0)

    def potential(self, theta: Any) -> Any:
        """The potential energy [J]."""
        return sum(model.potential(theta - f) for model, f in zip(self.models, self.firing, strict=True))

    def dead_centres(self) -> dict[str, float]:
        """There are none of the shaft."""
        return {}
