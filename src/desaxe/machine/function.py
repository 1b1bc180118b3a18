"""`machine.function(...)`: a prepared callable in the units of a machine."""

from collections.abc import Mapping
from typing import Any

from ..evaluation.in_units import Shown
from ..mechanism.inputs import INPUTS
from ..mechanism.messages import errors_in
from ..mechanism.quantity_units import unit_of
from ..mechanism.read import in_si


class FunctionInUnits:
    """A prepared callable (`desaxe.function`) whose arguments and values are in the units of a machine.

    names, inputs   as of the function
    units           dict name -> unit, of quantities and inputs
    si              the function itself, in SI units: with `scalar` and `address` for compiled code
    """

    def __init__(self, function: Any, show: Shown) -> None:
        self.si, self._show = function, show
        self.names, self.inputs = function.names, function.inputs
        self.units = {name: show.system.of(name).unit for name in (*self.names, *self.inputs)}

    def __call__(self, *args: Any, out: Any = None, **named: Any) -> Any:
        """The values: an array for a name, a tuple for a list of names."""
        with errors_in(self._show.system):
            result = self.si(*self._positional(args), **self._named(named))
        if not isinstance(result, tuple):
            shown = self._value(result, self.names[0])
            return shown if out is None else _filled(out, shown)
        values = tuple(self._value(v, name) for v, name in zip(result, self.names, strict=True))
        if out is None:
            return values
        outs = [out[name] for name in self.names] if isinstance(out, Mapping) else out
        return tuple(_filled(array, value) for array, value in zip(outs, values, strict=True))

    def jacobian(self, *args: Any, **named: Any) -> dict[str, dict[str, Any]]:
        """The exact derivatives with respect to the inputs: dict name -> dict input -> array."""
        with errors_in(self._show.system):
            result = self.si.jacobian(*self._positional(args), **self._named(named))
        return {
            name: {by: self._show.entry(value, unit_of(name, by)) for by, value in row.items()}
            for name, row in result.items()
        }

    def _positional(self, args: tuple[Any, ...]) -> list[Any]:
        rest = args[len(self.inputs) :]
        pairs = zip(self.inputs, args, strict=False)
        return [*(self._argument(name, value) for name, value in pairs), *rest]

    def _named(self, named: Mapping[str, Any]) -> dict[str, Any]:
        return {key: self._argument(key, v) if key in self.inputs else v for key, v in named.items()}

    def _value(self, found: Any, name: str) -> Any:
        """Convert a value from SI units; labels and chunks stay."""
        if not _is_labelled(found):
            return self._show.entry(found, unit_of(name))
        conversion = self._show.system.of(name)
        result = found / float(conversion.si)
        return result.assign_attrs(units=conversion.unit) if hasattr(result, "dims") else result

    def _argument(self, name: str, value: Any) -> Any:
        """An argument in SI units; texts and pint quantities say their units themselves."""
        return in_si(INPUTS[name], value, self._show.system)

    def __repr__(self) -> str:
        return f"{self.si!r} in {self._show.system!r}"


def _is_labelled(value: Any) -> bool:
    """True for arrays with labels or chunks, which are kept; pint quantities seem to have chunks, too."""
    chunked = hasattr(value, "__dask_graph__") and not hasattr(value, "magnitude")
    return chunked or hasattr(value, "dims")


def _filled(array: Any, value: Any) -> Any:
    array[...] = value
    return array
