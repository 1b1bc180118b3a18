"""The arguments of a user's function: a load or a torque is called with what they name, in any order."""

from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, signature
from typing import Any

ARGUMENTS = ("t", "theta", "omega", "Y", "s", "V_C")
POSITIONED = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)


def arguments_of(name: str, function: Callable[..., Any], served: Sequence[str]) -> tuple[str, ...]:
    """The arguments that a function needs, in its order; TypeError for one that it is not called with.

    name     of the input that the function is for
    served   the arguments that the call passes
    """
    needed = required(name, function)
    unknown = next((argument for argument in needed if argument not in ARGUMENTS), None)
    if unknown is not None or not needed:
        message = getattr(function, "__name__", type(function).__name__)
        what = f"{message} has {unknown}" if needed else f"{message} has none without a default"
        raise TypeError(
            f"{name}: a function is called by the names of its arguments, {', '.join(ARGUMENTS)}, but {what}"
        )
    refused = [argument for argument in needed if argument not in served]
    if refused:
        raise TypeError(
            f"{name}: a function of {', '.join(refused)} is not served by this call, which passes "
            f"{', '.join(served)}"
        )
    return needed


def by_position(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, its arguments without a default in order; those that need their names are wrapped."""
    needed = [p for p in _parameters("", function) if _is_required(p)]
    named = [p.name for p in needed if p.kind is Parameter.KEYWORD_ONLY]
    if not named:
        return function
    first = len(needed) - len(named)
    return lambda *values: function(*values[:first], **dict(zip(named, values[first:], strict=True)))


def of_one(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of one argument, whatever its name; TypeError for one of several."""
    try:
        needed = required(name, function)
    except TypeError:  # np.sin and others do not say
        return function
    if len(needed) > 1:
        message = getattr(function, "__name__", type(function).__name__)
        raise TypeError(
            f"{name}: a function of one argument is expected, but {message} has {', '.join(needed)}"
        )
    return by_position(function) if needed else function


def required(name: str, function: Callable[..., Any]) -> tuple[str, ...]:
    """The names of the arguments without a default."""
    return tuple(p.name for p in _parameters(name, function) if _is_required(p))


def _is_required(parameter: Parameter) -> bool:
    return parameter.default is Parameter.empty and parameter.kind in (*POSITIONED, Parameter.KEYWORD_ONLY)


def _parameters(name: str, function: Callable[..., Any]) -> Sequence[Parameter]:
    try:
        every: Mapping[str, Parameter] = signature(getattr(function, "pyfunc", function)).parameters
    except ValueError:
        message = getattr(function, "__name__", type(function).__name__)
        raise TypeError(
            f"{name}: {message} does not say what its arguments are; give a function of any of "
            f"{', '.join(ARGUMENTS)}, such as lambda theta: {message}(theta)"
        ) from None
    return list(every.values())
