"""The sections on what was given: inputs and loads, the mechanism to scale, its geometry."""

from collections.abc import Iterator
from math import pi
from typing import Any

from ...design.events.events import events
from ...design.feasibility.feasibility import feasibility
from ...evaluation.evaluate import evaluate
from ...loads.load import Load, OverY, TableOverTheta
from ...loads.stroke import OverStroke
from ...mechanism.closed import TURN
from ...mechanism.inputs import INPUTS
from ...mechanism.names import LENGTHS
from ...mechanism.own import used_by
from ...mechanism.quantity_units import UnitSystem
from ...support.forks import IMPORTS
from ..content import Content
from ..reading.values import Value
from .blocks import Block, Section, TextTable, cell, image_of
from .designs import designs_of, in_unit, unit_of, with_unit

LISTED, POINTS = 6, 24  # values of a list, points of a load, that are all shown
OF_TURN = {
    "stroke": "stroke",
    "theta_outer": "outer dead centre",
    "theta_inner": "inner dead centre",
    "max_pressure_angle": "largest pressure angle",
}
CENTRES = ("theta_outer", "theta_inner")
ANGLE = pi / 3.0  # at which the mechanism is drawn


def inputs(content: Content, units: UnitSystem) -> Section:
    """Every input with its unit, loads with their points, and quantities of the scene's own."""
    rows = [(n, *_value(n, v, units), INPUTS[n].meaning) for n, v in content.inputs.items()]
    rows += [("branch", "-1", "", "the slider is on the other side of the crank pin")] * (
        content.branch == -1
    )
    rows += [("accuracy", content.accuracy, "", "of all values")] * (content.accuracy != "standard")
    blocks: list[Block] = [TextTable(("input", "value", "unit", "meaning"), rows)]
    for name, value in content.inputs.items():
        blocks += _points(name, value, units)
    names = (*content.outputs, *(peak.quantity for peak in content.peaks))
    own = [(one.name, one.expression, one.unit, one.meaning) for one in used_by(names)]
    if own:
        blocks.append(TextTable(("quantity", "expression", "unit", "meaning"), own))
    return Section("Inputs", blocks)


def _value(name: str, value: Value, units: UnitSystem) -> tuple[str, str]:
    if isinstance(value, Load):
        conversion = units.of(name)
        own = value.unit is not None or conversion.si != 1
        return value.told(conversion).strip("<>"), "" if own else INPUTS[name].unit
    if not isinstance(value, tuple):
        return in_unit(units, name, value), unit_of(units, name)
    if len(value) <= LISTED:
        return ", ".join(in_unit(units, name, v) for v in value), unit_of(units, name)
    ends = f"{in_unit(units, name, value[0])} ... {in_unit(units, name, value[-1])}"
    return f"{ends} ({len(value)} values)", unit_of(units, name)


def _points(name: str, load: Value, units: UnitSystem) -> Iterator[Block]:
    """The points of a load that varies with the motion, where they are few."""
    if isinstance(load, TableOverTheta):
        over, tables = "theta", {name: load.table}
    elif isinstance(load, OverY):
        ways = {"outward": load.outward, "inward": load.inward or load.outward}
        over, tables = load.over, {f"{name}, {way}": table for way, table in ways.items()}
    else:
        return
    first = next(iter(tables.values()))
    if len(first.knots) > POINTS or any(len(t.values) != len(first.knots) for t in tables.values()):
        return
    head = over
    if isinstance(load, OverStroke):
        head, over = f"distance from Y_{load.dead_centre}", "Y"
    heads = [f"{head} [{unit_of(units, over)}]", *(f"{n} [{unit_of(units, name)}]" for n in tables)]
    columns = [t.values for t in tables.values()]
    yield TextTable(
        heads,
        [
            (in_unit(units, over, knot), *(in_unit(units, name, column[k]) for column in columns))
            for k, knot in enumerate(first.knots)
        ],
    )


def mechanism(content: Content, units: UnitSystem) -> Section | None:
    """The first design to scale, and the geometry of each; None without the lengths."""
    if any(name not in content.inputs for name in LENGTHS):
        return None
    with IMPORTS:
        from ...plot.mechanism import sketched

    designs = designs_of(content, units)
    lengths = {name: designs[0].inputs[name] for name in LENGTHS}
    angle = _angle(lengths, content.branch)
    picture = sketched(angle, lengths, content.branch, units)
    words = f"The mechanism to scale at theta = {with_unit(units, 'theta', angle)}"
    words += f", {designs[0].words}" if designs[0].words else ""
    columns = [_geometry({n: one.inputs[n] for n in LENGTHS}, content.branch, units) for one in designs]
    rows = [(name, *(column[name] for column in columns)) for name in columns[0]]
    heads = ("", *(one.words or "this design" for one in designs))
    return Section("Mechanism", [image_of(picture.figure, words), TextTable(heads, rows)])


def _angle(lengths: dict[str, Any], branch: int) -> float:
    """An angle at which the mechanism can be assembled, if there is one."""
    intervals = feasibility(**lengths)["theta_intervals"]
    if evaluate("status", theta=ANGLE, branch=branch, **lengths) == 0 or not intervals:
        return ANGLE
    return 0.5 * float(sum(intervals[0]))


def _geometry(lengths: dict[str, Any], branch: int, units: UnitSystem) -> dict[str, str]:
    found = feasibility(**lengths)
    kind = "no, it cannot be assembled" if found["kind"] == "none" else f"no ({found['kind']})"
    told = {
        "turns fully": "yes" if found["can_turn"] else kind,
        "margin BC - AB - |ec|": with_unit(units, "margin", found["margin"]),
    }
    turn = events(branch=branch, **lengths)
    for name, words in OF_TURN.items():
        value = turn[name] % TURN if name in CENTRES else turn[name]  # angles of a turn, as of peaks
        told[words] = with_unit(units, name, value)
    return {**told, "time ratio": cell(turn["time_ratio"])}
