"""The arguments of a grid, checked, and steps of a plan: some variables over the same dimensions.

Which kernel answers a request depends on its inputs (all designs have wide margins, some angle is huge, an
input is 0). So it is chosen once, from all of the inputs, and every block takes it, even a block of one
point: cutting a grid changes no digit.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.load import Load
from ..mechanism.catalogue import of_design
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs
from ..mechanism.names import LENGTHS, STATUS
from ..mechanism.own import Definition, Register, register, used_by
from ..mechanism.program import Variant, program_of
from ..runtime.kernels import KernelKey, key_of
from ..runtime.request import as_number, check_common, several
from ..support.forks import IMPORTS
from .arrays import as_array, copied_back, dtype_of, evaluate_arrays, fill, outputs_for, scratch_for
from .call import Call
from .labels import Output, attributes
from .values import prepared

Array = NDArray[Any]
ALWAYS = ("status", "margin")
OPTIONS = ("branch", "accuracy", "threads", "out", "reduce", "chunks", "sliders")
ARGUMENTS = (*INPUTS, *OPTIONS)  # of a grid, by name


class Outer(NamedTuple):
    """The arguments of a grid, checked.

    given   the inputs as they came, without loads
    axes    their arrays
    along   input -> its dimension, of those that have one: its own name, or one that several share
    loads   those that vary with the motion, which are no axes
    labels  coordinates of shared dimensions
    """

    names: tuple[str, ...]
    given: dict[str, Any]
    axes: dict[str, Array]
    along: dict[str, str]
    loads: Mapping[str, Load] = MappingProxyType({})
    labels: Mapping[str, Any] = MappingProxyType({})

    @property
    def dimensions(self) -> list[str]:
        """The dimensions, in the order of the inputs."""
        return [*dict.fromkeys(self.along.values())]

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension."""
        return {dim: self.axes[name].size for name, dim in self.along.items()}

    @property
    def columns(self) -> dict[str, Array]:
        """The arrays of the inputs, and of shared dimensions the positions along them."""
        shared = {dim: np.arange(float(n)) for dim, n in self.sizes.items() if dim not in self.axes}
        return {**self.axes, **shared}

    @property
    def shown(self) -> tuple[str, ...]:
        """The names of the variables of a labelled grid."""
        return tuple(dict.fromkeys((*self.names, *ALWAYS)))

    def groups(self) -> list[tuple[list[str], list[str]]]:
        """The names that have all dimensions, and those that have the lengths' alone, with them.

        Strokes hang on the sign of the speed: where that changes, they have the speed's dimension too.
        """
        whole, signed = _of_designs(self.shown, register())
        both = [*signed] if self._reverses else []
        rest = [name for name in whole if name not in both]
        others = [name for name in self.shown if name not in whole]
        if others == [STATUS] and "theta" not in self.axes:  # that of the design
            others, rest = [], [STATUS, *rest]
        lengths = self.of(LENGTHS)
        groups = [(others, self.dimensions), (rest, lengths), (both, self.of((*LENGTHS, *self._reverses)))]
        return [(names, along) for names, along in groups if names]

    @property
    def _reverses(self) -> list[str]:
        """The speeds of which some are negative, but not all."""
        axes = {name: self.axes[name] for name in ("omega0", "omega") if name in self.along}
        return [
            n
            for n, speeds in axes.items()
            if not (all(speeds >= 0.0) or all(speeds < 0.0)) or not speeds.size
        ]

    def of(self, inputs: Sequence[str]) -> list[str]:
        """The dimensions of some inputs, in their order."""
        dims = {self.along[name] for name in inputs if name in self.along}
        return [dim for dim in self.dimensions if dim in dims]


@lru_cache(maxsize=256)
def _of_designs(names: tuple[str, ...], known: Register) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names that follow from the lengths alone; of these, those that need the sign of the speed."""
    whole = tuple(name for name in names if of_design(name, known))
    programs = {name: program_of((name,), Variant(own=used_by((name,), known))) for name in whole}
    return whole, tuple(name for name, program in programs.items() if "omega0" in program.inputs)


def outer_of(
    names: str | Sequence[str], inputs: Mapping[str, Any], branch: int, threads: int | None, always: bool
) -> Outer:
    """Check the arguments of a grid; `always`: it has `status` and `margin` too."""
    requested = (names,) if isinstance(names, str) else several(names)
    check_inputs("grid", inputs, ARGUMENTS)
    loads: Mapping[str, Load] = {}
    shared: Mapping[str, str] = {}
    labels: Mapping[str, Any] = {}
    if any(callable(value) or hasattr(value, "dims") or hasattr(value, "iloc") for value in inputs.values()):
        with IMPORTS:
            from .labelled import labels_of, shared_dimensions, split_axes

        inputs, loads = split_axes(inputs)
        shared = shared_dimensions(inputs)
        labels = labels_of(inputs, shared)
    check_common(inputs, branch, threads)
    shown = tuple(dict.fromkeys((*requested, *ALWAYS))) if always else requested
    axes = {n: axis_of(n, value, (), shown) for n, value in inputs.items() if value is not None}
    along = {name: shared.get(name, name) for name, array in axes.items() if array.ndim}
    return Outer(requested, dict(inputs), axes, along, loads, labels)


def axis_of(name: str, value: Any, inputs: Sequence[str], names: Sequence[str]) -> Array:
    """An input of a grid as an array; ValueError for one of several dimensions."""
    array = as_array(name, value, inputs, names)
    if array.ndim > 1:
        raise ValueError(
            f"{name}: a grid takes numbers and 1-d arrays, got the shape {array.shape}; evaluate takes any"
        )
    return array


@dataclass(frozen=True)
class Step(ABC):
    """Base class of steps.

    dims   the dimensions of the outputs, in their order
    along  what it needs the values of, and the dimension of each
    """

    dims: tuple[str, ...]
    along: tuple[tuple[str, str], ...]

    @property
    def columns(self) -> dict[str, str]:
        """The dimension of each column that it needs, by name."""
        return dict(self.along)

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
        """The outputs of a block by name, from the values of its `columns`."""


@dataclass(frozen=True)
class Points(Step):
    """The values of names over some dimensions; without arrays, so that it pickles small.

    call     the request, with its loads
    numbers  the inputs that are numbers here
    key      the kernel of all blocks
    """

    call: Call
    numbers: tuple[tuple[str, float], ...]
    key: KernelKey

    @property
    def names(self) -> tuple[str, ...]:
        """The names, as the user says them."""
        return self.call.asked.shown

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.key.form.own

    @property
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""
        state = self.call.asked.form.state
        return {name: Output(dtype_of(name), attributes(name, state)) for name in self.names}

    @property
    def identity(self) -> str:
        """A text that tells the step from all others, by what its loads are too."""
        loads = () if self.call.loads is None else self.call.loads.loads.values()
        return " ".join([repr(self), *(load.identity for load in loads)])

    def compute(
        self, values: Mapping[str, Array], threads: int | None = 1, out: Any = None
    ) -> dict[str, Array]:
        """The outputs of a block by name, from the values of its `columns`; in `out` if it is an array."""
        arrays = outer_arrays(values, self.columns, self.dims)
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        places = outputs_for(self.names, shape, out)
        buffers = places if out is None else scratch_for(places, values.values())
        if all(shape):
            needed = {name: array for name, array in arrays.items() if name in self.call.inputs}
            fill(self.call, dict(self.numbers), needed, shape, list(buffers.values()), threads, self.key)
        return copied_back(places, buffers)

    def at(self, points: Mapping[str, Array]) -> dict[str, Array]:
        """The values at points, whose inputs are columns of one length."""
        return evaluate_arrays(self.call, {**dict(self.numbers), **points}, 1)


def outer_arrays(
    values: Mapping[str, Array], along: Mapping[str, str], dims: Sequence[str]
) -> dict[str, Array]:
    """Columns along their dimensions, as arrays that broadcast to a grid."""
    return {n: values[n].reshape([-1 if one == dim else 1 for one in dims]) for n, dim in along.items()}


def points_of(names: Sequence[str], outer: Outer, dims: Sequence[str], branch: int, accuracy: Any) -> Points:
    """The step of names over dimensions of a grid, checked; TypeError for what is missing."""
    call, _, keys = prepared(tuple(names), outer.given, branch, accuracy, outer.loads)
    for name in call.inputs:
        if name not in outer.axes:
            as_number(name, None, call.inputs, call.asked.shown)
    along = {name: dim for name, dim in outer.along.items() if dim in dims}
    numbers = {
        n: float(outer.axes[n].reshape(-1)[0]) for n in call.inputs if n not in along and outer.axes[n].size
    }
    columns = {n: outer.axes[n] for n in call.inputs if n in along}
    axis_of, axes = {name: dims.index(along[name]) for name in columns}, max(1, len(dims))
    if call.loads is not None:
        motion, moves = call.loads.motion, ["theta"]
        if motion is not None:  # its columns vary over all dimensions: one loop over all points
            moves = ["theta", *motion.inputs]
            axis_of, axes = dict.fromkeys(axis_of, 0), 1
        first = next((name for name in moves if name in columns), None)
        if first is not None:
            columns |= dict.fromkeys(call.loads.functions, columns[first])
            axis_of |= dict.fromkeys(call.loads.functions, axis_of[first])
        axis_of = {name: axis for name, axis in axis_of.items() if name in call.asked.inputs}
    key = key_of(call.asked, numbers, columns, axis_of, axes, keys)
    return Points(tuple(dims), tuple(along.items()), call, tuple(numbers.items()), key)
