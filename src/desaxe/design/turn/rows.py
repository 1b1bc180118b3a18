"""The inputs of a call as designs in rows: numbers, loads that vary with the motion, which are bad."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import are_good, as_array, broadcast_shape
from ...evaluation.under_loads.loaded import loads_of
from ...loads.along_motion import with_derivatives
from ...loads.load import Load
from ...mechanism.names import LENGTHS
from ...runtime.request import as_number

Array = NDArray[Any]


class InputRows(NamedTuple):
    """The inputs of designs: a number for all of them, or an array with one for each.

    more   further numbers of a caller; `bad` are designs with a number that is no value of its input
    """

    shape: tuple[int, ...]
    numbers: dict[str, Any]
    more: dict[str, Any]
    loads: dict[str, Load]
    bad: NDArray[np.bool_]

    @property
    def size(self) -> int:
        """The number of designs."""
        return self.bad.size

    def each(self, value: Any) -> Array:
        """One number for each design."""
        return np.broadcast_to(value, (self.size,))


def input_rows(
    caller: str,
    inputs: Mapping[str, Any],
    more: Mapping[str, Array] | None = None,
    needed: Iterable[str] = LENGTHS,
) -> InputRows:
    """The inputs that are not None, broadcast; an error names one that is missing, or wholly bad."""
    numbers, loads = loads_of({name: value for name, value in inputs.items() if value is not None})
    for name in needed:
        if name not in numbers:
            as_number(name, None, LENGTHS, (caller,))
    arrays = {name: as_array(name, value, LENGTHS, (caller,)) for name, value in numbers.items()}
    more = more or {}
    shape = broadcast_shape({**arrays, **more})
    empty = next((name for name, a in {**arrays, **more}.items() if not a.size), None)
    if empty is not None:
        raise ValueError(f"{empty}: an empty array; expected at least one design")
    good = [np.broadcast_to(are_good(name, a), shape) for name, a in arrays.items()]
    good += [np.broadcast_to(np.isfinite(a), shape) for a in more.values()]
    bad = ~np.logical_and.reduce([np.ones(shape, bool), *good]).reshape(-1)
    scales = arrays if "omega" in arrays or "omega0" in arrays else {**arrays, "omega": np.array(1.0)}

    def rows(values: Mapping[str, Array]) -> dict[str, Any]:
        return {n: np.broadcast_to(v, shape).reshape(-1) if v.ndim else v.item() for n, v in values.items()}

    return InputRows(shape, rows(arrays), rows(more), with_derivatives(loads, scales), bad)
