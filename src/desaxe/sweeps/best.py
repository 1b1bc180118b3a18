"""The best designs of a grid that is not stored: each chunk returns its best, which are merged."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.numba.reductions import KINDS as REDUCTIONS
from ..evaluation.blocks import grid_parts
from ..evaluation.chunks import blocks_of, slices_of
from ..evaluation.evaluate import evaluate
from ..evaluation.labels import attributes as attributes_of
from ..evaluation.labels import input_attributes, labelled, with_loads
from ..evaluation.lazy import AnyPart, parts_of_reduced
from ..evaluation.outer import Outer, outer_of
from ..evaluation.reduce import reduced_attributes
from ..evaluation.reductions import Reduction, reductions_of
from ..mechanism.spelling import did_you_mean
from ..runtime.accuracy import accuracy_of
from ..runtime.compiled_only import compiled_only
from ..runtime.request import several
from .cluster import Crew, run_all
from .kept import Found, Kept
from .layout import Layout, layout_of
from .meter import Meter
from .request import identity, versions
from .tasks import check_version

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
KINDS = ("max", "min", "absmax")


class Ranking(NamedTuple):
    """The criterion of a ranking of designs.

    name      the quantity
    kind      max, min or absmax, or a mean: what is taken of it
    variable  the variable of a block that is compared
    smallest  whether the smallest is the best
    """

    name: str
    kind: str
    variable: str
    smallest: bool


class Search(NamedTuple):
    """A search for the best designs: the grid of what they are ranked by, and how it is cut."""

    outer: Outer
    others: tuple[str, ...]
    ranking: Ranking
    reduction: Reduction | None
    part: AnyPart
    layout: Layout
    branch: int
    accuracy: Any
    identity: dict[str, str]

    @property
    def points(self) -> int:
        """Points of the grid."""
        return prod(self.outer.axes[name].size for name in self.outer.dimensions)


class BestTask(NamedTuple):
    """A chunk of a search, as it travels: what to compute, and where it stands in the whole."""

    number: int
    part: AnyPart
    ranking: Ranking
    best: int
    values: dict[str, Array]
    starts: tuple[int, ...]
    shape: tuple[int, ...]
    points: int
    threads: int
    version: str
    digest: str


def ranking_of(name: str, kind: str | None, reduction: Reduction | None) -> Ranking:
    """The ranking by a name and a kind; the first allowed kind by default."""
    known = KINDS if reduction is None else reduction.kinds
    kind = known[0] if kind is None else kind
    if kind not in known:
        raise ValueError(f"by: {kind!r}: {did_you_mean(kind, known)}allowed: {', '.join(known)}")
    return Ranking(name, kind, name if reduction is None else f"{name}_{kind}", kind == "min")


def _named(by: Any, reduce: Any) -> tuple[str, str | None]:
    """The name and kind of `"a_C"`, `("absmax", "a_C")` or, of a reduced grid, `"a_C_absmax"`."""
    kind, name = by if isinstance(by, (tuple, list)) and len(by) == 2 else (None, by)
    if not isinstance(name, str) or not (kind is None or isinstance(kind, str)):
        raise TypeError(f'by = {by!r}: the name of a quantity, or a pair such as ("absmax", "a_C")')
    stem, _, last = name.rpartition("_")
    if kind is None and reduce is not None and last in REDUCTIONS:
        return stem, last
    return name, kind


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
) -> Search:
    """The search for `count` designs, checked; over an axis theta a design is ranked by its extreme."""
    name, kind = _named(by, reduce)
    wanted = dict.fromkeys(((names,) if isinstance(names, str) else several(names)) + (name,))
    outer = outer_of(tuple(wanted), inputs, branch, threads, always=False)
    if reduce is None and "theta" in outer.dimensions:
        reduce = {"theta": kind if kind in KINDS else KINDS[0]}
    asked = None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)
    reduction = None if asked is None else asked.alone
    if asked is not None and reduction is None:
        raise ValueError(
            f"reduce: designs are ranked by one axis and {', '.join(REDUCTIONS)}; rank a reduced sweep itself"
        )
    ranking = ranking_of(name, kind, reduction)
    alone = outer._replace(names=(ranking.name,))
    sizes = {name: outer.axes[name].size for name in outer.dimensions}
    length = None if reduction is None else sizes.pop(reduction.axis)
    layout = layout_of("auto", sizes, 64, length or 1, memory)
    part: AnyPart
    if asked is None:
        part = grid_parts(alone, branch, accuracy, layout.chunk)[0]
    else:
        part = parts_of_reduced(alone, branch, accuracy, asked, layout.chunk)[0]
    others = tuple(name for name in outer.names if name != ranking.name)
    own = [repr(part.own)] if part.own else []
    told = identity(outer, branch, accuracy_of(accuracy), asked, (), own, (count, *ranking[:2]))
    return Search(outer, others, ranking, reduction, part, layout, branch, accuracy, told)


def best_of_block(task: BestTask) -> tuple[int, Found]:
    """The number of a chunk and its best designs."""
    check_version(task.version, task.digest)
    return task.number, _best_of_block(task)


def _best_of_block(task: BestTask) -> Found:
    arrays = task.part.compute(task.values, task.threads)
    name, kind, variable, smallest = task.ranking
    values = arrays[variable]
    compared = np.abs(values) if task.part.reduction is None and kind == "absmax" else values
    rank = (compared if smallest else -compared).reshape(-1)
    order = np.argsort(rank, kind="stable")[: task.best]  # NaN comes last
    order = order[~np.isnan(rank[order])]
    local = np.unravel_index(order, values.shape) if values.ndim else ()
    places = np.zeros(order.size, np.int64)
    if values.ndim:
        whole = tuple(index + start for index, start in zip(local, task.starts, strict=True))
        places = np.ravel_multi_index(whole, task.shape).astype(np.int64)
    flat = {n: a.reshape(-1)[order] for n, a in arrays.items()}
    reduction = task.part.reduction
    angles = np.full(order.size, np.nan)
    if reduction is None:
        return Found(places, flat[variable], angles, angles, int((~np.isnan(rank)).sum()), task.points)
    skipped = arrays[f"{name}_skipped"]
    feasible = int(skipped.size * task.values[reduction.axis].size - skipped.sum())
    angles = flat.get(f"{variable}_{reduction.axis}", angles)
    return Found(places, flat[variable], angles, flat[f"{name}_skipped"], feasible, task.points)


def best_designs(
    search: Search, count: int, crew: Crew, meter: Meter, inner: int, kept: Kept | None = None
) -> "xr.Dataset":
    """Run a search, or resume it from the chunks that are kept; return the best designs, the best first."""
    kept = Kept(search.layout.chunks) if kept is None else kept
    meter.add(kept.points, False)
    with closing(kept):
        tasks = _tasks(search, count, inner, kept.done)
        for number, found in run_all(crew, best_of_block, tasks, ahead=crew.size):
            meter.add(found.points, True)
            best = found if kept.best is None else _merged(kept.best, found, count, search.ranking)
            kept.add(number, best)
    assert kept.best is not None
    return _labelled(search, kept.best)


def _tasks(search: Search, count: int, inner: int, done: Array) -> Iterator[BestTask]:
    layout, shape = search.layout, tuple(search.layout.sizes.values())
    scale = search.points // max(1, prod(shape))
    for number, place in enumerate(blocks_of(layout.sizes, layout.chunk)):
        if done[number]:
            continue
        regions = slices_of(place, layout.sizes, layout.chunk)
        axes = search.outer.axes
        values = {n: axes[n][regions[n]] if n in regions else axes[n] for n in search.part.axes}
        points = scale * prod(part.stop - part.start for part in regions.values())
        starts = tuple(part.start for part in regions.values())
        yield BestTask(
            number, search.part, search.ranking, count, values, starts, shape, points, inner, *versions()
        )


def _merged(one: Found, other: Found, count: int, ranking: Ranking) -> Found:
    """The best of two; of equal ones the earlier in the grid, whichever chunk was done first."""
    places, values, theta, skipped = (np.concatenate([a, b]) for a, b in zip(one[:4], other[:4], strict=True))
    compared = np.abs(values) if ranking.kind == "absmax" else values
    order = np.lexsort((places, compared if ranking.smallest else -compared))[:count]
    feasible, points = one.feasible + other.feasible, one.points + other.points
    return Found(places[order], values[order], theta[order], skipped[order], feasible, points)


def _labelled(search: Search, kept: Found) -> "xr.Dataset":
    """The designs by rank, with every name at the point where it is attained."""
    outer, ranking, reduction = search.outer, search.ranking, search.reduction
    state = outer.given.get("omega") is not None
    sizes = search.layout.sizes
    index = np.unravel_index(kept.places, tuple(sizes.values())) if sizes else ()
    design = {name: outer.axes[name][i] for name, i in zip(sizes, index, strict=True)}
    attained = {} if reduction is None or np.isnan(kept.theta).all() else {reduction.axis: kept.theta}
    scalars = {name: array for name, array in outer.coordinates.items() if not array.ndim}
    told = attributes_of(ranking.name, state)
    if reduction is not None:
        own = input_attributes(reduction.axis)
        told = reduced_attributes([ranking.name], reduction, own, state)[ranking.variable]
    variables: dict[str, Any] = {ranking.variable: ("rank", kept.values, told)}
    if kept.places.size and (reduction is None or attained):
        point: dict[str, Any] = {n: a.item() for n, a in scalars.items()}
        point |= {**outer.loads, **design, **attained}
        options: dict[str, Any] = {"branch": search.branch, "accuracy": search.accuracy}
        for name in search.others:
            with compiled_only():
                value = np.broadcast_to(evaluate(name, **point, **options), kept.places.shape)
            variables[name] = ("rank", np.array(value), attributes_of(name, state))
    for name, values in {**design, **attained}.items():
        variables[name] = ("rank", values, input_attributes(name))
    if reduction is not None:
        share = 1.0 - kept.skipped / outer.axes[reduction.axis].size
        words = f"share of the points along {reduction.axis} that have a {ranking.name}"
        variables["feasible_fraction"] = ("rank", share, {"units": "1", "long_name": words})
    total = {"units": "1", "long_name": f"share of all points of the grid that have a {ranking.name}"}
    variables["feasible"] = ((), kept.feasible / search.points, total)
    found = labelled({}, scalars, search.branch, state, search.accuracy)
    ranks = ("rank", np.arange(1, kept.places.size + 1), {"units": "1", "long_name": "the best one is 1"})
    found = found.assign_attrs(search.identity)
    found = found.assign(variables).assign_coords(rank=ranks).set_coords([*design, *attained])
    return with_loads(found, outer.loads)
