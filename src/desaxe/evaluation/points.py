"""Quantities over some axes of a grid, by one kernel: a step of a plan.

Which kernel answers a request depends on its inputs (all designs have wide margins, some angle is huge, an
input is 0). So it is chosen once, from all of the inputs, and every block takes it, even a block of one
point: cutting a grid changes no digit.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.load import Load, OverTheta, OverY
from ..loads.pieces import Place
from ..loads.resolve import Forces, LoadPlan, way_of
from ..mechanism.names import LENGTHS
from ..mechanism.own import Definition, using
from ..runtime.kernels import KernelKey, key_of
from ..runtime.request import Request, request
from ..runtime.threads import run_in_blocks
from .arrays import copied_back, dtype_of, fill, outputs_for, scratch_for
from .axes import Outer, require_inputs
from .labels import Output, attributes
from .loops import Loops, spread
from .under_loads.kernel import UnderLoads, in_kernel
from .under_loads.loaded import MOTION, plan_at, totals_at

Array = NDArray[Any]


class Points(NamedTuple):
    """The values of names over some dimensions; without arrays, so that it pickles small.

    dims     the dimensions of the outputs, in their order
    wanted   what the kernel gives, in the order of its outputs: the names, and their slopes by loads
    numbers  the inputs that are numbers here
    key      the kernel of all blocks
    branch   the assembly
    loads    the plan of loads that vary with the motion; derivatives are total ones then
    motion   the values of the motion that these loads follow
    inside   the kernel that has the loads in it, where one does
    """

    dims: tuple[str, ...]
    wanted: Request
    numbers: tuple[tuple[str, float], ...]
    key: KernelKey
    branch: int
    loads: LoadPlan | None = None
    motion: "Points | None" = None
    inside: UnderLoads | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The names, as the user says them."""
        return self.wanted.shown if self.loads is None else self.loads.shown

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the step needs."""
        return self.dims

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
        if self.loads is None:
            buffers = places if out is None else scratch_for(places, values.values())
            self._fill(values, list(buffers.values()), None, threads)
            return copied_back(places, buffers, False)
        if self.inside is not None and all(shape):
            buffers = places if out is None else scratch_for(places, values.values())
            self.fill_inside(values, list(buffers.values()), threads)
            return copied_back(places, buffers, False)
        found = {name: np.empty(shape, dtype_of(name)) for name in self.wanted.shown}
        forces = self._forces(values, threads)
        self._fill(values, list(found.values()), forces, threads)
        for name, total in self.loads.totals(found, forces).items():
            np.copyto(places[name], total, casting="same_kind")
        return places

    def at(self, points: Mapping[str, Array]) -> dict[str, Array]:
        """The values under loads at points, whose inputs are columns of one length."""
        assert self.loads is not None
        numbers = {**dict(self.numbers), **points}
        given = {**dict.fromkeys(MOTION), **numbers}
        with using(self.own):
            return totals_at(self.loads, given, numbers, self.branch, self.wanted.accuracy, 1)

    @property
    def _flat(self) -> bool:
        """True where loads differ from point to point: one loop goes over all of them."""
        loads = {} if self.loads is None else self.loads.loads
        return bool(self.dims) and any(isinstance(load, OverY) for load in loads.values())

    def _place(self, name: str) -> int:
        """The axis along which an input varies, a load that varies with the motion along that of theta."""
        loads = {} if self.loads is None else self.loads.loads
        if isinstance(loads.get(name), OverY):
            return 0
        return self.dims.index("theta" if name in loads else name)

    def _fill(
        self, values: Mapping[str, Array], outs: Sequence[Array], forces: Forces | None, threads: int | None
    ) -> None:
        """Fill the outputs of the kernel."""
        shape = outs[0].shape
        if not all(shape):
            return
        inputs, varying = self.wanted.inputs, [name for name, _ in self.key.axis_of]
        every = {} if forces is None else forces.values
        loads = {name: value for name, value in every.items() if name in inputs}
        columns = {name: np.ascontiguousarray(values[name]) for name in varying if name not in loads}
        scalars = {name: value for name, value in self.numbers if name in inputs}
        whole: dict[str, Array] = {}
        for name, value in loads.items():
            if name not in varying:
                scalars[name] = float(value)
            elif self._flat and np.size(value) > 1:
                whole[name] = np.ascontiguousarray(np.broadcast_to(value, shape)).reshape(-1)
            else:
                columns[name] = np.ascontiguousarray(value).reshape(-1)
        places = {name: self._place(name) for name in columns}
        sizes = shape or (1,)
        if self._flat:
            columns = {name: spread(column, places[name], shape) for name, column in columns.items()} | whole
            sizes, places = (prod(shape),), dict.fromkeys(columns, 0)
        loops = Loops(sizes, columns, places)
        fill(self.wanted, scalars, loops, outs, threads, self.key)

    def fill_inside(self, values: Mapping[str, Array], outs: Sequence[Array], threads: int | None) -> None:
        """Fill the outputs by the kernel that has the loads in it; what rounding leaves open, exactly."""
        assert self.inside is not None
        run_in_blocks(self.inside.key, self.inside.arguments(values), outs, threads)
        for region, found in self.inside.settled(values):
            for out, new in zip(outs, found, strict=True):
                out[region] = new

    def _forces(self, values: Mapping[str, Array], threads: int | None) -> Forces:
        """The loads at the points of a block, and their derivatives, in shapes that broadcast to its own."""
        assert self.loads is not None
        given: dict[str, Any] = dict(self.numbers)
        for name in self.dims:
            given[name] = self._spread(np.ascontiguousarray(values[name]), (name,))
        motion = {}
        if self.motion is not None:
            found = self.motion.compute(values, threads)
            motion = {name: self._spread(array, self.motion.dims) for name, array in found.items()}
        lengths = [given.get(name) for name in LENGTHS]
        place = Place(np.asarray(given["theta"]), lengths, way_of(given), self.branch)
        return self.loads.forces(place, motion)

    def _spread(self, array: Array, along: Sequence[str]) -> Array:
        """An array over some of the dimensions, in the order of all."""
        sizes = dict(zip(along, array.shape, strict=True))
        return array.reshape([sizes.get(name, 1) for name in self.dims])


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
        return _keyed(wanted, outer, along, branch)
    if "theta" not in axes:
        varying = " and ".join(plan.loads)
        raise TypeError(f"{', '.join(plan.shown)}: theta, over which {varying} varies, is missing")
    wanted = request(plan.names, {**given, **dict.fromkeys(plan.loads, 0.0)}, branch, accuracy)
    motion = _motion_of(plan, wanted, outer, along, branch) if plan.motion else None
    require_inputs(wanted, {*axes, *plan.loads})
    step = _keyed(wanted, outer, along, branch, plan, motion)
    return step._replace(inside=in_kernel(plan, outer, along, branch, wanted.accuracy))


def _motion_of(plan: LoadPlan, wanted: Request, outer: Outer, along: Sequence[str], branch: int) -> Points:
    """The values of the motion that loads follow, over those of the dimensions that they have."""
    lengths = {name: outer.given.get(name) for name in ("theta", *LENGTHS)}
    kept = "extended" if wanted.accuracy == "extended" else "standard"
    asked = request(plan.motion, lengths, branch, kept)
    require_inputs(asked, outer.axes)
    return _keyed(asked, outer, [name for name in along if name in asked.inputs], branch)


def _keyed(
    wanted: Request,
    outer: Outer,
    along: Sequence[str],
    branch: int,
    plan: LoadPlan | None = None,
    motion: Points | None = None,
) -> Points:
    """The step of a request, with the kernel that all of the inputs need."""
    loads: Mapping[str, Load] = {} if plan is None else plan.loads
    inputs = wanted.inputs
    needed: Iterable[str] = outer.axes if loads else inputs
    alone = [name for name in needed if name not in along and name not in loads]
    numbers = {name: float(outer.axes[name].reshape(-1)[0]) for name in alone if outer.axes[name].size}
    columns = {name: np.ascontiguousarray(outer.axes[name]) for name in inputs if name in along}
    places = {name: along.index(name) for name in columns}
    for name, load in loads.items():
        if name in inputs and along and (not isinstance(load, OverTheta) or "theta" in along):
            places[name] = along.index("theta") if isinstance(load, OverTheta) else 0
            columns[name] = outer.axes[along[places[name]]]  # of its length
    scalars = {name: value for name, value in numbers.items() if name in inputs}
    key = key_of(wanted, scalars, columns, places, max(1, len(along)))
    step = Points(tuple(along), wanted, tuple(numbers.items()), key, int(branch), plan, motion)
    if not step._flat:
        return step
    return step._replace(key=key._replace(axis_of=tuple((name, 0) for name, _ in key.axis_of), axes=1))
