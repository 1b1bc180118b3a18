"""Why a design has no steady state: the motor is too weak, and where it stalls, or too strong."""

from math import degrees

import numpy as np

from ...mechanism.messages import Message, NamedValue, amount, listed
from ...mechanism.quantity_units import UnitSystem
from ...support.panels import Panels
from .designs import DesignRows, vanishing
from .scan import DEEP, Scan
from .states import States

SHARE = 0.01  # of the gain: less work of the loads is not worth a word
BALANCED = 1e-7  # of the work over a period: what of it counts as none


class AngleWithDegrees(NamedValue):
    """An angle, in degrees as well where its unit is another."""

    def text(self, system: UnitSystem | None = None) -> str:
        """The angle in the units of a system; in radians without."""
        text = super().text(system)
        return text if "deg" in text else f"{text} ({degrees(self.value):.0f} deg)"


def why_none(designs: DesignRows, states: States, k: int) -> str:
    """The message of a design without a stable steady state."""
    scan = states.scan
    gains, starts = scan.gains[k], scan.starts[k]
    if not np.isfinite(scan.turns.course.inertia[k]).all():
        return "no steady state: the crank cannot turn fully"
    if vanishing(designs)[k]:
        return (
            "no steady state: the effective inertia vanishes at a dead centre; give m_crank, I_crank or "
            "flywheel_inertia"
        )
    own = states.design == k
    if (own & states.jams).any():
        return "no steady state: the guide jams, friction leaves no balance of forces"
    rises = scan.rises()
    if (speeds := [_speed_of(scan, k, energy) for energy in rises.E0[rises.design == k]]) and not own.any():
        some = _each(speeds, ".2g")
        return "no steady state: below some " + some + " it slows down, above it runs away"
    there = np.isfinite(gains)
    if not (designs.source.varies or scan.turns.course.follow) and not designs.has_friction and there.any():
        return _of_number(designs, scan, k)
    if not there.any() or (gains[there] < 0.0).all():
        return "no steady state: the motor is too weak, " + _stall(designs, scan, k)
    last = np.flatnonzero(there)[-1]
    if abs(gains[last]) <= BALANCED * _work(scan, k):
        why = ", as at others, the motor balances the loads; its torque must fall over the speed there"
        return "no steady state of its own: at " + _speed(scan, k, starts[last]) + why
    if gains[last] < 0.0:
        first = there & (gains > 0.0)
        ends = _each([_speed_of(scan, k, e) for e in (starts[first].max(initial=0.0), starts[last])])
        return "a steady state between the speeds " + ends + " is not resolved"
    speed, gain = _speed(scan, k, starts[last]), _energy(gains[last])
    still = speed + " a period still gains " + gain + _driven(designs, scan, k, gains[last])
    return "no steady state: the motor is too strong, it runs away: at " + still


def _speed_of(scan: Scan, k: int, energy: float) -> float:
    return float(np.sqrt(2.0 * energy / scan.turns.mean_inertia[k]))


def _speed(scan: Scan, k: int, energy: float) -> Message:
    return amount("omega", _speed_of(scan, k, energy), ".6g", says_unit=True)


def _each(speeds: list[float], form: str = ".6g") -> Message:
    return listed([amount("omega", speed, form, says_unit=True) for speed in speeds])


def _energy(work: float, form: str = ".6g") -> Message:
    return amount("work", work, form, says_unit=True)


def _stall(designs: DesignRows, scan: Scan, k: int) -> str:
    """The angle where the crank stops, in the fastest turn that it does not finish."""
    gains, starts = scan.gains[k], scan.starts[k]
    stopped = np.flatnonzero(np.isnan(gains) & (starts > 0.0))
    if not len(stopped) and np.isnan(gains).all():
        return "it turns the crank at no speed"
    if not len(stopped):
        return "a period takes " + _energy(-np.nanmax(gains)) + " or more from the crank at any speed"
    stalled = np.isnan(scan.turns.rows(np.full(len(stopped), k)).path(starts[stopped], DEEP))
    if not stalled.any():
        return "it just does not get round"
    at = (int(np.argmax(stalled[stalled.any(1)][-1])) - 1) // 2
    x = float(0.5 * (scan.turns.edges[k, at] + scan.turns.edges[k, at + 1]))
    theta = float(designs.way[k]) * x
    return "it stalls near theta = " + Message(AngleWithDegrees("theta", theta, ".3g", says_unit=True))


def _work(scan: Scan, k: int) -> float:
    """The work of the loads over a period, of either sign."""
    return float(Panels(scan.turns.edges[k]).integral(np.abs(scan.turns.course.load[k])))


def _driven(designs: DesignRows, scan: Scan, k: int, gain: float) -> str:
    """That the loads drive the crank, where they do a share of what a period gains."""
    work = -float(designs.way[k] * Panels(scan.turns.edges[k]).integral(scan.turns.course.load[k]))
    if work <= SHARE * gain:
        return ""
    return "; the loads themselves drive the crank, " + _energy(work, ".4g") + " a period: check their signs"


def _of_number(designs: DesignRows, scan: Scan, k: int) -> str:
    """A torque that does not depend on the speed gains the same at every one."""
    gain = float(np.nanmedian(scan.gains[k]))
    if abs(gain) <= BALANCED * _work(scan, k):
        return (
            "no steady state of its own: the torque balances the loads at every speed; give the motor's "
            "torque over the speed"
        )
    way = "strong, it runs away" if gain > 0.0 else "weak, " + _stall(designs, scan, k)
    mean = amount("torque", gain / designs.period, ".6g", says_unit=True)
    rule = ": a torque that does not depend on the speed must balance the loads in the mean; this one gains "
    gained = _energy(gain) + " in a period at every speed, " + mean + " in the mean"
    return "no steady state: the motor is too " + way + rule + gained
