"""The section on the steady state of each design on its motor, the first one's course drawn."""

from typing import Any

from ...design.steady.steady import steady
from ...evaluation.in_units import in_units
from ...mechanism.quantity_units import UnitSystem
from ...plot.steady import steady as picture_of
from ..content import Content
from ..parts.motor import MotorResult
from ..report import steady_remarks, steady_rows
from .parts import Block, Lines, Section, Text, TextTable, image_of


def motor(content: Content, found: MotorResult | None, units: UnitSystem) -> Section | None:
    """The steady states in a table; None where the scene asks for none."""
    if found is None:
        return None
    names, heads, *rows = steady_rows(found, content, units)
    titles = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, heads, strict=True)]
    blocks: list[Block] = [Text(f"On {found.asked.torque!r}."), TextTable(titles, rows)]
    told = steady_remarks(found)
    blocks += [Lines("\n".join(told))] if told else []
    first: dict[str, Any] = {n: v[0] for n, v in found.asked.axes.items()}
    one = steady(torque=found.asked.torque, branch=content.branch, **found.asked.fixed, **first)
    if not one["status"]:
        words = "Speed and torque of the first design over a period, and its loop on the motor's curve"
        blocks.append(image_of(picture_of(in_units(one, units)).figure, words))
    return Section("Steady state", blocks)
