"""The blocks of a grid: each runs the kernel of the whole, so that cutting a grid changes no digit.

Which kernel answers a request depends on its inputs (all designs have wide margins, some angle is huge, an
input is 0), and points in plain Python may differ from a kernel in the last bit. So the kernel is chosen
once, from all of the inputs, and every block takes it, even a block of one point.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.numba.reductions import EXTREMES, outputs_of
from ..mechanism.names import LENGTHS
from ..mechanism.own import Definition
from ..runtime.compiled_only import compiled_only
from ..runtime.kernels import KernelKey, key_of
from ..runtime.point import point_of
from ..runtime.request import Request, request
from ..runtime.threads import run_in_blocks
from .arrays import dtype_of
from .outer import Outer, first_joined, join_from, require_inputs
from .reduce import fill_reduced, named_by_reduction
from .reductions import Reduction
from .sources import Source, source_of

Array = NDArray[Any]


class Part(NamedTuple):
    """The names of a grid that one kernel computes; without arrays, so that it pickles small.

    names      as the user says them, in the order of the kernel's outputs
    dims       the dimensions of the outputs, in their order
    key        the kernel of the whole grid
    scalars    the inputs that are numbers
    joined     the first of the last dimensions that the kernel runs over as one
    reduction  what is taken of which axis, if the grid is reduced
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    key: KernelKey
    scalars: tuple[tuple[str, float], ...]
    joined: int
    reduction: Reduction | None = None

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.key.form.own

    @property
    def outputs(self) -> dict[str, np.dtype[Any]]:
        """The names of the outputs and their dtypes."""
        if self.reduction is None:
            return {name: dtype_of(name) for name in self.names}
        found: dict[str, np.dtype[Any]] = {}
        for name in self.names:
            for kind in self.reduction.kinds:
                found[f"{name}_{kind}"] = np.dtype(np.float64)
                if kind in EXTREMES:
                    found[f"{name}_{kind}_{self.reduction.axis}"] = np.dtype(np.float64)
            found[f"{name}_skipped"] = np.dtype(np.int64)
        return found

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the part needs."""
        return self.dims if self.reduction is None else (*self.dims, self.reduction.axis)

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its `axes`."""
        with compiled_only():
            if self.reduction is None:
                return _compute(self, values, threads)
            return _compute_reduced(self, self.reduction, values, threads)


class LoadedPart(NamedTuple):
    """The names of a grid under loads that vary with the motion.

    Its kernel is chosen block by block, so that the last digit may depend on the blocks.
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    source: Source
    reduction: None = None

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.source.wanted.form.own

    @property
    def outputs(self) -> dict[str, np.dtype[Any]]:
        """The outputs by name, and their types."""
        return {name: dtype_of(name) for name in self.names}

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the part needs."""
        return self.dims

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its `axes`."""
        with compiled_only():
            return self.source.values({name: values[name] for name in self.dims}, self.dims, threads)


def grid_parts(
    outer: Outer, branch: int, accuracy: Any, block: Mapping[str, int]
) -> tuple[Part | LoadedPart, ...]:
    """The parts of a grid that is cut into blocks of these lengths."""
    (names, along), *margin = outer.groups()
    if not outer.loads:
        first: Part | LoadedPart = _part(
            request(names, outer.given, branch, accuracy), outer.axes, along, block
        )
    else:
        source = source_of(names, outer.given, outer.axes, outer.loads, branch, accuracy)
        first = LoadedPart(tuple(names), tuple(along), source)
    return first, *(
        _part(request(own, outer.given, branch, accuracy), outer.axes, along, block) for own, along in margin
    )


def reduced_parts(
    outer: Outer, branch: int, accuracy: Any, reduction: Reduction, block: Mapping[str, int]
) -> tuple[Part, ...]:
    """The part of a reduced grid, and that of its margin where all lengths are given."""
    wanted = request(outer.names, outer.given, branch, accuracy)
    require_inputs(wanted, outer.axes)
    rest = tuple(name for name in outer.dimensions if name != reduction.axis)
    order = [*(rest or ("",)), reduction.axis]
    scalars, columns = _inputs(wanted, outer.axes, order)
    places = {name: order.index(name) for name in columns}
    key = key_of(wanted, scalars, columns, places, len(order))._replace(reduce=reduction.kinds)
    part = Part(wanted.shown, rest, key, tuple(scalars.items()), len(order) - 1, reduction)
    return part, *margin_parts(outer, branch, accuracy, block, (reduction.axis,))


def margin_parts(
    outer: Outer, branch: int, accuracy: Any, block: Mapping[str, int], reduced: Sequence[str] = ()
) -> tuple[Part, ...]:
    """The part of the margin, if all lengths are given and none of them is reduced."""
    if not all(name in outer.axes and name not in reduced for name in LENGTHS):
        return ()
    wanted = request(["margin"], outer.given, branch, accuracy)
    return (_part(wanted, outer.axes, outer.lengths, block),)


def _part(wanted: Request, axes: Mapping[str, Array], along: Sequence[str], block: Mapping[str, int]) -> Part:
    require_inputs(wanted, axes)
    order = list(along) or [""]
    scalars, columns = _inputs(wanted, axes, order)
    places = {name: order.index(name) for name in columns}
    first = first_joined(order, tuple(block[name] for name in along) or (1,))
    key = key_of(wanted, scalars, columns, places, len(order))
    joined = tuple((name, min(axis, first)) for name, axis in key.axis_of)
    key = key._replace(axis_of=joined, axes=first + 1)
    return Part(wanted.shown, tuple(along), key, tuple(scalars.items()), first)


def _inputs(
    wanted: Request, axes: Mapping[str, Array], order: Sequence[str]
) -> tuple[dict[str, float], dict[str, Array]]:
    """The numbers and the columns of a request."""
    scalars = {name: float(axes[name].reshape(-1)[0]) for name in wanted.inputs if name not in order}
    return scalars, {name: np.ascontiguousarray(axes[name]) for name in wanted.inputs if name in order}


def _compute(part: Part, values: Mapping[str, Array], threads: int | None) -> dict[str, Array]:
    shape = tuple(values[name].size for name in part.dims)
    outs = {name: np.empty(shape, dtype) for name, dtype in part.outputs.items()}
    order = list(part.dims) or [""]
    columns = {name: np.ascontiguousarray(values[name]) for name, _ in part.key.axis_of}
    places = {name: order.index(name) for name in columns}
    scalars = dict(part.scalars)
    if not columns:
        point = point_of(part.key.names, part.key.form, part.key.fixed, part.key.accuracy)
        for out, value in zip(outs.values(), point.run(scalars), strict=True):
            out[...] = value
    elif all(shape):
        sizes = join_from(part.joined, columns, places, shape)
        run_in_blocks(
            part.key, {**scalars, **columns}, [out.reshape(sizes) for out in outs.values()], threads
        )
    return outs


def _compute_reduced(
    part: Part, reduction: Reduction, values: Mapping[str, Array], threads: int | None
) -> dict[str, Array]:
    shape = tuple(values[name].size for name in part.dims)
    axis = values[reduction.axis]
    outs = {name: np.empty(shape or (1,), kind) for name, kind in outputs_of(part.names, reduction.kinds)}
    if all(shape):
        columns = {name: np.ascontiguousarray(values[name]) for name, _ in part.key.axis_of}
        fill_reduced(part.key, {**dict(part.scalars), **columns}, axis.size, list(outs.values()), threads)
    arrays = {name: out if shape else out.reshape(()) for name, out in outs.items()}
    return {
        name: array
        for name, (_, array) in named_by_reduction(arrays, part.names, reduction, axis, part.dims).items()
    }
