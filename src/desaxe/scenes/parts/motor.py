"""[steady] of a scene: the machine on its motor, and its steady states, labelled."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ...design.steady.result import NUMBERS, Steady
from ...design.steady.steady import FLUCTUATION, FLYWHEEL, steady
from ...evaluation.in_units import in_units
from ...evaluation.labels import input_attributes
from ...loads.load import Load
from ...loads.motors import Motor
from ...mechanism.inputs import UNITS, Input
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import SteadyStatus
from ...support.shown import printed
from ..content import Content, PlanRow, RequestAnswer, RequestPlan, Sink
from ..document.blocks import ROWS as LISTED
from ..document.blocks import Section, Text, TextTable, cell, thinned, with_unit
from ..loads import motor_of
from ..reading.values import Value, read_number
from ..schema import SceneError, shown

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


REASONS = 5  # without a steady state, that are listed
FIGURES = ("omega_mean", "fluctuation", "power_mean", "work", "multiplier", "flywheel_inertia")


@dataclass(frozen=True)
class OnMotor:
    """The steady states on a motor, for the outer product of `axes` with everything else fixed."""

    key = group = "steady"
    torque: Any
    axes: dict[str, tuple[float, ...]]
    fixed: dict[str, Value]
    seeks: bool  # the flywheel for a fluctuation
    sliders: Any = None  # of a crankshaft, in place of the inputs of one

    def plan(self, content: Content) -> RequestPlan:
        """A periodic motion for each design."""
        designs = prod(len(values) for values in self.axes.values())
        how = "periodic motions by Newton's method, in NumPy"
        work = [PlanRow("steady state on a motor", designs, "designs", how)]
        return RequestPlan(lambda sink: self._answer(content, sink), 1, work)

    def _answer(self, content: Content, sink: Sink) -> "MotorResult":
        """The steady states of all designs, together."""
        sink.steps.next("steady state")
        arrays = np.meshgrid(*(np.asarray(v) for v in self.axes.values()), indexing="ij") if self.axes else []
        inputs: dict[str, Any] = {**self.fixed, **dict(zip(self.axes, arrays, strict=True))}
        of = {"branch": content.branch} if self.sliders is None else {"sliders": self.sliders}
        result = steady(torque=self.torque, **of, **inputs)
        names = [*NUMBERS, "flywheel_inertia", "status"]
        values = {n: (result[n], {"units": UNITS.get(n, "1"), "long_name": MEANINGS[n]}) for n in names}
        about = {"torque": repr(self.torque)}
        dataset = content.labelled(values, self.axes, self.fixed, about, _attributes)
        return MotorResult(asked=self, dataset=dataset, found=result)


@dataclass(frozen=True, kw_only=True)
class MotorResult(RequestAnswer):
    """The steady states of all designs, labelled.

    `dataset` has over the designs' dimensions: `omega_mean`, `period`, `fluctuation`, `power_mean`, `work`,
    `multiplier`, `flywheel_inertia`, `status`. `found` is what `desaxe.steady` gave [SI].
    """

    key = "steady"
    asked: OnMotor
    found: Steady

    def blocks(self, units: UnitSystem) -> Section:
        """A row for each design, and why some have no steady state."""
        dataset, axes = self.dataset, list(self.asked.axes)
        figures = [name for name in FIGURES if name in dataset.data_vars]
        rows = []
        for index in thinned(list(np.ndindex(dataset["status"].shape)), LISTED):
            row = [cell(dataset[name].values[k]) for name, k in zip(axes, index, strict=True)]
            rows.append([*row, *(cell(dataset[name].values[index]) for name in figures)])
        names = [*axes, *figures]
        messages = np.ravel(np.asarray(in_units(self.found, units)["message"], object)).tolist()
        reasons = [message for message in dict.fromkeys(messages) if message != "ok"]
        more = len(reasons) - REASONS
        remarks = [*reasons[:REASONS], *[f"and {more} more reasons"] * (more > 0)]
        remarks += [f"{LISTED} of {len(messages)} designs are shown"] * (len(messages) > LISTED)
        table, torque = (
            TextTable(names, rows, [printed(dataset[name].units) for name in names]),
            self.asked.torque,
        )
        motor = with_unit(units, "T_in", torque) if isinstance(torque, float) else repr(torque)
        return Section("Steady state", [Text(f"On {motor}."), table, *map(Text, remarks)])


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


def _attributes(name: str) -> dict[str, str]:
    if name not in ROWS:
        return input_attributes(name)
    return {"units": ROWS[name].unit, "long_name": MEANINGS[name]}
