"""`harmonics`: the Fourier series of a quantity over the crank angle, at constant speed."""

from typing import Any

import numpy as np

from ...mechanism.catalogue import quantity
from ...support.answer import answering
from .turn import Turn


@answering
def harmonics(name: str, *, orders: int = 8, branch: int = 1, **inputs: Any) -> dict[str, Any]:
    """The harmonics of a quantity over a turn at constant speed.

    name    any quantity or sensitivity, such as "F_shaking_Y", "T_in" or "a_C"
    orders  the highest harmonic that is wanted
    inputs  of one design, as in `evaluate`; F_X and F_Y may vary with the motion

    Gives a dict; the quantity is mean + sum over n of cos[n] cos(n theta) + sin[n] sin(n theta):

    order              0, 1, ..., orders
    cos, sin           coefficients by order, in the quantity's unit; cos[0] is the mean
    amplitude, phase   the same as amplitude cos(n theta - phase) [rad]
    mean               over the turn
    remainder          root of the mean square of all higher harmonics: what these orders leave out
    error              bound of the error of each coefficient: what the last halving of the steps changed
    points             steps of the turn that this took

    Equal steps and the fast Fourier transform: for a crank that turns with some margin the error falls
    geometrically with the steps, towards the change point ever slower. Raises ValueError where the crank
    cannot turn fully or a value is missing.

        >>> import desaxe as dx
        >>> found = dx.harmonics("a_C", ec=0, AB=0.1, BC=0.4, omega0=10.0)
        >>> [round(float(c), 4) for c in found["cos"][:3]]
        [0.0, -10.0, -2.5403]
    """
    quantity(name)
    if name == "status":
        raise ValueError("status is no real number")
    if not isinstance(orders, int) or orders < 0:
        raise ValueError(f"orders = {orders!r}: a whole number, at least 0")
    turn = Turn("harmonics", inputs, branch)
    found, error = turn.spectrum([name], 4 * (orders + 1))
    c = found[name]
    scale = np.where(np.arange(orders + 1) == 0, 1.0, 2.0)
    cosine, sine = scale * c[: orders + 1].real, -scale * c[: orders + 1].imag
    return {
        "order": np.arange(orders + 1),
        "cos": cosine,
        "sin": sine,
        "amplitude": np.hypot(cosine, sine),
        "phase": np.arctan2(sine, cosine),
        "mean": float(cosine[0]),
        "remainder": float(np.sqrt(2.0 * np.sum(np.abs(c[orders + 1 :]) ** 2))),
        "error": 2.0 * error,
        "points": 2 * (len(c) - 1),
    }
