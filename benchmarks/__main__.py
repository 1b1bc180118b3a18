"""`python -m benchmarks`: desaxe beside everyone else at the same works, time and error, in one run."""

import argparse
import json
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from .rows import ROWS, table
from .work import BRIEF, BY_KEY, WORKS

if TYPE_CHECKING:
    from .measure import Data

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).parent / "results" / "measured.json"
DOCS = ROOT / "docs"
PAGE, MEASURED = DOCS / "benchmarks.md", DOCS / "measured.md"
STARTS = "starts"  # no race: processes of desaxe alone
DESCRIPTION = """\
desaxe beside NumPy, numba, numexpr, JAX, CasADi, heyoka and C at the same works, on one core and on all:
time as a multiple of desaxe's, error against the truth. The peers come with the extra `peers`, C with gcc;
whoever is not installed is left out.
"""
EPILOG = """\
examples:
  python -m benchmarks --quick                 a look at everyone, in a minute
  python -m benchmarks --only point --only grid
  python -m benchmarks --write                 the committed figures afresh: results, pages, pictures
  python -m benchmarks --only tenth --write    this work alone, into the stored run
"""


def main() -> None:
    """Measure and print; write if asked to."""
    options = _parser().parse_args()
    if options.list:
        print(_listed())
    elif options.accuracy:
        import_module(".accuracy.command", __package__).measure_accuracy(
            options.quick, DOCS if options.write else None
        )
    elif options.again:
        _write(json.loads(RESULTS.read_text(encoding="utf-8")))
    else:
        _measure(options)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    keys = [work.key for work in WORKS]
    parser.add_argument(
        "--only",
        action="append",
        choices=[*keys, STARTS, *ROWS],
        metavar="WORK",
        help="this work alone; repeatable; --list names them",
    )
    parser.add_argument(
        "--accuracy",
        action="store_true",
        help="every accuracy of desaxe beside the textbook's formula in families of points where it loses "
        "its digits; a minute or two, half a minute with --quick; --write writes docs/accuracy.md",
    )
    parser.add_argument(
        "--quick", action="store_true", help="five small works, few rounds, no cold starts: a minute"
    )
    parser.add_argument("--points", type=_positive, metavar="N", help="points of the works at random points")
    parser.add_argument("--rounds", type=_positive, metavar="N", help="rounds of each work (9; quick: 2)")
    parser.add_argument(
        "--list", action="store_true", help="the works and the contenders, and who is not installed"
    )
    parser.add_argument("--write", action="store_true", help="write results, pages and pictures")
    parser.add_argument(
        "--again", action="store_true", help="write them from the stored results, measure nothing"
    )
    return parser


def _positive(text: str) -> int:
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError(f"{text}: at least 1 is needed")
    return count


def _listed() -> str:
    from .contenders import CONTENDERS

    works = [f"  {work.key:11}{work.title}" for work in WORKS]
    works.append(f"  {STARTS:11}first calls and second processes of desaxe")
    works += [f"  {name}: {work.__doc__}" for name, work in ROWS.items()]
    missing = {one.name: "" if one.is_here else f"not here: needs {one.needs}" for one in CONTENDERS}
    return "\n".join(
        ["works", *works, "contenders", *(f"  {n:18}{why}".rstrip() for n, why in missing.items())]
    )


def _measure(options: argparse.Namespace) -> None:
    try:
        from .measure import FULL, QUICK, Effort, measure
    except ModuleNotFoundError as missing:
        raise SystemExit(f"the benchmarks need {missing.name}: python -m pip install -e '.[dev]'") from None
    from desaxe.support.progress import progress_bar

    from .report import terminal

    if options.write and (options.quick or options.points):
        raise SystemExit("--write stores works in full: without --quick and --points")
    effort = QUICK if options.quick else FULL
    effort = effort._replace(points=options.points, rounds=options.rounds or effort.rounds)
    only = options.only or ()
    for name in (name for name in ROWS if name in only):
        print(table(name, effort.rounds), end="\n\n")
    if only and set(only) <= set(ROWS):
        return
    works = [BY_KEY[key] for key in only if key in BY_KEY]
    with progress_bar() as watch:
        data = measure([], Effort(False, 2)) if STARTS in only else {}
        if works or not only:
            data |= measure(works or (BRIEF if options.quick else WORKS), effort, watch)
    print(terminal(data))
    if options.write:
        data = _into_stored(data) if options.only else data
        RESULTS.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        _write(data)


def _into_stored(data: "Data") -> "Data":
    """The stored run with these works measured anew; times are compared inside a work only."""
    stored: Data = json.loads(RESULTS.read_text(encoding="utf-8"))
    if "calls" in data:
        stored["calls"] = data["calls"]
    for part in ("points", "one core", "all cores", "operations", "load"):
        merged = {**stored.get(part, {}), **data.get(part, {})}
        stored[part] = {work.key: merged[work.key] for work in WORKS if work.key in merged}
    return stored


def _write(data: "Data") -> None:
    """The page, its pictures, the short table."""
    from desaxe.plot import save

    from .picture import errors_over_time, time_over_points
    from .report import GROWTH_PICTURE, PICTURE, page, with_table

    PAGE.write_text(page(data), encoding="utf-8")
    MEASURED.write_text(with_table(MEASURED.read_text(encoding="utf-8"), data), encoding="utf-8")
    save(errors_over_time(data), DOCS / PICTURE, dpi=130)
    save(time_over_points(data), DOCS / GROWTH_PICTURE, dpi=130)
    for path in (PAGE, MEASURED, DOCS / PICTURE, DOCS / GROWTH_PICTURE):
        print(f"wrote {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
