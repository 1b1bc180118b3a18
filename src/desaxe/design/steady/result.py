"""The result of `steady`: which of the periodic motions it is, the others, and why there is none."""

from collections.abc import Callable, Mapping, Sequence
from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.messages import Message, NamedValue, amount, listed
from ...mechanism.quantity_units import SI, UnitSystem, units_by_name
from ...support.answer import Answer
from ...support.forks import IMPORTS
from ...support.panels import Panels
from .designs import DesignRows, picked, vanishing
from .figures import KEYS, STEPS
from .scan import BALANCED, DEEP, Scan
from .source import source_of
from .states import States

Array = NDArray[Any]
NUMBERS = ("period", "omega_mean", "fluctuation", "power_mean", "work", "multiplier")
CURVE, POINTS = 1.25, 400  # times the highest speed, of the motor's curve
COURSE = ("theta", "omega", "T_motor")
Part = tuple[Array, DesignRows, States, bool]  # whether the flywheel was looked for


class Steady(Answer):
    """The figures by name; `plot()`.

    `inputs` are those of the design in SI units, `torque` is the motor.
    """

    torque: Any = None
    branch: int = 1

    def motor_curve(self) -> tuple[Array, Array] | None:
        """Speeds and torques of the motor in SI units; None where the angle counts, or of an array."""
        source = source_of(self.torque)
        if np.ndim(self["period"]) or not source.varies or not source.of_speed_alone:
            return None
        row = {name: float(value) for name, value in source.numbers.items()}
        system = self.system or SI
        ends = [system.of("omega").to_si(end) for end in (self["omega"].min(), self["omega"].max())]
        way = np.sign(ends[1] + ends[0])
        speed = np.linspace(0.0, way * max(CURVE * abs(end) for end in ends), POINTS)
        return speed, np.asarray(source.both(np.zeros_like(speed), speed, row)[0])

    def plot(self, ax: Any = None) -> Any:
        """Speed and torque over a period, and the loop on the motor's curve: see `desaxe.plot.steady`."""
        with IMPORTS:
            from ...plot import steady

        return steady(self, ax=ax)


def result_of(shape: tuple[int, ...], parts: Sequence[Part], about: Mapping[str, Any]) -> Steady:
    """The result in the shape of the designs."""
    rows = _empty(int(np.prod(shape)), max((part for _, part, *_ in parts), key=lambda part: part.size))
    for index, designs, states, wheel in parts:
        _fill(rows, index, designs, states, wheel)
    result = Steady(
        _mapped(rows, lambda v: v.reshape(*shape, *v.shape[1:]) if shape else _plain(v[0])), _units
    )
    result.inputs, result.torque, result.branch = about["inputs"], about["torque"], about["branch"]
    return result


def _units(result: Mapping[str, Any]) -> dict[str, Any]:
    """The units of a steady state, and of the others."""
    units = units_by_name(result)
    return {**units, "others": units}


def _empty(count: int, designs: DesignRows) -> dict[str, Any]:
    """Rows of designs with bad inputs."""
    steps, others = STEPS * designs.turns + 1, np.empty(count, object)
    others[:] = [[] for _ in range(count)]
    return {
        "status": np.full(count, 4, np.int8), "message": np.full(count, "bad input", object),
        **{name: np.full(count, np.nan) for name in (*NUMBERS, "flywheel_inertia")},
        "stable": np.zeros(count, bool), "others": others,
        **{name: np.full((count, steps), np.nan) for name in COURSE}, "gradient": {key: {} for key in KEYS},
    }  # fmt: skip


def _fill(rows: dict[str, Any], index: Array, designs: DesignRows, states: States, wheel: bool) -> None:
    """The results of some designs."""
    best = states.fastest()
    there = np.flatnonzero(best >= 0)
    into = index[there]
    rows["theta"][index] = designs.theta(np.linspace(0.0, designs.period, rows["theta"].shape[1])[None])
    rows["flywheel_inertia"][index] = np.where((best < 0) & wheel, np.nan, designs.J)
    rows["status"][index], rows["status"][into], rows["message"][into] = 1, 0, "ok"
    for k in np.flatnonzero(best < 0).tolist():
        rows["message"][index[k]] = why_none(designs, states, k)
    for row in np.argsort(-np.abs(states.figures["omega_mean"]), kind="stable") if len(states.design) else ():
        k = states.design[row]
        if row != best[k]:
            rows["others"][index[k]].append(_other(_motion(states, row), float(designs.J[k])))
    if not len(there):
        return
    motion = _motion(states, best[there])
    gradient = motion.pop("gradient")
    if wheel:
        gradient["flywheel_inertia"] = _of_wheel(gradient["fluctuation"], designs.J[there])
    for name in (*COURSE, *NUMBERS, "stable"):
        rows[name][into] = motion[name]
    for key, by in gradient.items():
        whole = rows["gradient"].setdefault(key, {})
        for p, slopes in by.items():
            whole.setdefault(p, np.full(len(rows["status"]), np.nan))[into] = slopes


def _motion(states: States, row: Any) -> dict[str, Any]:
    """The figures of motions, their gradient as a dict of dicts."""
    figures: dict[str, Any] = {"gradient": {key: {} for key in KEYS}}
    for key, values in states.figures.items():
        into, name = (figures["gradient"][key[0]], key[1]) if isinstance(key, tuple) else (figures, key)
        into[name] = values[row]
    return figures


def _other(motion: dict[str, Any], J: float) -> dict[str, Any]:
    """A periodic motion that is not the one of its design."""
    jams = motion["jams"]
    figures = _mapped({n: motion[n] for n in (*NUMBERS, "stable", *COURSE, "gradient")}, _plain)
    return {
        "status": int(jams),
        "message": JAMS if jams else "ok",
        "flywheel_inertia": J,
        "others": [],
        **figures,
    }


def _of_wheel(by: Mapping[str, Array], J: Array) -> dict[str, Array]:
    """The derivatives of the flywheel that keeps a fluctuation, from those of the fluctuation."""
    steep = by["flywheel_inertia"]
    slopes = {p: np.where(J > 0.0, -v / steep, 0.0) for p, v in by.items() if p != "flywheel_inertia"}
    return {**slopes, "fluctuation": np.where(J > 0.0, 1.0 / steep, 0.0)}


def _mapped(values: Any, function: Callable[[Any], Any]) -> Any:
    """A mapping of mappings of arrays with a function of each array."""
    return {n: _mapped(v, function) if isinstance(v, dict) else function(v) for n, v in values.items()}


def _plain(value: Any) -> Any:
    """A NumPy number as one of Python; arrays as they are."""
    return value.item() if isinstance(value, np.generic) else value


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
