"""A load over the slider's distance from a dead centre of its own: it moves with the design."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import nan
from typing import Any

from ..mechanism.names import LENGTHS
from ..support.forks import IMPORTS
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

    def moved(self, parameter: str, motion: Mapping[str, Any]) -> Any:
        """The derivative of the distance by a parameter; NaN where the dead centre's is infinite."""
        change = -motion[f"Y_wrt_{parameter}"]
        before = motion[self.centre] < motion["Y"]
        if isinstance(change, float):
            if parameter in LENGTHS:
                change += _finite_or_nan(motion[f"{self.centre}_wrt_{parameter}"])
            return -change if before else change
        with IMPORTS:
            import numpy as np

        if parameter in LENGTHS:
            by_centre = motion[f"{self.centre}_wrt_{parameter}"]
            change = change + np.where(np.isfinite(by_centre), by_centre, np.nan)
        return np.where(before, -change, change)

    def _content(self) -> str:
        return f"{self.dead_centre} {super()._content()}"


def _finite_or_nan(x: float) -> float:
    return x if x - x == 0.0 else nan
