"""`python -m benchmarks.startup`: times of a new process up to its first result.

Each row is the median of several new processes, which take turns. A kernel that an earlier process
compiled is loaded from disk, without numba where it stands alone. What numba would need for that is
shown too: its own import, and the tables of types that it fills before the first kernel, which import
scipy.linalg where SciPy is installed.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile

WORK = """
import numpy as np
import desaxe as dx
points = {"theta": np.linspace(0, 6, 200_000), "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 157.0}
"""
FIRST = 'dx.evaluate("a_C", threads=1, **points)\n'
# Name -> what runs before the clock, and what it times.
ROWS = {
    "import desaxe": ("", "import desaxe"),
    "one point, plain Python": (
        "",
        "import desaxe as dx; dx.evaluate('a_C', theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=157.0)",
    ),
    "import numpy": ("", "import numpy"),
    "import numba": ("import numpy", "import numba"),
    "numba's first load of anything": (
        "import numba, numpy, math",
        "from numba.core.registry import cpu_target\n"
        "cpu_target.typing_context.refresh(); cpu_target.target_context.refresh()",
    ),
    "of this, scipy.linalg": ("import numba, numpy", "import scipy.linalg"),
    "desaxe's modules for arrays": (
        "import numba, numpy",
        "import desaxe as dx; dx.evaluate; import desaxe.evaluation.arrays",
    ),
    "program, cut and passes": (
        WORK + "import desaxe.evaluation.arrays, numba",
        "from desaxe.runtime import kernels as _kernels\n"
        "kept = _kernels._load\n"
        "def load(key):\n"
        "    _kernels.source_of(key)\n"
        "    raise KeyError\n"
        "_kernels._load = load\n"
        "try:\n    dx.evaluate('a_C', threads=1, **points)\nexcept KeyError:\n    pass",
    ),
    "first kernel, all else loaded": (
        WORK + "import numba\n" + "dx.evaluate('V_C', threads=1, **points)",
        FIRST,
    ),
    "first kernel from disk, all in all": ("", WORK + FIRST),
    "the same compiled for the first time": ("", WORK + FIRST),
}


def seconds(before: str, timed: str, cache: str) -> float:
    """The time of some lines in a new process."""
    code = f"import time\n{before}\nstart = time.perf_counter()\n{timed}\nprint(time.perf_counter() - start)"
    environment = {**os.environ, "DESAXE_CACHE_DIR": cache}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    if done.returncode:
        raise SystemExit(done.stderr)
    return float(done.stdout)


def measure(rounds: int) -> dict[str, float]:
    """The median of every row."""
    found: dict[str, list[float]] = {name: [] for name in ROWS}
    with tempfile.TemporaryDirectory() as kept:
        for name in ROWS:  # what is loaded from disk is there
            if not name.startswith("the same"):
                seconds(*ROWS[name], kept)
        for _ in range(rounds):
            for name, row in ROWS.items():
                with tempfile.TemporaryDirectory() as empty:
                    cache = empty if name.startswith("the same") else kept
                    found[name].append(seconds(*row, cache))
    return {name: statistics.median(times) for name, times in found.items()}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.startup", description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args()
    found = measure(options.rounds)
    if options.json:
        print(json.dumps(found, indent=2))
        return
    numba = found["import numba"]
    for name, time in found.items():
        print(f"{name:40} {1e3 * time:8.1f} ms   {time / numba:6.3f} of importing numba")


if __name__ == "__main__":
    main()
