"""The result of a call in the units of a machine or as pint quantities."""

from collections.abc import Mapping
from typing import Any

from ..evaluation.evaluate import Values
from ..evaluation.in_units import Shown, in_units
from ..evaluation.labels import loads_text, tell_loads
from ..loads.load import Load
from ..mechanism.quantity_units import unit_of, units_by_name
from ..support.answer import Answer


def shown(found: Any, machine: Any, named: Mapping[str, Any], show: Shown) -> Any:
    """The result of a public function, called with these arguments beside a machine's, as it is shown."""
    if hasattr(found, "data_vars"):  # of grid, design_map, sweep
        call = {**machine.in_units(), **named}
        loads = {name: value for name, value in call.items() if isinstance(value, Load)}
        if found.attrs.get("loads") == loads_text(loads):  # that of a sweep knows the text alone
            found = tell_loads(found, loads)
        return in_units(found, show.system, _as_given(found, call), as_quantity=show.as_quantity)
    if type(found) is dict:
        found = Answer(found, units_by_name)
    if isinstance(found, Answer):
        result = in_units(found, show.system, as_quantity=show.as_quantity)
        if isinstance(result, Values):
            result.inputs = {}  # which are in SI units
        return result
    names = named.get("names")
    return found if not isinstance(names, str) or names == "status" else show.entry(found, unit_of(names))


def _as_given(found: Any, call: Mapping[str, Any]) -> dict[str, Any]:
    """The coordinates that were given as plain numbers."""
    kept = {key: value for key, value in call.items() if key in found.coords and _is_plain(value)}
    return {
        key: value
        for key, value in kept.items()
        if found[key].shape == ((len(value),) if hasattr(value, "__len__") else ())
    }


def _is_plain(value: Any) -> bool:
    """True for numbers and arrays without a unit of their own."""
    if isinstance(value, (list, tuple)):
        return all(_is_plain(part) for part in value)
    own = hasattr(value, "magnitude") or "units" in getattr(value, "attrs", {})
    return not own and (isinstance(value, (int, float)) or hasattr(value, "dtype"))
