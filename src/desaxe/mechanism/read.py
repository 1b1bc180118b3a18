"""One reader: plain numbers, texts with a unit, pint quantities, and arrays of these, as numbers in SI units.

A row says name, unit and limit: one of `INPUTS`, or a row of the caller's own for what is no input. Plain
numbers are in the units of the caller's system, SI without; texts, pint quantities and arrays with an
attribute `units` name theirs themselves.
"""

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING, Any

from ..support.forks import IMPORTS
from ..support.lazy import np
from ..support.shown import shown
from .inputs import INPUTS, Input, is_beyond, limit_of
from .messages import named

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..units.system import Conversion
    from .quantity_units import UnitSystem


def number_of(row: Input, value: Any, system: "UnitSystem | None" = None) -> float | None:
    """The number in the row's unit; None for an array or anything else, ValueError beyond its limit."""
    if system or isinstance(value, str) or hasattr(value, "magnitude"):
        value = in_si(row, value, system)
    if isinstance(value, bool) or not (isinstance(value, (int, float)) or is_numpy_number(value)):
        return None
    try:
        number = float(value)
    except OverflowError:
        raise ValueError(f"{row.name} = {shown(value)}: it must be {row.limit}, at most 1.8e308") from None
    if not (-inf < number < inf and (row.least is None or row.least <= number)):
        raise ValueError(named(row.name, value) + f": it must be {row.limit}")
    if row.name in INPUTS and is_beyond(row.name, number):
        raise ValueError(named(row.name, value) + f": {limit_of(row.name, number)}")
    return number


def read(
    row: Input,
    value: Any,
    caller: str,
    expected: str = "a number",
    system: "UnitSystem | None" = None,
) -> float:
    """The number in the row's unit; TypeError that says what the caller expects for anything else."""
    number = number_of(row, value, system)
    if value is None:
        raise TypeError(f"{row.name} is missing: {caller} expects {expected}")
    if number is None:
        raise TypeError(named(row.name, value) + f": {caller} expects {expected}")
    return number


def read_array(row: Input, value: Any, system: "UnitSystem | None" = None) -> "NDArray[np.float64]":
    """Real numbers as a float64 array in the row's unit; TypeError that names the row for anything else."""
    graph = getattr(value, "__dask_graph__", None)
    if graph is not None and graph() is not None:
        remedy = f"give {row.name}.compute(), or grid(..., chunks=) for lazy values"
        raise TypeError(f"{row.name}: a Dask array; {remedy}")
    if system or not isinstance(value, (tuple, list)):
        value = in_si(row, value, system)
    value = getattr(value, "data", value) if hasattr(value, "dims") else value
    if hasattr(value, "mask") and np.ma.is_masked(value):
        raise TypeError(f"{row.name}: a masked array; fill it first, for example with .filled(np.nan)")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError, OverflowError):  # rows of different lengths
        raise TypeError(f"{row.name} = {shown(value)}: expected a number or an array of numbers") from None
    if array.dtype.kind == "U":
        texts = array.reshape(-1).tolist()
        array = np.array([in_si(row, text) for text in texts]).reshape(array.shape)
    if array.dtype.kind not in "fiu":
        kind = f"an array of {array.dtype}" if array.ndim else f"a {type(value).__name__}"
        raise TypeError(f"{row.name}: expected real numbers, got {kind}: {shown(value)}")
    return array.astype(np.float64, copy=False)


def in_si(row: Input, value: Any, system: "UnitSystem | None" = None) -> Any:
    """A value in the row's unit; labels, chunks and indices stay, what is no number passes as it is."""
    if isinstance(value, str) or hasattr(value, "magnitude"):
        return _with_its_unit(row, value, system)
    if isinstance(value, (tuple, list)):
        parts = [in_si(row, part, system) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if hasattr(value, "dims") and hasattr(value.data, "magnitude"):
        return value.copy(data=in_si(row, value.data))
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if kind and kind in "UTO" and hasattr(value, "tolist"):
        # of texts a Series is refused by its reader, which names the input
        return value if hasattr(value, "iloc") else in_si(row, value.tolist(), system)
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number and kind not in tuple("fiu"):
        several = system and isinstance(value, Sequence) and not isinstance(value, bytes)
        return in_si(row, list(value), system) if several else value
    conversion = _conversion(row, value, system)
    if conversion is None or conversion.si == 1:
        return value
    if hasattr(value, "dims"):
        return _labelled(value, conversion, row.unit)
    if hasattr(value, "iloc"):
        return type(value)(conversion.to_si(value.to_numpy()), index=value.index, name=value.name)
    return conversion.to_si(value)


def _with_its_unit(row: Input, value: Any, system: "UnitSystem | None") -> Any:
    """A text or a pint quantity; a text that is a number alone is in the system's unit."""
    with IMPORTS:
        from ..units.parse import in_unit
        from ..units.text import with_unit_of

    conversion = _plain(row, system)
    if isinstance(value, str) and conversion is not None:
        value = with_unit_of(f"1 {conversion.unit}", value)
    return in_unit(row.name, value, row.unit)


def _conversion(row: Input, value: Any, system: "UnitSystem | None") -> "Conversion | None":
    """The conversion of numbers: from the unit of their attribute `units`, else from the system's."""
    unit = getattr(value, "attrs", {}).get("units")
    if unit is None:
        return _plain(row, system)
    with IMPORTS:
        from ..units.system import conversion

    return conversion(row.name, str(unit), row.unit)


def _plain(row: Input, system: "UnitSystem | None") -> "Conversion | None":
    if not system:
        return None
    return system.find(row.name) or system.of_unit(row.unit)


def _labelled(array: Any, conversion: "Conversion", unit: str) -> Any:
    """A labelled array in SI units; one with chunks stays lazy."""
    with IMPORTS:
        import xarray

    result = xarray.apply_ufunc(conversion.to_si, array, dask="parallelized", output_dtypes=[float])
    return result.assign_attrs({**array.attrs, "units": unit})


def is_numpy_number(value: Any) -> bool:
    """True for a NumPy real scalar such as np.float32(1); not for a 0-d array or a time span."""
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    return getattr(value, "shape", None) == () and hasattr(value, "is_integer") and kind in "fiu"
