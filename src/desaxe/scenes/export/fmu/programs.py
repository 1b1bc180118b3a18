"""The Programs of an FMU: acceleration, outputs, partial derivatives, limit angles, columns of loads."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ....compiler.passes.differentiate import Chain
from ....compiler.passes.guard import guard_inputs
from ....compiler.passes.pipeline import optimise
from ....compiler.passes.slicing import keep_outputs
from ....compiler.program import Argument, Line, Program
from ....loads.lines import tables_of
from ....loads.load import Load
from ....loads.resolve import split
from ....mechanism.catalogue import has, law_name, quantities
from ....mechanism.closed.functions import closed_form
from ....mechanism.closed.limits import ANGLES, LIMITS
from ....mechanism.inputs import LEAST
from ....mechanism.names import LENGTHS, sensitivity
from ....runtime.request import request
from ....runtime.specialise import specialise
from ...content import Content
from ..motion import motion
from .variables import FORCES, Variables

TORQUE = "T_in"  # the row whose derivatives say how the acceleration depends on everything
THROUGH = (
    "theta",
    "omega",
    *LENGTHS,
)  # what columns of the motion depend on
HELD = ("shift", "first", "last", "side")  # of a table: whole periods, pieces, those of the way back


class Programs(NamedTuple):
    """Programs, and for each partial derivative its row (output) and what it is by."""

    motion: Program | None
    outputs: Program
    status: int
    slopes: Program
    entries: tuple[tuple[str, str], ...]
    limits: Program
    columns: Program  # dY/dtheta; then each of `used`, and its derivatives by THROUGH
    used: tuple[str, ...]
    tables: Mapping[str, Mapping[str, Load]]  # force -> the tables that are added to it


def programs(content: Content, table: Variables) -> Programs:
    """The Programs of a scene with these variables."""
    parameters = [name for name in table.parameters if name not in ("theta0", "omega_start")]
    moves, branch = bool(table.states), content.branch
    knowns = ("theta", "omega", *(["alpha"] if moves else []), *FORCES, *parameters)
    names = tuple(dict.fromkeys((*table.outputs, "status")))
    outputs = _program(names, knowns, branch)
    rows = dict.fromkeys((*(n for n in table.outputs if n != "status"), *([TORQUE] if moves else [])))
    slopes, entries = _slopes(tuple(rows), knowns, branch)
    loads = {force: tables_of(force, load) for force, load in split(content.inputs)[1].items()}
    used = dict.fromkeys(column for parts in loads.values() for one in parts.values() for column in one.needs)
    return Programs(
        motion(dict.fromkeys((*parameters, *FORCES), (0.0, 1.0)), branch) if moves else None,
        guard_inputs(outputs, [n for n in ("theta", "omega", *FORCES) if n in outputs.inputs], LEAST, {}),
        names.index("status"),
        slopes,
        entries,
        closed_form(LIMITS, (*ANGLES, "status")).program,
        _columns(tuple(used), branch),
        tuple(used),
        loads,
    )


def _program(names: Sequence[str], knowns: Sequence[str], branch: int) -> Program:
    """The Program of names of a given state, every input open; with a given speed alpha is 0."""
    asked = request(names, {"theta": 1.0, "omega": 1.0, **dict.fromkeys(knowns, 1.0)}, branch, "standard")
    return specialise(asked.names, asked.form, asked.fixed)


def _slopes(
    rows: Sequence[str], knowns: Sequence[str], branch: int
) -> tuple[Program, tuple[tuple[str, str], ...]]:
    """A Program of all partial derivatives that are not 0: the derived ones, else line by line."""
    derived: dict[tuple[str, str], str] = {}
    others: list[tuple[str, str]] = []
    for row in rows:
        used = _program((row,), knowns, branch).inputs
        for by in (by for by in knowns if by in used):
            name = sensitivity(row, by)
            if law_name(name) in quantities() and "omega0" not in name:
                derived[row, by] = name
            else:
                others.append((row, by))
    names = tuple(dict.fromkeys((*derived.values(), *(row for row, _ in others))))
    if not names:
        return Program((), (), (), {}), ()
    program = _program(names, knowns, branch)
    outputs = dict(zip(names, program.outputs, strict=True))
    results: dict[tuple[str, str], Argument] = {entry: outputs[name] for entry, name in derived.items()}
    chained = keep_outputs(program, [outputs[row] for row, _ in others]).lines
    lines = list(program.lines)
    for by in dict.fromkeys(by for _, by in others):
        chain = Chain(by)
        for line in chained:
            chain.through(line)
        lines += chain.lines
        results |= {(row, p): chain.slope(outputs[row]) for row, p in others if p == by}
    last = [Line(f"_slope{k}", "copy", (result,)) for k, result in enumerate(results.values())]
    whole = program._replace(lines=(*lines, *last), outputs=tuple(line.name for line in last))
    return optimise(whole), tuple(results)


def _columns(used: Sequence[str], branch: int) -> Program:
    """The columns of the motion that tables are over, each with its derivatives; ahead of them dY/dtheta."""
    rows = ["Y_wrt_theta", *(name for c in used for name in (c, *(sensitivity(c, p) for p in THROUGH)))]
    names = tuple(dict.fromkeys(name for name in rows if has(name, True)))
    base = _program(names, (), branch)
    known: dict[str, Argument] = dict(zip(names, base.outputs, strict=True))
    known |= {"theta": "theta", sensitivity("theta", "theta"): 1.0}
    lines = [Line(f"_column{k}", "copy", (known.get(name, 0.0),)) for k, name in enumerate(rows)]
    inputs = tuple(dict.fromkeys((*base.inputs, *(["theta"] if "theta" in used else []))))
    outputs = tuple(line.name for line in lines)
    return optimise(Program(inputs, (*base.lines, *lines), outputs, base.notes))
