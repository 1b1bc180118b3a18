"""The best designs of a grid that is not stored: each chunk returns its best, which are merged."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.axes import outer_of
from ..evaluation.evaluate import evaluate
from ..evaluation.labels import attributes, input_attributes, labelled, with_loads
from ..evaluation.plan import Plan, Step, computed, plan_of
from ..evaluation.points import points_of
from ..evaluation.reductions import ALLOWED, Reduction, kind_of, reductions_of
from ..mechanism.catalogue import has
from ..mechanism.spelling import did_you_mean
from ..runtime.accuracy import accuracy_of
from ..runtime.compiled_only import compiled_only
from ..runtime.request import several
from ..support.progress import Count
from ..support.shown import shown
from .cluster import Crew, run_all
from .kept import BestDesigns, Kept
from .layout import Layout, layout_of
from .request import identity, versions
from .tasks import check_version

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
EXTREMES = ("max", "min", "absmax")
ORDERS = ("smallest", "largest")
# Kinds of which one end is the better one by itself, or was never the other: their default.
DEFAULTS = {"min": "smallest", "mean": "largest", "median": "largest"}


class Ranking(NamedTuple):
    """The criterion of a ranking of designs.

    name      the quantity
    kind      max, min or absmax, or a mean: what is taken of it
    order     which end is the best: "smallest" or "largest"
    variable  the variable of a block that is compared
    """

    name: str
    kind: str
    order: str
    variable: str

    def rank(self, values: Array) -> Array:
        """The place of values of a block in the ranking: the smallest comes first."""
        compared = np.abs(values) if self.variable == self.name and self.kind == "absmax" else values
        return compared if self.order == "smallest" else -compared


class BestSearch(NamedTuple):
    """A search for the best designs: the plan of what they are ranked by, and how it is cut."""

    plan: Plan
    others: tuple[str, ...]
    ranking: Ranking
    reduction: Reduction | None
    layout: Layout
    identity: dict[str, str]


class BestTask(NamedTuple):
    """A chunk of a search, as it travels: what to compute, and where it stands in the whole."""

    number: int
    step: Step
    ranking: Ranking
    axis: str | None
    best: int
    values: dict[str, Array]
    starts: tuple[int, ...]
    shape: tuple[int, ...]
    points: int
    threads: int
    version: str
    digest: str


def ranking_of(name: str, kind: str | None, order: Any, reduction: Reduction | None) -> Ranking:
    """The ranking by a name and a kind; the first allowed kind by default."""
    known = EXTREMES if reduction is None else reduction.kinds
    if kind is not None and kind not in known:
        raise ValueError(f"by: {kind!r}: {did_you_mean(kind, known)}allowed: {', '.join(known)}")
    end = DEFAULTS.get(str(kind)) if order is None else order
    if end is None:
        of = f"{kind!r} of {name}" if kind else repr(name)
        raise ValueError(
            f'by: {of}: which end is the best? give order="smallest" or order="largest" '
            f"({', '.join(DEFAULTS)} have a default; allowed: {ALLOWED})"
        )
    if end not in ORDERS:
        raise ValueError(f'order = {shown(order)}: it is "smallest" or "largest"')
    kind = known[0] if kind is None else kind
    return Ranking(name, kind, end, name if reduction is None else f"{name}_{kind}")


def _named(by: Any, reduce: Any) -> tuple[str, str | None]:
    """The name and kind of `"a_C"`, `("absmax", "a_C")` or, of a reduced grid, `"a_C_absmax"`."""
    kind, name = by if isinstance(by, (tuple, list)) and len(by) == 2 else (None, by)
    if not isinstance(name, str) or not (kind is None or isinstance(kind, str)):
        raise TypeError(f'by = {by!r}: the name of a quantity, or a pair such as ("absmax", "a_C")')
    stem, _, last = name.rpartition("_")
    if kind is None and (reduce is None or has(name)):
        return name, None
    try:
        return (stem, kind_of(last)) if kind is None else (name, kind_of(kind))
    except ValueError as error:
        if kind is None:
            return name, None
        raise ValueError(str(error).replace("reduce", "by", 1)) from None


def search_for(
    names: str | Sequence[str],
    inputs: Mapping[str, Any],
    by: Any,
    reduce: Any,
    branch: int,
    accuracy: Any,
    threads: int | None,
    memory: int | None,
    count: int,
    order: str | None = None,
) -> BestSearch:
    """The search for `count` designs, checked; over an axis theta a design is ranked by its extreme."""
    name, kind = _named(by, reduce)
    wanted = dict.fromkeys(((names,) if isinstance(names, str) else several(names)) + (name,))
    outer = outer_of(tuple(wanted), inputs, branch, threads, always=False)
    if reduce is None and "theta" in outer.dimensions:
        reduce = {"theta": kind or EXTREMES[0]}
    asked = None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)
    reduction = None if asked is None else asked.along
    if asked is not None and reduction is None:
        raise ValueError("reduce: designs are ranked by kinds along one axis; rank a reduced sweep itself")
    ranking = ranking_of(name, kind, order, reduction)
    alone = outer._replace(names=(ranking.name,))
    if asked is None:
        step = points_of([ranking.name], alone, outer.dimensions, branch, accuracy)
        plan = Plan(alone, branch, accuracy, (step,), tuple(outer.dimensions))
    else:
        plan = plan_of(alone, branch, accuracy, asked)
    layout = layout_of("auto", plan.sizes, 64, plan.behind, memory)
    others = tuple(name for name in outer.names if name != ranking.name)
    own = [repr(step.own) for step in plan.steps if step.own]
    told = identity(outer, branch, accuracy_of(accuracy), asked, (), own, (count, *ranking[:3]))
    return BestSearch(plan, others, ranking, reduction, layout, told)


def best_of_block(task: BestTask) -> tuple[int, BestDesigns]:
    """The number of a chunk and its best designs."""
    check_version(task.version, task.digest)
    return task.number, _best_of_block(task)


def _best_of_block(task: BestTask) -> BestDesigns:
    arrays = computed(task.step, task.values, task.threads)
    name, variable = task.ranking.name, task.ranking.variable
    values = arrays[variable]
    rank = task.ranking.rank(values).reshape(-1)
    order = np.argsort(rank, kind="stable")[: task.best]  # NaN comes last
    order = order[~np.isnan(rank[order])]
    local = np.unravel_index(order, values.shape) if values.ndim else ()
    places = np.zeros(order.size, np.int64)
    if values.ndim:
        whole = tuple(index + start for index, start in zip(local, task.starts, strict=True))
        places = np.ravel_multi_index(whole, task.shape).astype(np.int64)
    flat = {n: a.reshape(-1)[order] for n, a in arrays.items()}
    angles = np.full(order.size, np.nan)
    if task.axis is None:
        return BestDesigns(places, flat[variable], angles, angles, int((~np.isnan(rank)).sum()), task.points)
    skipped = arrays[f"{name}_skipped"]
    feasible = int(skipped.size * task.values[task.axis].size - skipped.sum())
    angles = flat.get(f"{variable}_{task.axis}", angles)
    return BestDesigns(places, flat[variable], angles, flat[f"{name}_skipped"], feasible, task.points)


def best_designs(
    search: BestSearch, count: int, crew: Crew, told: Count, inner: int, kept: Kept | None = None
) -> "xr.Dataset":
    """Run a search, or resume it from the chunks that are kept; return the best designs, the best first."""
    kept = Kept(search.layout.chunks) if kept is None else kept
    told(kept.points, False)
    with closing(kept):
        tasks = _tasks(search, count, inner, kept.done)
        for number, found in run_all(crew, best_of_block, tasks, ahead=crew.size):
            told(found.points, True)
            best = found if kept.best is None else _merged(kept.best, found, count, search.ranking)
            kept.add(number, best)
    assert kept.best is not None
    return _labelled(search, kept.best)


def _tasks(search: BestSearch, count: int, inner: int, done: Array) -> Iterator[BestTask]:
    plan, layout = search.plan, search.layout
    axis, shape = None if search.reduction is None else search.reduction.axis, tuple(layout.sizes.values())
    for number, block in enumerate(plan.cut(layout.chunk).blocks(layout.chunk)):
        if not done[number]:
            starts = tuple(region.start for region in block.regions.values())
            about = block.parts[0].step, search.ranking, axis, count, block.values, starts, shape
            yield BestTask(number, *about, plan.points_in(block), inner, *versions())


def _merged(one: BestDesigns, other: BestDesigns, count: int, ranking: Ranking) -> BestDesigns:
    """The best of two; of equal ones the earlier in the grid, whichever chunk was done first."""
    places, values, theta, skipped = (np.concatenate([a, b]) for a, b in zip(one[:4], other[:4], strict=True))
    order = np.lexsort((places, ranking.rank(values)))[:count]
    feasible, points = one.feasible + other.feasible, one.points + other.points
    return BestDesigns(places[order], values[order], theta[order], skipped[order], feasible, points)


def _labelled(search: BestSearch, kept: BestDesigns) -> "xr.Dataset":
    """The designs by rank, with every name at the point where it is attained."""
    plan, outer, ranking, reduction = search.plan, search.plan.outer, search.ranking, search.reduction
    state = outer.given.get("omega") is not None
    sizes = search.layout.sizes
    index = np.unravel_index(kept.places, tuple(sizes.values())) if sizes else ()
    design = {name: outer.axes[name][i] for name, i in zip(sizes, index, strict=True)}
    attained = {} if reduction is None or np.isnan(kept.theta).all() else {reduction.axis: kept.theta}
    scalars = {name: array for name, array in outer.coordinates.items() if not array.ndim}
    told = plan.steps[0].outputs[ranking.variable].attributes
    variables: dict[str, Any] = {ranking.variable: ("rank", kept.values, told)}
    if kept.places.size and (reduction is None or attained):
        point: dict[str, Any] = {n: a.item() for n, a in scalars.items()}
        point |= {**outer.loads, **design, **attained}
        options: dict[str, Any] = {"branch": plan.branch, "accuracy": plan.accuracy}
        for name in search.others:
            with compiled_only():
                value = np.broadcast_to(evaluate(name, **point, **options), kept.places.shape)
            variables[name] = ("rank", np.array(value), attributes(name, state))
    for name, values in {**design, **attained}.items():
        variables[name] = ("rank", values, input_attributes(name))
    if reduction is not None:
        share = 1.0 - kept.skipped / outer.axes[reduction.axis].size
        words = f"share of the points along {reduction.axis} that have a {ranking.name}"
        variables["feasible_fraction"] = ("rank", share, {"units": "1", "long_name": words})
    total = {"units": "1", "long_name": f"share of all points of the grid that have a {ranking.name}"}
    variables["feasible"] = ((), kept.feasible / plan.points, total)
    found = labelled({}, scalars, plan.branch, plan.accuracy)
    ranks = ("rank", np.arange(1, kept.places.size + 1), {"units": "1", "long_name": "the best one is 1"})
    found = found.assign_attrs(search.identity)
    found = found.assign(variables).assign_coords(rank=ranks).set_coords([*design, *attained])
    return with_loads(found, outer.loads)
