"""[steady] of a scene: the machine on its motor, and its steady states, labelled."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...design.steady.result import NUMBERS, Steady
from ...design.steady.steady import FLUCTUATION, FLYWHEEL, steady
from ...evaluation.labels import input_attributes
from ...loads.load import Load
from ...loads.motors import Motor
from ...mechanism.inputs import OTHERS, Input
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import SteadyStatus
from ..reading.loads import motor_of
from ..reading.values import Value, read_number
from ..schema import SceneError, shown
from ..setting import PlanRow, Setting

if TYPE_CHECKING:
    import xarray as xr

SPEEDS = ("omega0", "omega", "alpha")  # of which the way of turning counts alone
TORQUE = Input("torque", "N*m", "", None, "a finite torque")
ROWS = {"flywheel_inertia": FLYWHEEL, "fluctuation": FLUCTUATION}
MEANINGS = {
    "period": "time of a period", "omega_mean": "mean speed of the crank",
    "fluctuation": "fastest less slowest over mean speed", "power_mean": "mean power of the motor",
    "work": "work of the motor in a period", "multiplier": "share of a change of energy left a period later",
    "flywheel_inertia": "flywheel, added at the crank",
    "status": "; ".join(f"{status:d} {status.words}" for status in SteadyStatus),
}  # fmt: skip


@dataclass(frozen=True)
class OnMotor:
    """The steady states on a motor, for the outer product of `axes` with everything else fixed."""

    torque: Any
    axes: dict[str, tuple[float, ...]]
    fixed: dict[str, Value]
    seeks: bool  # the flywheel for a fluctuation

    @property
    def work(self) -> PlanRow:
        """A periodic motion for each design."""
        designs = prod(len(values) for values in self.axes.values())
        how = "periodic motions by Newton's method, in NumPy"
        return PlanRow("steady state on a motor", designs, "designs", how)


class MotorResult(NamedTuple):
    """The steady states of all designs, labelled.

    `dataset` has over the designs' dimensions: `omega_mean`, `period`, `fluctuation`, `power_mean`, `work`,
    `multiplier`, `flywheel_inertia`, `status`. `found` is what `desaxe.steady` gave [SI].
    """

    asked: OnMotor
    dataset: "xr.Dataset"
    found: Steady


def on_motor(
    table: Mapping[str, Any], inputs: Mapping[str, Value], units: UnitSystem, folder: Path | None
) -> OnMotor:
    """The machine of a [steady] on its motor, which may be a Motor, or on a torque."""
    for name in LENGTHS:
        if name not in inputs:
            raise SceneError(f"steady: {name} is missing: give mechanism.{name}")
    torque = table["torque"]
    if isinstance(torque, Mapping):
        torque = motor_of("steady.torque", torque, folder, units)
    elif not isinstance(torque, (Motor, Load)):
        torque = _number("torque", TORQUE, torque, units)
    speeds = {n: v for n, v in inputs.items() if n in SPEEDS}
    given = {n: v for n, v in inputs.items() if n != "theta" and n not in SPEEDS}
    for name, row in ROWS.items():
        written = table.get(name)
        if isinstance(written, list):
            numbered = enumerate(written, 1)
            given[name] = tuple(_number(f"{name} #{k}", row, part, units) for k, part in numbered)
        elif written is not None:
            given[name] = _number(name, row, written, units)
    if np.any(np.asarray(speeds.pop("alpha", 0.0), float)):
        raise SceneError("motion.alpha: a steady state has its own course of the speed; leave it out")
    signs = {float(np.sign(v)) for value in speeds.values() for v in np.ravel(np.asarray(value, float))}
    if len(signs) > 1:
        raise SceneError("steady: the speeds of [motion] turn the crank both ways; give one way of turning")
    if signs - {0.0}:
        given["omega0"] = signs.pop()
    given.setdefault("flywheel_inertia", 0.0)
    axes = {n: v for n, v in given.items() if isinstance(v, tuple)}
    return OnMotor(torque, axes, {n: v for n, v in given.items() if n not in axes}, "fluctuation" in table)


def _number(key: str, row: Input, written: Any, units: UnitSystem) -> float:
    number = read_number(row, f"steady.{key}", written, units)
    if row is FLUCTUATION and number >= 2.0:
        raise SceneError(f"steady.{key} = {shown(written)}: it must be {row.limit}")
    return number


def steady_of(asked: OnMotor, setting: Setting) -> MotorResult:
    """The steady states of all designs, together."""
    arrays = np.meshgrid(*(np.asarray(v) for v in asked.axes.values()), indexing="ij") if asked.axes else []
    given: dict[str, Any] = {**asked.fixed, **dict(zip(asked.axes, arrays, strict=True))}
    result = steady(torque=asked.torque, branch=setting.branch, **given)
    names = [*NUMBERS, "flywheel_inertia", "status"]
    values = {n: (result[n], {"units": OTHERS.get(n, "1"), "long_name": MEANINGS[n]}) for n in names}
    about = {"torque": repr(asked.torque)}
    dataset = setting.labelled(values, asked.axes, asked.fixed, about, _attributes)
    return MotorResult(asked, dataset, result)


def _attributes(name: str) -> dict[str, str]:
    if name not in ROWS:
        return input_attributes(name)
    return {"units": ROWS[name].unit, "long_name": MEANINGS[name]}
