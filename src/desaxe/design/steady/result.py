"""The result of `steady`: which of the periodic motions it is, the others, and why there is none."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.quantity_units import SI, units_by_name
from ...support.answer import Answer
from ...support.forks import IMPORTS
from .designs import DesignRows
from .figures import KEYS, STEPS
from .source import source_of
from .states import States, main_of
from .why import why_none

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
    found = _empty(int(np.prod(shape)), max((part for _, part, *_ in parts), key=lambda part: part.size))
    for index, designs, states, wheel in parts:
        _fill(found, index, designs, states, wheel)
    result = Steady(_shaped(found, shape) if shape else _first(found), _units)
    result.inputs, result.torque, result.branch = about["inputs"], about["torque"], about["branch"]
    return result


def _units(found: Mapping[str, Any]) -> dict[str, Any]:
    """The units of a steady state, and of the others."""
    units = units_by_name(found)
    return {**units, "others": units}


def _empty(count: int, designs: DesignRows) -> dict[str, Any]:
    """Rows of designs with bad inputs."""
    steps = STEPS * designs.turns + 1
    nothing = {name: np.full((count, steps), np.nan) for name in COURSE}
    objects = {"others": np.empty(count, object), "message": np.full(count, "bad input", object)}
    objects["others"][:] = [[] for _ in range(count)]
    return {
        **nothing, **{name: np.full(count, np.nan) for name in NUMBERS}, "stable": np.zeros(count, bool),
        "gradient": {key: {} for key in KEYS}, "flywheel_inertia": np.full(count, np.nan),
        "others": objects["others"], "status": np.full(count, 4, np.int8), "message": objects["message"],
    }  # fmt: skip


def _fill(found: dict[str, Any], index: Array, designs: DesignRows, states: States, wheel: bool) -> None:
    """The results of some designs."""
    main = main_of(states, designs.size)
    there = np.flatnonzero(main >= 0)
    rows, into = main[there], index[there]
    found["theta"][index] = designs.theta(np.linspace(0.0, designs.period, found["theta"].shape[1])[None])
    found["flywheel_inertia"][index] = np.where((main < 0) & wheel, np.nan, designs.J)
    found["status"][index], found["status"][into] = 1, 0
    found["message"][into] = "ok"
    for k in np.flatnonzero(main < 0).tolist():
        found["message"][index[k]] = why_none(designs, states, k)
    for row in np.argsort(-np.abs(states.figures.values.get("omega_mean", np.empty(0))), kind="stable"):
        k = states.design[row]
        if row != main[k]:
            found["others"][index[k]].append(_other(states, row, float(designs.J[k])))
    if not len(there):
        return
    for name, values in (*states.course.items(), *states.figures.values.items()):
        found[name][into] = values[rows]
    gradient = {key: {p: v[rows] for p, v in by.items()} for key, by in states.figures.gradient.items()}
    if wheel:
        gradient["flywheel_inertia"] = _of_wheel(gradient["fluctuation"], designs.J[there])
    for key, by in gradient.items():
        own = found["gradient"].setdefault(key, {})
        for p, slopes in by.items():
            own.setdefault(p, np.full(len(found["status"]), np.nan))[into] = slopes


def _other(states: States, row: int, J: float) -> dict[str, Any]:
    """A periodic motion that is not the one of its design."""
    figures, jams = states.figures, bool(states.jams[row])
    return {
        **{name: states.course[name][row] for name in COURSE},
        **{name: v[row].item() for name, v in figures.values.items()},
        "gradient": {key: {p: float(v[row]) for p, v in by.items()} for key, by in figures.gradient.items()},
        "flywheel_inertia": J, "others": [], "status": 1 if jams else 0,
        "message": "the guide jams, friction leaves no balance of forces" if jams else "ok",
    }  # fmt: skip


def _of_wheel(by: Mapping[str, Array], J: Array) -> dict[str, Array]:
    """The derivatives of the flywheel that keeps a fluctuation, from those of the fluctuation."""
    own = by["flywheel_inertia"]
    slopes = {p: np.where(J > 0.0, -v / own, 0.0) for p, v in by.items() if p != "flywheel_inertia"}
    return {**slopes, "fluctuation": np.where(J > 0.0, 1.0 / own, 0.0)}


def _shaped(values: Any, shape: tuple[int, ...]) -> Any:
    """Rows in the shape of the designs."""
    if isinstance(values, dict):
        return {name: _shaped(value, shape) for name, value in values.items()}
    return values.reshape(*shape, *values.shape[1:])


def _first(values: Any) -> Any:
    """The only row, as plain numbers and arrays."""
    if isinstance(values, dict):
        return {name: _first(value) for name, value in values.items()}
    return values[0].item() if values.dtype != object and values.ndim == 1 else values[0]
