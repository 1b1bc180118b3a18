"""Cold starts: from the start of a new process to its first results.

A first start finds no cache of any kind, a second one what the first has kept on disk. Deriving the
formulas is not counted: whoever uses another tool has them at hand.
`python -m benchmarks.starts NAME` is such a process.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence

from .child import Child, keep_to
from .contenders import BY_NAME, Contender
from .work import BY_KEY

POINTS = 10_000
WORK = BY_KEY["point"]
CACHES = ("XDG_CACHE_HOME", "NUMBA_CACHE_DIR")


def starts(contenders: Sequence[Contender], core: int, rounds: int) -> dict[str, dict[str, float]]:
    """Name -> seconds of a first start and of a second one, the best of some."""
    result = {one.name: {"first": float("inf"), "second": float("inf")} for one in contenders}
    for _ in range(rounds):
        for one in contenders:
            with tempfile.TemporaryDirectory() as folder:
                for when in ("first", "second"):
                    result[one.name][when] = min(result[one.name][when], _start(one.name, core, folder))
    return result


def _start(name: str, core: int, folder: str) -> float:
    command = [sys.executable, "-m", __spec__.name, name, str(core)]
    started = time.perf_counter()
    environment = {**os.environ, **dict.fromkeys(CACHES, folder)}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return time.perf_counter() - started - float(done.stdout.split()[-1])


def _main(name: str, core: str) -> None:
    keep_to([int(core)])
    Child(BY_NAME[name].load(), 1).start(WORK.key, POINTS)
    formulas = sys.modules.get("benchmarks.formulas")
    print(formulas.spent[0] if formulas else 0.0)


if __name__ == "__main__":
    _main(*sys.argv[1:])
