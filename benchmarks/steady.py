"""`python -m benchmarks --only steady`: steady states in one call beside simulating until two turns agree.

Presses on induction motors, the same in both ways, in one process, in the time of one core; `simulate` goes
on turn by turn until the speed at the start of a turn changes by less than 1e-11 of it.
"""

import time
from math import pi
from typing import Any

import numpy as np

import desaxe as dx

from .rig import timed

DESIGNS, SIMULATED, ROUNDS = 1000, 5, 3
TURNS, AGREES, RTOL = 400, 1e-11, 1e-12
LOAD = ([0.0, 0.5e-3, 5e-3, 6e-3], [0.0, -9e3, -20e3, 0.0])  # over the last 6 mm before the outer dead centre
FIXED: dict[str, Any] = {"ec": 0.01, "I_crank": 2.0, "m_rod": 3.0, "I_rod": 0.01, "g_Y": -9.81}


def table() -> str:
    """The times for each design, and how far the mean speeds are apart."""
    rng = np.random.default_rng(1)
    columns = {
        "AB": rng.uniform(0.04, 0.06, DESIGNS),
        "BC": rng.uniform(0.18, 0.25, DESIGNS),
        "m_slider": rng.uniform(10.0, 30.0, DESIGNS),
        "flywheel_inertia": rng.uniform(1.0, 9.0, DESIGNS),
    }
    shared = {**FIXED, "F_Y": dx.over_stroke(*LOAD, [0.0] * 4, dead_centre="outer")}
    motor = dx.kloss(40.0, 0.15, 157.08, gear=12)
    rows = [{name: float(column[k]) for name, column in columns.items()} for k in range(SIMULATED)]
    dx.steady(torque=motor, **shared, **rows[0])
    ways = {
        f"`steady`, {DESIGNS} designs in a call": (_together(motor, shared, columns), DESIGNS),
        "`steady`, one design": (_one_by_one(motor, shared, rows), SIMULATED),
        "`simulate` until two turns agree": (_simulated(motor, shared, rows), SIMULATED),
    }
    lines = ["| way | ms a design | ratio | mean speed, largest difference |", "|---|---|---|---|"]
    first: tuple[float, list[float]] | None = None
    for title, (way, count) in ways.items():
        seconds, speeds = min((timed(way, time.process_time) for _ in range(ROUNDS)), key=lambda one: one[0])
        first = first or (seconds / count, speeds)
        off = max(abs(a / b - 1.0) for a, b in zip(speeds, first[1], strict=False))
        ratio = seconds / count / first[0]
        lines.append(f"| {title} | {1e3 * seconds / count:.3g} | {ratio:.3g} | {off:.1e} |")
    return "\n".join(lines)


def _together(motor: Any, shared: dict[str, Any], columns: dict[str, Any]) -> Any:
    return lambda: list(dx.steady(torque=motor, **shared, **columns)["omega_mean"])


def _one_by_one(motor: Any, shared: dict[str, Any], rows: list[dict[str, float]]) -> Any:
    return lambda: [dx.steady(torque=motor, **shared, **row)["omega_mean"] for row in rows]


def _simulated(motor: Any, shared: dict[str, Any], rows: list[dict[str, float]]) -> Any:
    return lambda: [_until_it_repeats(motor, {**shared, **row}) for row in rows]


def _until_it_repeats(motor: Any, machine: dict[str, Any]) -> float:
    """The mean speed of the first turn that ends as it began."""
    heavy = {**machine, "I_crank": machine["I_crank"] + machine["flywheel_inertia"]}
    del heavy["flywheel_inertia"]
    speed = 10.0
    for _ in range(TURNS):
        turn = dx.simulate(torque=motor, t_end=5.0, until=2.0 * pi, omega_start=speed, rtol=RTOL, **heavy)
        before, speed = speed, float(turn["omega"][-1])
        if abs(speed - before) <= AGREES * speed:
            return 2.0 * pi / turn["t_last"]
    raise RuntimeError(f"no periodic motion in {TURNS} turns")
