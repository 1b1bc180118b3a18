"""`python -m benchmarks.steps`: the worst error of many random motions beside the usual one, by rtol.

Each motion lasts 1 s; its truth is the same motion at rtol 1e-13. A step control that accepts a bad step now
and then shows in the ratio of the worst to the median: some 5,000 to 300,000 with Hairer's estimate alone.
"""

import argparse
import time
from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

import desaxe as dx

from .rig import timed

TRUTH = 1e-13
Designs = Mapping[str, Any]


class Spread(NamedTuple):
    """The median and the worst of an error."""

    median: float
    worst: float

    @property
    def ratio(self) -> float:
        """The worst over the median."""
        return self.worst / self.median


def designs(count: int, seed: int) -> dict[str, Any]:
    """Random cranks that speed up to some 50 to 500 rad/s."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.05, 0.15, count)
    BC = AB * rng.uniform(2.0, 4.0, count)
    return {
        "AB": AB, "BC": BC, "ec": (BC - AB) * rng.uniform(-0.5, 0.5, count),
        "m_slider": rng.uniform(0.3, 3.0, count), "m_crank": 0.5, "m_rod": 0.8, "I_crank": 6e-4,
        "I_rod": 7e-3, "F_Y": -50.0, "g_X": 3.0, "g_Y": -9.81,
        "torque": 1.5, "theta0": 0.3, "omega_start": 20.0,
    }  # fmt: skip


def ends(drawn: Designs, rtol: float) -> dict[str, Any]:
    """The motions at their ends, by the integrator."""
    return dx.simulate(t_end=1.0, rtol=rtol, times=[1.0], threads=1, method="DOP853", **drawn)


def spread(drawn: Designs, rtol: float) -> dict[str, Any]:
    """The spread of the errors of theta and omega, and the energy residuals."""
    key = tuple((name, np.asarray(value).tobytes()) for name, value in drawn.items())
    found, truth = ends(drawn, rtol), _truth(key)
    off = {name: np.abs(found[name] - truth[name]) for name in ("theta", "omega")}
    result: dict[str, Any] = {n: Spread(float(np.median(e)), float(e.max())) for n, e in off.items()}
    return result | {"residual": found["energy_residual"]}


@lru_cache(maxsize=1)
def _truth(key: tuple[tuple[str, bytes], ...]) -> dict[str, Any]:
    return ends({n: v[0] if (v := np.frombuffer(b)).size == 1 else v for n, b in key}, TRUTH)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.steps", description=__doc__)
    parser.add_argument("--designs", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    drawn = designs(options.designs, options.seed)
    ends(designs(2, 0), 1e-4)  # compiled
    print(f"{options.designs} designs, seed {options.seed}, one core\n")
    heads = ("theta: median", "worst/median", "omega: median", "worst/median", "residual: median", "worst")
    print(f"| rtol | {' | '.join(heads)} | s |")
    print("|---|---|---|---|---|---|---|---|")
    for power in range(4, 11):
        spent, found = timed(partial(spread, drawn, 10.0**-power), time.process_time)
        theta, omega, residual = found["theta"], found["omega"], found["residual"]
        print(
            f"| 1e-{power} | {theta.median:.1e} | {theta.ratio:.0f} | {omega.median:.1e} | {omega.ratio:.0f} "
            f"| {np.median(residual):.1e} | {residual.max():.1e} | {spent:.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
