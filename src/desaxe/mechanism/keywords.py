"""Keywords of public calls: an unknown one is refused with the one that was meant."""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import ParamSpec, TypeVar

from ..support.forks import IMPORTS
from ..support.shown import shown
from .inputs import INPUTS
from .spelling import did_you_mean

NEAREST = 3  # names that a message suggests
P = ParamSpec("P")
T = TypeVar("T")


def check_inputs(caller: str, inputs: Iterable[str], allowed: Sequence[str]) -> None:
    """TypeError for an unknown input, with similar names."""
    for name in inputs:
        if name not in allowed:
            raise unknown_input(caller, name, allowed)


def unknown_input(caller: str, name: str, allowed: Sequence[str]) -> TypeError:
    """The error for an unknown input: those that are most like it; all there are if none is."""
    if name == "as_quantity":
        way = f"a machine's {caller} has it, as in dx.Machine(**inputs).{caller}(..., as_quantity=True)"
        return TypeError(f"{caller}() has no as_quantity=: {way}")
    near = did_you_mean(name, allowed, NEAREST).strip() or f"there are {', '.join(allowed)}"
    return TypeError(f"{caller}() has no input {shown(name)}; {near}")


def with_known_keywords(function: Callable[P, T], caller: str = "") -> Callable[P, T]:
    """Decorate a function to refuse unknown keywords as `check_inputs` does; `**` stands for all inputs."""
    known: list[str] = []

    @wraps(function)
    def checked(*args: P.args, **named: P.kwargs) -> T:
        if not known:
            known.extend(keywords_of(function))
        if named.get("sliders") is None or "sliders" not in known:  # these know their inputs
            check_inputs(caller or function.__name__, named, known)
        return function(*args, **named)

    return checked


def keywords_of(function: Callable[..., object]) -> list[str]:
    """The keywords of a function; `**` stands for all inputs."""
    with IMPORTS:
        from inspect import signature

    every = signature(function).parameters
    own = [name for name, one in every.items() if name != "self" and one.kind is not one.VAR_KEYWORD]
    return own if len(own) == len([name for name in every if name != "self"]) else [*own, *INPUTS]
