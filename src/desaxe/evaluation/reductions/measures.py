"""Measures beside the kinds of a reduction: a name at one place of the axis, a function of the design.

Each is a step of a plan over the axes that are left; no point of the reduced axis is behind it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.catalogue import quantity
from ..labels import Output, attributes
from ..points import Points
from ..step import Step
from .argument import At
from .own_measure import OwnMeasure

Array = NDArray[Any]
FLOAT = np.dtype(np.float64)


@dataclass(frozen=True)
class AtPlace(Step):
    """The values of a name at one place of an axis."""

    axis: str
    at: At
    of: Points

    @property
    def identity(self) -> str:
        """A text that tells the step from all others, by what its loads are too."""
        return f"{self!r} {self.of.identity}"

    @property
    def outputs(self) -> dict[str, Output]:
        """The output: its type and CF attributes."""
        name, state = self.at.name, self.of.wanted.form.state
        words = f"{quantity(name, state).meaning} at {self.axis} = {self.at.text}"
        return {
            self.at.variable: Output(FLOAT, {**attributes(name, state), "long_name": words, "quantity": name})
        }

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The output of a block, from the values along each of its `axes`."""
        columns = {**values, self.axis: np.array([self.at.place])}
        return {self.at.variable: self.of.compute(columns, threads)[self.at.name][..., 0]}


@dataclass(frozen=True)
class OfDesign(Step):
    """A user's function of the design, with its derivatives by some parameters."""

    function: OwnMeasure
    numbers: tuple[tuple[str, float], ...]
    slopes: tuple[str, ...]

    @property
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""
        name = self.function.name
        found = {name: Output(FLOAT, {"long_name": f"{name} of the design"})}
        return found | {
            f"{name}_wrt_{p}": Output(FLOAT, {"long_name": f"{name}_wrt_{p}"}) for p in self.slopes
        }

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its dimensions."""
        grids = np.meshgrid(*(values[name] for name in self.dims), indexing="ij")
        shape, name = tuple(values[name].size for name in self.dims), self.function.name
        value, gradient = self.function({**dict(self.numbers), **dict(zip(self.dims, grids, strict=True))})
        found = {name: np.array(np.broadcast_to(value, shape))}
        for p in self.slopes:
            found[f"{name}_wrt_{p}"] = np.array(np.broadcast_to(gradient.get(p, 0.0), shape))
        return found
