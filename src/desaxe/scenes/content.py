"""The content of a scene, its machine and a list of requests, and the results of a run of it."""

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from ..evaluation.reductions.argument import Reduction
from ..loads.load import Load
from ..mechanism.own import Definition
from .parts.checks import Check, CheckResult
from .parts.motor import OnMotor
from .parts.peaks import Peak, PeakResult, group_names
from .parts.pictures import PictureRequest
from .parts.turning import FeasibilityResult
from .setting import PlanRow, Setting


@dataclass(frozen=True, kw_only=True)
class Content(Setting):
    """The machine, the requests beside its grid, and where results go: checked, and in SI units."""

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


@dataclass(frozen=True)
class Run:
    """The results of a run; `failures` lists the files that could not be written, with reasons."""

    dataset: Any  # an xarray.Dataset; None where nothing is requested
    checks: tuple[CheckResult, ...]
    peaks: tuple[PeakResult, ...]
    feasibility: FeasibilityResult | None
    files: tuple[Path, ...] = ()
    failures: tuple[str, ...] = ()
    steady: Any = None  # a MotorResult; None without a motor
