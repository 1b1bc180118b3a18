"""Checked requests that compute the values of a block of a grid, with or without loads over the motion.

A source has no arrays and carries what it knows of own quantities, so that it can travel to a worker.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.load import Load
from ..loads.pieces import Place
from ..loads.resolve import Plan, plan_of, way_of
from ..mechanism.names import LENGTHS
from ..runtime.request import Request, request
from .arrays import dtype_of, fill
from .filled import filled_grid
from .loops import loops_over
from .outer import require_inputs

Array = NDArray[Any]
Numbers = tuple[tuple[str, float], ...]


class Plain(NamedTuple):
    """A request of numbers and axes."""

    wanted: Request
    numbers: Numbers

    @property
    def accuracy(self) -> str:
        """The accuracy that is kept."""
        return self.wanted.accuracy

    def axes(self, columns: Mapping[str, Array]) -> dict[str, Array]:
        """All inputs as arrays."""
        return {**{name: np.array(value) for name, value in self.numbers}, **columns}

    def values(
        self, columns: Mapping[str, Array], dims: Sequence[str], threads: int | None
    ) -> dict[str, Array]:
        """The values over the outer product of columns, the dimensions in this order."""
        return filled_grid(self.wanted, self.axes(columns), dims, threads, None)


class Loaded(NamedTuple):
    """A request under loads that vary with the motion; derivatives are total ones."""

    plan: Plan
    wanted: Request
    motion: Request | None
    numbers: Numbers
    branch: int

    @property
    def accuracy(self) -> str:
        """The accuracy that is kept."""
        return self.wanted.accuracy

    def values(
        self, columns: Mapping[str, Array], dims: Sequence[str], threads: int | None
    ) -> dict[str, Array]:
        """The values over the outer product of columns, the dimensions in this order."""
        shape = tuple(columns[name].size for name in dims)
        given: dict[str, Any] = dict(self.numbers)
        for place, name in enumerate(dims):
            own = [-1 if k == place else 1 for k in range(len(dims))]
            given[name] = np.ascontiguousarray(columns[name], np.float64).reshape(own)
        return self._over(given, shape, threads)

    def at(self, points: Mapping[str, Array]) -> dict[str, Array]:
        """The values at points, whose inputs are columns of one length."""
        return self._over({**dict(self.numbers), **points}, points["theta"].shape, 1)

    def _over(
        self, given: Mapping[str, Any], shape: tuple[int, ...], threads: int | None
    ) -> dict[str, Array]:
        """The values at inputs that broadcast to a shape."""
        if not all(shape):
            return {name: np.empty(shape, dtype_of(name)) for name in self.plan.shown}
        motion = {} if self.motion is None else _values(self.motion, given, shape, threads)
        lengths = [given.get(name) for name in LENGTHS]
        place = Place(np.asarray(given["theta"]), lengths, way_of(given), self.branch)
        forces = self.plan.forces(place, motion)
        found = _values(self.wanted, {**given, **forces.values}, shape, threads)
        return {
            name: np.array(np.broadcast_to(total, shape))
            for name, total in self.plan.totals(found, forces).items()
        }


Source = Plain | Loaded


def source_of(
    names: Sequence[str],
    given: Mapping[str, Any],
    axes: Mapping[str, Array],
    loads: Mapping[str, Load],
    branch: int,
    accuracy: Any,
) -> Source:
    """The source of names, from inputs as they were given and as arrays; TypeError for what is missing."""
    numbers = tuple((name, float(array)) for name, array in axes.items() if not array.ndim)
    state = given.get("omega") is not None
    plan = plan_of(names, loads, state, given.get("mu") is not None) if loads else None
    if plan is None or not plan.loads:
        wanted = request(names, given, branch, accuracy)
        require_inputs(wanted, {*axes, *loads})
        return Plain(wanted, numbers)
    if "theta" not in axes:
        raise TypeError(
            f"{', '.join(plan.shown)}: theta, over which {' and '.join(plan.loads)} varies, is missing"
        )
    wanted = request(plan.names, {**given, **dict.fromkeys(plan.loads, 0.0)}, branch, accuracy)
    motion = None
    if plan.motion:
        lengths = {name: given.get(name) for name in ("theta", *LENGTHS)}
        kept = "extended" if wanted.accuracy == "extended" else "standard"
        motion = request(plan.motion, lengths, branch, kept)
        require_inputs(motion, axes)
    require_inputs(wanted, {*axes, *plan.loads})
    return Loaded(plan, wanted, motion, numbers, int(branch))


def _values(
    wanted: Request, given: Mapping[str, Any], shape: tuple[int, ...], threads: int | None
) -> dict[str, Array]:
    """The values of a request at inputs that broadcast to a shape."""
    scalars = {name: float(given[name]) for name in wanted.inputs if np.ndim(given[name]) == 0}
    arrays = {name: np.asarray(given[name]) for name in wanted.inputs if name not in scalars}
    whole = np.broadcast_shapes(*(array.shape for array in arrays.values())) if arrays else ()
    outs = {name: np.empty(whole, dtype_of(name)) for name in wanted.shown}
    fill(wanted, scalars, loops_over(arrays, whole), list(outs.values()), threads)
    return {name: np.broadcast_to(out, shape) for name, out in outs.items()}
