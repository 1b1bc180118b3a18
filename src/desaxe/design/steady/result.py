"""The result of `steady`: which of the periodic motions it is, the others, and why there is none."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.unit_system import SI
from ...support.answer import Answer
from ...support.forks import IMPORTS
from .designs import Designs
from .figures import KEYS, STEPS
from .source import source_of
from .states import States, main_of
from .why import why_none

Array = NDArray[Any]
NUMBERS = ("period", "omega_mean", "fluctuation", "power_mean", "work", "multiplier")
CURVE, POINTS = 1.25, 400  # times the highest speed, of the motor's curve
COURSE = ("theta", "omega", "T_motor")
Part = tuple[Array, Designs, States, bool]  # whether the flywheel was looked for


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
        system = self.units or SI
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
    rows: list[dict[str, Any]] = [bad_row() for _ in range(int(np.prod(shape)))]
    for index, designs, states, wheel in parts:
        for k, row in enumerate(_rows(designs, states, wheel)):
            rows[index[k]] = row
    found = rows[0] if not shape else _stacked(rows, shape)
    result = Steady(found)
    result.inputs, result.torque, result.branch = about["inputs"], about["torque"], about["branch"]
    return result


def bad_row() -> dict[str, Any]:
    """A design with a bad input."""
    return _empty(4, "bad input", 1, 1.0)


def _empty(status: int, message: str, turns: int, way: float) -> dict[str, Any]:
    theta = way * np.linspace(0.0, 2.0 * np.pi * turns, STEPS * turns + 1)
    nothing = np.full_like(theta, np.nan)
    return {
        "theta": theta, "omega": nothing, "T_motor": nothing.copy(), **dict.fromkeys(NUMBERS, np.nan),
        "stable": False, "gradient": {key: {} for key in KEYS}, "flywheel_inertia": np.nan, "others": [],
        "status": status, "message": message,
    }  # fmt: skip


def _rows(designs: Designs, states: States, wheel: bool) -> list[dict[str, Any]]:
    """The results of designs."""
    main = main_of(states, designs.size)
    order = np.argsort(-np.abs(states.figures.values.get("omega_mean", np.empty(0))), kind="stable")
    others: list[list[dict[str, Any]]] = [[] for _ in range(designs.size)]
    for row in order:
        k = states.design[row]
        if row != main[k]:
            others[k].append(_one(states, row) | {"flywheel_inertia": float(designs.J[k])})
    found = []
    for k, row in enumerate(main):
        if row < 0:
            one = _empty(1, why_none(designs, states, k), designs.turns, float(designs.way[k]))
        else:
            one = _one(states, row)
            if wheel:
                one["gradient"]["flywheel_inertia"] = _of_wheel(one["gradient"]["fluctuation"], designs.J[k])
        found.append(one | {"flywheel_inertia": float(designs.J[k]), "others": others[k]})
    return found


def _one(states: States, row: int) -> dict[str, Any]:
    """One periodic motion."""
    figures = states.figures
    gradient = {key: {p: float(v[row]) for p, v in by.items()} for key, by in figures.gradient.items()}
    values = {name: v[row].item() for name, v in figures.values.items()}
    jams = bool(states.jams[row])
    return {
        **{name: states.course[name][row] for name in COURSE}, **values, "gradient": gradient,
        "flywheel_inertia": np.nan, "others": [], "status": 1 if jams else 0,
        "message": "the guide jams, friction leaves no balance of forces" if jams else "ok",
    }  # fmt: skip


def _of_wheel(by: Mapping[str, float], J: float) -> dict[str, float]:
    """The derivatives of the flywheel that keeps a fluctuation, from those of the fluctuation."""
    own = by["flywheel_inertia"]
    slopes = {p: -slope / own if J else 0.0 for p, slope in by.items() if p != "flywheel_inertia"}
    return {**slopes, "fluctuation": 1.0 / own if J else 0.0}


def _stacked(rows: list[dict[str, Any]], shape: tuple[int, ...]) -> dict[str, Any]:
    """The results of designs as arrays."""
    found: dict[str, Any] = {}
    longest = max(rows, key=lambda row: len(row["theta"]) * (row["status"] != 4))
    for name in rows[0]:
        if name == "gradient":
            continue
        if name in COURSE:
            full = [row[name] if row["status"] != 4 else longest[name] * np.nan for row in rows]
            found[name] = np.reshape(full, (*shape, -1))
        elif name in ("others", "message"):
            objects = np.empty(len(rows), object)
            objects[:] = [row[name] for row in rows]
            found[name] = objects.reshape(shape)
        else:
            found[name] = np.array([row[name] for row in rows]).reshape(shape)
    found["status"] = found["status"].astype(np.int8)
    fullest = max((row["gradient"] for row in rows), key=lambda by: (len(by), len(by["period"])))
    gradient = {
        key: {
            p: np.array([row["gradient"].get(key, {}).get(p, np.nan) for row in rows]).reshape(shape)
            for p in by
        }
        for key, by in fullest.items()
    }
    order = ("theta", "omega", "T_motor", *NUMBERS, "stable")
    return {**{n: found.pop(n) for n in order}, "gradient": gradient, **found}
