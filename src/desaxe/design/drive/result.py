"""The result of `drive`: a dict with a report and a plot."""

from collections.abc import Mapping
from math import degrees, isnan, pi
from typing import TYPE_CHECKING, Any

from ...loads.load import Load
from ...loads.words import brief
from ...mechanism.quantity_units import SI, UnitSystem, units_by_name
from ...mechanism.status import DriveStatus
from ...support.answer import Answer
from ...support.forks import IMPORTS
from ...support.shown import printed, with_unit
from ...units.system import Conversion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...evaluation.in_units import Shown


class Drive(Answer):
    """The figures by name, `gradient` and `status`; `report()`, `plot()`.

    `inputs` are those of the design in SI units, varying loads included, `branch` is its branch; its loads
    repeat after `turns`. `course` has arrays over these: `theta`, `T_in`, `power_in` and, with the flywheel,
    `theta_of_speed` and `speed`.
    `system` is the unit system of all but `inputs`.
    """

    codes = DriveStatus

    def __init__(
        self,
        figures: Mapping[str, Any],
        inputs: Mapping[str, Any],
        branch: int,
        course: "Mapping[str, NDArray[Any]]",
        turns: int = 1,
    ) -> None:
        super().__init__(figures, _units)
        self.inputs, self.branch, self.course, self.turns = dict(inputs), branch, dict(course), turns

    def convert_rest(self, shown: "Shown") -> None:
        """The course over the turn in other units."""
        self.course = {
            name: _conversion(shown.system, name).shown(values) for name, values in self.course.items()
        }

    def report(self) -> str:
        """The figures as text for a data sheet; angles in radians are shown in degrees."""
        if not self.units:  # pint quantities say their units themselves
            return super().__repr__()
        lines = [
            f"Drive over {'one turn' if self.turns == 1 else f'{self.turns} turns'}",
            f"  {', '.join(self.design())}",
        ]
        if self["status"]:
            lines.append(f"  status {self['status']}: {DriveStatus(self['status']).words}")
        if not isnan(self["torque_mean"]):
            lines += [f"  {label:17} {value}" for label, value in self.rows()]
        return "\n".join(lines)

    @property
    def _system(self) -> UnitSystem:
        return self.system or SI

    @property
    def whole_turn(self) -> float:
        """A turn in the unit of its angles."""
        return float(self._system.of_unit("rad").shown(2.0 * pi))

    def design(self) -> list[str]:
        """The inputs with their units, loads in a few words."""
        message = []
        for name, value in self.inputs.items():
            if name == "sliders":
                message.append(str(value))
                continue
            conversion = self._system.of(name)
            if isinstance(value, Load):
                message.append(f"{name} {brief(value, name, self._system)}")
                continue
            message.append(with_unit(f"{name} = {conversion.shown(value):.6g}", conversion.unit))
        return message

    def unit(self, name: str) -> str:
        """The unit of a figure or of an array of `course`, as a label has it."""
        return printed(_conversion(self._system, name).unit)

    def rows(self) -> list[tuple[str, str]]:
        """The figures as text, each with its name."""

        def figure(name: str, angle: str | None = None) -> str:
            where = "" if angle is None or isnan(self[angle]) else f" at {self._angle(angle)}"
            scale = abs(self[f"{name.partition('_')[0]}_peak"]) if name.endswith("_mean") else 0.0
            value = 0.0 if abs(self[name]) < ROUNDING * scale else self[name]
            return "-" if isnan(value) else f"{value:.6g} {self.unit(name)}{where}"

        cycle = "a turn" if self.turns == 1 else f"in {self.turns} turns"
        speed = 60.0 * self.turns / _conversion(self._system, "period").to_si(self["period"])
        return [
            ("speed", f"{speed:.6g} rpm, {figure('period')} {cycle}"),
            ("torque, mean", figure("torque_mean")),
            ("torque, rms", figure("torque_rms")),
            ("torque, peak", figure("torque_peak", "theta_peak")),
            ("starting torque", figure("starting_torque", "theta_start")),
            ("power, mean", figure("power_mean")),
            ("power, peak", figure("power_peak")),
            ("work in, out", f"{figure('work_in')}, {figure('work_out')} {cycle}"),
            (
                "flywheel",
                f"{figure('flywheel_inertia')} for a fluctuation of {100 * self['fluctuation']:.3g} %",
            ),
        ]

    def _angle(self, name: str) -> str:
        angle = self[name] % (self.turns * self.whole_turn)
        return f"{degrees(angle):.1f} deg" if self.unit(name) == "rad" else f"{angle:.6g} {self.unit(name)}"

    def __repr__(self) -> str:
        return self.report()

    def plot(self, ax: Any = None) -> Any:
        """Torque, power and speed over the turn; see `desaxe.plot.drive`."""
        with IMPORTS:
            from ...plot import drive

        return drive(self, ax=ax)


FIGURES = (
    "torque_mean", "torque_rms", "torque_peak", "theta_peak", "work_in", "work_out", "power_mean",
    "power_peak", "flywheel_inertia", "flywheel_torque", "starting_torque", "theta_start", "period",
)  # fmt: skip
ROUNDING = 1e-13  # of a peak: a mean below it is the rounding error of a sum that is 0
COURSE = {"theta_of_speed": "rad", "speed": "rad/s"}


def _conversion(units: UnitSystem, name: str) -> Conversion:
    return units.of_unit(COURSE[name]) if name in COURSE else units.of(name)


def _units(result: Mapping[str, Any]) -> dict[str, Any]:
    return {key: unit for key, unit in units_by_name(result).items() if key in (*FIGURES, "gradient")}
