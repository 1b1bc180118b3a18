"""The content of a scene: its machine and a list of requests, checked and in SI units."""

from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from ..evaluation.reductions.argument import Reduction
from ..loads.load import Load
from ..mechanism.own import Definition
from .parts.checks import Check
from .parts.extremes import Peak, group_names
from .parts.motor import OnMotor
from .parts.pictures import PictureRequest
from .setting import PlanRow, Setting


@dataclass(frozen=True, kw_only=True)
class Content(Setting):
    """The machine, the requests beside its grid, and where results go."""

    checks: tuple[Check, ...] = ()
    peaks: tuple[Peak, ...] = ()
    pictures: tuple[PictureRequest, ...] = ()
    steady: OnMotor | None = None
    data: str | None = None
    store: str | None = None
    chunks: Any = None
    memory: int | None = None
    definitions: tuple[Definition, ...] = ()

    @property
    def digest(self) -> str:
        """A digest of every number, those of tables too."""
        loads = [load.identity for load in self.inputs.values() if isinstance(load, Load)]
        return sha256(repr((self, *loads) if loads else self).encode()).hexdigest()

    @property
    def fused(self) -> Reduction | None:
        """The reduction, where a kernel takes it without storing the grid."""
        return None if self.reduction is None else self.reduction.alone

    @property
    def work(self) -> list[PlanRow]:
        """The work of the requests beside the grid."""
        steady = () if self.steady is None else (self.steady,)
        printed = PlanRow("printed values", len(self.checks), "points", "single points in plain Python")
        rows = [one.work for one in (*self.peaks, *steady, *self.pictures)]
        return [*rows, printed] if self.checks else rows

    @property
    def groups(self) -> list[str]:
        """A name for each labelled result besides the values: of the peaks, and of the steady states."""
        return [*group_names(self.peaks), *(["steady"] if self.steady is not None else [])]
