"""Solvers for a controller: the crank angle for a slider position, and the limit angles.

Both are closed forms, written as Programs, so that every language that takes them has the same digits.
"""

from collections.abc import Mapping
from math import pi

from ...compiler.languages.protocol import Solver, Symbol
from ...compiler.passes.guard import guard_inputs
from ...compiler.passes.pipeline import optimise
from ...compiler.program import Program
from ...compiler.text import read_function
from ...design.inverse import SLIDER_INPUTS
from ...mechanism.inputs import LEAST
from ...mechanism.program import Variant
from ...runtime.specialise import specialise

# The triangle A B C has the sides AB, BC and L = |AC|; its angle at A comes from the half-angle form, which
# keeps its digits where the triangle is flat. See `desaxe.inverse`.
INVERSE = f'''def inverse(Y, ec, AB, BC, branch):
    """The crank angles that put the slider at Y."""
    L = sqrt(ec * ec + Y * Y)  # m | distance of the slider from the crank centre
    above = (BC - (L - AB)) * (BC + (L - AB))
    below = ((L + AB) - BC) * ((L + AB) + BC)
    is_flat = above == 0.0 or below == 0.0
    beta = 2.0 * atan2(sqrt(above), sqrt(below))  # rad | angle of the triangle at A
    middle = atan2(-ec, Y)  # rad | crank angle that points at the slider
    one = middle - beta
    other = middle + beta
    one_turn = one + {2 * pi!r} if one <= {-pi!r} else one
    other_turn = other - {2 * pi!r} if {pi!r} < other else (other + {2 * pi!r} if other <= {-pi!r} else other)
    one_fits = 0.0 <= (Y - AB * cos(one_turn)) * branch
    other_fits = 0.0 <= (Y - AB * cos(other_turn)) * branch
    one_good = one_turn if one_fits else nan
    other_good = other_turn if other_fits else nan
    swapped = not one_fits or (other_fits and other_good < one_good)
    first = other_good if swapped else one_good
    last = one_good if swapped else other_good
    second = nan if is_flat and first == last else last
    status = 2 if is_flat and first == first else (0 if first == first else 1)
    return first, second, status
'''
# A side of the crank whose margin is negative loses the angles within a gap of its quarter: 1 - cos(gap) =
# -margin/AB and 1 + cos(gap) = (margin + 2 AB)/AB, so that tan(gap/2) has no cancellation.
LIMITS = f'''def limits(ec, AB, BC):
    """The crank angles at which |ec + AB sin(theta)| <= BC."""
    room = BC - AB
    lost = two_sum_error(BC, -AB)
    upper = (room - ec) + (two_sum_error(room, -ec) + lost)  # m | margin at theta = pi/2
    lower = (room + ec) + (two_sum_error(room, ec) + lost)  # m | margin at theta = -pi/2
    over = BC + AB - ec
    under = BC + AB + ec
    top = 2.0 * atan2(sqrt(-upper), sqrt(over)) if upper < 0.0 else 0.0  # rad | lost on each side of pi/2
    bottom = 2.0 * atan2(sqrt(-lower), sqrt(under)) if lower < 0.0 else 0.0  # rad | at -pi/2
    turns = 0.0 <= upper and 0.0 <= lower
    none = not turns and (AB == 0.0 or not (0.0 <= over and 0.0 <= under))
    above = bottom == 0.0
    below = top == 0.0
    wraps = bottom < {pi / 2!r}
    start_below = {1.5 * pi!r} + bottom if wraps else bottom - {pi / 2!r}
    end_below = {3.5 * pi!r} - bottom if wraps else {1.5 * pi!r} - bottom
    start = {pi / 2!r} + top if above else (start_below if below else {pi / 2!r} + top)
    end = {2.5 * pi!r} - top if above else (end_below if below else {1.5 * pi!r} - bottom)
    first_start = nan if none else (0.0 if turns else start)
    first_end = nan if none else ({2 * pi!r} if turns else end)
    single = none or (turns or (above or below))
    second_start = nan if single else {1.5 * pi!r} + bottom
    second_end = nan if single else {2.5 * pi!r} - top
    least = upper if upper < lower else lower
    status = 2 if least == 0.0 else (0 if turns else 1)
    return first_start, first_end, second_start, second_end, status
'''
SLOPES = ("Y_wrt_theta", "Y_wrt_theta_theta")


def solvers(fixed: Mapping[str, float]) -> dict[str, Solver]:
    """The solvers of a mechanism of which some inputs are fixed."""
    kinematic = tuple((name, value) for name, value in fixed.items() if name in ("branch", "ec", "AB", "BC"))
    slider = tuple(Symbol(row.name, row.unit, row.meaning) for row in SLIDER_INPUTS.values())
    slopes = specialise(SLOPES, Variant(), kinematic)
    return {
        "inverse": Solver(slider, _cut(INVERSE, fixed), slopes),
        "limits": Solver((), _cut(LIMITS, fixed)),
    }


def _cut(text: str, fixed: Mapping[str, float]) -> Program:
    """The program with fixed inputs folded in; invalid arguments give NaN and status 4."""
    program = read_function(text)
    program = optimise(program, {name: fixed[name] for name in program.inputs if name in fixed})[0]
    return guard_inputs(program, program.inputs, LEAST, {})
