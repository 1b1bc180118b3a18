"""Pictures as files."""

from os import PathLike
from pathlib import Path
from typing import Any

from ..support.files import replacing


def save(figure: Any, path: str | PathLike[str], dpi: float | None = None) -> Path:
    """Write a figure or animation to a file, in the format of its suffix; missing folders are created.

    figure  a matplotlib Figure (.png, .svg, .pdf), or an animation (.gif, .html)
    dpi     dots per inch; by default 150, and 80 of an animation

    A file appears whole or not at all. Returns its path.
    """
    target = Path(path)
    with replacing(target) as staged:
        if hasattr(figure, "to_jshtml"):
            _animation(figure, staged, dpi or 80.0)
        else:
            figure.savefig(staged, dpi=dpi or 150.0)
    return target


def _animation(animation: Any, path: Path, dpi: float) -> None:
    from matplotlib import rc_context
    from matplotlib.animation import PillowWriter

    if path.suffix == ".gif":
        animation.save(path, writer=PillowWriter(fps=1000.0 / animation._interval), dpi=dpi)
    elif path.suffix == ".html":
        with rc_context({"savefig.dpi": dpi, "animation.embed_limit": 200.0}):
            path.write_text(animation.to_jshtml(), encoding="utf-8")
    else:
        raise ValueError(f"{path.suffix!r}: an animation is written as .gif or .html")
