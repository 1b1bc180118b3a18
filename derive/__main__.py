"""`python -m derive`: write generated/, or check that it is fresh, or report seconds and sizes."""

import argparse
import sys
import time
from importlib.util import find_spec
from pathlib import Path

REMEDY = "python -m derive"


def target() -> Path:
    """The output folder: generated/ beside this package, or that of the installed package."""
    beside = Path(__file__).resolve().parent.parent / "generated"
    if beside.is_dir() and Path(__file__).resolve().parent.name == "derive":
        return beside
    spec = find_spec("desaxe.generated")
    return Path(spec.origin).parent if spec and spec.origin else beside


def main(arguments: list[str] | None = None) -> int:
    """Run the command; 1 where --check finds a difference."""
    parser = argparse.ArgumentParser(prog="python -m derive", description=__doc__, allow_abbrev=False)
    parser.add_argument(
        "--check", action="store_true", help="build in memory, compare, exit 1 on a difference"
    )
    parser.add_argument(
        "--report", action="store_true", help="seconds and sizes of modules, operations of quantities by pass"
    )
    parser.add_argument("-o", "--output", type=Path, help="another folder than generated/")
    options = parser.parse_args(arguments)
    folder = options.output or target()

    started = time.perf_counter()
    print("deriving from the loop closure ...", file=sys.stderr, flush=True)
    from desaxe.support.shown import in_brief

    from .build import build
    from .report import report
    from .write import differences, render, write

    derivation = build()
    files = render(derivation)
    lines = len(derivation.program.lines)
    seconds = time.perf_counter() - started
    print(f"derived {len(derivation.names)} names in {lines} lines, {seconds:.1f} s", file=sys.stderr)
    if options.report:
        print(report(derivation))
        return 0
    if options.check:
        result = differences(files, folder)
        print(f"{folder.name}/ is {'stale: run ' + REMEDY if result else 'fresh'}")
        sys.stdout.write(in_brief(result))
        return 1 if result else 0
    changed = write(files, folder)
    print(f"wrote {', '.join(changed)}" if changed else f"{folder.name}/ was fresh: nothing written")
    return 0


if __name__ == "__main__":
    sys.exit(main())
