"""Results of a call in the units of a machine, or as pint quantities."""

import copy
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..evaluation.in_units import in_units
from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.names import parts
from ..mechanism.unit_system import OTHERS, Conversion, UnitSystem
from ..mechanism.units import registry

# Keys whose values are in the unit of the requested quantity, and keys whose values are plain numbers.
OWN = (
    "value", "lower", "upper", "inner", "mean", "std", "least", "largest", "mean_error", "std_error",
    "percentiles", "cos", "sin", "amplitude", "remainder", "error", "first_order", "second_order",
    "monte_carlo", "worst_case", "X", "Y", "second", "peak",
)  # fmt: skip
PLAIN = (
    "contributions", "sobol", "agreement", "side", "status", "message", "boxes", "points", "samples", "order",
    "kind", "active", "residual", "scale",
)  # fmt: skip

OF_MOTIONS = (
    "theta",
    "omega",
    "t_last",
    "work",
)  # derivatives of these may be by theta0, omega_start, torque


class Shown(NamedTuple):
    """The form of results: a unit system, as plain numbers or as pint quantities."""

    system: UnitSystem
    as_quantity: bool

    def number(self, value: Any, conversion: Conversion) -> Any:
        """A number or array in SI units."""
        shown = conversion.shown(value)
        if not self.as_quantity or conversion.unit in ("", "1"):
            return shown
        return registry().Quantity(shown, conversion.unit)

    def named(self, value: Any, name: str) -> Any:
        """A value of a quantity: a number, an array, or a Quality."""
        if name == "status":
            return value
        if hasattr(value, "dims"):
            return in_units(value.to_dataset(name=name), self.system, as_quantity=self.as_quantity)[name]
        conversion = self.system.of(name)
        if hasattr(value, "error_bound"):
            bound = self.number(value.error_bound, conversion)
            return value._replace(value=self.number(value.value, conversion), error_bound=bound)
        return self.number(value, conversion)

    def mapping(self, found: Mapping[Any, Any], own: Conversion | None) -> Any:
        """A dict of results: each in the unit of its key, or all in the conversion `own`."""
        result = copy.copy(found)
        assert isinstance(result, dict)
        for key, value in found.items():
            result[key] = self._entry(key, value, own)
        return result

    def _entry(self, key: Any, value: Any, own: Conversion | None) -> Any:
        if key in PLAIN or value is None or isinstance(value, (str, bool)):
            return value
        if key == "gradient":
            return self._gradient(value, own)
        if isinstance(value, Mapping):
            return self.mapping(value, own)
        if isinstance(value, list) and value and isinstance(value[0], Mapping):
            return [self.mapping(part, own) for part in value]
        if own is not None and (key in OWN or not isinstance(key, str)):
            return self._numbers(value, own)
        conversion = conversion_of(self.system, key)
        return value if conversion is None else self._numbers(value, conversion)

    def _numbers(self, value: Any, conversion: Conversion) -> Any:
        """A number, an array, or a pair or list of these."""
        if isinstance(value, (tuple, list)):
            return type(value)(self._numbers(part, conversion) for part in value)
        return self.number(value, conversion)

    def _gradient(self, gradient: Mapping[str, Any], own: Conversion | None) -> dict[str, Any]:
        """Derivatives by parameters; or of several figures, each by parameters."""
        found: dict[str, Any] = {}
        for name, slope in gradient.items():
            if isinstance(slope, Mapping):
                found[name] = self._gradient(slope, conversion_of(self.system, name))
            else:
                base = own or Conversion("1")
                by = conversion_of(self.system, name) or Conversion("1")
                per = base.per([by]) if by.unit != "1" else base
                found[name] = self.number(slope, per)
        return found


def conversion_of(system: UnitSystem, name: str) -> Conversion | None:
    """The conversion of a key of a result; None where it has no unit."""
    base, _, parameter = name.partition("_wrt_")
    if base in OF_MOTIONS and (parameter in OTHERS or parameter in INPUTS):
        return system.slope(base, parameter)
    if name in OTHERS or name in INPUTS or name.startswith("theta_"):
        return system.of(name)
    try:
        quantity(name, "omega" in parts(name)[1])
    except ValueError:
        return None
    return system.of(name)


def shown(name: str, found: Any, call: Mapping[str, Any], show: Shown) -> Any:
    """The result of a public function, called with these arguments, as it is shown."""
    system = show.system
    if hasattr(found, "data_vars"):  # of grid, design_map, sweep
        return in_units(found, system, _as_given(found, call), as_quantity=show.as_quantity)
    if name in ("evaluate", "grid"):
        names = call["names"]
        if isinstance(names, str):
            return show.named(found, names)
        return {key: show.named(value, key) for key, value in found.items()}
    if name == "drive":
        return found.as_quantities(system) if show.as_quantity else found.in_units(system)
    if name == "fit":
        return found.in_units(system, show.as_quantity)
    if name == "simulate":
        return _motion(found, show)
    if name == "optimize":
        return _optimum(found, call, show)
    own = {"feasibility": "margin", "counterweight": "F_X"}.get(name) or call.get("name")
    measure = own[-1] if isinstance(own, (tuple, list)) else own
    conversion = None if measure is None else conversion_of(system, measure)
    if name == "tolerance" and conversion is not None:
        found.unit = "" if show.as_quantity else conversion.unit
    return show.mapping(found, conversion) if isinstance(found, Mapping) else found


def _as_given(found: Any, call: Mapping[str, Any]) -> dict[str, Any]:
    """The coordinates that were given as plain numbers; of the best designs they are others."""
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


def _motion(found: Any, show: Shown) -> Any:
    """A simulation: its events and its solution too."""
    result = show.mapping(found, None)
    second, angle, speed = (show.system.of_unit(unit) for unit in ("s", "rad", "rad/s"))
    result["events"] = [
        event._replace(
            t=show.number(event.t, second),
            theta=show.number(event.theta, angle),
            omega=show.number(event.omega, speed),
            wrt=event.wrt and {p: show.number(d, show.system.slope("t", p)) for p, d in event.wrt.items()},
        )
        for event in found.get("events", [])
    ]
    solution = found.get("solution")
    if solution is not None:
        result["solution"] = lambda t: show.mapping(solution(second.to_si(t)), None)
    return result


def _optimum(found: Mapping[str, Any], call: Mapping[str, Any], show: Shown) -> dict[str, Any]:
    """An optimum: value and multipliers are in the units of the objectives and of what is limited."""

    def unit_of(measure: Any) -> Conversion:
        name = measure[-1] if isinstance(measure, (tuple, list)) else measure
        return conversion_of(show.system, str(name)) or Conversion("1")

    def in_own_unit(match: re.Match[str]) -> str:
        conversion = unit_of(match[1])
        return f"{match[1]} = {conversion.shown(float(match[2])):.6g} {conversion.unit}".removesuffix(" 1")

    def missed(match: re.Match[str]) -> str:
        conversion = unit_of(match[1].split()[-1])
        by = f"{conversion.shown(float(match[3])):.3g} {conversion.unit}".removesuffix(" 1")
        return f"{match[1]} misses {match[2]} by {by} at"

    objectives = [call[side] for side in ("maximize", "minimize") if call.get(side) is not None]
    by_measure = ("active", "multipliers")  # whose keys may be pairs
    result: dict[str, Any] = show.mapping({k: v for k, v in found.items() if k not in by_measure}, None)
    result = {key: result.get(key, part) for key, part in found.items()}
    names = "|".join(map(re.escape, call["over"]))
    result["message"] = re.sub(rf"\b({names}) = ([-+.0-9e]*[0-9])", in_own_unit, found["message"])
    by = r"(?<=limits: )(.+?) misses (its \w+ limit) by ([-+.0-9e]*[0-9]).*? at(?= the nearest)"
    result["message"] = re.sub(by, missed, result["message"])
    value = found["value"]
    if isinstance(value, Mapping):
        result["value"] = {key: show.number(part, unit_of(key)) for key, part in value.items()}
        return result
    own = unit_of(objectives[0])
    result["value"] = show.number(value, own)
    if "multipliers" in found:
        result["multipliers"] = {
            key: show.number(gain, own.per([unit_of(key)])) for key, gain in found["multipliers"].items()
        }
    return result
