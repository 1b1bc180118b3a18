"""The machine of a scene, how all of its requests are computed, and how their results are labelled."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.labels import CONVENTIONS, import_xarray, input_attributes, source, tell_loads
from ..evaluation.reductions.argument import Reductions
from ..loads.load import Load
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

    def labelled(
        self,
        values: Mapping[str, tuple[Any, dict[str, Any]]],
        axes: Mapping[str, tuple[float, ...]],
        fixed: Mapping[str, Value],
        about: Mapping[str, Any],
        attributes: Callable[[str], dict[str, str]] = input_attributes,
    ) -> Any:
        """A Dataset of values, each with its attributes, over the designs of these axes."""
        xarray = import_xarray()
        data = {name: (tuple(axes), array, row) for name, (array, row) in values.items() if name not in axes}
        loads = {name: value for name, value in fixed.items() if isinstance(value, Load)}
        coords: dict[str, Any] = {n: (n, list(v), attributes(n)) for n, v in axes.items()}
        rest = {n: v for n, v in fixed.items() if n not in loads and n not in data}
        coords |= {n: ((), v, attributes(n)) for n, v in rest.items()}
        facts = {**self.provenance, "branch": self.branch, **about}
        return tell_loads(xarray.Dataset(data, coords, facts), loads)


@dataclass(frozen=True)
class PlanRow:
    """The work of a request: a row of a plan."""

    what: str
    count: int
    of: str
    how: str


def columns_of(inputs: Mapping[str, Value]) -> dict[str, NDArray[np.float64]]:
    """The outer product of the inputs, flat, in the order given."""
    arrays = np.meshgrid(*(np.asarray(value) for value in inputs.values()), indexing="ij")
    return {name: array.reshape(-1) for name, array in zip(inputs, arrays, strict=True)}
