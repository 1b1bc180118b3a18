"""A step of a plan: some variables over the same dimensions, computed in any block of a grid."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from ..mechanism.own import Definition
from .labels import Output

Array = NDArray[Any]


@dataclass(frozen=True)
class Step(ABC):
    """Base class of steps.

    dims   the dimensions of the outputs, in their order
    """

    dims: tuple[str, ...]

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the step needs; those that are reduced are whole in every block."""
        return self.dims

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs, but for those that the request of a store tells."""
        return ()

    @property
    def identity(self) -> str:
        """A text that tells the step from all others."""
        return repr(self)

    @property
    @abstractmethod
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""

    @abstractmethod
    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its `axes`."""

    def held(self) -> tuple[str, ...]:
        """The reduced axes whose points are in memory behind each number of the outputs."""
        return ()

    def combines(self) -> bool:
        """True if the outputs follow from those of pieces of these axes."""
        return False

    def combine(
        self, parts: Sequence[Mapping[str, Array]], found: Sequence[dict[str, Array]]
    ) -> dict[str, Array]:
        """The outputs of a block from those of its pieces, in their order, and the values of these."""
        raise NotImplementedError
