"""The peaks of a block of designs of a sweep."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.passes.guard import BAD_INPUT
from ..evaluation.arrays import are_good, broadcast_shape
from ..mechanism.own import using
from .designs import Sought, peaks_of_designs, search_of
from .programs import Search

Array = NDArray[Any]
GRADIENT = "gradient_"


class PeakBlock(NamedTuple):
    """The peaks of a block of designs, from arrays of some inputs that broadcast; the others are numbers."""

    sought: Sought
    search: Search
    scalars: tuple[tuple[str, float], ...]
    names: tuple[str, ...]

    @property
    def identity(self) -> str:
        """A text that tells the block from all others, by what its loads are too."""
        return " ".join([repr(self), *(load.identity for load in self.sought.loads.values())])

    @property
    def dtypes(self) -> dict[str, np.dtype[Any]]:
        """The names of the outputs, `gradient_<parameter>` among them, and their dtypes."""
        gradient = (f"{GRADIENT}{name}" for name in self.search.parameters)
        kinds = {**dict.fromkeys(("value", "theta"), np.float64), "side": np.int8}
        kinds |= {**dict.fromkeys(gradient, np.float64), "status": np.int8}
        return {name: np.dtype(kind) for name, kind in kinds.items()}

    def compute(self, *blocks: Array) -> dict[str, Array]:
        """The outputs in the shape to which the blocks broadcast."""
        arrays = {n: np.asarray(block, np.float64) for n, block in zip(self.names, blocks, strict=True)}
        shape = broadcast_shape(arrays)
        flat = {name: np.broadcast_to(array, shape).reshape(-1) for name, array in arrays.items()}
        fine = np.logical_and.reduce([are_good(name, column) for name, column in flat.items()])
        outs = {
            name: np.full(fine.size, {"side": 0, "status": BAD_INPUT}.get(name, np.nan), dtype)
            for name, dtype in self.dtypes.items()
        }
        rows = np.flatnonzero(fine)
        if rows.size:
            found = self._found({name: column[rows] for name, column in flat.items()}, rows.size)
            for name, out in outs.items():
                out[rows] = found[name]
        return {name: out.reshape(shape) for name, out in outs.items()}

    def _found(self, flat: Mapping[str, Array], size: int) -> dict[str, Array]:
        """The outputs of designs without invalid inputs."""
        columns = {**flat, **{name: np.full(size, value) for name, value in self.scalars}}
        with using(self.search.form.own):
            found = peaks_of_designs(self.sought, self.search, columns)
        return {**found, **{f"{GRADIENT}{n}": slope for n, slope in found["gradient"].items()}}


def peak_block(sought: Sought, scalars: Mapping[str, float], varying: tuple[str, ...]) -> PeakBlock:
    """The block of a request; an input of 0 is folded where it is a number."""
    shapes = {n: np.array(scalars[n]) if n in scalars else np.zeros(2) for n in sought.numbers}
    search = search_of(sought.plan, shapes, sought.ends)
    own = sought._replace(threads=sought.threads or 1, loads=dict(sought.loads))
    return PeakBlock(own, search, tuple(scalars.items()), varying)
