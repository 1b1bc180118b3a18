"""The outputs of the closed form of the dead centres, by name: numbers or arrays."""

from math import copysign, inf, pi, ulp
from typing import Any

from ...evaluation.evaluate import evaluate
from ...mechanism.closed.dead_centres import PLACES, SENSITIVITIES
from ...mechanism.names import LENGTHS, WHOLE, sensitivity
from ...support.roots import root

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


def _stroke_ends(values: dict[str, Any], side: int, branch: int) -> tuple[Any, Any]:
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


def velocity(
    direction: int, values: dict[str, Any], branch: int, omega: float, lengths: dict[str, Any], sharp: bool
) -> list[float]:
    """The largest |V_C| between two dead centres: value, crank angle, derivatives by lengths and omega0.

    sharp   one of them is a change point: if it is fastest there, that grows as a root of the margin
    """

    def at(theta: float, name: str, omega0: float = 1.0) -> float:
        return float(evaluate(name, theta=theta, omega0=omega0, branch=branch, **lengths))

    side = direction * branch  # of Y
    first, last = ends = _stroke_ends(values, -side if omega < 0.0 else side, branch)
    if at(first, "a_C") * at(last, "a_C") < 0.0:
        theta, sharp = root(lambda angle: at(angle, "a_C"), first, last), False
    else:  # no crank, or it is fastest at the change point itself
        theta = max(ends, key=lambda angle: abs(at(angle, "V_C")))
    value, *slopes = (
        side * at(theta, n, omega) for n in ("V_C", *(f"V_C_wrt_{p}" for p in (*LENGTHS, "omega0")))
    )
    if sharp and value:
        slopes[:3] = [copysign(inf, slope) for slope in slopes[:3]]
    return [value, float(in_turn(theta)), *slopes]


def in_turn(theta: Any) -> Any:
    """The angle shifted into the turn from -pi/2 to 3 pi/2."""
    return theta + 2.0 * pi * (theta < -pi / 2) - 2.0 * pi * (theta > 1.5 * pi)
