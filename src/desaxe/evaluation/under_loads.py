"""Names under loads that vary with the motion, as one request.

Its variant names the loads, never their content: tables are arguments of a kernel, or of a point's function,
which looks them up and gives total derivatives; of a Python function the values at the angles are.
"""

from collections.abc import Container, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from ..loads.along_motion import SPEEDS, OfMotion
from ..loads.function import naming
from ..loads.lines import lines_of, tables_of, totals_of
from ..loads.load import Load, OverTheta, TableOverTheta, ahead
from ..loads.resolve import LoadPlan, plan_of, split, way_of
from ..mechanism.load_lines import LoadLines, TurningSense, Under
from ..mechanism.names import LENGTHS, STATUS
from ..mechanism.own import Register
from ..runtime.point import point_of
from ..runtime.request import Request, request
from ..support.lazy import np

UnderLoads = tuple[Request, tuple[str, ...], "LoadInputs | None"]  # a request, its caller's inputs, others
MOTION = ("theta", *LENGTHS, "omega0", "alpha", "omega")  # inputs that every request has, if only as None


class LoadInputs(NamedTuple):
    """The inputs of a request that follow from loads.

    loads      those that vary with the motion
    functions  the inputs that are values or derivatives of Python functions and of loads over the motion
    motion     the request of the columns of the motion that these need, and of their derivatives
    """

    loads: Mapping[str, Load]
    functions: tuple[str, ...]
    motion: Request | None = None

    def at_point(self, numbers: Mapping[str, float]) -> dict[str, Any]:
        """All inputs at a point, from those of the caller; tables are lists, which need no NumPy."""
        motion: Mapping[str, float] = {}
        if self.motion is not None:
            motion = dict(zip(self.motion.shown, point_of(*self.motion.key).run(numbers), strict=True))
        return {**numbers, **self.tables(arrays=False), **self.at(numbers, motion)}

    def tables(self, arrays: bool = True) -> dict[str, Any]:
        """The arrays and numbers of tables, by the names of a kernel's inputs."""
        result: dict[str, Any] = {}
        every = [one for item in self.loads.items() for one in tables_of(*item).items()]
        for name, load in every:
            result[f"{name}_x"], result[f"{name}_c"] = load.columns if arrays else load.lists
            if isinstance(load, TableOverTheta):
                result |= {f"{name}_first": load.table.knots[0], f"{name}_period": load.period}
        return result

    def at(
        self, inputs: Mapping[str, Any], motion: Mapping[str, Any] = MappingProxyType({})
    ) -> dict[str, Any]:
        """The values and derivatives of loads that are no tables, from inputs, and the motion there."""
        result: dict[str, Any] = {}
        theta = inputs["theta"]
        for name in self.loads if self.functions else ():
            load = self.loads[name]
            if isinstance(load, OfMotion) and self.motion is not None and not tables_of(name, load):
                result |= self._of_motion(name, load, {**motion, "theta": theta}, inputs)
            elif name in self.functions or f"{name}_by_theta" in self.functions:
                assert isinstance(load, OverTheta)
                with naming(name):
                    value, slope = load.both(theta)
                result |= {name: _finite_or_zero(value), f"{name}_by_theta": slope}
        return {name: value for name, value in result.items() if name in self.functions}

    def _of_motion(
        self, name: str, load: OfMotion, motion: Mapping[str, Any], inputs: Mapping[str, Any]
    ) -> dict[str, Any]:
        """A load over columns of the motion, and its derivatives with respect to the needed parameters."""
        way = ahead(motion, way_of(inputs)) if load.has_ways else 1.0
        with naming(name):
            value, by = load.partials({**motion, "way": way})
        by_name = f"{name}_by_"
        needed = [one.removeprefix(by_name) for one in self.functions if one.startswith(by_name)]
        return {name: _finite_or_zero(value), **{by_name + p: load.total(by, p, motion) for p in needed}}


def request_under(
    names: Sequence[str],
    numbers: Mapping[str, Any],
    loads: Mapping[str, Load],
    branch: int,
    accuracy: Any,
    known: Register | None = None,
) -> UnderLoads:
    """The request of names from inputs that are present, and from loads; TypeError without an angle.

    known   the definitions that names have; those of this process at this moment without
    """
    plan = plan_at(names, loads, {n for n, value in numbers.items() if value is not None})
    if not plan.loads:
        asked = request(names, numbers, branch, accuracy, known)
        return asked, asked.inputs, None
    if numbers.get("theta") is None:
        varying = " and ".join(plan.loads)
        raise TypeError(f"{', '.join(plan.shown)}: theta, over which {varying} varies, is missing")
    return totals_under(plan, numbers, branch, accuracy, known)


def plan_at(names: Sequence[str], loads: Mapping[str, Load], inputs: Container[str]) -> LoadPlan:
    """The plan for names under loads; without an angle, a status has no friction and no load."""
    at_angle = "theta" in inputs
    loads = loads if at_angle or tuple(names) != (STATUS,) else {}
    return plan_of(names, loads, "omega" in inputs, "mu" in inputs and at_angle)


def plan_for(names: Sequence[str], inputs: Mapping[str, Any]) -> tuple[dict[str, Any], LoadPlan]:
    """The inputs that are numbers, and the plan for names under the loads that are not."""
    numbers, loads = split({name: value for name, value in inputs.items() if value is not None})
    return numbers, plan_at(names, loads, numbers)


def totals_under(
    plan: LoadPlan, inputs: Mapping[str, Any], branch: int, accuracy: Any, known: Register | None = None
) -> UnderLoads:
    """The request of a plan's totals."""
    every = tuple(dict.fromkeys((*plan.names, *plan.motion)))
    asked = request(every, {**inputs, **dict.fromkeys(plan.loads, 1.0)}, branch, accuracy, known)
    names = dict(zip(asked.shown, asked.names, strict=True))
    lines = tuple(_lines(name, load) for name, load in plan.loads.items())
    under = Under(tuple(names.items()), lines, totals_of(plan), _sense(inputs))
    own = tuple(names[name] for name in plan.shown)
    asked = asked._replace(shown=plan.shown, names=own, form=asked.form._replace(under=under))
    by = {f"{term.force}_by_{term.parameter}" for group in plan.terms.values() for term in group}
    motion = None
    if plan.of_motion:
        needed = (*LENGTHS, *SPEEDS) if plan.follows_speed else LENGTHS
        at = {**dict.fromkeys(MOTION), **{name: inputs.get(name) for name in needed}, "theta": 1.0}
        motion = request(plan.of_motion, at, branch, "standard", known)
    more = () if motion is None else motion.inputs
    forces = [*plan.loads, *(part for item in plan.loads.items() for part in tables_of(*item))]
    made = by | {f"{load}{end}" for load in forces for end in ("", "_first", "_period")}
    taken = {*asked.inputs, "theta", *more} - made
    own = tuple(name for name in dict.fromkeys((*inputs, *asked.inputs, *more)) if name in taken)
    functions = tuple(name for name in asked.inputs if name in by or name in plan.loads)
    return asked, own, LoadInputs(plan.loads, functions, motion)


def _lines(name: str, load: Load) -> LoadLines:
    """The lines of a load; the bounds of a table over theta are inputs."""
    lines = lines_of(name, load)
    return _with_inputs(lines)._replace(parts=tuple(map(_with_inputs, lines.parts)))


def _with_inputs(lines: LoadLines) -> LoadLines:
    if lines.over != "theta":
        return lines
    return lines._replace(period=f"{lines.force}_period", first=f"{lines.force}_first")


def _sense(inputs: Mapping[str, Any]) -> TurningSense:
    """The inputs that tell the sense in which the crank turns."""
    speeds = [name for name in ("omega", "omega0") if inputs.get(name) is not None]
    start = "alpha" if speeds == ["omega"] and inputs.get("alpha") is not None else 0.0
    return TurningSense(speeds[0] if speeds else 1.0, start)


def _finite_or_zero(value: Any) -> Any:
    """The load with NaN replaced by 0: a point without motion has NaN and a status of its own."""
    if isinstance(value, float):
        return value if value - value == 0.0 else 0.0
    return np.nan_to_num(value, nan=0.0, posinf=0.0, neginf=0.0)
