"""Names of sensitivities: `a_C_wrt_ec_BC` is the quantity `a_C` by the parameters `ec` and `BC`.

Parameters stand in one order. A parameter may have an underscore in its own name, so names are
taken apart and put together here and nowhere else.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import TYPE_CHECKING

from ..support.forks import IMPORTS
from .inputs import INPUTS, names_in

if TYPE_CHECKING:
    from ..units.dimensions import Unit

# Geometry and motion; then the bodies and what acts on them, which only forces and energies need.
LENGTHS = ("ec", "AB", "BC")
PARAMETERS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
LOADS = names_in("masses", "loads")
MASSES = tuple(name for name in LOADS if INPUTS[name].unit in ("kg", "kg*m^2"))
# A status: that of the motion, that of a request for forces, that of a design; shown by the same name.
STATUS, FORCE_STATUS, TURN_STATUS = STATUSES = ("status", "force_status", "turn_status")
# Quantities of a whole design, of its lengths alone: no theta, no speed.
WHOLE = (
    "stroke", "time_ratio", "advance_angle", "return_angle", "Y_outer", "Y_inner", "theta_outer",
    "theta_inner", "max_pressure_angle", "min_transmission_angle", "min_pressure_angle",
    "max_transmission_angle",
)  # fmt: skip
# What the library requests beside the names of a user: no quantity of his own is called so.
INTERNAL = (
    FORCE_STATUS, TURN_STATUS, "wide_margins", "undecided", "less_rounded", "less_unsure", "no_effect_on_rod",
    "not_stalled",
)  # fmt: skip
CENTRES = ("r_crank", "r_rod")  # half of AB and of BC where they are not given
# The order in which parameters stand in a name; omega, of a given state, stands in omega0's place.
ORDER = ("theta", "ec", "AB", "BC", "omega0", "omega", "alpha", *LOADS)
RANK = {name: place for place, name in enumerate(ORDER)}
_JOINT = "_wrt_"


@lru_cache(maxsize=4096)
def parts(name: str) -> tuple[str, tuple[str, ...]]:
    """The quantity and the parameters of a name: `("a_C", ("ec", "BC"))`.

    What follows `_wrt_` and is no parameter stays whole, as a parameter that nobody knows.
    """
    base, joint, rest = name.partition(_JOINT)
    result: list[str] = []
    while joint and rest:
        known = [p for p in ORDER if rest == p or rest.startswith(f"{p}_")]
        parameter = max(known, key=len, default=rest)
        result.append(parameter)
        rest = rest[len(parameter) + 1 :]
    return base, tuple(result)


@lru_cache(maxsize=4096)
def sensitivity(name: str, *parameters: str) -> str:
    """The name of the derivative of a name by more parameters, in their order; unknown ones last."""
    base, before = parts(name)
    return joined(base, sorted((*before, *parameters), key=lambda p: RANK.get(p, len(ORDER))))


def joined(base: str, parameters: Iterable[str]) -> str:
    """A quantity and parameters, in the order given, as one name."""
    wrt = "_".join(parameters)
    return f"{base}{_JOINT}{wrt}" if wrt else base


def per(unit: "Unit", *parameters: str) -> "Unit":
    """The unit of a derivative with respect to these parameters."""
    with IMPORTS:
        from ..units.parse import coherent_unit

    for parameter in parameters:
        unit = unit.times(coherent_unit(INPUTS[parameter].unit), -1)
    return unit
