"""Curves over the crank angle under loads that jump: a node on each side of every jump."""

from collections.abc import Mapping
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..evaluation.labels import known_loads
from ..evaluation.under_loads.arcs import arcs_of
from ..loads.along_motion import members_of
from ..loads.load import Load, OverTheta, OverY
from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS
from ..units.pint_units import registry
from .shared import input_in_si

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
BESIDE = 2.0**-44  # rad: more than what is rounded of the angle of a jump, and nothing in a picture


def with_jumps(dataset: "xr.Dataset", array: "xr.DataArray", over: str) -> "xr.DataArray":
    """The curves of (family, over) or (over), with more samples where a load of the dataset jumps.

    Unchanged where nothing jumps, or where the loads are not known, as in a dataset that comes from a file.
    """
    name, loads = str(array.name), known_loads(dataset)
    unit = array.attrs.get("units")
    if over != "theta" or not loads or unit is None or array["theta"].size < 2:
        return array
    given = {n: input_in_si(c) for n, c in array.coords.items() if n in INPUTS and n not in loads}
    samples = given.pop("theta")
    branch = int(dataset.attrs["branch"])
    angles = _jumps(loads, given, branch, float(samples.min()), float(samples.max()))
    if not angles.size:
        return array
    wide: dict[str, Any] = {n: v[:, None] if v.ndim else v for n, v in given.items()}
    found = evaluate(name, theta=angles, branch=branch, **wide, **loads)
    si = quantity(name, "omega" in given).unit
    found = np.broadcast_to(found, (*array.shape[:-1], angles.size)) * _factor(si, unit)
    angles = np.clip(angles, samples.min(), samples.max())
    theta = np.append(array["theta"].values, angles * _factor("rad", str(array["theta"].attrs["units"])))
    order = np.argsort(theta, kind="stable")
    values = np.concatenate([array.values, found], axis=-1)[..., order]
    kept = {n: c for n, c in array.coords.items() if "theta" not in c.dims}
    coords = {**kept, "theta": ("theta", theta[order], array["theta"].attrs)}
    return type(array)(values, coords, array.dims, name, array.attrs)


def _jumps(
    loads: Mapping[str, Load], given: Mapping[str, Array], branch: int, low: float, high: float
) -> Array:
    """Angles before and after every jump of one of the designs, ascending, those at the ends included."""
    found = [np.empty(0)]
    columns = dict(zip(given, np.broadcast_arrays(*(np.atleast_1d(v) for v in given.values())), strict=True))
    for load in members_of(loads.values()):
        if isinstance(load, OverTheta):
            nodes = np.array(load.nodes(low, high, smooth=False))
            found += [nodes, np.nextafter(nodes, -inf)]
        elif isinstance(load, OverY) and load.jumping:
            arcs = arcs_of(load, columns, branch, (low, high))
            starts = arcs.starts[arcs.leaps]
            found += [starts - BESIDE, starts + BESIDE]
    angles = np.unique(np.concatenate(found))
    return angles[(angles >= low - 2.0 * BESIDE) & (angles <= high + 2.0 * BESIDE)]


def _factor(from_unit: str, to_unit: str) -> float:
    """The factor from numbers in one unit to numbers in another."""
    if from_unit == to_unit:
        return 1.0
    return float(registry().Quantity(1.0, from_unit).to(to_unit).magnitude)
