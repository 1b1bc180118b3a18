"""`Picture`: what a function of `desaxe.plot` drew, to build on, to save, and to show in a notebook."""

from collections.abc import Iterator
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

from .save import save

OWN = ("figure", "axes", "artists", "_drawn")


class Picture:
    """A drawing of a function of `desaxe.plot`.

    figure   the matplotlib Figure
    axes     the Axes that were drawn on; a list of them where there are several quantities
    artists  what was drawn: a list, or a dict name -> lines where there are several quantities

    A picture is a sequence, or a mapping, of its artists: `picture[0]`, `picture["T_in"]`, `len(picture)`.
    Any other attribute is that of what was drawn: `turn(theta)` of a sketch, `to_jshtml()` of an animation.
    """

    def __init__(self, axes: Any, artists: Any, drawn: Any = None) -> None:
        first = axes[0] if isinstance(axes, list) else axes
        self.figure, self.axes, self.artists = _root(first.figure), axes, artists
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

    def __setattr__(self, name: str, value: Any) -> None:
        own = name in OWN or not hasattr(self._drawn, name)
        object.__setattr__(self if own else self._drawn, name, value)

    def _repr_png_(self) -> bytes:
        """The picture in a notebook."""
        image = BytesIO()
        self.figure.savefig(image, format="png", dpi=100.0)
        return image.getvalue()

    def __repr__(self) -> str:
        return f"<Picture of {len(self.artists)} artists: {self.artists!r}>"


def _root(figure: Any) -> Any:
    """The figure itself, of a part of one too."""
    return figure if hasattr(figure, "savefig") else _root(figure.figure)
