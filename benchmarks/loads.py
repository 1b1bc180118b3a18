"""`python -m benchmarks --only loads`: a driving torque under loads, beside a constant force.

The same machine in one process and in turns: a grid of 721 angles and 512 designs, stored and reduced, as
many points of an array, the peaks of 512 designs in one call, by NumPy as in a first call, and with machine
code, `tolerance` of a peak with 2,000 samples, and `optimize` of a peak over two variables.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import desaxe as dx

from .rig import in_turns

DESIGNS, ANGLES = 512, 721
ROUNDS = {"tolerance": 2, "optimize": 1}  # of those that take long; 9 of the others
MACHINE = {"AB": 0.1, "BC": 0.35, "omega0": 30.0, "m_slider": 2.0, "m_rod": 1.0, "I_rod": 0.01}


def loads() -> dict[str, Any]:
    """Loads of every kind, and no load that varies."""
    turn = np.linspace(0.0, 2.0 * np.pi, 73)[:-1]
    positions, distances = [0.27, 0.33, 0.40], [0.0, 0.008, 0.1]
    out, back = [0.0, -100.0, -400.0], [0.0, -10.0, -50.0]
    return {
        "a number": -300.0,
        "over theta, 9 points, linear": dx.over_theta(
            turn[::8], 100.0 * np.sin(turn[::8]) - 50.0, kind="linear"
        ),
        "over theta, 72 points, cubic": dx.over_theta(turn, -100.0 * np.cos(turn)),
        "over Y, 3 points, linear": dx.over_Y(positions, out, kind="linear"),
        "over Y, 3 points, step, both ways": dx.over_Y(positions, out, back, kind="step"),
        "over the stroke, 3 points, linear": dx.over_stroke(
            distances, out[::-1], kind="linear", dead_centre="inner"
        ),
        "over the stroke, 3 points, step, both ways": dx.over_stroke(
            distances, out[::-1], back, kind="step", dead_centre="inner"
        ),
    }


def works(load: Any) -> dict[str, Callable[[], Any]]:
    """The works under a load."""
    ec = np.linspace(-0.05, 0.05, DESIGNS)
    grid = partial(dx.grid, "T_in", theta=np.linspace(0.0, 2.0 * np.pi, ANGLES), ec=ec, F_Y=load, **MACHINE)
    peak = partial(dx.peak, "T_in", ec=ec, F_Y=load, **MACHINE)
    points = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, ANGLES), ec)
    theta, offsets = (np.ascontiguousarray(column.reshape(-1)) for column in points)
    rest = {name: value for name, value in MACHINE.items() if name not in ("AB", "BC")} | {"F_Y": load}
    scatter = {
        "ec": dx.plus_minus(0.01, 0.001),
        "AB": dx.plus_minus(0.1, 5e-4),
        "BC": dx.plus_minus(0.35, 1e-3),
    }
    over = {"ec": (-0.03, 0.03), "BC": (0.25, 0.5)}
    return {
        "grid": grid,
        "grid, reduced": partial(grid, reduce={"theta": ["absmax", "mean"]}),
        "points": partial(dx.evaluate, "T_in", theta=theta, ec=offsets, F_Y=load, **MACHINE),
        "peaks": peak,
        "tolerance": partial(dx.tolerance, ("absmax", "T_in"), samples=2_000, **scatter, **rest),
        "optimize": partial(dx.optimize, minimize=("absmax", "T_in"), over=over, AB=0.1, **rest),
    }


def table() -> str:
    """The times, and their ratios to those without a load."""
    rows = {name: works(load) for name, load in loads().items()}
    first = rows["a number"]
    lines = [f"{ANGLES} angles, {DESIGNS} designs", "", f"| ms (ratio) | {' | '.join(first)} |"]
    lines.append("|---" * (1 + len(first)) + "|")
    found = {work: in_turns({n: row[work] for n, row in rows.items()}, ROUNDS.get(work, 9)) for work in first}
    for name in rows:
        cells = [f"{own[name] * 1e3:.1f} ({own[name] / own['a number']:.1f})" for own in found.values()]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)
