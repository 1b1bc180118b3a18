"""The inputs that quantities of a scene need: those given, or a SceneError that names the missing one."""

from collections.abc import Iterable, Mapping
from typing import Any

from ...mechanism.catalogue import law_name, of_design, quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.names import FORCE_STATUS, LENGTHS, LOADS, STATUS
from ...mechanism.program import Variant, program_of
from ...runtime.request import needs_no_speed
from ..schema import SceneError, shown
from .values import Value

OPTIONAL = ("alpha", *LOADS)  # 0 where they are not given, or half of a length


def require_known(key: str, name: str, state: bool) -> None:
    """Refuse a name that is no quantity, under the law or for a given state."""
    try:
        quantity(name, state)
    except ValueError as error:
        raise SceneError(f"{key} = {shown(name)}: {error}") from None


def needs_of(names: Iterable[str], inputs: Mapping[str, Any]) -> tuple[str, ...]:
    """The inputs that quantities can use, under the law or for a given state; a speed where they need one."""
    state = "omega" in inputs
    law = tuple(law_name(name) if state else name for name in names)
    if "mu" in inputs:  # then the status includes that of friction
        law = tuple(FORCE_STATUS if name == STATUS else name for name in law)
    left = {"branch", *({"omega0"} - set(inputs) if needs_no_speed(law) else ())}
    return tuple(name for name in program_of(law, Variant(state)).inputs if name not in left)


def require(key: str, needs: Iterable[str], what: str, inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs from those given; SceneError for a missing one."""
    for name in needs:
        if name not in inputs and name not in OPTIONAL:
            raise SceneError(f"{key}: {what} needs {INPUTS[name].section}.{name}, which is missing")
    return [name for name in needs if name in inputs]


def require_for_grid(key: str, names: tuple[str, ...], inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs of a grid, which has `status` and `margin` too; they need no speed."""
    still = "theta" not in inputs and all(name == STATUS or of_design(name) for name in names)
    used = needs_of([name for name in names if not (still and name == STATUS)], inputs)
    needs = dict.fromkeys([*used, *LENGTHS, *(() if still else ("theta",))])
    return require(key, needs, ", ".join(names), inputs)


def with_others(inputs: Mapping[str, Value], other: Mapping[str, Value]) -> dict[str, Value]:
    """Replace inputs by others; a given state replaces the law, and vice versa."""
    swapped = {"omega": "omega0", "omega0": "omega"}
    replaced = {swapped[name] for name in other if name in swapped}
    return {**{name: value for name, value in inputs.items() if name not in replaced}, **other}


def single(key: str, names: Iterable[str], inputs: Mapping[str, Value]) -> dict[str, Any]:
    """Inputs that must be single: a number or a load that varies; SceneError for a list or range."""
    found: dict[str, Any] = {}
    for name in names:
        value = inputs[name]
        if isinstance(value, tuple):
            family = f", or family.{name} for a curve of each" if key.startswith("picture") else ""
            raise SceneError(f"{key}: {name} has {len(value)} values, expected one: give at.{name}{family}")
        found[name] = value
    return found
