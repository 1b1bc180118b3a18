"""`python -m benchmarks --only integrators`: many motions beside heyoka's Taylor series.

The same designs and the same equations on one core, heyoka in a process of its own: scalar and in batches of
four. heyoka takes M_eff(theta) written out and differentiates it by itself. The truth is heyoka's at the
smallest tolerance; an error is that of the angle at the end, relative, the largest of all designs.
"""

import json
import math
import subprocess
import sys
import time
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

import desaxe as dx

Array = NDArray[np.float64]
DESIGNS, ROUNDS, BATCH, T_END = 200, 5, 4, 1.0
TORQUES = {"1.5 N m": (1.5, 0.0, 0.0), "1.5 - 0.02 omega + 0.3 sin(t) N m": (1.5, 0.02, 0.3)}
TOLERANCES = {"heyoka": (1e-9, 1e-12), "desaxe": (1e-6, 1e-8, 1e-10, 1e-12)}
WRT = ("m_slider", "AB", "theta0", "omega_start", "torque")
Row = dict[str, Any]  # who, torque, tol, ms a design, error


def designs(seed: int = 1) -> dict[str, Any]:
    """Cranks at rest that make some six turns in a second."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.04, 0.06, DESIGNS)
    return {
        "AB": AB, "BC": AB * rng.uniform(2.5, 4.0, DESIGNS), "ec": 0.01, "m_crank": 0.5, "I_crank": 1.4e-2,
        "m_rod": rng.uniform(0.2, 0.5, DESIGNS), "I_rod": 5e-4, "m_slider": rng.uniform(0.5, 2.0, DESIGNS),
    }  # fmt: skip


def of_t_and_omega(t: float, theta: float, omega: float) -> float:
    """A torque that falls with the speed and swings with time."""
    return 1.5 - 0.02 * omega + 0.3 * math.sin(t)


def ours() -> tuple[list[Row], dict[str, Array]]:
    """The rows of desaxe without errors, and the angles at the end."""
    rows, ends = [], {}
    for name, numbers in TORQUES.items():
        drive: Any = of_t_and_omega if numbers[1] else numbers[0]
        for tol in TOLERANCES["desaxe"]:

            def run(drive: Any = drive, tol: float = tol) -> Any:
                return dx.simulate(
                    torque=drive, t_end=T_END, times=[T_END], rtol=tol, threads=1, **designs()
                )["theta"]

            run()
            rows.append({"who": "desaxe", "torque": name, "tol": tol, "ms": _least(run)})
            ends[f"{name} {tol:g}"] = run()[:, 0]
    return rows, ends


def sensitivities() -> float:
    """The time of motions with their derivatives by five parameters, of that of the motions alone."""

    def run(**wrt: Any) -> None:
        dx.simulate(torque=1.5, t_end=T_END, times=[T_END], threads=1, **designs(), **wrt)

    run(wrt=WRT)
    return _least(lambda: run(wrt=WRT)) / _least(run)


def _least(run: Any) -> float:
    """Milliseconds of processor time a design, the least of some rounds."""
    spent = []
    for _ in range(ROUNDS):
        start = time.process_time()
        run()
        spent.append(time.process_time() - start)
    return 1e3 * min(spent) / DESIGNS


def theirs() -> dict[str, Any]:
    """The rows of heyoka, and the truth, from a process of its own."""
    found = subprocess.run(
        [sys.executable, "-m", "benchmarks.integrators"], capture_output=True, text=True, check=True
    )
    result: dict[str, Any] = json.loads(found.stdout)
    return result


def _equations(numbers: tuple[float, ...]) -> tuple[list[Any], list[str]]:
    """The equations of motion as heyoka takes them; the parameters' names in their order."""
    import heyoka as hy

    theta, omega = hy.make_vars("theta", "omega")
    names = ["AB", "BC", "ec", "m_crank", "m_rod", "m_slider", "I_crank", "I_rod"]
    AB, BC, ec, m_crank, m_rod, m_slider, I_crank, I_rod = (hy.par[k] for k in range(len(names)))
    u = AB * hy.sin(theta) + ec
    S = hy.sqrt(BC * BC - u * u)
    turn = AB * hy.cos(theta) / S  # dphi/dtheta
    slide = -(AB * hy.sin(theta)) - u * turn  # dY/dtheta
    x, y = 0.5 * AB * hy.cos(theta), 0.5 * (slide - AB * hy.sin(theta))  # of the middle of the rod
    inertia = I_crank + m_crank * AB * AB * 0.25 + m_rod * (x * x + y * y) + I_rod * turn * turn
    inertia = inertia + m_slider * slide * slide
    push = numbers[0] - numbers[1] * omega + numbers[2] * hy.sin(hy.time)
    return [
        (theta, omega),
        (omega, (push - 0.5 * hy.diff(inertia, theta) * omega * omega) / inertia),
    ], names


def _heyoka() -> dict[str, Any]:
    import heyoka as hy

    drawn = designs()
    rows, truths = [], {}
    for name, numbers in TORQUES.items():
        system, names = _equations(numbers)
        values = np.array([np.broadcast_to(drawn[n], DESIGNS) for n in names])
        ends = {}
        for tol in (*TOLERANCES["heyoka"], 1e-17):
            alone = hy.taylor_adaptive(system, [0.0, 0.0], tol=tol, pars=[0.0] * len(names))
            batch = hy.taylor_adaptive_batch(
                system, np.zeros((2, BATCH)), tol=tol, pars=np.zeros((len(names), BATCH))
            )

            def scalar(alone: Any = alone, values: Array = values) -> Array:
                found = []
                for k in range(DESIGNS):
                    alone.time = 0.0
                    alone.state[:], alone.pars[:] = 0.0, values[:, k]
                    alone.propagate_until(T_END)
                    found.append(alone.state[0])
                return np.array(found)

            def in_batches(batch: Any = batch, values: Array = values) -> Array:
                found = []
                for k in range(0, DESIGNS, BATCH):
                    batch.set_time(0.0)
                    batch.state[:], batch.pars[:] = 0.0, values[:, k : k + BATCH]
                    batch.propagate_until(T_END)
                    found.append(batch.state[0].copy())
                return np.concatenate(found)

            for who, run in (("heyoka", scalar), ("heyoka, batch of 4", in_batches)):
                ends[who, tol] = run()
                rows.append({"who": who, "torque": name, "tol": tol, "ms": _least(run)})
        truth = truths[name] = ends["heyoka", 1e-17]
        for row in rows:
            if row["torque"] == name:
                row["error"] = _worst(ends[row["who"], row["tol"]], truth)
    kept = [row for row in rows if row["tol"] != 1e-17]
    return {"rows": kept, "truth": {name: list(truth) for name, truth in truths.items()}}


def _worst(found: Array, truth: Array) -> float:
    return float(np.max(np.abs(found / truth - 1.0)))


def measured() -> list[Row]:
    """The rows of everyone; without heyoka the truth is desaxe's at its smallest tolerance."""
    rows, ends = ours()
    other = theirs() if find_spec("heyoka") else None
    for row in rows:
        name = row["torque"]
        truth = np.array(other["truth"][name]) if other else ends[f"{name} {TOLERANCES['desaxe'][-1]:g}"]
        row["error"] = _worst(ends[f"{name} {row['tol']:g}"], truth)
    return rows + (other["rows"] if other else [])


def table() -> str:
    """The rows as a table."""
    rows = measured()
    lines = [
        "| torque | who | tolerance | ms a design | worst relative error of the angle |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {row['torque']} | {row['who']} | {row['tol']:g} | {row['ms']:.3f} | {row['error']:.1e} |"
        for row in sorted(rows, key=lambda row: str(row["torque"]))
    ]
    of_five = f"The derivatives by {', '.join(WRT)} take {sensitivities():.2f} times the motion alone"
    return "\n".join([*lines, "", f"{of_five} (1.5 N m, rtol 1e-10)."])


if __name__ == "__main__":
    print(json.dumps(_heyoka()))
