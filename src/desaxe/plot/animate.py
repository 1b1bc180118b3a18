"""Animations: the mechanism as it turns, beside a quantity over the crank angle."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..mechanism.names import LENGTHS
from ..mechanism.quantity_units import UnitSystem
from ..support.extras import needed
from ..support.forks import IMPORTS
from .curves import curves
from .mechanism import label_lengths, mechanism
from .picture import Picture
from .shared import ORANGE, input_in_si, shown

if TYPE_CHECKING:
    import xarray as xr

TALL, WIDE = 4.6, 5.0  # inches: height of all, width of the curve's part


def animate(
    dataset: "xr.Dataset", name: str | None = None, *, frames: int = 60, seconds: float = 3.0, ax: Any = None
) -> Picture:
    """The mechanism of a dataset as it turns, and where it is on a quantity's curve; a Picture, animated.

    dataset  the result of `desaxe.grid` over theta alone, with ec, AB and BC
    name     the quantity whose curve is drawn beside it; without one there is only the mechanism
    frames   how many pictures, evenly among the angles of the dataset, for a turn of so many `seconds`
    ax       where to draw: an Axes for the mechanism, and a second one in a pair for the curve; by default
             those of a new Figure

    `picture.save("press.gif")` or `"press.html"` writes it; in a notebook show
    `IPython.display.HTML(picture.to_jshtml())`. Raises ValueError where the dataset lacks what is needed.
    """
    with needed("plot.animate"):
        from matplotlib.animation import FuncAnimation
    design = _design(dataset)
    left, right = _axes(design, name is not None, ax)
    theta = input_in_si(dataset["theta"])
    sketch = mechanism(theta=theta[0], branch=int(dataset.attrs.get("branch", 1)), ax=left, **design)
    label_lengths(left, UnitSystem.read({"ec": dataset["ec"].attrs.get("units", "m")}).of("ec"))
    moving: Any = None
    if name is not None:
        curves(dataset, name, ax=right)
        (moving,) = right.plot([], [], "o", color=ORANGE, markersize=8, zorder=5)
        across, up = shown(dataset["theta"]), np.asarray(dataset[name].values, dtype=np.float64)

    def at(place: int) -> list[Any]:
        artists: list[Any] = sketch.turn(theta[place])
        if moving is None:
            return artists
        moving.set_data(across[place : place + 1], up[place : place + 1])
        return [*artists, moving]

    whole = theta.size > 1 and abs(theta[-1] - theta[0] - 2.0 * np.pi) < 1e-9  # its last angle is its first
    places = np.linspace(0, theta.size - 1, min(frames, theta.size) + whole).round().astype(int)
    every = places[:-1] if whole and places.size > 1 else places
    frames_of = [int(k) for k in every]
    movie = FuncAnimation(left.figure, at, frames_of, interval=1000.0 * seconds / every.size)
    return Picture([left, right] if moving is not None else left, at(0), movie)


def _design(dataset: "xr.Dataset") -> dict[str, float]:
    missing = [n for n in (*LENGTHS, "theta") if n not in dataset.coords]
    if missing:
        raise ValueError(f"animate: the dataset has no {missing[0]}")
    wide = [str(n) for n in dataset.dims if n != "theta"]
    if wide or "theta" not in dataset.dims:
        wanted = ", ".join(f"{n}=..." for n in wide)
        told = f"choose a value first, dataset.sel({wanted})" if wide else "it needs the dimension theta"
        raise ValueError(f"animate: one design over the crank angle; {told}")
    return {n: float(input_in_si(dataset[n])) for n in LENGTHS}


def _axes(design: dict[str, float], both: bool, ax: Any) -> tuple[Any, Any]:
    if ax is not None:
        left, *rest = np.atleast_1d(ax)
        if both and not rest:
            raise ValueError("ax: expected two Axes, for the mechanism and for the curve")
        return left, rest[0] if rest else None
    with IMPORTS:
        from matplotlib.figure import Figure

    narrow = 2.0 * (design["AB"] + abs(design["ec"])) / (2.0 * design["AB"] + design["BC"])
    width = max(2.6, 1.2 + TALL * min(narrow, 1.0))
    if not both:
        return Figure(figsize=(width, TALL), layout="constrained").add_subplot(), None
    figure = Figure(figsize=(width + WIDE, TALL), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[width, WIDE])
    return left, right
