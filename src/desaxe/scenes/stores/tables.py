"""A labelled result as a table: a column for each dimension and name, units in the headings."""

from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr


def table_of(dataset: "xr.Dataset") -> Iterator[list[Any]]:
    """The headings, then a row for each point."""
    columns = [dataset[name] for name in (*dataset.dims, *dataset.data_vars)]
    yield [heading(str(column.name), column.attrs.get("units", "")) for column in columns]
    order = tuple(dataset.dims)
    wide = dict(dataset.sizes)
    full = [
        np.broadcast_to(
            c.transpose(*(d for d in order if d in c.dims)).values.reshape(
                [wide[d] if d in c.dims else 1 for d in order]
            ),
            [wide[d] for d in order],
        )
        for c in columns
    ]
    for index in product(*(range(wide[d]) for d in order)):
        yield [array[index].item() for array in full]


def heading(name: str, unit: str) -> str:
    """A name with its unit."""
    return f"{name} [{unit}]" if unit not in ("", "1") else name
