"""The inputs of the mechanism: what each is, its unit, its limits."""

from collections.abc import Iterator
from math import inf
from typing import Generic, NamedTuple, TypedDict, TypeVar

V = TypeVar("V")


class Input(NamedTuple):
    """An input: a finite number of at least `least`."""

    name: str
    unit: str
    meaning: str
    least: float | None = None
    limit: str = "a finite number"
    brief: str = ""  # its meaning where there is little room
    section: str = ""  # of a scene, in which it stands


class Inputs(TypedDict, Generic[V], total=False):
    """The inputs as keyword arguments, for editors and type checkers; a test compares them with INPUTS."""

    theta: V
    ec: V
    AB: V
    BC: V
    omega0: V
    alpha: V
    omega: V
    m_crank: V
    m_rod: V
    m_slider: V
    I_crank: V
    I_rod: V
    r_crank: V
    r_rod: V
    F_X: V
    F_Y: V
    g_X: V
    g_Y: V
    mu: V


TINY = 5e-324  # the least number that is more than nothing: a rod of 0 is no rod
# Sections of a scene with their inputs, in the order in which their names stand; name, unit, meaning, meaning
# where there is little room, limit. `tests/mechanism/test_inputs.py` has the other places of an input.
_TABLE = """
[motion]
theta | rad | crank angle, from the slider axis | crank angle
[mechanism]
ec | m | eccentricity: the slider axis is at X = -ec | eccentricity
AB | m | crank length | crank | >= 0
BC | m | length of the connecting rod | connecting rod | > 0
[motion]
omega0 | rad/s | angular speed of the crank at theta = 0 | speed
alpha | rad/s^2 | angular acceleration of the crank, constant | acceleration of the crank
omega | rad/s | angular speed of the crank at this instant, instead of omega0 | speed at this instant
[masses]
m_crank | kg | mass of the crank | mass of the crank | >= 0
m_rod | kg | mass of the connecting rod | mass of the rod | >= 0
m_slider | kg | mass of the slider | mass of the slider | >= 0
I_crank | kg*m^2 | moment of inertia of the crank about its centre of mass | inertia of the crank | >= 0
I_rod | kg*m^2 | moment of inertia of the rod about its centre of mass | inertia of the rod | >= 0
r_crank | m | from the crank centre towards the crank pin: the crank's centre of mass | crank's centre of mass
r_rod | m | from the crank pin towards the slider: the rod's centre of mass | rod's centre of mass
[loads]
F_X | N | external force on the slider along X | force on the slider along X
F_Y | N | external force on the slider along Y | force on the slider along Y
g_X | m/s^2 | gravity along X
g_Y | m/s^2 | gravity along Y
mu | 1 | Coulomb friction coefficient of the slider's guide | friction of the guide | >= 0
"""
_NOUNS = {"m": "length", "kg": "mass", "kg*m^2": "moment of inertia"}  # of a limit, by unit


def _read(table: str) -> Iterator[Input]:
    section = ""
    for line in table.strip().splitlines():
        if line.startswith("["):
            section = line.strip("[]")
            continue
        name, unit, meaning, brief, bound = [*line.split(" | "), "", ""][:5]
        least = {">= 0": 0.0, "> 0": TINY}.get(bound)
        limit = f"a finite {_NOUNS.get(unit, 'number')} {bound}" if bound else "a finite number"
        yield Input(name, unit, meaning, least, limit, brief or meaning, section)


INPUTS = {row.name: row for row in _read(_TABLE)}
# Of several sliders on one crankshaft; with an index but for the last.
OF_SHAFTS = {
    "phase": Input("phase", "rad", "lag of a slider's dead centre"),
    "bank": Input("bank", "rad", "angle of a slider's axis"),
    "firing": Input("firing", "rad", "start of the cycle of a slider's load"),
    "position": Input("position", "m", "from the middle of the shaft to a slider"),
    "I_shaft": Input("I_shaft", "kg*m^2", "moment of inertia of the shaft", 0.0, INPUTS["I_rod"].limit),
}
# Units of all inputs, and of results that are no quantities of the catalogue.
UNITS = {row.name: row.unit for row in (*INPUTS.values(), *OF_SHAFTS.values())} | {
    name: unit
    for unit, names in {
        "m/s": "V_outward V_inward",
        "rad": "theta0 until angle theta_intervals",
        "rad/s": "omega_start omega_mean synchronous_speed",
        "s": "t t_end t_last times period",
        "N*m": "torque torque_mean torque_rms torque_peak starting_torque flywheel_torque "
        "T_motor breakdown_torque C_inertia_X C_inertia_Y",
        "J": "work work_in work_out",
        "W": "power_mean power_peak",
        "kg*m^2": "flywheel_inertia",
        "1": "breakdown_slip gear",
        "m": "radius spacing free",
        "kg": "mass",
        "kg*m": "product",
    }.items()
    for name in names.split()
}  # fmt: skip
# Magnitudes between which nothing overflows, nor underflows to a wrong value. The least is that of the rod;
# what is much smaller vanishes beside it.
SAFE = 1e-60, 1e60
RANGE = "it must be of a magnitude of at most 1e+60"
RANGE_OF_ROD = "it must be a length from 1e-60 to 1e+60 m"
LEAST = {name: row.least for name, row in INPUTS.items() if row.least is not None}


def names_in(*sections: str) -> tuple[str, ...]:
    """The inputs of some sections of a scene, in their order."""
    return tuple(row.name for row in INPUTS.values() if row.section in sections)


def row_of(name: str) -> Input:
    """The row of an input, also of one slider of several: "AB[2]", "phase[1]"; KeyError for another name."""
    plain = name.partition("[")[0]
    return (INPUTS.get(plain) or OF_SHAFTS[plain])._replace(name=name)


def is_good(name: str, value: float) -> bool:
    """True for a valid value of this input, or of a kernel's input that a load gives."""
    least = LEAST.get(name)
    return -inf < value < inf and (least is None or least <= value) and not is_beyond(name, value)


def is_beyond(name: str, value: float) -> bool:
    """True for a finite number whose products would overflow, or vanish; an angle has no range."""
    least, most = SAFE
    return (name != "theta" and most < abs(value) < inf) or (name == "BC" and 0.0 < value < least)


def limit_of(name: str, value: float) -> str:
    """The limit of an input that a bad value exceeds, in words."""
    if is_beyond(name, value):
        return RANGE_OF_ROD if name == "BC" else RANGE
    return f"it must be {INPUTS[name].limit}"
