"""The catalogue: every quantity and sensitivity with its unit, meaning and paper equation.

The names are read from generated/index.py, where the derivation wrote them. Under a given state
(`omega` instead of `omega0`) the sensitivity `_wrt_omega` stands where `_wrt_omega0` does.
"""

from collections import ChainMap
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ..support.shown import printed, shown
from ..support.text_table import table
from .names import LENGTHS, LOADS, PARAMETERS, WHOLE, joined, parts, sensitivity
from .own import Register, Row, derived_names, leaves, register, used_by
from .program import Variant, program_of
from .spelling import meant


class Quantity(NamedTuple):
    """The record of a name: unit, meaning, source."""

    name: str
    unit: str
    meaning: str
    source: str = ""


# What `events` has besides the quantities of a whole design.
OF_EVENTS = frozenset((
    "V_outward", "V_inward", "theta_V_outward", "theta_V_inward", "slow_stroke",
    "theta_max_pressure_angle", "theta_min_pressure_angle",
))  # fmt: skip


class UnknownQuantityError(KeyError, ValueError):
    """No quantity has this name; the message names the nearest ones."""

    def __str__(self) -> str:
        return str(self.args[0])


class Catalogue(Mapping[str, Quantity]):
    """A mapping from every valid name to its record; printed, it is a table.

    `"a_C" in catalogue`, `catalogue["T_in"].unit`, `list(catalogue)` (the names, in order). A name that
    there is not is an UnknownQuantityError, a KeyError and a ValueError.
    """

    __slots__ = ()

    def __getitem__(self, name: str) -> Quantity:
        return quantity(name)

    def __iter__(self) -> Iterator[str]:
        return iter(_names())

    def __len__(self) -> int:
        return len(_names())

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and has(name)

    def __repr__(self) -> str:
        rows = ((name, printed(unit) or "1", *more) for name, unit, *more in self.values())
        return "\n".join(table([("name", "unit", "meaning", "source"), *rows]))


def _names(known: Register | None = None) -> Mapping[str, Row]:
    """The rows of all names; those of a user's own quantities follow."""
    own = (known or register()).rows
    return ChainMap(dict(own), derived_names()) if own else derived_names()


def quantities() -> Catalogue:
    """The catalogue: a mapping from every quantity and sensitivity to its record, in order."""
    return Catalogue()


def has(name: str, state: bool = False, known: Register | None = None) -> bool:
    """True if a name exists, under the law or, with `state`, under a given state."""
    law = law_name(name) if state else name
    there = law in derived_names() or law in (known or register()).rows
    return there and not (state and "omega0" in name)


def quantity(name: str, state: bool = False, known: Register | None = None) -> Quantity:
    """The record of a name; UnknownQuantityError with the nearest names if there is none."""
    if not isinstance(name, str):
        raise TypeError(f"the name of a quantity is a str, got {shown(name)}")
    known = known or register()
    if not has(name, state, known):
        raise UnknownQuantityError(_unknown(name, state, known))
    if state:
        _refuse_law(parts(name)[0], known)
    law = law_name(name) if state else name
    return Quantity(name, *(known.rows.get(law) or derived_names()[law]))


def of_design(name: str, known: Register | None = None) -> bool:
    """True for what the lengths alone tell of a design: the margin, the stroke, what is made of these."""
    base, known = parts(name)[0], known or register()
    if base in known.definitions:
        return all(leaf in LENGTHS or of_design(leaf, known) for leaf in leaves((base,), known.definitions))
    return base == "margin" or base in WHOLE


def _refuse_law(name: str, known: Register) -> None:
    """ValueError for a user's quantity that uses omega0: it has no meaning for a given state."""
    of_law = [leaf for leaf in leaves((name,), known.definitions) if "omega0" in leaf]
    if of_law:
        raise ValueError(f"{name!r} is made of {of_law[0]}, which has no meaning for a given state omega=")


def law_name(name: str) -> str:
    """Translate a name of a given state into that of the law: omega becomes omega0."""
    base, parameters = parts(name)
    return joined(base, ("omega0" if p == "omega" else p for p in parameters))


def inputs_of(name: str, state: bool = False, known: Register | None = None) -> tuple[str, ...]:
    """The inputs that a name depends on, all centres of mass given."""
    law = (law_name(name) if state else name,)
    inputs = program_of(law, Variant(own=used_by(law, known))).inputs
    return tuple("omega" if state and given == "omega0" else given for given in inputs)


def _unknown(name: str, state: bool, own: Register) -> str:
    names = _names(own)
    if len(name) > 100:
        return f"unknown quantity {shown(name)} (desaxe.quantities() lists them all)"
    if not state and law_name(name) in names:
        return f"{name!r} needs a state: give omega= instead of omega0="
    if state and name in names:
        other = name.replace("omega0", "omega")
        return f"{name!r} has no meaning for a given state omega=: ask for {other!r}"
    base, parameters = parts(law_name(name))
    if set(parameters) <= set(PARAMETERS) and base in names:
        ordered = sensitivity(base, *parameters)
        if ordered in names:
            return f"{name!r}: the parameters of a sensitivity stand in one order, {ordered!r}"
        if len(parameters) > 1:
            return f"{name!r}: this derivative is not derived (second order: Y, V_C, a_C, omega_BC, alpha_BC)"
    if "," in name or len(name.split()) > 1:
        return f"unknown quantity {name!r}: several names are a list, such as ['V_C', 'a_C']"
    if name in PARAMETERS or name in LOADS:
        return f"{name!r} is an input, not a quantity: it has the values that are given"
    if name in OF_EVENTS:
        return f"{name!r} is one of `events`, which takes arrays, too, and no quantity"
    word = f" {name.lower()}"
    near = meant(name, names, 3) or [one for one, row in names.items() if word in f" {row[1].lower()}"]
    hint = f"; did you mean {', '.join(near[:3])}?" if near else ""
    return f"unknown quantity {name!r}{hint} (desaxe.quantities() lists them all)"
