"""The best designs of a grid that is not stored: each chunk returns its best, which are merged."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.axes import outer_of
from ..evaluation.evaluate import evaluate
from ..evaluation.labels import attributes, import_xarray, input_attributes, labelled, with_loads
from ..evaluation.plan import Plan, plan_of
from ..evaluation.points import points_of
from ..evaluation.reductions.argument import Reduction
from ..evaluation.reductions.kinds import ALLOWED, EXTREMES, kind_of
from ..mechanism.catalogue import has
from ..mechanism.spelling import did_you_mean
from ..runtime.accuracy import accuracy_of
from ..runtime.compiled_only import compiled_only
from ..runtime.request import several
from ..support.forks import IMPORTS
from ..support.shown import shown
from .layout import layout_of
from .ranking import BestDesigns, Ranking
from .request import Sweep, SweepRequest, identity, reductions_asked

if TYPE_CHECKING:
    import xarray as xr

ORDERS = ("smallest", "largest")
# Kinds of which one end is the better one by itself, or was never the other: their default.
DEFAULTS = {"min": "smallest", "mean": "largest", "median": "largest"}


def _kind_and_order(name: str, kind: str | None, order: Any, reduction: Reduction | None) -> tuple[str, str]:
    """The kind that designs are ranked by, and which end is the best; the first allowed kind by default."""
    known = tuple(EXTREMES) if reduction is None else reduction.kinds
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
    return known[0] if kind is None else kind, end


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


def search_of(asked: SweepRequest, by: Any, count: int, order: str | None) -> Sweep:
    """The search for `count` designs, checked; over an axis theta a design is ranked by its extreme."""
    names, branch, accuracy, reduce = asked.names, asked.branch, asked.accuracy, asked.reduce
    name, kind = _named(by, reduce)
    wanted = dict.fromkeys(((names,) if isinstance(names, str) else several(names)) + (name,))
    outer = outer_of(tuple(wanted), asked.inputs, branch, asked.threads, always=False)
    if reduce is None and "theta" in outer.dimensions:
        reduce = {"theta": kind or "max"}
    reductions = reductions_asked(reduce, outer)
    reduction = None if reductions is None else reductions.along
    if reductions is not None and reduction is None:
        raise ValueError("reduce: designs are ranked by kinds along one axis; rank a reduced sweep itself")
    kind, end = _kind_and_order(name, kind, order, reduction)
    alone = outer._replace(names=(name,))
    if reductions is None:
        step = points_of([name], alone, outer.dimensions, branch, accuracy)
        plan = Plan(alone, branch, accuracy, (step,), tuple(outer.dimensions))
    else:
        plan = plan_of(alone, branch, accuracy, reductions)
    layout = layout_of("auto", plan.sizes, 64, plan.behind, asked.memory)
    others = tuple(other for other in outer.names if other != name)
    variable, axis = (name, None) if reduction is None else (f"{name}_{kind}", reduction.axis)
    ranking = Ranking(name, kind, end, variable, axis, count, tuple(plan.sizes.values()))
    told = identity(plan, accuracy_of(accuracy), (), (count, name, kind, end), outer.names)
    return Sweep(plan, layout, empty_dataset(), told, ranking, others)


def empty_dataset() -> "xr.Dataset":
    """A Dataset of nothing."""
    import_xarray()
    with IMPORTS:
        import xarray

    return xarray.Dataset()


def designs_of(search: Sweep, kept: BestDesigns) -> "xr.Dataset":
    """The designs by rank, with every name at the point where it is attained."""
    plan, outer, ranking = search.plan, search.plan.outer, search.ranking
    assert ranking is not None
    state = outer.given.get("omega") is not None
    index = np.unravel_index(kept.places, ranking.shape) if ranking.shape else ()
    design = {name: outer.axes[name][i] for name, i in zip(plan.dims, index, strict=True)}
    attained = {} if ranking.axis is None or np.isnan(kept.theta).all() else {ranking.axis: kept.theta}
    scalars = {name: array for name, array in outer.coordinates.items() if not array.ndim}
    told = plan.steps[0].outputs[ranking.variable].attributes
    variables: dict[str, Any] = {ranking.variable: ("rank", kept.values, told)}
    if kept.places.size and (ranking.axis is None or attained):
        point: dict[str, Any] = {n: a.item() for n, a in scalars.items()}
        point |= {**outer.loads, **design, **attained}
        options: dict[str, Any] = {"branch": plan.branch, "accuracy": plan.accuracy}
        for name in search.others:
            with compiled_only():
                value = np.broadcast_to(evaluate(name, **point, **options), kept.places.shape)
            variables[name] = ("rank", np.array(value), attributes(name, state))
    for name, values in {**design, **attained}.items():
        variables[name] = ("rank", values, input_attributes(name))
    if ranking.axis is not None:
        share = 1.0 - kept.skipped / outer.axes[ranking.axis].size
        words = f"share of the points along {ranking.axis} that have a {ranking.name}"
        variables["feasible_fraction"] = ("rank", share, {"units": "1", "long_name": words})
    total = {"units": "1", "long_name": f"share of all points of the grid that have a {ranking.name}"}
    variables["feasible"] = ((), kept.feasible / plan.points, total)
    found = labelled({}, scalars, plan.branch, plan.accuracy)
    ranks = ("rank", np.arange(1, kept.places.size + 1), {"units": "1", "long_name": "the best one is 1"})
    found = found.assign_attrs(search.identity)
    found = found.assign(variables).assign_coords(rank=ranks).set_coords([*design, *attained])
    return with_loads(found, outer.loads)
