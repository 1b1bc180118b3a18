"""`flywheel`: torque ripple and the inertia for a fluctuation of speed; deprecated for `drive`."""

from typing import Any

from ...mechanism.keywords import with_known_keywords
from ...mechanism.quantity_units import units_by_name
from ...peaks.peak import peak
from ...support.answer import Answer
from ...support.deprecation import deprecated
from ..turn.turn import cannot_turn
from .drive import design_of, fluctuation_of
from .inertia import flywheel_for


@with_known_keywords
def flywheel(*, fluctuation: float, branch: int = 1, **inputs: Any) -> dict[str, Any]:
    """Torque ripple over a turn, and the flywheel for a required fluctuation of speed.

    Deprecated: `drive` has the flywheel, its derivatives and the speed with it.

    fluctuation  (fastest - slowest)/mean speed that is allowed, such as 0.02
    inputs       of one design with masses and loads, as in `drive`

    Returns a dict:

    mean_torque, max_torque, min_torque   that the drive applies at constant speed [N m], the last two at
                                          `theta_max_torque` and `theta_min_torque` [rad]
    ripple                 largest less smallest torque [N m]
    energy_fluctuation     what a flywheel must store at constant speed [J]
    inertia                `flywheel_inertia` of `drive` [kg m2]
    inertia_first_order    energy_fluctuation/(fluctuation omega0^2) [kg m2], the textbook's estimate
    fluctuation_without    the fluctuation without a flywheel; infinite if the crank would stop, NaN with
                           friction
    theta_fastest, theta_slowest   where the crank turns fastest and slowest with it [rad]

    Raises as `drive` does, and ValueError where the crank cannot turn fully or friction jams.
    """
    deprecated("flywheel(...)", "drive(fluctuation=...)")
    required = fluctuation_of(fluctuation)
    design = design_of("flywheel", inputs, branch)
    if design.margin < 0.0:
        raise cannot_turn("flywheel", design)
    over = design.panels(["T_in"])
    torque = over.values["T_in"]
    mean = over.integral(torque) / design.angle
    stored = over.running(torque - mean)
    energy = over.extreme(stored, 1.0)[0] - over.extreme(stored, -1.0)[0]
    given: dict[str, Any] = {**design.numbers, **design.loads, "branch": design.branch, "theta": design.ends}
    high, low = (peak("T_in", kind=kind, **given) for kind in ("max", "min"))
    wheel = flywheel_for(design, required)
    if wheel is None:
        raise ValueError(f"flywheel: no inertia was found for fluctuation = {required:g}")
    found = {
        "mean_torque": mean,
        "max_torque": high["value"],
        "min_torque": low["value"],
        "theta_max_torque": high["theta"] % design.angle,
        "theta_min_torque": low["theta"] % design.angle,
        "ripple": high["value"] - low["value"],
        "energy_fluctuation": energy,
        "inertia": wheel.inertia,
        "inertia_first_order": energy / (required * design.numbers["omega0"] ** 2),
        "fluctuation_without": wheel.without,
        "theta_fastest": wheel.fastest % design.angle,
        "theta_slowest": wheel.slowest % design.angle,
    }
    return Answer(found, units_by_name)
