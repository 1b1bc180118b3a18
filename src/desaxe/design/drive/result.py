"""The result of `drive`: a dict with a report and a plot."""

from collections.abc import Mapping
from math import degrees, isnan
from typing import TYPE_CHECKING, Any

from ...loads.angles import turns_of
from ...mechanism.status import DriveStatus
from ...mechanism.unit_system import SI, Conversion, UnitSystem
from ...mechanism.units import registry
from ...support.answer import Answer
from ...support.forks import IMPORTS
from ..turn.turn import MOST_TURNS

if TYPE_CHECKING:
    from numpy.typing import NDArray

STATUS = {int(status): status.words for status in DriveStatus if status}


class Drive(Answer):
    """The figures by name, `gradient` and `status`; `report()`, `plot()`.

    `inputs` are those of the design in SI units, varying loads included, `branch` is its branch. `course` has
    arrays over the turn: `theta`, `T_in`, `power_in` and, with the flywheel, `theta_of_speed` and `speed`.
    `units` are the units of all but `inputs`.
    """

    def __init__(
        self,
        figures: Mapping[str, Any],
        inputs: Mapping[str, Any],
        branch: int,
        course: "Mapping[str, NDArray[Any]]",
        units: UnitSystem = SI,
    ) -> None:
        super().__init__(figures)
        self.inputs, self.branch, self.course, self.units = dict(inputs), branch, dict(course), units

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self), self.inputs, self.branch, self.course, self.units)

    def in_units(self, units: UnitSystem) -> "Drive":
        """The result in other units; it must be in SI units now."""
        figures = {name: _shown(units, name, value) for name, value in self.items()}
        course = {name: _conversion(units, name).shown(values) for name, values in self.course.items()}
        return Drive(figures, self.inputs, self.branch, course, units)

    def as_quantities(self, units: UnitSystem) -> dict[str, Any]:
        """The figures in these units as pint quantities (extra `units`)."""
        Quantity = registry().Quantity

        def labelled(value: Any, conversion: Conversion) -> Any:
            return value if conversion.unit == "1" else Quantity(conversion.shown(value), conversion.unit)

        found = {n: labelled(v, _conversion(units, n)) for n, v in self.items() if n in FIGURES}
        gradient = {
            name: {by: labelled(slope, _slope(units, name, by)) for by, slope in slopes.items()}
            for name, slopes in self["gradient"].items()
        }
        return {**self, **found, "gradient": gradient}

    def report(self) -> str:
        """The figures as text for a data sheet; angles in radians are shown in degrees."""
        lines = [
            f"Drive over {'one turn' if self.turns == 1 else f'{self.turns} turns'}",
            f"  {self.design()}",
        ]
        if self["status"]:
            lines.append(f"  status {self['status']}: {STATUS[self['status']]}")
        if not isnan(self["torque_mean"]):
            lines += [f"  {label:17} {value}" for label, value in self.rows()]
        return "\n".join(lines)

    @property
    def turns(self) -> int:
        """After how many turns the loads repeat."""
        return turns_of("drive", {n: load for n, load in self.inputs.items() if callable(load)}, MOST_TURNS)

    def design(self) -> str:
        """The inputs with their units, in a line."""
        told = []
        for name, value in self.inputs.items():
            if callable(value):
                told.append(f"{name}: {value!r}".replace("<", "").replace(">", ""))
                continue
            conversion = self.units.of(name)
            told.append(f"{name} = {conversion.shown(value):.6g} {conversion.unit}".removesuffix(" 1"))
        return ", ".join(told)

    def unit(self, name: str) -> str:
        """The unit of a figure or of an array of `course`, as a label has it."""
        return _conversion(self.units, name).unit.replace("*", " ")

    def rows(self) -> list[tuple[str, str]]:
        """The figures as text, each with its name."""

        def figure(name: str, angle: str | None = None) -> str:
            where = "" if angle is None or isnan(self[angle]) else f" at {self._angle(angle)}"
            return "-" if isnan(self[name]) else f"{self[name]:.6g} {self.unit(name)}{where}"

        cycle = "a turn" if self.turns == 1 else f"in {self.turns} turns"
        speed = 60.0 * self.turns / _conversion(self.units, "period").to_si(self["period"])
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
        if self.unit(name) == "rad":
            return f"{degrees(self[name]):.1f} deg"
        return f"{self[name]:.6g} {self.unit(name)}"

    def __str__(self) -> str:
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
COURSE = {"theta_of_speed": "rad", "speed": "rad/s"}


def _conversion(units: UnitSystem, name: str) -> Conversion:
    return units.of_unit(COURSE[name]) if name in COURSE else units.of(name)


def _slope(units: UnitSystem, name: str, by: str) -> Conversion:
    return _conversion(units, name) if by == "fluctuation" else units.slope(name, by)


def _shown(units: UnitSystem, name: str, value: Any) -> Any:
    """A figure, or the derivatives of all, in these units."""
    if name == "gradient":
        return {
            figure: {by: _slope(units, figure, by).shown(slope) for by, slope in slopes.items()}
            for figure, slopes in value.items()
        }
    return _conversion(units, name).shown(value) if name in FIGURES else value
