"""The section on tolerances: how much each output scatters, and what drives it."""

from collections.abc import Mapping
from math import inf, isnan
from typing import Any

from ...design.tolerance.tolerance import tolerance
from ...mechanism.catalogue import of_design
from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.ranges import PlusMinus
from ...mechanism.read import read
from ...mechanism.status import ToleranceStatus
from ...support.shown import shown
from ...units.text import with_unit_of
from ..content import Content
from .blocks import NONE, Block, Section, Text, TextTable
from .curves import ALWAYS
from .designs import designs_of, in_unit, unit_of, with_unit

SAMPLES = 1000  # of a Monte Carlo: its standard deviation is good to 2 %
HEADS = ("quantity", "nominal", "unit", "standard deviation", "worst case", "driven by")


def read_tolerances(content: Content, units: UnitSystem, given: Mapping[str, Any]) -> dict[str, float]:
    """Tolerances of inputs in SI units, plain numbers in these units; ValueError for a bad one."""
    found = {}
    for name, value in given.items():
        if name == "theta" or not isinstance(content.inputs.get(name), (float, tuple)):
            known = ", ".join(n for n, v in content.inputs.items() if n != "theta" and not callable(v))
            raise ValueError(f"tolerances: {shown(name)} is no input here that is a number: {known}")
        wanted = "a number or a text with a unit, half of the range"
        unit = with_unit_of(f"1 {units.of(name).unit}", value)
        half = read(INPUTS[name], unit, "tolerances", wanted)
        found[name] = float(half if isinstance(unit, str) else units.of(name).to_si(half))
        if not 0.0 <= found[name] < inf:
            raise ValueError(f"tolerances: {name} = {shown(value)}: it must be finite and at least 0")
    return found


def spread(content: Content, units: UnitSystem, tolerances: Mapping[str, float]) -> Section | None:
    """The scatter of the first design's outputs under tolerances [SI]; None without any."""
    if not tolerances:
        return None
    design = designs_of(content, units)[0]
    inputs: dict[str, Any] = dict(design.inputs)
    inputs |= {n: PlusMinus(inputs[n], half) for n, half in tolerances.items()}
    given = ", ".join(f"{n} +- {with_unit(units, n, half)}" for n, half in tolerances.items())
    about = f" for {design.words}" if design.words else ""
    blocks: list[Block] = [Text(f"With {given}{about}, each a normal distribution of 3 standard deviations.")]
    rows: list[tuple[str, ...]] = []
    for name in content.outputs:
        if name in ALWAYS:
            continue
        measure: Any = name if of_design(name) else ("absmax", name)
        words = name if of_design(name) else f"largest magnitude of {name}"
        try:
            found = tolerance(measure, branch=content.branch, samples=SAMPLES, **inputs)
        except (ValueError, TypeError) as error:
            blocks.append(Text(f"{words}: {error}"))
            continue
        rows.append(_row(words, name, found, units))
        if found["status"]:
            blocks.append(
                Text(f"{words}: status {found['status']}, {ToleranceStatus(found['status']).words}")
            )
    return Section("Tolerances", [blocks[0], *([TextTable(HEADS, rows)] if rows else []), *blocks[1:]])


def _row(words: str, name: str, found: Mapping[str, Any], units: UnitSystem) -> tuple[str, ...]:
    worst, shares = found["worst_case"], found["contributions"]
    ends = [in_unit(units, name, worst[end]) for end in ("lower", "upper")] if worst else [NONE, NONE]
    estimate = "" if not worst or worst["guaranteed"] else " (corner estimate, not guaranteed)"
    driven = [
        f"{n} {100.0 * share:.0f} %" for n, share in shares.items() if not isnan(share) and share >= 0.005
    ]
    return (
        words,
        in_unit(units, name, found["value"]),
        unit_of(units, name),
        in_unit(units, name, found["monte_carlo"]["std"]),
        f"{ends[0]} to {ends[1]}{estimate}",
        ", ".join(driven),
    )
