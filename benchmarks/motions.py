"""`python -m benchmarks.motions`: many designs in one compiled call beside one SciPy run for each.

The same designs, tolerances and instants in the same process on one core: desaxe's compiled call, desaxe one
design at a time, and bare `solve_ivp` on the same rates; the table has the time for each design.
"""

import argparse

import numpy as np
from scipy.integrate import solve_ivp

import desaxe as dx
from desaxe.simulation.checks import design_values, drive_of, model_of
from desaxe.simulation.equations import Smooth

from .rig import timed

PRESS = {
    "AB": 0.14, "BC": 0.31, "m_crank": 0.7637, "m_rod": 1.559464, "I_crank": 80.6e-6, "I_rod": 166.8085e-6,
}  # fmt: skip
TORQUE, T_END = 0.25, 3.0


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.motions", description=__doc__)
    parser.add_argument("--designs", type=int, default=1000)
    parser.add_argument("--single", type=int, default=20, help="how many of them one at a time")
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    designs = {
        "ec": rng.uniform(-0.1, 0.1, options.designs),
        "m_slider": rng.uniform(0.5, 3, options.designs),
    }
    rows = [{name: float(column[k]) for name, column in designs.items()} for k in range(options.single)]
    t = np.linspace(0.0, T_END, 101)

    def together() -> list[float]:
        found = dx.simulate(torque=TORQUE, t_end=T_END, times=t, threads=1, **PRESS, **designs)
        return [float(theta) for theta in found["theta"][: options.single, -1]]

    def alone() -> list[float]:
        runs = (dx.simulate(torque=TORQUE, t_end=T_END, times=t, **PRESS, **row) for row in rows)
        return [float(run["theta"][-1]) for run in runs]

    def bare() -> list[float]:
        runs = (_bare(t, row) for row in rows)
        return [float(run) for run in runs]

    dx.simulate(torque=TORQUE, t_end=0.1, **PRESS, **{name: column[:2] for name, column in designs.items()})
    print(f"a turning crank for {T_END:g} s, rtol 1e-10, ms for each design, one core\n")
    print("| way | ms | ratio | largest difference in theta |\n|---|---|---|---|")
    seconds, reference = timed(together)
    ours = seconds / options.designs
    for title, way, count in (
        ("one compiled call", together, options.designs),
        ("solve_ivp on the same rates", bare, options.single),
        ("simulate, one at a time", alone, options.single),
    ):
        seconds, ends = timed(way)
        each = seconds / count
        off = max(abs(a - b) for a, b in zip(ends, reference, strict=True))
        print(f"| {title} | {each * 1e3:.2f} | {each / ours:.0f} | {off:.1e} |")


def _bare(t: np.ndarray, row: dict[str, float]) -> float:
    model = model_of(design_values({**PRESS, **row}), 1, 0.0, drive_of(TORQUE, None, None))
    found = solve_ivp(
        Smooth(model).rate, (0.0, T_END), [0.0] * 3, method="DOP853", rtol=1e-10, atol=1e-13, t_eval=t
    )
    return float(found.y[0, -1])


if __name__ == "__main__":
    main()
