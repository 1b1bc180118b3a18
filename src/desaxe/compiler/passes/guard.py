"""Guard inputs: an invalid element of an array gives NaN and status 4, in its own element only.

A scalar is checked once, before anything runs; an array element is checked here, inside the loop.
Most bad values turn into NaN by themselves (the sine of an infinity, the square root of a negative
number), but a rod of negative or infinite length would give a finite, wrong answer.
"""

from collections.abc import Iterable, Mapping
from math import inf, nan

from ..program import Line, Note, Program
from .slicing import drop_unused

BAD_INPUT = 4
GUARDED = "_good"  # ends the name of an input's value, NaN where it is bad


def guard_inputs(
    program: Program, inputs: Iterable[str], least: Mapping[str, float], largest: Mapping[str, float]
) -> Program:
    """Guard these inputs: an invalid element reads as NaN, and `status` is 4.

    Effect: an input that is infinite or NaN, below its `least` value or of a magnitude above its
    `largest` is replaced by NaN where it is used. An output that is a status becomes 4.
    """
    checked = [name for name in inputs if name in program.inputs]
    lines: list[Line] = []
    safe: dict[str, str] = {}
    for name in checked:
        lines += _check(name, least.get(name), largest.get(name))
        safe[name] = f"{name}_good"
    for line in program.lines:
        lines.append(
            line._replace(args=tuple(safe.get(a, a) if isinstance(a, str) else a for a in line.args))
        )
    types = {line.name: line.type for line in program.lines}
    for name in program.outputs:
        if types.get(name) == "i64" and checked:
            lines = _with_status(lines, checked, name)
    notes = {**program.notes, **{good: Note("", f"{name}, NaN where bad") for name, good in safe.items()}}
    outputs = tuple(safe.get(name, name) for name in program.outputs)  # an output may be an input
    return drop_unused(program._replace(lines=tuple(lines), notes=notes, outputs=outputs))


def _check(name: str, least: float | None, largest: float | None) -> list[Line]:
    """The lines `<name>_is_good` and `<name>_good`, which is NaN for an invalid value."""
    op, bound = ("lt", inf) if largest is None else ("le", largest)
    size, lines = name, []
    if least is None or least < 0.0:  # else the least value is a bound below already
        size, lines = f"{name}_size", [Line(f"{name}_size", "abs", (name,))]
    lines.append(Line(f"{name}_is_finite", op, (size, bound), "bool"))
    good = f"{name}_is_finite"
    if least is not None:
        lines.append(Line(f"{name}_is_enough", "le", (least, name), "bool"))
        lines.append(Line(f"{name}_is_good", "and", (good, f"{name}_is_enough"), "bool"))
        good = f"{name}_is_good"
    return [*lines, Line(f"{name}_good", "select", (good, name, nan))]


def _with_status(lines: list[Line], checked: list[str], status: str) -> list[Line]:
    """The lines with a status of 4 where a checked input is invalid."""
    lines = [line._replace(name=f"{status}_if_good") if line.name == status else line for line in lines]
    good = ""
    for name in checked:
        own = Line(f"{name}_counts", "eq", (f"{name}_good", f"{name}_good"), "bool")
        lines.append(own)
        if good:
            lines.append(Line(f"good_to_{name}", "and", (good, own.name), "bool"))
        good = f"good_to_{name}" if good else own.name
    return [*lines, Line(status, "select", (good, f"{status}_if_good", BAD_INPUT), "i64")]
