"""A design as functions of its state, by prepared functions of the package."""

from collections.abc import Mapping
from functools import lru_cache
from math import copysign, cos, isnan, nan, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.function import Function, function
from ..mechanism.closed import TURN
from ..mechanism.closed.dead_centres import DEAD_CENTRES
from ..mechanism.closed.functions import closed_form
from ..mechanism.names import CENTRES, LENGTHS
from ..mechanism.program import Variant
from ..runtime.kernels import STRUCTURAL_ZEROS
from .coordinate import Coordinate
from .drive import ConstantCurve, Curve, SliderDesign
from .loops.compiled import DesignFamily

Array = NDArray[np.float64]

# Held still, T_in is the torque of gravity alone: loads on the slider are added by hand, for they may vary.
STILL = ("M_eff", "M_eff_wrt_theta", "T_in", "T_in_wrt_theta", "Y_wrt_theta", "Y_wrt_theta_theta")
CONTACT = ("N_C", "N_C_wrt_alpha", "N_C_wrt_omega", "phi")
SLIDER = ("Y", "s", "Y_wrt_theta")


class Still(NamedTuple):
    """Functions of the angle alone: M_eff, the torque of gravity and Y', each with its slope."""

    inertia: Any
    inertia_slope: Any
    weight: Any
    weight_slope: Any
    travel: Any
    bend: Any


class Actuation(NamedTuple):
    """The torque [N m] and the forces on the slider [N] that drive the mechanism."""

    torque: Curve
    F_X: Curve
    F_Y: Curve

    @property
    def steady(self) -> bool:
        """True where all three are numbers."""
        return all(isinstance(curve, ConstantCurve) for curve in self)

    @property
    def knots(self) -> tuple[float, ...]:
        """Speeds at which pieces meet."""
        return self.torque.knots

    def ahead(self, theta: float, omega: float, direction: float, growing: float = 1.0) -> "Actuation":
        """The pieces that hold from a state on: for this way of turning, and this sign of domega/dt."""
        return Actuation(*(curve.ahead(theta, omega, direction, growing) for curve in self))


CHANGE_POINT = 1e-6  # of the crank: so nearly across the guide a limit angle has no derivative
KEPT = ("AB", "BC", *CENTRES)  # inputs that are passed where they are 0, too
NOTHING = Actuation(ConstantCurve(0.0), ConstantCurve(0.0), ConstantCurve(0.0))


@lru_cache(maxsize=256)
def _function(
    names: tuple[str, ...], inputs: tuple[str, ...], fixed: tuple[tuple[str, Any], ...]
) -> Function:
    return function(names, inputs=inputs, **dict(fixed))


class Model(SliderDesign):
    """One design: its inputs and functions of its state, and what drives it."""

    def __init__(
        self, values: Mapping[str, float], branch: int, coordinate: Coordinate, drive: Actuation
    ) -> None:
        self.values, self.coordinate, self.drive = values, coordinate, drive
        self.mu, self.branch = values["mu"], branch
        loads = ("mu", "F_X", "F_Y")
        self._design = {n: v for n, v in values.items() if n not in loads and (v != 0.0 or n in KEPT)}
        self._calls: dict[tuple[str, ...], Function] = {}
        for curve in drive:
            curve.stand(self, self.lengths, branch)

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickle has the design but not what drives it, which may be any function."""
        return Model, (self.values, self.branch, self.coordinate, NOTHING)

    def _values(self, names: tuple[str, ...], **state: Any) -> tuple[Any, ...]:
        """Quantities of the design at states; what is not in `state` is 0."""
        call = self._calls.get(names)
        if call is None:
            fixed = {n: 0.0 for n in ("omega", "alpha") if n not in state} | {"branch": self.branch}
            if "ec" not in self._design:
                fixed["ec"] = 0.0
            call = self._calls[names] = _function(names, (*state, *self._design), tuple(fixed.items()))
        result: tuple[Any, ...] = call(*state.values(), *self._design.values())
        return result

    def family(self) -> DesignFamily:
        """The family of designs that share its kernels of the compiled loops."""
        return DesignFamily(form_of(self.values), fixed_zeros(self.values))

    def still(self, theta: Any) -> Still:
        """Inertia, gravity's torque and Y' at angles, with their slopes."""
        return Still(*self._values(STILL, theta=theta))

    def slider(self, theta: Any) -> tuple[Any, Any, Any]:
        """Y, s and Y_wrt_theta at angles."""
        Y, s, slope = self._values(SLIDER, theta=theta)
        return Y, s, slope

    def contact(self, theta: Any, omega: Any, F_X: Any, F_Y: Any) -> tuple[Any, Any, Any, Any]:
        """The normal force without friction at alpha = 0, its slopes by alpha and omega, branch tan(phi)."""
        result = self._values(CONTACT, theta=theta, omega=omega, F_X=F_X, F_Y=F_Y)
        return result[0], result[1], result[2], self.branch * np.tan(result[3])

    @property
    def lengths(self) -> tuple[float, ...]:
        """Eccentricity, crank and rod [m]."""
        return tuple(self.values[name] for name in LENGTHS)

    @property
    def friction(self) -> float | None:
        """The coefficient of friction; None where sliders have their own."""
        return self.mu

    def limit(self, theta: float) -> dict[str, float]:
        """The shift of a limit angle, at which ec + AB sin(theta) = BC or -BC; NaN at a change point."""
        ec, AB, _ = self.lengths
        side, arm = copysign(1.0, ec + AB * sin(theta)), AB * cos(theta)
        if abs(arm) <= CHANGE_POINT * AB:
            return dict.fromkeys(LENGTHS, nan)
        return {"ec": -1.0 / arm, "AB": -sin(theta) / arm, "BC": side / arm}

    def inertia(self, theta: Any) -> Any:
        """The effective moment of inertia [kg m^2]."""
        return self.still(theta).inertia

    def potential(self, theta: Any) -> Any:
        """The potential energy [J]."""
        return self._values(("potential_energy",), theta=theta)[0]

    def dead_centres(self) -> dict[str, float]:
        """The crank angles at which the slider turns round, by name: rod and crank in line."""
        ec, AB, BC = self.lengths
        form = closed_form(DEAD_CENTRES, ("theta_outer", "theta_inner"), branch=float(self.branch))
        there = {"outer": AB > 0.0, "inner": AB > 0.0 and AB != BC}
        angles = zip(there, form.point(ec, AB, BC), strict=True)
        return {which: angle for which, angle in angles if there[which] and not isnan(angle)}

    def vanishing(self) -> dict[str, float]:
        """The dead centres at which no inertia is left, because nothing that turns with the crank has any."""
        inertias = self.inertia(TURN * np.arange(16) / 16)
        least = 1e-12 * float(np.nanmax(inertias, initial=0.0))
        return {which: angle for which, angle in self.dead_centres().items() if self.inertia(angle) <= least}


def form_of(values: Mapping[str, Any]) -> Variant:
    """The form of the program: a given state; centres of mass that are not given are halfway."""
    return Variant(True, tuple(name for name in CENTRES if name not in values))


def fixed_zeros(values: Mapping[str, Any]) -> tuple[tuple[str, float], ...]:
    """Inputs that are 0 in a design; their terms vanish from the program."""
    return tuple(
        (name, 0.0) for name in STRUCTURAL_ZEROS if isinstance(z := values.get(name), float) and z == 0.0
    )
