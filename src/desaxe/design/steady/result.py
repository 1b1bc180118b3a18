"""The result of `steady`: which of the periodic motions it is, the others, and why there is none."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.quantity_units import SI, units_by_name
from ...support.answer import Answer
from ...support.forks import IMPORTS
from .designs import DesignRows
from .figures import KEYS, STEPS
from .source import source_of
from .states import States
from .why import JAMS, why_none

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
        **{name: np.full((count, steps), np.nan) for name in COURSE},
        **{name: np.full(count, np.nan) for name in NUMBERS}, "stable": np.zeros(count, bool),
        "gradient": {key: {} for key in KEYS}, "flywheel_inertia": np.full(count, np.nan), "others": others,
        "status": np.full(count, 4, np.int8), "message": np.full(count, "bad input", object),
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
    return {
        **_mapped({n: motion[n] for n in (*COURSE, *NUMBERS, "stable", "gradient")}, _plain),
        "flywheel_inertia": J, "others": [], "status": int(jams), "message": JAMS if jams else "ok",
    }  # fmt: skip


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
