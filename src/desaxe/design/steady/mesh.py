"""Panels of the turns of many designs: a row of panels a design, functions as polynomials at Gauss nodes.

Arrays have the shape (designs, panels, NODES). A panel may have no width: it fills a row that needs fewer.
"""

from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ...support.computed import computed_once
from ..turn.panels import NODE, NODES, RUNNING, TO_COEFFICIENTS, WEIGHT

Array = NDArray[Any]
ENDS = legendre.legvander(np.array([-1.0, 1.0]), NODES - 1) @ TO_COEFFICIENTS
DERIVATIVE = (legendre.legvander(NODE, NODES - 2) @ legendre.legder(TO_COEFFICIENTS, axis=0)).T
STIFF = 5.0  # growth over a panel beyond which an integrating factor is no polynomial


class Mesh:
    """Panels between edges, which ascend in each row: an array (designs, panels + 1)."""

    def __init__(self, edges: Array) -> None:
        self.edges = edges

    @computed_once
    def half(self) -> Array:
        """Half the width of each panel."""
        return 0.5 * np.diff(self.edges)[..., None]

    @computed_once
    def x(self) -> Array:
        """The nodes."""
        nodes: Array = 0.5 * (self.edges[:, 1:] + self.edges[:, :-1])[..., None] + self.half * NODE
        return nodes

    def integral(self, values: Array) -> Array:
        """The integral over all panels, of each design."""
        return np.asarray(((values @ WEIGHT) * self.half[..., 0]).sum(-1))

    def running(self, values: Array) -> Array:
        """The integral from the first edge to each node."""
        whole = np.cumsum((values @ WEIGHT) * self.half[..., 0], axis=-1)
        start = np.concatenate([np.zeros_like(whole[..., :1]), whole[..., :-1]], axis=-1)
        return np.asarray(self.half * (values @ RUNNING.T) + start[..., None])

    def ends(self, values: Array) -> Array:
        """The values at both ends of each panel."""
        return np.asarray(values @ ENDS.T)

    def tails(self, values: Array) -> tuple[Array, Array]:
        """The last two Legendre coefficients of each panel, and two before them: the larger magnitudes."""
        four = np.abs(values @ TO_COEFFICIENTS[[10, 11, -2, -1]].T)
        return four[..., 2:].max(-1), four[..., :2].max(-1)

    def at(self, x: Array, values: Array) -> Array:
        """Values at places (designs, any)."""
        last = self.edges.shape[1] - 2
        panel = np.array(
            [np.searchsorted(e[1:], p, side="right") for e, p in zip(self.edges, x, strict=True)]
        )
        return self.within(np.minimum(panel.reshape(x.shape), last), x, values)

    def within(self, panel: Array, x: Array, values: Array) -> Array:
        """Values at places of known panels."""
        row = np.arange(len(x))[:, None]
        half = self.half[row, panel, 0]
        middle = self.edges[row, panel] + half
        local = np.clip((x - middle) / np.where(half > 0.0, half, 1.0), -1.0, 1.0)
        basis = legendre.legvander(local, NODES - 1)
        return np.asarray(np.einsum("nmk,nmk->nm", basis, (values @ TO_COEFFICIENTS.T)[row, panel]))

    def samples(self, values: Array) -> Array:
        """The values at start, nodes and end of each panel, in a row."""
        ends = self.ends(values)
        every = np.concatenate([ends[..., :1], values, ends[..., 1:]], axis=-1)
        return every.reshape(len(every), -1)

    @computed_once
    def places(self) -> Array:
        """The places of `samples`."""
        start, stop = self.edges[:, :-1, None], self.edges[:, 1:, None]
        return np.concatenate([start, self.x, stop], axis=-1).reshape(len(self.edges), -1)

    def roots(self, values: Array) -> Array:
        """The places at which a function changes its sign, in a row padded with the first edge."""
        sampled, places = np.sign(self.samples(values)), self.places
        sampled[sampled == 0.0] = 1.0
        row, at = np.nonzero(np.diff(sampled, axis=1))
        found = places[row, at].copy()
        panel, number = np.divmod(at, NODES + 2)
        inside = number < NODES + 1  # else between two panels
        rows, panels = row[inside], panel[inside]
        series = (values @ TO_COEFFICIENTS.T)[rows, panels]
        half, middle = self.half[rows, panels, 0], self.edges[rows, panels] + self.half[rows, panels, 0]
        whole = np.concatenate([[-1.0], NODE, [1.0]])
        low, high = whole[number[inside]], whole[number[inside] + 1]
        found[inside] = middle + half * _root(series, low, high)
        return padded(row, found, len(values), self.edges[:, 0])

    def refined(self, bad: Array, edges: Array) -> Array:
        """These edges and the middles of bad panels, in rows."""
        row, panel = np.nonzero(bad)
        middles = self.edges[row, panel] + self.half[row, panel, 0]
        return np.sort(np.concatenate([edges, padded(row, middles, len(edges), edges[:, 0])], axis=1), axis=1)


def padded(row: Array, values: Array, count: int, filler: Array) -> Array:
    """Values of rows as an array with as many columns as the fullest row needs."""
    sizes = np.bincount(row, minlength=count)
    order = np.argsort(row, kind="stable")
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    found = np.repeat(filler[:, None], sizes.max(initial=0), axis=1)
    found[row[order], np.arange(len(row)) - starts[row[order]]] = values[order]
    return found


def _root(series: Array, low: Array, high: Array) -> Array:
    """The roots of Legendre series in brackets, by Illinois steps and bisection."""

    def value(x: Array) -> Array:
        return np.asarray(np.einsum("mk,mk->m", legendre.legvander(x, NODES - 1), series))

    at_low, at_high = value(low), value(high)
    for step in range(60):
        with np.errstate(invalid="ignore", divide="ignore"):
            x = high - at_high * (high - low) / (at_high - at_low)
        x = np.where((x > low) & (x < high) & (step % 3 < 2), x, 0.5 * (low + high))
        here = value(x)
        same = np.sign(here) == np.sign(at_high)
        at_low, at_high = np.where(same, 0.5 * at_low, here), np.where(same, here, 0.5 * at_high)
        low, high = np.where(same, low, x), np.where(same, x, high)
        # Halved values steer the secant only; the signs, which decide, stay.
        if not (high - low > 4e-16).any():
            break
    return np.where(np.abs(at_low) < np.abs(at_high), low, high)


class Linear:
    """The equation y' = g y + r with y(end) + jump = y(start) - defect, on a mesh; g is given once.

    Between the edges of a panel by the integrating factor exp(integral of g), which is a polynomial unless g
    is large; there the collocation equations are solved.
    """

    def __init__(self, mesh: Mesh, g: Array) -> None:
        self.mesh, self.g = mesh, g
        total = (g @ WEIGHT) * mesh.half[..., 0]
        growth = np.clip(mesh.half * (g @ RUNNING.T), -STIFF, STIFF)
        self.factor = np.exp(growth)
        self.through = np.exp(np.clip(total, -STIFF, STIFF))  # a panel
        self.stiff = np.nonzero(np.abs(mesh.half * g).max(-1) * 2.0 > STIFF)
        half, steep = mesh.half[self.stiff], g[self.stiff]
        self.matrix = np.eye(NODES) - half[..., None] * RUNNING * steep[:, None, :]
        self.free = np.linalg.solve(self.matrix, np.ones((len(steep), NODES, 1)))[..., 0]
        self.factor[self.stiff] = self.free
        self.through[self.stiff] = 1.0 + half[..., 0] * ((steep * self.free) @ WEIGHT)
        self.log_multiplier = total.sum(-1)

    def solve(self, r: Array, defect: Array, jumps: Array | None = None) -> tuple[Array, Array]:
        """y at the start and at the nodes; `jumps` of y stand at the end of each panel.

        r may have an axis of several equations before those of the mesh.
        """
        half, (row, panel) = self.mesh.half, self.stiff
        inner = r / self.factor
        own = self.factor * (half * (inner @ RUNNING.T))
        last = self.through * half[..., 0] * (inner @ WEIGHT)
        if len(row):
            wide, steep = half[row, panel], r[..., row, panel, :]
            local = self._solved(wide * (steep @ RUNNING.T))
            own[..., row, panel, :] = local
            last[..., row, panel] = wide[:, 0] * ((steep + self.g[row, panel] * local) @ WEIGHT)
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

    def _solved(self, r: Array) -> Array:
        """The collocation equations of stiff panels: one right-hand side each, or several."""
        if r.ndim == 2:
            return np.asarray(np.linalg.solve(self.matrix, r[..., None])[..., 0])
        return np.moveaxis(np.linalg.solve(self.matrix, np.moveaxis(r, 0, -1)), -1, 0)

    @computed_once
    def less_one(self) -> Array:
        """1 - the product over all panels, which does not cancel where that is near 1."""
        if len(self.stiff[0]):
            far = np.abs(self.log_multiplier) > STIFF
            return np.asarray(np.where(far, 1.0 - self.through.prod(-1), -np.expm1(self.log_multiplier)))
        return np.asarray(-np.expm1(self.log_multiplier))
