"""The summary of a machine: a table, as text, and with a drawing as HTML for notebooks."""

from contextlib import suppress
from html import escape
from math import isfinite
from typing import Any

import numpy as np

from ..design.events.events import events
from ..design.feasibility.feasibility import feasibility
from ..loads.load import Load
from ..loads.words import brief
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, LOADS
from ..scenes.document.blocks import TextTable, in_unit, with_unit
from ..scenes.document.design import drawn_to_scale, turns_fully
from ..scenes.document.render import address, element
from ..support.extras import MissingExtraError
from ..support.text_table import table

_ORDER = ("AB", "BC", "ec", "omega0", "omega", "alpha", *LOADS)
NAMES = {name: INPUTS[name].brief for name in _ORDER} | {"branch": "side of the slider"}
WIDEST = 28  # letters of a value that the column is made for
HEIGHT = 240  # of the drawing


def rows_of(machine: Any) -> list[tuple[str, str, str]]:
    """Rows of the summary: name, value with unit, and meaning."""
    rows = [(name, _value(machine, name), NAMES[name]) for name in NAMES if name in machine]
    return rows + _geometry(machine)


def _value(machine: Any, name: str) -> str:
    value, units = machine[name], machine.units
    if name == "branch":
        return str(value)
    if isinstance(value, Load):
        return brief(value, name, units)
    if callable(value):
        return f"the function {value.__name__}" if hasattr(value, "__name__") else repr(value)
    if hasattr(value, "tolist"):
        ends = in_unit(units, name, value[0]), with_unit(units, name, value[-1])
        return f"{' ... '.join(ends)} ({len(value)} values)"
    return with_unit(units, name, value)


def _geometry(machine: Any) -> list[tuple[str, str, str]]:
    """Rows on the geometry: full turns, stroke, time ratio; for arrays, the number of designs that turn."""
    lengths = {name: machine[name] for name in LENGTHS if name in machine}
    if len(lengths) < len(LENGTHS):
        return []
    can_turn: Any = feasibility(**lengths)["can_turn"]
    if hasattr(can_turn, "sum"):
        return [("turns", f"{int(can_turn.sum())} of {can_turn.size} designs", "full turns of the crank")]
    rows = [("turns", turns_fully(lengths), "full turns of the crank")]
    if can_turn:
        turn = events(branch=machine.get("branch", 1), **lengths)
        meanings = {"stroke": "of the slider", "time_ratio": "slow stroke to quick one"}
        for name, meaning in meanings.items():
            if isfinite(turn[name]):
                rows.append((name, with_unit(machine.units, name, turn[name]), meaning))
    return rows


def text_of(machine: Any) -> str:
    """The machine as text."""
    units = f", units={machine.units!r}" if machine.units else ""
    lines = (f"  {line}" for line in table(rows_of(machine), most=WIDEST))
    return "\n".join([f"Machine({len(machine)} inputs{units})", *lines])


def html_of(machine: Any) -> str:
    """The machine for a notebook: the first design to scale (extra `plot`), and the table."""
    drawing = ""
    lengths = {name: float(np.ravel(machine[name])[0]) for name in LENGTHS if name in machine}
    if len(lengths) == len(LENGTHS) and feasibility(**lengths)["kind"] != "none":
        with suppress(MissingExtraError):
            image = drawn_to_scale(lengths, machine.get("branch", 1), machine.units)
            drawing = f'<img src="{address(image)}" alt="{escape(image.words)}" height="{HEIGHT}">'
    units = f"units: {escape(str(machine.units).strip(chr(39)))}" if machine.units else ""
    listed = element(TextTable(("", units, ""), rows_of(machine)))
    return f'<div style="display:flex;gap:1.5em;align-items:center">{drawing}{listed}</div>'
