"""A design as plain functions of its state, cut from the generated Program."""

from collections.abc import Callable, Mapping, Sequence
from math import isnan
from typing import Any, NamedTuple

from ..mechanism.closed import TURN
from ..mechanism.closed.dead_centres import DEAD_CENTRES
from ..mechanism.closed.functions import closed_form
from ..mechanism.names import CENTRES, LENGTHS
from ..mechanism.program import Variant
from ..runtime.kernels import STRUCTURAL_ZEROS
from ..runtime.point import PointFunction, point_of
from .coordinate import Coordinate
from .held import Held, UserLoad

Values = tuple[float, ...]
Function = Callable[..., Values]
Load = Callable[[float, float, float], float]

# Held still, T_in is the torque of gravity alone: loads on the slider are added by hand, for they may vary.
STILL = ("M_eff", "T_in", "Y_wrt_theta")
MOVING = ("M_eff", "M_eff_wrt_theta", "T_in", "Y_wrt_theta")
CONTACT = ("N_C", "N_C_wrt_alpha", "lean")
UNLOADED = ("omega", "alpha", "mu", "F_X", "F_Y")


class Actuation(NamedTuple):
    """The torque [N m] and the forces on the slider [N] that drive the mechanism."""

    torque: Load
    F_X: Load
    F_Y: Load
    steady: bool  # whether all three are numbers
    held: tuple[Held, ...] = ()  # those of them that vary with the motion


def _gone(t: float, theta: float, omega: float) -> float:
    raise RuntimeError("a pickled motion knows its angles and speeds, not the torque that drove it")


class Model:
    """One design: its inputs, functions and drive."""

    def __init__(
        self, values: Mapping[str, float], branch: int, coordinate: Coordinate, drive: Actuation
    ) -> None:
        self.values, self.coordinate, self.drive = values, coordinate, drive
        self.mu = values["mu"]
        self.sign = float(branch)
        fixed = fixed_zeros(values) if coordinate.half else (("branch", self.sign), *fixed_zeros(values))
        form = form_of(values)

        def function(names: Sequence[str], free: Sequence[str], *zeros: str) -> Function:
            lines = dict(fixed) | dict.fromkeys(zeros, 0.0)
            return bound(point_of(tuple(names), form, tuple(lines.items())), values, free)

        self.still = function(STILL, ("theta", "branch"), *UNLOADED)
        self.moving = function(MOVING, ("theta", "branch"), *UNLOADED)
        self.contact = function(CONTACT, ("theta", "branch", "omega", "F_X", "F_Y"), "alpha", "mu")
        self.energies = function(("kinetic_energy", "potential_energy"), ("theta", "branch", "omega"))
        position = function(("Y", "Y_wrt_theta"), ("theta", "branch"))
        for held in drive.held:
            held.stand(lambda theta: position(theta, self.sign), self.lengths, branch)
        following = [load for load in drive[:3] if isinstance(load, UserLoad) and load.follows_the_slider]
        if following:
            slider = function(("Y", "s", "Y_wrt_theta"), ("theta", "branch"))
            for load in following:
                load.stand(lambda theta: slider(theta, self.sign))

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickle has the design but not what drives it, which may be any function."""
        return Model, (self.values, int(self.sign), self.coordinate, Actuation(_gone, _gone, _gone, False))

    @property
    def lengths(self) -> tuple[float, ...]:
        """Eccentricity, crank and rod [m]."""
        return tuple(self.values[name] for name in LENGTHS)

    def inertia(self, theta: float) -> float:
        """The effective moment of inertia [kg m^2] on the branch of the start."""
        return self.still(theta, self.sign)[0]

    def kinetic_and_potential(self, theta: float, branch: float, omega: float) -> tuple[float, float]:
        """Both energies [J], from the generated quantities."""
        kinetic, potential = self.energies(theta, branch, omega)
        return kinetic, potential

    def dead_centres(self) -> dict[str, float]:
        """The crank angles at which the slider turns round, by name: rod and crank in line."""
        ec, AB, BC = self.lengths
        angles = closed_form(DEAD_CENTRES, ("theta_outer", "theta_inner"), branch=self.sign).point(ec, AB, BC)
        there = {"outer": AB > 0.0, "inner": AB > 0.0 and AB != BC}
        found = zip(there, angles, strict=True)
        return {which: angle for which, angle in found if there[which] and not isnan(angle)}

    def vanishing(self) -> dict[str, float]:
        """The dead centres at which no inertia is left, because nothing that turns with the crank has any."""
        angles = [TURN * k / 16 for k in range(16)]
        inertias = [m for m in map(self.inertia, angles) if not isnan(m)]
        least = 1e-12 * max(inertias, default=0.0)
        return {which: angle for which, angle in self.dead_centres().items() if self.inertia(angle) <= least}


def form_of(values: Mapping[str, Any]) -> Variant:
    """The form of the program: a given state; centres of mass that are not given are halfway."""
    return Variant(True, tuple(name for name in CENTRES if name not in values))


def fixed_zeros(values: Mapping[str, Any]) -> tuple[tuple[str, float], ...]:
    """Inputs that are 0 in a design; their terms vanish from the program."""
    return tuple(
        (name, 0.0) for name in STRUCTURAL_ZEROS if isinstance(z := values.get(name), float) and z == 0.0
    )


def bound(point: PointFunction, values: Mapping[str, float], free: Sequence[str]) -> Function:
    """The point function with a design put in; what is left are the `free` inputs, in their order."""
    row = [values.get(name, 0.0) for name in point.inputs]
    places = [(point.inputs.index(name), at) for at, name in enumerate(free) if name in point.inputs]
    function = point.function

    def call(*now: float) -> Values:
        arguments = row.copy()
        for place, at in places:
            arguments[place] = now[at]
        return function(*arguments)

    return call
