"""The pictures of a scene."""

from pathlib import Path
from typing import Any

from ...evaluation.grid import grid
from ...evaluation.in_units import in_units
from ...mechanism.quantity_units import UnitSystem
from ...support.forks import IMPORTS
from ..content import Content, PictureRequest
from .grid import arrays_of


def draw(picture: PictureRequest, content: Content, shown_in: UnitSystem, overwrite: bool) -> Path:
    """Draw the curves of a picture, in the units shown, into its file; return its path."""
    axes = drawn(picture, content, shown_in)
    with IMPORTS:
        from ...plot import save
    return save(axes.figure, picture.file, overwrite=overwrite)


def drawn(picture: PictureRequest, content: Content, shown_in: UnitSystem) -> Any:
    """The curves of a picture, in the units shown; returns the Axes."""
    with IMPORTS:
        from ...plot import curves

    # With the names of the outputs the kernel of the grid serves here too, where all inputs are the same.
    shared = picture.quantity in content.outputs and set(picture.inputs) == set(content.inputs)
    names = content.outputs if shared else (picture.quantity,)
    options: dict[str, Any] = {"accuracy": content.accuracy, "threads": content.threads}
    values: Any = grid(names, branch=content.branch, **options, **arrays_of(picture.inputs))
    dataset = in_units(values, shown_in)
    axes: Any = curves(dataset, picture.quantity, over=picture.over, family=picture.family).axes
    title = picture.title or content.title
    if title:
        axes.set_title(" ".join(title.split()), loc="left", parse_math=False)  # text, no TeX
    return axes
