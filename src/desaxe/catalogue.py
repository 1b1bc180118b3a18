"""What can be asked for: every quantity and sensitivity, its unit, meaning and paper equation.

The names are read from generated/index.py, where the derivation wrote them. Under a given state
(`omega` instead of `omega0`) the sensitivity `_wrt_omega` stands where `_wrt_omega0` does.
"""

from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from .names import PARAMETERS, joined, parts, sensitivity


class Quantity(NamedTuple):
    """One name that can be asked for."""

    name: str
    unit: str
    meaning: str
    source: str = ""


class Catalogue(tuple[Quantity, ...]):
    """Quantities that show themselves as a table; `catalogue["T_in"]` is one of them by name."""

    __slots__ = ()

    def __getitem__(self, place: Any) -> Any:
        return quantity(place) if isinstance(place, str) else super().__getitem__(place)

    def __repr__(self) -> str:
        rows = [("name", "unit", "meaning", "source"), *self]
        widths = [max(len(row[i]) for row in rows) for i in range(3)]
        return "\n".join(
            "  ".join([*(cell.ljust(w) for cell, w in zip(row, widths, strict=False)), row[3]]).rstrip()
            for row in rows
        )


@cache
def _names() -> dict[str, tuple[str, ...]]:
    names: dict[str, tuple[str, ...]] = import_module("desaxe.generated.index").NAMES
    return names


def quantities() -> Catalogue:
    """Every quantity and sensitivity that can be asked for, in order: name, unit, meaning, source."""
    return Catalogue(Quantity(name, *row) for name, row in _names().items())


def quantity(name: str, state: bool = False) -> Quantity:
    """One of them by name; ValueError with the nearest names where there is none such."""
    if not isinstance(name, str):
        raise TypeError(f"the name of a quantity is a str, got {name!r}")
    row = _names().get(law_name(name) if state else name)
    if row is None or (state and "omega0" in name):
        raise ValueError(_unknown(name, state))
    return Quantity(name, *row)


def law_name(name: str) -> str:
    """The name under the law of a name under a state: omega stands in the place of omega0."""
    base, parameters = parts(name)
    return joined(base, ("omega0" if p == "omega" else p for p in parameters))


def _unknown(name: str, state: bool) -> str:
    from ._meant import meant

    if not state and law_name(name) in _names():
        return f"{name!r} needs a state: give omega= instead of omega0="
    if state and name in _names():
        return (
            f"{name!r} has no meaning for a given state omega=: ask for {name.replace('omega0', 'omega')!r}"
        )
    base, parameters = parts(law_name(name))
    if set(parameters) <= set(PARAMETERS) and base in _names():
        ordered = sensitivity(base, *parameters)
        if ordered in _names():
            return f"{name!r}: the parameters of a sensitivity stand in one order, {ordered!r}"
        if len(parameters) > 1:
            return f"{name!r}: this derivative is not derived (second order: Y, V_C, a_C, omega_BC, alpha_BC)"
    near = (
        meant(name, _names(), 3)
        or [
            known
            for known, (_, meaning, _) in _names().items()
            if f" {name.lower()}" in f" {meaning.lower()}"
        ][:3]
    )
    hint = f"; did you mean {', '.join(near)}?" if near else ""
    return f"unknown quantity {name!r}{hint} (desaxe.quantities() lists them all)"
