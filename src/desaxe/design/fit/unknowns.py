"""The unknowns of a fit: parameters of the machine, and nuisances of its instruments."""

from collections.abc import Mapping, Sequence
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS, LEAST, Input
from ...mechanism.messages import named
from ...mechanism.read import read
from ...mechanism.spelling import did_you_mean
from ...support.forks import IMPORTS
from ...support.shown import shown
from .data import MOST, Data

OFFSET = "theta_offset"


class Unknown(NamedTuple):
    """One unknown: its start, its bounds, the size of a relevant change.

    `ranged`: a range was requested; `linear`: the measurements are a linear function of it.
    """

    name: str
    start: float
    low: float
    high: float
    scale: float
    ranged: bool = False
    linear: bool = False


def unknowns_of(
    over: Mapping[str, Any], nuisance: Sequence[str] | Mapping[str, Any], data: Data, fixed: Mapping[str, Any]
) -> list[Unknown]:
    """The unknowns, checked: parameters first, then nuisances."""
    if not isinstance(over, Mapping) or not over:
        raise TypeError("over: expected a dict parameter -> start or (low, high), such as {'AB': 0.1}")
    try:
        names = (nuisance,) if isinstance(nuisance, str) else nuisance
        starts = {**names} if isinstance(names, Mapping) else dict.fromkeys(names)
    except TypeError:
        raise TypeError(f"nuisance = {shown(nuisance)}: expected names, or a dict name -> start") from None
    result = [_parameter(name, value, fixed) for name, value in over.items()]
    longest = max((u.scale for u in result if INPUTS[u.name].unit == "m"), default=1.0)
    result = [u._replace(scale=longest) if u.name == "ec" else u for u in result]
    return [*result, *(_nuisance(name, value, data) for name, value in starts.items())]


def _parameter(name: str, value: Any, fixed: Mapping[str, Any]) -> Unknown:
    allowed = [known for known in INPUTS if known != "theta"]
    if name not in allowed:
        meant = did_you_mean(str(name), allowed)
        raise ValueError(f"over: {name!r} is not a parameter; {meant}there are {', '.join(allowed)}")
    if fixed.get(name) is not None:
        raise TypeError(f"{name} is given in over= and as a fixed input: leave one of them out")
    least = LEAST.get(name, -inf)
    if isinstance(value, (tuple, list)):
        if len(value) != 2:
            raise ValueError("over: " + named(name, value) + ": expected a start or (low, high)")
        low, high = (_number(name, end) for end in value)
        if not max(low, least) < high:
            raise ValueError("over: " + named(name, value) + ": low must be below high")
        _require_moderate(name, value, max(abs(low), abs(high)))
        start, low = 0.5 * (low + high), max(low, least)
        return Unknown(name, start, low, high, max(abs(low), abs(high)), ranged=True)
    start = _number(name, value)
    _require_moderate(name, value, abs(start))
    return Unknown(name, start, least, inf, abs(start) or 1.0)


def _number(name: str, value: Any) -> float:
    return read(INPUTS[name], value, "over", "a number or (low, high)")


def _require_moderate(name: str, value: Any, size: float) -> None:
    if size and not 1.0 / MOST <= size <= MOST:
        limit = f"between {1.0 / MOST:g} and {MOST:g} in magnitude, or 0"
        raise ValueError("over: " + named(name, value) + f": {limit}")


def _nuisance(name: str, value: Any, data: Data) -> Unknown:
    """A further unknown; a bias or a scale with a range is searched for as any other."""
    if not isinstance(name, str):
        raise TypeError(f"nuisance: {shown(name)}: a name is wanted")
    kinds = {OFFSET: Unknown(name, 0.0, -inf, inf, 1.0)}
    units = {OFFSET: "rad"}
    for of, column in data.measured.items():
        size = float(np.nanstd(column)) or 1.0
        kinds[f"{of}_bias"] = Unknown(name, 0.0, -inf, inf, size, linear=True)
        kinds[f"{of}_scale"] = Unknown(name, 1.0, -inf, inf, 1.0, linear=True)
        units |= {f"{of}_bias": quantity(of).unit, f"{of}_scale": "1"}
    if name not in kinds:
        meant = did_you_mean(name, kinds)
        raise ValueError(f"nuisance: {name!r}; {meant}there are {', '.join(kinds)}")
    result, row = kinds[name], Input(name, units[name], "")
    if value is None:
        return result
    if not (isinstance(value, (tuple, list)) and len(value) == 2):
        return result._replace(start=read(row, value, "nuisance", "a start or (low, high)"))
    low, high = [read(row, end, "nuisance", "a start or (low, high)") for end in value]
    if not low < high:
        raise ValueError("nuisance: " + named(name, value) + ": low must be below high")
    return Unknown(name, 0.5 * (low + high), low, high, result.scale, ranged=True)


def starts_of(unknowns: Sequence[Unknown], count: int, seed: int) -> np.ndarray[Any, Any]:
    """Points to start from: the given one, and others spread over the ranges and the offset's turn."""
    first = np.array([u.start for u in unknowns])
    free = [k for k, u in enumerate(unknowns) if u.ranged or u.name == OFFSET]
    if not free or count == 1:
        return first[None]
    with IMPORTS:
        from scipy.stats import qmc

        sequence = qmc.Sobol(len(free), seed=seed)  # whose table is a resource
    drawn = sequence.random(1 << (count - 1).bit_length())[: count - 1]
    points = np.tile(first, (count, 1))
    for column, k in enumerate(free):
        low, high = (unknowns[k].low, unknowns[k].high) if unknowns[k].ranged else (-pi, pi)
        points[1:, k] = low + (high - low) * drawn[:, column]
    return points
