"""The plan of a scene: the operations of each pass and loop, the skipped lines with reasons, the cost."""

import json
import shutil
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import prod
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ...compiler.kernel import Kernel
from ...compiler.passes.double_double import double_double
from ...compiler.passes.pipeline import optimise_in_steps
from ...compiler.program import Line
from ...evaluation.points import Points
from ...evaluation.reductions.reduced import AtPlace, Reduced
from ...loads.along_motion import OfMotion
from ...loads.load import Load, OverTheta, TableOverTheta
from ...loads.words import brief
from ...mechanism.catalogue import quantity
from ...mechanism.constants import double_constants, limit_of
from ...mechanism.inputs import INPUTS
from ...mechanism.keywords import with_known_keywords
from ...mechanism.names import STATUSES
from ...mechanism.own import using
from ...mechanism.program import digest, program_of, whole_program
from ...mechanism.quantity_units import UnitSystem
from ...runtime.executor import is_ready
from ...runtime.kernels import KernelKey, kernel_of
from ...runtime.request import Request
from ...runtime.specialise import specialise
from ...runtime.threads import LEAST_BLOCK, available
from ...sweeps.request import sweep_of
from ..content import Content
from ..document.render import terminal
from ..parts.grid import plan_of_grid, request_of
from ..reading.values import Value
from ..scene import Scene
from ..scene import scene as scene_of
from .plan_text import plan_sections

PROMISES = {
    "standard": "at most 8 ulp x (1 + the sum of the condition numbers), wherever it can be assembled",
    "extended": "2 ulp, but for the last double inside a limit angle, with a floor of 2^-96 of the scale",
}
WHAT = {
    "derivation": "every line of the derivation",
    "slice": "only the lines that the requested names need",
    "fold": "fixed inputs folded in; terms with a factor 0 vanish",
    "number": "what is computed twice is computed once",
    "unused": "lines that nothing needs any more",
    "keep": "NaN is kept where the mechanism cannot be assembled",
    "plain": "every design has wide margins: shorter forms",
    "write out": "sine, cosine and checks as arithmetic: loops vectorise",
}
WHY = {
    "branch": "one way to assemble it: no sign at run time",
    "alpha": "constant speed: the law of the crank and the test whether it stalls vanish",
    "ec": "concentric: the slider's axis meets the crank's centre",
    **{f"m_{part}": f"a massless {part}: its terms vanish" for part in ("crank", "rod", "slider")},
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
    state, units = "omega" in content.inputs, content.units
    with using(content.definitions):
        outputs = [
            {"name": name, "unit": units.of(name).unit, "meaning": quantity(name, state).meaning}
            for name in content.outputs
        ]
        grid: dict[str, Any] = dict.fromkeys(("points", "loops", "operations", "loads", "run"))
        return RunPlan({
            "title": content.title,
            "outputs": outputs,
            "accuracy": content.accuracy,
            "promise": PROMISES[content.accuracy],
            "motion": _motion(content),
            "branch": content.branch,
            "derivation": digest()[:16],
            "inputs": [_input(name, value, units) for name, value in content.inputs.items()],
            **(_grid(content) if outputs else grid),
            "also": [row for one in content.requests for row in one.plan(content).describe()],
            "results": content.data if content.store is None else content.store,
            "sweep": None if content.store is None else _sweep(content, content.store),
        })  # fmt: skip


def _sweep(content: Content, store: str) -> dict[str, Any]:
    """The chunks of a scene that goes to a store, what they take in memory, and the disk for all of them."""
    sweep = sweep_of(request_of(content))
    folder = next(parent for parent in Path(store).absolute().parents if parent.exists())
    return {
        "store": store,
        "chunks": sweep.chunks,
        "chunk": sweep.chunk,
        "memory": min(content.threads or available(), sweep.at_once) * sweep.in_flight,
        "disk": sweep.plan.bytes,
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
    if isinstance(value, Load):
        return {**row, "load": brief(value, name, units)}
    return {**row, "value": own.shown(value)}


def _grid(content: Content) -> dict[str, Any]:
    """The grid of the outputs: its passes, its loops, how it runs."""
    plan = plan_of_grid(content)
    (step, *_), taken = plan.steps, plan.reductions
    assert isinstance(step, (Points, Reduced, AtPlace))
    of = step if isinstance(step, Points) else step.of  # the step of the values, reduced or not
    key, is_compiled = of.key, bool(of.key.axis_of)
    sizes = {name: plan.outer.axes[name].size for name in of.dims}
    points = prod(sizes.values())
    loops = [*_loops(of, sizes)]
    straight = sum(loop["operations"] for loop in loops if not loop["close"])
    total = sum(loop["runs"] * loop["operations"] for loop in loops if not loop["close"])
    loads = {} if of.call.loads is None else of.call.loads.loads
    angles = plan.outer.axes.get("theta", np.zeros(1))
    threads = max(1, min(content.threads or available(), points // LEAST_BLOCK, *[*sizes.values()][:1]))
    result = plan._replace(steps=plan.steps[: None if taken else 1]).bytes
    grid = sum(1 if name in STATUSES else 8 for name in key.names) * points
    return {
        "points": points,
        "axes": [{"name": n, "size": s} for n, s in sizes.items()],
        "steps": [*_steps(key, of.call.asked, straight)],
        "skipped": [*_skipped(key, of.call.asked, [name for name in content.inputs if name not in loads])],
        "loops": loops,
        "operations": {"straight": straight, "per_point": total / points, "total": total},
        "reduction": taken and {"axis": ", ".join(taken.axes), "kinds": taken.kinds},
        "loads": [_lookups(n, load, angles.size, points, is_compiled) for n, load in loads.items()],
        "run": {
            "way": "compiled" if is_compiled else "plain Python",
            "large_angles": bool(key.far or (abs(angles) > limit_of("standard")).any()),
            "wide_margins": key.form.wide_margins,
            "threads": threads if is_compiled else 1,
            "cached": "memory" if is_ready(key) else "no",
        },
        "memory": {
            "result": result,
            "grid": grid if taken else result,
            "inputs": 8 * max(1, sum(plan.outer.axes[name].size for name in plan.outer.dimensions)),
        },
    }  # fmt: skip


# ---- operations ----------------------------------------------------------------------------------


def _steps(key: KernelKey, request: Request, inside: int) -> Iterator[dict[str, Any]]:
    """From the whole derivation to the kernel: operations at each point after a pass, and what it saved.

    `inside` is the number of the kernel's.
    """
    _, costs = optimise_in_steps(program_of(request.names, request.form), dict(key.fixed))
    counts = [("derivation", len(whole_program().lines)), ("slice", costs[0][1])]
    counts += [("unused" if name == "slice" else name, operations) for name, operations in costs[1:]]
    counts.append(("keep", len(specialise(request.names, request.form, key.fixed).lines)))
    counts += [("plain", _operations(key, key.fixed))] if key.form.wide_margins else []
    counts.append(("write out", inside))
    for (_, before), (name, after) in pairwise([counts[0], *counts]):
        if before != after or name in ("derivation", "slice", "fold"):
            what = WHAT.get(name, f"the pass {name}")
            yield {"name": name, "what": what, "operations": after, "saved": before - after}


def _skipped(key: KernelKey, request: Request, inputs: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Skipped lines, why, and what each fixed input saves on its own."""
    least = _operations(key, key.fixed)
    absent = [name for name, _ in key.fixed if name not in inputs and name in INPUTS and name != "alpha"]

    def row(what: str, why: str, names: Sequence[str] = ()) -> dict[str, Any]:
        free = tuple(pair for pair in key.fixed if pair[0] not in names)
        return {"what": what, "why": why, "saved": _operations(key, free) - least if names else 0}

    for name, value in key.fixed:
        if name not in absent:
            meaning = WHY.get(name) or f"no {INPUTS[name].meaning}: its terms vanish"
            yield row(f"{name} = {value:+.0f}" if name == "branch" else f"{name} = 0", meaning, [name])
    if absent:
        yield row(f"{', '.join(absent)} = 0", "not given: their terms vanish", absent)
    for name in request.form.default_centres:
        yield row(name, f"not given: half of {'AB' if name == 'r_crank' else 'BC'}, moving with it")
    for name in inputs:
        if name in INPUTS and name not in request.inputs and name not in dict(key.fixed):
            yield row(name, "given, but no requested name depends on it")


def _operations(key: KernelKey, fixed: tuple[tuple[str, float], ...]) -> int:
    return len(specialise(key.names, key.form, fixed).lines)


def _loops(of: Points, sizes: Mapping[str, int]) -> Iterator[dict[str, Any]]:
    """The loops of a kernel; a point is plain Python: every operation once, sine and cosine from `math`.

    A loop has its operations, counted by name too, how often it runs, its named values and outputs. `close`
    marks the form that runs instead of the others where margins are narrow.
    """
    if of.key.axis_of:
        kernel = kernel_of(of.key)
    else:
        program = specialise(of.key.names, of.key.form, of.key.fixed)
        if of.key.accuracy == "extended":
            program = double_double(program, double_constants())
        levels = (*((),) * len(of.dims), program.lines)
        kernel = Kernel(len(of.dims), {}, levels, program.outputs, {}, program.notes)
    points = prod(sizes.values())

    def loop(
        lines: Sequence[Line], along: Sequence[str], kernel: Kernel, table: bool = False, close: bool = False
    ) -> dict[str, Any]:
        kinds = Counter(line.op for line in lines if line.op != "copy")
        known = {*kernel.notes, *kernel.outputs}
        runs = prod(sizes[axis] for axis in along)
        return {
            "table": table, "along": tuple(along), "runs": runs, "operations": kinds.total(),
            "kinds": dict(sorted(kinds.items())), "close": close,
            "values": tuple(line.name for line in lines if line.name in known),
            "per_point": 0.0 if close else runs * kinds.total() / points,
        }  # fmt: skip

    tables = ((table.kernel, [of.dims[axis] for axis in table.along], True) for table in kernel.tables)
    for nest, axes, table in (*tables, (kernel, of.dims, False)):
        for level, lines in enumerate(nest.levels):
            if lines:
                yield loop(lines, axes[:level], nest, table)
    if kernel.close is not None:
        yield loop(kernel.close.lines, of.dims, kernel, close=True)


def _lookups(name: str, load: Load, angles: int, points: int, is_compiled: bool) -> dict[str, Any]:
    """The number of times that a load is looked up, and where."""
    where = "at each point, by the kernel" if is_compiled else "at the point"
    if isinstance(load, TableOverTheta):
        where = "once for each angle"
    elif isinstance(load, OverTheta):
        where = "a Python function, called with all angles"
    elif isinstance(load, OfMotion):
        where = "at each point, from the motion there"
    return {"name": name, "lookups": angles if isinstance(load, OverTheta) else points, "where": where}
