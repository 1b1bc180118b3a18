"""A load over the slider's distance from a dead centre of its own: it moves with the design."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..mechanism.names import LENGTHS
from .load import POSITION, OverY

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
    def place(self) -> str:  # type: ignore[override]
        """The distance that the load is over, in words."""
        return f"the distance from the {self.dead_centre} dead centre"

    def motion(self, parameters: Iterable[str] = ()) -> tuple[str, ...]:
        """The names of the motion from which the load and its derivatives by these parameters follow."""
        parameters = tuple(parameters)
        own = (f"{self.centre}_wrt_{p}" for p in parameters if p in LENGTHS)
        return (*POSITION, self.centre, *(f"Y_wrt_{p}" for p in parameters), *own)

    def along(self, motion: Mapping[str, Any]) -> Any:
        """The distance from the dead centre."""
        return abs(motion[self.centre] - motion["Y"])

    def _content(self) -> str:
        return f"{self.dead_centre} {super()._content()}"
