"""`python -m benchmarks --accuracy`: measure, print, and write the page with its picture."""

from pathlib import Path

from desaxe.plot import save
from desaxe.support.progress import progress_bar
from desaxe.support.written import write_whole

from .picture import draw
from .report import PICTURE, by_family, overview, report, share_of, ulp_of
from .run import FULL, QUICK, Audit, audit

PAGE = "accuracy.md"


def measure_accuracy(quick: bool, folder: Path | None) -> None:
    """Audit; the tables on stdout, and files if there is a folder for them."""
    with progress_bar() as watch:
        result = audit(QUICK if quick else FULL, watch)
    print(text(result), flush=True)
    for path in write(result, folder) if folder is not None else ():
        print(f"wrote {path}")


def text(result: Audit) -> str:
    """The tables of an audit as text for the terminal."""
    tables = {
        "time as a multiple of desaxe standard, errors as shares of its promise, and in plain ulp": overview(
            result
        ),
        "share of the promise, worst (median)": by_family(result, share_of),
        "plain ulp, worst (median)": by_family(result, ulp_of),
    }
    parts = [result.machine, *(f"{title}\n\n{rows}" for title, rows in tables.items())]
    return "\n\n".join(parts) + "\n"


def write(result: Audit, folder: Path) -> list[Path]:
    """accuracy.md and accuracy.png in a folder, which is made if need be."""
    page, picture = folder / PAGE, folder / PICTURE
    with write_whole(page, overwrite=True) as staged:
        staged.write_text(report(result), encoding="utf-8")
    save(draw(result), picture, dpi=130)
    return [page, picture]
