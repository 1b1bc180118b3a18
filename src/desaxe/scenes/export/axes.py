"""The axes of a scene in a written module: a range by its ends and step, a list by its values."""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from textwrap import wrap

import numpy as np

from ...mechanism.catalogue import of_design
from ...mechanism.names import LENGTHS
from ...runtime.request import request
from ..content import Content
from ..reading.spread import in_parts
from .functions import spaced


def own_axes(content: Content, names: Iterable[str]) -> dict[str, list[str]]:
    """The axes of each quantity of a whole design: lengths, and a speed whose sign it uses."""
    axes = [name for name, value in content.inputs.items() if isinstance(value, tuple)]
    result = {}
    for name in filter(of_design, names):
        asked = request((name,), dict(content.inputs), content.branch, content.accuracy)
        result[name] = [axis for axis in axes if axis in (*LENGTHS, *asked.inputs)]
    return result


def axes_text(axes: Mapping[str, Sequence[float]]) -> str:
    """`AXES`: the axes of the scene."""
    rows = [row for name, values in axes.items() for row in axis_rows(name, values, "    ", 90)]
    return "\n".join(["# The scene's axes, the outermost first.", "AXES = {", *rows, "}"])


def arguments_of(axes: Iterable[str]) -> list[str]:
    """The parameters of a function whose axes may be given in place of the scene's."""
    return ["*", *(f"{name}=None" for name in axes), "threads=None"]


def axis_rows(name: str, values: Sequence[float], indent: str, width: int) -> list[str]:
    """The entry of an axis in a table: its rule, or its values in rows of a width."""
    rule = rule_of(values)
    if rule:
        return [f'{indent}"{name}": {rule},']
    rows = [f"{indent}    {row}" for row in number_rows(values, width)]
    if len(rows) == 1:
        return [f'{indent}"{name}": array([{rows[0].strip(" ,")}]),']
    return [f'{indent}"{name}": array([', *rows, f"{indent}]),"]


def number_rows(values: Sequence[float], width: int) -> list[str]:
    """Numbers as rows of an array in a text."""
    return wrap(", ".join(map(repr, values)) + ",", width)


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
    exact = spaced(first, rest, step, len(values))  # type: ignore[no-untyped-call]
    if not np.array_equal(array, exact):
        return ""
    return f"spaced({first!r}, {rest!r}, {step!r}, {len(values)})"
