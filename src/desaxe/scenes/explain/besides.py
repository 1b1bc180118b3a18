"""Work of a run beside its grid: peaks, pictures, checks."""

from math import prod
from typing import Any

from ..content import Content


def work_besides(content: Content) -> list[dict[str, Any]]:
    """The work besides the grid: peaks, pictures, checks."""
    found: list[dict[str, Any]] = []
    for peak in content.peaks:
        designs = prod(len(values) for values in peak.axes.values())
        how = "refined over theta by its derivative"
        found.append(
            {"what": f"{peak.kind} of {peak.quantity}", "count": designs, "of": "designs", "how": how}
        )
    if content.steady is not None:
        designs = prod(len(values) for values in content.steady.axes.values())
        how = "periodic motions by Newton's method, in NumPy"
        found.append({"what": "steady state on a motor", "count": designs, "of": "designs", "how": how})
    for picture in content.pictures:
        points = prod(len(value) for value in picture.inputs.values() if isinstance(value, tuple))
        how = f"drawn to {picture.file}"
        found.append({"what": f"picture of {picture.quantity}", "count": points, "of": "points", "how": how})
    if content.checks:
        how = "single points in plain Python"
        found.append({"what": "printed values", "count": len(content.checks), "of": "points", "how": how})
    return found
