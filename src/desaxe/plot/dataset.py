"""Arrays of `evaluate` and motions of `simulate` as a Dataset to draw, with samples at jumps of loads."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arcs import arcs_of
from ..evaluation.evaluate import evaluate
from ..evaluation.labels import attributes, import_xarray, known_loads, labelled, with_loads
from ..loads.along_motion import members_of
from ..loads.load import Load, OverTheta, OverY
from ..loads.resolve import split
from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS, Input
from ..mechanism.quantity_units import SI
from ..mechanism.read import read_array
from ..support.forks import IMPORTS
from ..support.shown import printed, with_unit
from ..units.parse import factor_to_si

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
STARTS = {  # what a motion has beside the inputs of the mechanism
    "theta0": INPUTS["theta"],
    "omega_start": INPUTS["omega"],
    "torque": Input("T_in", "N*m", "torque on the crank"),
}
BESIDE = 2.0**-44  # rad: more than what is rounded of the angle of a jump, and nothing in a picture


# ---- selection -----------------------------------------------------------------------------------


def chosen(dataset: "xr.Dataset", name: str, over: str, family: str | None) -> "xr.DataArray":
    """The quantity with the dimensions (family, over) or (over); samples at the jumps of its loads, too."""
    if family == over:
        raise ValueError(f"family = {family!r}: it must be another dimension than over")
    others = [str(dim) for dim in dataset[name].dims if dim != over] if name in dataset else []
    family = family or (others[0] if len(others) == 1 else None)
    return with_jumps(dataset, choose(dataset, name, [*([family] if family else []), over]), over)


def choose(dataset: "xr.Dataset", name: str, dims: Sequence[str]) -> "xr.DataArray":
    """The quantity with these dimensions, and no others."""
    if name not in dataset:
        raise ValueError(f"no {name!r} in this dataset, it has: {', '.join(map(str, dataset.data_vars))}")
    array = dataset[name]
    for dim in reversed(dims):
        if dim not in array.dims:
            known = ", ".join(map(str, array.dims)) or "none"
            raise ValueError(f"{name} has no dimension {dim!r}, it has: {known}")
    rest = [str(dim) for dim in array.dims if dim not in dims]
    if rest:
        selection = ", ".join(f"{dim}=..." for dim in rest)
        raise ValueError(
            f"{name} varies with {', '.join(rest)} too: choose a value first, dataset.sel({selection})"
        )
    return array.transpose(*dims)


def input_in_si(array: "xr.DataArray") -> Array:
    """The values of a labelled input in its SI unit, whatever it is labelled in."""
    return read_array(INPUTS[str(array.name)], array)


# ---- arrays and motions --------------------------------------------------------------------------


def as_dataset(result: Any, over: str, inputs: Mapping[str, Any]) -> "xr.Dataset":
    """The Dataset of a dict of arrays; a Dataset is returned unchanged.

    A motion has its histories, over t or over theta.

    `inputs` are those that the arrays were computed with, beside or instead of those that an answer of
    `evaluate` remembers. Each varies along one axis of the arrays. Raises TypeError where the one `over`
    which a curve is drawn is missing, ValueError where an input does not fit.
    """
    if hasattr(result, "data_vars"):
        if inputs:
            raise TypeError(f"a Dataset has its inputs: leave {', '.join(inputs)} out")
        dataset: xr.Dataset = result
        return dataset
    if is_motion(result):
        return dataset_of_motion(result, over)
    numbers, loads = split({**getattr(result, "inputs", {}), **inputs})
    shape = np.broadcast_shapes(*(np.shape(array) for array in result.values()))
    arrays = {name: _numbers(name, value) for name, value in numbers.items() if value is not None}
    if over not in arrays:
        raise TypeError(f"a dict does not say {over}: give it, as in curves(found, name, {over}={over})")
    dims: dict[int, str] = {}
    coordinates: dict[str, Any] = {}
    for name, array in sorted(arrays.items(), key=lambda item: item[0] != over):
        axes = [len(shape) - array.ndim + k for k, size in enumerate(array.shape) if size > 1]
        if len(axes) > 1 or (axes and array.size != shape[axes[0]]):
            raise ValueError(
                f"{name}: it varies along one axis of arrays of the shape {shape}, got {array.shape}"
            )
        if not axes or dims.setdefault(axes[0], name) == name:
            coordinates[name] = np.asarray(array.reshape(-1) if axes else array.reshape(-1)[0])
    named = [dims.get(axis, f"axis_{axis}") for axis in range(len(shape))]
    values = {
        name: (named, np.broadcast_to(np.asarray(array), shape), attributes(name, "omega" in arrays))
        for name, array in result.items()
    }
    return with_loads(labelled(values, coordinates, int(numbers.get("branch", 1))), loads)


def _numbers(name: str, value: Any) -> Any:
    if name not in INPUTS:
        raise TypeError(f"no input {name!r}; there are {', '.join(INPUTS)}")
    return read_array(INPUTS[name], value)


def is_motion(result: Any) -> bool:
    """True for a result of `simulate`."""
    return hasattr(result, "keys") and {"t", "theta", "omega", "energy_residual"} <= result.keys()


def dataset_of_motion(result: Any, over: str) -> "xr.Dataset":
    """The histories of a motion, or of those of many designs, over t or over theta.

    ValueError for another `over`, and for theta of many designs, each of which has angles of its own.
    """
    import_xarray("a picture of a motion")
    with IMPORTS:
        import xarray

    t, designs = np.asarray(result["t"]), np.shape(result["theta"])[:-1]
    if over not in ("t", "theta"):
        raise ValueError(f"over = {over!r}: a motion has its histories over 't' or over 'theta'")
    if over == "theta" and designs:
        raise ValueError("over = 'theta': each of these designs has its own angles; give over='t'")
    units = getattr(result, "system", None) or SI
    coordinates = _designs(getattr(result, "inputs", {}), designs, units)
    names = list(coordinates)
    histories = {
        name: ((*names, over), np.asarray(values), _attributes(name, units))
        for name, values in result.items()
        if name not in ("t", over) and np.shape(values) == (*designs, t.size)
    }
    coordinate = (over, np.asarray(result[over]), _attributes(over, units))
    return xarray.Dataset(histories, coords={**coordinates, over: coordinate})


def _designs(inputs: Mapping[str, Any], shape: tuple[int, ...], units: Any) -> dict[str, Any]:
    """A coordinate for each axis of designs: the input that differs along it, or texts where several do."""
    arrays = {}
    for name, value in inputs.items():
        row = STARTS.get(name) or INPUTS[name]
        if value is not None and not callable(value) and np.ndim(value):
            arrays[name] = np.array(units.of(row.name).shown(read_array(row, value)), ndmin=len(shape))
    result: dict[str, Any] = {}
    for axis, size in enumerate(shape):
        along = {n: a.reshape(-1) for n, a in arrays.items() if a.shape[axis] == a.size == size}
        spelled = {n: printed(units.of(STARTS[n].name if n in STARTS else n).unit) for n in along}
        if len(along) == 1:
            ((name, values),) = along.items()
            result[name] = (name, values, {"units": spelled[name]})
            continue
        name = "design" if len(shape) == 1 else f"design_{axis}"
        words = [[with_unit(f"{n} = {x:.6g}", spelled[n]) for x in a] for n, a in along.items()]
        texts = [", ".join(parts) for parts in zip(*words, strict=True)] or [*map(str, range(size))]
        result[name] = (name, texts)
    return result


def _attributes(name: str, units: Any) -> dict[str, Any]:
    """Meaning and unit of a history."""
    base, _, parameter = name.partition("_wrt_")
    if parameter and base in ("theta", "omega"):
        unit = units.of(base).per([units.of(parameter)]).unit
        return {"units": unit, "long_name": f"derivative of {base} with respect to {parameter}"}
    meaning = "time" if name == "t" else INPUTS[name].meaning if name in INPUTS else None
    words = attributes(name, state=True) if meaning is None else {"long_name": meaning}
    return {**words, "units": units.of(name).unit}


# ---- jumps of loads ------------------------------------------------------------------------------


def with_jumps(dataset: "xr.Dataset", array: "xr.DataArray", over: str) -> "xr.DataArray":
    """The curves of (family, over) or (over), with more samples where a load of the dataset jumps.

    Unchanged where nothing jumps, or where the loads are not known, as in a dataset that comes from a file.
    """
    name, loads = str(array.name), known_loads(dataset)
    unit = array.attrs.get("units")
    if over != "theta" or not loads or unit is None or array["theta"].size < 2:
        return array
    inputs = {n: input_in_si(c) for n, c in array.coords.items() if n in INPUTS and n not in loads}
    samples = inputs.pop("theta")
    branch = int(dataset.attrs["branch"])
    angles = _jumps(loads, inputs, branch, float(samples.min()), float(samples.max()))
    if not angles.size:
        return array
    columns: dict[str, Any] = {n: v[:, None] if v.ndim else v for n, v in inputs.items()}
    there = evaluate(name, theta=angles, branch=branch, **columns, **loads)
    si = quantity(name, "omega" in inputs).unit
    there = np.broadcast_to(there, (*array.shape[:-1], angles.size)) / float(factor_to_si(name, unit, si))
    angles = np.clip(angles, samples.min(), samples.max())
    degree = float(factor_to_si("theta", str(array["theta"].attrs["units"]), "rad"))
    theta = np.append(array["theta"].values, angles / degree)
    order = np.argsort(theta, kind="stable")
    values = np.concatenate([array.values, there], axis=-1)[..., order]
    others = {n: c for n, c in array.coords.items() if "theta" not in c.dims}
    coords = {**others, "theta": ("theta", theta[order], array["theta"].attrs)}
    return type(array)(values, coords, array.dims, name, array.attrs)


def _jumps(
    loads: Mapping[str, Load], inputs: Mapping[str, Array], branch: int, low: float, high: float
) -> Array:
    """Angles before and after every jump of one of the designs, ascending, those at the ends included."""
    every = [np.empty(0)]
    arrays = np.broadcast_arrays(*(np.atleast_1d(v) for v in inputs.values()))
    for load in members_of(loads.values()):
        if isinstance(load, OverTheta):
            nodes = np.array(load.nodes(low, high, smooth=False))
            every += [nodes, np.nextafter(nodes, -inf)]
        elif isinstance(load, OverY) and load.jumping:
            arcs = arcs_of(load, dict(zip(inputs, arrays, strict=True)), branch, (low, high))
            starts = arcs.starts[arcs.leaps]
            every += [starts - BESIDE, starts + BESIDE]
    angles = np.unique(np.concatenate(every))
    return angles[(angles >= low - 2.0 * BESIDE) & (angles <= high + 2.0 * BESIDE)]
