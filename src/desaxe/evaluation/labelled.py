"""Labelled arrays: they broadcast by their dimensions, and one over theta is a load."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.function import FunctionOverTheta
from ..loads.load import Load
from ..loads.resolve import VARIABLE, split
from ..loads.tabulated import over_theta
from ..mechanism.closed import TURN
from ..mechanism.inputs import INPUTS
from ..mechanism.messages import amount, message_of
from ..mechanism.read import read_array
from ..support.shown import shown
from .labels import attributes, import_xarray

Array = NDArray[Any]
MOST_SHOWN = 4  # labels in a message
GAP = 1.5  # steps: a table that lacks no more of a turn is a whole one


def is_labelled(value: Any) -> bool:
    """True for an xarray.DataArray that has dimensions."""
    return bool(getattr(value, "dims", ())) and hasattr(value, "coords")


def by_dimensions(
    run: Callable[[Mapping[str, Array]], Mapping[str, Array]],
    names: Sequence[str],
    labelled: Mapping[str, Any],
    others: Mapping[str, Array],
    state: bool,
) -> dict[str, Any]:
    """The values by name as DataArrays, with the coordinates of the labelled inputs and units.

    `run` evaluates plain arrays, which broadcast by position. ValueError for an array without labels beside
    others of several dimensions.
    """
    xarray = import_xarray("labelled arrays")
    several = [name for name, array in others.items() if array.size > 1]
    if several and len({array.dims for array in labelled.values()}) > 1:
        message = ", ".join(f"{name} {array.dims}" for name, array in labelled.items())
        raise ValueError(
            f"{several[0]}: an array without labels beside labelled ones of different dimensions, {message}: "
            "make it an xarray.DataArray too, or pass the .values of all"
        )

    def plain(*columns: Array) -> Any:
        answer, shape = run(dict(zip(labelled, columns, strict=True))), np.broadcast(*columns).shape
        whole = [np.broadcast_to(answer[n], shape) for n in names]
        return tuple(whole) if len(whole) > 1 else whole[0]

    outputs = xarray.apply_ufunc(
        plain, *labelled.values(), join="override", output_core_dims=[()] * len(names)
    )
    result = dict(zip(names, outputs if len(names) > 1 else (outputs,), strict=True))
    return {n: array.rename(n).assign_attrs(attributes(n, state)) for n, array in result.items()}


def refuse_other_labels(inputs: Mapping[str, Any]) -> None:
    """ValueError for labelled arrays of different dimensions or labels where arrays broadcast by position."""
    varying = {name: value for name, value in inputs.items() if not _is_over_theta(name, value)}
    dims = {name: value.dims for name, value in varying.items() if hasattr(value, "dims") and value.dims}
    if len(set(dims.values())) > 1:
        message = ", ".join(f"{name} {along}" for name, along in dims.items())
        raise ValueError(
            f"labelled arrays of different dimensions: {message}; here arrays broadcast by position: make "
            "the dimensions the same, as xarray.broadcast does, or pass the .values"
        )
    refuse_differing(varying)


def refuse_differing(inputs: Mapping[str, Any]) -> None:
    """ValueError that names two inputs whose sizes or labels differ along a dimension that both have.

    A Series goes beside other Series and labelled arrays of one dimension row by row.
    """
    sizes: dict[Any, tuple[str, int]] = {}
    labels: dict[Any, tuple[str, Any]] = {}
    rows = [(name, value.index) for name, value in inputs.items() if hasattr(value, "iloc")]
    for name, value in inputs.items():
        dims = getattr(value, "dims", ())
        for dim, size in zip(dims, value.shape if dims else (), strict=True):
            first, expected = sizes.setdefault(dim, (name, size))
            if size != expected:
                raise ValueError(f"{first} and {name}: {expected} and {size} values along {dim}")
        indexes = {dim: index for dim, index in getattr(value, "indexes", {}).items() if dim in dims}
        for dim, index in indexes.items():
            _refuse_unequal(*labels.setdefault(dim, (name, index)), name, index, str(dim))
        if rows and len(dims) == 1:
            rows += [(name, index) for index in indexes.values()]
    for name, index in rows[1:]:
        _refuse_unequal(*rows[0], name, index, "their rows")


def _refuse_unequal(first: str, expected: Any, name: str, index: Any, dim: str) -> None:
    """ValueError for other labels, as many as expected."""
    if len(index) == len(expected) and not index.equals(expected):
        one, other = (shown([*labels[:MOST_SHOWN]]) for labels in (expected, index))
        raise ValueError(
            f"{first} and {name}: their labels differ along {dim}, {one} and {other}: align them, for "
            f"example by {name}.reindex_like({first}), or pass the .values"
        )


# ---- dimensions that several inputs of a grid share ------------------------------------------------------


def shared_dimensions(inputs: Mapping[str, Any]) -> dict[str, str]:
    """Input -> its dimension: of labelled arrays that share one, and of Series whose index has a name."""
    dims = {n: str(v.dims[0]) for n, v in inputs.items() if is_labelled(v) and v.dims[0] not in inputs}
    names = {n: getattr(v.index, "name", None) for n, v in inputs.items() if hasattr(v, "iloc")}
    rows = {n: dim for n, dim in names.items() if isinstance(dim, str) and dim != n}
    every = [*dims.values(), *rows.values()]
    for name, dim in rows.items():
        if inputs.get(dim) is not None:
            raise ValueError(f"{name}: its index is called {dim}, as another input of the grid is")
    return {n: dim for n, dim in {**dims, **rows}.items() if n in rows or every.count(dim) > 1}


def labels_of(inputs: Mapping[str, Any], shared: Mapping[str, str]) -> dict[str, Any]:
    """The coordinates of shared dimensions; ValueError where those of two inputs differ."""
    if not shared:
        return {}
    xarray = import_xarray()
    arrays = [
        xarray.DataArray(value.to_numpy(), {dim: value.index}, (dim,)) if hasattr(value, "iloc") else value
        for value, dim in ((inputs[name], dim) for name, dim in shared.items())
    ]
    refuse_differing(dict(zip(shared, arrays, strict=True)))
    return {name: label.variable for array in arrays for name, label in array.coords.items() if label.dims}


# ---- loads -------------------------------------------------------------------------------------------


def loads_of(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Load]]:
    """The inputs without loads that vary with the motion, and these; an array labelled over theta is one.

    ValueError for other labelled arrays of different dimensions or labels: the callers broadcast by position.
    """
    refuse_other_labels(inputs)
    return split(with_labelled(inputs))


def with_labelled(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs, with labelled arrays over theta replaced by the loads that they stand for."""
    labelled = [n for n in VARIABLE if _is_over_theta(n, inputs.get(n))]
    return {**inputs, **{n: labelled_load(n, inputs[n]) for n in labelled}}


def _is_over_theta(name: str, value: Any) -> bool:
    """True for a labelled array that is a load over theta."""
    return name in VARIABLE and getattr(value, "dims", ()) == ("theta",)


def split_axes(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Load]]:
    """The inputs of a grid without its loads, and these; a labelled array over theta is one of them."""
    theta = inputs.get("theta")
    made = {
        name: labelled_load(name, value, theta) if name in VARIABLE else value
        for name, value in inputs.items()
        if _is_along(name, value, inputs)
    }
    return split({**inputs, **made})


def labelled_load(name: str, array: Any, theta: Any = None) -> Load:
    """The load over theta of a labelled array, at its own angles or at those of `theta`.

    Where its angles are those of `theta`, and no period of a table, it is known at these alone.
    """
    angles = array.coords.get("theta", theta)
    if angles is None:
        raise ValueError(f"{name}: a labelled array over theta has the coordinate theta")
    x, y = read_array(INPUTS["theta"], angles), read_array(INPUTS[name], array)
    if x.shape != y.shape:
        raise ValueError(f"{name}: {y.size} values over theta, which has {x.size}")
    try:
        if x.size and x[-1] - x[0] < TURN - GAP * np.diff(x).max(initial=0.0):
            first, last = (amount("theta", end, "g", says_unit=True) for end in (x[0], x[-1]))
            raise ValueError("its angles go from " + first + " to " + last + ", which is not a whole turn")
        return over_theta(x, y)
    except ValueError as error:
        if theta is None or not np.array_equal(x, read_array(INPUTS["theta"], theta)):
            raise ValueError(f"{name}: " + message_of(error)) from None
        return FunctionOverTheta(SampledLoad(x, y).at)


class SampledLoad(NamedTuple):
    """A load that is known only at samples of the crank angle."""

    angles: Array
    values: Array

    def at(self, theta: Any) -> Any:
        """The values at angles that are among the samples."""
        order = np.argsort(self.angles)
        place = order[np.searchsorted(self.angles[order], theta).clip(0, order.size - 1)]
        if (self.angles[place] != theta).any():
            raise LookupError("a labelled load over part of a turn is known at its own angles alone")
        return self.values[place]


def _is_along(name: str, value: Any, inputs: Mapping[str, Any]) -> bool:
    """True for a labelled array over theta; ValueError for another one over a different input."""
    if _is_over_theta(name, value):
        return True
    dimensions = getattr(value, "dims", ())
    other = [str(d) for d in dimensions if d != name and d in inputs]
    if other:
        raise ValueError(
            f"{name} has the dimensions {', '.join(map(str, dimensions))}: a grid is the outer product of "
            "its inputs, each with one dimension of its own; F_X and F_Y may be over theta alone"
        )
    return False
