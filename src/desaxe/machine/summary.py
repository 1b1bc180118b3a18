"""The summary of a machine: a small drawing and a table, as text and as HTML for notebooks."""

from collections.abc import Mapping
from html import escape
from math import cos, isfinite, isnan, pi, sin
from typing import Any, NamedTuple

from ..design.events.events import events
from ..design.feasibility.feasibility import feasibility
from ..evaluation.evaluate import evaluate
from ..loads.load import Load
from ..loads.words import brief
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, LOADS
from ..mechanism.quantity_units import UnitSystem
from ..support.shown import with_unit
from ..support.text_table import table

_ORDER = ("AB", "BC", "ec", "omega0", "omega", "alpha", *LOADS)
NAMES = {name: INPUTS[name].brief for name in _ORDER} | {"branch": "side of the slider"}
ROWS, COLUMNS = 11, 21  # of the drawing in text
WIDEST = 28  # letters of a value that the column is made for
ANGLE = pi / 3  # at which it is drawn


class Pose(NamedTuple):
    """Positions of the joints for a drawing: A is at the origin, Y points up."""

    B: tuple[float, float]
    C: tuple[float, float]
    AB: float


def rows_of(machine: Any) -> list[tuple[str, str, str]]:
    """Rows of the summary: name, value with unit, and meaning."""
    shown = machine.in_units()
    rows = [(name, _input(machine.units, name, shown[name]), NAMES[name]) for name in NAMES if name in shown]
    return rows + _geometry(machine)


def _input(units: UnitSystem, name: str, value: Any) -> str:
    if name == "branch":
        return _value(value, "")
    conversion = units.of(name)
    return brief(value, conversion) if isinstance(value, Load) else _value(value, conversion.unit)


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
    told = events(branch=machine.get("branch", 1), **lengths)
    for name, meaning in (("stroke", "of the slider"), ("time_ratio", "slow stroke to quick one")):
        unit = machine.units.of("ec").unit if name == "stroke" else "1"
        value = machine.units.of("ec").shown(told[name]) if name == "stroke" else told[name]
        if isfinite(value):
            rows.append((name, _value(value, unit), meaning))
    return rows


def pose_of(machine: Mapping[str, Any]) -> Pose | None:
    """The pose of the first design at a feasible angle; None without one, or without lengths."""
    if any(name not in machine for name in LENGTHS):
        return None
    ec, AB, BC = (_first(machine[name]) for name in LENGTHS)
    theta = ANGLE
    Y = evaluate("Y", theta=theta, ec=ec, AB=AB, BC=BC, branch=machine.get("branch", 1))
    if isnan(Y):
        intervals = feasibility(ec=ec, AB=AB, BC=BC)["theta_intervals"]
        if not intervals:
            return None
        theta = 0.5 * sum(intervals[0])
        Y = evaluate("Y", theta=theta, ec=ec, AB=AB, BC=BC, branch=machine.get("branch", 1))
    return Pose((AB * sin(theta), AB * cos(theta)), (-ec, float(Y)), AB)


def _first(value: Any) -> float:
    return float(value[0]) if hasattr(value, "tolist") else float(value)


# ---- text ----------------------------------------------------------------------------------------


def text_of(machine: Any) -> str:
    """The machine as text: the drawing beside its table."""
    lines = table(rows_of(machine), most=WIDEST)
    units = f", units={machine.units!r}" if machine.units else ""
    title = f"Machine({len(machine)} inputs{units})"
    pose = pose_of(machine)
    drawing = _drawing(pose) if pose else []
    height = max(len(drawing), len(lines))
    left = [*drawing, *[""] * (height - len(drawing))]
    right = [*lines, *[""] * (height - len(lines))]
    wide = COLUMNS if drawing else 0
    return "\n".join([title, *(f"  {a:{wide}}  {b}".rstrip() for a, b in zip(left, right, strict=True))])


def _drawing(pose: Pose) -> list[str]:
    """The mechanism in letters, to scale; a letter is twice as high as wide."""
    (bx, by), (cx, cy) = pose.B, pose.C
    xs, ys = (0.0, bx, cx), (0.0, by, cy)
    size = max((max(ys) - min(ys)) / (ROWS - 1), 2.0 * (max(xs) - min(xs)) / (COLUMNS - 5)) or 1.0
    middle = 0.5 * (max(xs) + min(xs))
    cells = [[" "] * COLUMNS for _ in range(ROWS)]

    def place(x: float, y: float) -> tuple[int, int]:
        row = (max(ys) - y) / size
        column = COLUMNS // 2 + 2.0 * (x - middle) / size
        return min(ROWS - 1, max(0, round(row))), min(COLUMNS - 2, max(1, round(column)))

    for (x0, y0), (x1, y1) in (((bx, by), (cx, cy)), ((0.0, 0.0), (bx, by))):
        (first, left), (last, right) = place(x0, y0), place(x1, y1)
        steps = max(abs(last - first), abs(right - left), 1)
        for k in range(steps + 1):
            row, column = (round(a + (b - a) * k / steps) for a, b in ((first, last), (left, right)))
            cells[row][column] = _stroke(x1 - x0, y1 - y0)
    for (x, y), mark in (((bx, by), "o"), ((0.0, 0.0), "A")):
        row, column = place(x, y)
        cells[row][column] = mark
    row, column = place(cx, cy)
    cells[row][column - 1 : column + 2] = "[C]"
    lines = ["".join(line).rstrip() for line in cells]
    while lines and not lines[-1]:
        lines.pop()
    return lines


def _stroke(x: float, y: float) -> str:
    """The character with about this slope."""
    if abs(x) < 0.2 * abs(y):
        return "|"
    if abs(y) < 0.25 * abs(x):
        return "-"
    return "/" if x * y > 0.0 else "\\"


# ---- HTML ----------------------------------------------------------------------------------------


def html_of(machine: Any) -> str:
    """The machine for a notebook: a drawing to scale and a table."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(value)}</td>"
        f"<td style='text-align:left;opacity:.7'>{escape(meaning)}</td></tr>"
        for name, value, meaning in rows_of(machine)
    )
    units = f"<caption>units: {escape(str(machine.units).strip(chr(39)))}</caption>" if machine.units else ""
    pose = pose_of(machine)
    drawing = _svg(pose) if pose else ""
    return (
        "<div style='display:flex;gap:1.5em;align-items:center'>"
        f"{drawing}<table>{units}<tbody>{rows}</tbody></table></div>"
    )


def _svg(pose: Pose) -> str:
    """Crank, rod, slider and guide."""
    (bx, by), (cx, cy), r = pose.B, pose.C, pose.AB or 0.1 * (abs(pose.C[1]) or 1.0)
    room = 0.45 * r
    low, high = min(-r, cy) - room, max(r, cy) + room
    left, right = min(-r, cx) - room, max(r, cx) + room
    wide, tall = right - left, high - low
    height = 180.0
    width = max(40.0, height * wide / tall)

    def x(value: float) -> str:
        return f"{(value - left) / wide * width:.1f}"

    def y(value: float) -> str:
        return f"{(high - value) / tall * height:.1f}"

    def line(
        a: tuple[float, float], b: tuple[float, float], colour: str, thick: float, dash: str = ""
    ) -> str:
        return (
            f"<line x1='{x(a[0])}' y1='{y(a[1])}' x2='{x(b[0])}' y2='{y(b[1])}' stroke='{colour}' "
            f"stroke-width='{thick:g}' stroke-linecap='round'{dash}/>"
        )

    scale = height / tall
    half = 0.28 * r * scale
    dashes = " stroke-dasharray='3 3'"
    parts = [
        f"<circle cx='{x(0.0)}' cy='{y(0.0)}' r='{r * scale:.1f}' fill='none' stroke='#999'{dashes}/>",
        line((cx, low + 0.3 * room), (cx, high - 0.3 * room), "#999", 1.0, dashes),
        f"<rect x='{float(x(cx)) - half:.1f}' y='{float(y(cy)) - half:.1f}' width='{2 * half:.1f}' "
        f"height='{2 * half:.1f}' fill='#ddd' stroke='#555'/>",
        line((bx, by), (cx, cy), "#0072B2", 4.0),
        line((0.0, 0.0), (bx, by), "#D55E00", 4.0),
        *(
            f"<circle cx='{x(px)}' cy='{y(py)}' r='3.5' fill='#fff' stroke='#222'/>"
            for px, py in ((0.0, 0.0), (bx, by), (cx, cy))
        ),
    ]
    return f"<svg width='{width:.0f}' height='{height:.0f}' role='img'>{''.join(parts)}</svg>"
