"""The plan of a scene: the operations of each loop, the skipped lines with reasons, the cost."""

import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import prod
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from ...compiler.kernel import Kernel
from ...compiler.passes.double_double import double_double
from ...evaluation.plan import Plan
from ...loads.load import Load
from ...loads.words import brief
from ...mechanism.catalogue import quantity
from ...mechanism.constants import double_constants
from ...mechanism.keywords import with_known_keywords
from ...mechanism.names import STATUSES
from ...mechanism.own import using
from ...mechanism.program import digest
from ...mechanism.quantity_units import UnitSystem
from ...runtime.executor import is_ready
from ...runtime.kernels import KernelKey, kernel_of
from ...runtime.left_over import has_large_angles
from ...runtime.request import Request
from ...runtime.specialise import specialise
from ...runtime.threads import LEAST_BLOCK, available
from ...support.forks import IMPORTS
from ...sweeps.request import sweep_of
from ..content import Content
from ..parts.grid import plan_of_grid
from ..parts.stored import request_of
from ..reading.values import Value
from ..scene import Scene
from ..scene import scene as scene_of
from .loads import load_costs, points_of
from .loops import LoopCost, loops_of
from .steps import skipped_of, steps_of

PROMISES = {
    "standard": "at most 8 ulp x (1 + the sum of the condition numbers), wherever it can be assembled",
    "extended": "2 ulp, but for the last double inside a limit angle, with a floor of 2^-96 of the scale",
}


class GridKernel(NamedTuple):
    """The kernel of a scene's grid: its request, its axes in loop order, its key."""

    request: Request
    axes: tuple[str, ...]
    sizes: tuple[int, ...]
    key: KernelKey

    @property
    def points(self) -> int:
        """Points of the grid."""
        return prod(self.sizes)


@dataclass(frozen=True)
class RunPlan:
    """A plan as data (`plan["loops"]`, `plan.as_dict()`); printed, it is text.

    Keys: `title, outputs, accuracy, promise, motion, inputs, points, designs, steps` (operations at each
    point after every pass), `skipped, loops, operations` (at each point, in all loops together), `run`
    (how: in plain Python or compiled, and what is cached), `memory, also` (peaks, pictures, ...), `results`,
    `sweep` (of a store: its chunks, memory, disk). `operations` and `loops` are None where no outputs are
    asked for. Inputs and outputs are in the units that the scene names, and in SI units without.
    """

    data: Mapping[str, Any]

    def __getitem__(self, key: str) -> Any:
        return self.data[key]

    def as_dict(self) -> dict[str, Any]:
        """The plan as plain dicts and lists."""
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    def to_json(self) -> str:
        """The plan as JSON."""
        return json.dumps(self.data, indent=2)

    def __str__(self) -> str:
        with IMPORTS:
            from ..document.terminal import terminal
            from .plan_text import plan_sections

        return terminal(self.data["title"] or "Scene", [*plan_sections(self.data)])


@with_known_keywords
def explain(scene: Scene | str | PathLike[str] | Mapping[str, Any]) -> RunPlan:
    """The plan of a scene (or of a path or mapping that describes one), without running it.

        print(dx.explain("examples/compactor.toml"))
        dx.explain(scene)["operations"]["per_point"]

    Raises as `scene` does.

    See docs/choose.md: which call for which question.
    """
    content = (scene if isinstance(scene, Scene) else scene_of(scene)).content
    with using(content.definitions):
        return _plan_of(content)


def _plan_of(content: Content) -> RunPlan:
    data: dict[str, Any] = {
        "title": content.title,
        "outputs": [_output(name, content) for name in content.outputs],
        "accuracy": content.accuracy,
        "promise": PROMISES[content.accuracy],
        "motion": _motion(content),
        "branch": content.branch,
        "derivation": digest()[:16],
        "inputs": [_input(name, value, content.units) for name, value in content.inputs.items()],
    }
    plan = plan_of_grid(content) if content.outputs else None
    data |= (
        dict.fromkeys(("points", "loops", "operations", "loads", "run"))
        if plan is None
        else _grid(content, plan)
    )
    results = content.data if content.store is None else content.store
    return RunPlan(
        data | {"also": [asdict(work) for work in content.work], "results": results, "sweep": _sweep(content)}
    )


def _sweep(content: Content) -> dict[str, Any] | None:
    """The chunks of a scene that goes to a store, what they take in memory, and the disk for all of them."""
    if content.store is None:
        return None
    made = sweep_of(request_of(content))
    layout = made.layout
    at_once = min(content.threads or available(), layout.at_once)
    return {
        "store": content.store,
        "chunks": layout.chunks,
        "chunk": layout.chunk,
        "memory": at_once * layout.in_flight,
        "disk": made.plan.bytes,
        "free": shutil.disk_usage(_existing(Path(content.store))).free,
    }


def _existing(path: Path) -> Path:
    return next(parent for parent in path.absolute().parents if parent.exists())


def _output(name: str, content: Content) -> dict[str, str]:
    row = quantity(name, "omega" in content.inputs)
    return {"name": name, "unit": content.units.of(name).unit, "meaning": row.meaning}


def _motion(content: Content) -> str:
    if "omega" in content.inputs:
        return "a given state: omega and alpha at this instant"
    if "omega0" not in content.inputs:
        return "none: no speed is given or needed"
    steady = content.inputs.get("alpha", 0.0) == 0.0
    return "constant speed omega0" if steady else "paper A's law: omega^2 = omega0^2 + 2 alpha theta"


def _input(name: str, value: Value, units: UnitSystem) -> dict[str, Any]:
    own = units.of(name)
    row: dict[str, Any] = {"name": name, "unit": own.unit}
    if isinstance(value, tuple):
        return {**row, "values": len(value), "from": own.shown(value[0]), "to": own.shown(value[-1])}
    if isinstance(value, Load):
        return {**row, "load": brief(value, own)}
    return {**row, "value": own.shown(value)}


def _grid(content: Content, plan: Plan) -> dict[str, Any]:
    """The grid of the outputs: its passes, its loops, how it runs."""
    found = _kernel_of(plan)
    compiled = bool(found.key.axis_of)  # a point is plain Python
    angles = plan.outer.axes.get("theta")
    large = found.key.far or (angles is not None and has_large_angles(angles.reshape(-1)))
    loops = _compiled_loops(found) if compiled else _plain_loops(found)
    straight = sum(loop.operations for loop in loops if not loop.close)
    total = sum(loop.work for loop in loops)
    steps = steps_of(found.key, found.request, straight)
    loads = load_costs(plan, found.points, compiled)
    given = {n: value for n, value in content.inputs.items() if n not in {load.name for load in loads}}
    return {
        "points": found.points,
        "axes": [{"name": n, "size": s} for n, s in zip(found.axes, found.sizes, strict=True) if n],
        "steps": [step._asdict() for step in steps],
        "skipped": [one._asdict() for one in skipped_of(found.key, found.request, given)],
        "loops": [_loop(loop, found.points) for loop in loops],
        "operations": {"straight": straight, "per_point": total / found.points, "total": total},
        "reduction": _reduction(plan),
        "loads": [load._asdict() for load in loads],
        "run": _run(content, found, compiled, large),
        "memory": _memory(plan, found),
    }


def _kernel_of(plan: Plan) -> GridKernel:
    """The kernel of a plan, with its loops."""
    of = points_of(plan)
    sizes = tuple(plan.outer.axes[name].size for name in of.dims) or (1,)
    if not of.dims:
        return GridKernel(of.wanted, ("",), sizes, of.key)
    return GridKernel(of.wanted, of.dims, sizes, of.key)


def _reduction(plan: Plan) -> dict[str, Any] | None:
    taken = plan.reductions
    if taken is None:
        return None
    return {"axis": ", ".join(taken.axes), "kinds": taken.kinds}


def _compiled_loops(found: GridKernel) -> list[LoopCost]:
    return loops_of(kernel_of(found.key), found.axes, found.sizes)


def _plain_loops(found: GridKernel) -> list[LoopCost]:
    """Every operation at every point, sine and cosine from `math`."""
    program = specialise(found.key.names, found.key.form, found.key.fixed)
    if found.key.accuracy == "extended":
        program = double_double(program, double_constants())
    axes = [name for name in found.axes if name]
    kernel = Kernel(len(axes), {}, ((),) * len(axes) + (program.lines,), program.outputs, {}, program.notes)
    return loops_of(kernel, axes, [s for n, s in zip(found.axes, found.sizes, strict=True) if n])


def _loop(loop: LoopCost, points: int) -> dict[str, Any]:
    row = loop._asdict()
    return {**row, "along": list(loop.along), "values": list(loop.values), "per_point": loop.work / points}


def _run(content: Content, found: GridKernel, compiled: bool, large: bool) -> dict[str, Any]:
    """The execution of the grid: how, on how many threads, what is cached."""
    threads = max(1, min(content.threads or available(), found.points // LEAST_BLOCK, found.sizes[0]))
    return {
        "way": "compiled" if compiled else "plain Python",
        "large_angles": large,
        "wide_margins": found.key.form.wide_margins,
        "threads": threads if compiled else 1,
        "cached": "memory" if is_ready(found.key) else "no",
    }


def _memory(plan: Plan, found: GridKernel) -> dict[str, int]:
    """Bytes of the result, and of what the grid would have taken where it is reduced."""
    result = plan._replace(steps=plan.steps[: None if plan.reductions else 1]).bytes
    grid = sum(1 if name in STATUSES else 8 for name in found.key.names) * found.points
    inputs = 8 * max(1, sum(plan.outer.axes[name].size for name in plan.outer.dimensions))
    return {"result": result, "grid": result if plan.reductions is None else grid, "inputs": inputs}
