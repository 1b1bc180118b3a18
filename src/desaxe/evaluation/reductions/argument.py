"""The argument `reduce=`: kinds along axes, measures of single names, functions of a design.

{"theta": "absmax"}                             along one axis
{"theta": ["max", "p95"], "ec": "mean"}         one axis after the other, in this order
{("theta", "ec"): "rms"}                        along both at once; in a file "theta, ec"
{"theta": [("rms", "T_in"), ("at", "60 deg", "Y"), f]}     of single names, and a function of a design
a list of these alone                           goes along theta
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

from ...mechanism.catalogue import of_design
from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.read import is_numpy_number
from ...mechanism.spelling import did_you_mean
from ...runtime.request import as_number
from ...support.shown import shown
from ...units.text import with_unit_of
from .kinds import ALLOWED, kind_name, kind_of
from .own_measure import OwnMeasure

Chain = tuple[tuple[tuple[str, ...], str], ...]  # axes and what is taken of them, one after the other
EVERY = ""  # stands for every name
NO_STATUS = "a status has no largest or mean: leave it out; each name has a count of skipped points"
EXAMPLE = '{"theta": "absmax"}'


class Reduction(NamedTuple):
    """Kinds of every name along one axis."""

    axis: str
    kinds: tuple[str, ...]


class At(NamedTuple):
    """A name at one place of the reduced axis; `text` is how the place was given."""

    axis: str
    place: float
    name: str
    text: str

    @property
    def variable(self) -> str:
        """The name of the result: `Y_at_60_deg`."""
        return f"{self.name}_at_{re.sub(r'[^0-9A-Za-z.+-]+', '_', self.text).strip('_')}"


class Reductions(NamedTuple):
    """A request of `reduce=`.

    axes   all reduced axes
    first  those that are reduced first
    taken  names, each with a chain that is taken of it; beside these, measures along one axis
    """

    axes: tuple[str, ...]
    first: tuple[str, ...]
    taken: tuple[tuple[str, Chain], ...]
    at: tuple[At, ...] = ()
    functions: tuple[OwnMeasure, ...] = ()

    @property
    def kinds(self) -> tuple[str, ...]:
        """All kinds, in their order."""
        return tuple(dict.fromkeys(kind for _, chain in self.taken for _, kind in chain))

    @property
    def alone(self) -> Reduction | None:
        """The request as kinds along one axis that exported modules have; None where it is more than that."""
        names = dict.fromkeys(name for name, _ in self.taken)
        partly = len(self.taken) < len(names) * len(self.kinds)
        if partly or self.at or self.functions or len(self.axes) > 1:
            return None
        return Reduction(self.axes[0], self.kinds) if all(kind_of(k).combines for k in self.kinds) else None

    def plain(self) -> list[str]:
        """The request in texts, which tell it from another."""
        at = [f"{one.name} at {one.axis} = {one.place!r}" for one in self.at]
        chains = [f"{name}: {_text(chain)}" for name, chain in self.taken]
        return [*chains, *at, *(function.name for function in self.functions)]

    def chains(self, name: str) -> list[Chain]:
        """Lists of (axes, kind) that are taken of a name."""
        return [chain for of, chain in self.taken if of == name]


def _chains(stages: Sequence[tuple[tuple[str, ...], Iterable[tuple[str, str]]]], name: str) -> list[Chain]:
    """The chains of a name through all stages; equal kinds in a row go along all axes at once."""
    chains: list[Chain] = [()]
    for axes, taken in stages:
        kinds = dict.fromkeys(kind for kind, of in taken if of in (EVERY, name))
        chains = [_extended(chain, axes, kind) for chain in chains for kind in kinds]
    return chains


def _extended(chain: Chain, axes: tuple[str, ...], kind: str) -> Chain:
    if chain and chain[-1][1] == kind:
        return *chain[:-1], ((*chain[-1][0], *axes), kind)
    return *chain, (axes, kind)


def chain_name(name: str, chain: Chain) -> str:
    """`a_C_max`, or of several stages `a_C_max_mean`."""
    return "_".join([name, *(kind for _, kind in chain)])


def extremes_at_end(chain: Chain) -> tuple[str, ...]:
    """The axes along which the result of a chain has a place: those since its last average."""
    result: tuple[str, ...] = ()
    for axes, kind in chain:
        result = (*result, *axes) if kind_of(kind).score else ()
    return result


# ---- from what the user says ------------------------------------------------------------------------


def reductions_of(asked: Any, dimensions: Sequence[str], names: Sequence[str]) -> Reductions:
    """A request, checked; ValueError or TypeError that names what is wrong."""
    if isinstance(asked, Reductions):
        return asked
    entries = _entries(asked)
    stages: list[tuple[tuple[str, ...], dict[tuple[str, str], None]]] = []
    at: dict[At, None] = {}
    functions: list[OwnMeasure] = []
    used: list[str] = []
    for key, items in entries.items():
        axes = _axes(key, dimensions, used)
        used += axes
        taken: dict[tuple[str, str], None] = {}
        for one in _listed(key, items):
            measure = _measure(one)
            if measure is None:
                taken[kind_name(one), EVERY] = None
            elif len(entries) > 1:
                alone = "a measure of one name goes along one axis, without others"
                raise ValueError(f"reduce: {shown(one)}: {alone}")
            elif isinstance(measure, OwnMeasure):
                functions.append(measure)
            elif measure[0] == "at":
                at[_at(axes, *measure[1:])] = None
            else:
                taken[kind_name(measure[0]), measure[1]] = None
        if not (taken or at or functions):
            raise ValueError(f"reduce: nothing is taken of {_text(axes)}; allowed: {ALLOWED}")
        stages.append((axes, taken))
    every = tuple((name, chain) for name in names for chain in _chains(stages, name))
    result = Reductions(tuple(used), stages[0][0], every, tuple(at), tuple(functions))
    _check_names(result, names)
    return result


def at_with_units(asked: Any, system: UnitSystem, axis: str = "theta") -> Any:
    """A request, a measure or measures in which the plain place of ("at", 60, "Y") has the system's unit."""
    if isinstance(asked, Mapping):
        return {
            at_with_units(key, system): at_with_units(one, system, key if key in INPUTS else axis)
            for key, one in asked.items()
        }
    if type(asked) not in (tuple, list):
        return asked
    if not (len(asked) == 3 and asked[0] == "at"):
        return type(asked)(at_with_units(one, system, axis) for one in asked)
    conversion, place = system.of(axis), asked[1]
    if conversion.si == 1:
        return asked
    if not isinstance(place, bool) and (isinstance(place, (int, float)) or is_numpy_number(place)):
        place = repr(float(place)).removesuffix(".0")
    return type(asked)(("at", with_unit_of(f"1 {conversion.unit}", place), asked[2]))


def names_reduced(asked: Any) -> tuple[str, ...]:
    """The names that measures of a request are of, which need not be asked for beside it."""
    if isinstance(asked, Reductions):
        return ()
    measures = [_measure(one) for key, items in _entries(asked).items() for one in _listed(key, items)]
    return tuple(dict.fromkeys(one[-1] for one in measures if isinstance(one, tuple)))


def _entries(asked: Any) -> Mapping[Any, Any]:
    """The request as a mapping; measures alone go along theta."""
    alone = asked if isinstance(asked, list) else [asked]
    if alone and all(_measure(one) is not None for one in alone):
        return {"theta": alone}
    if not isinstance(asked, Mapping) or not asked:
        raise TypeError(f"reduce = {shown(asked)}: it must map an axis to a reduction, such as {EXAMPLE}")
    return asked


def _axes(key: Any, dimensions: Sequence[str], used: Sequence[str]) -> tuple[str, ...]:
    axes = tuple(part.strip() for part in key.split(",")) if isinstance(key, str) else key
    if not isinstance(axes, tuple) or not axes:
        raise TypeError(f"reduce: {shown(key)}: expected an axis or a tuple of axes")
    for number, axis in enumerate(axes):
        if axis not in dimensions:
            hint = did_you_mean(str(axis)[:40], dimensions)
            known = ", ".join(dimensions) or "none"
            raise ValueError(f"reduce: {shown(axis)} is not an axis of this grid; {hint}axes: {known}")
        if axis in used or axis in axes[:number]:
            raise ValueError(f"reduce: {axis!r} is reduced twice")
    return axes


def _listed(key: Any, items: Any) -> list[Any]:
    """The kinds and measures of an axis as a list."""
    pair = isinstance(items, (tuple, list)) and len(items) == 2 and items[0] == "percentile"
    if pair or isinstance(items, str) or _measure(items) is not None:
        return [items]
    if isinstance(items, Mapping) or not isinstance(items, Iterable):
        expected = f"expected the name of a reduction or a list of names, of {ALLOWED}"
        raise TypeError(f"reduce: {_text(key)} = {shown(items)}: {expected}")
    return list(items)


def _measure(one: Any) -> OwnMeasure | tuple[Any, ...] | None:
    """("rms", name), ("at", place, name) or a function; None for a kind."""
    if callable(one):
        return one if isinstance(one, OwnMeasure) else OwnMeasure(one)
    if not isinstance(one, (tuple, list)) or len(one) not in (2, 3):
        return None
    if len(one) == 3:
        return ("at", one[1], str(one[2])) if one[0] == "at" else None
    kind, name = one
    if not isinstance(name, str):
        return None
    if isinstance(kind, str):
        return (kind, name) if _is_kind(kind) and not _is_kind(name) else None
    return kind_name(kind), name  # (("percentile", 95), name)


def _is_kind(text: str) -> bool:
    with suppress(ValueError):
        return bool(kind_name(text))
    return False


def _at(axes: tuple[str, ...], place: Any, name: str) -> At:
    if len(axes) > 1:
        raise ValueError(f"reduce: ('at', {shown(place)}, {name!r}) goes along one axis, not {_text(axes)}")
    number = as_number(axes[0], place, axes, ("at",)) if axes[0] in INPUTS else None
    if number is None:
        raise TypeError(f"reduce: at = {shown(place)}: expected one value of {axes[0]}")
    return At(axes[0], number, name, place if isinstance(place, str) else f"{number:g}")


def _check_names(result: Reductions, names: Sequence[str]) -> None:
    if "status" in names:
        raise ValueError(f"reduce: {NO_STATUS}")
    measured = {one.name for one in result.at}
    called = [one.variable for one in result.at] + [one.name for one in result.functions]
    for name in names:
        if "theta" in result.axes and of_design(name):
            raise ValueError(f"reduce: {name} is of the whole design: it has no course over theta")
        if not result.chains(name) and name not in measured:
            raise ValueError(f"reduce: nothing is taken of {name}; allowed: {ALLOWED}")
    called += [chain_name(name, chain) for name, chain in result.taken]
    twice = [name for name in called if called.count(name) > 1]
    if twice:
        raise ValueError(f"reduce: two results would be called {twice[0]}")


def _text(axes: Any) -> str:
    """Axes in a message; of a chain, each with its kind."""
    if isinstance(axes, str):
        return axes
    return ", ".join(one if isinstance(one, str) else f"{one[1]} along {_text(one[0])}" for one in axes)
