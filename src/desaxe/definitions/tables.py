"""Definitions as tables: `[quantities.NAME]` of a scene or of a file of its own, and in stored results.

[quantities.shoe_power]
expression = "f * abs(N_C * V_C)"
unit = "W"
meaning = "power lost in the shoe"
constants = { f = 0.08 }
"""

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

from ..mechanism.own import Definition, change, register, used_by
from .define import compiled, with_definitions


def read_definitions(tables: Mapping[str, Mapping[str, Any]]) -> tuple[Definition, ...]:
    """Read the definitions of `[quantities]`, in any order, of tables that the schema of scenes lets pass."""
    waiting = dict(tables)
    known = {name: old for name, old in register().definitions.items() if name not in waiting}
    made: dict[str, Definition] = {}
    while waiting:
        # The definitions that use no other pending one; a circle leaves none, and the first reports it.
        ready = [n for n, table in waiting.items() if not _mentions(table["expression"], waiting, n)]
        for name in ready or [next(iter(waiting))]:
            table: dict[str, Any] = {"unit": None, "meaning": "", "constants": {}, **waiting.pop(name)}
            made[name] = compiled(name, **table, known={**known, **made})
    return tuple(made.values())


def _mentions(expression: str, names: Mapping[str, Any], own: str) -> bool:
    """True if an expression contains one of the names other than its own, or a sensitivity of one."""
    words = {word.partition("_wrt_")[0] for word in re.findall(r"[A-Za-z_]\w*", expression[:10_000])}
    return any(name in words for name in names if name != own)


def tables_of(made: Iterable[Definition]) -> dict[str, dict[str, Any]]:
    """The tables of definitions, normalised."""
    result: dict[str, dict[str, Any]] = {}
    for own in made:
        result[own.name] = {"expression": own.expression, "unit": own.unit, "meaning": own.meaning}
        if own.constants:
            result[own.name]["constants"] = dict(own.constants)
    return result


def text_of(names: Iterable[str]) -> str:
    """The definitions that names need, as JSON for a stored result; empty if there are none."""
    own = used_by(names)
    return json.dumps(tables_of(own)) if own else ""


def redefine(made: Iterable[Definition]) -> None:
    """Register definitions, replacing others of the same names."""
    made = tuple(made)
    change(lambda known: with_definitions(known, [own for own in made if known.get(own.name) != own]))
