"""The outputs of the closed form of the dead centres, by name: numbers or arrays."""

from math import pi, ulp
from typing import Any

from ...mechanism.closed.dead_centres import PLACES, SENSITIVITIES
from ...mechanism.names import LENGTHS, WHOLE, sensitivity

VELOCITIES = {"V_outward": 1, "V_inward": -1}  # name -> direction along the stroke

BESIDE = 4.0 * ulp(pi)  # rad: next to an angle, on whichever side of it rounding has put that


class DesignEvents:
    """Values, their gradient, the angles of the extremes of the rod, and the status."""

    def __init__(self, outputs: tuple[Any, ...]) -> None:
        by_name = dict(zip((*WHOLE, *SENSITIVITIES, *PLACES), outputs, strict=False))
        self.status = outputs[-1]
        self.values = {name: by_name[name] for name in WHOLE}
        self.places = {name: by_name[name] for name in PLACES}
        self.gradient = {name: {p: by_name[sensitivity(name, p)] for p in LENGTHS} for name in WHOLE}


def stroke_ends(values: dict[str, Any], side: int, branch: int) -> tuple[Any, Any]:
    """The crank angles, ascending, between which Y grows (side 1) or falls (-1) as the angle does.

    At a change point the angle next to it within the stroke is meant: the speed jumps there. A slider whose
    crank is as long as its rod, in line with A, rests there for half of the turn.
    """
    outer, inner = values["theta_outer"], values["theta_inner"]
    jumps = values["Y_inner"] == 0.0
    within = BESIDE * jumps + (pi / 2) * (jumps & (values["advance_angle"] == pi))
    inner = inner + side * branch * within
    top, bottom = (outer, inner) if branch > 0 else (inner, outer)
    return (bottom - 2.0 * pi, top) if side > 0 else (top, bottom)
