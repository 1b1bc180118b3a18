"""The kernels that are committed: which outputs each of them has."""

from typing import NamedTuple

from desaxe.mechanism.names import PARAMETERS, sensitivity


class Group(NamedTuple):
    """A kernel module of generated/."""

    name: str
    what: str
    outputs: tuple[str, ...]
    fixed: tuple[tuple[str, float], ...] = ()  # inputs that do not matter here
    two_forms: bool = True  # shorter formulas for wide margins; beside arc tangents they save nothing


LENGTHS = PARAMETERS[:4]
KINEMATICS = ("Y", "V_C", "a_C")
ROD_ANGLES = ("phi", "delta", "transmission_angle", "pressure_angle")
ROD_RATES = ("omega_BC", "alpha_BC")


def first(name: str) -> tuple[str, ...]:
    """A quantity's first sensitivities: a position has none by the motion."""
    parameters = PARAMETERS if name in ("V_C", "a_C", *ROD_RATES) else LENGTHS
    return tuple(sensitivity(name, p) for p in parameters)


JOINTS = tuple(f"F_{joint}_{axis}" for joint in "ABC" for axis in "XY")
GUIDE = ("N_C", "F_friction")
FRAME = ("F_shaking_X", "F_shaking_Y", "M_shaking")

GROUPS = (
    Group(
        "position",
        "position of the slider and angles of the rod",
        ("Y", "s", *ROD_ANGLES, "margin", "status"),
        (("omega0", 0.0), ("alpha", 0.0)),
        two_forms=False,
    ),
    Group("motion", "position, velocity and acceleration of the slider", KINEMATICS),
    Group(
        "sensitivities",
        "position, velocity and acceleration of the slider with all first sensitivities",
        (*KINEMATICS, *(name for quantity in KINEMATICS for name in first(quantity))),
    ),
    Group(
        "rod",
        "angles, speed and acceleration of the rod with all first sensitivities",
        (
            *(*ROD_ANGLES, *ROD_RATES),
            *(name for quantity in (*ROD_ANGLES, *ROD_RATES) for name in first(quantity)),
        ),
        two_forms=False,
    ),
    Group(
        "forces",
        "torque, forces at the joints, the guide and on the frame, with their status",
        ("T_in", *JOINTS, *GUIDE, *FRAME, "status"),
    ),
)
