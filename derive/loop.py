r"""The mechanism: an offset slider-crank, from its vector loop.

             Y, slider axis (shifted by -ec along X)
             ^
        C    |              B = (AB sin theta, AB cos theta)     crank pin
       [=]   |              C = (-ec, Y)                         slider
         \   |              A -> B -> C closes on the slider line X = -ec
      BC  \  |   B
           \ | _o           theta turns from +Y towards +X
            \|/  AB         phi is the angle of the rod to the slider axis
      -ec <--A---> X

Nothing here is typed in solved form: SymPy solves the loop for the rod angle and the slider, and
differentiates the rod's own loop. `branch` is +1 where the slider is beyond the crank pin (the
papers), else -1.

Source: paper A, equations (5) to (7); paper B, (4) to (8).
"""

from functools import cache

import sympy as sp

theta, ec, AB, BC, branch = sp.symbols("theta ec AB BC branch", real=True)
phi, slider = sp.symbols("phi Y", real=True)

CRANK = sp.Matrix([AB * sp.sin(theta), AB * sp.cos(theta)])  # A -> B
ROD = sp.Matrix([-BC * sp.sin(phi), branch * BC * sp.cos(phi)])  # B -> C
SLIDER = sp.Matrix([-ec, slider])  # A -> C
CLOSURE = CRANK + ROD - SLIDER  # = 0

# The rod alone: a bar of length BC whose ends are u apart across the slider axis, S along it.
u, S = sp.symbols("u S", real=True)
r = sp.Symbol("inv_S", real=True)  # 1 / S
ROD_CLOSURE = sp.Matrix([BC * sp.sin(phi) - u, BC * sp.cos(phi) - S])  # = 0


@cache
def solved() -> dict[sp.Expr, sp.Expr]:
    """The loop solved for `BC sin(phi)` (which is u) and the slider `Y`, in u and S."""
    sine, cosine = sp.symbols("sine cosine")
    across, along = CLOSURE.subs({sp.sin(phi): sine, sp.cos(phi): cosine})
    (position,) = sp.solve(along, slider)
    (sin_phi,) = sp.solve(across, sine)
    return {u: sp.expand(BC * sin_phi), slider: position.subs(cosine, S / BC)}


@cache
def rod_partials() -> dict[tuple[str, sp.Symbol], sp.Expr]:
    """First partial derivatives of the rod's angle phi and height S by u and BC, in u, BC and 1/S.

    By implicit differentiation of the rod's loop BC sin(phi) = u, BC cos(phi) = S.
    """
    unknown = sp.Matrix([phi, S])
    result = {}
    for parameter in (u, BC):
        rates = -ROD_CLOSURE.jacobian(unknown).inv() * ROD_CLOSURE.diff(parameter)
        for name, rate in zip(("phi", "S"), rates, strict=True):
            on_rod = sp.simplify(rate).subs(
                {sp.tan(phi): u * r, sp.sin(phi): u / BC, sp.cos(phi): 1 / (r * BC)}
            )
            result[name, parameter] = on_rod
    return result
