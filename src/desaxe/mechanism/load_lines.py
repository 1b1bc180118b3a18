"""Loads over the motion as lines of a Program: what they are looked up at, and the totals that they make.

A Program has a force as an input, and partial derivatives with respect to it. Here the force becomes lines,
which look up a table that is known at run time, and what depends on it becomes total: with the terms of each
derivative,

    dq/dp = q_wrt_p + q_wrt_F dF/dp,    dF/dtheta = F'(theta),    dF/dp = F'(Y) Y_wrt_p

or F'(d) sign(Y_dc - Y) (dY_dc/dp - Y_wrt_p) over the distance d from a dead centre.
"""

from collections.abc import Mapping, Sequence
from math import nan
from sys import float_info
from typing import NamedTuple

from ..compiler.passes.differentiate import Chain
from ..compiler.passes.slicing import drop_unused
from ..compiler.program import Argument, Line, Note, Program, TableName, names_in, validate
from .inputs import INPUTS
from .names import LENGTHS, STATUS


class LoadLines(NamedTuple):
    """A load: the force, what its table is over, and the period of one over theta.

    over    "theta", "Y", "V_C", a dead centre's position "Y_outer" or "Y_inner"; "" of a force that stays an
            input, as its derivative is, `<force>_by_theta`
    period  of a table over theta: a number, 0 without one, or the name of an input
    first   the first knot of such a table
    ways    whether another table holds for the way inward
    held    whether the number of the piece that holds is an input, `<force>_piece`
    parts   of a sum: the lines of its tables
    """

    force: str
    over: str
    period: float | str = 0.0
    first: float | str = 0.0
    ways: bool = True
    held: bool = False
    parts: tuple["LoadLines", ...] = ()

    @property
    def tables(self) -> tuple[str, ...]:
        """The names of its tables."""
        return tuple(part.force for part in self.parts or (self,) if part.over)


class Total(NamedTuple):
    """A name, the forces that it depends on, and terms: (the name of a slope, force, parameter)."""

    name: str
    forces: tuple[str, ...] = ()
    terms: tuple[tuple[str, str, str], ...] = ()


class TurningSense(NamedTuple):
    """The inputs, or numbers, that say which way the crank turns: a speed, and what starts one at rest."""

    speed: Argument
    start: Argument = 0.0


def with_totals(
    program: Program,
    names: Mapping[str, str],
    loads: Sequence[LoadLines],
    totals: Sequence[Total],
    way: TurningSense,
    others: Sequence[str] = (),
) -> Program:
    """The program of these totals, whose loads are looked up.

    names   quantities -> the outputs of the program that have them: of the totals, of the slopes in their
            terms, and of the motion that loads over the slider's place need
    others  lines of the program that are outputs too
    """
    writer = _Writer(program, names, way)
    for load in loads:
        writer.load(load, {p for total in totals for _, force, p in total.terms if force == load.force})
    writer.lines += writer.late
    outputs = *(writer.total(total) for total in totals), *others
    made = {line.name for line in writer.lines}
    used = (name for line in writer.lines for name in names_in(line.args) if name not in made)
    inputs = dict.fromkeys((*(name for name in program.inputs if name not in made), *used))
    whole = Program(tuple(inputs), tuple(writer.lines), outputs, writer.notes)
    return validate(drop_unused(whole))


class Under(NamedTuple):
    """The loads of a request: their lines, the totals that are its outputs, and what these are made of.

    names   quantities, and in the same order what the Program of a variant calls them
    """

    names: tuple[tuple[str, str], ...]
    loads: tuple[LoadLines, ...]
    totals: tuple[Total, ...]
    way: TurningSense

    def added_to(self, program: Program, fixed: Mapping[str, float], others: Sequence[str] = ()) -> Program:
        """The program of the totals and others, from that of `names`; some inputs are fixed."""
        names = dict(zip((shown for shown, _ in self.names), program.outputs, strict=False))
        way = TurningSense(*(fixed.get(one, one) if isinstance(one, str) else one for one in self.way))
        return with_totals(program, names, self.loads, self.totals, way, others)


class _Writer:
    """Appends lines: those that no load changes, the loads, the others, the totals."""

    def __init__(self, program: Program, names: Mapping[str, str], way: TurningSense) -> None:
        self.names, self.way = names, way
        self.notes = dict(program.notes)
        self.marks: dict[str, list[tuple[str, str, Argument]]] = {}  # of a force: table, is there, moves
        self.slopes: dict[tuple[str, str], Argument] = {}
        self.reduced: dict[str, Argument] = {}  # lines of reduced angles, with their slopes
        changed = set(INPUTS) & {"F_X", "F_Y"}
        self.lines: list[Line] = []
        self.late: list[Line] = []
        for line in program.lines:
            depends = not changed.isdisjoint(names_in(line.args))
            changed |= {line.name} if depends else set()
            (self.late if depends else self.lines).append(line)

    def new(self, name: str, op: str, *args: Argument, type: str = "f64") -> str:
        """A line."""
        self.lines.append(Line(name, op, args, type))
        return name

    def load(self, load: LoadLines, parameters: set[str]) -> None:
        """The lines of a force and of its derivatives with respect to these parameters."""
        force, start = load.force, len(self.lines)
        if not load.over:
            self.slopes.update({(force, p): f"{force}_by_{p}" for p in parameters})
            return
        value, *others = [self._look_up(part) for part in load.parts or (load,)]
        for number, other in enumerate(others):
            value = self.new(f"{force}_sum_{number}", "add", value, other)
        made = [line for line in self.lines[start:] if line.name not in self.reduced]
        for p in sorted(parameters):
            self.slopes[force, p] = self._derivative(force, value, p, made)
        for part in load.parts or (load,):
            if part.over not in ("theta", "Y", "V_C"):
                self._mark(force, part, parameters)
        size = self.new(f"{force}_size", "abs", value)
        finite = self.new(f"{force}_is_finite", "le", size, float_info.max, type="bool")
        self.new(force, "select", finite, value, 0.0)  # a point without motion has a status of its own
        self.notes[force] = Note(INPUTS[force].unit, INPUTS[force].meaning)

    def _derivative(self, force: str, value: str, parameter: str, lines: Sequence[Line]) -> Argument:
        """The derivative of a force by the chain rule on its lines."""
        chain = Chain(parameter, prefix=f"{force}_d_")
        for quantity in ("Y", "V_C", "Y_outer", "Y_inner"):
            slope = f"{quantity}_wrt_{parameter}"
            if quantity in self.names and slope in self.names:
                chain.slopes[self.names[quantity]] = self.names[slope]
        if parameter == "theta":
            chain.slopes |= self.reduced
        for line in lines:
            chain.through(line)
        self.lines += chain.lines
        return chain.slope(value)

    def _look_up(self, load: LoadLines) -> str:
        """The lines of the value of a table; the name of the value."""
        force, table = load.force, TableName(load.force)
        x = self._reduced(load) if load.over == "theta" else self._along(load)
        piece = f"{force}_piece"
        if not load.held:
            way = 1.0 if load.over == "theta" or not load.ways else self._ahead()
            self.new(piece, "lookup_piece", x, table, way)
        return self.new(f"{force}_found", "lookup", x, table, piece)

    def _reduced(self, load: LoadLines) -> str:
        """The crank angle in the first period of a table."""
        if not load.period:
            return "theta"
        force, first, period, start = load.force, load.first, load.period, len(self.lines)
        away = self.new(f"{force}_away", "sub", "theta", first)
        turns = self.new(f"{force}_turns", "floor", self.new(f"{force}_ratio", "div", away, period))
        back = self.new(f"{force}_back", "mul", period, turns)
        angle = self.new(f"{force}_angle", "sub", "theta", back)
        early = self.new(f"{force}_is_early", "lt", angle, first, type="bool")
        before = self.new(f"{force}_before", "sub", angle, period)
        late = self.new(f"{force}_is_late", "le", first, before, type="bool")
        after = self.new(f"{force}_after", "add", angle, period)
        inside = self.new(f"{force}_inside", "select", late, before, angle)
        result = self.new(f"{force}_at", "select", early, after, inside)
        self.reduced |= dict.fromkeys((line.name for line in self.lines[start:]), 1.0)
        return result

    def _along(self, load: LoadLines) -> str:
        if load.over in ("Y", "V_C"):
            return self.names[load.over]
        away = self.new(f"{load.force}_away", "sub", self.names[load.over], self.names["Y"])
        return self.new(f"{load.force}_at", "abs", away)

    def _ahead(self) -> str:
        """Negative where the slider goes inward; at a dead centre where it will."""
        if any(line.name == "way_ahead" for line in self.lines):
            return "way_ahead"
        slope, bend = self.names["Y_wrt_theta"], self.names["Y_wrt_theta_theta"]
        rests = self.new("speed_is_0", "eq", self.way.speed, 0.0, type="bool")
        turning = self.new("way_of_turning", "select", rests, self.way.start, self.way.speed)
        turns = self.new("slider_turns", "eq", slope, 0.0, type="bool")
        forward = self.new("way_forward", "select", turns, bend, slope)
        back = self.new("way_back", "neg", forward)
        backwards = self.new("turns_backwards", "lt", turning, 0.0, type="bool")
        return self.new("way_ahead", "select", backwards, back, forward)

    def _mark(self, force: str, load: LoadLines, parameters: set[str]) -> None:
        """The conditions that there is no such dead centre, and that it moves infinitely fast."""
        name, centre = load.force, self.names[load.over]
        there = self.new(f"{name}_is_there", "eq", centre, centre, type="bool")
        moves: Argument = True
        for p in sorted(parameters & set(LENGTHS)):
            size = self.new(f"{name}_rate_{p}", "abs", self.names[f"{load.over}_wrt_{p}"])
            finite = self.new(f"{name}_moves_{p}", "le", size, float_info.max, type="bool")
            moves = self.new(f"{name}_moves_to_{p}", "and", moves, finite, type="bool")
            value = self.slopes[force, p]
            self.slopes[force, p] = self.new(f"{name}_per_{p}", "select", finite, value, nan)
        self.marks.setdefault(force, []).append((name, there, moves))

    def total(self, total: Total) -> str:
        """The line of a total."""
        result = self.names[total.name]
        for number, (slope, force, parameter) in enumerate(total.terms):
            factors = self.names[slope], self.slopes[force, parameter]
            term = self.new(f"{total.name}_term_{number}", "mul", *factors)
            result = self.new(f"{total.name}_total_{number}", "add", result, term)
        for force in total.forces:
            for mark in self.marks.get(force, ()):
                result = self._with_status(total.name, result, *mark)
        return result

    def _with_status(self, name: str, value: str, table: str, there: str, moves: Argument) -> str:
        if name != STATUS:
            return self.new(f"{name}_under_{table}", "select", there, value, nan)
        why = self.new(f"{table}_moves_status", "select", moves, 0, 2, type="i64")
        own = self.new(f"{table}_status", "select", there, why, 1, type="i64")
        return self.new(f"{name}_under_{table}", "select", self._is_good(value), own, value, type="i64")

    def _is_good(self, status: Argument) -> Argument:
        """The condition that a status is 0: what chooses it chooses True for 0 and else False."""
        if not isinstance(status, str):
            return status == 0
        name = f"{status}_is_0"
        line = next(line for line in self.lines if line.name == status)
        if not any(line.name == name for line in self.lines):
            test = line.args[: line.op == "select"]
            args = (*test, *map(self._is_good, line.args[len(test) :]))
            self.new(name, line.op, *args, type="bool")
        return name
