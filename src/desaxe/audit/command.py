"""`desaxe audit`: measure, print, and write the page with its picture."""

from importlib import import_module
from pathlib import Path

from ..runtime.written import replacing_ours, require_place
from ..support.progress import progress_bar
from ..support.shown import printable
from .report import PICTURE, by_family, overview, report, share_of, ulp_of
from .run import FULL, QUICK, Audit, audit

PAGE = "accuracy.md"


def command(quick: bool, folder: str | None, overwrite: bool = False) -> int:
    """Audit; the tables on stdout, and files if there is a folder for them."""
    if folder is not None:  # fail at once, not after minutes
        import_module("matplotlib.figure")
        for name in (PAGE, PICTURE):
            require_place(Path(folder) / name, overwrite)
    with progress_bar() as watch:
        found = audit(QUICK if quick else FULL, watch)
    print(text(found), flush=True)
    if folder is not None:
        for path in write(found, Path(folder), overwrite):
            print(f"wrote {printable(path)}")
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


def write(found: Audit, folder: Path, overwrite: bool = False) -> list[Path]:
    """accuracy.md and accuracy.png in a folder, which is made if need be."""
    from ..plot.save import save
    from .picture import draw

    page, picture = folder / PAGE, folder / PICTURE
    with replacing_ours(page, overwrite) as staged:
        staged.write_text(report(found), encoding="utf-8")
    with replacing_ours(picture, overwrite) as staged:
        save(draw(found), staged, dpi=130)
    return [page, picture]
