"""Loads that vary with the motion as the data of a scene: points in it, or a CSV file beside it."""

from pathlib import Path
from typing import Any, NamedTuple

from ..loads.load import Load, OverY, TableOverTheta
from ..loads.motors import ROWS, Kloss, OverOmega
from ..loads.stroke import OverStroke

INLINE = 24  # points that stand in the scene itself


class LoadTable(NamedTuple):
    """The data of a load in a scene, and the file of its points, if they are many."""

    data: dict[str, Any]
    file: Path | None = None
    text: str = ""


def load_table(name: str, load: Load, scene: Path, unit: str | None = None) -> LoadTable:
    """The table of a load for a scene at this path; TypeError for a load that is a function.

    Points are in SI units with all their digits, so that the load that is read equals this one.
    unit   of its plain values, where the scene names another one
    """
    if isinstance(load, TableOverTheta):
        columns = [load.table.knots, load.table.values]
        more: dict[str, Any] = {"kind": load.kind, "period": load.period}
        over, along, heads = "over_theta", {"theta": "rad"}, ["theta [rad]", name]
    elif isinstance(load, OverY):
        ways = [load.outward] if load.inward is None else [load.outward, load.inward]
        columns = [load.outward.knots, *(table.values for table in ways)]
        more = {"kind": load.kind}
        over, along, first = "over_Y", {"Y": "m"}, "Y [m]"
        if isinstance(load, OverStroke):
            over, along, first = "over_stroke", {"distance": "m"}, "distance [m]"
            more["dead_centre"] = load.dead_centre
        heads = [first, *(f"{name} {way}" for way in ("outward", "inward")[: len(ways)])]
    else:
        raise TypeError(f"{name}: a function is not data, and cannot stand in a scene file; give a table")
    unit = load.unit or unit
    more |= along | ({"value": unit} if unit is not None else {})
    rows = list(zip(*columns, strict=True))
    if len(rows) <= INLINE:
        return LoadTable({over: [list(row) for row in rows], **more})
    file = scene.with_name(f"{scene.stem}_{name}.csv")
    lines = [",".join(heads), *(",".join(map(repr, row)) for row in rows)]
    return LoadTable({over: file.name, **more}, file, "\n".join(lines) + "\n")


def motor_table(motor: Any) -> Any:
    """The data of a motor in a scene, in SI units with all its digits; anything else as it is."""
    if isinstance(motor, OverOmega):
        rows = zip(motor.table.knots, motor.table.values, strict=True)
        return {"over_omega": [[f"{x!r} rad/s", f"{y!r} N m"] for x, y in rows], "kind": motor.kind}
    if isinstance(motor, Kloss):
        units = {row.name: row.unit for row in ROWS}
        told = {name: f"{value!r} {units[name]}" for name, value in motor.numbers.items()}
        return {"kloss": {name: text.removesuffix(" 1") for name, text in told.items()}}
    return motor
