"""Quantities over some axes of a grid, by one kernel: a step of a plan.

Which kernel answers a request depends on its inputs (all designs have wide margins, some angle is huge, an
input is 0). So it is chosen once, from all of the inputs, and every block takes it, even a block of one
point: cutting a grid changes no digit.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.own import Definition, using
from ..runtime.kernels import KernelKey, key_of
from ..runtime.request import Request, request
from .arrays import Loops, copied_back, dtype_of, fill, outputs_for, scratch_for
from .axes import Outer, require_inputs
from .labels import Output, attributes
from .under_loads.columns import MOTION, plan_at, require_angle, totals_at
from .under_loads.request import UnderLoads, made_by, under_loads

Array = NDArray[Any]


class Points(NamedTuple):
    """The values of names over some dimensions; without arrays, so that it pickles small.

    dims     the dimensions of the outputs, in their order
    wanted   what the kernel gives, in the order of its outputs: the names, and their slopes by loads
    numbers  the inputs that are numbers here
    key      the kernel of all blocks
    branch   the assembly
    loads    the names under loads that vary with the motion; derivatives are total ones then
    """

    dims: tuple[str, ...]
    wanted: Request
    numbers: tuple[tuple[str, float], ...]
    key: KernelKey
    branch: int
    loads: UnderLoads | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The names, as the user says them."""
        return self.wanted.shown if self.loads is None else self.loads.plan.shown

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the step needs."""
        return self.dims

    @property
    def inputs(self) -> tuple[str, ...]:
        """The inputs of the kernel, and those that its loads depend on."""
        return self.wanted.inputs if self.loads is None else self.loads.inputs

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
        loads = () if self.loads is None else self.loads.plan.loads.values()
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
        return copied_back(places, buffers, False)

    def at(self, points: Mapping[str, Array]) -> dict[str, Array]:
        """The values under loads at points, whose inputs are columns of one length."""
        assert self.loads is not None
        numbers = {**dict(self.numbers), **points}
        given = {**dict.fromkeys(MOTION), **numbers}
        with using(self.own):
            return totals_at(self.loads.plan, given, numbers, self.branch, self.wanted.accuracy, 1)

    def _fill(self, values: Mapping[str, Array], outs: Sequence[Array], threads: int | None) -> None:
        """Fill outputs of a block."""
        columns = {name: np.ascontiguousarray(values[name]) for name in self.dims if name in self.inputs}
        scalars = {name: value for name, value in self.numbers if name in self.inputs}
        places = {name: self.dims.index(name) for name in columns}
        loops = Loops(tuple(values[name].size for name in self.dims) or (1,), columns, places)
        if self.loads is None:
            fill(self.wanted, scalars, loops, outs, threads, self.key)
        else:
            self.loads.fill(scalars, loops, outs, threads, self.key)


def points_of(
    names: Sequence[str],
    outer: Outer,
    along: Sequence[str],
    branch: int,
    accuracy: Any,
) -> Points:
    """The step of names over dimensions of a grid, checked; TypeError for what is missing."""
    given, axes = outer.given, outer.axes
    plan = plan_at(names, outer.loads, axes) if outer.loads else None
    if plan is None or not plan.loads:
        wanted = request(names, given, branch, accuracy)
        require_inputs(wanted, {*axes, *outer.loads})
        scalars, loops = _arguments(wanted.inputs, outer, along)
        key = key_of(wanted, scalars, loops.columns, loops.axis_of, len(loops.sizes))
        return Points(tuple(along), wanted, tuple(scalars.items()), key, int(branch))
    require_angle(plan, axes)
    loads = under_loads(plan, given, branch, accuracy)
    missing = loads.wanted._replace(shown=plan.shown)
    require_inputs(missing, {*axes, *made_by(plan.loads)})
    scalars, loops = _arguments(loads.inputs, outer, along)
    return Points(
        tuple(along), loads.wanted, tuple(scalars.items()), loads.key(scalars, loops), int(branch), loads
    )


def _arguments(names: Sequence[str], outer: Outer, along: Sequence[str]) -> tuple[dict[str, float], Loops]:
    """The inputs of these names: numbers, and columns along dimensions."""
    own = {name: outer.axes[name] for name in dict.fromkeys(names) if name in outer.axes}
    scalars = {n: float(axis.reshape(-1)[0]) for n, axis in own.items() if n not in along and axis.size}
    columns = {n: np.ascontiguousarray(axis) for n, axis in own.items() if n in along}
    sizes = tuple(outer.axes[name].size for name in along) or (1,)
    return scalars, Loops(sizes, columns, {name: along.index(name) for name in columns})
