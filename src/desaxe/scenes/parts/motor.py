"""[steady] of a scene: the machine on its motor, and its steady states, labelled."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...design.steady.result import NUMBERS, Steady
from ...design.steady.steady import FLUCTUATION, FLYWHEEL, steady
from ...evaluation.labels import import_xarray, input_attributes, tell_loads
from ...loads.load import Load
from ...loads.motors import MakeKloss, MakeOverOmega, Motor, over_omega
from ...loads.resolve import settled
from ...mechanism.inputs import Input
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import OTHERS, UnitSystem
from ...mechanism.status import SteadyStatus
from ...scenes import schema
from ...support.extras import MissingExtraError
from ...support.forks import IMPORTS
from ..reading.loads import file_of
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
    table: schema.SteadyTable,
    torque: Any,
    inputs: Mapping[str, Value],
    units: UnitSystem,
    folder: Path | None,
) -> OnMotor:
    """The machine of a [steady] on its motor; `torque` as it stands in the scene, perhaps a Motor."""
    for name in LENGTHS:
        if name not in inputs:
            raise SceneError(f"steady: {name} is missing: give mechanism.{name}")
    motor = torque if isinstance(torque, Motor) else _motor(table.torque, units, folder)
    given = {n: v for n, v in inputs.items() if n != "theta" and n not in SPEEDS}
    given |= {
        name: _numbers(name, written, units) for name in ROWS if (written := getattr(table, name)) is not None
    }
    speeds = {n: v for n, v in inputs.items() if n in SPEEDS}
    if np.any(np.asarray(speeds.get("alpha", 0.0), float)):
        raise SceneError("motion.alpha: a steady state has its own course of the speed; leave it out")
    speed = np.sign(np.ravel([np.asarray(v, float) for n, v in speeds.items() if n != "alpha"]))
    if speed.size and (speed != speed[0]).any():
        raise SceneError("steady: the speeds of [motion] turn the crank both ways; give one way of turning")
    given |= {"omega0": float(speed[0])} if speed.size and speed[0] else {}
    axes = {n: v for n, v in given.items() if isinstance(v, tuple)}
    fixed = {n: v for n, v in given.items() if n not in axes}
    return OnMotor(motor, axes, fixed, table.fluctuation is not None)


def _numbers(name: str, written: Any, units: UnitSystem) -> Any:
    """A number, or several, of the flywheel or the fluctuation."""
    if isinstance(written, tuple):
        return tuple(_number(f"{name} #{k}", ROWS[name], part, units) for k, part in enumerate(written, 1))
    return _number(name, ROWS[name], written, units)


def _number(key: str, row: Input, written: Any, units: UnitSystem) -> float:
    try:
        number = read_number(row, f"steady.{key}", written, units)
    except TypeError:
        raise SceneError(f"steady.{key} = {shown(written)}: it must be {row.limit}") from None
    if row is FLUCTUATION and number >= 2.0:
        raise SceneError(f"steady.{key} = {shown(written)}: it must be {row.limit}")
    return number


def _motor(written: Any, units: UnitSystem, folder: Path | None) -> Any:
    """The motor, or the number, of a torque as it stands in a scene."""
    if not isinstance(written, schema.MotorTable):
        return _number("torque", TORQUE, written, units)
    if (written.over_omega is None) == (written.kloss is None):
        raise SceneError('steady.torque: a motor has over_omega = "motor.csv", [...] or kloss = {...}')
    key = "over_omega" if written.kloss is None else "kloss"
    more = {
        name: value for name in ("kind", "omega", "torque") if (value := getattr(written, name)) is not None
    }
    wrong = next(
        (
            name
            for name in more
            if key == "kloss" or (name != "kind" and not isinstance(written.over_omega, str))
        ),
        None,
    )
    if wrong is not None:
        beside = "kloss" if key == "kloss" else "points"
        raise SceneError(f"steady.torque.{wrong} = {shown(more[wrong])}: it has no place beside {beside}")
    try:
        if written.kloss is not None:
            four = {name: getattr(written.kloss, name) for name in written.kloss.__struct_fields__}
            return MakeKloss(units)(**four)
        if isinstance(written.over_omega, str):
            return settled("torque", over_omega.read(file_of(written.over_omega, folder), **more), units)
        speeds, torques = (list(column) for column in zip(*written.over_omega or (), strict=True))
        return MakeOverOmega(units)(speeds, torques, **more)
    except MissingExtraError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"steady.torque.{key}: {error}") from None
    except OSError as error:
        raise SceneError(
            f"steady.torque.{key} = {shown(written.over_omega)}: {error.strerror or error}"
        ) from None


def steady_of(asked: OnMotor, setting: Setting) -> MotorResult:
    """The steady states of all designs, together."""
    arrays = np.meshgrid(*(np.asarray(v) for v in asked.axes.values()), indexing="ij") if asked.axes else []
    given: dict[str, Any] = {**asked.fixed, **dict(zip(asked.axes, arrays, strict=True))}
    found = steady(torque=asked.torque, branch=setting.branch, **given)
    return MotorResult(asked, _labelled(asked, setting, found), found)


def _labelled(asked: OnMotor, setting: Setting, found: Steady) -> "xr.Dataset":
    import_xarray()
    with IMPORTS:
        import xarray

    names = [*NUMBERS, "flywheel_inertia", "status"]
    dims = tuple(asked.axes)
    data = {
        name: (dims, found[name], {"units": OTHERS.get(name, "1"), "long_name": MEANINGS[name]})
        for name in names
        if name not in dims
    }
    axes = {name: (name, list(values), _attributes(name)) for name, values in asked.axes.items()}
    loads = {n: v for n, v in asked.fixed.items() if isinstance(v, Load)}
    scalars = {n: ((), v, _attributes(n)) for n, v in asked.fixed.items() if n not in loads and n not in data}
    about = {**setting.provenance, "branch": setting.branch, "torque": repr(asked.torque)}
    return tell_loads(xarray.Dataset(data, {**axes, **scalars}, about), loads)


def _attributes(name: str) -> dict[str, str]:
    if name not in ROWS:
        return input_attributes(name)
    return {"units": ROWS[name].unit, "long_name": MEANINGS[name]}
