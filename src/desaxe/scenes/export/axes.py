"""The axes of a scene in a written module: a range by its ends and step, a list by its values."""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from textwrap import wrap
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.catalogue import of_design
from ...mechanism.names import LENGTHS
from ...runtime.request import request
from ..content import Content
from ..reading.spread import in_parts

SPACED = '''def spaced(first, rest, step, num):
    """num values from first + rest on, correctly rounded; step is in parts, whose products are exact."""
    k = arange(num, dtype=float64)
    wide, narrow = k * step[0], k * step[1]
    total = wide + narrow
    lost = narrow - (total - wide)
    value = first + total
    of_total = value - first
    more = (first - (value - of_total)) + (total - of_total)
    return value + (more + (lost + (k * step[2] + rest)))
'''


def axes_of(content: Content) -> list[str]:
    """The axes of a scene in loop order: one that is reduced is the last; a grid has one before it."""
    found = [name for name, value in content.inputs.items() if isinstance(value, tuple)]
    if content.fused is None:
        return found or [""]
    rest = [name for name in found if name != content.fused.axis]
    return [*(rest or [""]), content.fused.axis]


def own_axes(content: Content, names: Iterable[str]) -> dict[str, list[str]]:
    """The axes of each quantity of a whole design: lengths, and a speed whose sign it uses."""
    axes = [name for name, value in content.inputs.items() if isinstance(value, tuple)]
    found = {}
    for name in filter(of_design, names):
        asked = request((name,), dict(content.inputs), content.branch, content.accuracy)
        found[name] = [axis for axis in axes if axis in (*LENGTHS, *asked.inputs)]
    return found


def axes_text(axes: Mapping[str, Sequence[float]]) -> str:
    """`AXES`, and the function that spreads their values."""
    rows = ["# The scene's axes, the outermost first.", "AXES = {"]
    for name, values in axes.items():
        rows += axis_rows(name, values, "    ", 90)
    text = "\n".join([*rows, "}"])
    return f"{SPACED}\n\n{text}" if "spaced(" in text else text


def axis_rows(name: str, values: Sequence[float], indent: str, width: int) -> list[str]:
    """The entry of an axis in a table: its rule, or its values in rows of a width."""
    rule = rule_of(values)
    if rule:
        return [f'{indent}"{name}": {rule},']
    rows = [f"{indent}    {row}" for row in number_rows(values, width)]
    return [f'{indent}"{name}": array([', *rows, f"{indent}]),"]


def number_rows(values: Sequence[float], width: int) -> list[str]:
    """Numbers as rows of an array in a text."""
    return wrap(", ".join(map(repr, values)) + ",", width)


WITH_AXES = '''def with_axes(axes, given):
    """The axes of the scene, with those that are given in their places: 1-d arrays in the same order."""
    axes = dict(axes)
    for name, values in given.items():
        if values is not None:
            (numbers,) = doubles(**{name: values})
            if numbers.ndim > 1:
                raise ValueError(f"{name}: expected a number or one dimension, got the shape {numbers.shape}")
            axes[name] = ascontiguousarray(numbers.reshape(-1))
    return axes
'''
CHOSEN = '''def chosen(**given):
    """The axes of a run."""
    axes = with_axes(AXES, given)
'''
REACH = """    theta = axes["theta"]
    if (abs(theta[isfinite(theta)]) > LIMIT).any():
        raise ValueError("theta: at most ROUNDED rad in magnitude; take whole turns off")
"""


def chosen_text(axes: Iterable[str], limit: float | None) -> str:
    """`chosen`: the axes of a run; angles are checked against the largest one that is reduced exactly."""
    check = ""
    if limit is not None and "theta" in axes:
        check = REACH.replace("LIMIT", repr(limit)).replace("ROUNDED", f"{limit:.0f}")
    return CHOSEN + check + "    return axes\n"


def arguments_of(axes: Iterable[str]) -> str:
    """The parameters of a function whose axes may be given in the place of the scene's."""
    return ", ".join(["*", *(f"{name}=None" for name in axes), "threads=None"])


def taken_from(axes: Iterable[str]) -> str:
    """The line that looks up the axes."""
    return f"    axes = chosen({', '.join(f'{name}={name}' for name in axes)})"


def rule_of(values: Sequence[float]) -> str:
    """An expression for exactly these values; empty if there is none."""
    array = np.array(values)
    if len(values) < 3:
        return ""
    if np.array_equal(array, np.linspace(values[0], values[-1], len(values))):
        return f"linspace({values[0]!r}, {values[-1]!r}, {len(values)})"
    start, stop = getattr(values, "start", None), getattr(values, "stop", None)
    if start is None or stop is None:
        start, stop = Fraction(values[0]), Fraction(values[-1])
    first, rest, step = in_parts(start, (stop - start) / (len(values) - 1))
    if not np.array_equal(array, _spaced(first, rest, step, len(values))):
        return ""
    return f"spaced({first!r}, {rest!r}, {step!r}, {len(values)})"


def _spaced(first: float, rest: float, step: tuple[float, float, float], num: int) -> NDArray[np.float64]:
    scope: dict[str, Any] = {"arange": np.arange, "float64": np.float64}
    exec(SPACED, scope)
    found: NDArray[np.float64] = scope["spaced"](first, rest, step, num)
    return found
