"""Names under loads at the points of large arrays: by one kernel, which looks the tables up.

Tables over the slider's place and over the crank angle are its arguments; of a function of theta, which
nothing compiles, the values at each point are. Points at which rounding may decide on the side of a jump are
answered again by the road of few points, exactly, and so are arrays with a design next to its change point.
"""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import numpy as np

from ...loads.load import Load, OverTheta, OverY, TableOverTheta
from ...loads.pieces import FLAT, NEAR, Place
from ...loads.resolve import LoadPlan
from ...mechanism.names import LENGTHS
from ...runtime.kernels import KernelKey, key_of, plain_of
from ...runtime.request import Request
from ...runtime.threads import least_of, run_in_blocks, run_parts
from ...runtime.wide_margins import all_have_wide_margins
from ..arrays import as_array, broadcast_shape, dtype_of
from ..loops import Loops, loops_over
from .request import LEAST, Array, are_extreme_under, table_arrays, under_loads

PART = 2**15  # points of which the motion is in the cache


def points_under_loads(
    plan: LoadPlan, kept: Sequence[str], numbers: Mapping[str, Any], branch: int, threads: int | None
) -> tuple[dict[str, Array], Array | None] | None:
    """Totals at all points, and the places of those that rounding leaves open; None without a kernel.

    plan   its names include the motion that `opens` asks for
    kept   those of its names that are returned
    """
    wanted = with_tables(under_loads(plan, numbers, branch, "standard"), plan.loads)
    own = {
        name for load in plan.loads for name in (load, f"{load}_by_theta", f"{load}_first", f"{load}_period")
    }
    inputs = [name for name in wanted.inputs if name not in own]
    arrays = {name: as_array(name, numbers.get(name), inputs, wanted.shown) for name in inputs}
    shape = broadcast_shape(arrays)
    if prod(shape) < LEAST or are_extreme_under(plan.loads, arrays):
        return None
    functions = {n: a for n, a in plan.loads.items() if isinstance(a, OverTheta) and n in wanted.inputs}
    if functions:
        found = plan._replace(loads=functions).forces(Place(arrays["theta"], (), 1.0, branch), {})
        slopes = {f"{force}_by_{p}": slope for (force, p), slope in found.slopes.items()}
        arrays |= {n: a for n, a in (found.values | slopes).items() if n in wanted.inputs}
    scalars = {name: array.item() for name, array in arrays.items() if array.size == 1}
    tables, bounds = tables_of(plan.loads)
    scalars |= {name: value for name, value in bounds.items() if name in wanted.inputs}
    loops = loops_over({name: array for name, array in arrays.items() if array.size != 1}, shape)
    key = _key(wanted, scalars, loops)
    if key is None:
        return None
    outs = {name: np.empty(shape, dtype_of(name)) for name in kept}
    places = {name: out.reshape(loops.sizes) for name, out in outs.items()}
    if len(kept) == len(wanted.shown):
        run_in_blocks(key, {**scalars, **loops.columns, **tables}, [*places.values()], threads)
        return outs, opens(plan.loads, arrays, outs)
    return outs, _in_parts(plan.loads, key, {**scalars, **tables}, loops, wanted.shown, places, threads)


def _in_parts(
    loads: Mapping[str, Load],
    key: KernelKey,
    given: Mapping[str, Any],
    loops: Loops,
    names: Sequence[str],
    places: Mapping[str, Array],
    threads: int | None,
) -> Array | None:
    """Fill `places`; the flat places of open points. The motion that tells them never leaves the cache."""
    found: list[Array] = []
    each = prod(loops.sizes[1:])

    def part(first: int, last: int) -> None:
        columns = {n: c[first:last] if loops.axis_of[n] == 0 else c for n, c in loops.columns.items()}
        own = {n: place[first:last] for n, place in places.items()}
        size = last - first, *loops.sizes[1:]
        own |= {n: np.empty(size) for n in names if n not in own}
        run_in_blocks(key, {**given, **columns}, [own[n] for n in names], 1)
        wide = {n: c.reshape(c.size, *[1] * (len(size) - 1 - loops.axis_of[n])) for n, c in columns.items()}
        some = opens(loads, {**given, **wide}, own)
        if some is not None:
            found.append(some + first * each)

    run_parts(part, loops.sizes[0], threads, max(1, least_of(1) // each), max(1, PART // each))
    return np.sort(np.concatenate(found)) if found else None


def with_tables(wanted: Request, loads: Mapping[str, Load]) -> Request:
    """The request with tables over theta among its lines; where their periods begin and end are inputs."""
    under = wanted.form.under
    assert under is not None
    lines = tuple(
        line._replace(over="theta", period=f"{line.force}_period", first=f"{line.force}_first")
        if isinstance(loads[line.force], TableOverTheta)
        else line
        for line in under.loads
    )
    return wanted._replace(form=wanted.form._replace(under=under._replace(loads=lines)))


def tables_of(loads: Mapping[str, Load]) -> tuple[dict[str, Array], dict[str, float]]:
    """The arrays of the tables of loads, and first angles and periods of those over theta."""
    arrays, bounds = table_arrays(loads), dict[str, float]()
    for name, load in loads.items():
        if isinstance(load, TableOverTheta):
            bounds |= {f"{name}_first": load.table.knots[0], f"{name}_period": load.period}
            arrays[f"{name}_x"], arrays[f"{name}_c"] = map(np.array, load.arrays())
    return arrays, bounds


def _key(wanted: Request, scalars: Mapping[str, float], loops: Loops) -> KernelKey | None:
    """The kernel in one form; None where designs next to their change points take another."""
    sizes, columns, axis_of = loops
    key = key_of(wanted, scalars, columns, axis_of, len(sizes))
    if key.form.wide_margins or plain_of(key) is None:
        return key
    lengths = [columns.get(name, scalars.get(name)) for name in LENGTHS]
    if any(length is None for length in lengths) or not all_have_wide_margins(key.form, *lengths):
        return None
    return key._replace(form=key.form._replace(wide_margins=True))


def motion_of_jumps(loads: Mapping[str, Load]) -> tuple[str, ...]:
    """The names of the motion that tell which points are open, of loads that jump."""
    jumping = [load for load in loads.values() if isinstance(load, OverY) and load.jumping]
    names = (n for load in jumping for n in (*load.kept, *(("Y_wrt_theta",) if load.turns else ())))
    return tuple(dict.fromkeys(names))


def opens(
    loads: Mapping[str, Load], arrays: Mapping[str, Array], motion: Mapping[str, Array]
) -> Array | None:
    """The flat places of points at which rounding may decide on the side of a jump; None without any."""
    found = None
    for load in loads.values():
        if isinstance(load, OverY) and load.jumping:
            _, AB, BC = (arrays[name] for name in LENGTHS)
            with np.errstate(invalid="ignore"):
                along, room = load.along(motion), NEAR * (AB + BC)
                found = np.zeros(along.shape, np.bool_) if found is None else found
                for x in load.jumps:
                    away = along - x
                    found |= np.abs(away, out=away) <= room
                if load.turns:
                    found |= np.abs(motion["Y_wrt_theta"]) <= FLAT * AB
    return np.flatnonzero(found) if found is not None and found.any() else None
