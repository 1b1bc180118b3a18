"""The machine of a scene, and how all of its requests are computed."""

from dataclasses import dataclass

from ..evaluation.labels import CONVENTIONS, source
from ..evaluation.reductions.argument import Reductions
from ..mechanism.quantity_units import SI, UnitSystem
from .reading.values import Value


@dataclass(frozen=True, kw_only=True)
class Setting:
    """The inputs in SI units, in the order of the file, the outputs over their grid, branch and accuracy.

    units   of results and files; SI units where the scene names none
    """

    title: str
    outputs: tuple[str, ...]
    accuracy: str
    branch: int
    inputs: dict[str, Value]
    reduction: Reductions | None = None
    threads: int | None = None
    units: UnitSystem = SI

    @property
    def provenance(self) -> dict[str, str]:
        """Attributes of results: title, source, conventions."""
        title = {"title": self.title} if self.title else {}
        return {**title, "source": source(), "Conventions": CONVENTIONS}


@dataclass(frozen=True)
class PlanRow:
    """The work of a request: a row of a plan."""

    what: str
    count: int
    of: str
    how: str
