"""`python -m benchmarks.startup`: what desaxe's calls take in a new process, over importing NumPy.

A first call finds no cache of any kind, a second process the machine code that an earlier one has compiled.
Each figure is processor time, the least of some new processes.
"""

import argparse
import os
import subprocess
import sys
import tempfile

BEFORE = """
import os, time
import numpy as np
ANGLES, DESIGNS = np.linspace(0.0, 6.0, 100_000), np.linspace(0.0, 0.05, 2_000)
LENGTHS = {"AB": 0.125, "BC": 0.35}
CRANK = {**LENGTHS, "omega0": 157.08}
MASSES = {**LENGTHS, "ec": 0.01, "m_crank": 1.0, "I_crank": 0.01, "m_slider": 1.0}
start = time.process_time()
import desaxe as dx
"""
AFTER = "\nprint(time.process_time() - start)"
CALLS = {
    "`evaluate` of a name at 100,000 points": 'dx.evaluate("a_C", theta=ANGLES, ec=0.01, **CRANK)',
    "`grid` of 720 x 32 x 16 into memory of the caller": (
        'dx.grid("a_C", theta=ANGLES[:720], ec=DESIGNS[:32], BC=np.linspace(0.3, 0.4, 16), AB=0.125, '
        "omega0=157.08, out=np.empty((720, 32, 16)))"
    ),
    "`function` of 2 names at 720 angles": (
        'dx.function(["V_C", "a_C"], inputs=("theta", "ec"), **CRANK)(ANGLES[:720], 0.01)'
    ),
    "`peak` of 2,000 designs": 'dx.peak("a_C", ec=DESIGNS, **CRANK)',
    "`peak` of the torque of 1,000 designs": (
        'dx.peak("T_in", **{**MASSES, "ec": DESIGNS[::2]}, omega0=157.08)'
    ),
    "`peak` of one design": 'dx.peak("j_C", ec=0.01, **CRANK)',
    "`peak` of the torque of 200 designs, friction": (
        'dx.peak("T_in", **{**MASSES, "ec": DESIGNS[:200]}, mu=0.1, omega0=157.08)'
    ),
    "`peak` of the torque of 200 designs, a load over the stroke": (
        'dx.peak("T_in", **{**MASSES, "ec": DESIGNS[:200]}, omega0=157.08, '
        'F_Y=dx.over_stroke([0.0, 0.1, 0.2], [-400.0, -100.0, 0.0], dead_centre="inner"))'
    ),
    "`events` of 2,000 designs": "dx.events(ec=DESIGNS, **LENGTHS)",
    "`simulate`, one motion": "dx.simulate(torque=1.0, t_end=0.1, **MASSES)",
    "`simulate`, one motion, derivatives by two inputs": (
        'dx.simulate(torque=1.0, t_end=0.1, wrt=["AB", "m_slider"], **MASSES)'
    ),
    "`simulate`, 20 motions": "dx.simulate(torque=np.linspace(1.0, 2.0, 20), t_end=0.1, **MASSES)",
    "`tolerance` of a peak": ('dx.tolerance(("absmax", "a_C"), ec=dx.plus_minus(0.01, 0.001), **CRANK)'),
}


def seconds(call: str, cache: str) -> float:
    """Processor time of a call in a new process."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    code = f"{BEFORE}{call}{AFTER}"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    if done.returncode:
        raise SystemExit(done.stderr)
    return float(done.stdout)


def measure(rounds: int) -> dict[str, dict[str, float]]:
    """Call -> seconds of a first call, and of one in a second process."""
    found = {}
    for name, call in CALLS.items():
        first = []
        for _ in range(rounds):
            with tempfile.TemporaryDirectory() as empty:
                first.append(seconds(call, empty))
        with tempfile.TemporaryDirectory() as kept:
            seconds(call, kept)
            second = min(seconds(call, kept) for _ in range(2 * rounds))
        found[name] = {"first": min(first), "second": second}
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.startup", description=__doc__)
    parser.add_argument("--rounds", type=int, default=2)
    found = measure(parser.parse_args().rounds)
    for name, times in found.items():
        print(f"{name:52} first {times['first']:6.2f} s   second process {times['second']:6.3f} s")


if __name__ == "__main__":
    main()
