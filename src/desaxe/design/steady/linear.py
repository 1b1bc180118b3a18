"""Linear periodic equations along the panels of designs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...support.computed import computed_once
from ...support.panels import NODES, RUNNING, WEIGHT, Panels

Array = NDArray[Any]
# Growth over a panel beyond which an integrating factor is no polynomial, not even a rough one: what
# that leaves is corrected by Newton's method, or by another solution.
STIFF = 6.0


class Linear:
    """The equation y' = g y + r with y(end) + jump = y(start) - defect, on a mesh; g is given once.

    Between the edges of a panel by the integrating factor exp(integral of g), which is a polynomial unless g
    is large; there the collocation equations are solved.
    """

    def __init__(self, mesh: Panels, g: Array) -> None:
        self.mesh, self.g = mesh, g
        total = (g @ WEIGHT) * mesh.half[..., 0]
        growth = np.clip(mesh.half * (g @ RUNNING.T), -STIFF, STIFF)
        self.factor = np.exp(growth)
        self.through = np.exp(np.clip(total, -STIFF, STIFF))  # a panel
        self.stiff = np.nonzero(np.abs(mesh.half * g).max(-1) * 2.0 > STIFF)
        half, steep = mesh.half[self.stiff], g[self.stiff]
        self.inverse = np.linalg.inv(np.eye(NODES) - half[..., None] * RUNNING * steep[:, None, :])
        self.free = self.inverse.sum(-1)
        self.factor[self.stiff] = self.free
        self.through[self.stiff] = 1.0 + half[..., 0] * ((steep * self.free) @ WEIGHT)
        self.log_multiplier = total.sum(-1)

    def solve(self, r: Array, defect: Array, jumps: Array | None = None) -> tuple[Array, Array]:
        """y at the start and at the nodes; `jumps` of y stand at the end of each panel."""
        half, (row, panel) = self.mesh.half, self.stiff
        inner = r / self.factor
        own = self.factor * (half * (inner @ RUNNING.T))
        last = self.through * half[..., 0] * (inner @ WEIGHT)
        if len(row):
            wide, steep = half[row, panel], r[row, panel]
            local = np.einsum("kij,kj->ki", self.inverse, wide * (steep @ RUNNING.T))
            own[row, panel] = local
            last[row, panel] = wide[:, 0] * ((steep + self.g[row, panel] * local) @ WEIGHT)
        if jumps is not None:
            last = last + jumps
        entering = np.zeros((*last.shape[:-1], last.shape[-1] + 1))
        for k in range(last.shape[-1]):
            entering[..., k + 1] = self.through[:, k] * entering[..., k] + last[..., k]
        start = (defect + entering[..., -1]) / self.less_one
        share = np.cumprod(self.through[:, :-1], axis=-1)
        entering[..., 0] += start
        entering[..., 1:-1] += share * start[..., None]
        return start, self.factor * entering[..., :-1, None] + own

    @computed_once
    def less_one(self) -> Array:
        """1 - the product over all panels, which does not cancel where that is near 1."""
        if len(self.stiff[0]):
            far = np.abs(self.log_multiplier) > STIFF
            return np.asarray(np.where(far, 1.0 - self.through.prod(-1), -np.expm1(self.log_multiplier)))
        return np.asarray(-np.expm1(self.log_multiplier))
