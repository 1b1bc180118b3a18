"""`python -m benchmarks.startup`: what desaxe's calls take in a new process, over importing NumPy.

A first call finds no cache of any kind, a second process that of numba.
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
LATER = 10  # calls after the first one, of which the slowest tells of a stall
AFTER = f"""
spent = [time.process_time() - start]
for _ in range({LATER}):
    start = time.process_time()
    {{call}}
    spent.append(time.process_time() - start)
print(spent[0], max(spent[1:]))
"""
NAMES = [
    "Y", "V_C", "a_C", "phi", "omega_BC", "alpha_BC", "T_in", "F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_C_X",
    "F_C_Y", "N_C", "kinetic_energy", "power_in", "a_C_wrt_ec", "a_C_wrt_AB", "a_C_wrt_BC", "V_C_wrt_ec",
    "V_C_wrt_AB", "V_C_wrt_BC", "T_in_wrt_ec", "T_in_wrt_AB", "T_in_wrt_BC", "N_C_wrt_ec", "N_C_wrt_AB",
    "N_C_wrt_BC", "F_A_X_wrt_AB", "F_A_Y_wrt_AB",
]  # fmt: skip
CALLS = {
    "`evaluate` of V_C, a_C, a_C_wrt_ec at 100,000 points": (
        'dx.evaluate(["V_C", "a_C", "a_C_wrt_ec"], theta=ANGLES, ec=0.01, **CRANK)'
    ),
    **{
        f"`evaluate` of {count} names at 721 angles": (
            f"dx.evaluate({NAMES[:count]}, theta=ANGLES[:721], omega0=157.08, **MASSES)"
        )
        for count in (10, 30)
    },
    "`drive` under a load over the stroke": (
        "dx.drive(omega0=157.08, **MASSES, "
        'F_Y=dx.over_stroke([0.0, 0.1, 0.2], [-400.0, -100.0, 0.0], dead_centre="inner"))'
    ),
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


def seconds(call: str, cache: str) -> tuple[float, float]:
    """Processor time of the first call in a new process, and of the slowest one that follows."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    code = f"{BEFORE}{call}{AFTER.format(call=call)}"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    if done.returncode:
        raise SystemExit(done.stderr)
    first, later = map(float, done.stdout.split())
    return first, later


def measure(rounds: int) -> dict[str, dict[str, float]]:
    """Call -> seconds of a first call, of the slowest one that follows, and of one in a second process."""
    result = {}
    for name, call in CALLS.items():
        first = []
        for _ in range(rounds):
            with tempfile.TemporaryDirectory() as empty:
                first.append(seconds(call, empty))
        with tempfile.TemporaryDirectory() as kept:
            seconds(call, kept)
            second = min(seconds(call, kept)[0] for _ in range(2 * rounds))
        begin, later = (min(column) for column in zip(*first, strict=True))
        result[name] = {"first": begin, "later": later, "second": second}
    return result


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.startup", description=__doc__)
    parser.add_argument("--rounds", type=int, default=2)
    result = measure(parser.parse_args().rounds)
    for name, times in result.items():
        first, later, second = (times[key] for key in ("first", "later", "second"))
        print(f"{name:60} first {first:6.2f} s   later {later:7.4f} s   second process {second:6.3f} s")


if __name__ == "__main__":
    main()
