"""The Programs of a search: a quantity, its slope over theta, its gradient; compiled, once a process.

Derivatives that are not derived (a second one of a torque, a third one of a motion) are those of the program,
line by line: they keep the digits that its lines keep.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from math import prod
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..compiler.lowering import for_loops, nest
from ..compiler.passes.differentiate import RULES, SIGNED, Chain
from ..compiler.passes.double_double import double_double
from ..compiler.passes.pipeline import optimise
from ..compiler.passes.slicing import keep_outputs
from ..compiler.program import Line, Program
from ..compiler.text import with_short_temporaries
from ..mechanism.catalogue import has
from ..mechanism.constants import constants, double_constants
from ..mechanism.names import sensitivity
from ..mechanism.program import Variant
from ..runtime.executor import CompiledKernel
from ..runtime.native_calls import bind_kernel, ufunc_of
from ..runtime.specialise import specialise
from ..support.forks import ForkSafeLock
from ..support.recent import Recent
from ..support.signals import finished
from .nodes import Array
from .special import SearchedDesigns

MOST_KEPT = 256
T = TypeVar("T")


class Search(NamedTuple):
    """The key of a compiled search."""

    name: str  # the quantity, as the program calls it
    parameters: tuple[str, ...]  # of the gradient
    form: Variant
    fixed: tuple[tuple[str, float], ...]
    extended: bool = False  # value, slope and gradient at the peak in double-double
    far: bool = False  # angles beyond what the written-out sine and cosine reduce exactly


class SearchPrograms(NamedTuple):
    """The bodies of the loops, and the inputs that differ from design to design."""

    curve: Program  # value and slope
    finish: Program
    inputs: tuple[str, ...]


def needs_own(name: str, parameters: Sequence[str]) -> list[str]:
    """The parameters by which the derivative of a name is not derived."""
    return [p for p in parameters if not has(_by(name, p))]


def _by(name: str, parameter: str) -> str:
    """The line of a derivative: the program calls a state's omega by omega0."""
    return sensitivity(name, "omega0" if parameter == "omega" else parameter)


@lru_cache(maxsize=1024)
def programs_of(search: Search) -> SearchPrograms:
    """The programs of a search."""
    whole, outputs = _whole(search)
    value, slope, *gradient = outputs

    def prepared(names: Sequence[str]) -> Program:
        program = keep_outputs(whole, tuple(names))
        if search.far:
            return program
        return for_loops(program, constants(), search.form.wide_margins)

    finish = (value, slope, *gradient)
    if search.extended:
        last = double_double(keep_outputs(whole, finish), double_constants())
    else:
        last = prepared(finish)
    programs = prepared((value, slope)), last
    used = {name for program in programs for name in program.inputs}
    inputs = tuple(name for name in whole.inputs if name in used and name != "theta")
    return SearchPrograms(*programs, inputs)


@lru_cache(maxsize=1024)
def _whole(search: Search) -> tuple[Program, list[str]]:
    """One program of value, slope and gradient, and the names of its outputs."""
    under, form = search.form.under, search.form._replace(under=None)
    by = [_by(search.name, p) for p in ("theta", *search.parameters)]
    if under is not None and all(map(has, by)):
        program = specialise((), search.form, search.fixed)
        return program, list(program.outputs)
    motion = [] if under is None else [name for name, _ in under.names[1 + len(by) :]]
    derived = tuple(dict.fromkeys((search.name, *filter(has, by), *motion)))
    program = specialise(derived, form, search.fixed)
    called = dict(zip(derived, program.outputs, strict=True))
    names = [called[search.name]]
    for parameter, known in zip(("theta", *search.parameters), by, strict=True):
        if known in called:
            names.append(called[known])
        else:
            program, result = _differentiated(program, called[search.name], parameter)
            names.append(result)
    if under is not None:
        outputs = *names, *(called[name] for name in motion)
        program = under.added_to(program._replace(outputs=outputs), dict(search.fixed))
        names = [*program.outputs]
    return program, names


def _differentiated(program: Program, name: str, parameter: str) -> tuple[Program, str]:
    """The program with the derivative of one of its outputs, and the name of that."""
    chain = Chain(parameter, _RULES)
    for line in program.lines:
        chain.through(line)
    own = f"{name}_by_{parameter}"
    lines = (*program.lines, *chain.lines, Line(own, "copy", (chain.slope(name),)))
    outputs = (*program.outputs, own)
    longer = optimise(program._replace(lines=lines, outputs=outputs))
    return with_short_temporaries(longer), own


# A double knows its sign; the rules of balls leave it to what is known of the whole ball.
_SIGNED = "da * copysign(1.0, a)"
_RULES = {**RULES, "abs": _SIGNED, "abs_sin": _SIGNED, "copysign": SIGNED}


# ---- compiled --------------------------------------------------------------------------------------


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
    result: T | None = _KEPT.get((make, *key))
    if result is None:
        with _LOCK:
            result = _KEPT.get((make, *key)) or make(*key)
            _KEPT[make, *key] = result
    return result
