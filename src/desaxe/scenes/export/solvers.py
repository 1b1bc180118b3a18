"""Solvers for a controller: the crank angle for a slider position, and the limit angles.

Both are closed forms of `mechanism/closed/`.
"""

from collections.abc import Mapping

from ...compiler.languages.protocol import Solver, Symbol
from ...compiler.passes.guard import guard_inputs
from ...compiler.passes.pipeline import optimise
from ...compiler.program import Program
from ...design.inverse import SLIDER_INPUTS
from ...mechanism.closed.functions import closed_form
from ...mechanism.closed.inverse import INVERSE
from ...mechanism.closed.limits import ANGLES, LIMITS
from ...mechanism.inputs import LEAST
from ...mechanism.program import Variant
from ...runtime.specialise import specialise

SLOPES = ("Y_wrt_theta", "Y_wrt_theta_theta")


def solvers(fixed: Mapping[str, float]) -> dict[str, Solver]:
    """The solvers of a mechanism of which some inputs are fixed."""
    kinematic = tuple((name, value) for name, value in fixed.items() if name in ("branch", "ec", "AB", "BC"))
    slider = tuple(Symbol(row.name, row.unit, row.meaning) for row in SLIDER_INPUTS.values())
    slopes = specialise(SLOPES, Variant(), kinematic)
    return {
        "inverse": Solver(slider, _cut(INVERSE, fixed), slopes),
        "limits": Solver((), _cut(LIMITS, fixed, (*ANGLES, "status"))),
    }


def _cut(text: str, fixed: Mapping[str, float], outputs: tuple[str, ...] = ()) -> Program:
    """The program with fixed inputs folded in; invalid arguments give NaN and status 4."""
    program = optimise(closed_form(text, outputs).program, fixed)
    return guard_inputs(program, program.inputs, LEAST, {})
