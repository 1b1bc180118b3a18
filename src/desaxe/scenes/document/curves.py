"""The section on curves: the outputs over the crank angle, and the pictures that the scene asks for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...design.steady.steady import steady
from ...evaluation.in_units import in_units
from ...mechanism.quantity_units import UnitSystem
from ...mechanism.status import PointStatus
from ...support.forks import IMPORTS
from ..content import Content, Run
from ..parts.pictures import drawn
from .blocks import Block, Section, Text, cell, image_of, thinned
from .design import ALWAYS

if TYPE_CHECKING:
    import xarray as xr

PANELS, SAMPLES, CURVES = 3, 20_001, 6  # in a picture, along a curve, of a family


def curves(content: Content, run: Run, units: UnitSystem, elsewhere: Sequence[str]) -> Section | None:
    """The outputs over theta, or over the first axis, and the scene's own pictures; None without any.

    elsewhere  outputs that are drawn in another section, where theta alone varies
    """
    blocks: list[Block] = []
    if run.dataset is not None:
        again = [n for n in elsewhere if n in run.dataset and run.dataset[n].dims == ("theta",)]
        blocks += _of_outputs(run.dataset.drop_vars(again))
    for picture in content.of("picture"):
        axes = drawn(picture, content, units)
        blocks.append(image_of(axes.figure, picture.title or f"{picture.quantity} over {picture.over}"))
    if run.steady is not None:
        with IMPORTS:
            from ...plot import steady as draw

        requested = run.steady.asked  # the first design's speed and torque over a period
        first: dict[str, Any] = {n: v[0] for n, v in requested.axes.items()}
        one = steady(torque=requested.torque, branch=content.branch, **requested.fixed, **first)
        words = "Speed and torque of the first design over a period, and its loop on the motor's curve"
        blocks += [] if one["status"] else [image_of(draw(in_units(one, units)).figure, words)]
    return Section("Curves", blocks) if blocks else None


def statuses(dataset: "xr.Dataset | None") -> list[str]:
    """The status codes other than ok, in words, with the number of points of each."""
    if dataset is None or "status" not in dataset or dataset["status"].chunks is not None:
        return []
    result = np.asarray(dataset["status"].values)
    counts = {status: int((result == int(status)).sum()) for status in PointStatus if status}
    return [f"{n} of {result.size} points: {status.words}" for status, n in counts.items() if n]


def _of_outputs(dataset: "xr.Dataset") -> list[Block]:
    """Pictures of the quantities that have the same axes, a few in each."""
    kinds: dict[tuple[str, ...], list[str]] = {}
    for name, array in dataset.data_vars.items():
        if name not in ALWAYS and array.dtype.kind == "f" and array.ndim:
            kinds.setdefault(tuple(map(str, array.dims)), []).append(str(name))
    return [
        block
        for dims, group in kinds.items()
        for start in range(0, len(group), PANELS)
        for block in _picture(dataset, dims, group[start : start + PANELS])
    ]


def _picture(dataset: "xr.Dataset", dims: tuple[str, ...], names: list[str]) -> list[Block]:
    """Quantities over theta, a few curves of each; of further axes the first value."""
    with IMPORTS:
        from ...plot import panels

    over = "theta" if "theta" in dims else dims[0]
    family, *rest = [*(dim for dim in dims if dim != over), None]
    rest = [dim for dim in rest if dim is not None]
    most = {over: SAMPLES, family: CURVES}
    chosen = {dim: thinned(list(range(dataset.sizes[dim])), n) for dim, n in most.items() if dim is not None}
    part: Any = dataset[[*names]].isel({**dict.fromkeys(rest, 0), **chosen})
    part.encoding = dataset.encoding  # what the dataset knows of its loads
    left = [f"{dim} = {cell(float(part[dim]))} {part[dim].attrs.get('units', '')}" for dim in rest]
    if family is not None and dataset.sizes[family] > CURVES:
        left.append(f"{CURVES} of {dataset.sizes[family]} values of {family}")
    words = f"{', '.join(names)} over {over}" + (f"; {', '.join(left)}" if left else "")
    picture = panels(part, names, over=over, family=family)
    return [image_of(picture.figure, words), *([Text(words)] if left else [])]
