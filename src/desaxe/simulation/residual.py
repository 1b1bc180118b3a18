"""The energy residual of a motion, and a message where it is unusual: step control was deceived then."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .checks import LEAST_RTOL
from .equations import state_of
from .events import Q, V, W
from .model import Model

# The usual residual, as a share of rtol: the medians of `python -m benchmarks.steps` (DOP853), and of 12
# such motions by each of SciPy's methods.
USUAL = {
    "energy": 1e-3, "panels": 2e-4, "DOP853": 2e-4,
    "RK45": 4e-4, "RK23": 4e-4, "Radau": 5e-3, "LSODA": 5e-3, "BDF": 3.0,
}  # fmt: skip
ROUNDED = 2e-17  # of the largest energy in a step: what rounding alone makes
TOLD = 100.0  # times the usual
TELLS = "; energy_residual "
Energies = Callable[[float, float], tuple[float, float]]


def energy_residual(
    model: Model, accepted: Sequence[tuple[float, NDArray[np.float64]]]
) -> tuple[float, float]:
    """The energy error relative to the total work or the largest kinetic energy, and that of rounding alone.

    max |kinetic + potential - W - initial| over the accepted steps, with the energies of the generated
    quantities at theta and omega.
    """
    energies = _energies(model)
    rows = [(*energies(float(y[Q]), float(y[V])), float(y[W])) for _, y in accepted]
    rows = [row for row in rows if isfinite(sum(row))]
    if not rows:  # energies beyond every double
        return inf, 0.0
    first = sum(rows[0][:2])
    residual = max(abs(kinetic + potential - work - first) for kinetic, potential, work in rows)
    turned = sum(abs(b[2] - a[2]) for a, b in pairwise(rows))
    scale = max(turned, *(row[0] for row in rows), 0.0)
    if not scale:
        return 0.0, inf
    heaviest = max(abs(row[0] + row[1]) for row in rows)
    return residual / scale, ROUNDED * (len(rows) - 1) * (1.0 + heaviest / scale)


def _energies(model: Model) -> Energies:
    def energies(q: float, v: float) -> tuple[float, float]:
        theta, omega, branch = state_of(model, q, v)
        return model.kinetic_and_potential(theta, branch, omega)

    return energies


def told_of(residual: Any, rounded: Any, rtol: float, method: Any = "DOP853") -> str:
    """The end of a message: the largest of the residuals that are unusual at this rtol; "" if none is.

    residual, rounded, method   of one motion or, as arrays, of many; NaN where there is none
    """
    if rtol <= LEAST_RTOL:
        return ""
    several = np.atleast_1d(residual)
    usual = np.array([USUAL[way] for way in np.atleast_1d(method).tolist()])
    unusual = several > TOLD * (usual * rtol + np.atleast_1d(rounded))
    if not unusual.any():
        return ""
    count = f" at most, in {unusual.sum()} of {several.size} designs" if np.ndim(residual) else ""
    better = float(f"{max(rtol / TOLD, LEAST_RTOL):.3g}")
    return f"{TELLS}{several[unusual].max():.2g}{count}: repeat with rtol = {better:g}"
