"""Pictures as files."""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from ..support.forks import IMPORTS
from ..support.written import GIF_COMMENT, PAGE, SIGNED, write_whole


def save(
    figure: Any,
    path: str | PathLike[str],
    dpi: float | None = None,
    *,
    overwrite: bool = False,
    **options: Any,
) -> Path:
    """Write a figure or animation to a file, in the format of its suffix; missing folders are created.

    figure  a matplotlib Figure or what a function of `desaxe.plot` returns (.png, .svg, .pdf), or an
            animation (.gif, .html)
    dpi     dots per inch; by default 150, and 80 of an animation
    overwrite  replace a file that desaxe did not write
    options  of matplotlib's `savefig`, such as `transparent=True`; an animation's `save`, such as `writer`

    A file appears whole or not at all. Returns its path. Raises FileExistsError for a file without the mark
    that pictures of desaxe have in their metadata (.png, .svg, .pdf, .ps, .eps, .gif, .html).
    """
    target = Path(path)
    with write_whole(target, overwrite) as staged:
        if hasattr(figure, "to_jshtml"):
            _animation(figure, staged, dpi or 80.0, options)
        else:
            field = SIGNED.get(target.suffix.lower())
            if field is not None:
                options["metadata"] = {field: "desaxe", **options.get("metadata", {})}
            _figure_of(figure).savefig(staged, dpi=dpi or 150.0, **options)
    return target


def _figure_of(shown: Any) -> Any:
    """The figure of a picture, of axes, or of the first of several; TypeError for anything else."""
    first = shown
    while isinstance(first, (Mapping, Sequence)):
        first = next(iter(first.values() if isinstance(first, Mapping) else first), None)
    if not hasattr(first, "savefig"):
        first = getattr(first, "figure", None)
    if not hasattr(first, "savefig"):
        raise TypeError(f"save: {type(shown).__name__}: expected a figure, or what desaxe.plot returns")
    return first


def _animation(animation: Any, path: Path, dpi: float, options: Mapping[str, Any]) -> None:
    with IMPORTS:
        from matplotlib import rc_context
        from matplotlib.animation import PillowWriter

    if options:
        animation.save(path, dpi=dpi, **options)
    elif path.suffix == ".gif":
        animation.save(path, writer=PillowWriter(fps=1000.0 / animation._interval), dpi=dpi)
    elif path.suffix == ".html":
        with rc_context({"savefig.dpi": dpi, "animation.embed_limit": 200.0}):
            path.write_text(f"{PAGE}\n{animation.to_jshtml()}", encoding="utf-8")
    else:
        raise ValueError(f"{path.suffix!r}: an animation is written as .gif or .html")
    if path.suffix == ".gif":
        path.write_bytes(path.read_bytes().removesuffix(b";") + GIF_COMMENT + b";")
