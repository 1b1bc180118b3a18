"""The content of a scene, a machine and a list of requests; the plan of a request, and its answer.

A request is a frozen dataclass with `key`, the name of its table in a scene file, and

    request.plan(content) -> RequestPlan    what it costs, and how it runs
    plan.run(sink) -> RequestAnswer         values in SI units
    answer.to(units).blocks(units)          a section of the report
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..evaluation.in_units import in_units
from ..evaluation.labels import CONVENTIONS, import_xarray, input_attributes, source, tell_loads
from ..evaluation.reductions.argument import Reduction, Reductions
from ..loads.load import Load
from ..mechanism.own import Definition
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.progress import Steps
from .document.blocks import Section
from .reading.values import Value


class PlanRow(NamedTuple):
    """The work of a request: a row of a plan."""

    what: str
    number: int
    of: str
    how: str


class Sink(NamedTuple):
    """The progress of a run, leave to replace files, and the units of its pictures."""

    steps: Steps
    overwrite: bool = False
    units: UnitSystem = SI


class RequestPlan(NamedTuple):
    """The plan of a request: what runs, in how many steps of progress, its work, the file that it writes."""

    run: Callable[[Sink], Any]
    steps: int = 0
    work: Sequence[PlanRow] = ()
    file: str | None = None

    def describe(self) -> list[dict[str, Any]]:
        """The rows of `explain`."""
        return [{"what": what, "count": number, "of": of, "how": how} for what, number, of, how in self.work]


@dataclass(frozen=True, kw_only=True)
class RequestAnswer(ABC):
    """The answer to a request; `dataset` has its values with their units, where they are labelled."""

    key: ClassVar[str]
    dataset: Any = None

    def to(self, units: UnitSystem) -> Self:
        """The answer with its values in other units."""
        return self if self.dataset is None else replace(self, dataset=in_units(self.dataset, units))

    @abstractmethod
    def blocks(self, units: UnitSystem) -> Section:
        """The section of a report; values are in these units already."""


@dataclass(frozen=True, kw_only=True)
class Content:
    """A machine and a list of requests, checked: inputs in SI units, in the order of the file.

    outputs   of the grid over all inputs, taken together by `reduction`
    units     of results and files; SI units where the scene names none
    requests  in the order of the report; pictures last
    """

    title: str
    outputs: tuple[str, ...]
    accuracy: str
    branch: int
    inputs: dict[str, Value]
    reduction: Reductions | None = None
    threads: int | None = None
    units: UnitSystem = SI
    requests: tuple[Any, ...] = ()
    data: str | None = None
    store: str | None = None
    chunks: Any = None
    memory: int | None = None
    definitions: tuple[Definition, ...] = ()

    def of(self, key: str) -> tuple[Any, ...]:
        """The requests of a key: "peak", "picture", "steady", ..."""
        return tuple(one for one in self.requests if one.key == key)

    @property
    def peaks(self) -> tuple[Any, ...]:
        """The peaks."""
        return self.of("peak")

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
    def groups(self) -> list[str]:
        """A name for each labelled result besides the values; further ones of the same name have a number."""
        names: list[str] = []
        for name in (one.group for one in self.requests if hasattr(one, "group")):
            again = sum(other == name or other.startswith(f"{name}__") for other in names)
            names.append(f"{name}__{again + 1}" if again else name)
        return names

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


@dataclass(frozen=True, kw_only=True)
class Run:
    """The answers of a run, its files, and those that could not be written, with reasons."""

    answers: tuple[RequestAnswer, ...]
    files: tuple[Path, ...] = ()
    failures: tuple[str, ...] = ()

    def of(self, key: str) -> tuple[Any, ...]:
        """The answers of a key."""
        return tuple(one for one in self.answers if one.key == key)

    def one(self, key: str) -> Any:
        """The answer of a key; None without."""
        return next(iter(self.of(key)), None)

    def to(self, content: Content, units: UnitSystem) -> Self:
        """The run in the units of a report; answers are in those of the scene, in SI units without."""
        return self if content.units else replace(self, answers=tuple(one.to(units) for one in self.answers))

    def blocks(self, content: Content, units: UnitSystem) -> list[Section]:
        """The sections of a report in these units."""
        return [one.blocks(units) for one in self.to(content, units).answers]

    @property
    def dataset(self) -> Any:
        """The outputs over the grid of all inputs, labelled; None where there are none."""
        return getattr(self.one("outputs"), "dataset", None)

    @property
    def peaks(self) -> tuple[Any, ...]:
        """The answers of [[peak]]."""
        return self.of("peak")

    @property
    def checks(self) -> tuple[Any, ...]:
        """The printed values beside the computed ones."""
        return tuple(result for one in self.of("check") for result in one.results)

    @property
    def feasibility(self) -> Any:
        """The designs that turn fully; None without all lengths."""
        return self.one("feasibility")

    @property
    def steady(self) -> Any:
        """The steady states; None without a motor."""
        return self.one("steady")


def columns_of(inputs: Mapping[str, Value]) -> dict[str, NDArray[np.float64]]:
    """The outer product of the inputs, flat, in the order given."""
    arrays = np.meshgrid(*(np.asarray(value) for value in inputs.values()), indexing="ij")
    return {name: array.reshape(-1) for name, array in zip(inputs, arrays, strict=True)}
