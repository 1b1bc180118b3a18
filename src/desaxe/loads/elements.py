"""`spring`, `damper`, `over_V`: forces on the slider by its position and its speed."""

from collections.abc import Callable
from typing import Any

from ..mechanism.inputs import Input
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import number_of
from ..mechanism.slips import warn_of_slips
from ..support.shown import shown
from .along_motion import Damper, Spring
from .columns import column_of
from .load import Load
from .made import table_over_V
from .maker import MAKING, Maker
from .units import force_unit, load_over

STIFFNESS = Input("stiffness", "N/m", "of a spring", 0.0, "a stiffness >= 0")
FREE = Input("free", "m", "position at which a spring is free", None, "a finite position")
LINEAR = Input("linear", "N*s/m", "of a damper", 0.0, "a coefficient >= 0")
QUADRATIC = Input("quadratic", "N*s^2/m^2", "of a damper", 0.0, "a coefficient >= 0")


class MakeSpring(Maker):
    """`spring(stiffness, free)`: a spring between slider and frame, F = -stiffness (Y - free).

        back = dx.spring("4 N/mm", free="120 mm")
        dx.drive(F_Y=back, ec=0.01, AB=0.04, BC=0.1, omega0=30)

    stiffness  [N/m], or a text with a unit
    free       the slider's position along Y at which the spring has no force [m], or a text with a unit

    `machine.spring` is the same in the units of a machine. Its numbers are parameters of `simulate(wrt=)` and
    of the gradients of `steady`: "F_Y.stiffness", "F_Y.free". Raises ValueError or TypeError for a bad value.
    """

    name = "spring"
    takes = "stiffness, free"

    def __call__(self, stiffness: Any, free: Any) -> Load:
        """A spring; see `help(desaxe.spring)`."""
        numbers = _number(STIFFNESS, stiffness, self.units), _number(FREE, free, self.units)
        warn_of_slips({"free": free}, self.units or SI, stacklevel=MAKING)
        return Spring(*numbers, ("value", "Y") if self.units is None and _plain(stiffness, free) else ())


class MakeDamper(Maker):
    """`damper(linear=0, quadratic=0)`: a damper between slider and frame.

        oil = dx.damper(linear="200 N s/m")
        air = dx.damper(quadratic=0.8)
        dx.drive(F_Y=oil + air, ec=0.01, AB=0.04, BC=0.1, omega0=30)

    linear     [N s/m], or a text with a unit: F = -linear V_C
    quadratic  [N s2/m2], or a text with a unit: F = -quadratic |V_C| V_C, the drag of a flow

    `machine.damper` is the same in the units of a machine. Its numbers are parameters of `simulate(wrt=)` and
    of the gradients of `steady`: "F_Y.linear", "F_Y.quadratic". Raises ValueError or TypeError for bad ones.
    """

    name = "damper"
    takes = "linear=0, quadratic=0"

    def __call__(self, linear: Any = 0.0, quadratic: Any = 0.0) -> Load:
        """A damper; see `help(desaxe.damper)`."""
        numbers = _number(LINEAR, linear, self.units), _number(QUADRATIC, quadratic, self.units)
        plain = _plain(*(x for x in (linear, quadratic) if shown(x) not in ("0", "0.0")))
        return Damper(*numbers, ("value", "V_C") if plain and self.units is None else ())


class MakeOverV(Maker):
    """`over_V(speeds, forces)`: a load over the slider's speed V_C, for F_X and F_Y.

        throttle = dx.over_V(["-2 m/s", "0 m/s", "2 m/s"], [900, 0, -400])
        drag = dx.over_V(lambda V: -0.8 * V * abs(V), derivative=lambda V: -1.6 * abs(V))

    speeds  ascending speeds [m/s], negative inward, or texts with units
    forces  the load at each of them [N], or texts with units
    kind    "linear", or "smooth": a curve without corners, which rises and falls only where the table does

    Beyond the speeds the values at the ends hold. `over_V(f, derivative=None)` makes one of a function of
    V_C: arrays in, arrays out, or numbers alone. `machine.over_V` is the same in the units of a machine.
    Raises ValueError or TypeError for a table that is no function of the speed.
    """

    name = "over_V"
    takes = "speeds, forces, kind='linear'"

    def __call__(
        self,
        speeds: Any,
        forces: Any = None,
        kind: str = "linear",
        *,
        derivative: Callable[[Any], Any] | None = None,
    ) -> Load:
        """A load over the slider's speed; see `help(desaxe.over_V)`."""
        if callable(speeds):
            return load_over("over_V", "V_C", (speeds, forces, derivative), self.units)
        if derivative is not None:
            raise TypeError("over_V: derivative= belongs to a function; a table has its own")
        if forces is None:
            raise TypeError("over_V: forces is missing: the load at each of the speeds")
        x = column_of("over_V: speeds", speeds, ("m/s",), self.unit("V_C"))
        return table_over_V(x, column_of("over_V: forces", forces, ("N",), force_unit(self.units)), kind)


def _number(row: Input, value: Any, units: UnitSystem | None) -> float:
    """A number in SI units, a plain one from these."""
    number = number_of(row, value)
    if number is None:
        raise TypeError(f"{row.name} = {shown(value)}: expected {row.limit}, a number or a text with a unit")
    if units is None or not _plain(value):
        return number
    force_unit(units)  # which is the same along both axes
    return float(units.of(f"F_Y.{row.name}").to_si(number))


def _plain(*values: Any) -> bool:
    """True if one of the values has no unit."""
    return any(not isinstance(value, str) and not hasattr(value, "magnitude") for value in values)


spring = MakeSpring()
damper = MakeDamper()
over_V = MakeOverV()
