"""A load over the slider's distance from a dead centre of its own: it moves with the design."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..support.computed import computed_once
from .load import OverY, Partials, sign_of

DEAD_CENTRES = ("outer", "inner")


@dataclass(frozen=True, repr=False)
class OverStroke(OverY):
    """A load over d = |Y - Y_dead_centre|, a table for each way of the slider."""

    dead_centre: str = "outer"  # or inner

    over = "stroke"

    @computed_once
    def rises(self) -> float:
        """Inward the distance from the outer dead centre grows, outward that from the inner one."""
        return -1.0 if self.dead_centre == "outer" else 1.0

    @computed_once
    def centre(self) -> str:
        """The name of the dead centre's position."""
        return f"Y_{self.dead_centre}"

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
