"""The section on the drive: torque, power, starting torque and flywheel of each design."""

from typing import Any

from ...design.drive.drive import drive as drive_of
from ...evaluation.in_units import in_units
from ...mechanism.names import LOADS
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import DriveStatus
from ..content import Content
from .blocks import Block, Section, Text, TextTable, image_of
from .designs import designs_of


def drive(content: Content, units: UnitSystem, fluctuation: float) -> Section | None:
    """The drive of each design, the first one's torque drawn; None without masses and loads, or a law."""
    needed = ("ec", "AB", "BC", "omega0")
    if not any(n in content.inputs for n in LOADS) or any(n not in content.inputs for n in needed):
        return None
    found: list[tuple[str, Any]] = []
    blocks: list[Block] = []
    for one in designs_of(content, units):
        words = one.words or "this design"
        try:
            result = drive_of(fluctuation=fluctuation, branch=content.branch, **one.inputs)
        except (ValueError, TypeError) as error:
            blocks.append(Text(f"{words}: {error}"))
            continue
        result = in_units(result, units)
        if result["status"]:
            blocks.append(Text(f"{words}: status {result['status']}, {DriveStatus(result['status']).words}"))
        if "T_in" in result.course:
            found.append((words, result))
    if not found:
        return Section("Drive", blocks) if blocks else None
    columns = [dict(result.rows()) for _, result in found]
    rows = [(name, *(column[name] for column in columns)) for name in columns[0]]
    words, first = found[0]
    cycle = "a turn" if first.turns == 1 else f"{first.turns} turns"
    picture = image_of(first.plot().figure, f"Torque of the drive over {cycle}, {words}")
    return Section("Drive", [TextTable(("", *(words for words, _ in found)), rows), picture, *blocks])
