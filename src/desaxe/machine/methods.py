"""Public functions as methods of a machine: signature and documentation, with the inputs filled in.

A function of this table is a method of the same name. To add one, add its name.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, NamedTuple

from ..evaluation.evaluate import Values
from ..evaluation.in_units import Shown, in_units
from ..evaluation.labels import loads_text, tell_loads
from ..loads.load import Load
from ..mechanism.inputs import INPUTS
from ..mechanism.messages import errors_in
from ..mechanism.own import using
from ..mechanism.quantity_units import unit_of, units_by_name
from ..mechanism.ranges import refuse_bare_pair
from ..mechanism.slips import warn_of_slips
from ..runtime.request import MachineSpeed
from ..support.answer import Answer
from ..support.forks import IMPORTS, imported
from .arguments import in_si, in_unit_of

# Public function -> its module; what it takes that no machine gives, because it is what is looked for.
METHODS = {
    "evaluate": "desaxe.evaluation.evaluate",
    "grid": "desaxe.evaluation.grid",
    "peak": "desaxe.peaks.peak",
    "events": "desaxe.design.events.events",
    "feasibility": "desaxe.design.feasibility.feasibility",
    "inverse": "desaxe.design.inverse",
    "simulate": "desaxe.simulation.simulate",
    "sweep": "desaxe.scenes.sweep",
    "optimize": "desaxe.design.optimisation.optimize",
    "synthesize": "desaxe.design.synthesis.synthesize",
    "design_map": "desaxe.design.design_map",
    "tolerance": "desaxe.design.tolerance.tolerance",
    "enclose": "desaxe.enclosure.enclose",
    "harmonics": "desaxe.design.turn.harmonics",
    "counterweight": "desaxe.design.turn.counterweight",
    "crossings": "desaxe.design.turn.crossings",
    "drive": "desaxe.design.drive.drive",
    "solve": "desaxe.design.solve",
    "steady": "desaxe.design.steady.steady",
    "fit": "desaxe.design.fit.fit",
    "function": "desaxe.evaluation.function",
    "explore": "desaxe.scenes.explorer.explore",
}
NOT_FILLED = {"synthesize": ("AB", "BC"), "explore": ("source",)}
WISHES = ("BC", "AB", "max_pressure_angle")  # one of them beside stroke and time ratio
EITHER = {"omega": "omega0", "omega0": "omega"}  # a given state takes the place of the law, and back
INTRODUCTION = "`desaxe.{name}` with the inputs of this machine; those given here replace them."
UNITS = """
    Plain numbers and answers are in the units of the machine.

    as_quantity  True: numbers with units come as pint quantities (extra `units`)
"""


class Method:
    """A public function as a method, made when it is first looked up."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type) -> Any:
        method = method_of(import_function(self.name), self.name)
        setattr(owner, self.name, method)
        return method.__get__(instance, owner) if instance is not None else method


def import_function(name: str) -> Callable[..., Any]:
    """The public function of this name."""
    function: Callable[..., Any] = getattr(imported(METHODS[name]), name)
    return function


def method_of(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    """A function as a method of a machine."""
    own = signature(function)
    kept = [*_parameters(own, name)]
    positional = tuple(p.name for p in kept if p.kind is Parameter.POSITIONAL_OR_KEYWORD)
    anything = any(p.kind is Parameter.VAR_KEYWORD for p in kept)
    takes = Takes(frozenset(own.parameters), positional, anything)

    @wraps(function)
    def method(self: Any, *args: Any, as_quantity: bool = False, **inputs: Any) -> Any:
        if not self.definitions:
            return call(self, name, function, takes, args, inputs, as_quantity)
        with using(self.definitions):
            return call(self, name, function, takes, args, inputs, as_quantity)

    method.__qualname__ = f"Machine.{name}"
    method.__doc__ = f"{INTRODUCTION.format(name=name)}\n{UNITS}\n    {function.__doc__}"
    kept.insert(len(kept) - anything, AS_QUANTITY)
    method.__dict__["__signature__"] = own.replace(parameters=[SELF, *kept])
    return method


class Takes(NamedTuple):
    """The parameters of a function, those that need no name, and a flag: it takes any other name."""

    names: frozenset[str]
    positional: tuple[str, ...]
    anything: bool


def _parameters(own: Signature, name: str) -> Iterator[Parameter]:
    """The parameters of a method: those that a machine gives are optional, what is looked for is dropped."""
    for parameter in own.parameters.values():
        is_keyword = parameter.kind is Parameter.KEYWORD_ONLY
        if parameter.name != "sliders" and (is_keyword or parameter.name not in NOT_FILLED.get(name, ())):
            is_given = is_keyword and parameter.name in (*FILLED, "stroke", "time_ratio")
            yield parameter.replace(default=None) if is_given else parameter


SELF = Parameter("self", Parameter.POSITIONAL_OR_KEYWORD)
AS_QUANTITY = Parameter("as_quantity", Parameter.KEYWORD_ONLY, default=False, annotation=bool)
FILLED = ("ec", "AB", "BC")
OF_RANGES = ("enclose", "tolerance")  # in which a pair must say what it means, in the caller's units


def call(
    machine: Any,
    name: str,
    function: Callable[..., Any],
    takes: Takes,
    args: tuple[Any, ...],
    inputs: Mapping[str, Any],
    as_quantity: bool,
) -> Any:
    """Call a public function with a machine's inputs and those given, which replace them."""
    if "sliders" in machine and "sliders" not in takes.names:
        raise TypeError(f"{name} is of one slider: crankshaft.members[0].{name}(...)")
    positional = takes.positional
    if len(args) > len(positional):
        raise TypeError(f"{name}() takes {len(positional)} arguments without a name, got {len(args)}")
    twice = [key for key in positional[: len(args)] if key in inputs]
    if twice:
        raise TypeError(f"{name}() got two values of {twice[0]}")
    system = machine.units
    if name in OF_RANGES:
        for key in INPUTS.keys() & inputs.keys():
            refuse_bare_pair(key, inputs[key])
    named = {**dict(zip(positional, args, strict=False)), **inputs}
    if name == "fit" and "over" in named:
        named["over"] = _starts(machine, named["over"])
    warn_of_slips(named, system, 4, {"alpha": machine.get("alpha")})
    with errors_in(system):
        given = {key: in_si(system, key, value) for key, value in named.items()}
        if "value" in given:  # of `crossings`: in the unit of the quantity
            given["value"] = in_unit_of(str(named.get("name")), given["value"], system)
        if system and "units" in takes.names:
            given.setdefault("units", system)
        found = function(**given, **filled(machine, name, takes, given))
    if not system and not as_quantity:
        return found
    show = Shown(system, as_quantity)
    if name == "function":
        with IMPORTS:
            from .function import FunctionInUnits

        return FunctionInUnits(found, show)
    result = _shown(found, machine, named, show)
    return _delivered(result, given.get("out"))


def filled(machine: Mapping[str, Any], name: str, takes: Takes, given: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs of a machine that a function takes and that are not given in this call."""
    free = given.get("over") or (given.get("inputs", ("theta",)) if name == "function" else ())
    free = (free,) if isinstance(free, str) else tuple(free)
    left = {*given, *(EITHER[key] for key in (*given, *free) if key in EITHER), *free}
    left.update(NOT_FILLED.get(name, ()))
    result = {
        key: value
        for key, value in machine.items()
        if key not in left and (takes.anything or key in takes.names or _is_initial_speed(name, value))
    }
    return result | _wishes(machine, given) if name == "synthesize" else result


def _starts(machine: Any, over: Any) -> Any:
    """The unknowns of a fit; one that is only named starts at the machine's number."""
    names = [over] if isinstance(over, str) else over
    pairs = names if isinstance(names, Mapping) else dict.fromkeys(names)
    return {key: machine.in_units().get(key) if start is None else start for key, start in pairs.items()}


def _is_initial_speed(name: str, value: Any) -> bool:
    """True for a speed of a machine where a motion starts: `simulate` has another name for it."""
    return name == "simulate" and isinstance(value, MachineSpeed)


def _wishes(machine: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Requirements of a synthesis that the machine meets itself: stroke, time ratio, rod."""
    result = {}
    if not all(key in given for key in ("stroke", "time_ratio")):
        lengths = {key: machine[key] for key in FILLED if key in machine}
        own = import_function("events")(**lengths) if len(lengths) == len(FILLED) else {}
        result = {key: own[key] for key in ("stroke", "time_ratio") if key in own and key not in given}
    if not any(given.get(key) is not None for key in WISHES) and "BC" in machine:
        result["BC"] = machine["BC"]
    return result


def _delivered(result: Any, out: Any) -> Any:
    """The result, also in `out`, whose SI values are converted to the machine's units."""
    if out is None:
        return result
    if not isinstance(result, dict):
        out[...] = result
        return out
    arrays = out if isinstance(out, Mapping) else {next(iter(result)): out}
    for key, array in arrays.items():
        array[...] = result[key]
    return dict(arrays)


def _shown(found: Any, machine: Any, named: Mapping[str, Any], show: Shown) -> Any:
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


def _as_given(result: Any, call: Mapping[str, Any]) -> dict[str, Any]:
    """The coordinates that were given as plain numbers."""
    kept = {key: value for key, value in call.items() if key in result.coords and _is_plain(value)}
    return {
        key: value
        for key, value in kept.items()
        if result[key].shape == ((len(value),) if hasattr(value, "__len__") else ())
    }


def _is_plain(value: Any) -> bool:
    """True for numbers and arrays without a unit of their own."""
    if isinstance(value, (list, tuple)):
        return all(_is_plain(part) for part in value)
    own = hasattr(value, "magnitude") or "units" in getattr(value, "attrs", {})
    return not own and (isinstance(value, (int, float)) or hasattr(value, "dtype"))
