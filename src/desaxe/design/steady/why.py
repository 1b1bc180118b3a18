"""Why a design has no steady state: the motor is too weak, and where it stalls, or too strong."""

from math import degrees

import numpy as np

from ...mechanism.messages import Message, NamedValue, amount, listed
from ...mechanism.quantity_units import UnitSystem
from ...support.panels import Panels
from .designs import DesignRows, picked, vanishing
from .scan import BALANCED, DEEP, Scan
from .states import States

SHARE = 0.01  # of the gain: less work of the loads is not worth a word
JAMS = "the guide jams, friction leaves no balance of forces"


class AngleWithDegrees(NamedValue):
    """An angle, in degrees as well where its unit is another."""

    def text(self, system: UnitSystem | None = None) -> str:
        """The angle in the units of a system; in radians without."""
        text = super().text(system)
        return text if "deg" in text else f"{text} ({degrees(self.value):.0f} deg)"


def why_none(designs: DesignRows, states: States, k: int) -> str:
    """The message of a design without a stable steady state."""
    scan, none = states.scan, "no steady state: "
    gains, starts, course = scan.gains[k], scan.starts[k], picked(scan.turns.course, k)
    there = np.isfinite(gains)

    def speed(energy: float, form: str = ".6g") -> Message:
        value = float(np.sqrt(2.0 * energy / scan.turns.inertia[k]))
        return amount("omega", value, form, says_unit=True)

    if not np.isfinite(course["inertia"]).all():
        return none + "the crank cannot turn fully"
    if vanishing(designs)[k]:
        cure = "give m_crank, I_crank or flywheel_inertia"
        return none + "the effective inertia vanishes at a dead centre; " + cure
    here = states.design == k
    if here.any() and states.figures["jams"][here].any():
        return none + JAMS
    rises = scan.brackets(-1.0)
    speeds = [speed(energy, ".2g") for energy in rises.E0[rises.design == k]]
    if speeds and not here.any():
        return none + "below some " + listed(speeds) + " it slows down, above it runs away"
    loads = Panels(scan.turns.edges[k])
    work, size = loads.integral(course["load"]), loads.integral(np.abs(course["load"]))
    if not (designs.source.varies or designs.following or designs.has_friction) and there.any():
        return _of_number(designs, scan, k, BALANCED * size)
    if not there.any() or (gains[there] < 0.0).all():
        return none + "the motor is too weak, " + _stall(designs, scan, k)
    last = np.flatnonzero(there)[-1]
    fastest, gain = speed(starts[last]), float(gains[last])
    if abs(gain) <= BALANCED * size:
        why = ", as at others, the motor balances the loads; its torque must fall over the speed there"
        return "no steady state of its own: at " + fastest + why
    if gain < 0.0:
        first = speed(starts[there & (gains > 0.0)].max(initial=0.0))
        return "a steady state between the speeds " + listed([first, fastest]) + " is not resolved"
    driven, drives = -float(designs.way[k] * work), Message("")
    if driven > SHARE * gain:
        said = "; the loads themselves drive the crank, " + _energy(driven, ".4g")
        drives = said + " a period: check their signs"
    return (
        none
        + "the motor is too strong, it runs away: at "
        + fastest
        + " a period still gains "
        + _energy(gain)
        + drives
    )


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
    stalled = np.isnan(picked(scan.turns, np.full(len(stopped), k)).path(starts[stopped], DEEP))
    if not stalled.any():
        return "it just does not get round"
    at = (int(np.argmax(stalled[stalled.any(1)][-1])) - 1) // 2
    theta = float(designs.way[k] * scan.turns.edges[k, at : at + 2].mean())
    return "it stalls near theta = " + Message(AngleWithDegrees("theta", theta, ".3g", says_unit=True))


def _of_number(designs: DesignRows, scan: Scan, k: int, least: float) -> str:
    """A torque that does not depend on the speed gains the same at every one."""
    gain = float(np.nanmedian(scan.gains[k]))
    if abs(gain) <= least:
        cure = "give the motor's torque over the speed"
        return "no steady state of its own: the torque balances the loads at every speed; " + cure
    way = "strong, it runs away" if gain > 0.0 else "weak, " + _stall(designs, scan, k)
    mean = amount("torque", gain / designs.period, ".6g", says_unit=True)
    rule = ": a torque that does not depend on the speed must balance the loads in the mean; this one gains "
    gained = _energy(gain) + " in a period at every speed, " + mean + " in the mean"
    return "no steady state: the motor is too " + way + rule + gained
