"""User-defined quantities: the register, and their rows of the catalogue.

A definition carries its value as a text like generated/program.py, in the names of the catalogue (`own_lines`
puts it into the Program). The register of a process is an immutable mapping that `define` replaces by another
in one step: a reader has the one or the other, never half of both. It is no thread's own, so that the threads
of a pool and of a Dask worker see it. A call for a scene or a machine with definitions of its own has a
register of these and the process's (`using`), which its requests and tasks bring along to other threads.
Whoever remembers answers by name has the register in the key.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, lru_cache
from types import MappingProxyType
from typing import NamedTuple

from ..compiler.text import ProgramText
from ..support.forks import IMPORTS, ForkSafeLock, imported
from .inputs import INPUTS
from .names import CENTRES, LOADS, PARAMETERS, joined, parts, per, sensitivity

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


class Register:
    """All definitions at one moment, with their rows of the catalogue. It never changes."""

    __slots__ = ("definitions", "rows")

    def __init__(self, definitions: Mapping[str, Definition]) -> None:
        self.definitions: Mapping[str, Definition] = MappingProxyType(dict(definitions))
        rows = (row for own in definitions.values() for row in rows_of(own, definitions).items())
        self.rows: Mapping[str, Row] = MappingProxyType(dict(rows))


_LOCK = ForkSafeLock()
_NOW: list[Register] = []  # the one of this process, which all of its threads see
_CALL: ContextVar[Register | None] = ContextVar("definitions of a call", default=None)


def register() -> Register:
    """The definitions of this call: a request takes them once, and memories have them in their keys."""
    return _CALL.get() or _NOW[0]


@contextmanager
def using(own: tuple[Definition, ...]) -> Iterator[None]:
    """Calls within the block know these definitions as well, before others of the same names."""
    before = _CALL.set(register_with(own) if own else _CALL.get())
    try:
        yield
    finally:
        _CALL.reset(before)


def change(changed: Callable[[Mapping[str, Definition]], Mapping[str, Definition]]) -> None:
    """Replace the definitions by others that are made of them, in one step for every reader."""
    with _LOCK:
        before = _NOW[0].definitions
        after = changed(before)
        if after != before:
            _NOW[0] = Register(after)


def register_with(own: tuple[Definition, ...]) -> Register:
    """The definitions of this call and those that a request brings along, which come first."""
    return _with(register(), own)


@lru_cache(maxsize=64)
def _with(known: Register, own: tuple[Definition, ...]) -> Register:
    differ = any(known.definitions.get(definition.name) != definition for definition in own)
    return Register({**known.definitions, **{one.name: one for one in own}}) if differ else known


def definitions() -> dict[str, Definition]:
    """The definitions by name, in the order in which they were made."""
    return dict(register().definitions)


def used_by(names: Iterable[str], known: Register | None = None) -> tuple[Definition, ...]:
    """The definitions that names need, each behind those that it uses."""
    definitions = (known or register()).definitions
    return closure((parts(name)[0] for name in names), definitions) if definitions else ()


def closure(names: Iterable[str], known: Mapping[str, Definition]) -> tuple[Definition, ...]:
    """The definitions behind names, each behind those that it uses."""
    result: dict[str, Definition] = {}

    def visit(name: str) -> None:
        if name in known and name not in result:
            for used in known[name].uses:
                visit(parts(used)[0])
            result[name] = known[name]

    for name in names:
        visit(name)
    return tuple(result.values())


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
    pairs = (
        (first, second)
        for index, first in enumerate(parameters)
        for second in parameters[index:]
        if all(_has_second(leaf, first, second) for leaf in made_of)
    )
    result = {name: (definition.unit, definition.meaning, definition.expression)}
    for by in (*((p,) for p in parameters), *pairs):
        result[joined(name, by)] = derivative_row(name, definition.unit, by)
    return result


def derivative_row(name: str, unit: str, parameters: tuple[str, ...]) -> Row:
    """Unit and meaning of a derivative of a quantity with a unit."""
    with IMPORTS:
        from ..units.dimensions import unit_text
        from ..units.parse import coherent_unit

    *before, last = parameters
    text = unit_text(per(coherent_unit(unit), *parameters))
    return text, f"derivative of {joined(name, before)} with respect to {last}", ""


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


_NOW.append(Register({}))
