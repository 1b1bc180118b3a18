"""`Picture`: what a function of `desaxe.plot` drew, to build on, to show in a notebook, and to save."""

from collections.abc import Iterator, Mapping
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

from ..support.forks import IMPORTS
from ..support.written import GIF_COMMENT, PAGE, SIGNED, write_whole


class Picture:
    """A drawing of a function of `desaxe.plot`.

    figure   the matplotlib Figure
    axes     the Axes that were drawn on; a list of them where there are several quantities
    artists  what was drawn: a list, or a dict name -> lines where there are several quantities

    A picture is a sequence, or a mapping, of its artists: `picture[0]`, `picture["T_in"]`, `len(picture)`.
    Any other attribute is that of what was drawn: `turn(theta)` of a sketch, `to_jshtml()` of an animation.
    """

    def __init__(self, axes: Any, artists: Any, drawn: Any = None) -> None:
        figure = (axes[0] if isinstance(axes, list) else axes).figure
        while not hasattr(figure, "savefig"):  # a part of a figure
            figure = figure.figure
        self.figure, self.axes, self.artists = figure, axes, artists
        self._drawn = artists if drawn is None else drawn

    def save(self, path: str | PathLike[str], dpi: float | None = None, **options: Any) -> Path:
        """Write it to a file, as `desaxe.plot.save` does; `options` are matplotlib's own."""
        return save(self._drawn if hasattr(self._drawn, "to_jshtml") else self.figure, path, dpi, **options)

    def __getitem__(self, key: Any) -> Any:
        return self.artists[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.artists)

    def __len__(self) -> int:
        return len(self.artists)

    def __eq__(self, other: object) -> bool:
        return bool(self.artists == (other.artists if isinstance(other, Picture) else other))

    __hash__ = object.__hash__

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or "_drawn" not in self.__dict__:
            raise AttributeError(name)
        return getattr(self._drawn, name)

    def _repr_png_(self) -> bytes:
        """The picture in a notebook."""
        image = BytesIO()
        self.figure.savefig(image, format="png", dpi=100.0)
        return image.getvalue()

    def __repr__(self) -> str:
        return f"<Picture of {len(self.artists)} artists: {self.artists!r}>"


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
            _save_animation(figure, staged, dpi or 80.0, options)
        else:
            field = SIGNED.get(target.suffix.lower())
            if field is not None:
                options["metadata"] = {field: "desaxe", **options.get("metadata", {})}
            drawn: Any = getattr(figure, "figure", None)  # of a figure itself
            if not hasattr(drawn, "savefig"):
                requested = "expected a figure, or what desaxe.plot returns"
                raise TypeError(f"save: {type(figure).__name__}: {requested}")
            drawn.savefig(staged, dpi=dpi or 150.0, **options)
    return target


def _save_animation(animation: Any, path: Path, dpi: float, options: Mapping[str, Any]) -> None:
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
