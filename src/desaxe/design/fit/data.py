"""Measurements in SI units: samples of the crank angle or the time, and of quantities; NaN where missing."""

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.column_files import Heading, heading_of, named_columns
from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import SI, UnitSystem
from ...support.shown import shown
from ...units.parse import factor_to_si, in_unit
from ...units.scaling import by_digits
from ...units.text import plain_number

Array = NDArray[np.float64]
MOST = 1e100  # of samples and unknowns: squares of residuals and derivatives must not overflow, nor vanish
COURSE = {"theta": "rad", "t": "s"}  # what samples are taken over, and its unit


class Data(NamedTuple):
    """Samples: `course` is "theta" or "t", `at` its values, `measured` a column for each quantity.

    t  the time at each sample, where it was measured beside theta
    """

    course: str
    at: Array
    measured: dict[str, Array]
    t: Array | None = None

    @property
    def size(self) -> int:
        """The number of measured values."""
        return sum(int(np.isfinite(column).sum()) for column in self.measured.values())


def read_data(data: Any, state: bool) -> Data:
    """The measurements, checked; errors name the column."""
    columns = columns_of(data)
    names = [heading.name for heading in columns]
    if len(set(names)) < len(names):
        raise TypeError(f"fit: data has one column of each name, got {', '.join(names)}")
    course = [name for name in COURSE if name in names]
    if not course:
        raise TypeError(f"fit: data has one of theta and t, got {', '.join(names) or 'nothing'}")
    units = {name: COURSE.get(name) or quantity(name, state).unit for name in names}
    measured = {
        heading.name: _column(heading, column, units[heading.name]) for heading, column in columns.items()
    }
    at = measured.pop(course[0])
    if not measured.keys() - COURSE.keys():
        raise TypeError(f"fit: data has {' and '.join(course)} and no measured quantity")
    for name, column in measured.items():
        if column.shape != at.shape:
            raise ValueError(f"data: {name} has {column.size} samples, {course[0]} has {at.size}")
    measured = {name: np.where(np.isfinite(at), column, np.nan) for name, column in measured.items()}
    for name, column in measured.items():
        if not np.isfinite(column).any():
            raise ValueError(f"data: {name} has no finite sample")
    t = measured.pop("t", None)
    return Data(course[0], np.where(np.isfinite(at), at, 0.0), measured, t)


def columns_of(data: Any, units: UnitSystem = SI) -> dict[Heading, Any]:
    """The columns of a file, a mapping, a DataFrame or a Dataset; a course may be its index or coordinate.

    units  of the columns of a file without a unit
    """
    if isinstance(data, (str, PathLike)):
        columns = named_columns(data, COURSE.__contains__, _is_known)
        return {
            Heading(name, unit or _unit(name, units)): samples for (name, unit), samples in columns.items()
        }
    if hasattr(data, "data_vars"):
        columns = {name: one for name, one in data.coords.items() if name in COURSE and one.ndim}
        columns |= data.data_vars
    elif hasattr(data, "columns"):
        index: Any = getattr(data, "index", None)  # polars has none
        columns = {index.name: index.to_numpy()} if getattr(index, "name", None) in COURSE else {}
        columns |= {name: data[name].to_numpy() for name in data.columns}
    elif isinstance(data, Mapping):
        columns = {**data}
    else:
        raise TypeError(
            f"data = {type(data).__name__}: expected a mapping name -> samples, a table or the path of a file"
        )
    return {
        name if isinstance(name, Heading) else heading_of(str(name)): one for name, one in columns.items()
    }


def _unit(name: str, units: UnitSystem) -> str | None:
    conversion = units.find(name)
    return conversion and conversion.unit


def _is_known(name: str) -> bool:
    """True for a course, an input or a quantity; other channels of an instrument are left out."""
    try:
        return name in COURSE or name in INPUTS or bool(quantity(name))
    except ValueError:
        return False


def _column(heading: Heading, values: Any, unit: str) -> Array:
    name, own = heading
    if hasattr(values, "dims"):
        own = own or values.attrs.get("units")
        values = values.values
    if hasattr(values, "magnitude"):
        values = in_unit(name, values, unit)
    try:
        value = np.asarray(values)
        if value.dtype.kind in "SUO":
            _require_plain(value.ravel().tolist())
        column = value.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"data: {name}: expected real numbers") from None
    if np.iscomplexobj(values) or column.ndim != 1:
        raise TypeError(f"data: {name}: expected a row of real numbers, got the shape {column.shape}")
    if own is not None:
        column = by_digits(column, factor_to_si(f"data: {name} in {own!r}", own, unit))
    if np.isinf(column).any():
        raise ValueError(f"data: {name}: an infinite sample; a missing one is NaN")
    if (np.abs(column) > MOST).any():
        raise ValueError(f"data: {name}: a sample beyond {MOST:g} in magnitude")
    return column


def _require_plain(samples: Iterable[Any]) -> None:
    """TypeError for a text that is no plain number."""
    for one in samples:
        if isinstance(one, bytes) or (isinstance(one, str) and plain_number(one) is None):
            raise TypeError(f"{shown(one)} is not a number")
