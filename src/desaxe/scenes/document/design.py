"""The sections on the designs of a scene: inputs, mechanism and geometry, drive, tolerances."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import product
from math import inf, pi
from typing import Any, NamedTuple

from ...design.drive.drive import drive as drive_of
from ...design.events.events import events
from ...design.feasibility.feasibility import feasibility
from ...design.tolerance.tolerance import tolerance
from ...evaluation.evaluate import evaluate
from ...evaluation.in_units import in_units
from ...loads.load import Load
from ...loads.stroke import OverStroke
from ...mechanism.catalogue import of_design
from ...mechanism.closed import TURN
from ...mechanism.inputs import INPUTS
from ...mechanism.messages import errors_in
from ...mechanism.names import LENGTHS, LOADS, STATUSES
from ...mechanism.own import used_by
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.ranges import PlusMinus
from ...mechanism.read import read
from ...mechanism.status import DriveStatus, ToleranceStatus
from ...support.forks import IMPORTS
from ...support.shown import shown
from ...units.text import with_unit_of
from ..content import Content
from ..loads import WAYS, kind_of
from ..reading.values import Value
from .blocks import (
    NONE,
    Block,
    Image,
    Section,
    Text,
    TextTable,
    cell,
    image_of,
    in_unit,
    thinned,
    unit_of,
    with_unit,
)

MOST = 6  # designs beside each other
LISTED, POINTS = 6, 24  # values of a list, points of a load, that are all shown
OF_TURN = {
    "stroke": "stroke",
    "theta_outer": "outer dead centre",
    "theta_inner": "inner dead centre",
    "max_pressure_angle": "largest pressure angle",
}
CENTRES = ("theta_outer", "theta_inner")
ANGLE = pi / 3.0  # at which the mechanism is drawn
ALWAYS = (*STATUSES, "margin")
SAMPLES = 1000  # of a Monte Carlo: its standard deviation is good to 2 %
SPREAD = ("quantity", "nominal", "unit", "standard deviation", "worst case", "driven by")


class Design(NamedTuple):
    """One design of a scene: what it is called, and its inputs in SI units, without crank angles."""

    words: str
    inputs: dict[str, Any]


def designs_of(content: Content, units: UnitSystem) -> list[Design]:
    """The designs of a scene, a few of many."""
    several = axes_of(content.inputs)
    fixed = {n: v for n, v in content.inputs.items() if n not in several and n != "theta"}
    chosen = [
        {name: values[k] for (name, values), k in zip(several.items(), indices, strict=True)}
        for indices in thinned(list(product(*(range(len(values)) for values in several.values()))), MOST)
    ]
    return [
        Design(", ".join(f"{n} = {with_unit(units, n, v)}" for n, v in one.items()), {**fixed, **one})
        for one in chosen
    ]


def axes_of(inputs: Mapping[str, Value]) -> dict[str, tuple[float, ...]]:
    """The inputs with several values, but the crank angle."""
    return {n: v for n, v in inputs.items() if isinstance(v, tuple) and n != "theta"}


# ---- inputs --------------------------------------------------------------------------------------


def inputs(content: Content, units: UnitSystem) -> Section:
    """Every input with its unit, loads with their points, and quantities of the scene's own."""
    rows = [(n, *_value(n, v, units), INPUTS[n].meaning) for n, v in content.inputs.items()]
    if content.branch == -1:
        rows.append(("branch", "-1", "", "the slider is on the other side of the crank pin"))
    if content.accuracy != "standard":
        rows.append(("accuracy", content.accuracy, "", "of all values"))
    points = [block for n, value in content.inputs.items() for block in _points(n, value, units)]
    names = (*content.outputs, *(peak.quantity for peak in content.peaks))
    own = [(one.name, one.expression, one.unit, one.meaning) for one in used_by(names)]
    tables = [TextTable(("quantity", "expression", "unit", "meaning"), own)] if own else []
    return Section("Inputs", [TextTable(("input", "value", "unit", "meaning"), rows), *points, *tables])


def _value(name: str, value: Value, units: UnitSystem) -> tuple[str, str]:
    if isinstance(value, Load):
        conversion = units.of(name)
        own = value.unit is not None or conversion.si != 1
        return value.told(conversion).strip("<>"), "" if own else INPUTS[name].unit
    values = value if isinstance(value, tuple) else (value,)
    unit, ends = unit_of(units, name), [in_unit(units, name, values[k]) for k in (0, -1)]
    if len(values) <= LISTED:
        return ", ".join(in_unit(units, name, v) for v in values), unit
    return f"{' ... '.join(ends)} ({len(values)} values)", unit


def _points(name: str, load: Value, units: UnitSystem) -> Iterator[Block]:
    """The points of a load that varies with the motion, where they are few."""
    _, kind = kind_of(load)
    if kind is None or kind.numbers or not isinstance(load, Load):
        return
    tables, along = load.tables, kind.along
    knots = tables[0].knots
    if len(knots) > POINTS or any(len(table.values) != len(knots) for table in tables):
        return
    columns = [(along, knots), *((name, table.values) for table in tables)]
    cells = [[in_unit(units, n, value) for value in column] for n, column in columns]
    head = f"distance from Y_{load.dead_centre}" if isinstance(load, OverStroke) else along
    names = [name] if len(tables) == 1 else [f"{name}, {way}" for way in WAYS]
    heads = [f"{head} [{unit_of(units, along)}]", *(f"{n} [{unit_of(units, name)}]" for n in names)]
    yield TextTable(heads, [*zip(*cells, strict=True)])


# ---- mechanism -----------------------------------------------------------------------------------


def mechanism(content: Content, units: UnitSystem) -> Section | None:
    """The first design to scale, and the geometry of each; None without the lengths."""
    if any(name not in content.inputs for name in LENGTHS):
        return None
    designs = designs_of(content, units)
    lengths = [{name: one.inputs[name] for name in LENGTHS} for one in designs]
    image = drawn_to_scale(lengths[0], content.branch, units, designs[0].words)
    figures = [_geometry(one, content.branch, units) for one in lengths]
    return Section("Mechanism", [image, _side_by_side([one.words for one in designs], figures)])


def drawn_to_scale(lengths: Mapping[str, Any], branch: int, units: UnitSystem, words: str = "") -> Image:
    """A design to scale at an angle at which it can be assembled, if there is one."""
    with IMPORTS:
        from ...plot.mechanism import sketched

    intervals, angle = feasibility(**lengths)["theta_intervals"], ANGLE
    if evaluate("status", theta=ANGLE, branch=branch, **lengths) != 0 and intervals:
        angle = 0.5 * float(sum(intervals[0]))
    about = f"The mechanism to scale at theta = {with_unit(units, 'theta', angle)}"
    picture = sketched(angle, lengths, branch, units)
    return image_of(picture.figure, f"{about}, {words}" if words else about)


def turns_fully(lengths: Mapping[str, Any]) -> str:
    """A word for whether the crank turns fully, with the kind of the mechanism where it does not."""
    result = feasibility(**lengths)
    kind = "no, it cannot be assembled" if result["kind"] == "none" else f"no ({result['kind']})"
    return "yes" if result["can_turn"] else kind


def _geometry(lengths: dict[str, Any], branch: int, units: UnitSystem) -> dict[str, str]:
    rows = {
        "turns fully": turns_fully(lengths),
        "margin BC - AB - |ec|": with_unit(units, "margin", feasibility(**lengths)["margin"]),
    }
    turn = events(branch=branch, **lengths)
    for name, words in OF_TURN.items():
        value = turn[name] % TURN if name in CENTRES else turn[name]  # angles of a turn, as of peaks
        rows[words] = with_unit(units, name, value)
    return {**rows, "time ratio": cell(turn["time_ratio"])}


def _side_by_side(heads: Sequence[str], columns: Sequence[Mapping[str, str]]) -> TextTable:
    """Figures of designs, a column for each."""
    rows = [(name, *(column[name] for column in columns)) for name in columns[0]]
    return TextTable(("", *(head or "this design" for head in heads)), rows)


# ---- drive ---------------------------------------------------------------------------------------


def drive(content: Content, units: UnitSystem, fluctuation: float) -> Section | None:
    """The drive of each design, the first one's torque drawn; None without masses and loads, or a law."""
    needed = (*LENGTHS, "omega0")
    if not any(n in content.inputs for n in LOADS) or any(n not in content.inputs for n in needed):
        return None
    drives: dict[str, Any] = {}
    blocks: list[Block] = []
    options: dict[str, Any] = {"branch": content.branch, "fluctuation": fluctuation}
    for one in designs_of(content, units):
        words = one.words or "this design"
        result = _attempted(words, blocks, units, DriveStatus, partial(drive_of, **options, **one.inputs))
        if result is not None and "T_in" in result.course:
            drives[words] = in_units(result, units)
    if not drives:
        return Section("Drive", blocks) if blocks else None
    words, first = next(iter(drives.items()))
    cycle = "a turn" if first.turns == 1 else f"{first.turns} turns"
    picture = image_of(first.plot().figure, f"Torque of the drive over {cycle}, {words}")
    table = _side_by_side([*drives], [dict(result.rows()) for result in drives.values()])
    return Section("Drive", [table, picture, *blocks])


def _attempted(
    words: str, remarks: list[Block], units: UnitSystem, codes: Any, call: Callable[[], Any]
) -> Any:
    """The answer of a call; None where it refuses. A remark says why, or what its status is."""
    try:
        with errors_in(units):
            result = call()
    except (ValueError, TypeError) as error:
        remarks.append(Text(f"{words}: {error}"))
        return None
    if result["status"]:
        remarks.append(Text(f"{words}: status {result['status']}, {codes(result['status']).words}"))
    return result


# ---- tolerances ----------------------------------------------------------------------------------


def read_tolerances(content: Content, units: UnitSystem, given: Mapping[str, Any]) -> dict[str, float]:
    """Tolerances of inputs in SI units, plain numbers in these units; ValueError for a bad one."""
    halves = {}
    for name, value in given.items():
        if name == "theta" or not isinstance(content.inputs.get(name), (float, tuple)):
            known = ", ".join(n for n, v in content.inputs.items() if n != "theta" and not callable(v))
            raise ValueError(f"tolerances: {shown(name)} is no input here that is a number: {known}")
        requested = "a number or a text with a unit, half of the range"
        text = with_unit_of(f"1 {units.of(name).unit}", value)
        half = read(INPUTS[name], text, "tolerances", requested)
        halves[name] = float(half if isinstance(text, str) else units.of(name).to_si(half))
        if not 0.0 <= halves[name] < inf:
            raise ValueError(f"tolerances: {name} = {shown(value)}: it must be finite and at least 0")
    return halves


def spread(content: Content, units: UnitSystem, tolerances: Mapping[str, float]) -> Section | None:
    """The scatter of the first design's outputs under tolerances [SI]; None without any."""
    if not tolerances:
        return None
    design = designs_of(content, units)[0]
    ranges: dict[str, Any] = {n: PlusMinus(design.inputs[n], half) for n, half in tolerances.items()}
    listed = ", ".join(f"{n} +- {with_unit(units, n, half)}" for n, half in tolerances.items())
    about = f" for {design.words}" if design.words else ""
    remarks: list[Block] = []
    rows: list[tuple[str, ...]] = []
    for name in content.outputs:
        if name in ALWAYS:
            continue
        measure: Any = name if of_design(name) else ("absmax", name)
        words = name if of_design(name) else f"largest magnitude of {name}"
        options = {"branch": content.branch, "samples": SAMPLES, **design.inputs, **ranges}
        result = _attempted(words, remarks, units, ToleranceStatus, partial(tolerance, measure, **options))
        if result is not None:
            rows.append((words, *_scatter(name, result, units)))
    first = Text(f"With {listed}{about}, each a normal distribution of 3 standard deviations.")
    return Section("Tolerances", [first, *([TextTable(SPREAD, rows)] if rows else []), *remarks])


def _scatter(name: str, result: Mapping[str, Any], units: UnitSystem) -> tuple[str, ...]:
    """Nominal value, unit, standard deviation, worst case, and what drives it."""
    worst, shares = result["worst_case"], result["contributions"]
    ends = [in_unit(units, name, worst[end]) for end in ("lower", "upper")] if worst else [NONE, NONE]
    estimate = "" if not worst or worst["guaranteed"] else " (corner estimate, not guaranteed)"
    driven = [f"{n} {100.0 * share:.0f} %" for n, share in shares.items() if share >= 0.005]
    value, std = (in_unit(units, name, x) for x in (result["value"], result["monte_carlo"]["std"]))
    return value, unit_of(units, name), std, f"{' to '.join(ends)}{estimate}", ", ".join(driven)
