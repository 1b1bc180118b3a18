"""From the loop closure to the frozen Programs, in order."""

from typing import NamedTuple

from desaxe.compiler.passes.number import number_values
from desaxe.compiler.passes.slicing import drop_unused
from desaxe.compiler.passes.trigonometry import Trigonometry
from desaxe.compiler.program import Program, validate
from desaxe.names import PARAMETERS, parts, sensitivity

from .freeze import freeze
from .motion import state_sheet
from .polynomials import trigonometry
from .quantities import FACTS, QUANTITIES, SECOND_ORDER, build_sheet
from .sheet import Sheet, symbol

INPUTS = (*PARAMETERS, "branch")
# What is needed -> the line that is 0 where there is such a thing, else NaN.
GUARDS = {"D": "no_effect_on_rod", "omega2": "no_effect_on_motion"}


class Derivation(NamedTuple):
    """What is written: the law's program, the state's lines, public names, sine and cosine."""

    program: Program
    frozen: Program  # the same before equal values were merged
    state: Program
    names: tuple[str, ...]
    trigonometry: Trigonometry


def public_names() -> tuple[str, ...]:
    """Every name that can be asked for: quantities, sensitivities, facts."""
    first = [sensitivity(q, p) for q in QUANTITIES for p in PARAMETERS]
    second = [
        sensitivity(sensitivity(q, p), t)
        for q in SECOND_ORDER
        for i, p in enumerate(PARAMETERS)
        for t in PARAMETERS[i:]
    ]
    return (*QUANTITIES, *FACTS, *first, *second)


def build() -> Derivation:
    """Derive everything."""
    sheet = build_sheet()
    for name in public_names():
        _derive(sheet, name)
    state = state_sheet()
    motion = tuple(name for name in state.equations if sheet.equation(name) is not None)
    program = freeze(sheet, INPUTS, (*public_names(), *motion))
    state_program = freeze(state, ("omega", "alpha"), motion)
    return Derivation(_finished(program), program, _finished(state_program), public_names(), trigonometry())


def _derive(sheet: Sheet, name: str) -> None:
    """Make the equation of a public name."""
    base, parameters = parts(name)
    so_far = base
    for parameter in parameters:
        value = sheet.derivative(so_far, parameter)
        so_far = sensitivity(so_far, parameter)
        if value.is_number and so_far not in sheet.equations:
            _define_constant(sheet, so_far, base, value)


def _define_constant(sheet: Sheet, name: str, base: str, value: object) -> None:
    """A derivative that is 0: NaN all the same where there is no mechanism or no motion."""
    if value != 0:
        raise ValueError(f"{name} is the constant {value}")
    needs = set(sheet.ordered((base,)))
    still = next((guard for what, guard in GUARDS.items() if what in needs), "")
    unit = sheet.equations[base].unit
    if unit is None:
        raise ValueError(f"{base} has no unit")
    sheet.define(
        name,
        symbol(still) if still else value,
        unit=unit.over(*parts(name)[1]),
        meaning=f"0: {base} does not depend on it",
        rigid=True,
    )


def _finished(program: Program) -> Program:
    return validate(drop_unused(number_values(program)))
