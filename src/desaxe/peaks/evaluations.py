"""Values of a quantity in machine code: with its slope, and both with the gradient."""

from collections.abc import Callable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..compiler.lowering import nest
from ..compiler.program import Program
from ..runtime.executor import CompiledKernel
from ..runtime.native_calls import bind_kernel, ufunc_of
from ..support.forks import ForkSafeLock
from ..support.interrupts import finished
from ..support.recent import Recent
from .nodes import Array
from .programs import Search, programs_of
from .special import SearchedDesigns

MOST_KEPT = 256
T = TypeVar("T")


class ProgramFunction:
    """A Program whose inputs are arrays that broadcast, as a function that gives a tuple of arrays."""

    def __init__(self, program: Program, arguments: Sequence[str]) -> None:
        """Compile it; the arguments may be more than it reads."""
        kernel = nest(program, dict.fromkeys(program.inputs, 0), 1)
        bound = bind_kernel(finished(lambda: CompiledKernel(kernel, arguments)), {})
        whole = [False] * len(kernel.outputs)
        self.call, self._kept = ufunc_of(bound, len(arguments), whole, "search")


class TotalsFunction:
    """A Program under loads as a function of arrays by name, which broadcast, and of the loads' tables."""

    def __init__(self, program: Program, tables: Sequence[str]) -> None:
        """Compile it."""
        self.inputs, self._count = program.inputs, len(program.outputs)
        self._by_arrays = None if tables else ProgramFunction(program, program.inputs)
        if tables:
            kernel = nest(program, dict.fromkeys(program.inputs, 0), 1)._replace(given=tuple(tables))
            self._kernel = finished(lambda: CompiledKernel(kernel))

    def __call__(self, values: Mapping[str, Array]) -> Sequence[Array]:
        """The outputs."""
        if self._by_arrays is not None:
            outputs: Sequence[Array] = self._by_arrays.call(*(values[name] for name in self.inputs))
            return outputs
        shape = np.broadcast_shapes(*(values[name].shape for name in self.inputs))
        flat = {name: _flat(values[name], shape) for name in self.inputs}
        outs = np.empty((self._count, *shape))
        self._kernel.run({**values, **flat}, [*outs.reshape(self._count, -1)])
        return [*outs]


def _flat(values: Array, shape: tuple[int, ...]) -> Array:
    """The values of a shape in one dimension."""
    if values.shape == shape:
        return values.reshape(-1)
    if values.size == 1:
        return np.full(prod(shape), values.item())
    return np.broadcast_to(values, shape).reshape(-1)


class Evaluations(NamedTuple):
    """The quantity of a search, for blocks of its inputs (see `search`)."""

    key: Search

    def block(self, designs: SearchedDesigns, rows: NDArray[np.intp]) -> Array:
        """The inputs of designs for `curve` and `finish`."""
        return np.stack([designs.columns[name][rows] for name in programs_of(self.key).inputs])

    def curve(self, theta: Array, block: Array) -> tuple[Array, Array]:
        """Value and slope at angles that broadcast with the rows of the block."""
        value, slope = compiled(_of_designs, self.key, "curve").call(theta, *block)
        return value, slope

    def finish(self, theta: Array, block: Array) -> Array:
        """Value, slope and gradient at an angle of each design: a row each."""
        return np.array(compiled(_of_designs, self.key, "finish").call(theta, *block))


def _of_designs(key: Search, part: str) -> ProgramFunction:
    programs = programs_of(key)
    return ProgramFunction(getattr(programs, part), ("theta", *programs.inputs))


def totals_of(key: Search, part: str) -> TotalsFunction:
    """The totals of a search under loads: `curve`, value and slope, or `finish`, these with the gradient."""
    under = key.form.under
    tables = [] if under is None else [name for load in under.loads for name in load.tables]
    return TotalsFunction(getattr(programs_of(key), part), tables)


_LOCK = ForkSafeLock()
_KEPT: Recent[Any, Any] = Recent(MOST_KEPT)


def compiled(make: Callable[..., T], *key: Any) -> T:
    """`make(*key)`, once a process: several threads that want the same wait for the first."""
    found: T | None = _KEPT.get((make, *key))
    if found is None:
        with _LOCK:
            found = _KEPT.get((make, *key)) or make(*key)
            _KEPT[make, *key] = found
    return found
