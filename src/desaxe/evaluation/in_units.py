"""Labelled results in other units than SI."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..compiler.languages.numba.reductions import KINDS
from ..mechanism.inputs import INPUTS
from ..mechanism.unit_system import SI, Conversion, UnitSystem
from ..mechanism.units import registry
from ..support.forks import IMPORTS

if TYPE_CHECKING:
    import xarray as xr

FLAGS = ("status", "can_turn", "kind")


def in_units(
    dataset: "xr.Dataset",
    units: UnitSystem,
    given: Mapping[str, Any] | None = None,
    names: Mapping[str, str] | None = None,
    as_quantity: bool = False,
) -> "xr.Dataset":
    """A Dataset in other units, its attributes too.

    given        coordinates that were given as plain numbers in these units, and are kept as they are
    names        variable -> the quantity that it is about, where its name does not say so
    as_quantity  data as pint quantities instead (extra `units`)
    """
    result = dataset.copy()
    for key in map(str, dataset.variables):
        array = dataset[key]
        if key in FLAGS or array.dtype.kind not in "fc" or "units" not in array.attrs:
            continue
        conversion = conversion_of_variable(units, (names or {}).get(key, key), array.attrs["units"])
        lazy = array.chunks is not None  # a sweep's, which may be larger than memory
        values = array.data / float(conversion.si) if lazy else conversion.shown(array.values)
        if given is not None and key in given:
            with IMPORTS:
                import numpy as np

            values = np.asarray(given[key], dtype=np.float64)
        attributes = {**array.attrs, "units": conversion.unit}
        if as_quantity and key in dataset.data_vars and conversion.unit != "1":
            with IMPORTS:
                import numpy as np

            values = registry().Quantity(values if lazy else np.asarray(values), conversion.unit)
            del attributes["units"]
        changed = {key: (array.dims, values, attributes)}
        result = result.assign_coords(changed) if key in dataset.coords else result.assign(changed)
    if "scene" in dataset.attrs:
        result.attrs["scene"] = _scene_of(dataset, result)
    return result


def _scene_of(before: "xr.Dataset", after: "xr.Dataset") -> str:
    """The attribute `scene` with the numbers of the inputs in their units."""
    with IMPORTS:
        from .labels import said

    fixed = [name for name, array in before.coords.items() if name in INPUTS and not array.ndim]
    old, new = (
        [said(str(name), found[name], found[name].attrs.get("units", "1")) for name in fixed]
        for found in (before, after)
    )
    told = dict(zip(old, new, strict=True))
    what, mark, numbers = str(before.attrs["scene"]).partition("; ")
    return what + mark + ", ".join(told.get(part, part) for part in numbers.split(", "))


def conversion_of_variable(units: UnitSystem, name: str, unit: str) -> Conversion:
    """The conversion of a variable with this SI unit: that of the quantity that its name is about."""
    stripped = [name.removeprefix(f"{kind}_") for kind in KINDS]
    words = name.split("_")  # a_C_max_mean, Y_at_60_deg
    stripped += ["_".join(words[:count]) for count in range(len(words) - 1, 0, -1)]
    for known in dict.fromkeys([name, *stripped]):
        try:
            if "_wrt_" in known or SI.of(known).unit == unit:
                return units.of(known)
        except ValueError:
            continue
    return units.of_unit(unit)
