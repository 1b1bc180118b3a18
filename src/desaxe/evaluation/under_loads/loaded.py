"""Loads among the inputs of a call: those that vary with the motion, and labelled arrays."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.function import FunctionOverTheta
from ...loads.load import Load
from ...loads.resolve import VARIABLE, split
from ...loads.tabulated import over_theta
from ...mechanism.closed import TURN
from ...mechanism.messages import amount, message_of
from ..arrays import as_array

Array = NDArray[Any]
GAP = 1.5  # steps: a table that lacks no more of a turn is a whole one


def loads_of(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Load]]:
    """The inputs without loads that vary with the motion, and these; an array labelled over theta is one."""
    return split(with_labelled(inputs))


def with_labelled(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs, with labelled arrays over theta replaced by the loads that they stand for."""
    labelled = [n for n in VARIABLE if getattr(inputs.get(n), "dims", ()) == ("theta",)]
    return {**inputs, **{n: labelled_load(n, inputs[n]) for n in labelled}}


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
    x, y = as_array("theta", angles, ("theta",), (name,)), as_array(name, array, (name,), (name,))
    if x.shape != y.shape:
        raise ValueError(f"{name}: {y.size} values over theta, which has {x.size}")
    try:
        if x.size and x[-1] - x[0] < TURN - GAP * np.diff(x).max(initial=0.0):
            first, last = (amount("theta", end, "g", says_unit=True) for end in (x[0], x[-1]))
            raise ValueError("its angles go from " + first + " to " + last + ", which is not a whole turn")
        return over_theta(x, y)
    except ValueError as error:
        if theta is None or not np.array_equal(x, as_array("theta", theta, ("theta",), (name,))):
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
    dimensions = getattr(value, "dims", ())
    if dimensions == ("theta",) and name in VARIABLE:
        return True
    other = [str(d) for d in dimensions if d != name and d in inputs]
    if other:
        raise ValueError(
            f"{name} has the dimensions {', '.join(map(str, dimensions))}: a grid is the outer product of "
            "its inputs, each with one dimension of its own; F_X and F_Y may be over theta alone"
        )
    return False
