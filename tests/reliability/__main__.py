"""`python -m tests.reliability`: every kind of trial, as often as it takes; writes docs/reliability.md."""

import argparse
import platform
import tempfile
import time
from collections import Counter
from pathlib import Path
from random import Random

from desaxe.support.written import write_whole
from tests.reliability.rig import CRASHED, OUTCOMES, RIGHT, Trial, Verdict

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reliability.md"
HEAD = """# Reliability: what was tried, and how it ended

`python -m tests.reliability` does things, disturbs them at a moment or in a way that a seed chooses, and
judges what is left. **Wrong**: another value than without the disturbance, a mixed or half-written file,
files left behind. **Crashed**: a signal, or an error that is not one of ours. **Hung**: no end in time.
**Lost**: something that was there before. The default test run does a few of each kind.

"""


def main() -> int:
    """Run the trials; 1 where one does not end right."""
    parser = argparse.ArgumentParser(prog="python -m tests.reliability", description=__doc__)
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--share", type=float, default=1.0, help="of the full number of trials")
    parser.add_argument("--check", action="store_true", help="leave docs/reliability.md as it is")
    parser.add_argument("--only", default="", help="kinds with this word in their name")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="desaxe-reliability-") as room:
        from tests.reliability.trials import TRIALS

        rows = []
        for kind in (trial for trial in TRIALS if options.only in trial.what):
            count = max(1, round(kind.full * options.share))
            rows.append((kind.what, repeated(kind, count, options.seed, Path(room))))
    if not (options.only or options.check):
        with write_whole(PAGE, overwrite=True) as staged:
            staged.write_text(HEAD + table(rows) + foot(), encoding="utf-8")
        print(f"wrote {PAGE}")
    return int(any(set(counts) - {RIGHT} for _, counts in rows))


def repeated(trial: Trial, count: int, first: int, room: Path) -> Counter[str]:
    """Outcomes of a trial over seeds; what did not end right is printed."""
    counts: Counter[str] = Counter()
    begun = time.monotonic()
    for seed in range(first, first + count):
        with tempfile.TemporaryDirectory(dir=room) as folder:
            try:
                verdict = trial.run(Path(folder), Random(seed))
            except Exception as error:
                verdict = Verdict(CRASHED, f"{type(error).__name__}: {error}")
        counts[verdict.outcome] += 1
        if verdict.outcome != RIGHT:
            print(f"  seed {seed}: {verdict.outcome}: {verdict.note}", flush=True)
    print(f"{trial.what}: {dict(counts)}, {time.monotonic() - begun:.0f} s", flush=True)
    return counts


def table(rows: list[tuple[str, Counter[str]]]) -> str:
    """Outcomes as a table."""
    heads = ("tried", "times", *OUTCOMES)
    lines = [f"| {' | '.join(heads)} |", f"|{' --- |' * len(heads)}"]
    for what, counts in rows:
        numbers = [counts.total(), *(counts[outcome] for outcome in OUTCOMES)]
        lines.append(f"| {what} | {' | '.join(map(str, numbers))} |")
    return "\n".join(lines) + "\n"


def foot() -> str:
    """The foot of the page: Python version and system."""
    return f"\nPython {platform.python_version()} on {platform.system()} {platform.machine()}.\n"


raise SystemExit(main())
