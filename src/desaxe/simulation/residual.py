"""The energy residual of a motion, and a message where it is unusual: step control was deceived then."""

from math import inf
from typing import Any

import numpy as np

from .checks import LEAST_RTOL
from .march import March
from .result import LIMIT

# The usual residual, as a share of rtol: the median of many motions.
USUAL = 2e-4
ROUNDED = 2e-17  # of the largest energy in a step: what rounding alone makes
TOLD = 100.0  # times the usual
TELLS = "; energy_residual "


def energy_residual(run: March) -> tuple[float, float]:
    """The energy error relative to the total work or the largest kinetic energy, and that of rounding alone.

    max |kinetic + potential - W - initial| over the ends of panels, with the potential energy of the
    generated quantities.
    """
    ends = np.vstack([run.record.y, run.record.last])
    q, v, work = ends[: -1 if run.status == LIMIT else None].T  # at a limit Y has half its digits
    kinetic, potential = 0.5 * v * v, run.model.potential(run.model.coordinate.theta(q))
    known = np.isfinite(kinetic + potential + work)
    if not known.any():  # energies beyond every double
        return inf, 0.0
    kinetic, potential, work = kinetic[known], potential[known], work[known]
    energy = kinetic + potential
    residual = float(np.abs(energy - work - energy[0]).max())
    scale = max(float(np.abs(np.diff(work)).sum()), float(kinetic.max()))
    if not scale:
        return 0.0, inf
    return residual / scale, ROUNDED * (len(work) - 1) * (1.0 + float(np.abs(energy).max()) / scale)


def told_of(residual: Any, rounded: Any, rtol: float) -> str:
    """The end of a message: the largest of the residuals that are unusual at this rtol; "" if none is.

    residual, rounded   of one motion or, as arrays, of many; NaN where there is none
    """
    if rtol <= LEAST_RTOL:
        return ""
    several = np.atleast_1d(residual)
    unusual = several > TOLD * (USUAL * rtol + np.atleast_1d(rounded))
    if not unusual.any():
        return ""
    count = f" at most, in {unusual.sum()} of {several.size} designs" if np.ndim(residual) else ""
    better = float(f"{max(rtol / TOLD, LEAST_RTOL):.3g}")
    return f"{TELLS}{several[unusual].max():.2g}{count}: repeat with rtol = {better:g}"
