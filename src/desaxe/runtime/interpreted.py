"""Few points: interpreted one by one while that is cheaper than compiling a kernel."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiler.passes.guard import BAD_INPUT
from ..mechanism.constants import double_constants
from ..mechanism.inputs import INPUTS, SAFE
from .kernels import KernelKey
from .point import point_of

Array = NDArray[Any]


def are_good(name: str, array: Array) -> NDArray[np.bool_]:
    """Mask of the elements that are valid values of an input."""
    least = INPUTS[name].least
    good: NDArray[np.bool_] = np.isfinite(array)
    good = good if least is None else good & (array >= least)
    return good & ~are_beyond(name, array)


def are_beyond(name: str, array: Array) -> NDArray[np.bool_]:
    """Mask of the elements that `is_beyond` holds for."""
    least, most = SAFE
    beyond: NDArray[np.bool_] = np.zeros(array.shape, np.bool_)
    if name != "theta" and array.size and not (array.min() >= -most and array.max() <= most):
        beyond = (np.abs(array) > most) & np.isfinite(array)
    if name == "BC" and array.size and not array.min() >= least:
        beyond = beyond | ((array > 0.0) & (array < least))
    return beyond


def fill_by_points(
    key: KernelKey, scalars: Mapping[str, float], columns: Mapping[str, Array], outs: Sequence[Array]
) -> None:
    """Fill flat outputs from scalars and flat columns, point by point."""
    point = point_of(key.names, key.form, key.fixed, key.accuracy)
    good = {name: are_good(name, column) for name, column in columns.items()}
    if key.accuracy == "extended" and "theta" in good:
        good["theta"] &= np.abs(columns["theta"]) <= double_constants().limit
    safe = {name: np.where(good[name], column, np.nan).tolist() for name, column in columns.items()}
    for index, here in enumerate(zip(*safe.values(), strict=True)):
        answer = point.run({**scalars, **dict(zip(safe, here, strict=True))})
        for out, value in zip(outs, answer, strict=True):
            out[index] = value
    bad = ~np.logical_and.reduce(list(good.values()))
    for out in outs:
        if out.dtype == np.int8:  # a status
            out[bad] = BAD_INPUT
