"""Loads that vary with the motion in an FMU: their tables as C arrays, which no parameter changes."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ....loads.load import Load, OverY, TableOverTheta
from ....loads.resolve import plan_of
from ....loads.stroke import OverStroke
from ....loads.table import Row
from ....mechanism.names import LENGTHS, sensitivity
from ....support.template import file_text
from ...schema import SceneError


def tables(given: Mapping[str, Any]) -> dict[str, Load]:
    """The loads that vary with the motion, by the forces to which they are added."""
    return {name: load for name, load in given.items() if callable(load)}


def check_loads(where: str, outputs: Sequence[str], loads: Mapping[str, Load]) -> None:
    """SceneError for an output that is a derivative through a load."""
    if not loads:
        return
    through = plan_of(outputs, loads, True, False).terms
    total = next((name for name, terms in through.items() if terms), None)
    if total is not None:
        raise SceneError(
            f"{where}: outputs: {total!r} is a derivative through a load that varies with the motion, which "
            "an FMU does not give as an output: ask for its directional derivative"
        )


def position_names(loads: Mapping[str, Load]) -> tuple[str, ...]:
    """Names that loads over Y or the stroke are looked up by, and their derivatives by theta and lengths."""
    centres = dict.fromkeys(load.centre for load in loads.values() if isinstance(load, OverStroke))
    by_lengths = {name: [sensitivity(name, length) for length in LENGTHS] for name in ("Y", *centres)}
    names = [one for name, slopes in by_lengths.items() for one in (name, *slopes)]
    return ("Y", sensitivity("Y", "theta"), *names[1:])


def loads_text(loads: Mapping[str, Load], place: Mapping[str, int]) -> str:
    """The C of the loads, or of none."""
    if not loads:
        return file_text(__package__, "no_loads.c")
    rows, angles, known = [], 1, position_names(loads)
    lines: list[str] = []
    for force, load in loads.items():
        period, places, outward, inward, kinks = _arrays(load)
        over_Y = int(isinstance(load, OverY))
        centre = known.index(load.centre) if isinstance(load, OverStroke) else 0
        angles = max(angles, (4 if centre else 2) * len(places) + 4 if over_Y else len(places))
        lines.append(array_text(f"double {force}_PLACES[]", map(repr, places)))
        lines.append(array_text(f"double {force}_ROWS[][4]", map(_braces, outward)))
        lines += [array_text(f"double {force}_INWARD[][4]", map(_braces, inward))] if inward else []
        lines.append(array_text(f"int {force}_KINKS[]", map(str, [*kinks, 0])))
        own = f"{force}_INWARD" if inward else "NULL"
        rows.append(
            f"{{{place[force]}, {over_Y}, {centre}, {len(places)}, {len(kinks)}, {period!r}, {force}_PLACES, "
            f"{force}_ROWS, {own}, {force}_KINKS}}"
        )
    lines.append(array_text("Load LOADS[N_LOADS]", rows))
    turning = sum(isinstance(load, OverY) and load.inward is not None for load in loads.values())
    sizes = {"N_LOADS": len(loads), "TURNING_LOADS": turning, "N_ANGLES": angles, "N_POSITION": len(known)}
    sizes["OUTER"] = known.index("Y_outer") if "Y_outer" in known else -1
    head = "\n".join(f"#define {name} {size}" for name, size in sizes.items())
    return f"{head}\n\n{file_text(__package__, 'loads.c').replace('/*TABLES*/', chr(10).join(lines))}"


def _arrays(load: Load) -> tuple[float, Sequence[float], Sequence[Row], Sequence[Row], list[int]]:
    """Period, places, rows outward and inward, and the kinks; a period begins at a kink, if there is one."""
    if isinstance(load, OverY):
        places = load.outward.knots
        kinks = [places.index(place) for place in load.positions(smooth=False)]
        return 0.0, places, load.outward.rows, load.inward.rows if load.inward else (), kinks
    assert isinstance(load, TableOverTheta)
    table, period = load.table, load.period
    first = table.knots.index(table.kinks[0]) if table.kinks else 0
    places = (*table.knots[first:], *(angle + period for angle in table.knots[:first]))
    rows = (*table.rows[first + 1 :], *table.rows[1 : first + 1])
    kinks = sorted((table.knots.index(angle) - first) % len(places) for angle in table.kinks)
    return period, places, (rows[-1], *rows), (), kinks


def _braces(row: Row) -> str:
    return "{" + ", ".join(map(repr, row)) + "}"


def array_text(head: str, items: Iterable[str]) -> str:
    """A constant array of C."""
    return f"static const {head} = {{\n" + "".join(f"  {item},\n" for item in items) + "};"
