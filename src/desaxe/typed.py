"""The public calls as type checkers see them; nothing imports this file at run time.

Inputs are keywords, so `peak("a_C", **lengths)` with a `dict[str, float]` must pass whatever the types of the
options: each call has a second signature for that.
"""

from collections.abc import Callable
from typing import Any, ParamSpec, Protocol, TypeVar, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from .design.design_map import design_map as _design_map
from .design.drive.drive import drive as _drive
from .design.events.events import events as _events
from .design.feasibility.feasibility import feasibility as _feasibility
from .design.fit.fit import fit as _fit
from .design.inverse import inverse as _inverse
from .design.optimisation.optimize import optimize as _optimize
from .design.solve import solve as _solve
from .design.steady.steady import steady as _steady
from .design.synthesis.synthesize import synthesize as _synthesize
from .design.tolerance.tolerance import tolerance as _tolerance
from .design.turn.counterweight import counterweight as _counterweight
from .design.turn.crossings import crossings as _crossings
from .design.turn.harmonics import harmonics as _harmonics
from .enclosure.enclose import enclose as _enclose
from .evaluation.function import function as _function
from .evaluation.grid import grid as _grid
from .mechanism.inputs import Inputs
from .peaks.peak import peak as _peak
from .scenes.explorer.explore import explore as _explore
from .scenes.sweep import sweep as _sweep
from .simulation.simulate import simulate as _simulate

P = ParamSpec("P")
T_co = TypeVar("T_co", covariant=True)
Number = float | str | None
Floats = NDArray[np.float64]
Names = list[str] | tuple[str, ...]


@overload
def evaluate(
    names: str, *, branch: int = 1, accuracy: str | float = "standard", **inputs: Unpack[Inputs[Number]]
) -> float: ...
@overload
def evaluate(
    names: Names, *, branch: int = 1, accuracy: str | float = "standard", **inputs: Unpack[Inputs[Number]]
) -> dict[str, float]: ...
@overload
def evaluate(
    names: str,
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    **inputs: Unpack[Inputs[Number | Floats]],
) -> Floats: ...
@overload
def evaluate(
    names: Names,
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    **inputs: Unpack[Inputs[Number | Floats]],
) -> dict[str, Floats]: ...
@overload
def evaluate(names: str | Names, **inputs: Any) -> Any: ...
def evaluate(names: Any, **inputs: Any) -> Any:
    """Values of quantities and sensitivities: `evaluation.evaluate`."""
    raise NotImplementedError  # never run


class TypedCall(Protocol[P, T_co]):
    """A public call: its signature, and that of keywords from a mapping."""

    @overload
    def __call__(self, *args: P.args, **inputs: P.kwargs) -> T_co: ...
    @overload
    def __call__(self, *args: Any, **inputs: Any) -> T_co: ...


def _call(function: Callable[P, T_co]) -> TypedCall[P, T_co]:
    return function


counterweight = _call(_counterweight)
crossings = _call(_crossings)
design_map = _call(_design_map)
drive = _call(_drive)
enclose = _call(_enclose)
events = _call(_events)
explore = _call(_explore)
feasibility = _call(_feasibility)
fit = _call(_fit)
function = _call(_function)
grid = _call(_grid)
harmonics = _call(_harmonics)
inverse = _call(_inverse)
optimize = _call(_optimize)
peak = _call(_peak)
simulate = _call(_simulate)
solve = _call(_solve)
steady = _call(_steady)
sweep = _call(_sweep)
synthesize = _call(_synthesize)
tolerance = _call(_tolerance)
