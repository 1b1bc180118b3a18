"""The loop closure is solved, not typed: what SymPy finds closes the loop, and follows it if it changes."""

import mpmath
import pytest
import sympy as sp

from desaxe.derive import loop
from desaxe.derive.loop import AB, BC, CLOSURE, S, branch, ec, phi, r, rod_partials, slider, solved, theta, u

POINTS = [
    {theta: 1.1, ec: 0.02, AB: 0.125, BC: 0.35, branch: 1},
    {theta: -2.5, ec: -0.1, AB: 0.2, BC: 0.5, branch: -1},
    {theta: 0.2, ec: 0.1, AB: 0.9, BC: 0.4, branch: 1},
]


def test_the_solution_closes_the_loop():
    """With u = BC sin(phi) and S = BC cos(phi)."""
    across, along = CLOSURE.subs(slider, solved()[slider])
    assert sp.expand(along.subs(S, BC * sp.cos(phi))) == 0
    assert sp.expand(across + BC * sp.sin(phi) - solved()[u]) == 0


@pytest.mark.parametrize("at", POINTS)
def test_the_solution_closes_the_loop_in_numbers(at):
    offset = solved()[u].subs(at)
    angle = sp.asin(offset / at[BC])
    position = solved()[slider].subs(S, BC * sp.cos(angle)).subs(at)
    residual = CLOSURE.subs({slider: position, phi: angle}).subs(at)
    assert max(abs(component.evalf(30)) for component in residual) < 1e-15


def test_another_loop_has_another_solution(monkeypatch):
    monkeypatch.setattr(loop, "CLOSURE", CLOSURE.subs(ec, -ec))
    assert solved.__wrapped__()[u] == AB * sp.sin(theta) - ec


def height(across, rod):
    return mpmath.sqrt(rod * rod - across * across)


def angle(across, rod):
    return mpmath.asin(across / rod)


@pytest.mark.parametrize(("name", "function"), [("phi", angle), ("S", height)])
@pytest.mark.parametrize(("parameter", "order"), [(u, (1, 0)), (BC, (0, 1))])
@pytest.mark.parametrize(("across", "rod"), [(0.1, 0.35), (-0.34, 0.35), (0.0, 2.0)])
def test_the_partials_of_the_rod_are_its_slopes(name, function, parameter, order, across, rod):
    with mpmath.workdps(40):
        at = {u: sp.Float(across, 40), BC: sp.Float(rod, 40)}
        formula = rod_partials()[name, parameter].subs(r, 1 / sp.sqrt(BC**2 - u**2)).subs(at).evalf(40)
        slope = mpmath.diff(function, (mpmath.mpf(across), mpmath.mpf(rod)), order)
        assert abs(mpmath.mpf(formula) - slope) < 1e-18 * (1 + abs(slope))


def test_another_rod_has_other_partials(monkeypatch):
    """A rod of twice the length, were its closure typed so."""
    right = rod_partials()["S", BC]  # first: it is kept
    monkeypatch.setattr(loop, "ROD_CLOSURE", loop.ROD_CLOSURE.subs(BC, 2 * BC))
    assert rod_partials.__wrapped__()["S", BC] != right
