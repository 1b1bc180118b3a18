"""`harmonics`: the Fourier series of a quantity over the crank angle, at constant speed."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.catalogue import quantity
from ...mechanism.keywords import with_known_keywords
from ...mechanism.quantity_units import unit_of
from ...support.answer import Answer
from ...support.checks import whole_number
from ...support.panels import RESOLVED, WEIGHT
from .turn import MOST, Turn, one_turn

WAVES = 4.0  # rad of the highest wave in a panel of 16 nodes: what Gauss's rule integrates to rounding


@with_known_keywords
def harmonics(name: str, *, orders: int = 8, branch: int = 1, **inputs: Any) -> dict[str, Any]:
    """The harmonics of a quantity over a turn at constant speed.

    name    any quantity or sensitivity, such as "F_shaking_Y", "T_in" or "a_C"
    orders  the highest harmonic
    inputs  of one design, as in `evaluate`; F_X and F_Y may vary with the motion

    Returns a dict; the quantity is mean + sum over n of cos[n] cos(n theta) + sin[n] sin(n theta):

    order              0, 1, ..., orders
    cos, sin           coefficients by order, in the quantity's unit; cos[0] is the mean
    amplitude, phase   the same as amplitude cos(n theta - phase) [rad]
    mean               over the turn
    remainder          root of the mean square of all higher harmonics: what these orders leave out
    error              bound of the error of each coefficient: what the last halving of the steps changed, or
                       how far the panels were refined
    points             steps of the turn that this took

    Equal steps and the fast Fourier transform: for a crank that turns with some margin the error falls
    geometrically with the steps, towards the change point ever slower. Under a table of a load, Gauss's rule
    in panels between its kinks and jumps. Raises ValueError where the crank
    cannot turn fully or a value is missing.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.harmonics("a_C", ec=0, AB=0.1, BC=0.4, omega0=10.0)
        >>> [round(float(c), 4) for c in found["cos"][:3]]
        [0.0, -10.0, -2.5403]
    """
    quantity(name)
    if name == "status":
        raise ValueError("status is not a real number")
    orders = whole_number("orders", orders, 0, MOST // 16)
    turn = one_turn("harmonics", inputs, branch)
    if turn.kinks:
        c, remainder, error, points = _across_kinks(turn, name, orders)
    else:
        found, error = turn.spectrum([name], 4 * (orders + 1))
        c, points = found[name][: orders + 1], 2 * (len(found[name]) - 1)
        remainder = float(np.sqrt(2.0 * np.sum(np.abs(found[name][orders + 1 :]) ** 2)))
    scale = np.where(np.arange(orders + 1) == 0, 1.0, 2.0)
    cosine, sine = scale * c.real, -scale * c.imag
    series: dict[str, Any] = {
        "order": np.arange(orders + 1),
        "cos": cosine,
        "sin": sine,
        "amplitude": np.hypot(cosine, sine),
        "phase": np.arctan2(sine, cosine),
        "mean": float(cosine[0]),
        "remainder": remainder,
        "error": 2.0 * error,
        "points": points,
    }
    own = dict.fromkeys(("cos", "sin", "amplitude", "mean", "remainder", "error"), unit_of(name))
    return Answer(series, {**own, "phase": unit_of("phase")})


def _across_kinks(turn: Turn, name: str, orders: int) -> tuple[NDArray[np.complex128], float, float, int]:
    """Complex coefficients, remainder, their error, and the angles that this took, in panels."""
    panels = turn.panels([name])
    widest = WAVES / (orders + 1)
    edges = [np.linspace(a, b, int(np.ceil((b - a) / widest)) + 1) for a, b in pairwise(panels.edges)]
    panels = panels.split(np.concatenate(edges).tolist())
    value, weight = panels.values[name], panels.half * WEIGHT / (2.0 * np.pi)
    c = np.array([np.sum(weight * value * np.exp(-1j * n * panels.x)) for n in range(orders + 1)])
    series = c[0].real + 2.0 * sum((c[n] * np.exp(1j * n * panels.x)).real for n in range(1, orders + 1))
    remainder = float(np.sqrt(np.sum(weight * (value - series) ** 2)))
    return c, remainder, RESOLVED * float(np.abs(value).max()), value.size
