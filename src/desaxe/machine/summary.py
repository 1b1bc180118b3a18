"""The summary of a machine: a table, as text, and with a drawing as HTML for notebooks."""

from collections.abc import Mapping
from html import escape
from math import cos, isfinite, isnan, sin
from typing import Any

from ..design.events.events import events
from ..design.feasibility.feasibility import feasibility
from ..evaluation.evaluate import evaluate
from ..loads.load import Load
from ..loads.words import brief
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, LOADS
from ..mechanism.quantity_units import UnitSystem
from ..scenes.document.design import feasible_angle
from ..support.shown import with_unit
from ..support.text_table import table

_ORDER = ("AB", "BC", "ec", "omega0", "omega", "alpha", *LOADS)
NAMES = {name: INPUTS[name].brief for name in _ORDER} | {"branch": "side of the slider"}
WIDEST = 28  # letters of a value that the column is made for
HEIGHT = 180.0  # of the drawing


def rows_of(machine: Any) -> list[tuple[str, str, str]]:
    """Rows of the summary: name, value with unit, and meaning."""
    shown = machine.in_units()
    rows = [(name, _input(machine.units, name, shown[name]), NAMES[name]) for name in NAMES if name in shown]
    return rows + _geometry(machine)


def _input(units: UnitSystem, name: str, value: Any) -> str:
    if name == "branch":
        return _value(value, "")
    return brief(value, name, units) if isinstance(value, Load) else _value(value, units.of(name).unit)


def _value(value: Any, unit: str) -> str:
    if callable(value):
        name = getattr(value, "__name__", None)
        return f"the function {name}" if name else repr(value)
    if hasattr(value, "tolist"):
        numbers = value.tolist()
        text = f"{numbers[0]:.6g} ... {numbers[-1]:.6g}"
        return f"{with_unit(text, unit)} ({len(numbers)} values)"
    return with_unit(f"{value:.6g}", unit)


def _geometry(machine: Any) -> list[tuple[str, str, str]]:
    """Rows on the geometry: full turns, stroke, time ratio; for arrays, the number of designs that turn."""
    lengths = {name: machine[name] for name in LENGTHS if name in machine}
    if len(lengths) < len(LENGTHS):
        return []
    can_turn = feasibility(**lengths)["can_turn"]
    if hasattr(can_turn, "sum"):
        return [("turns", f"{int(can_turn.sum())} of {can_turn.size} designs", "full turns of the crank")]
    rows = [("turns", "yes" if can_turn else "no", "full turns of the crank")]
    if not can_turn:
        kind = feasibility(**lengths)["kind"]
        return [("turns", f"no ({kind})" if kind != "none" else "no, it cannot be assembled", rows[0][2])]
    message = events(branch=machine.get("branch", 1), **lengths)
    for name, meaning in (("stroke", "of the slider"), ("time_ratio", "slow stroke to quick one")):
        unit = machine.units.of("ec").unit if name == "stroke" else "1"
        value = machine.units.of("ec").shown(message[name]) if name == "stroke" else message[name]
        if isfinite(value):
            rows.append((name, _value(value, unit), meaning))
    return rows


def _first(value: Any) -> float:
    return float(value[0]) if hasattr(value, "tolist") else float(value)


def text_of(machine: Any) -> str:
    """The machine as text."""
    units = f", units={machine.units!r}" if machine.units else ""
    lines = (f"  {line}" for line in table(rows_of(machine), most=WIDEST))
    return "\n".join([f"Machine({len(machine)} inputs{units})", *lines])


def html_of(machine: Any) -> str:
    """The machine for a notebook: a drawing to scale and a table."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(value)}</td>"
        f"<td style='text-align:left;opacity:.7'>{escape(meaning)}</td></tr>"
        for name, value, meaning in rows_of(machine)
    )
    units = f"<caption>units: {escape(str(machine.units).strip(chr(39)))}</caption>" if machine.units else ""
    return (
        "<div style='display:flex;gap:1.5em;align-items:center'>"
        f"{_drawing(machine)}<table>{units}<tbody>{rows}</tbody></table></div>"
    )


def _drawing(machine: Mapping[str, Any]) -> str:
    """Crank, rod, slider and guide of the first design at a feasible angle; empty where there is none."""
    if any(name not in machine for name in LENGTHS):
        return ""
    lengths: dict[str, Any] = {name: _first(machine[name]) for name in LENGTHS}
    branch = machine.get("branch", 1)
    theta = feasible_angle(lengths, branch)
    end = float(evaluate("Y", theta=theta, branch=branch, **lengths))
    if isnan(end):
        return ""
    crank = lengths["AB"]
    pin, slider = (crank * sin(theta), crank * cos(theta)), (-lengths["ec"], end)
    r = crank or 0.1 * (abs(end) or 1.0)
    low, left = min(-r, end) - 0.45 * r, min(-r, slider[0]) - 0.45 * r
    high, right = max(r, end) + 0.45 * r, max(r, slider[0]) + 0.45 * r
    scale = HEIGHT / (high - low)

    def at(point: tuple[float, float]) -> tuple[float, float]:
        return (point[0] - left) * scale, (high - point[1]) * scale

    def line(a: tuple[float, float], b: tuple[float, float], style: str) -> str:
        (x1, y1), (x2, y2) = at(a), at(b)
        ends = f"x1='{x1:.1f}' y1='{y1:.1f}' x2='{x2:.1f}' y2='{y2:.1f}'"
        return f"<line {ends} stroke-linecap='round' {style}/>"

    half, dashes = 0.28 * r * scale, "stroke='#999' stroke-dasharray='3 3'"
    (ax, ay), (cx, cy) = at((0.0, 0.0)), at(slider)
    joints = [f"<circle cx='{x:.1f}' cy='{y:.1f}' r='3.5' fill='#fff' stroke='#222'/>"
              for x, y in map(at, ((0.0, 0.0), pin, slider))]  # fmt: skip
    parts = [
        f"<circle cx='{ax:.1f}' cy='{ay:.1f}' r='{crank * scale:.1f}' fill='none' {dashes}/>",
        line((slider[0], low + 0.1 * r), (slider[0], high - 0.1 * r), dashes),
        f"<rect x='{cx - half:.1f}' y='{cy - half:.1f}' width='{2 * half:.1f}' height='{2 * half:.1f}' "
        "fill='#ddd' stroke='#555'/>",
        line(pin, slider, "stroke='#0072B2' stroke-width='4'"),
        line((0.0, 0.0), pin, "stroke='#D55E00' stroke-width='4'"),
        *joints,
    ]
    width = max(40.0, (right - left) * scale)
    return f"<svg width='{width:.0f}' height='{HEIGHT:.0f}' role='img'>{''.join(parts)}</svg>"
