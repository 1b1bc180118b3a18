"""From the loop closure to the frozen Programs, in order."""

from typing import NamedTuple

import sympy as sp

from desaxe.compiler.passes.double_angles import DoubleTrigonometry
from desaxe.compiler.passes.slicing import drop_unused
from desaxe.compiler.passes.trigonometry import Trigonometry
from desaxe.compiler.passes.value_numbering import value_numbering
from desaxe.compiler.program import Program, renamed, validate
from desaxe.mechanism.closed.dead_centres import SENSITIVITIES
from desaxe.mechanism.names import CENTRES, LOADS, PARAMETERS, WHOLE, parts, per, sensitivity

from .closed import whole_design
from .dynamics import FORCES, LUMPS, centres_sheet
from .freeze import freeze
from .groups import FRAME
from .motion import state_sheet
from .polynomials import double_trigonometry, trigonometry
from .quantities import FACTS, QUANTITIES, SECOND_ORDER, build_sheet
from .sheet import Sheet, symbol

INPUTS = (*PARAMETERS, *LOADS, "branch")
# What a quantity may need -> the line that is 0 where it is there, else NaN. A derivative that has lost
# a need of its quantity is still NaN where that is not there.
KEEPS = {"D": "no_effect_on_rod", "omega2": "not_stalled", "N_C": "one_balance"}
# Computed for the library, but nothing that one asks for by name.
INTERNAL = ("force_status", "turning", *KEEPS.values())


class Derivation(NamedTuple):
    """The result of the derivation: the law's program, its overlays, public names, sine and cosine."""

    program: Program
    frozen: Program  # the same before equal values were merged
    state: Program  # the lines of a given state
    centres: Program  # the lines of centres of mass that are halfway along their links
    names: tuple[str, ...]
    trigonometry: Trigonometry
    double_trigonometry: DoubleTrigonometry  # to twice the digits


def sheet_names() -> tuple[str, ...]:
    """The public names of the sheet: quantities, sensitivities, facts."""
    first = [sensitivity(q, p) for q in QUANTITIES for p in parameters_of(q)]
    second = [
        sensitivity(sensitivity(q, p), t)
        for q in SECOND_ORDER
        for i, p in enumerate(PARAMETERS)
        for t in PARAMETERS[i:]
    ]
    return (*QUANTITIES, *FACTS, *first, *second)


def public_names() -> tuple[str, ...]:
    """All public names: those of the sheet, and those of a whole design behind the facts."""
    facts = len(QUANTITIES) + len(FACTS)
    names = sheet_names()
    return (*names[:facts], *WHOLE, *names[facts:], *SENSITIVITIES)


def parameters_of(quantity: str) -> tuple[str, ...]:
    """Parameters that a quantity may depend on."""
    return (*PARAMETERS, *LOADS) if quantity in FORCES else PARAMETERS


def build() -> Derivation:
    """Derive everything."""
    sheet = build_sheet()
    for name in sheet_names():
        _derive(sheet, name)
    state, centres = state_sheet(), centres_sheet()
    motion = tuple(name for name in state.equations if sheet.equation(name) is not None)
    moving = tuple(name for name in centres.equations if name not in CENTRES)
    program = freeze(sheet, INPUTS, (*sheet_names(), *INTERNAL, *motion, *moving))
    program = _with_lines(program, whole_design())
    overlays = (
        _finished(freeze(state, ("omega", "alpha"), motion)),
        _finished(freeze(centres, ("AB", "BC"), (*CENTRES, *moving))),
    )
    return Derivation(
        _finished(program),
        program,
        *overlays,
        public_names(),
        trigonometry(),
        double_trigonometry(),
    )


def _with_lines(program: Program, more: Program) -> Program:
    """The program, followed by the lines of another one; ValueError where they share a name."""
    own = {line.name: f"_design{n}" for n, line in enumerate(more.lines) if line.name.startswith("_")}
    lines = renamed(more, own)
    shared = {line.name for line in program.lines} & {line.name for line in lines.lines}
    if shared:
        raise ValueError(f"the sheet and the whole design both define {', '.join(sorted(shared))}")
    return program._replace(
        lines=(*program.lines, *lines.lines),
        outputs=(*program.outputs, *lines.outputs),
        notes={**program.notes, **lines.notes},
    )


def _derive(sheet: Sheet, name: str) -> None:
    """Make the equation of a public name."""
    base, parameters = parts(name)
    so_far = base
    for parameter in parameters:
        value = sheet.derivative(so_far, parameter)
        so_far = sensitivity(so_far, parameter)
        if value.is_number and so_far not in sheet.equations:
            _define_constant(sheet, so_far, base, value)
    _keep_needs(sheet, name, base)


def _keep_needs(sheet: Sheet, name: str, base: str) -> None:
    """Make a value NaN where its quantity does not exist, if its own lines do not already.

    A force is one of the whole mechanism, even where its formula has the crank alone.
    """
    requested, own = set(sheet.ordered((base,))), set(sheet.ordered((name,)))
    if base in FORCES and base not in LUMPS:
        requested |= {"D"} if base not in FRAME else {"D", "N_C"}
    lost = [KEEPS[what] for what in KEEPS if what in requested and what not in own and KEEPS[what] not in own]
    equation = sheet.equations[name]
    if lost and name not in FACTS:
        plain = equation.expression if equation.differentiate is None else equation.differentiate
        terms = [*([equation.expression] if equation.expression != 0 else []), *map(symbol, lost)]
        guarded = sp.Add(*terms, evaluate=False) if len(terms) > 1 else terms[0]
        sheet.equations[name] = equation._replace(expression=guarded, differentiate=plain)


def _define_constant(sheet: Sheet, name: str, base: str, value: sp.Expr) -> None:
    """A derivative that is a number."""
    unit = sheet.equations[base].unit
    if unit is None:
        raise ValueError(f"{base} has no unit")
    by = parts(name)[1]
    named = f"derivative of {base} with respect to {', '.join(by)}"
    what = named if value else f"0: {base} does not depend on it"
    sheet.define(name, value, per(unit, *by), what)


def _finished(program: Program) -> Program:
    return validate(drop_unused(value_numbering(program)))
