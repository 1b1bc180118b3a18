"""The costs of a kernel: operations after each pass and in each loop, what was skipped and why, look-ups."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import prod
from typing import Any, NamedTuple

from ...compiler.kernel import Kernel
from ...compiler.passes.double_double import double_double
from ...compiler.passes.pipeline import optimise_in_steps
from ...compiler.program import Line
from ...evaluation.points import Points
from ...loads.along_motion import OfMotion
from ...loads.load import Load, OverTheta, TableOverTheta
from ...mechanism.constants import double_constants
from ...mechanism.inputs import INPUTS
from ...mechanism.program import program_of, whole_program
from ...runtime.kernels import KernelKey, kernel_of
from ...runtime.request import Request
from ...runtime.specialise import specialise

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
    "m_crank": "a massless crank: its terms vanish",
    "m_rod": "a massless rod: its terms vanish",
    "m_slider": "a massless slider: its terms vanish",
}


class LoopCost(NamedTuple):
    """A loop body: its operations and how often it runs.

    `kinds` counts them by name, `values` are the named ones and the outputs among them. `close` marks the
    form that runs instead of the others where margins are narrow.
    """

    table: bool
    along: tuple[str, ...]
    runs: int
    operations: int
    kinds: dict[str, int]
    values: tuple[str, ...]
    close: bool = False

    @property
    def work(self) -> int:
        """Total operations, without those of the form for narrow margins."""
        return 0 if self.close else self.runs * self.operations


def steps_of(key: KernelKey, request: Request, inside: int) -> Iterator[dict[str, Any]]:
    """From the whole derivation to the kernel: operations at each point after a pass, and what it saved.

    `inside` is the number of the kernel's.
    """
    _, costs = optimise_in_steps(program_of(request.names, request.form), dict(key.fixed))
    counts = [("derivation", len(whole_program().lines)), ("slice", costs[0][1])]
    names = {"slice": "unused"}
    counts += [(names.get(name, name), operations) for name, operations in costs[1:]]
    kept = len(specialise(request.names, request.form, key.fixed).lines)
    counts.append(("keep", kept))
    if key.form.wide_margins:
        counts.append(("plain", _operations(key, key.fixed)))
    counts.append(("write out", inside))
    for (_, before), (name, after) in pairwise([counts[0], *counts]):
        if before != after or name in ("derivation", "slice", "fold"):
            what = WHAT.get(name, f"the pass {name}")
            yield {"name": name, "what": what, "operations": after, "saved": before - after}


def skipped_of(key: KernelKey, request: Request, given: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Skipped lines, why, and what each fixed input saves on its own."""
    least = _operations(key, key.fixed)
    absent = [name for name, _ in key.fixed if name not in given and name in INPUTS and name != "alpha"]

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
    for name in given:
        if name in INPUTS and name not in request.inputs and name not in dict(key.fixed):
            yield row(name, "given, but no requested name depends on it")


def _operations(key: KernelKey, fixed: tuple[tuple[str, float], ...]) -> int:
    return len(specialise(key.names, key.form, fixed).lines)


def loops_of(of: Points, sizes: Mapping[str, int]) -> list[LoopCost]:
    """The loops of a kernel; a point is plain Python: every operation once, sine and cosine from `math`."""
    if of.key.axis_of:
        kernel = kernel_of(of.key)
    else:
        program = specialise(of.key.names, of.key.form, of.key.fixed)
        if of.key.accuracy == "extended":
            program = double_double(program, double_constants())
        levels = (*((),) * len(of.dims), program.lines)
        kernel = Kernel(len(of.dims), {}, levels, program.outputs, {}, program.notes)
    loops: list[LoopCost] = []
    for table in kernel.tables:
        loops += _nest(table.kernel, [of.dims[axis] for axis in table.along], sizes, True)
    loops += _nest(kernel, of.dims, sizes, False)
    if kernel.close is not None:
        loops.append(_loop(kernel.close.lines, False, of.dims, sizes, kernel)._replace(close=True))
    return loops


def _nest(kernel: Kernel, axes: Sequence[str], sizes: Mapping[str, int], table: bool) -> list[LoopCost]:
    levels = enumerate(kernel.levels)
    return [_loop(lines, table, axes[:level], sizes, kernel) for level, lines in levels if lines]


def _loop(
    lines: Sequence[Line], table: bool, along: Sequence[str], sizes: Mapping[str, int], kernel: Kernel
) -> LoopCost:
    kinds = Counter(line.op for line in lines if line.op != "copy")
    values = tuple(line.name for line in lines if line.name in kernel.notes or line.name in kernel.outputs)
    runs = prod(sizes[axis] for axis in along)
    return LoopCost(table, tuple(along), runs, kinds.total(), dict(sorted(kinds.items())), values)


def lookups_of(of: Points, angles: int, points: int) -> list[dict[str, Any]]:
    """The number of times that each load is looked up, and where."""
    loads = {} if of.loads is None else of.loads.loads

    def where(load: Load) -> tuple[int, str]:
        if isinstance(load, OverTheta):
            table = isinstance(load, TableOverTheta)
            return angles, "once for each angle" if table else "a Python function, called with all angles"
        if isinstance(load, OfMotion):
            return points, "at each point, from the motion there"
        return points, "at each point, by the kernel" if of.dims else "at the point"

    return [dict(zip(("name", "lookups", "where"), (n, *where(v)), strict=True)) for n, v in loads.items()]
