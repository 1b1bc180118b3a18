"""The axes of a scene in a written module: a range by its ends and step, a list by its values."""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from textwrap import wrap

import numpy as np

from ...mechanism.catalogue import of_design
from ...mechanism.names import LENGTHS
from ...runtime.request import request
from ...support.template import file_text, filled
from ..content import Content
from ..reading.spread import in_parts
from .functions import spaced


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
    """`AXES`: the axes of the scene."""
    rows = [row for name, values in axes.items() for row in axis_rows(name, values, "    ", 90)]
    return "\n".join(["# The scene's axes, the outermost first.", "AXES = {", *rows, "}"])


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


def chosen_text(axes: Iterable[str], limit: float | None) -> str:
    """`chosen`: the axes of a run; angles are checked against the largest one that is reduced exactly."""
    check = []
    if limit is not None and "theta" in axes:
        reach = text_file("chosen_reach")
        check = filled(reach, LIMIT=repr(limit), ROUNDED=f"{limit:.0f}").splitlines()
    return filled(text_file("chosen"), CHECK=check)


def text_file(name: str) -> str:
    """The text of a function with places for what depends on the scene."""
    return file_text(__package__, "texts", f"{name}.txt")


def arguments_of(axes: Iterable[str]) -> str:
    """The parameters of a function whose axes may be given in the place of the scene's."""
    return ", ".join(["*", *(f"{name}=None" for name in axes), "threads=None"])


def taken_from(axes: Iterable[str]) -> str:
    """The call that looks up the axes."""
    return f"chosen({', '.join(f'{name}={name}' for name in axes)})"


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
