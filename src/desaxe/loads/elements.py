"""`spring`, `damper`, `over_V`: forces on the slider by its position and its speed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from ..mechanism.inputs import Input
from ..mechanism.quantity_units import SI
from ..mechanism.read import read
from ..mechanism.slips import warn_of_slips
from ..support.computed import computed_once
from ..support.shown import with_unit
from .along_motion import OverColumn
from .load import Load, outside
from .made import table_over_V
from .maker import Maker
from .of_columns import MakeTable
from .table import Table
from .units import force_unit, load_over

STIFFNESS = Input("stiffness", "N/m", "of a spring", 0.0, "a stiffness >= 0")
FREE = Input("free", "m", "position at which a spring is free", None, "a finite position")
LINEAR = Input("linear", "N*s/m", "of a damper", 0.0, "a coefficient >= 0")
QUADRATIC = Input("quadratic", "N*s^2/m^2", "of a damper", 0.0, "a coefficient >= 0")


class Element(OverColumn):
    """A load by its numbers, whose table of two pieces follows from these."""

    unit = "N"
    call: ClassVar[str]
    names: ClassVar[tuple[str, ...]]

    @computed_once
    def numbers(self) -> Mapping[str, float]:
        """The numbers by which a motion has derivatives."""
        return {name: getattr(self, name) for name in self.names}

    def told(self, conversion: Any = None) -> str:
        """The numbers in a line."""
        units = {name: (self.shown_in or SI).of(f"F_Y.{name}") for name in self.names}
        texts = (
            f"{n} = " + with_unit(f"{units[n].shown(x):g}", units[n].unit) for n, x in self.numbers.items()
        )
        return f"<{self.call}: {', '.join(texts)}>"


@dataclass(frozen=True, repr=False)
class Spring(Element):
    """A spring between slider and frame: F = -stiffness (Y - free)."""

    stiffness: float
    free: float
    plain: tuple[str, ...] = field(default=(), compare=False)

    call = "spring"
    needs = ("Y",)
    names = ("stiffness", "free")

    @computed_once
    def table(self) -> Table:
        """A line through the free position."""
        row = 0.0, -self.stiffness, 0.0, 0.0
        return Table((self.free,), (row, row))

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives with respect to stiffness and free position."""
        stretch = now["Y"] - self.free
        return {"stiffness": -stretch, "free": 0.0 * stretch + self.stiffness}


@dataclass(frozen=True, repr=False)
class Damper(Element):
    """A damper between slider and frame: F = -linear V_C - quadratic |V_C| V_C."""

    linear: float
    quadratic: float
    plain: tuple[str, ...] = field(default=(), compare=False)

    call = "damper"
    needs = ("V_C",)
    names = ("linear", "quadratic")

    @computed_once
    def table(self) -> Table:
        """Parabolas that meet at rest."""
        return Table((0.0,), tuple((0.0, -self.linear, side * self.quadratic, 0.0) for side in (1.0, -1.0)))

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives with respect to both coefficients."""
        V = now["V_C"]
        return {"linear": -V, "quadratic": -abs(V) * V}


class MakeElement(Maker):
    """A maker of loads by their numbers."""

    place: ClassVar[str]

    def numbers(self, written: Mapping[Input, Any]) -> tuple[Any, ...]:
        """Numbers in SI units, plain ones from those of a machine, and what of them is plain."""
        units, numbers, plain = self.units or SI, [], False
        force_unit(units)  # which is the same along both axes
        for row, value in written.items():
            number = read(row, value, self.name, f"{row.limit}, a number or a text with a unit")
            if not isinstance(value, str) and not hasattr(value, "magnitude"):
                number, plain = float(units.of(f"F_Y.{row.name}").to_si(number)), plain or number != 0.0
            numbers.append(number)
        return *numbers, ("value", self.place) if plain and self.units is None else ()


class MakeSpring(MakeElement):
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
    place = "Y"

    def __call__(self, stiffness: Any, free: Any) -> Load:
        """A spring; see `help(desaxe.spring)`."""
        warn_of_slips({"free": free}, self.units or SI, stacklevel=outside() + 1)
        return Spring(*self.numbers({STIFFNESS: stiffness, FREE: free}))


class MakeDamper(MakeElement):
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
    place = "V_C"

    def __call__(self, linear: Any = 0.0, quadratic: Any = 0.0) -> Load:
        """A damper; see `help(desaxe.damper)`."""
        return Damper(*self.numbers({LINEAR: linear, QUADRATIC: quadratic}))


class MakeOverV(MakeTable):
    """`over_V(speeds, forces)`: a load over the slider's speed V_C, for F_X and F_Y.

        throttle = dx.over_V(["-2 m/s", "0 m/s", "2 m/s"], [900, 0, -400])
        drag = dx.over_V(lambda V: -0.8 * V * abs(V), derivative=lambda V: -1.6 * abs(V))

    speeds  ascending speeds [m/s], negative inward, or texts with units
    forces  the load at each of them [N], or texts with units
    kind    "linear", or "smooth": a curve without corners, which rises and falls only where the table does

    Beyond the speeds the values at the ends hold. `over_V(f, derivative=None)` makes one of a function of
    V_C: arrays in, arrays out, or numbers alone. With `area=` or `bore=` the values are pressures, as in
    `over_theta`. `machine.over_V` is the same in the units of a machine.
    Raises ValueError or TypeError for a table that is no function of the speed.
    """

    name = "over_V"
    takes = "speeds, forces, kind='linear'"
    places, ways, over, si = "speeds", ("forces",), "V_C", "m/s"

    def __call__(
        self,
        speeds: Any,
        forces: Any = None,
        kind: str = "linear",
        *,
        derivative: Callable[[Any], Any] | None = None,
        area: Any = None,
        bore: Any = None,
        ambient: Any = None,
    ) -> Load:
        """A load over the slider's speed; see `help(desaxe.over_V)`."""
        piston = self.piston(area, bore, ambient)
        if callable(speeds) or derivative is not None:
            return load_over("over_V", "V_C", (speeds, forces, derivative), self.units, piston)
        return table_over_V(*self.columns(speeds, forces, piston=piston), kind=kind)


spring = MakeSpring()
damper = MakeDamper()
over_V = MakeOverV()
