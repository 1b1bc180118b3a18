"""Motors: torques over the speed of the crank, from a table or by Kloss's formula."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..mechanism.inputs import INPUTS, TINY, Input
from ..mechanism.messages import Message, amount, listed, named
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import in_si, read_array
from ..mechanism.slips import warn_of_slips
from ..support.computed import computed_once
from ..support.shown import shown
from .load import outside
from .made import ascending_table
from .maker import Maker
from .of_columns import MakeTable
from .table import Table

Array = NDArray[np.float64]
ROWS = (
    Input("breakdown_torque", "N*m", "", TINY, "a finite torque > 0"),
    Input("breakdown_slip", "1", "", TINY, "a finite slip > 0"),
    Input("synchronous_speed", "rad/s", "", None, "a finite speed, not 0"),
    Input("gear", "1", "", TINY, "a finite ratio > 0"),
)


class Motor(ABC):
    """A torque on the crank [N m], positive like theta, over the crank's speed [rad/s].

    knots   speeds at which pieces of a table meet
    plain   what was given as plain numbers, which a machine in other units could mean otherwise
    """

    call: ClassVar[str] = "over_omega"  # the call that makes it
    knots: tuple[float, ...] = ()
    plain: tuple[str, ...] = ()
    shown_in: UnitSystem | None = None  # of the machine that made it, in which it is called

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The parameters by which its torque has derivatives: numbers, or arrays of designs."""
        return {}

    @abstractmethod
    def both(self, omega: Any, row: Mapping[str, Any]) -> tuple[Any, Any]:
        """The torque and its derivative with respect to the speed, with these values of the parameters."""

    def by(self, omega: Any, row: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives of the torque by the parameters."""
        return {}

    @abstractmethod
    def speeds(self, row: Mapping[str, Any]) -> Array:
        """Speeds between which the torque has no turn that matters, the last far beyond all of them."""

    def __call__(self, omega: Any) -> Any:
        """The torque at a speed, in the units of the machine or scene that it was made for, else in SI."""
        torque = self.value(in_si(INPUTS["omega"], omega, self.shown_in))
        return (self.shown_in or SI).of("torque").shown(torque)

    def value(self, omega: Any) -> Any:
        """The torque at a speed [rad/s]: a number or an array."""
        torque = self.both(np.asarray(omega, float), self.numbers)[0]
        return float(torque) if np.ndim(torque) == 0 else torque

    def of_design(self, row: Mapping[str, float]) -> "Motor":
        """The motor of one design, of those that its parameters are arrays of."""
        return self

    def __repr__(self) -> str:
        return f"<{self._text().in_units(self.shown_in or SI)}>"

    @abstractmethod
    def _text(self) -> Message:
        """Return its kind and its numbers as text."""


@dataclass(frozen=True, repr=False)
class OverOmega(Motor):
    """A table over the speed, held beyond its ends."""

    table: Table
    kind: str
    plain: tuple[str, ...] = field(default=(), compare=False)

    @computed_once
    def knots(self) -> tuple[float, ...]:
        """The speeds of the table."""
        return self.table.knots

    def both(self, omega: Any, row: Mapping[str, Any]) -> tuple[Any, Any]:
        """The torque and its derivative with respect to the speed."""
        value, slope = self.table.both(np.asarray(omega))
        return value, slope

    def speeds(self, row: Mapping[str, Any]) -> Array:
        """The speeds of the table and some between them."""
        first, last = min(self.knots), max(self.knots)
        most = max(abs(first), abs(last))
        between = np.interp(np.arange(0.0, len(self.knots) - 0.9, 0.25), range(len(self.knots)), self.knots)
        return np.concatenate([between, most * np.linspace(-3.0, 3.0, 49)])

    def _text(self) -> Message:
        low, high = (amount("torque", end(self.table.values), "g", says_unit=True) for end in (min, max))
        return f"motor over omega: {len(self.knots)} speeds, {self.kind}, " + low + " to " + high


@dataclass(frozen=True, repr=False)
class Kloss(Motor):
    """An induction motor by Kloss's formula, behind a gear."""

    breakdown_torque: Any
    breakdown_slip: Any
    synchronous_speed: Any
    gear: Any = 1.0
    plain: tuple[str, ...] = field(default=(), compare=False)
    call: ClassVar[str] = "kloss"
    SLIPS: ClassVar[Array] = np.geomspace(0.05, 20.0, 7)  # over the breakdown slip

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The four parameters."""
        return {row.name: getattr(self, row.name) for row in ROWS}

    def of_design(self, row: Mapping[str, float]) -> Motor:
        """The motor with these numbers."""
        return replace(self, **dict[str, Any](row))

    def both(self, omega: Any, row: Mapping[str, Any]) -> tuple[Any, Any]:
        """The torque and its derivative with respect to the speed."""
        _, slip, speed, gear = (row[r.name] for r in ROWS)
        torque, bend = self._at(omega, row)
        return torque, bend * (-gear / (speed * slip))

    def by(self, omega: Any, row: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives of the torque by the four parameters."""
        most, slip, speed, gear = (row[r.name] for r in ROWS)
        torque, bend = self._at(omega, row)
        return {
            "breakdown_torque": torque / most,
            "breakdown_slip": -bend * (1.0 - gear * omega / speed) / (slip * slip),
            "synchronous_speed": bend * gear * omega / (speed * speed * slip),
            "gear": torque / gear - bend * omega / (speed * slip),
        }

    def _at(self, omega: Any, row: Mapping[str, Any]) -> tuple[Any, Any]:
        """The torque, and its derivative with respect to the slip over that of breakdown."""
        most, slip, speed, gear = (row[r.name] for r in ROWS)
        u, top = (1.0 - gear * omega / speed) / slip, gear * np.copysign(most, speed)
        square = u * u
        return top * 2.0 * u / (1.0 + square), top * 2.0 * (1.0 - square) / (1.0 + square) ** 2

    def speeds(self, row: Mapping[str, Any]) -> Array:
        """From standstill beyond the synchronous speed, close together around the breakdown slips."""
        _, slip, speed, gear = (np.asarray(row[r.name], float)[..., None] for r in ROWS)
        near = np.concatenate([self.SLIPS, -self.SLIPS])
        far = np.concatenate([1.0 - np.geomspace(1e-3, 0.1, 3), np.linspace(0.9, -3.0, 14)])
        slips = np.concatenate([slip * near, slip * 0.0 + far], axis=-1)
        result: Array = (1.0 - np.clip(slips, -3.0, 1.0)) * speed / gear
        return result

    def _text(self) -> Message:
        return "induction motor: " + listed([named(name, value) for name, value in self.numbers.items()])


class MakeOverOmega(MakeTable):
    """`over_omega(speeds, torques, kind="linear")`: a motor from a table, wherever a torque is given.

        motor = dx.over_omega(["0 rpm", "600 rpm", "1000 rpm"], [30, 45, 0])
        dx.steady(torque=motor, ec=0.01, AB=0.04, BC=0.15, m_slider=2, I_crank=0.1)

    speeds   ascending speeds of the crank [rad/s], or texts with units; the torque at the first and last
             holds beyond them
    torques  on the crank [N m], positive like theta, or texts with units
    kind     "linear", or "smooth": a curve without corners, which rises and falls only where the table does

    `machine.over_omega` is the same in the units of a machine. Raises ValueError or TypeError for a table
    that is no function of the speed. `over_omega.read("motor.csv", omega="rpm", torque="N m")` reads a table
    from the first two columns of a file.
    """

    name = "over_omega"
    takes = "speeds, torques, kind='linear'"
    places, ways, over, si, values = "speeds", ("torques",), "omega", "rad/s", ("N*m",)

    def __call__(self, speeds: Any, torques: Any, kind: str = "linear") -> Motor:
        """A motor from a table; see `help(desaxe.over_omega)`."""
        x, y = self.columns(speeds, torques)
        table = ascending_table("over_omega", "omega", x, y, kind)
        return OverOmega(table, kind, ("omega",) * x.plain + ("torque",) * y.plain)

    def read(
        self,
        path: Any,
        omega: str | None = None,
        torque: str | None = None,
        kind: str = "linear",
    ) -> Motor:
        """A motor from the first two columns of a file or a frame: speeds of the crank and torques.

        omega, torque   units of the columns, such as "rpm" and "N m"; without, those of the heading, such as
                        "speed [rpm], torque [N m]", else SI units
        kind            as in `over_omega`; the form of the file is that of `over_theta.read`
        """
        motor: Motor = self.from_file(path, {"omega": omega, "torque": torque}, kind=kind)
        return motor


class MakeKloss(Maker):
    """`kloss(breakdown_torque, breakdown_slip, synchronous_speed, gear=1)`: an induction motor.

        motor = dx.kloss("40 N m", 0.15, "1500 rpm", gear=12)
        dx.steady(torque=motor, ec=0.01, AB=0.04, BC=0.15, m_slider=2, I_crank=0.1)

    breakdown_torque   the motor's largest torque T_b [N m]
    breakdown_slip     the slip s_b at which it is reached
    synchronous_speed  of the motor [rad/s]; negative for one that turns backwards
    gear               turns of the motor for one of the crank: the crank has gear times the motor's torque

    T = 2 T_b s s_b/(s^2 + s_b^2) with the slip s = 1 - gear omega/synchronous_speed. Each is a number, or an
    array for an array of designs. `machine.kloss` is the same in the units of a machine.
    """

    name = "kloss"
    takes = "breakdown_torque, breakdown_slip, synchronous_speed, gear=1"

    def __call__(
        self, breakdown_torque: Any, breakdown_slip: Any, synchronous_speed: Any, gear: Any = 1.0
    ) -> Motor:
        """An induction motor; see `help(desaxe.kloss)`."""
        written = dict(zip(ROWS, (breakdown_torque, breakdown_slip, synchronous_speed, gear), strict=True))
        by_name = {row.name: value for row, value in written.items()}
        warn_of_slips(by_name, self.units or SI, stacklevel=outside() + 1)
        most, slip, speed, ratio = (_numbers(row, value, self.units) for row, value in written.items())
        kinds = {"N*m": "torque", "rad/s": "omega"}
        plain = [kinds[row.unit] for row, value in written.items() if row.unit in kinds and _is_plain(value)]
        return Kloss(most, slip, speed, ratio, () if self.units else tuple(plain))


def _numbers(row: Input, value: Any, units: UnitSystem | None) -> Any:
    """A number, or an array of numbers, within the limit of its row."""
    try:
        array = read_array(row, value, units)
    except TypeError:
        raise TypeError(
            f"{row.name} = {shown(value)}: kloss expects a number or an array of numbers"
        ) from None
    wrong = ~np.isfinite(array) | (array == 0.0 if row.least is None else array < row.least)
    if wrong.any():
        raise ValueError(named(row.name, array[wrong].item(0)) + f": it must be {row.limit}")
    return array if array.ndim else array.item()


def _is_plain(value: Any) -> bool:
    """True for numbers without a unit of their own."""
    if hasattr(value, "magnitude") or "units" in getattr(value, "attrs", {}):
        return False
    return np.asarray(value).dtype.kind != "U"


over_omega = MakeOverOmega()
kloss = MakeKloss()
