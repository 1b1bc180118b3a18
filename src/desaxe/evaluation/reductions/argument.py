"""The argument `reduce=`: kinds along axes, measures of single names, functions of a design.

{"theta": "absmax"}                             along one axis
{"theta": ["max", "p95"], "ec": "mean"}         one axis after the other, in this order
{("theta", "ec"): "rms"}                        along both at once; in a file "theta, ec"
{"theta": [("rms", "T_in"), ("at", "60 deg", "Y"), f]}     of single names, and a function of a design
a list of these alone                           goes along theta
"""

import re
from collections.abc import Iterable, Mapping, Sequence
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

Chain = Sequence[tuple[tuple[str, ...], str]]  # axes and what is taken of them, one after the other
NO_STATUS = "a status has no largest or mean: leave it out; each name has a count of skipped points"
EXAMPLE = '{"theta": "absmax"}'


class Reduction(NamedTuple):
    """Kinds of every name along one axis."""

    axis: str
    kinds: tuple[str, ...]


class Stage(NamedTuple):
    """Kinds along some axes at once: of every name, and of single names as (kind, name)."""

    axes: tuple[str, ...]
    kinds: tuple[str, ...]
    single: tuple[tuple[str, str], ...] = ()

    def kinds_of(self, name: str) -> tuple[str, ...]:
        """The kinds that are taken of a name."""
        return tuple(dict.fromkeys((*self.kinds, *(kind for kind, own in self.single if own == name))))


class At(NamedTuple):
    """A name at one place of the reduced axis; `text` is how the place was given."""

    place: float
    name: str
    text: str

    @property
    def variable(self) -> str:
        """The name of the result: `Y_at_60_deg`."""
        return f"{self.name}_at_{re.sub(r'[^0-9A-Za-z.+-]+', '_', self.text).strip('_')}"


class Reductions(NamedTuple):
    """A request of `reduce=`: stages in their order, and where there is one stage measures beside it."""

    stages: tuple[Stage, ...]
    at: tuple[At, ...] = ()
    functions: tuple[OwnMeasure, ...] = ()

    @property
    def axes(self) -> tuple[str, ...]:
        """All reduced axes."""
        return tuple(axis for stage in self.stages for axis in stage.axes)

    @property
    def kinds(self) -> tuple[str, ...]:
        """All kinds, in their order."""
        kinds = (k for stage in self.stages for k in (*stage.kinds, *(one for one, _ in stage.single)))
        return tuple(dict.fromkeys(kinds))

    @property
    def alone(self) -> Reduction | None:
        """The request as kinds along one axis that a kernel computes; None where it is more than that."""
        stage = self.stages[0]
        more = self.at or self.functions or stage.single or len(self.stages) > 1 or len(stage.axes) > 1
        more = more or not all(kind_of(kind).combines for kind in stage.kinds)
        return None if more else Reduction(stage.axes[0], stage.kinds)

    def plain(self) -> dict[str, list[Any]]:
        """The request in plain lists, which tell it from another."""
        found: dict[str, list[Any]] = {
            ", ".join(s.axes): [*s.kinds, *map(list, s.single)] for s in self.stages
        }
        last = ", ".join(self.stages[-1].axes)
        found[last] += [["at", one.place, one.name] for one in self.at]
        found[last] += [function.name for function in self.functions]
        return found

    def chains(self, name: str) -> list[list[tuple[tuple[str, ...], str]]]:
        """Lists of (axes, kind) that are taken of a name; equal kinds in a row go along all axes at once."""
        chains: list[list[tuple[tuple[str, ...], str]]] = [[]]
        for stage in self.stages:
            chains = [_extended(chain, stage.axes, kind) for chain in chains for kind in stage.kinds_of(name)]
        return chains


def _extended(
    chain: list[tuple[tuple[str, ...], str]], axes: tuple[str, ...], kind: str
) -> list[tuple[tuple[str, ...], str]]:
    if chain and chain[-1][1] == kind:
        return [*chain[:-1], ((*chain[-1][0], *axes), kind)]
    return [*chain, (axes, kind)]


def chain_name(name: str, chain: Chain) -> str:
    """`a_C_max`, or of several stages `a_C_max_mean`."""
    return "_".join([name, *(kind for _, kind in chain)])


def extremes_at_end(chain: Chain) -> tuple[str, ...]:
    """The axes along which the result of a chain has a place: those since its last average."""
    found: tuple[str, ...] = ()
    for axes, kind in chain:
        found = (*found, *axes) if kind_of(kind).score else ()
    return found


# ---- from what the user says ------------------------------------------------------------------------


def reductions_of(asked: Any, dimensions: Sequence[str], names: Sequence[str]) -> Reductions:
    """A request, checked; ValueError or TypeError that names what is wrong."""
    if isinstance(asked, Reductions):
        return asked
    entries = _entries(asked)
    used: list[str] = []
    found = []
    at: list[At] = []
    functions: list[OwnMeasure] = []
    for key, taken in entries.items():
        axes = _axes(key, dimensions, used)
        used += axes
        kinds: dict[str, None] = {}
        single: dict[tuple[str, str], None] = {}
        for one in _listed(key, taken):
            measure = _measure(one)
            if measure is None:
                kinds[kind_name(one)] = None
            elif len(entries) > 1:
                raise ValueError(
                    f"reduce: {shown(one)}: a measure of one name goes along one axis, without others"
                )
            elif isinstance(measure, OwnMeasure):
                functions.append(measure)
            elif measure[0] == "at":
                at.append(_at(axes, *measure[1:]))
            else:
                single[kind_name(measure[0]), measure[1]] = None
        if not (kinds or single or at or functions):
            raise ValueError(f"reduce: nothing is taken of {_text(axes)}; allowed: {ALLOWED}")
        found.append(Stage(axes, tuple(kinds), tuple(single)))
    result = Reductions(tuple(found), tuple(dict.fromkeys(at)), tuple(functions))
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
    conversion = system.of(axis)
    if conversion.si == 1:
        return asked
    text = asked[1] if isinstance(asked[1], str) else _digits(asked[1])
    return type(asked)(("at", with_unit_of(f"1 {conversion.unit}", text), asked[2]))


def _digits(number: Any) -> Any:
    """A number as text; anything else as it is."""
    plain = isinstance(number, (int, float)) or is_numpy_number(number)
    return number if isinstance(number, bool) or not plain else repr(float(number)).removesuffix(".0")


def names_reduced(asked: Any) -> tuple[str, ...]:
    """The names that measures of a request are of, which need not be asked for beside it."""
    if isinstance(asked, Reductions):
        return ()
    measures = [_measure(one) for key, taken in _entries(asked).items() for one in _listed(key, taken)]
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
            there = ", ".join(dimensions) or "none"
            hint = did_you_mean(str(axis)[:40], dimensions)
            raise ValueError(f"reduce: {shown(axis)} is not an axis of this grid; {hint}axes: {there}")
        if axis in used or axis in axes[:number]:
            raise ValueError(f"reduce: {axis!r} is reduced twice")
    return axes


def _listed(key: Any, taken: Any) -> list[Any]:
    """The kinds and measures of an axis as a list."""
    single = isinstance(taken, str) or callable(taken) or _measure(taken) is not None
    if single or (isinstance(taken, (tuple, list)) and len(taken) == 2 and taken[0] == "percentile"):
        return [taken]
    if isinstance(taken, Mapping) or not isinstance(taken, Iterable):
        raise TypeError(
            f"reduce: {_text(key)} = {shown(taken)}: expected the name of a reduction or a list of names, "
            f"of {ALLOWED}"
        )
    return list(taken)


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
    try:
        return bool(kind_name(text))
    except ValueError:
        return False


def _at(axes: tuple[str, ...], place: Any, name: str) -> At:
    if len(axes) > 1:
        raise ValueError(f"reduce: ('at', {shown(place)}, {name!r}) goes along one axis, not {_text(axes)}")
    number = as_number(axes[0], place, axes, ("at",))
    if number is None:
        raise TypeError(f"reduce: at = {shown(place)}: expected one value of {axes[0]}")
    return At(number, name, place if isinstance(place, str) else f"{number:g}")


def _check_names(found: Reductions, names: Sequence[str]) -> None:
    if "status" in names:
        raise ValueError(f"reduce: {NO_STATUS}")
    measured = {one.name for one in found.at}
    still = [name for name in names if of_design(name)]
    if still and "theta" in found.axes:
        raise ValueError(f"reduce: {still[0]} is of the whole design: it has no course over theta")
    idle = [name for name in names if not found.chains(name) and name not in measured]
    if idle:
        raise ValueError(f"reduce: nothing is taken of {idle[0]}; allowed: {ALLOWED}")
    called = [one.variable for one in found.at] + [one.name for one in found.functions]
    called += [chain_name(name, chain) for name in names for chain in found.chains(name)]
    twice = [name for name in called if called.count(name) > 1]
    if twice:
        raise ValueError(f"reduce: two results would be called {twice[0]}")


def _text(axes: Any) -> str:
    return axes if isinstance(axes, str) else ", ".join(map(str, axes))
