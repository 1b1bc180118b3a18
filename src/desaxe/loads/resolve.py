"""From loads that vary with the motion to numbers, and from partial derivatives to total ones.

The forces of the mechanism are what the Program says at the load of that instant. A derivative of a quantity
q by a parameter p that the load F depends on is the Program's own, at a fixed load, and the load's part:

    dq/dp = q_wrt_p + q_wrt_F dF/dp,    dF/dtheta = F'(theta), or dF/dp = F'(Y) Y_wrt_p

    numbers, loads = split(inputs)             # what varies with the motion, apart
    plan = plan_of(names, loads, state, mu)    # what to evaluate for these names, and over which motion
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

from ..mechanism.catalogue import law_name, quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.names import STATUS, parts, sensitivity
from ..mechanism.own import Definition, Register, register, used_by
from ..mechanism.program import Variant, program_of
from ..mechanism.quantity_units import UnitSystem
from ..support.lazy import np
from ..support.recent import Recent
from .along_motion import COLUMNS, FunctionOfMotion, OfMotion, SumOfLoads
from .arguments import arguments_of, by_position
from .arithmetic import parts_of
from .function import FunctionOverTheta
from .load import Load
from .stroke import OverStroke

FUNCTIONS = {"Y": "over_Y", "V_C": "over_V"}  # what makes a load of a function with its derivative
VARIABLE = ("F_X", "F_Y")  # inputs that may vary with the motion


def as_load(name: str, value: Any) -> Load:
    """The load that a callable stands for: a function of what its arguments name."""
    if isinstance(value, Load):
        requested = "N*m" if name == "torque" else INPUTS[name].unit
        if name == "torque" and isinstance(value, OfMotion):
            raise TypeError(f"torque = {value!r}: a torque over theta or omega, or a function, is expected")
        if value.unit not in (None, requested):
            raise ValueError(f"{name}: the load is in {value.unit}, expected {requested}")
        return value
    arguments = arguments_of(name, value, ("theta",) if name == "torque" else COLUMNS)
    if arguments == ("theta",):
        return FunctionOverTheta(by_position(value))
    return FunctionOfMotion(by_position(value), arguments)


def plain_units(name: str, load: Any, units: UnitSystem) -> dict[str, str]:
    """Place, "value" or "pressure" -> the unit that plain numbers could be meant in, where it is not SI."""
    plain = getattr(load, "plain", ())
    there = {
        place: units.of_unit("Pa") if place == "pressure" else units.of(name if place == "value" else place)
        for place in plain
    }
    return {place: conversion.unit for place, conversion in there.items() if conversion.si != 1}


def settled(name: str, load: Any, units: UnitSystem) -> Any:
    """A load as it enters a machine or a scene, in which it is in SI units from then on.

    ValueError where its plain numbers, which are SI units, would be taken for those of the machine.
    """
    if not getattr(load, "plain", ()):
        return load
    if isinstance(load, SumOfLoads):
        return replace(load, terms=tuple((f, settled(name, part, units)) for f, part in load.terms))
    other = plain_units(name, load, units).values()
    if other:
        call = getattr(load, "call", "") or f"over_{load.over}"
        texts = ", ".join(f'"... {unit}"' for unit in other)
        raise ValueError(
            f"{name}: plain numbers of desaxe.{call} are in SI units, but those given here are in "
            f"{', '.join(other)}: give machine.{call}(...), which takes the units of the machine (or a table "
            f"in the scene), or desaxe.{call}(...) of texts with units, {texts}"
        )
    return replace(load, plain=())


def split(inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Load]]:
    """The inputs without those that vary with the motion, and these; TypeError for one that cannot."""
    numbers = {name: value for name, value in inputs.items() if not callable(value)}
    varying = [name for name in inputs if name not in numbers]
    for name in varying:
        if name not in VARIABLE:
            raise TypeError(f"{name}: expected a number; {' and '.join(VARIABLE)} may vary with the motion")
    return numbers, {name: as_load(name, inputs[name]) for name in varying}


def without_loads(caller: str, inputs: Mapping[str, Any], instead: str) -> None:
    """TypeError for a load where only numbers make sense; `instead` is what to give for {name}."""
    for name, value in inputs.items():
        if callable(value):
            raise TypeError(
                f"{name}: {caller} takes numbers, not a load that varies with the motion; give "
                f"{instead.format(name=name)}"
            )


class Term(NamedTuple):
    """The part of a derivative that comes through a load: slope (a name) times dF/dp."""

    slope: str
    force: str
    parameter: str


class LoadPlan(NamedTuple):
    """A plan to evaluate names under loads that vary with the motion."""

    shown: tuple[str, ...]
    names: tuple[str, ...]  # to evaluate: the requested ones, and the slopes by the loads
    terms: Mapping[str, tuple[Term, ...]]
    acting: tuple[str, ...]  # the loads that matter
    motion: tuple[str, ...]  # names of the motion, at a fixed load, which the loads and derivatives need
    forces_of: Mapping[str, tuple[str, ...]]  # those that a name depends on
    of_motion: tuple[str, ...] = ()  # names of the motion that loads over its columns need
    loads: Mapping[str, Load] = MappingProxyType({})  # those that act, of this request

    @property
    def follows_speed(self) -> bool:
        """True if a load depends on how fast the crank turns."""
        return any(load.follows_speed for load in self.loads.values())


MOST_PLANS = 1024
_PLANS: Recent[Any, LoadPlan] = Recent(MOST_PLANS)  # for loads of the same kinds


def plan_of(
    names: Sequence[str], loads: Mapping[str, Load], state: bool, mu: bool, known: Register | None = None
) -> LoadPlan:
    """The plan for names; ValueError for one that needs what is not known of a load.

    state   whether omega is given instead of omega0
    mu      whether friction is: then the status depends on the loads
    known   the definitions that names have
    """
    known = known or register()
    sorts = tuple((name, load.variant) for name, load in loads.items())
    key = tuple(names), sorts, state, mu, known
    plan = _PLANS.get(key)
    if plan is None:
        plan = _new_plan(names, loads, state, mu, known)
        _PLANS[key] = plan
    return plan._replace(loads={name: loads[name] for name in plan.acting})


def _new_plan(
    names: Sequence[str], loads: Mapping[str, Load], state: bool, mu: bool, known: Register
) -> LoadPlan:
    terms: dict[str, tuple[Term, ...]] = {}
    used: dict[str, Load] = {}
    forces_of: dict[str, tuple[str, ...]] = {}
    for name in names:
        quantity(name, state, known)
        for force, load in loads.items():
            law = law_name(name) if state else name
            if _depends(law, force, mu, used_by((law,), known)):
                used[force] = load
                forces_of[name] = (*forces_of.get(name, ()), force)
                terms[name] = (*terms.get(name, ()), *_terms(name, force, load, state, known))
    if STATUS in names:
        of_design = [n for n, load in loads.items() if isinstance(load, OverStroke)]
        some = [n for n in of_design if n in used or len(names) == 1]
        forces_of[STATUS] = tuple(dict.fromkeys((*forces_of.get(STATUS, ()), *some)))
        used |= {n: loads[n] for n in some}
    every = [term for group in terms.values() for term in group]
    motion: dict[str, None] = {}
    of_motion: dict[str, None] = {}
    for force, load in used.items():
        by = sorted({term.parameter for term in every if term.force == force})
        columns = of_motion if parts_of(load) is None else motion
        columns |= dict.fromkeys(load.motion(by, state))
    more = (term.slope for term in every)
    requested = tuple(dict.fromkeys((*names, *more)))
    return LoadPlan(tuple(names), requested, terms, tuple(used), tuple(motion), forces_of, tuple(of_motion))


@lru_cache(maxsize=1024)
def _depends(name: str, force: str, mu: bool, own: tuple[Definition, ...]) -> bool:
    """True if a force matters: also to a derivative, at a fixed force, that does not have it as an input."""
    if name == STATUS:
        return mu
    return force in program_of((parts(name)[0],), Variant(own=own)).inputs


def _terms(name: str, force: str, load: Load, state: bool, known: Register) -> tuple[Term, ...]:
    """The terms of a derivative that come through a load's dependence on the parameters."""
    base, parameters = parts(name)
    # In a given state alpha changes no speed.
    through = [p for p in parameters if p in load.parameters and not (state and p == "alpha")]
    if not through:
        return ()
    if not load.has_slope:
        raise ValueError(
            f"{name}: it needs the slope of {force}, a function without derivative; give "
            f"{force} = desaxe.{FUNCTIONS.get(load.over, 'over_theta')}(f, derivative=...), or a table"
        )
    others = list(parameters)
    others.remove(through[0])
    slope = sensitivity(base, *others, force)
    try:
        quantity(slope, state, known)
    except ValueError:
        slope = ""
    if len(through) > 1 or not slope:
        raise ValueError(f"{name}: this derivative is not derived for a load {force} over {load.over}")
    return (Term(slope, force, through[0]),)


def way_of(inputs: Mapping[str, Any]) -> Any:
    """The sign of the crank's speed, as a number or array: that of alpha where a given state rests."""
    speed, alpha = inputs.get("omega"), inputs.get("alpha")
    if speed is None:
        speed, alpha = inputs.get("omega0"), None
    if speed is None or alpha is None:
        return 1.0 if speed is None else speed
    return np.where(np.equal(speed, 0.0), alpha, speed)
