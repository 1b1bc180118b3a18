"""The Programs of an FMU: acceleration, outputs, their partial derivatives, limit angles."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ....compiler.passes.differentiate import with_derivatives
from ....compiler.passes.guard import guard_inputs
from ....compiler.passes.pipeline import optimise
from ....compiler.program import Line, Program
from ....loads.load import Load
from ....mechanism.catalogue import law_name, quantities
from ....mechanism.closed.functions import closed_form
from ....mechanism.closed.inverse import INVERSE
from ....mechanism.closed.limits import ANGLES, LIMITS
from ....mechanism.inputs import LEAST
from ....mechanism.names import sensitivity
from ....runtime.request import Request, request
from ....runtime.specialise import specialise
from ...content import Content
from ..motion import motion
from .loads import position_names, tables
from .variables import FORCES, Variables

TORQUE = "T_in"  # the row whose derivatives say how the acceleration depends on everything


class Programs(NamedTuple):
    """Programs, and for each partial derivative its row (output) and what it is by."""

    motion: Program | None
    outputs: Program
    status: int
    slopes: Program
    entries: tuple[tuple[str, str], ...]
    limits: Program
    position: Program  # of the slider and of its dead centres, with derivatives by theta and the lengths
    inverse: Program  # the crank angles for a slider position
    loads: Mapping[str, Load]  # those that vary with the motion


def programs(content: Content, table: Variables) -> Programs:
    """The Programs of a scene with these variables."""
    own = [name for name in table.parameters if name not in ("theta0", "omega_start")]
    moves = bool(table.states)
    given = dict.fromkeys((*own, *FORCES), (0.0, 1.0))
    knowns = ("theta", "omega", "alpha", *FORCES, *own) if moves else ("theta", "omega", *FORCES, *own)
    names = tuple(dict.fromkeys((*table.outputs, "status")))
    asked = _request(names, given, content.branch, moves)
    outputs = specialise(asked.names, asked.form, asked.fixed)
    rows = dict.fromkeys((*(n for n in table.outputs if n != "status"), *([TORQUE] if moves else [])))
    slopes, entries = _slopes(tuple(rows), knowns, given, content.branch, moves)
    loads = tables(content.inputs)
    position = _request(position_names(loads), {}, content.branch, False)
    return Programs(
        motion(given, content.branch) if moves else None,
        guard_inputs(outputs, [n for n in ("theta", "omega", *FORCES) if n in outputs.inputs], LEAST, {}),
        names.index("status"),
        slopes,
        entries,
        closed_form(LIMITS, (*ANGLES, "status")).program,
        specialise(position.names, position.form, position.fixed),
        closed_form(INVERSE, ("first", "second"), branch=float(content.branch)).program,
        loads,
    )


def _request(
    names: Sequence[str], given: dict[str, tuple[float, float]], branch: int, moves: bool
) -> Request:
    """The request of names of a given state, every input open; with a given speed alpha is 0."""
    state: dict[str, object] = {"theta": 1.0, "omega": 1.0, **dict.fromkeys(given, 1.0)}
    return request(names, state | ({"alpha": 1.0} if moves else {}), branch, "standard")


def _slopes(
    rows: Sequence[str],
    knowns: Sequence[str],
    given: dict[str, tuple[float, float]],
    branch: int,
    moves: bool,
) -> tuple[Program, tuple[tuple[str, str], ...]]:
    """A Program of all partial derivatives that are not 0: the derived ones, else line by line."""
    known = quantities()
    found: dict[tuple[str, str], str] = {}
    missing: dict[str, list[str]] = {}
    for row in rows:
        asked = _request((row,), given, branch, moves)
        used = specialise(asked.names, asked.form, asked.fixed).inputs
        for by in (by for by in knowns if by in used):
            name = sensitivity(row, by)
            if law_name(name) in known and "omega0" not in name:
                found[row, by] = name
            else:
                missing.setdefault(row, []).append(by)
    program = Program((), (), (), {})
    if found:
        asked = _request(tuple(found.values()), given, branch, moves)
        program = specialise(asked.names, asked.form, asked.fixed)
    places = dict(zip(found, program.outputs, strict=True))
    lines, inputs = list(program.lines), dict.fromkeys(program.inputs)
    for number, (row, several) in enumerate(missing.items()):
        asked = _request((row,), given, branch, moves)
        more = with_derivatives(specialise(asked.names, asked.form, asked.fixed), tuple(several))
        prefix = {line.name: f"_own{number}_{line.name}" for line in more.lines}
        lines += [
            line._replace(
                name=prefix[line.name],
                args=tuple(prefix.get(a, a) if isinstance(a, str) else a for a in line.args),
            )
            for line in more.lines
        ]
        inputs |= dict.fromkeys(more.inputs)
        places |= {(row, p): prefix[output] for p, output in zip(several, more.outputs[1:], strict=True)}
    outputs = []
    for number, place in enumerate(places.values()):  # an output may be an input, or that of two entries
        lines.append(Line(f"_slope{number}", "copy", (place,)))
        outputs.append(f"_slope{number}")
    whole = Program(tuple(inputs), tuple(lines), tuple(outputs), program.notes)
    return optimise(whole), tuple(places)
