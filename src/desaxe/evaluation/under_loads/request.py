"""Names under loads that vary with the motion, as a request of one kernel.

Its variant names the loads, never their content: tables are arguments of the kernel, which looks them up and
gives total derivatives; of a Python function the values at the angles are. Where rounding may decide on the
side of a jump the kernel says so, and these points are answered again, exactly.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.lines import line_of, totals_of
from ...loads.load import Load, OverY, TableOverTheta
from ...loads.pieces import Place
from ...loads.resolve import LoadPlan
from ...mechanism.load_lines import EDGES, NEAR_JUMP, LoadLines, TurningSense, Under
from ...mechanism.names import LENGTHS
from ...mechanism.own import register
from ...runtime.kernels import KernelKey, key_of
from ...runtime.request import Request, accuracy_of, is_steady, request
from ...support.recent import Recent
from ..arrays import (
    Loops,
    are_good,
    as_array,
    broadcast_shape,
    copied_back,
    fill,
    loops_of,
    outputs_for,
    refuse_other_labels,
    scratch_for,
)
from ..call_cache import planned
from .columns import MOTION, numeric, totals_at, totals_of_columns

Array = NDArray[Any]
MOST_KNOWN = 256  # requests that are remembered


class UnderLoads(NamedTuple):
    """Names under loads by one kernel.

    plan    the loads, and how totals are made
    wanted  the request: its names are those of the totals, and NEAR_JUMP last where a load jumps
    branch  the assembly
    inputs  those that numbers or arrays are needed of
    is_whole   whether the kernel takes all of these
    """

    plan: LoadPlan
    wanted: Request
    branch: int
    inputs: tuple[str, ...]
    is_whole: bool

    def evaluate(self, given: Mapping[str, Any], threads: int | None, out: Any) -> dict[str, Any] | None:
        """The totals over arrays that broadcast by position; None if every input is a number."""
        names = self.plan.shown
        forces = self._functions(given["theta"])
        if out is None and self.is_whole:
            ready = planned(self.wanted, {**given, **forces}, None, threads, table_arrays(self.plan.loads))
            if ready is not None:
                flags = ready.pop(NEAR_JUMP, None)
                self._settle(ready, flags, lambda at: {n: _taken(given.get(n), at) for n in self.inputs})
                return ready
        refuse_other_labels({name: given.get(name) for name in self.inputs})
        arrays = {name: as_array(name, given.get(name), self.inputs, names) for name in self.inputs}
        shape = broadcast_shape(arrays)
        if not shape:
            return None
        places = outputs_for(names, shape, out)
        buffers = places if out is None else scratch_for(places, arrays.values())
        if prod(shape):
            scalars, loops = loops_of({**arrays, **{n: np.asarray(f) for n, f in forces.items()}}, shape)
            self._fill(scalars, loops, list(buffers.values()), threads)
        return copied_back(places, buffers, False)

    def fill(
        self,
        scalars: Mapping[str, float],
        loops: Loops,
        outs: Sequence[Array],
        threads: int | None,
        key: KernelKey,
    ) -> None:
        """Fill contiguous outputs of the totals from scalars and the columns along loops."""
        sizes, columns, axis_of = loops
        if "theta" in columns:
            forces = self._functions(columns["theta"])
            along = Loops(sizes, columns | forces, axis_of | dict.fromkeys(forces, axis_of["theta"]))
            self._fill(scalars, along, outs, threads, key)
        else:
            self._fill({**scalars, **self._functions(scalars["theta"])}, loops, outs, threads, key)

    def _fill(
        self,
        scalars: Mapping[str, Any],
        loops: Loops,
        outs: Sequence[Array],
        threads: int | None,
        key: KernelKey | None = None,
    ) -> None:
        """Fill outputs from the inputs of the kernel."""
        sizes, columns, axis_of = loops
        if not columns:
            for out, value in zip(outs, self._totals(scalars).values(), strict=True):
                out[...] = value
            return
        results = dict(zip(self.plan.shown, (out.reshape(sizes) for out in outs), strict=True))
        flags = np.empty(sizes, np.int8) if NEAR_JUMP in self.wanted.names else None
        every = [*results.values(), *([] if flags is None else [flags])]
        fill(
            self.wanted,
            {**scalars, **table_arrays(self.plan.loads)},
            self._of_kernel(loops),
            every,
            threads,
            key,
        )

        def inputs_at(places: tuple[Array, ...]) -> dict[str, Any]:
            return {n: columns[n][places[axis_of[n]]] if n in columns else scalars[n] for n in self.inputs}

        self._settle(results, flags, inputs_at)

    def _of_kernel(self, loops: Loops) -> Loops:
        """The columns that the kernel takes."""
        inputs = self.wanted.inputs
        own = {name: column for name, column in loops.columns.items() if name in inputs}
        return Loops(loops.sizes, own, {name: loops.axis_of[name] for name in own})

    def key(self, scalars: Mapping[str, float], loops: Loops) -> KernelKey:
        """The kernel of all points along loops."""
        sizes, columns, axis_of = loops
        if "theta" in columns:  # the values of functions are along it
            made = made_by(self._python_functions)
            columns = columns | dict.fromkeys(made, columns["theta"])
            axis_of = axis_of | dict.fromkeys(made, axis_of["theta"])
        own = self._of_kernel(Loops(sizes, columns, axis_of))
        numbers = {name: value for name, value in scalars.items() if name in self.wanted.inputs}
        return key_of(self.wanted, numbers, own.columns, own.axis_of, len(sizes))

    @property
    def _python_functions(self) -> dict[str, Load]:
        return {n: a for n, a in self.plan.loads.items() if not isinstance(a, (TableOverTheta, OverY))}

    def _functions(self, theta: Any) -> dict[str, Any]:
        """The values and derivatives of Python functions, by the names of the kernel's inputs."""
        functions = self._python_functions
        if not functions:
            return {}
        theta = numeric("theta", theta, self.plan.shown)
        forces = self.plan._replace(loads=functions).forces(Place(theta, (), 1.0, self.branch), {})
        slopes = {f"{force}_by_{p}": slope for (force, p), slope in forces.slopes.items()}
        return {name: value for name, value in (forces.values | slopes).items() if name in self.wanted.inputs}

    def _settle(
        self,
        results: Mapping[str, Array],
        flags: Array | None,
        inputs_at: Callable[[tuple[Array, ...]], Mapping[str, Any]],
    ) -> None:
        """Answer points at which rounding may decide on the side of a jump, exactly."""
        if flags is None or not flags.any():
            return
        flat = flags.reshape(-1)
        marked = np.flatnonzero(flat.view(np.bool_))
        marked = marked[flat[marked] == 1]
        points = {n: x for n, x in inputs_at(np.unravel_index(marked, flags.shape)).items() if x is not None}
        columns = {n: column for n, column in points.items() if np.ndim(column)}
        good = np.logical_and.reduce([are_good(n, column) for n, column in columns.items()])
        if good.any():
            points |= {n: column[good] for n, column in columns.items()}
            places = np.unravel_index(marked[good], flags.shape)
            points |= {"theta": np.broadcast_to(points["theta"], places[0].shape)}
            exact = totals_of_columns(self.plan, points, self.branch, self.wanted.accuracy)
            for name, values_ in exact.items():
                results[name][places] = values_

    def _totals(self, points: Mapping[str, Any]) -> dict[str, Any]:
        numbers = {name: value for name, value in points.items() if name in self.inputs and value is not None}
        given = {**dict.fromkeys(MOTION), **numbers}
        return totals_at(self.plan, given, numbers, self.branch, self.wanted.accuracy, 1)


_KNOWN: Recent[Any, tuple[Request, tuple[str, ...], bool]] = Recent(MOST_KNOWN)


def under_loads(plan: LoadPlan, given: Mapping[str, Any], branch: int, accuracy: Any) -> UnderLoads:
    """The request of a plan's totals."""
    lines = tuple(_lines(name, load) for name, load in plan.loads.items())
    present = tuple(name for name, value in given.items() if value is not None)
    sort = is_steady(given.get("alpha")), branch, accuracy_of(accuracy), _has_sides(plan), register()
    key = plan.shown, lines, present, *sort
    known = _KNOWN.get(key)
    if known is None:
        known = _KNOWN[key] = _new_request(plan, lines, given, branch, accuracy)
    wanted, inputs, is_whole = known
    return UnderLoads(plan, wanted, branch, inputs, is_whole)


def _new_request(
    plan: LoadPlan, lines: tuple[LoadLines, ...], given: Mapping[str, Any], branch: int, accuracy: Any
) -> tuple[Request, tuple[str, ...], bool]:
    every = tuple(dict.fromkeys((*plan.names, *plan.motion)))
    asked = request(every, {**given, **dict.fromkeys(plan.loads, 1.0)}, branch, accuracy)
    names = dict(zip(asked.shown, asked.names, strict=True))
    under = Under(tuple(names.items()), lines, totals_of(plan), _sense(given))
    flags = [NEAR_JUMP] if any(line.jumps for line in lines) else []
    own = *(names[name] for name in plan.shown), *flags
    wanted = Request(
        (*plan.shown, *flags), own, asked.form._replace(under=under), asked.fixed, asked.accuracy
    )
    made = made_by(plan.loads)
    lengths = LENGTHS if plan.motion else ()
    speeds = [name for name in under.way if isinstance(name, str)] if _has_sides(plan) else []
    inputs = dict.fromkeys((*wanted.inputs, "theta", *lengths, *speeds))
    return wanted, tuple(name for name in inputs if name not in made), {*inputs} <= {*wanted.inputs}


def made_by(loads: Iterable[str]) -> set[str]:
    """The inputs of a kernel that are numbers or columns of loads."""
    ends = "", "_by_theta", "_first", "_period"
    return {f"{load}{end}" for load in loads for end in ends}


def _has_sides(plan: LoadPlan) -> bool:
    """True if the sense of turning decides on a load."""
    every = [load for load in plan.loads.values() if isinstance(load, OverY)]
    return any(load.inward is not None or load.outward.jumps_at_points for load in every)


def _lines(name: str, load: Load) -> LoadLines:
    """The lines of a load; the bounds of a table over theta are inputs."""
    lines = line_of(name, load)
    if lines.over == "theta":
        return lines._replace(period=f"{name}_period", first=f"{name}_first")
    return lines


def _sense(given: Mapping[str, Any]) -> TurningSense:
    """The inputs that tell the sense in which the crank turns."""
    speeds = [name for name in ("omega", "omega0") if given.get(name) is not None]
    start = "alpha" if speeds == ["omega"] and given.get("alpha") is not None else 0.0
    return TurningSense(speeds[0] if speeds else 1.0, start)


def table_arrays(loads: Mapping[str, Load]) -> dict[str, Any]:
    """The arrays and numbers of tables, by the names of a kernel's inputs."""
    result: dict[str, Any] = {}
    for name, load in loads.items():
        if isinstance(load, (TableOverTheta, OverY)):
            result[f"{name}_x"], result[f"{name}_c"] = load.columns
        if isinstance(load, TableOverTheta):
            result |= {f"{name}_first": load.table.knots[0], f"{name}_period": load.period}
        elif isinstance(load, OverY) and load.jumping:
            result |= {f"{name}{EDGES}_x": result[f"{name}_x"], f"{name}{EDGES}_c": load.edge_rows}
    return result


def _taken(value: Any, places: Any) -> Any:
    """The values of an input at places of a whole array."""
    return value[places] if np.ndim(value) else value
