"""`python -m benchmarks.tolerances`: the errors of random motions beside the tolerance they were asked for.

Cranks, loads and torques (a number; functions of theta, of omega, of all three with t; tables; friction at
the guide) are drawn at random; the truth is the same motion at the smallest tolerance. An error is relative
to the largest angle and the largest speed of the motion. Motions that multiply a change of the first speed by
more than 1,000, such as those that nearly stop, are left out.
"""

import argparse
import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import desaxe as dx
from desaxe.simulation.checks import LEAST_RTOL

Array = NDArray[np.float64]
Designs = Mapping[str, Any]
Histories = tuple[Array, Array]
INSTANTS = 8  # of a motion, at which it is compared
CHANGE, MOST = 1e-6, 1000.0  # of the first speed; what a motion may make of it
HIGHEST = 3.0  # of rtol: the worst of many errors is not above


def of_theta(theta: float) -> float:
    """A torque that swings once a turn."""
    return 1.5 + 0.8 * math.cos(theta - 0.4)


def of_all(t: float, theta: float, omega: float) -> float:
    """A torque that falls with the speed and swings with time."""
    return 1.5 - 0.02 * omega + 0.3 * math.sin(t)


def fast(t: float, theta: float, omega: float) -> float:
    """A torque that swings faster than the crank turns."""
    return 1.2 + 0.5 * math.sin(40.0 * t + theta) - 0.01 * omega


def cranks(count: int, rng: Any) -> dict[str, Any]:
    """Cranks that turn fully, loaded and in motion."""
    AB = rng.uniform(0.05, 0.15, count)
    BC = AB * rng.uniform(2.0, 5.0, count)
    return {
        "AB": AB, "BC": BC, "ec": (BC - AB) * rng.uniform(-0.5, 0.5, count),
        "m_slider": rng.uniform(0.3, 3.0, count), "m_crank": 0.5, "m_rod": rng.uniform(0.2, 1.0, count),
        "I_crank": rng.uniform(5e-4, 5e-3, count), "I_rod": 7e-3, "F_Y": rng.uniform(-60.0, 60.0, count),
        "g_X": 3.0, "g_Y": -9.81, "theta0": rng.uniform(0.0, 6.0, count),
        "omega_start": rng.uniform(20.0, 40.0, count),
    }  # fmt: skip


def _table(rng: Any) -> Any:
    return dx.over_theta(np.linspace(0.0, 2.0 * np.pi, 7)[:-1], rng.uniform(0.5, 2.5, 6), "cubic")


# How the motions of a kind are driven, and whether they run together, compiled.
KINDS: Mapping[str, tuple[Callable[[Any], dict[str, Any]], bool]] = {
    "number": (lambda rng: {"torque": 1.5}, True),
    "of theta": (lambda rng: {"torque": of_theta}, True),
    "of t, theta, omega": (lambda rng: {"torque": of_all}, True),
    "of t, fast": (lambda rng: {"torque": fast}, True),
    "table of theta": (lambda rng: {"torque": _table(rng)}, False),
    "friction": (lambda rng: {"torque": of_all, "mu": rng.uniform(0.02, 0.2)}, False),
}


def motions(drawn: Designs, drive: Designs, rtol: float, t_end: float) -> Histories:
    """theta and omega of motions at the instants."""
    times = t_end * np.arange(1, INSTANTS + 1) / INSTANTS
    how = {"times": times, "threads": 1}
    result = dx.simulate(t_end=t_end, rtol=rtol, **how, **{**drawn, **drive})
    return np.atleast_2d(result["theta"]), np.atleast_2d(result["omega"])


def errors(kind: str, count: int, rtol: float, seed: int, t_end: float = 1.0) -> Array:
    """The relative errors of theta and omega of random motions of a kind, a column for each."""
    truth, result = (_ends(kind, count, seed, one, t_end) for one in (LEAST_RTOL, rtol))
    changed = _ends(kind, count, seed, 1e-9, t_end, 1.0 + CHANGE)
    steady = _relative(changed, truth).max(axis=1) < MOST * CHANGE
    return _relative(result, truth)[steady]


def _relative(result: Histories, truth: Histories) -> Array:
    sizes = [np.abs(part).max(axis=1) for part in truth]
    sizes[0] = np.maximum(sizes[0], 1.0)
    parts = zip(result, truth, sizes, strict=True)
    return np.stack([np.abs(a - b).max(axis=1) / size for a, b, size in parts], axis=1)


@lru_cache(maxsize=16)
def _ends(kind: str, count: int, seed: int, rtol: float, t_end: float, faster: float = 1.0) -> Histories:
    rng = np.random.default_rng(seed)
    drawn, (drive, together) = cranks(count, rng), KINDS[kind]
    drawn["omega_start"] = drawn["omega_start"] * faster
    if together:
        return motions(drawn, drive(rng), rtol, t_end)
    each = [
        motions({n: float(np.broadcast_to(v, count)[k]) for n, v in drawn.items()}, drive(rng), rtol, t_end)
        for k in range(count)
    ]
    theta, omega = (np.concatenate(parts) for parts in zip(*each, strict=True))
    return theta, omega


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.tolerances", description=__doc__)
    parser.add_argument("--motions", type=int, default=1000, help="of each kind; a tenth one at a time")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--t-end", type=float, default=1.0)
    parser.add_argument("--kind", action="append", choices=KINDS)
    options = parser.parse_args()
    print("errors as multiples of rtol\n")
    print("| torque | rtol | theta: median | worst | omega: median | worst |\n|---|---|---|---|---|---|")
    for kind in options.kind or KINDS:
        count = options.motions if KINDS[kind][1] else max(1, options.motions // 10)
        for rtol in (1e-6, 1e-8, 1e-10, 1e-12):
            result = errors(kind, count, rtol, options.seed, options.t_end) / rtol
            shown = " | ".join(f"{np.median(one):.2g} | {one.max():.2g}" for one in result.T)
            print(f"| {kind} | {rtol:g} | {shown} |", flush=True)


if __name__ == "__main__":
    main()
