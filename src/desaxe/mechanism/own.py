"""User-defined quantities: the register, and their rows of the catalogue.

A definition carries its value as a text like generated/program.py, in the names of the catalogue (`own_lines`
puts it into the Program). Whoever remembers answers by name forgets them when a name gets another meaning
(`forget_on_change`), or has the definitions in the key of the memory.
"""

from collections.abc import Iterable, Mapping, MutableMapping
from functools import cache
from typing import Any, NamedTuple

from ..compiler.text import ProgramText
from ..support.forks import IMPORTS, ForkSafeLock, imported
from .inputs import INPUTS
from .names import CENTRES, LOADS, PARAMETERS, joined, parts, sensitivity

LENGTH_OF = dict(zip(CENTRES, ("AB", "BC"), strict=True))
Row = tuple[str, str, str]  # unit, meaning, source


class Definition(NamedTuple):
    """A user-defined quantity. `text` is the Program of its value, in names of the catalogue."""

    name: str
    expression: str
    unit: str
    meaning: str
    constants: tuple[tuple[str, str | float], ...]  # name -> the value as it was given
    text: str

    @property
    def uses(self) -> tuple[str, ...]:
        """The names that the expression uses."""
        return ProgramText(self.text).inputs


_LOCK = ForkSafeLock()
_DEFINITIONS: dict[str, Definition] = {}
_MEMORIES: list[MutableMapping[Any, Any]] = []
_ROWS: dict[str, Row] = {}
_CHANGES = [0]


def forget_on_change(memory: MutableMapping[Any, Any]) -> None:
    """Register a cache keyed by names, to be emptied whenever a definition changes."""
    _MEMORIES.append(memory)


def changes() -> int:
    """A counter of changed definitions: a cache compares it before and after a slow computation."""
    return _CHANGES[0]


def definitions() -> dict[str, Definition]:
    """The definitions by name, in the order in which they were made."""
    return dict(_DEFINITIONS)


def rows() -> dict[str, Row]:
    """Unit, meaning and expression of every user-defined quantity and its sensitivities."""
    return _ROWS


def replace_all(new: Mapping[str, Definition]) -> None:
    """Replace all definitions; caches that depend on them are emptied."""
    with _LOCK:
        found: dict[str, Row] = {}
        for definition in new.values():
            found |= rows_of(definition, new)
        _DEFINITIONS.clear()
        _DEFINITIONS.update(new)
        _ROWS.clear()
        _ROWS.update(found)
        _CHANGES[0] += 1
        for memory in _MEMORIES:
            memory.clear()


def used_by(names: Iterable[str]) -> tuple[Definition, ...]:
    """The definitions that names need, each behind those that it uses."""
    if not _DEFINITIONS:
        return ()
    return closure((parts(name)[0] for name in names), _DEFINITIONS)


def closure(names: Iterable[str], known: Mapping[str, Definition]) -> tuple[Definition, ...]:
    """The definitions behind names, each behind those that it uses."""
    found: dict[str, Definition] = {}

    def visit(name: str) -> None:
        if name in known and name not in found:
            for used in known[name].uses:
                visit(parts(used)[0])
            found[name] = known[name]

    for name in names:
        visit(name)
    return tuple(found.values())


def leaves(names: Iterable[str], known: Mapping[str, Definition]) -> tuple[str, ...]:
    """The names of the derivation that user-defined quantities use."""
    uses = (used for definition in closure(names, known) for used in definition.uses)
    return tuple(dict.fromkeys(used for used in uses if parts(used)[0] not in known))


@cache
def derived_names() -> dict[str, Row]:
    """The quantities and sensitivities of the derivation."""
    names: dict[str, Row] = imported("desaxe.generated.index").NAMES
    return names


# ---- the catalogue --------------------------------------------------------------------------------


def rows_of(definition: Definition, known: Mapping[str, Definition]) -> dict[str, Row]:
    """Unit, meaning and expression of a quantity and its sensitivities; `known` has those that it uses."""
    name = definition.name
    made_of = leaves((name,), known)
    parameters = [p for p in (*PARAMETERS, *LOADS) if p in PARAMETERS or any(depends(n, p) for n in made_of)]
    found = {name: (definition.unit, definition.meaning, definition.expression)}
    for parameter in parameters:
        found[joined(name, (parameter,))] = derivative_row(name, definition.unit, (parameter,))
    for place, first in enumerate(parameters):
        for second in parameters[place:]:
            if all(_has_second(leaf, first, second) for leaf in made_of):
                found[joined(name, (first, second))] = derivative_row(name, definition.unit, (first, second))
    return found


def derivative_row(name: str, unit: str, parameters: tuple[str, ...]) -> Row:
    """Unit and meaning of a derivative of a quantity with a unit."""
    with IMPORTS:
        from .dimensions import unit_of, unit_text

    *before, last = parameters
    return unit_text(unit_of(unit).over(*parameters)), f"derivative of {joined(name, before)} by {last}", ""


def depends(leaf: str, parameter: str) -> bool:
    """True if a name of the derivation, or an input, depends on a parameter."""
    base = parts(leaf)[0]
    if leaf in INPUTS and leaf not in derived_names():
        return parameter in (leaf, LENGTH_OF.get(leaf))
    return joined(base, (parameter,)) in derived_names() or base == "margin"


def _has_second(leaf: str, first: str, second: str) -> bool:
    if leaf in INPUTS and leaf not in derived_names():
        return True
    if not (depends(leaf, first) and depends(leaf, second)):
        return True
    return leaf != "margin" and sensitivity(leaf, first, second) in derived_names()
