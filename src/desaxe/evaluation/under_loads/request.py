"""The request of names under loads: its variant names the loads, never their content."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.lines import line_of, totals_of
from ...loads.load import Load, OverTheta, OverY
from ...loads.resolve import LoadPlan
from ...mechanism.inputs import SAFE
from ...mechanism.load_lines import LoadLines, TurningSense, Under
from ...runtime.request import Request, request
from ..arrays import are_beyond

Array = NDArray[Any]

LEAST = 10_000  # points: of fewer, to look for those that rounding decides takes what the kernel saves


def under_loads(plan: LoadPlan, given: Mapping[str, Any], branch: int, accuracy: Any) -> Request:
    """The request of a plan's totals, whose variant names the loads; those over theta are columns."""
    every = tuple(dict.fromkeys((*plan.names, *plan.motion)))
    asked = request(every, {**given, **dict.fromkeys(plan.loads, 1.0)}, branch, accuracy)
    names = dict(zip(asked.shown, asked.names, strict=True))
    lines = tuple(
        LoadLines(name, "") if isinstance(load, OverTheta) else line_of(name, load)
        for name, load in plan.loads.items()
    )
    under = Under(tuple(names.items()), lines, totals_of(plan), _way(given))
    own = tuple(names[name] for name in plan.shown)
    return Request(plan.shown, own, asked.form._replace(under=under), asked.fixed, asked.accuracy)


def _way(given: Mapping[str, Any]) -> TurningSense:
    """The inputs that tell the way of turning."""
    speeds = [name for name in ("omega", "omega0") if given.get(name) is not None]
    start = "alpha" if speeds == ["omega"] and given.get("alpha") is not None else 0.0
    return TurningSense(speeds[0] if speeds else 1.0, start)


def table_arrays(loads: Mapping[str, Load]) -> dict[str, Array]:
    """The arrays of the tables of loads over the slider's place, by the names of a kernel's arguments."""
    found: dict[str, Array] = {}
    for name, load in loads.items():
        if isinstance(load, OverY):
            knots, coefficients = load.arrays()
            found |= {f"{name}_x": np.array(knots), f"{name}_c": np.array(coefficients)}
    return found


def are_extreme_under(loads: Mapping[str, Load], axes: Mapping[str, Array]) -> bool:
    """True where an input, or a load, is near the ends of the double range."""
    large = (load.largest > SAFE[1] for load in loads.values() if isinstance(load, OverY))
    return any(large) or any(are_beyond(n, a).any() for n, a in axes.items())
