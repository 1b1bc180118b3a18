"""The derivatives of the torque that guide friction takes, at the side of the guide that the motion is on.

R = c sigma N_0/(1 - sigma mu s k), c = mu s Y', with N_0 the normal force without friction, s the sign of the
slider's velocity, sigma that of the normal force, k = branch tan(phi) (paper C, link 4). Next to a limit
angle two normal forces balance an acceleration that is given; the motion has the one of its own side.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.names import LENGTHS

Array = NDArray[np.float64]


class Signs(NamedTuple):
    """Signs of the slider's velocity and of the normal force, for each panel; and the branch."""

    slider: Array
    pressed: Array
    branch: float


def rubbing_slopes(
    values: Callable[[Sequence[str]], Mapping[str, Array]], mu: float, signs: Signs, by: Sequence[str]
) -> tuple[dict[str, Array], Array]:
    """The derivatives of R by these inputs, theta, omega and alpha among them; and R.

    values   quantities without friction along the motion
    """
    moving = [q for q in by if q in ("theta", *LENGTHS)]
    others = [q for q in by if q != "mu"]
    names = ["N_C", "phi", "Y_wrt_theta", *(f"N_C_wrt_{q}" for q in others)]
    found = values([*names, *(f"{n}_{q}" for n in ("phi_wrt", "Y_wrt_theta") for q in moving)])
    s, sigma = signs.slider[:, None], signs.pressed[:, None]
    lean, bend = signs.branch * np.tan(found["phi"]), signs.branch / np.cos(found["phi"]) ** 2
    room, normal, arm = 1.0 - sigma * mu * s * lean, found["N_C"], mu * s * found["Y_wrt_theta"]
    taken = arm * sigma * normal / room
    slopes: dict[str, Any] = {}
    for q in others:
        slopes[q] = arm * sigma * found[f"N_C_wrt_{q}"] / room
        if q in moving:
            slopes[q] = slopes[q] + sigma * mu * s * found[f"Y_wrt_theta_{q}"] * normal / room
            slopes[q] = slopes[q] + taken * sigma * mu * s * bend * found[f"phi_wrt_{q}"] / room
    if "mu" in by:
        slopes["mu"] = sigma * s * found["Y_wrt_theta"] * normal / room + taken * sigma * s * lean / room
    return slopes, taken
