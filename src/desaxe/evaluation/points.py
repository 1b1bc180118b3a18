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
from ..mechanism.own import Definition, Register, register, used_by, using
from ..mechanism.program import Variant, program_of
from ..runtime.kernels import KernelKey, key_of
from ..runtime.request import Request, as_number, check_common, several
from ..support.forks import IMPORTS
from .arrays import Loops, as_array, copied_back, dtype_of, evaluate_arrays, fill, outputs_for, scratch_for
from .labels import Output, attributes
from .under_loads.request import LoadInputs
from .values import checked_request, values

Array = NDArray[Any]
ALWAYS = ("status", "margin")
OPTIONS = ("branch", "accuracy", "threads", "out", "reduce", "chunks", "sliders")
ARGUMENTS = (*INPUTS, *OPTIONS)  # of a grid, by name


class Outer(NamedTuple):
    """The arguments of a grid, checked.

    `given` are the inputs as they came; `axes` their arrays; `loads` those that vary with the motion, which
    are no axes.
    """

    names: tuple[str, ...]
    given: dict[str, Any]
    axes: dict[str, Array]
    loads: Mapping[str, Load] = MappingProxyType({})

    @property
    def dimensions(self) -> list[str]:
        """The inputs with one axis, in their order."""
        return [name for name, array in self.axes.items() if array.ndim]

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
        groups = [(others, self.dimensions), (rest, self.lengths), (both, [*self.lengths, *self._reverses])]
        return [(names, along) for names, along in groups if names]

    @property
    def _reverses(self) -> list[str]:
        """The axis of speeds of which some are negative, but not all."""
        axes = {name: self.axes[name] for name in ("omega0", "omega") if name in self.dimensions}
        return [
            name
            for name, speeds in axes.items()
            if not (all(speeds >= 0.0) or all(speeds < 0.0)) or not speeds.size
        ]

    @property
    def lengths(self) -> list[str]:
        """The dimensions that are lengths."""
        return [name for name in self.dimensions if name in LENGTHS]


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
    if any(callable(value) or hasattr(value, "dims") for value in inputs.values()):
        with IMPORTS:
            from .under_loads.loaded import split_axes

        inputs, loads = split_axes(inputs)
    check_common(inputs, branch, threads)
    shown = tuple(dict.fromkeys((*requested, *ALWAYS))) if always else requested
    axes = {n: axis_of(n, value, (), shown) for n, value in inputs.items() if value is not None}
    return Outer(requested, dict(inputs), axes, loads)


def axis_of(name: str, value: Any, inputs: Sequence[str], names: Sequence[str]) -> Array:
    """An input of a grid as an array; ValueError for one of several dimensions."""
    array = as_array(name, value, inputs, names)
    if array.ndim > 1:
        raise ValueError(f"{name}: a grid takes numbers and 1-d arrays, got the shape {array.shape}")
    return array


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


@dataclass(frozen=True)
class Points(Step):
    """The values of names over some dimensions; without arrays, so that it pickles small.

    wanted   the request
    inputs   those that are numbers here, or dimensions
    numbers  the inputs that are numbers here
    key      the kernel of all blocks
    branch   the assembly
    loads    the inputs that follow from loads which vary with the motion; derivatives are total ones then
    """

    wanted: Request
    inputs: tuple[str, ...]
    numbers: tuple[tuple[str, float], ...]
    key: KernelKey
    branch: int
    loads: LoadInputs | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The names, as the user says them."""
        return self.wanted.shown

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.key.form.own

    @property
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""
        state = self.wanted.form.state
        return {name: Output(dtype_of(name), attributes(name, state)) for name in self.names}

    @property
    def identity(self) -> str:
        """A text that tells the step from all others, by what its loads are too."""
        loads = () if self.loads is None else self.loads.loads.values()
        return " ".join([repr(self), *(load.identity for load in loads)])

    def compute(
        self, values: Mapping[str, Array], threads: int | None = 1, out: Any = None
    ) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its dimensions; in `out` if given."""
        shape = tuple(values[name].size for name in self.dims)
        places = outputs_for(self.names, shape, out)
        buffers = places if out is None else scratch_for(places, values.values())
        if all(shape):
            self._fill(values, list(buffers.values()), threads)
        return copied_back(places, buffers)

    def at(self, points: Mapping[str, Array]) -> dict[str, Array]:
        """The values under loads at points, whose inputs are columns of one length."""
        assert self.loads is not None
        inputs = {**dict(self.numbers), **points, **self.loads.loads}
        with using(self.own):
            result: dict[str, Array] = values(self.names, inputs, self.branch, self.wanted.accuracy, 1)
        return result

    def _fill(self, values: Mapping[str, Array], outs: Sequence[Array], threads: int | None) -> None:
        """Fill outputs of a block."""
        columns = {name: np.ascontiguousarray(values[name]) for name in self.dims if name in self.inputs}
        scalars: dict[str, Any] = dict(self.numbers)
        axes = {name: self.dims.index(name) for name in columns}
        if self.loads is not None and self.loads.motion is not None:
            self._of_motion(columns, outs, threads)
            return
        if self.loads is not None:
            scalars |= self.loads.tables()
            along = columns if "theta" in columns else scalars
            along.update(self.loads.at({"theta": along["theta"]}))
            axes |= {name: axes["theta"] for name in self.loads.functions if name in columns}
        loops = Loops(tuple(values[name].size for name in self.dims) or (1,), columns, axes)
        fill(self.wanted, scalars, loops.taken_by(self.wanted), outs, threads, self.key)

    def _of_motion(self, columns: Mapping[str, Array], outs: Sequence[Array], threads: int | None) -> None:
        """Fill outputs under loads over the motion, whose values vary over all dimensions."""
        count = len(self.dims)
        along = {
            n: column.reshape([-1 if dim == n else 1 for dim in self.dims]) for n, column in columns.items()
        }
        given = {**dict(self.numbers), **along}
        if not count:
            given["theta"] = np.array(given["theta"])
        result = evaluate_arrays(self.wanted, self.inputs, given, threads, None, self.loads)
        for out, array in zip(outs, result.values(), strict=True):
            out[...] = array


def points_of(names: Sequence[str], outer: Outer, along: Sequence[str], branch: int, accuracy: Any) -> Points:
    """The step of names over dimensions of a grid, checked; TypeError for what is missing."""
    call = checked_request(tuple(names), outer.given, branch, accuracy, outer.loads)
    requested, inputs, loads = call.asked, call.inputs, call.of_loads(outer.loads)
    for name in inputs:
        if name not in outer.axes:
            as_number(name, None, inputs, requested.shown)
    own = {name: outer.axes[name] for name in inputs}
    scalars = {n: float(axis.reshape(-1)[0]) for n, axis in own.items() if n not in along and axis.size}
    columns = {n: np.ascontiguousarray(axis) for n, axis in own.items() if n in along}
    axis_of = {name: along.index(name) for name in columns}
    if loads is not None and "theta" in columns:  # the values of functions are along it
        columns |= dict.fromkeys(loads.functions, columns["theta"])
        axis_of |= dict.fromkeys(loads.functions, axis_of["theta"])
    loops = Loops(tuple(outer.axes[name].size for name in along) or (1,), columns, axis_of).taken_by(
        requested
    )
    key = key_of(requested, scalars, loops.columns, loops.axis_of, len(loops.sizes), call.keys)
    return Points(tuple(along), requested, tuple(inputs), tuple(scalars.items()), key, int(branch), loads)
