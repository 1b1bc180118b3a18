"""A load over the slider's distance from a dead centre of its own: it moves with the design."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .load import OverY, Partials, sign_of

DEAD_CENTRES = ("outer", "inner")


@dataclass(frozen=True, repr=False)
class OverStroke(OverY):
    """A load over d = |Y - Y_dead_centre|, a table for each way of the slider."""

    dead_centre: str = "outer"  # or inner

    over = "stroke"

    @property
    def rises(self) -> float:  # type: ignore[override]
        """Inward the distance from the outer dead centre grows, outward that from the inner one."""
        return -1.0 if self.dead_centre == "outer" else 1.0

    @property
    def centre(self) -> str:  # type: ignore[override]
        """The name of the dead centre's position."""
        return f"Y_{self.dead_centre}"

    @property
    def needs(self) -> tuple[str, ...]:  # type: ignore[override]
        """The position, and that of the dead centre."""
        return "Y", self.centre

    @property
    def place(self) -> str:
        """The distance that the load is over, in words."""
        return f"the distance from the {self.dead_centre} dead centre"

    def along(self, motion: Mapping[str, Any]) -> Any:
        """The distance from the dead centre."""
        return abs(motion[self.centre] - motion["Y"])

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The value and the derivatives by Y and the dead centre."""
        value, slope = self.both(self.along(now), now["way"])
        slope = slope * sign_of(now["Y"] - now[self.centre])
        return Partials(value, {"Y": slope, self.centre: -slope})
