"""The Programs of an FMU: acceleration, outputs, their partial derivatives, limit angles, loads."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ....compiler.passes.differentiate import Chain
from ....compiler.passes.guard import guard_inputs
from ....compiler.passes.pipeline import optimise
from ....compiler.passes.slicing import keep_outputs
from ....compiler.program import Argument, Line, Program, TableName
from ....loads.load import Load, TableOverTheta
from ....loads.stroke import OverStroke
from ....mechanism.catalogue import law_name, quantities
from ....mechanism.closed.functions import closed_form
from ....mechanism.closed.limits import ANGLES, LIMITS
from ....mechanism.inputs import LEAST
from ....mechanism.names import LENGTHS, sensitivity
from ....runtime.request import request
from ....runtime.specialise import specialise
from ...content import Content
from ..motion import motion
from .variables import FORCES, Variables, tables

TORQUE = "T_in"  # the row whose derivatives say how the acceleration depends on everything
THROUGH = ("theta", *LENGTHS)  # what the forces of loads depend on
# What the loads' Program has of each load, in this order; what it is held by is an input.
LOOKED_UP = ("VALUE", "SLOPE", *(f"SLOPE_{k}" for k in range(1, len(THROUGH))), "AT", "PIECE", "RISES")
HELD = ("shift", "first", "last", "side")  # whole periods, pieces, those of the way back


class Programs(NamedTuple):
    """Programs, and for each partial derivative its row (output) and what it is by."""

    motion: Program | None
    outputs: Program
    status: int
    slopes: Program
    entries: tuple[tuple[str, str], ...]
    limits: Program
    looked_up: Program
    loads: Mapping[str, Load]  # those that vary with the motion


def programs(content: Content, table: Variables) -> Programs:
    """The Programs of a scene with these variables."""
    parameters = [name for name in table.parameters if name not in ("theta0", "omega_start")]
    moves, branch = bool(table.states), content.branch
    knowns = ("theta", "omega", *(["alpha"] if moves else []), *FORCES, *parameters)
    names = tuple(dict.fromkeys((*table.outputs, "status")))
    outputs = _program(names, knowns, branch)
    rows = dict.fromkeys((*(n for n in table.outputs if n != "status"), *([TORQUE] if moves else [])))
    slopes, entries = _slopes(tuple(rows), knowns, branch)
    loads = tables(content.inputs)
    return Programs(
        motion(dict.fromkeys((*parameters, *FORCES), (0.0, 1.0)), branch) if moves else None,
        guard_inputs(outputs, [n for n in ("theta", "omega", *FORCES) if n in outputs.inputs], LEAST, {}),
        names.index("status"),
        slopes,
        entries,
        closed_form(LIMITS, (*ANGLES, "status")).program,
        _looked_up(loads, branch),
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


def _looked_up(loads: Mapping[str, Load], branch: int) -> Program:
    """The Program that has LOOKED_UP of each load: force, slopes, where it is looked up, piece, dY/dtheta.

    Pieces before `first` and after `last` are those, whose cubics go on.
    """
    centres = dict.fromkeys(load.centre for load in loads.values() if isinstance(load, OverStroke))
    names = [
        *("Y", "Y_wrt_theta", *(sensitivity("Y", p) for p in LENGTHS)),
        *(name for centre in centres for name in (centre, *(sensitivity(centre, p) for p in LENGTHS))),
    ]
    base = _program(names, (), branch)
    writer = _LoadWriter(dict(zip(names, base.outputs, strict=True)))
    outputs = [output for force, load in loads.items() for output in writer.load(force, load)]
    inputs = (*base.inputs, *(f"{force}_{held}" for force in loads for held in HELD))
    return optimise(Program(inputs, (*base.lines, *writer.lines), tuple(outputs), base.notes))


class _LoadWriter:
    """Appends the lines of loads behind those of the slider's position and of dead centres."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self.names = names
        self.lines: list[Line] = []

    def new(self, op: str, *args: Argument, type: str = "f64") -> str:
        """A line."""
        self.lines.append(Line(f"_load{len(self.lines)}", op, args, type))
        return self.lines[-1].name

    def load(self, force: str, load: Load) -> list[str]:
        """The lines of a load; its outputs."""
        shift, first, last, side = (f"{force}_{held}" for held in HELD)
        at, along = self._along(load, shift)
        table = TableName(force)
        piece = self.new("lookup_piece", at, table, 1.0)
        low = self.new("select", self.new("lt", piece, first, type="bool"), first, piece)
        inside = self.new("select", self.new("lt", last, low, type="bool"), last, low)
        looked = (at, table, self.new("add", inside, side))
        slope = self.new("lookup_slope", *looked)
        slopes = [self.new("mul", slope, along.get(p, 0.0)) for p in THROUGH]
        rises = self.new("copy", self.names["Y_wrt_theta"])
        return [self.new("lookup", *looked), *slopes, self.new("copy", at), piece, rises]

    def _along(self, load: Load, shift: str) -> tuple[str, dict[str, Argument]]:
        """The argument of a table, and its derivatives."""
        if isinstance(load, TableOverTheta):
            return self.new("sub", "theta", shift), {"theta": 1.0}
        moved = {p: self.names[sensitivity("Y", p)] for p in THROUGH}
        if not isinstance(load, OverStroke):
            return self.names["Y"], dict(moved)
        away = self.new("sub", self.names[load.centre], self.names["Y"])
        sign = self.new("copysign", 1.0, away)
        outer = {p: self.names[sensitivity(load.centre, p)] for p in LENGTHS}
        change = {p: self.new("sub", outer.get(p, 0.0), moved[p]) for p in THROUGH}
        return self.new("abs", away), {p: self.new("mul", sign, value) for p, value in change.items()}
