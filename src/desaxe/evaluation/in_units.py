"""Results in other units than SI: labelled ones, answers, numbers."""

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from ..mechanism.inputs import INPUTS
from ..mechanism.messages import Message
from ..mechanism.quantity_units import SI, UnitSystem, conversion_of
from ..support.answer import Answer
from ..support.forks import IMPORTS
from ..units.pint_units import registry
from ..units.system import Conversion

if TYPE_CHECKING:
    import xarray as xr


FLAGS = ("status", "can_turn", "kind")


class Shown(NamedTuple):
    """The form of results: a unit system, as plain numbers or as pint quantities."""

    system: UnitSystem
    as_quantity: bool = False

    def number(self, value: Any, conversion: Conversion) -> Any:
        """A number or array in SI units."""
        shown = conversion.shown(value)
        if not self.as_quantity or conversion.unit in ("", "1"):
            return shown
        return registry().Quantity(shown, conversion.unit)

    def entry(self, value: Any, unit: Any) -> Any:
        """A value of an answer, whose unit is a text, or a mapping of units by key."""
        if type(value) is float and isinstance(unit, str):  # the most usual one first
            return self.number(value, conversion_of(unit, self.system))
        if isinstance(value, Message):
            return value.in_units(self.system)
        if getattr(getattr(value, "dtype", None), "hasobject", False):  # designs, each with its own entry
            result = value.copy()
            flat = result.reshape(-1)
            for k, part in enumerate(flat):
                flat[k] = self.entry(part, unit)
            return result
        if unit is None or value is None or isinstance(value, (str, bool)):
            return value
        if hasattr(value, "dims"):
            labelled = value.to_dataset(name=unit.name)
            return in_units(labelled, self.system, as_quantity=self.as_quantity)[unit.name]
        if isinstance(value, Mapping):
            return {key: self.entry(part, self._of(unit, key)) for key, part in value.items()}
        if hasattr(value, "_fields"):
            keys = unit if isinstance(unit, Mapping) else ("value", "error_bound")  # a record, or a Quality
            return value._replace(**self.entry({key: getattr(value, key) for key in keys}, unit))
        if isinstance(value, (tuple, list)):
            return type(value)(self.entry(part, unit) for part in value)
        return self.number(value, conversion_of(unit, self.system))

    def texts(self, units: Mapping[Any, Any]) -> dict[Any, Any]:
        """The units themselves, in these."""
        return {
            key: self.texts(unit) if isinstance(unit, Mapping) else conversion_of(unit, self.system).unit
            for key, unit in units.items()
        }

    @staticmethod
    def _of(unit: Any, key: Any) -> Any:
        """The unit of a key; one text holds for all of them."""
        return unit.get(key) if isinstance(unit, Mapping) else unit


def in_units(
    found: Any,
    units: UnitSystem,
    inputs: Mapping[str, Any] | None = None,
    as_quantity: bool = False,
) -> Any:
    """A result in SI units in others: an Answer by the units that it knows, a Dataset, its attributes too.

    given        coordinates that were given as plain numbers in these units, and are kept as they are
    as_quantity  numbers as pint quantities instead (extra `units`)
    """
    if not isinstance(found, Answer):
        return _dataset_in_units(found, units, inputs, as_quantity)
    shown = Shown(units, as_quantity)
    result = copy.copy(found)
    for key, value in found.items():
        result[key] = shown.entry(value, found.units.get(key))
    result.convert_rest(shown)
    result.become({} if as_quantity else shown.texts(found.units), units)
    return result


def _dataset_in_units(
    dataset: "xr.Dataset",
    units: UnitSystem,
    inputs: Mapping[str, Any] | None,
    as_quantity: bool,
) -> "xr.Dataset":
    """A Dataset in other units, its attributes too; see `in_units`."""
    with IMPORTS:
        import numpy as np

        from .labels import known_loads, loads_text, said
    result = dataset.copy()
    for key in map(str, dataset.variables):
        array = dataset[key]
        if key in FLAGS or array.dtype.kind not in "fc" or "units" not in array.attrs:
            continue
        name, unit = array.attrs.get("quantity", key), array.attrs["units"]
        known = SI.find(name) == Conversion(unit) and units.find(name)
        conversion = known or units.of_unit(unit)
        lazy = array.chunks is not None  # a sweep's, which may be larger than memory
        values = array.data / float(conversion.si) if lazy else conversion.shown(array.values)
        if inputs is not None and key in inputs:
            values = np.asarray(inputs[key], dtype=np.float64)
        attributes = {**array.attrs, "units": conversion.unit}
        if as_quantity and key in dataset.data_vars and conversion.unit != "1":
            values = registry().Quantity(values if lazy else np.asarray(values), conversion.unit)
            del attributes["units"]
        changed = {key: (array.dims, values, attributes)}
        result = result.assign_coords(changed) if key in dataset.coords else result.assign(changed)
    loads = known_loads(dataset)
    if loads:
        result.attrs["loads"] = loads_text(loads, units)
    if "scene" in dataset.attrs:
        fixed = [name for name, array in dataset.coords.items() if name in INPUTS and not array.ndim]
        old, new = (
            [said(str(name), one[name], one[name].attrs.get("units", "1")) for name in fixed]
            for one in (dataset, result)
        )
        message = dict(zip(old, new, strict=True))
        what, mark, numbers = str(dataset.attrs["scene"]).partition("; ")
        result.attrs["scene"] = what + mark + ", ".join(message.get(one, one) for one in numbers.split(", "))
    return result
