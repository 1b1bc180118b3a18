"""`python -m benchmarks`: desaxe beside NumPy and numba on the textbook formula, time and error.

The contenders do the same work in the same process on one core, in turns; the table has the ratio
of the fastest of several rounds. The textbook formula is the closed form of `desaxe.equation`,
lambdified with common subexpressions. Errors are against the tests' oracle.
"""

import argparse
import platform
import time
from collections.abc import Callable, Mapping
from typing import Any

import llvmlite.binding
import numba
import numpy as np
import sympy as sp

import desaxe as dx

try:
    from desaxe.audit.truth import relative_error, truth
except ModuleNotFoundError as missing:
    raise SystemExit(f"the benchmarks need {missing.name}: python -m pip install -e '.[dev]'") from None

KINEMATICS = ("V_C", "a_C")
SENSITIVITIES = tuple(f"{q}_wrt_{p}" for q in KINEMATICS for p in ("theta", "ec", "AB", "BC"))
INPUTS = ("theta", "ec", "AB", "BC", "omega0")
WORK = {
    "V_C, a_C": KINEMATICS,
    "V_C, a_C and 8 first sensitivities": (*KINEMATICS, *SENSITIVITIES),
}
DISTANCES = (1e-2, 1e-4, 1e-6)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    versions = f"desaxe {dx.__version__}, numba {numba.__version__}, NumPy {np.__version__}"
    print(f"{platform.machine()}, {llvmlite.binding.get_host_cpu_name()}, {versions}\n")
    print(f"time at {options.points} random points, one core, as a multiple of desaxe's\n")
    print("| work | NumPy lambdify | numba on it | desaxe |\n|---|---|---|---|")
    for title, names in WORK.items():
        print(_row(title, _times(names, options.points, options.rounds)))
    print("\nworst relative error of V_C, a_C next to the change point AB = 1, BC = 1.5, ec = -0.5\n")
    print("| distance | NumPy lambdify | desaxe |\n|---|---|---|")
    for distance in DISTANCES:
        textbook, ours = _errors(distance)
        print(f"| {distance:g} rad | {textbook:.1e} | {ours:.1e} |")


def textbook(names: tuple[str, ...]) -> Callable[..., Any]:
    """The closed forms as a NumPy function of INPUTS; the crank turns forwards, at constant speed."""
    speed = sp.Symbol("omega0", positive=True)
    fixed = {"alpha": 0, "branch": 1, "omega0": speed}
    fixed = {sp.Symbol(name, real=True): value for name, value in fixed.items()}
    symbols = [*(sp.Symbol(name, real=True) for name in INPUTS[:-1]), speed]
    expressions = [dx.equation(name).expression.subs(fixed) for name in names]
    function: Callable[..., Any] = sp.lambdify(symbols, expressions, "numpy", cse=True)
    return function


def _points(count: int) -> dict[str, Any]:
    rng = np.random.default_rng(1)
    ranges = {"theta": (-7.0, 7.0), "ec": (-0.05, 0.05), "AB": (0.1, 0.15), "BC": (0.3, 0.4)}
    return {name: rng.uniform(*ends, count) for name, ends in ranges.items()}


def _times(names: tuple[str, ...], count: int, rounds: int) -> dict[str, float]:
    columns = _points(count)
    plain = textbook(names)
    compiled = numba.njit(error_model="numpy")(plain)
    out = {name: np.empty(count) for name in names}
    contenders: Mapping[str, Callable[[], Any]] = {
        "NumPy": lambda: plain(*columns.values(), 157.08),
        "numba": lambda: compiled(*columns.values(), 157.08),
        "desaxe": lambda: dx.evaluate(list(names), **columns, omega0=157.08, out=out, threads=1),
    }
    best = dict.fromkeys(contenders, float("inf"))
    for _ in range(rounds):
        for name, run in contenders.items():
            started = time.perf_counter()
            run()
            best[name] = min(best[name], time.perf_counter() - started)
    return best


def _row(title: str, times: Mapping[str, float]) -> str:
    return f"| {title} | " + " | ".join(f"{times[name] / times['desaxe']:.1f}" for name in times) + " |"


def _errors(distance: float) -> tuple[float, float]:
    """The worst error of the textbook formula, and ours, on both sides of the quarter."""
    plain = textbook(KINEMATICS)
    worst = [0.0, 0.0]
    for side in (1, -1):
        point = {"theta": -np.pi / 2 + side * distance, "ec": -0.5, "AB": 1.0, "BC": 1.5, "omega0": 1.0}
        ours = dx.evaluate(list(KINEMATICS), **point)
        theirs = dict(zip(KINEMATICS, plain(*point.values()), strict=True))
        for name in KINEMATICS:
            exact = truth(name, **point)
            for place, value in enumerate((theirs[name], ours[name])):
                worst[place] = max(worst[place], float(relative_error(float(value), exact)))
    return worst[0], worst[1]


if __name__ == "__main__":
    main()
