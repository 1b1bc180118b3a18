"""The plan of a scene: the operations of each loop, the skipped lines with reasons, the cost."""

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, prod
from os import PathLike
from pathlib import Path
from typing import Any

from ...evaluation.plan import Plan
from ...evaluation.points import Points
from ...evaluation.reductions.reduced import AtPlace, Reduced
from ...loads.load import Load
from ...loads.words import brief
from ...mechanism.catalogue import quantity
from ...mechanism.constants import limit_of
from ...mechanism.keywords import with_known_keywords
from ...mechanism.names import STATUSES
from ...mechanism.own import using
from ...mechanism.program import digest
from ...mechanism.quantity_units import UnitSystem
from ...runtime.executor import is_ready
from ...runtime.threads import LEAST_BLOCK, available
from ...support.forks import IMPORTS
from ...sweeps.request import sweep_of
from ..content import Content
from ..parts.grid import plan_of_grid, request_of
from ..reading.values import Value
from ..scene import Scene
from ..scene import scene as scene_of
from .costs import lookups_of, loops_of, skipped_of, steps_of

PROMISES = {
    "standard": "at most 8 ulp x (1 + the sum of the condition numbers), wherever it can be assembled",
    "extended": "2 ulp, but for the last double inside a limit angle, with a floor of 2^-96 of the scale",
}


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
        plain: dict[str, Any] = json.loads(self.to_json())
        return plain

    def to_json(self) -> str:
        """The plan as JSON."""
        return json.dumps(self.data, indent=2)

    def __str__(self) -> str:
        with IMPORTS:
            from ..document.render import terminal
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
    state = "omega" in content.inputs
    outputs = [
        {"name": name, "unit": content.units.of(name).unit, "meaning": quantity(name, state).meaning}
        for name in content.outputs
    ]
    grid: dict[str, Any] = dict.fromkeys(("points", "loops", "operations", "loads", "run"))
    if content.outputs:
        grid = _grid(content, plan_of_grid(content))
    return RunPlan({
        "title": content.title,
        "outputs": outputs,
        "accuracy": content.accuracy,
        "promise": PROMISES[content.accuracy],
        "motion": _motion(content),
        "branch": content.branch,
        "derivation": digest()[:16],
        "inputs": [_input(name, value, content.units) for name, value in content.inputs.items()],
        **grid,
        "also": [row for one in content.requests for row in one.plan(content).describe()],
        "results": content.data if content.store is None else content.store,
        "sweep": None if content.store is None else _sweep(content),
    })  # fmt: skip


def _sweep(content: Content) -> dict[str, Any]:
    """The chunks of a scene that goes to a store, what they take in memory, and the disk for all of them."""
    made = sweep_of(request_of(content))
    layout, store = made.layout, str(content.store)
    folder = next(parent for parent in Path(store).absolute().parents if parent.exists())
    return {
        "store": store,
        "chunks": layout.chunks,
        "chunk": layout.chunk,
        "memory": min(content.threads or available(), layout.at_once) * layout.in_flight,
        "disk": made.plan.bytes,
        "free": shutil.disk_usage(folder).free,
    }


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
    return row | (
        {"load": brief(value, name, units)} if isinstance(value, Load) else {"value": own.shown(value)}
    )


def _grid(content: Content, plan: Plan) -> dict[str, Any]:
    """The grid of the outputs: its passes, its loops, how it runs."""
    (step, *_), taken = plan.steps, plan.reductions
    assert isinstance(step, (Points, Reduced, AtPlace))
    of = step if isinstance(step, Points) else step.of  # the step of the values, reduced or not
    sizes = {name: plan.outer.axes[name].size for name in of.dims}
    points = prod(sizes.values())
    angles = plan.outer.axes.get("theta")
    loops = loops_of(of, sizes)
    straight = sum(loop.operations for loop in loops if not loop.close)
    total = sum(loop.work for loop in loops)
    loads = lookups_of(of, 1 if angles is None else angles.size, points)
    given = {n: v for n, v in content.inputs.items() if n not in {load["name"] for load in loads}}
    rows = [{**loop._asdict(), "per_point": loop.work / points} for loop in loops]
    threads = max(1, min(content.threads or available(), points // LEAST_BLOCK, *[*sizes.values()][:1]))
    result = plan._replace(steps=plan.steps[: None if taken else 1]).bytes
    grid = sum(1 if name in STATUSES else 8 for name in of.key.names) * points
    large = of.key.far or (angles is not None and bool(_are_large(angles).any()))
    return {
        "points": points,
        "axes": [{"name": n, "size": s} for n, s in sizes.items()],
        "steps": [*steps_of(of.key, of.wanted, straight)],
        "skipped": [*skipped_of(of.key, of.wanted, given)],
        "loops": rows,
        "operations": {"straight": straight, "per_point": total / points, "total": total},
        "reduction": taken and {"axis": ", ".join(taken.axes), "kinds": taken.kinds},
        "loads": loads,
        "run": {
            "way": "compiled" if of.key.axis_of else "plain Python",
            "large_angles": large,
            "wide_margins": of.key.form.wide_margins,
            "threads": threads if of.key.axis_of else 1,
            "cached": "memory" if is_ready(of.key) else "no",
        },
        "memory": {
            "result": result,
            "grid": grid if taken else result,
            "inputs": 8 * max(1, sum(plan.outer.axes[name].size for name in plan.outer.dimensions)),
        },
    }  # fmt: skip


def _are_large(angles: Any) -> Any:
    """Mask of the angles beyond what the written-out sine and cosine reduce exactly."""
    return (abs(angles) > limit_of("standard")) & (abs(angles) < inf)
