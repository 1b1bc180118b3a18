"""What `drive` returns: a dict that prints as a report and draws itself."""

from collections.abc import Mapping
from math import degrees, isnan
from typing import TYPE_CHECKING, Any

from ...mechanism.inputs import INPUTS

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNITS = {
    **dict.fromkeys(
        ("torque_mean", "torque_rms", "torque_peak", "starting_torque", "flywheel_torque"), "N*m"
    ),
    **dict.fromkeys(("work_in", "work_out"), "J"),
    **dict.fromkeys(("power_mean", "power_peak"), "W"),
    **dict.fromkeys(("theta_peak", "theta_start"), "rad"),
    "flywheel_inertia": "kg*m^2",
    "period": "s",
    "fluctuation": "1",
}
STATUS = {
    1: "the crank cannot turn fully",
    2: "at a change point",
    3: "the crank stalls within the turn",
    4: "no finite torque",
    5: "friction jams: no forces balance somewhere on the turn",
    6: "friction: two sets of forces balance somewhere on the turn",
}


class Drive(dict[str, Any]):
    """The figures by name, `gradient` and `status`; `report()`, `plot()`.

    `inputs` are those of the design, `branch` its branch; `course` has arrays over the turn: `theta`, `T_in`,
    `power_in`, and, with the flywheel, `theta_of_speed` and `speed`. All in SI units and radians.
    """

    def __init__(
        self,
        figures: Mapping[str, Any],
        inputs: Mapping[str, float],
        branch: int,
        course: "Mapping[str, NDArray[Any]]",
    ) -> None:
        super().__init__(figures)
        self.inputs, self.branch, self.course = dict(inputs), branch, dict(course)

    def report(self) -> str:
        """The figures as a text for a data sheet, in SI units and degrees."""
        design = ", ".join(
            f"{name} = {value:.6g} {INPUTS[name].unit}".removesuffix(" 1")
            for name, value in self.inputs.items()
        )
        lines = ["Drive over one turn", f"  {design}"]
        if self["status"]:
            lines.append(f"  status {self['status']}: {STATUS[self['status']]}")
        if not isnan(self["torque_mean"]):
            lines += [f"  {label:17} {value}" for label, value in self._rows()]
        return "\n".join(lines)

    def _rows(self) -> list[tuple[str, str]]:
        def told(name: str, angle: str | None = None) -> str:
            unit = UNITS[name].replace("*", " ")
            where = "" if angle is None or isnan(self[angle]) else f" at {degrees(self[angle]):.1f} deg"
            return "-" if isnan(self[name]) else f"{self[name]:.6g} {unit}{where}"

        turns = 60.0 / self["period"]
        return [
            ("speed", f"{turns:.6g} rpm, {self['period']:.6g} s a turn"),
            ("torque, mean", told("torque_mean")),
            ("torque, rms", told("torque_rms")),
            ("torque, peak", told("torque_peak", "theta_peak")),
            ("starting torque", told("starting_torque", "theta_start")),
            ("power, mean", told("power_mean")),
            ("power, peak", told("power_peak")),
            ("work in, out", f"{told('work_in')}, {told('work_out')} a turn"),
            (
                "flywheel",
                f"{told('flywheel_inertia')} for a fluctuation of {100 * self['fluctuation']:.3g} %",
            ),
        ]

    def __str__(self) -> str:
        return self.report()

    def plot(self, ax: Any = None) -> Any:
        """Torque, power and speed over the turn; see `desaxe.plot.drive`."""
        from ...plot import drive

        return drive(self, ax=ax)
