"""A design as functions of its state, by prepared functions of the package."""

from collections.abc import Mapping
from functools import lru_cache
from math import copysign, cos, isnan, nan, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.function import Function, function
from ..loads.load import OverY
from ..mechanism.closed import TURN
from ..mechanism.closed.dead_centres import DEAD_CENTRES
from ..mechanism.closed.functions import closed_form
from ..mechanism.names import CENTRES, LENGTHS
from ..mechanism.program import Variant
from ..runtime.kernels import STRUCTURAL_ZEROS
from .coordinate import Coordinate
from .drive import NOTHING, Acting, Actuation, Called, Slider, UserFunction
from .loops.compiled import NAMES, DesignFamily
from .loops.law import FORCE, POTENTIAL, SIDEWAYS, TORQUE
from .pieces import compiles

Array = NDArray[np.float64]

CONTACT = ("N_C", "N_C_wrt_alpha", "N_C_wrt_omega", "phi")
SLIDER = ("Y", "s", "Y_wrt_theta")


CHANGE_POINT = 1e-6  # of the crank: so nearly across the guide a limit angle has no derivative
KEPT = ("AB", "BC", *CENTRES)  # inputs that are passed where they are 0, too


@lru_cache(maxsize=256)
def _function(
    names: tuple[str, ...], inputs: tuple[str, ...], fixed: tuple[tuple[str, Any], ...]
) -> Function:
    return function(names, inputs=inputs, **dict(fixed))


class Model:
    """One design: its inputs and functions of its state, and what drives it."""

    def __init__(
        self, values: Mapping[str, float], branch: int, coordinate: Coordinate, drive: Actuation
    ) -> None:
        self.values, self.coordinate, self.drive = values, coordinate, drive
        self.mu, self.branch = values["mu"], branch
        loads = ("mu", "F_X", "F_Y")
        self._design = {n: v for n, v in values.items() if n not in loads and (v != 0.0 or n in KEPT)}
        self._calls: dict[tuple[str, ...], Function] = {}
        self.terms = self._terms()

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

    def family(self) -> DesignFamily | None:
        """The family of designs that share its kernels of the compiled loops."""
        return DesignFamily(form_of(self.values), fixed_zeros(self.values))

    def _terms(self) -> list[tuple[float, float, Any]]:
        """Torque and forces: which, factor, and what they are, called where loops do not know it."""
        slider = self.slider_of()
        each = ((TORQUE, self.drive.torque), (FORCE, self.drive.F_Y), (SIDEWAYS, self.drive.F_X))
        every = [(arm, factor, part) for arm, acting in each for factor, part in acting.terms]
        for _, _, part in every:
            if isinstance(part, OverY):
                slider.zero(part)  # or it has no such dead centre
        known = [isinstance(part, float) or compiles(part) for *_, part in every]
        return [
            (arm, factor, part if simple else Called(part, slider))
            for (arm, factor, part), simple in zip(every, known, strict=True)
            if part != 0.0
        ]

    def along(self, acting: Acting, t: Any, theta: Any, omega: Any) -> Any:
        """A force at every instant of a history; a number or a load as it is."""
        if not isinstance(acting.value, UserFunction):
            return acting.value
        return Called(acting.value, self.slider_of()).at(t, theta, omega)

    def quantities(self, theta: Any) -> tuple[Any, ...]:
        """The quantities that compiled loops take from their kernel, in its order."""
        return self._values(NAMES, theta=theta)

    def slider_of(self) -> Slider:
        """The slider, for loads that follow it."""
        return Slider(self.lengths, self.branch, self.slider)

    def slider(self, theta: Any) -> tuple[Any, Any, Any]:
        """Y, s and Y_wrt_theta at angles."""
        Y, s, slope = self._values(SLIDER, theta=theta)
        return Y, s, slope

    def contact(self, theta: Any, omega: Any, F_X: Any, F_Y: Any) -> tuple[Any, ...]:
        """The normal force without friction at alpha = 0, its slopes by alpha and omega, and phi."""
        return self._values(CONTACT, theta=theta, omega=omega, F_X=F_X, F_Y=F_Y)

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
        return self.quantities(theta)[0]

    def potential(self, theta: Any) -> Any:
        """The potential energy [J]."""
        return self.quantities(theta)[POTENTIAL]

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
