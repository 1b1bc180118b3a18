"""The section on curves: the outputs over the crank angle, and the pictures that the scene asks for."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.in_units import in_units
from ...mechanism.names import STATUSES
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import PointStatus
from ...support.forks import IMPORTS
from ..content import Content
from ..parts.pictures import drawn
from .parts import Block, Section, Text, TextTable, cell, image_of, thinned

if TYPE_CHECKING:
    import xarray as xr

PANELS, SAMPLES, CURVES = 3, 20_001, 6  # in a picture, along a curve, of a family
ROWS = 24  # of a table
ALWAYS = (*STATUSES, "margin")


def curves(content: Content, dataset: "xr.Dataset | None", units: UnitSystem) -> Section | None:
    """The outputs over theta, or over the first axis, and the scene's own pictures; None without any."""
    blocks: list[Block] = []
    if dataset is not None:
        blocks += _of_outputs(dataset if content.units else in_units(dataset, units))
    for picture in content.pictures:
        axes = drawn(picture, content, units)
        blocks.append(image_of(axes.figure, picture.title or f"{picture.quantity} over {picture.over}"))
    return Section("Curves", blocks) if blocks else None


def statuses(dataset: "xr.Dataset | None") -> list[str]:
    """The status codes other than ok, in words, with the number of points of each."""
    if dataset is None or "status" not in dataset or dataset["status"].chunks is not None:
        return []
    found = np.asarray(dataset["status"].values)
    counts = {status: int((found == int(status)).sum()) for status in PointStatus if status}
    return [f"{n} of {found.size} points: {status.words}" for status, n in counts.items() if n]


def _of_outputs(dataset: "xr.Dataset") -> list[Block]:
    names = [str(n) for n, a in dataset.data_vars.items() if n not in ALWAYS and a.dtype.kind == "f"]
    one = {n: a for n in names if not (a := dataset[n]).ndim}
    blocks: list[Block] = []
    if one:
        rows = [
            (n, cell(float(a)), *(str(a.attrs.get(key, "")) for key in ("units", "long_name")))
            for n, a in one.items()
        ]
        blocks.append(TextTable(("quantity", "value", "unit", "meaning"), rows))
    kinds: dict[tuple[str, ...], list[str]] = {}
    for name in names:
        if name not in one:
            kinds.setdefault(tuple(map(str, dataset[name].dims)), []).append(name)
    for dims, group in kinds.items():
        for start in range(0, len(group), PANELS):
            blocks += _picture(dataset, dims, group[start : start + PANELS])
    return blocks


def _picture(dataset: "xr.Dataset", dims: tuple[str, ...], names: list[str]) -> list[Block]:
    """Quantities over theta, a few curves of each; of further axes the first value."""
    with IMPORTS:
        from ...plot import curves as draw_curves
        from ...plot import panels

    over = "theta" if "theta" in dims else dims[0]
    others = [dim for dim in dims if dim != over]
    family, rest = (others[0] if others else None), others[1:]
    part: Any = dataset[[*names]].isel(dict.fromkeys(rest, 0))
    part.encoding = dataset.encoding
    if family is not None:
        part = _kept(part, family, CURVES)
    if part.sizes[over] > SAMPLES:
        part = _kept(part, over, SAMPLES)
    left = [f"{dim} = {cell(float(part[dim]))} {part[dim].attrs.get('units', '')}" for dim in rest]
    if family is not None and dataset.sizes[family] > CURVES:
        left.append(f"{CURVES} of {dataset.sizes[family]} values of {family}")
    words = f"{', '.join(names)} over {over}" + (f"; {', '.join(left)}" if left else "")
    if len(names) == 1:
        picture = draw_curves(part, names[0], over=over, family=family)
    else:
        picture = panels(part, names, over=over, family=family)
    return [image_of(picture.figure, words), *([Text(words)] if left else [])]


def _kept(part: Any, dim: str, most: int) -> Any:
    """A few values of an axis; what the dataset knows of its loads stays."""
    found = part.isel({dim: thinned(list(range(part.sizes[dim])), most)})
    found.encoding = part.encoding
    return found
