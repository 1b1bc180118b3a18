"""`desaxe audit`: measure, print, and write the page with its picture."""

from importlib import import_module
from pathlib import Path

from ..support.progress import progress_bar
from .report import PICTURE, by_family, overview, report, share_of, ulp_of
from .run import FULL, QUICK, Audit, audit

PAGE = "accuracy.md"


def command(quick: bool, folder: str | None) -> int:
    """Audit; the tables on stdout, and files if there is a folder for them."""
    if folder is not None:
        import_module("matplotlib.figure")  # told at once if it is missing, not after minutes
    with progress_bar() as watch:
        found = audit(QUICK if quick else FULL, watch)
    print(text(found))
    if folder is not None:
        for path in write(found, Path(folder)):
            print(f"wrote {path}")
    return 0


def text(found: Audit) -> str:
    """The tables of an audit as text for the terminal."""
    tables = {
        "time as a multiple of desaxe standard, errors as shares of its promise, and in plain ulp": overview(
            found
        ),
        "share of the promise, worst (median)": by_family(found, share_of),
        "plain ulp, worst (median)": by_family(found, ulp_of),
    }
    parts = [found.machine, *(f"{title}\n\n{rows}" for title, rows in tables.items())]
    return "\n\n".join(parts) + "\n"


def write(found: Audit, folder: Path) -> list[Path]:
    """accuracy.md and accuracy.png in a folder, which is made if need be."""
    from ..plot.save import save
    from ..support.files import write_text
    from .picture import draw

    page = folder / PAGE
    picture = save(draw(found), folder / PICTURE, dpi=130)
    write_text(page, report(found))
    return [page, picture]
