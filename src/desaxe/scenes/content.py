"""The content of a scene, checked and in SI units."""

from collections.abc import Mapping
from hashlib import sha256
from types import MappingProxyType
from typing import Any, NamedTuple

from ..evaluation.reductions.argument import Reduction, Reductions
from ..loads.load import Load
from ..mechanism.own import Definition
from ..mechanism.quantity_units import SI, UnitSystem
from .reading.printed import Printed
from .reading.values import Value


class Check(NamedTuple):
    """A printed value, and the inputs for the computed one."""

    title: str
    source: str
    quantity: str
    printed: Printed
    inputs: dict[str, Any]


class Claim(NamedTuple):
    """A claim about the peak of one design: its increase over the baseline."""

    source: str
    at: dict[str, float]
    design: dict[str, float]
    increase: Printed


class Peak(NamedTuple):
    """A peak over the crank angle, for the outer product of `axes` with everything else fixed."""

    title: str
    quantity: str
    kind: str
    axes: dict[str, tuple[float, ...]]
    fixed: dict[str, float]
    theta: tuple[float, float]
    at_baseline: dict[str, float]
    baseline: dict[str, float]
    claims: tuple[Claim, ...]
    sensitivities: tuple[str, ...]
    loads: Mapping[str, Load] = MappingProxyType({})  # that vary with the motion


class PictureRequest(NamedTuple):
    """A family of curves and the file it goes to."""

    title: str
    file: str
    quantity: str
    over: str
    family: str | None
    inputs: dict[str, Value]


class OnMotor(NamedTuple):
    """The steady states on a motor, for the outer product of `axes` with everything else fixed."""

    torque: Any
    axes: dict[str, tuple[float, ...]]
    fixed: dict[str, Value]
    seeks: bool  # the flywheel for a fluctuation


class Content(NamedTuple):
    """The content of a scene in SI units, its inputs in the order of the file."""

    title: str
    outputs: tuple[str, ...]
    accuracy: str
    branch: int
    inputs: dict[str, Value]
    checks: tuple[Check, ...]
    peaks: tuple[Peak, ...]
    pictures: tuple[PictureRequest, ...]
    data: str | None
    reduction: Reductions | None = None
    threads: int | None = None
    units: UnitSystem = SI
    store: str | None = None
    chunks: Any = None
    memory: int | None = None
    definitions: tuple[Definition, ...] = ()
    steady: OnMotor | None = None

    @property
    def digest(self) -> str:
        """A digest of every number, those of tables too."""
        loads = [load.identity for load in self.inputs.values() if isinstance(load, Load)]
        return sha256(repr((self, *loads) if loads else self).encode()).hexdigest()

    @property
    def fused(self) -> Reduction | None:
        """The reduction, where a kernel takes it without storing the grid."""
        return None if self.reduction is None else self.reduction.alone
